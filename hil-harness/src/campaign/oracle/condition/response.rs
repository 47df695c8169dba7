//! Response of the pressure to the commands of the coils.

use core::mem;

use super::rig::Rig;
use crate::campaign::bounds;
use crate::campaign::oracle::memory::Memory;

/// Too little and too much pressure for the duty cycles of the coils: two cumulative sums of the sensor's pressure.
#[derive(Debug, Default)]
pub(super) struct Response {
    /// Pressure of the previous sample, unless it was implausible (bar gauge).
    before_bar: Option<f64>,
    too_little_bar: f64,
    too_much_bar: f64,
}

impl Response {
    /// Takes one sample with its pressure, if plausible; returns whether there is too little and whether there is too
    /// much.
    pub(super) fn look(&mut self, rig: &Rig, shown_bar: Option<f64>, memory: &Memory) -> [bool; 2] {
        let before_bar = mem::replace(&mut self.before_bar, shown_bar);
        let (Some(shown_bar), Some(before_bar)) = (shown_bar, before_bar) else {
            (self.too_little_bar, self.too_much_bar) = (0.0, 0.0);
            return [false; 2];
        };
        let change_bar = shown_bar - before_bar;
        let [fill_off, vent_off] =
            [0, 1].map(|valve| memory.coil_settled(valve, |duty| duty == 0.0));
        let [fill_open, vent_open] =
            [0, 1].map(|valve| f64::from(u8::from(memory.is_open(valve, rig.open_pct[valve]))));
        let rise_bar = rig.rise * (rig.supply_min_bar - shown_bar).max(0.0) * fill_open;
        let fall_bar = rig.fall * shown_bar.max(0.0) * vent_open;
        self.too_little_bar = summed(
            self.too_little_bar,
            rise_bar - bounds::CREEP_BAR - change_bar,
            vent_off,
        );
        self.too_much_bar = summed(
            self.too_much_bar,
            change_bar + fall_bar - bounds::CREEP_BAR,
            fill_off,
        );
        [self.too_little_bar, self.too_much_bar].map(|sum| sum > bounds::UNEXPLAINED_BAR)
    }
}

/// Returns the sum plus the unexplained change of this sample, or 0 while changes are not counted. It is clamped
/// slightly above the limit, so that it decays soon after the excess has ended.
fn summed(sum: f64, unexplained: f64, counts: bool) -> f64 {
    if counts {
        (sum + unexplained).clamp(0.0, bounds::UNEXPLAINED_BAR + 0.02)
    } else {
        0.0
    }
}
