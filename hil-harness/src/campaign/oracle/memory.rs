//! History of the last samples for the oracle.

use std::collections::VecDeque;

use super::Observation;
use crate::campaign::bounds;

/// Duty cycles of the coils and pressures of the chamber, newest first.
#[derive(Debug, Default)]
pub(super) struct Memory {
    coils: VecDeque<[f64; 2]>,
    /// Duty cycles that give the same currents at the nominal voltage.
    at_nominal: VecDeque<[f64; 2]>,
    pressures_bar: VecDeque<f64>,
}

/// Longest history that any rule needs.
const SAMPLES: usize = bounds::RAMP_WINDOW as usize;

impl Memory {
    pub(super) fn new() -> Self {
        Self::default()
    }

    /// Clears the history: the target has restarted.
    pub(super) fn forget(&mut self) {
        self.coils.clear();
        self.at_nominal.clear();
        self.pressures_bar.clear();
    }

    pub(super) fn remember(&mut self, observation: &Observation) {
        self.coils.truncate(SAMPLES - 1);
        self.coils.push_front(observation.coils);
        self.at_nominal.truncate(SAMPLES - 1);
        let factor = observation.voltage_factor();
        self.at_nominal
            .push_front(observation.coils.map(|duty| duty / factor));
        self.pressures_bar.truncate(SAMPLES - 1);
        self.pressures_bar.push_front(observation.pressure_bar);
    }

    /// Returns the duty cycles of the coils in the previous sample; `None` before the first.
    pub(super) fn coils(&self) -> Option<[f64; 2]> {
        self.coils.front().copied()
    }

    /// Returns the true pressure `samples` samples ago (bar gauge).
    pub(super) fn pressure_bar(&self, samples: u32) -> Option<f64> {
        let index = (samples as usize).checked_sub(1)?;
        self.pressures_bar.get(index).copied()
    }

    /// Returns whether the duty cycle of coil `valve` satisfied `is_so` for the settling time.
    pub(super) fn coil_settled(&self, valve: usize, is_so: impl Fn(f64) -> bool) -> bool {
        settled(&self.coils, valve, is_so)
    }

    /// Returns whether coil `valve` got at least `duty_pct`, and the current of it at the nominal voltage, for the settling
    /// time: then the valve is open for an ECU with compensation as for one without.
    pub(super) fn is_open(&self, valve: usize, duty_pct: f64) -> bool {
        settled(&self.coils, valve, |duty| duty >= duty_pct)
            && settled(&self.at_nominal, valve, |duty| duty >= duty_pct)
    }
}

fn settled(coils: &VecDeque<[f64; 2]>, valve: usize, is_so: impl Fn(f64) -> bool) -> bool {
    let settling = bounds::SETTLING as usize;
    coils.len() >= settling && coils.iter().take(settling).all(|coils| is_so(coils[valve]))
}
