//! Statistics of one time series: histogram and power spectral density.

use recording::{OwnSamples, Samples, median_step_s};
use serde::{Deserialize, Serialize};

use super::residual::{residual_of, unit_of_errors};
use crate::histogram::Histogram;
use crate::pages::points::Range;
use crate::refusal::Refusal;
use crate::session::Session;
use crate::shown_unit::shown_unit;
use crate::spectrum::Spectrum;

/// Requested statistics.
#[derive(Deserialize)]
pub(super) struct Request {
    signal: String,
    of: Side,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

/// Choice of measured, modelled or residual.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Side {
    Measured,
    Modelled,
    /// Measured minus modelled.
    Residual,
}

#[derive(Serialize)]
pub(super) struct Distribution {
    unit: String,
    /// Standard deviation of the measurement noise; `None` if unknown or not applicable.
    noise: Option<f64>,
    /// Histogram; `None` if the range is empty.
    histogram: Option<Histogram>,
}

#[derive(Serialize)]
pub(super) struct Spectral {
    unit: String,
    /// Density of the measurement noise, if it is white (unit²/Hz).
    noise_level: Option<f64>,
    /// Spectrum; `None` if no interval without a gap is long enough.
    spectrum: Option<Spectrum>,
}

/// Values of a series in a range.
struct ShownSamples {
    unit: String,
    noise: Option<f64>,
    times_s: Vec<f64>,
    values: Vec<f64>,
    /// Median sample interval of the whole log.
    step_s: Option<f64>,
}

/// Returns the histogram of a series.
pub(super) fn distribution(
    session: &Session,
    number: u32,
    request: &Request,
) -> Result<Distribution, Refusal> {
    let shown = ShownSamples::of(session, number, request)?;
    Ok(Distribution {
        histogram: Histogram::of(&shown.values),
        unit: shown.unit,
        noise: shown.noise,
    })
}

/// Returns the power spectral density of a series.
pub(super) fn spectrum(
    session: &Session,
    number: u32,
    request: &Request,
) -> Result<Spectral, Refusal> {
    let shown = ShownSamples::of(session, number, request)?;
    let spectrum = shown
        .step_s
        .and_then(|step_s| Spectrum::of(&shown.times_s, &shown.values, step_s));
    let level = shown.noise.zip(spectrum.as_ref());
    Ok(Spectral {
        unit: shown.unit,
        noise_level: level.map(|(noise, spectrum)| spectrum.of_white_noise(noise)),
        spectrum,
    })
}

impl ShownSamples {
    fn of(session: &Session, number: u32, request: &Request) -> Result<Self, Refusal> {
        let compared = super::compared(session, number)?;
        let log = session.log(number)?;
        let log = log.as_ref().as_ref().map_err(Clone::clone)?;
        let traces = &compared.comparison.traces;
        let (residual, values);
        let found = || Refusal::not_found("signal");
        let (base, values, unit, converter): (_, &dyn Samples, _, _) = match request.of {
            Side::Residual => {
                let (base, errors) = residual_of(&compared, &request.signal)?;
                let unit = unit_of_errors(&compared, &request.signal);
                residual = errors;
                (base, &residual, unit, None)
            }
            Side::Modelled => {
                let run = &traces.free_run;
                let model = run.signal(&request.signal).ok_or_else(found)?;
                let base = run.time_base_of(&request.signal).ok_or_else(found)?;
                let unit = model.unit().symbol().to_owned();
                values = model.values_or_nan();
                (base, &values, unit, None)
            }
            Side::Measured => {
                let log = &log.recording;
                let measured = log.signal(&request.signal).ok_or_else(found)?;
                let base = log.time_base_of(&request.signal).ok_or_else(found)?;
                let (unit, converter) = shown_unit(measured, &compared.parameters);
                values = measured.values_or_nan();
                (base, &values, unit.symbol().to_owned(), converter)
            }
        };
        let range = Range {
            from_s: request.from_s,
            to_s: request.to_s,
        };
        let (within, _) = range.of(base)?;
        let signals = compared.comparison.signals.iter();
        let noise = signals
            .filter(|one| one.name == request.signal && request.of != Side::Modelled)
            .find_map(|one| one.noise_floor.value);
        let shown = within.clone().map(|index| values.value(index));
        let shown: Vec<f64> = shown
            .map(|value| converter.map_or(value, |converter| converter.apply(value)))
            .collect();
        let times_s = &base.times_s()[within];
        // A signal of a lower rate than its rows has no gaps between its samples.
        let (times_s, values) = match OwnSamples::of(times_s, &shown) {
            None => (times_s.to_vec(), shown),
            Some(own) => (own.times_s, own.values),
        };
        Ok(Self {
            unit,
            noise,
            step_s: median_step_s(&times_s),
            times_s,
            values,
        })
    }
}
