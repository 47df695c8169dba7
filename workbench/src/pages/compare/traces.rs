//! Time series of a view, with as many points as it has pixels, and their statistics.

use std::collections::BTreeMap;

use model_lab::result::Residual;
use plant_sim::parameters::PlantParameters;
use recording::{Pyramid, Samples, Signal, TimeBase};
use serde::{Deserialize, Serialize};

use super::band::Band;
use super::selection::Selection;
use super::states::{self, Segment};
use crate::pages::points::{Drawn, Points, Range};
use crate::refusal::Refusal;
use crate::results::Compared;
use crate::session::{LoadedLog, Session};
use crate::shown_unit::{shown_unit, shown_values};
use crate::tolerance::Tolerance;

/// View of the page.
#[derive(Debug, Deserialize)]
pub(super) struct View {
    from_s: Option<f64>,
    to_s: Option<f64>,
    /// Share of the view that is drawn on either side, so that moving shows no empty edge.
    #[serde(default)]
    beside: f64,
    /// Points of each series.
    points: usize,
    /// Samples to mark; see [`Selection`].
    select: Option<String>,
    /// Whether the states of the valves are requested.
    #[serde(default)]
    states: bool,
}

#[derive(Serialize)]
pub(super) struct Traces {
    /// First and last instant of the whole log (s).
    whole_s: (f64, f64),
    signals: Vec<SignalTraces>,
    selection: Option<Selection>,
    /// Commanded states of the valves.
    states: Vec<Segment>,
}

#[derive(Serialize)]
struct SignalTraces {
    name: String,
    quantity: String,
    unit: &'static str,
    /// Whether it drives the model.
    is_input: bool,
    measured: Points,
    model: Option<Points>,
    residual: Option<ResidualTrace>,
}

#[derive(Serialize)]
struct ResidualTrace {
    trace: Points,
    unit: String,
    /// Standard deviation of the measurement noise.
    noise: Option<f64>,
    /// Largest rms error within tolerance.
    limit: Option<f64>,
    holds: Option<bool>,
    /// Metrics of the samples in the view.
    metrics: Option<Metrics>,
    /// Tolerance of single samples, if the user set one.
    band: Option<Band>,
}

/// Statistics of a residual.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Metrics {
    samples: usize,
    rms: f64,
    mean_absolute: f64,
    bias: f64,
    standard_deviation: f64,
    lowest: f64,
    highest: f64,
}

impl Metrics {
    /// Returns the statistics of a residual; `None` if nothing was compared.
    pub(super) fn of(residual: impl Iterator<Item = f64> + Clone) -> Option<Self> {
        let present = || residual.clone().filter(|error| !error.is_nan());
        let samples = present().count();
        if samples == 0 {
            return None;
        }
        let mean = |term: fn(f64) -> f64| present().map(term).sum::<f64>() / samples as f64;
        let bias = mean(|error| error);
        let variance = present().map(|error| (error - bias).powi(2)).sum::<f64>() / samples as f64;
        Some(Self {
            samples,
            rms: mean(|error| error * error).sqrt(),
            mean_absolute: mean(f64::abs),
            bias,
            standard_deviation: variance.sqrt(),
            lowest: present().fold(f64::INFINITY, f64::min),
            highest: present().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}

/// Returns the time series of the log `number` in a view, and those of the model if it was compared.
pub(super) fn traces(session: &Session, number: u32, view: &View) -> Result<Traces, Refusal> {
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let compared = session.comparison(number);
    let project = session.project();
    let parameters = project.plant.parameters()?;
    let seen = Range {
        from_s: view.from_s,
        to_s: view.to_s,
    };
    let range = seen.with_beside(view.beside)?;
    let drawer = Drawer {
        log,
        parameters: &parameters,
        compared: compared.as_deref(),
        tolerances: &project.strictness.bands,
        seen,
        drawn: Drawn {
            range,
            points: view.points,
        },
    };
    let signals = (0..log.recording.signals().len()).map(|index| drawer.signal(index));
    let signals = signals.collect::<Result<_, _>>()?;
    let bases = || log.recording.time_bases().map(|(_, base)| base);
    let selection = match (&compared, &view.select) {
        (Some(compared), Some(select)) => Some(Selection::of(compared, select)?),
        _ => None,
    };
    let states = if view.states {
        states::segments(&log.recording, &parameters, range)?
    } else {
        Vec::new()
    };
    Ok(Traces {
        states,
        whole_s: (
            bases().map(TimeBase::start_s).fold(f64::INFINITY, f64::min),
            bases()
                .map(TimeBase::end_s)
                .fold(f64::NEG_INFINITY, f64::max),
        ),
        signals,
        selection,
    })
}

struct Drawer<'a> {
    log: &'a LoadedLog,
    parameters: &'a PlantParameters,
    compared: Option<&'a Compared>,
    tolerances: &'a BTreeMap<String, Tolerance>,
    /// Visible range, for the statistics.
    seen: Range,
    drawn: Drawn,
}

impl Drawer<'_> {
    fn signal(&self, index: usize) -> Result<SignalTraces, Refusal> {
        let recording = &self.log.recording;
        let signal = &recording.signals()[index];
        let base = recording.time_base(signal.time_base());
        let base = base.ok_or_else(|| Refusal::not_found("time base"))?;
        let (unit, converter) = shown_unit(signal, self.parameters);
        let measured = self.trace(base, signal.values_or_nan(), &self.log.pyramids[index])?;
        let place = self.compared.and_then(|compared| {
            let signals = &compared.comparison.signals;
            Some((
                compared,
                signals.iter().position(|one| one.name == signal.name())?,
            ))
        });
        let (mut model, mut residual) = (None, None);
        if let Some((compared, place)) = place {
            let traces = &compared.comparison.traces;
            let pyramids = &compared.pyramids[place];
            if let Some(run) = traces.free_run.signal(signal.name()) {
                model = Some(self.trace(base, run.values_or_nan(), &pyramids.model)?);
            }
            residual = self.residual(compared, place, (base, signal))?;
        }
        Ok(SignalTraces {
            name: signal.name().to_owned(),
            quantity: signal.quantity().to_string(),
            unit: unit.symbol(),
            is_input: signal.name().starts_with("duty_") || signal.name() == "u_bat",
            measured: match converter {
                Some(converter) => measured.map(|value| converter.apply(value)),
                None => measured,
            },
            model,
            residual,
        })
    }

    fn residual(
        &self,
        compared: &Compared,
        place: usize,
        (base, measured): (&TimeBase, &Signal),
    ) -> Result<Option<ResidualTrace>, Refusal> {
        let signal = &compared.comparison.signals[place];
        let traces = &compared.comparison.traces;
        let Some(errors) = traces.free_run_residual(&signal.name) else {
            return Ok(None);
        };
        let (within, _) = self.seen.of(base)?;
        Ok(Some(ResidualTrace {
            trace: self.trace(base, &errors, &compared.pyramids[place].residual)?,
            unit: signal.unit.clone(),
            noise: signal.noise_floor.value,
            limit: signal.limit,
            holds: signal.holds,
            metrics: Metrics::of(errors.part(within).iter()),
            band: self.band((base, measured, errors))?,
        }))
    }

    fn band(
        &self,
        (base, measured, errors): (&TimeBase, &Signal, Residual),
    ) -> Result<Option<Band>, Refusal> {
        let Some(tolerance) = self.tolerances.get(measured.name()) else {
            return Ok(None);
        };
        let measured = shown_values(measured, self.parameters);
        let band = Band::of(tolerance, (base, &measured, &errors), self.seen, self.drawn)?;
        Ok(Some(band))
    }

    fn trace(
        &self,
        base: &TimeBase,
        values: &(impl Samples + ?Sized),
        pyramid: &Pyramid,
    ) -> Result<Points, Refusal> {
        Points::of_pyramid(base, values, pyramid, self.drawn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_are_those_of_the_samples_that_are_there() {
        let metrics = Metrics::of([1.0, f64::NAN, -3.0].into_iter()).unwrap();
        assert_eq!(
            metrics,
            Metrics {
                samples: 2,
                rms: 5.0_f64.sqrt(),
                mean_absolute: 2.0,
                bias: -1.0,
                standard_deviation: 2.0,
                lowest: -3.0,
                highest: 1.0,
            }
        );
        assert_eq!(Metrics::of([f64::NAN].into_iter()), None);
    }
}
