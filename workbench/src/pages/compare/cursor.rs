//! Values of all signals at a cursor.

use recording::{Signal, TimeBase};
use serde::{Deserialize, Serialize};

use crate::refusal::Refusal;
use crate::session::Session;
use crate::shown_unit::shown_unit;

/// Instant of the log (s).
#[derive(Deserialize)]
pub(super) struct Instant {
    pub(super) time_s: f64,
}

/// Values of the log at the sample nearest to an instant.
#[derive(Serialize)]
pub(super) struct Values {
    signals: Vec<ValueOf>,
}

#[derive(Serialize)]
struct ValueOf {
    name: String,
    /// Time of the sample (s).
    time_s: f64,
    measured: Option<f64>,
    model: Option<f64>,
    residual: Option<f64>,
}

/// Returns the values at the cursor.
pub(super) fn values(session: &Session, number: u32, time_s: f64) -> Result<Values, Refusal> {
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let compared = session.comparison(number);
    let parameters = session.project().plant.parameters()?;
    let traces = compared
        .as_ref()
        .map(|compared| &compared.comparison.traces);
    let value_of = |signal: &Signal| {
        let base = log.recording.time_base(signal.time_base())?;
        let index = nearest(base, time_s);
        let (_, converter) = shown_unit(signal, &parameters);
        let measured = signal.get(index);
        let errors = traces.and_then(|traces| traces.free_run_residual(signal.name()));
        let residual = errors.filter(|errors| index < errors.len());
        let residual = residual
            .map(|errors| errors.at(index))
            .filter(|error| !error.is_nan());
        Some(ValueOf {
            name: signal.name().to_owned(),
            time_s: base.times_s()[index],
            measured: match converter {
                Some(converter) => measured.map(|value| converter.apply(value)),
                None => measured,
            },
            model: traces
                .filter(|_| errors.is_some())
                .and_then(|traces| traces.free_run.signal(signal.name())?.get(index)),
            residual,
        })
    };
    Ok(Values {
        signals: log
            .recording
            .signals()
            .iter()
            .filter_map(value_of)
            .collect(),
    })
}

fn nearest(base: &TimeBase, time_s: f64) -> usize {
    let times_s = base.times_s();
    let after = times_s
        .partition_point(|&one| one < time_s)
        .min(times_s.len() - 1);
    let before = after.saturating_sub(1);
    if (times_s[before] - time_s).abs() <= (times_s[after] - time_s).abs() {
        before
    } else {
        after
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_sample_is_found_at_both_ends_and_between() {
        let base = TimeBase::new(vec![0.0, 1.0, 3.0]).unwrap();
        for (time_s, index) in [(-5.0, 0), (0.4, 0), (0.6, 1), (2.1, 2), (99.0, 2)] {
            assert_eq!(nearest(&base, time_s), index, "{time_s}");
        }
    }
}
