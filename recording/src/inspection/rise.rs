//! Change of a pressure while a valve is on.

use super::columns::Column;

/// Samples of a column.
#[derive(Clone, Copy)]
pub(super) struct Trace<'a> {
    times: &'a [f64],
    samples: &'a [f64],
    /// Value above which a valve counts as on.
    on: f64,
    range: f64,
}

impl<'a> Trace<'a> {
    /// Share of the greatest value above which a valve counts as on.
    const ON: f64 = 0.1;

    pub(super) fn of(column: &'a Column) -> Self {
        Self {
            times: &column.times,
            samples: &column.samples,
            on: Self::ON * column.values.greatest,
            range: column.values.greatest - column.values.least,
        }
    }
}

/// Returns the change of the pressure while a valve is on and the other one is off, as a share of its range.
pub(super) fn rise(valve: Trace<'_>, other: Option<Trace<'_>>, pressure: Trace<'_>) -> Option<f64> {
    let mut valve_is_on = Last::of(valve);
    let mut other_is_on = other.map(Last::of);
    let present = pressure.times.iter().zip(pressure.samples);
    let mut present = present.filter(|(_, sample)| !sample.is_nan()).peekable();
    let (mut sum, mut count) = (0.0, 0_u64);
    while let Some((&time, &value)) = present.next() {
        let is_on = valve_is_on.is_on_at(time);
        let is_other_on = other_is_on
            .as_mut()
            .is_some_and(|other| other.is_on_at(time));
        if let (Some(&(_, &next)), true, false) = (present.peek(), is_on, is_other_on) {
            (sum, count) = (sum + next - value, count + 1);
        }
    }
    (count > 0 && pressure.range > 0.0).then(|| sum / pressure.range)
}

/// Last known sample of a trace.
struct Last<'a> {
    trace: Trace<'a>,
    next: usize,
    value: f64,
}

impl<'a> Last<'a> {
    fn of(trace: Trace<'a>) -> Self {
        Self {
            trace,
            next: 0,
            value: 0.0,
        }
    }

    fn is_on_at(&mut self, time: f64) -> bool {
        while self
            .trace
            .times
            .get(self.next)
            .is_some_and(|&at| at <= time)
        {
            let sample = self
                .trace
                .samples
                .get(self.next)
                .copied()
                .unwrap_or(f64::NAN);
            if !sample.is_nan() {
                self.value = sample;
            }
            self.next += 1;
        }
        self.trace.on > 0.0 && self.value > self.trace.on
    }
}
