//! Values of a rig.

use super::hidden::HiddenEffects;
use super::hose::Walls;
use super::inputs::Swing;
use super::orifice::Conductance;
use super::valve::Drive;

/// Rig with two valves, one chamber or two, and the effects that it hides.
#[derive(Debug, Clone, PartialEq)]
pub struct KindRig {
    /// Supply pressure (Pa abs).
    pub supply_pa: f64,
    /// Ambient pressure, also of the drain (Pa abs).
    pub ambient_pa: f64,
    /// Temperature of supply, walls and surroundings (K).
    pub temperature_k: f64,
    /// Pressure of all chambers at the beginning (Pa abs).
    pub start_pa: f64,
    /// Period of the commands and of the PWM (s).
    pub command_period_s: f64,
    /// Delay from a command to both outputs (s).
    pub command_delay_s: f64,
    /// Volume of the first chamber at ambient pressure (m³).
    pub chamber_m3: f64,
    /// Walls of the first chamber.
    pub walls: Walls,
    /// Second chamber, if there is one.
    pub second: Option<SecondChamber>,
    /// Fill valve and vent valve, both at the first chamber.
    pub valves: [ValvePart; 2],
    /// Position of an actuator (m).
    pub actuator: Swing,
    /// Supply voltage (V).
    pub voltage: Swing,
    /// Hidden effects.
    pub hidden: HiddenEffects,
}

/// Rigid chamber behind a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondChamber {
    /// Volume (m³).
    pub volume_m3: f64,
    /// Line from the first chamber.
    pub line: Conductance,
}

/// Valve of a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValvePart {
    /// Conductance of the open valve.
    pub open: Conductance,
    /// Drive of the valve.
    pub drive: Drive,
}

impl KindRig {
    /// Returns the volume of all chambers at ambient pressure (m³).
    pub fn volume_m3(&self) -> f64 {
        self.chamber_m3 + self.second.map_or(0.0, |second| second.volume_m3)
    }
}
