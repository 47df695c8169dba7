//! Commands of the logs: fillings and ventings of several sizes, pulses, holds, then random commands.

use super::format::KindLogger;
use crate::chance::Chance;
use crate::kinds_plant::{Drive, KindRig};

/// Sizes of the commands of the id log (%).
const LEVELS_PCT: [f64; 4] = [80.0, 60.0, 45.0, 30.0];
/// Period of pulse trains that stand for a duty cycle (s).
const TRAIN_S: f64 = 0.2;
/// Longest single filling or venting (s).
const ACTION_S_MAX: f64 = 3.0;
/// Longest share of a log that a long hold takes, and its length (s).
const LONG_HOLD_SHARE: f64 = 0.12;
const LONG_HOLD_S: f64 = 9.0;
/// Holds of the random part, and their share of its commands.
const HOLD_S: [f64; 2] = [0.3, 3.0];
const HOLDS: f64 = 0.3;
/// Share of the random commands that open both valves.
const BOTH: f64 = 0.08;

/// Returns the commands (%, fill and vent) of each period of the id log or the check log.
pub(super) fn commands(
    rig: &KindRig,
    logger: &KindLogger,
    log: usize,
    chance: &mut Chance,
) -> Vec<[f64; 2]> {
    // A command stands for longer than a row lasts, so that each is in the log.
    let grid = (1.01 / (logger.rate_hz * rig.command_period_s)).ceil();
    let end_s = 1.01 * logger.lengths_s[log] + logger.offset_of_first_row_s[log];
    let mut list = List {
        commands: Vec::new(),
        period_s: rig.command_period_s,
        grid: grid as usize,
        fill_s: 1e3 * rig.volume_m3() / rig.valves[0].open.dm3_per_s_bar,
        long_hold_s: LONG_HOLD_S.min(LONG_HOLD_SHARE * logger.lengths_s[log]),
        has_states: logger.states,
        least_pct: least_pct(rig),
    };
    if log == 0 {
        list.bench();
    } else {
        list.begin();
    }
    list.random(end_s, chance);
    list.commands.truncate((end_s / list.period_s) as usize + 1);
    list.commands
}

/// Returns the smallest useful command (%): above the dead zones of proportional valves.
fn least_pct(rig: &KindRig) -> f64 {
    let zones = rig.valves.iter().map(|valve| match valve.drive {
        Drive::OnOff(_) => 20.0,
        Drive::Proportional(characteristic) => characteristic.opens_at_pct + 6.0,
    });
    zones.fold(0.0, f64::max)
}

struct List {
    commands: Vec<[f64; 2]>,
    period_s: f64,
    /// Periods of which each command stands a multiple.
    grid: usize,
    /// About the time of a filling (s).
    fill_s: f64,
    long_hold_s: f64,
    has_states: bool,
    least_pct: f64,
}

impl List {
    fn length_s(&self) -> f64 {
        self.commands.len() as f64 * self.period_s
    }

    /// Adds at least `length_s` of one command, rounded to 0.1 %.
    fn hold(&mut self, length_s: f64, command: [f64; 2]) {
        let grids = (length_s / self.period_s / self.grid as f64).ceil();
        let periods = (grids as usize).max(1) * self.grid;
        let command = command.map(|pct| (10.0 * pct).round() / 10.0);
        self.commands.extend(std::iter::repeat_n(command, periods));
    }

    fn rest(&mut self, length_s: f64) {
        self.hold(length_s, [0.0; 2]);
    }

    /// Opens a valve for `length_s` at a command (%). A valve with states opens in pulses for that share of the time.
    fn open(&mut self, valve: usize, length_s: f64, pct: f64) {
        let command = |pct: f64| {
            let mut command = [0.0; 2];
            command[valve] = pct;
            command
        };
        if !self.has_states || pct >= 100.0 {
            return self.hold(length_s, command(pct));
        }
        let pulse_s = TRAIN_S * pct / 100.0;
        for _ in 0..(length_s / TRAIN_S).ceil() as usize {
            self.hold(pulse_s, command(100.0));
            self.rest(TRAIN_S - pulse_s);
        }
    }

    /// Adds the commands of a person at the bench: full pressure with a long hold, then both valves at several sizes.
    fn bench(&mut self) {
        let fill_s = self.fill_s;
        self.begin();
        for (count, valve, pct) in [(5, 1, 50.0), (6, 0, 45.0)] {
            for _ in 0..count {
                self.open(valve, 0.12 * fill_s, pct);
                self.rest(0.5);
            }
        }
        self.open(1, 2.5 * fill_s, 100.0);
        self.rest(1.0);
        for pct in LEVELS_PCT {
            let longer = 100.0 / (pct - 0.5 * self.least_pct);
            self.open(0, (0.45 * fill_s * longer).min(ACTION_S_MAX), pct);
            self.rest(1.2);
            self.open(1, (0.35 * fill_s * longer).min(ACTION_S_MAX), pct);
            self.rest(0.8);
            self.open(1, 2.5 * fill_s, 100.0);
            self.rest(0.4);
        }
        for command in [[100.0, 100.0], [50.0, 100.0], [100.0, 50.0]] {
            let command = if self.has_states { [100.0; 2] } else { command };
            self.hold(0.8, command);
        }
        self.rest(1.0);
    }

    /// Begins at rest, fills to the supply pressure and holds it.
    fn begin(&mut self) {
        self.rest(1.0);
        self.open(0, 3.5 * self.fill_s, 100.0);
        self.rest(self.long_hold_s);
    }

    /// Adds random commands until `end_s`, with a long hold in the middle.
    fn random(&mut self, end_s: f64, chance: &mut Chance) {
        let middle_s = 0.5 * (self.length_s() + end_s);
        let mut was_held = false;
        while self.length_s() < end_s {
            if !was_held && self.length_s() > middle_s {
                was_held = true;
                self.rest(self.long_hold_s);
            }
            let length_s = self.fill_s * chance.between(0.1, 0.6);
            let pct = chance.between(self.least_pct, 100.0);
            let valve = chance.whole(0, 1);
            if chance.happens(HOLDS) {
                self.rest(chance.between(HOLD_S[0], HOLD_S[1]));
            } else if chance.happens(BOTH) && !self.has_states {
                self.hold(length_s, [pct, chance.between(self.least_pct, 100.0)]);
            } else {
                self.open(valve, length_s, pct);
            }
        }
    }
}
