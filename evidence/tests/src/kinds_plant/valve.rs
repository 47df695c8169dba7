//! Valve of either drive, and the instants at which its commands take effect.

use std::collections::VecDeque;

use super::on_off_valve::{OnOffValve, SwitchingTimes};
use super::orifice::Orifice;
use super::proportional_valve::{Characteristic, ProportionalValve};
use super::rig::ValvePart;

/// Drive of a valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// On or off; a duty cycle is a pulse at the start of each period.
    OnOff(SwitchingTimes),
    /// Opening by the command.
    Proportional(Characteristic),
}

#[derive(Debug, Clone, PartialEq)]
enum Moving {
    OnOff(OnOffValve),
    Proportional(ProportionalValve),
}

/// Valve with its commands on the way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Valve {
    pub(super) orifice: Orifice,
    moving: Moving,
    /// Times (s) at which the output changes, and its values (%).
    outputs: VecDeque<(f64, f64)>,
}

impl Valve {
    pub(super) fn new(part: &ValvePart) -> Self {
        let moving = match part.drive {
            Drive::OnOff(times) => Moving::OnOff(OnOffValve::new(times)),
            Drive::Proportional(characteristic) => {
                Moving::Proportional(ProportionalValve::new(characteristic))
            }
        };
        Self {
            orifice: Orifice::new(&part.open),
            moving,
            outputs: VecDeque::new(),
        }
    }

    /// Gives the command (%) of a period that begins at the output at `begin_s`.
    pub(super) fn begin_period(&mut self, begin_s: f64, period_s: f64, command_pct: f64) {
        if matches!(self.moving, Moving::Proportional(_)) {
            self.outputs.push_back((begin_s, command_pct));
            return;
        }
        let is_on = command_pct > 0.0;
        self.outputs
            .push_back((begin_s, if is_on { 100.0 } else { 0.0 }));
        if is_on && command_pct < 100.0 {
            let end_s = begin_s + period_s * command_pct / 100.0;
            self.outputs.push_back((end_s, 0.0));
        }
    }

    /// Returns the next time (s) after `time_s` at which the law of the open share changes.
    pub(super) fn next_event_s(&self, time_s: f64) -> f64 {
        let output_s = self.outputs.front().map_or(f64::INFINITY, |next| next.0);
        match &self.moving {
            Moving::OnOff(valve) => output_s.min(valve.next_event_s(time_s)),
            Moving::Proportional(_) => output_s,
        }
    }

    /// Applies all changes up to `time_s`; `opening` multiplies the opening delay of an on/off valve.
    pub(super) fn pass(&mut self, time_s: f64, opening: f64) {
        while let Some(&(at_s, output_pct)) = self.outputs.front()
            && at_s <= time_s
        {
            match &mut self.moving {
                Moving::OnOff(valve) => valve.command(at_s, output_pct > 0.0, opening),
                Moving::Proportional(valve) => valve.command(at_s, output_pct),
            }
            self.outputs.pop_front();
        }
        if let Moving::OnOff(valve) = &mut self.moving {
            valve.pass(time_s);
        }
    }

    /// Returns the open share at a time (s), 0 to 1; valid until the next event.
    pub(super) fn open_share(&self, time_s: f64) -> f64 {
        match &self.moving {
            Moving::OnOff(valve) => valve.open_share(time_s),
            Moving::Proportional(valve) => valve.open_share(time_s),
        }
    }
}
