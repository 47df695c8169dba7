//! Signals of several rates at the instants of one of them.

use crate::{Provenance, Recording, TimeBase, TimeBaseId};

/// Maximum age of a sample: until the next one should have come, and half a step more.
const AGE_IN_MEDIAN_STEPS: f64 = 1.5;
/// Difference below which instants are equal: groups of one logger differ in the last bits.
const SAME_IN_MEDIAN_STEPS: f64 = 1e-6;

impl Recording {
    /// Returns the recording with every signal at the instants of `time_base`. Other signals have their last known
    /// sample at these instants, as an ECU sees them. Nothing is interpolated or averaged. If the last sample is
    /// missing, or older than one and a half of its signal's median steps, the value is missing. Returns `None` if the
    /// time base belongs to another recording.
    pub fn known_at(&self, time_base: TimeBaseId) -> Option<Self> {
        let instants = self.time_base(time_base)?.clone();
        let mut known = Self::new(Provenance::clone(self.provenance()));
        for left_out in self.left_out() {
            known.leave_out(&left_out.name, &left_out.reason);
        }
        for row in self.skipped_rows() {
            known.add_skipped_row(row.clone());
        }
        for cells in self.out_of_bounds() {
            known.add_out_of_bounds(cells.clone());
        }
        let places: Vec<Vec<Option<usize>>> = self
            .time_bases()
            .map(|(_, base)| last_known(base, &instants))
            .collect();
        let ids: Vec<TimeBaseId> = self.time_bases().map(|(id, _)| id).collect();
        let id = known.add_time_base(instants);
        for signal in self.signals() {
            let samples = signal.values_or_nan();
            let base = ids.iter().position(|base| *base == signal.time_base())?;
            let samples = match signal.time_base() == time_base {
                true => samples.to_vec(),
                false => places[base]
                    .iter()
                    .map(|place| place.map_or(f64::NAN, |place| samples[place]))
                    .collect(),
            };
            known
                .add_signal(signal.name(), signal.unit(), id, samples)
                .ok()?;
        }
        Some(known)
    }
}

/// Returns for each of `instants` the last sample of `base`, unless it is too old.
fn last_known(base: &TimeBase, instants: &TimeBase) -> Vec<Option<usize>> {
    let step_s = base.sampling().median_step_s.unwrap_or(0.0);
    let (same_s, oldest_s) = (SAME_IN_MEDIAN_STEPS * step_s, AGE_IN_MEDIAN_STEPS * step_s);
    let times_s = base.times_s();
    let mut next = 0;
    let last = |&instant_s: &f64| {
        while times_s
            .get(next)
            .is_some_and(|time_s| *time_s <= instant_s + same_s)
        {
            next += 1;
        }
        let last = next.checked_sub(1)?;
        (instant_s - times_s[last] <= oldest_s).then_some(last)
    };
    instants.times_s().iter().map(last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unit;

    /// Returns a recording with 1 kHz and 100 Hz, the slow signal 2 ms late.
    fn two_rates() -> (Recording, TimeBaseId, TimeBaseId) {
        let mut recording = Recording::new(Provenance::from_source("bench"));
        let fast = recording.add_time_base(TimeBase::uniform(0.0, 0.001, 100).unwrap());
        let slow = recording.add_time_base(TimeBase::uniform(0.002, 0.01, 5).unwrap());
        let ramp = (0..100).map(f64::from).collect();
        recording.add_signal("u", Unit::Volt, fast, ramp).unwrap();
        let steps = vec![10.0, 20.0, f64::NAN, 40.0, 50.0];
        recording
            .add_signal("duty_fill", Unit::Percent, slow, steps)
            .unwrap();
        (recording, fast, slow)
    }

    #[test]
    fn fast_samples_are_picked_at_slow_instants() {
        let (recording, _, slow) = two_rates();
        let known = recording.known_at(slow).unwrap();
        let picked = known.signal("u").unwrap();
        assert_eq!(picked.values_or_nan(), [2.0, 12.0, 22.0, 32.0, 42.0]);
        assert_eq!(known.time_bases().count(), 1);
        let duty = known.signal("duty_fill").unwrap();
        assert_eq!((duty.get(1), duty.get(2)), (Some(20.0), None));
    }

    #[test]
    fn slow_samples_are_held_until_the_next_should_have_come() {
        let (recording, fast, _) = two_rates();
        let known = recording.known_at(fast).unwrap();
        let held = known.signal("duty_fill").unwrap();
        let at_ms = |ms: usize| held.get(ms);
        // Before the first sample; at it; until the next; the missing one; after the last one.
        let seen = [0, 1, 2, 11, 12, 21, 22, 31, 32, 57, 58].map(at_ms);
        let expected = [
            None,
            None,
            Some(10.0),
            Some(10.0),
            Some(20.0),
            Some(20.0),
            None,
            None,
            Some(40.0),
            Some(50.0),
            None,
        ];
        assert_eq!(seen, expected);
    }

    /// 0.06 s is not exactly 60 times 0.001 s: without the tolerance the sample of the same instant would be skipped.
    #[test]
    fn instants_that_differ_in_their_last_bits_are_the_same() {
        let mut recording = Recording::new(Provenance::default());
        let fast = recording.add_time_base(TimeBase::uniform(0.0, 0.001, 1000).unwrap());
        let times_s = (0..100).map(|index| f64::from(index) / 100.0).collect();
        let slow = recording.add_time_base(TimeBase::new(times_s).unwrap());
        let ramp = (0..1000).map(f64::from).collect();
        recording.add_signal("u", Unit::Volt, fast, ramp).unwrap();
        let known = recording.known_at(slow).unwrap();
        let expected: Vec<f64> = (0..100).map(|index| 10.0 * f64::from(index)).collect();
        assert_eq!(known.signal("u").unwrap().values_or_nan(), expected);
    }
}
