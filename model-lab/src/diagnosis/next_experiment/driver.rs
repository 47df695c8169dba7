//! Driver of a plant that executes a plan and records its commands. A plan states openings: the driver finds the duty cycles.

use plant_sim::parameters::OnOffValveParameters;
use plant_sim::plant::{FILL, VENT};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Simulator};

use super::result::Limits;

/// Approximate number of rows for which a command continues to act.
const DELAY_ROWS: f64 = 3.0;
/// Longest wait for a pressure (s).
const LONGEST_WAIT_S: f64 = 4.0;
/// Time at the start in which nothing happens (s), so that the noise of every signal shows.
const REST_S: f64 = 0.5;

/// Returns the end of a row (ns).
pub(super) fn end_ns(row: usize, interval_s: f64) -> u64 {
    ((row + 1) as f64 * interval_s * 1e9).round() as u64
}

/// Conversion of the opening of a valve to its duty cycle.
#[derive(Debug, Clone, Copy)]
enum Drive {
    /// The current opens the valve: the duty cycle is the opening.
    Opens,
    /// The current shuts the valve: the duty cycle is the rest.
    Shuts,
    /// The valve is commanded open or shut for whole samples; a partial opening is the open share of this many.
    Switches { rows: usize },
}

impl Drive {
    fn of(
        function: ValveFunction,
        on_off: &OnOffValveParameters,
        period_s: f64,
        interval_s: f64,
    ) -> Self {
        match function {
            ValveFunction::NormallyOpen => Self::Shuts,
            ValveFunction::OnOff => {
                let opening_s = on_off.opening_delay_s + on_off.opening_ramp_s;
                let closing_s = on_off.closing_delay_s + on_off.closing_ramp_s;
                let rows = (period_s.max(opening_s + closing_s) / interval_s).ceil();
                Self::Switches {
                    rows: rows as usize,
                }
            }
            ValveFunction::NormallyClosed
            | ValveFunction::Proportional
            | ValveFunction::AlwaysOpen
            | ValveFunction::Blocked
            | ValveFunction::Absent => Self::Opens,
        }
    }

    /// Returns the duty cycle (%) for an opening (%) that began `since` rows ago.
    fn duty_pct(self, opening_pct: f64, since: usize) -> f64 {
        match self {
            Self::Opens => opening_pct,
            Self::Shuts => 100.0 - opening_pct,
            Self::Switches { rows } => {
                let open_rows = (opening_pct / 100.0 * rows as f64).round() as usize;
                if since % rows < open_rows { 100.0 } else { 0.0 }
            }
        }
    }
}

/// Driver of a plant. Openings are in % of the time or, for a proportional valve, of its command.
pub(super) struct Driver<'a> {
    simulator: Simulator,
    ambient_pa: f64,
    limits: &'a Limits,
    drives: [Drive; 2],
    /// Sample time of the ECU (s).
    pub(super) interval_s: f64,
    /// Time in which one duty cycle acts (s): a PWM period, or a sample where that is longer.
    period_s: f64,
    /// Duty cycles (%) of fill and vent valve, row by row.
    pub(super) duties: Vec<[f64; 2]>,
    /// Rows since the opening of each valve began.
    since: [usize; 2],
    /// Pressure one row ago (Pa abs).
    before: f64,
}

impl<'a> Driver<'a> {
    pub(super) fn new(plant: &PlantParameters, limits: &'a Limits) -> Self {
        let interval_s = plant.ecu.sample_time_s;
        let period_s = interval_s.max(1.0 / plant.ecu.pwm_frequency_hz);
        let [fill, vent] = plant.functions;
        let mut driver = Self {
            simulator: Simulator::new(plant),
            ambient_pa: plant.gas.ambient_pressure_pa,
            limits,
            drives: [
                Drive::of(fill, &plant.on_off_fill, period_s, interval_s),
                Drive::of(vent, &plant.on_off_vent, period_s, interval_s),
            ],
            interval_s,
            period_s,
            duties: Vec::new(),
            since: [0; 2],
            before: plant.gas.ambient_pressure_pa,
        };
        driver.hold(REST_S);
        driver
    }

    pub(super) fn is_over(&self) -> bool {
        self.duties.len() as f64 * self.interval_s >= self.limits.duration_s - 1e-9
    }

    /// Returns the longest duration (s).
    pub(super) fn duration_s(&self) -> f64 {
        self.limits.duration_s
    }

    /// Returns the duty cycles that shut both valves as far as the limits allow (%).
    pub(super) fn shut(&self) -> [f64; 2] {
        self.duties_pct([0.0; 2], [0; 2])
    }

    /// Returns the duty cycles that open one valve as far as the limits allow (%).
    pub(super) fn wide_open(&self, valve: usize) -> [f64; 2] {
        self.duties_pct(only(valve, 100.0), [0; 2])
    }

    fn duties_pct(&self, openings_pct: [f64; 2], since: [usize; 2]) -> [f64; 2] {
        [FILL, VENT].map(|valve| {
            let duty_pct = self.drives[valve].duty_pct(openings_pct[valve], since[valve]);
            duty_pct.min(self.limits.max_duty_pct)
        })
    }

    /// Returns the pressure (Pa gauge) that is reached when the command ends now.
    fn coming(&self) -> f64 {
        let pressure = self.simulator.state().pressure;
        pressure + DELAY_ROWS * (pressure - self.before) - self.ambient_pa
    }

    /// Returns whether the pressure is above this share of the highest allowed.
    pub(super) fn is_above(&self, share: f64) -> bool {
        self.simulator.state().pressure - self.ambient_pa > share * self.limits.max_bar * 1e5
    }

    /// Commands one row of openings (%).
    fn row(&mut self, openings_pct: [f64; 2]) {
        let duties = self.duties_pct(openings_pct, self.since);
        for (since, opening_pct) in self.since.iter_mut().zip(openings_pct) {
            *since = if opening_pct > 0.0 { *since + 1 } else { 0 };
        }
        self.command(duties);
    }

    /// Commands one row of duty cycles (%).
    fn command(&mut self, duties: [f64; 2]) {
        if self.is_over() {
            return;
        }
        let [duty_fill_pct, duty_vent_pct] = duties;
        self.duties.push(duties);
        self.before = self.simulator.state().pressure;
        self.simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct,
        });
        let row = self.duties.len() - 1;
        self.simulator.advance_to_ns(end_ns(row, self.interval_s));
    }

    fn rows(&self, span_s: f64) -> usize {
        (span_s / self.interval_s).round() as usize
    }

    fn go(&mut self, openings_pct: [f64; 2], span_s: f64) {
        for _ in 0..self.rows(span_s) {
            self.row(openings_pct);
        }
    }

    /// Keeps both valves shut.
    pub(super) fn hold(&mut self, span_s: f64) {
        self.go([0.0; 2], span_s);
    }

    pub(super) fn fill(&mut self, opening_pct: f64, span_s: f64) {
        self.go(only(FILL, opening_pct), span_s);
    }

    pub(super) fn vent(&mut self, opening_pct: f64, span_s: f64) {
        self.go(only(VENT, opening_pct), span_s);
    }

    /// Drives the vent valve with the highest duty cycle, so that its coil warms, whatever the valve does then.
    pub(super) fn energise_vent(&mut self, span_s: f64) {
        let mut duties = self.shut();
        duties[VENT] = self.limits.max_duty_pct;
        for _ in 0..self.rows(span_s) {
            self.command(duties);
        }
    }

    /// Opens a valve for a share of some PWM periods. One that switches opens once, for the same share of as many of its cycles.
    pub(super) fn pulse(&mut self, valve: usize, opening_pct: f64, periods: u32) {
        match self.drives[valve] {
            Drive::Opens | Drive::Shuts => {
                self.go(only(valve, opening_pct), f64::from(periods) * self.period_s);
            }
            Drive::Switches { rows } => {
                let open_rows = (opening_pct / 100.0 * f64::from(periods) * rows as f64).round();
                self.go(only(valve, 100.0), open_rows * self.interval_s);
            }
        }
    }

    pub(super) fn fill_to(&mut self, opening_pct: f64, share: f64) {
        let most = self.duties.len() + (LONGEST_WAIT_S / self.interval_s) as usize;
        let sought = share * self.limits.max_bar * 1e5;
        while self.coming() < sought && self.duties.len() < most && !self.is_over() {
            self.row(only(FILL, opening_pct));
        }
    }

    pub(super) fn vent_to(&mut self, opening_pct: f64, share: f64) {
        let most = self.duties.len() + (LONGEST_WAIT_S / self.interval_s) as usize;
        let sought = share.max(0.01) * self.limits.max_bar * 1e5;
        while self.coming() > sought && self.duties.len() < most && !self.is_over() {
            self.row(only(VENT, opening_pct));
        }
    }

    /// Vents above this share of the highest allowed pressure.
    pub(super) fn vent_above(&mut self, share: f64, span_s: f64) {
        if self.is_above(share) {
            self.vent(100.0, span_s);
            self.hold(0.2);
        }
    }
}

/// Returns the openings with one valve open (%).
fn only(valve: usize, opening_pct: f64) -> [f64; 2] {
    let mut openings_pct = [0.0; 2];
    openings_pct[valve] = opening_pct;
    openings_pct
}
