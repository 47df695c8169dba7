//! Time offset between two logs, from the cross-correlation of the changes of a signal.

use recording::{Recording, Signal, TimeBase};
use serde::Serialize;

use crate::refusal::Refusal;

/// Steps of the coarse search in either direction, and number of pieces of a log.
const COARSE: usize = 2000;
/// Steps of the fine search in either direction.
const FINE: usize = 40;
/// Share of the shorter log that has to overlap.
const OVERLAP_MIN: f64 = 0.25;

/// Offset with the best agreement of two logs.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Alignment {
    /// Offset to add to the times of the moved log (s).
    pub(crate) offset_s: f64,
    /// Correlation coefficient of the signal at this offset, -1 to 1.
    pub(crate) correlation: f64,
}

/// Finds the offset of `moved` at which `signal` correlates best with that of `fixed`, with an overlap of at least a
/// quarter of the shorter log.
pub(crate) fn align(
    fixed: &Recording,
    moved: &Recording,
    signal: &str,
) -> Result<Alignment, Refusal> {
    let [fixed, moved] = [
        PresentSamples::of(fixed, signal)?,
        PresentSamples::of(moved, signal)?,
    ];
    let shorter_s = fixed.duration_s().min(moved.duration_s());
    let longer_s = fixed.duration_s().max(moved.duration_s());
    let overlap_s = OVERLAP_MIN * shorter_s;
    let step_s = longer_s / COARSE as f64;
    let search = |middle_s: f64, step_s: f64, steps: usize| {
        let offsets = (0..=2 * steps).map(|step| middle_s + (step as f64 - steps as f64) * step_s);
        offsets
            .filter_map(|offset_s| {
                let correlation = correlation(&fixed, &moved, offset_s, overlap_s)?;
                Some(Alignment {
                    offset_s,
                    correlation,
                })
            })
            .max_by(|one, other| one.correlation.total_cmp(&other.correlation))
    };
    // If both logs begin at the same event, the offset between their starts is the middle of the search range.
    let middle_s = fixed.times_s[0] - moved.times_s[0];
    let coarse = search(middle_s, step_s, COARSE);
    let fine = coarse.and_then(|coarse| search(coarse.offset_s, step_s / FINE as f64, FINE));
    fine.ok_or_else(|| {
        Refusal::value(format!(
            "{signal} does not change enough to align two logs by it; choose another signal, or type the offset"
        ))
    })
}

/// Signal without its missing samples.
struct PresentSamples {
    times_s: Vec<f64>,
    values: Vec<f64>,
}

impl PresentSamples {
    fn of(log: &Recording, name: &str) -> Result<Self, Refusal> {
        let found = log.signal(name).zip(log.time_base_of(name));
        let (signal, base): (&Signal, &TimeBase) =
            found.ok_or_else(|| Refusal::not_found("signal in both logs"))?;
        let pairs = base.times_s().iter().zip(signal.values_or_nan());
        let (times_s, values) = pairs.filter(|(_, value)| !value.is_nan()).unzip();
        let trace = Self { times_s, values };
        if trace.times_s.len() < 3 {
            return Err(Refusal::value(format!(
                "{name} has {} samples (at least 3 to align two logs); choose another signal, or type the offset",
                trace.times_s.len()
            )));
        }
        Ok(trace)
    }

    fn duration_s(&self) -> f64 {
        self.times_s[self.times_s.len() - 1] - self.times_s[0]
    }

    /// Returns the value at `time_s`, linear between two samples.
    fn at(&self, time_s: f64) -> f64 {
        let after = self.times_s.partition_point(|&one| one < time_s);
        let after = after.clamp(1, self.times_s.len() - 1);
        let [from_s, to_s] = [self.times_s[after - 1], self.times_s[after]];
        let share = ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        self.values[after - 1] + share * (self.values[after] - self.values[after - 1])
    }
}

/// Returns the correlation coefficient of the overlapping part, sampled at a fixed number of places; `None` if it is
/// too short or constant.
fn correlation(
    fixed: &PresentSamples,
    moved: &PresentSamples,
    offset_s: f64,
    overlap_s: f64,
) -> Option<f64> {
    let from_s = fixed.times_s[0].max(moved.times_s[0] + offset_s);
    let last = |trace: &PresentSamples| trace.times_s[trace.times_s.len() - 1];
    let to_s = last(fixed).min(last(moved) + offset_s);
    if to_s - from_s < overlap_s {
        return None;
    }
    let count = COARSE;
    let (mut x, mut y, mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for place in 0..count {
        let time_s = from_s + (to_s - from_s) * (place as f64 + 0.5) / count as f64;
        let (a, b) = (fixed.at(time_s), moved.at(time_s - offset_s));
        x += a;
        y += b;
        xx += a * a;
        yy += b * b;
        xy += a * b;
    }
    let n = count as f64;
    let (variance_x, variance_y) = (xx - x * x / n, yy - y * y / n);
    let is_flat = variance_x <= 1e-12 * xx || variance_y <= 1e-12 * yy;
    (!is_flat).then(|| (xy - x * y / n) / (variance_x * variance_y).sqrt())
}

#[cfg(test)]
mod tests {
    use recording::{Provenance, Unit};

    use super::*;

    /// Returns pressure steps, as recorded by a clock that is late by `late_s` and begins at `begin_s`.
    fn log(begin_s: f64, late_s: f64, step_s: f64, count: usize) -> Recording {
        let mut recording = Recording::new(Provenance::from_source("bench"));
        let base = TimeBase::uniform(begin_s, step_s, count).unwrap();
        let value = |time_s: &f64| {
            let time_s = time_s - late_s;
            (0.7 * time_s).sin() + 0.5 * (2.3 * time_s).sin() + (0.13 * time_s).cos()
        };
        let values = base.times_s().iter().map(value).collect();
        let id = recording.add_time_base(base);
        recording
            .add_signal("p_ch", Unit::BarGauge, id, values)
            .unwrap();
        recording
    }

    #[test]
    fn a_late_clock_is_found_whatever_the_sampling() {
        let fixed = log(0.0, 0.0, 0.01, 6000);
        for (begin_s, late_s) in [(0.0, 1.234), (0.0, -0.5), (3.0, 0.02)] {
            let moved = log(begin_s, late_s, 0.013, 4000);
            let found = align(&fixed, &moved, "p_ch").unwrap();
            assert!(
                (found.offset_s + late_s).abs() < 2e-3,
                "{late_s}: {found:?}"
            );
            assert!(found.correlation > 0.999, "{found:?}");
        }
    }

    #[test]
    fn what_does_not_change_cannot_be_aligned() {
        let mut flat = Recording::new(Provenance::from_source("bench"));
        let id = flat.add_time_base(TimeBase::uniform(0.0, 0.01, 100).unwrap());
        flat.add_signal("p_ch", Unit::BarGauge, id, vec![1.0; 100])
            .unwrap();
        assert!(align(&flat, &flat, "p_ch").is_err());
        assert!(align(&flat, &flat, "i_fill").is_err());
    }
}
