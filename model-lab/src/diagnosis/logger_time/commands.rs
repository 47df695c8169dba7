//! The clock of a logger, from the commands that it logged.
//!
//! The ECU commands on its own grid, so every change of a logged duty cycle lies between the two rows that enclose a sample
//! instant of the ECU. A logger that is faster than the ECU thereby shows phase and drift of its clock without any model.

use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::ReplayInput;

/// Drifts beyond this are no logger's clock (ppm).
pub(super) const DRIFT_MAX_PPM: f64 = 400.0;
/// A logger is faster than the ECU if its rows are closer than this share of the ECU's sample time.
const FASTER: f64 = 0.75;
/// Changes of a command from which on a clock is believed.
const CHANGES_MIN: usize = 5;
/// Drifts are tried in steps that move the last change by this share of the row interval.
const STEP_SHARE: f64 = 0.01;
/// Clocks are this share of the row interval apart at the last change.
const APART_SHARE: f64 = 0.3;
/// The changes may spread over this much more than a row interval: rounded times.
const SLACK: f64 = 1.02;

/// A clock as the commands tell it.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToldClock {
    pub(super) clock: LoggerClock,
    /// The phase may be this much more or less (s).
    pub(super) phase_slack_s: f64,
}

/// Returns clocks in whose time all changes of the commands follow the sample instants of the ECU by less than a row, all over
/// the drifts for which that is so. None for a logger that is hardly faster than the ECU, for few changes, and for commands
/// that are on no such grid.
pub(super) fn clocks_from_commands(
    inputs: &[ReplayInput],
    interval_s: f64,
    sample_time_s: f64,
) -> Vec<ToldClock> {
    let changes = changes_s(inputs, interval_s);
    if interval_s > FASTER * sample_time_s || changes.len() < CHANGES_MIN {
        return Vec::new();
    }
    let span_s = changes[changes.len() - 1] - changes[0];
    let step_ppm = (STEP_SHARE * interval_s / span_s * 1e6).min(DRIFT_MAX_PPM);
    let steps = (DRIFT_MAX_PPM / step_ppm).ceil() as i32;
    let drifts = (-steps..=steps).map(|step| f64::from(step) * step_ppm);
    let is_possible = |drift_ppm: &f64| {
        Arc::of(&changes, *drift_ppm, sample_time_s).length_s <= SLACK * interval_s
    };
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    for drift_ppm in drifts.filter(is_possible) {
        match ranges.last_mut() {
            Some(last) if drift_ppm - last.1 < 1.5 * step_ppm => last.1 = drift_ppm,
            _ => ranges.push((drift_ppm, drift_ppm)),
        }
    }
    let clock = |drift_ppm: f64| {
        let arc = Arc::of(&changes, drift_ppm, sample_time_s);
        // The arc lies in the middle of the row that follows a sample instant.
        let before_s = 0.5 * (interval_s - arc.length_s);
        ToldClock {
            clock: LoggerClock {
                phase_s: (before_s - arc.begin_s).rem_euclid(sample_time_s),
                drift_ppm,
            },
            phase_slack_s: before_s.max(0.0),
        }
    };
    let apart_ppm = APART_SHARE * interval_s / span_s * 1e6;
    let drifts = ranges.into_iter().flat_map(|(least_ppm, most_ppm)| {
        let count = ((most_ppm - least_ppm) / apart_ppm).ceil().max(1.0);
        let place = move |n: usize| (n as f64 + 0.5) / count;
        (0..count as usize).map(move |n| least_ppm + place(n) * (most_ppm - least_ppm))
    });
    drifts.map(clock).collect()
}

/// The instants of the rows, since the first one (s), that show a new command right after a row with the old one.
fn changes_s(inputs: &[ReplayInput], interval_s: f64) -> Vec<f64> {
    inputs
        .windows(2)
        .filter(|pair| pair[0].command.is_some() && pair[1].command.is_some())
        .filter(|pair| pair[0].command != pair[1].command)
        .filter(|pair| (pair[1].time_ns - pair[0].time_ns) as f64 * 1e-9 < 1.5 * interval_s)
        .map(|pair| pair[1].time_ns as f64 * 1e-9)
        .collect()
}

/// The shortest arc of the ECU's sample time that holds all instants.
#[derive(Debug, Clone, Copy)]
struct Arc {
    begin_s: f64,
    length_s: f64,
}

impl Arc {
    fn of(instants_s: &[f64], drift_ppm: f64, sample_time_s: f64) -> Self {
        let mut places: Vec<f64> = instants_s
            .iter()
            .map(|instant_s| (instant_s * (1.0 + drift_ppm * 1e-6)).rem_euclid(sample_time_s))
            .collect();
        places.sort_by(f64::total_cmp);
        let last = places.len() - 1;
        let around = places[0] + sample_time_s - places[last];
        let gaps = places.windows(2).map(|pair| pair[1] - pair[0]);
        // The arc is what the widest gap leaves.
        gaps.enumerate().fold(
            Self {
                begin_s: places[0],
                length_s: sample_time_s - around,
            },
            |arc, (index, gap)| {
                if sample_time_s - gap < arc.length_s {
                    Self {
                        begin_s: places[index + 1],
                        length_s: sample_time_s - gap,
                    }
                } else {
                    arc
                }
            },
        )
    }
}
