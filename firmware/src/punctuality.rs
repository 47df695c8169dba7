//! Signals of the image in addition to those of the ECU: the timing of its samples.

use ecu::calibration::{MISSING, Signal};

/// Number of the first of these signals in messages; those of the ECU are below.
pub const FIRST_SIGNAL: u16 = 0x100;

/// Number of these signals.
const COUNT: usize = 7;
/// Number of the last of these signals.
pub(crate) const LAST_SIGNAL: u16 = FIRST_SIGNAL + COUNT as u16 - 1;

/// All signals of the image, in the order of their numbers. The maxima are counted since the session was opened. No
/// signal has a value while a host sets the pace.
pub const SIGNALS: [Signal; COUNT] = [
    us("start_latency"),
    us("start_latency_max"),
    us("drive_latency"),
    us("drive_latency_max"),
    us("interval_error"),
    us("interval_error_max"),
    Signal {
        name: "ticks_missed",
        unit: "",
        fraction_bits: 0,
        signed: true,
    },
];

const START: usize = 0;
const DRIVE: usize = 2;
const INTERVAL: usize = 4;
const MISSED: usize = 6;

/// T_ECU (µs).
pub(crate) const PERIOD_US: u32 = 10_000;

const fn us(name: &'static str) -> Signal {
    Signal {
        name,
        unit: "us",
        fraction_bits: 0,
        signed: true,
    }
}

/// Timing of the samples by the timer.
///
/// ```text
/// tick            begin: inputs are measured            driven: duty cycles are at the outputs            next tick
///  ├─── start latency ───┤                                           │
///  ├──────────────────── drive latency ──────────────────────────────┤
///                        ├─────────────────── interval: 10 ms and its error ─────────────────────────────── ... begin
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Punctuality {
    values: [i32; COUNT],
    /// Time at which the last sample began, by the machine's clock (µs).
    begun_us: Option<u32>,
}

impl Punctuality {
    /// Creates the timing before the first sample.
    pub(crate) const fn new() -> Self {
        Self {
            values: [MISSING; COUNT],
            begun_us: None,
        }
    }

    /// Records the beginning of a sample, its latency after the tick, and the number of ticks without a sample.
    pub(crate) fn begin(&mut self, now_us: u32, latency_us: u32, missed: u32) {
        self.note::<START>(latency_us);
        if let Some(before_us) = self.begun_us.replace(now_us) {
            let interval = now_us.wrapping_sub(before_us);
            self.note::<INTERVAL>(interval.abs_diff(PERIOD_US));
        }
        let missed = number(missed).saturating_add(self.values[MISSED].max(0));
        self.values[MISSED] = missed;
    }

    /// Records the latency after the tick at which the duty cycles were at the outputs.
    pub(crate) fn driven(&mut self, latency_us: u32) {
        self.note::<DRIVE>(latency_us);
    }

    /// Returns the value of a signal.
    pub(crate) fn signal(&self, id: u16) -> Option<i32> {
        let row = id.checked_sub(FIRST_SIGNAL)?;
        self.values.get(usize::from(row)).copied()
    }

    /// Stores the latest value, and the largest one in the next row.
    fn note<const ROW: usize>(&mut self, us: u32) {
        self.values[ROW] = number(us);
        self.values[ROW + 1] = self.values[ROW + 1].max(number(us));
    }
}

fn number(value: u32) -> i32 {
    i32::try_from(value).unwrap_or(i32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(punctuality: &Punctuality, name: &str) -> i32 {
        let row = SIGNALS.iter().position(|signal| signal.name == name);
        let id = FIRST_SIGNAL + u16::try_from(row.unwrap()).unwrap();
        punctuality.signal(id).unwrap()
    }

    #[test]
    fn the_latest_and_the_largest_of_each_time_are_reported() {
        let mut punctuality = Punctuality::new();
        for (now_us, latency_us) in [(10_000, 5), (20_030, 35), (30_001, 6)] {
            punctuality.begin(now_us, latency_us, 0);
            punctuality.driven(latency_us + 100);
        }
        for (name, expected) in [
            ("start_latency", 6),
            ("start_latency_max", 35),
            ("drive_latency", 106),
            ("drive_latency_max", 135),
            ("interval_error", 29),
            ("interval_error_max", 30),
            ("ticks_missed", 0),
        ] {
            assert_eq!(signal(&punctuality, name), expected, "{name}");
        }
    }

    #[test]
    fn the_clock_may_pass_the_end_of_its_type() {
        let mut punctuality = Punctuality::new();
        punctuality.begin(u32::MAX - 4_999, 0, 0);
        punctuality.begin(5_003, 0, 0);
        assert_eq!(signal(&punctuality, "interval_error"), 3);
    }

    #[test]
    fn missed_ticks_add_up() {
        let mut punctuality = Punctuality::new();
        for missed in [0, 2, 0, 1] {
            punctuality.begin(0, 0, missed);
        }
        assert_eq!(signal(&punctuality, "ticks_missed"), 3);
    }

    #[test]
    fn before_the_first_sample_nothing_has_a_value_and_beyond_the_last_signal_nothing_is() {
        let punctuality = Punctuality::new();
        for row in 0..SIGNALS.len() as u16 {
            assert_eq!(punctuality.signal(FIRST_SIGNAL + row), Some(MISSING));
        }
        let beyond = FIRST_SIGNAL + SIGNALS.len() as u16;
        for id in [0, FIRST_SIGNAL - 1, beyond, u16::MAX] {
            assert_eq!(punctuality.signal(id), None, "{id}");
        }
    }
}
