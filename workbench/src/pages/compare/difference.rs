//! Differences of a log from another one, for every signal of both, at the instants of the first.

use recording::{Quantity, Recording, Signal, TimeBase, Trace, Unit};
use serde::{Deserialize, Serialize};

use super::traces::Metrics;
use crate::pages::points::{Drawn, Points, Range};
use crate::refusal::Refusal;
use crate::resample::{Between, at_instants};
use crate::session::Session;
use crate::shown_unit::{shown_unit, shown_values, unit_of_difference};

/// Requested difference.
#[derive(Deserialize)]
pub(super) struct Request {
    /// Log that is subtracted.
    other: u32,
    /// Interpolation between two samples; `None` decides by the quantity.
    between: Option<Between>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    /// Share of the view that is drawn on either side; the statistics ignore it.
    #[serde(default)]
    beside: f64,
    points: usize,
}

#[derive(Serialize)]
pub(super) struct Differences {
    signals: Vec<Difference>,
}

#[derive(Serialize)]
struct Difference {
    name: String,
    unit: &'static str,
    between: Between,
    /// This log minus the other one.
    trace: Points,
    /// Statistics of the samples in the view; `None` if the logs do not overlap.
    metrics: Option<Metrics>,
}

/// Returns this log minus another one, both with their time offsets.
pub(super) fn differences(
    session: &Session,
    number: u32,
    request: &Request,
) -> Result<Differences, Refusal> {
    let project = session.project();
    let parameters = project.plant.parameters()?;
    let shift_s = project.log(request.other)?.offset_s - project.log(number)?.offset_s;
    let [this, other] = [session.log(number)?, session.log(request.other)?];
    let this = &this.as_ref().as_ref().map_err(Clone::clone)?.recording;
    let other = &other.as_ref().as_ref().map_err(Clone::clone)?.recording;
    let of_signal = |signal: &Signal| {
        let unit = shown_unit(signal, &parameters).0;
        let same = other.signal(signal.name())?;
        // Signals of different quantities have no difference.
        if shown_unit(same, &parameters).0 != unit {
            return None;
        }
        let between = request.between.unwrap_or_else(|| usual(signal));
        let values = [signal, same].map(|one| shown_values(one, &parameters));
        let difference = Pair {
            base: this.time_base(signal.time_base())?,
            values: &values[0],
            other_base: base_of(other, same)?,
            other_values: &values[1],
            shift_s,
        };
        Some(difference.of(signal.name(), unit, between, request))
    };
    let signals = this.signals().iter().filter_map(of_signal);
    Ok(Differences {
        signals: signals.collect::<Result<_, _>>()?,
    })
}

fn base_of<'a>(log: &'a Recording, signal: &Signal) -> Option<&'a TimeBase> {
    log.time_base(signal.time_base())
}

/// Returns the usual interpolation: a command applies until the next one; a measured signal is linear between samples.
fn usual(signal: &Signal) -> Between {
    match signal.quantity() {
        Quantity::DutyCycle => Between::Hold,
        _ => Between::Linear,
    }
}

/// Same signal of two logs.
struct Pair<'a> {
    base: &'a TimeBase,
    values: &'a [f64],
    other_base: &'a TimeBase,
    other_values: &'a [f64],
    /// Offset (s) added to the times of the other log.
    shift_s: f64,
}

impl Pair<'_> {
    fn of(
        &self,
        name: &str,
        unit: Unit,
        between: Between,
        request: &Request,
    ) -> Result<Difference, Refusal> {
        let view = Range {
            from_s: request.from_s,
            to_s: request.to_s,
        };
        let range = view.with_beside(request.beside)?;
        let ((seen, _), (within, _)) = (view.of(self.base)?, range.of(self.base)?);
        let times_s = &self.base.times_s()[within.clone()];
        let step_s = median_step_s(self.other_base);
        let other = at_instants(
            &Trace::new(self.other_base.times_s(), self.other_values, step_s),
            times_s.iter().map(|time_s| time_s - self.shift_s),
            between,
        );
        let pairs = self.values[within.clone()].iter().zip(other);
        let values: Vec<f64> = pairs.map(|(this, other)| this - other).collect();
        let trace = match TimeBase::new(times_s.to_vec()) {
            Ok(base) => {
                let points = request.points;
                Points::of(&base, &values[..], Drawn { range, points })?
            }
            // The view contains nothing of this log.
            Err(_) => Points::default(),
        };
        Ok(Difference {
            name: name.to_owned(),
            unit: unit_of_difference(unit),
            between,
            trace,
            metrics: Metrics::of(
                values[seen.start - within.start..seen.end - within.start]
                    .iter()
                    .copied(),
            ),
        })
    }
}

/// Returns the median sample interval (s); 0 for a log with one sample.
fn median_step_s(base: &TimeBase) -> f64 {
    base.sampling().median_step_s.unwrap_or(0.0)
}
