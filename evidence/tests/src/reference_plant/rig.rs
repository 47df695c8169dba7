//! Concrete plant: the datasheet's values as scattered on this rig, and its departures.

use serde::{Deserialize, Serialize};

use super::datasheet::Datasheet;
use super::departures::Departures;

/// Concrete rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// True values, in the keys of the datasheet.
    pub datasheet: Datasheet,
    /// Departures from the plain plant.
    pub departures: Departures,
    /// Whether the vent valve is open without current.
    pub is_vent_normally_open: bool,
}

/// Name and half width of each scattered quantity: relative, except for the delay (s) and the supply pressure (bar).
pub const SCATTERED: [(&str, f64); 10] = [
    ("discharge_fill", 0.08),
    ("discharge_vent", 0.08),
    ("preload_fill", 0.03),
    ("preload_vent", 0.03),
    ("resistance", 0.03),
    ("inductance", 0.06),
    ("volume", 0.03),
    ("spring", 0.05),
    ("command_delay_s", 1.5e-3),
    ("supply_pressure_bar", 0.15),
];

/// Position of a rig within the scatter, each in -1 to 1, in the order of [`SCATTERED`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Scatter(pub [f64; SCATTERED.len()]);

impl Rig {
    /// Returns the plain plant of the datasheet.
    pub fn nominal() -> Self {
        Self {
            datasheet: Datasheet::bundled(),
            departures: Departures::default(),
            is_vent_normally_open: false,
        }
    }

    /// Returns the same rig with other departures.
    pub fn with(&self, departures: Departures) -> Self {
        Self {
            departures,
            ..self.clone()
        }
    }

    /// Returns the same rig, with its values moved by `scatter`.
    pub fn scattered(&self, scatter: &Scatter) -> Self {
        let moved = |n: usize| SCATTERED[n].1 * scatter.0[n];
        let mut rig = self.clone();
        let sheet = &mut rig.datasheet;
        sheet.flow.discharge_fill *= 1.0 + moved(0);
        sheet.flow.discharge_vent *= 1.0 + moved(1);
        sheet.armature.preload_fill_n *= 1.0 + moved(2);
        sheet.armature.preload_vent_n *= 1.0 + moved(3);
        sheet.coil.resistance_20c_ohm *= 1.0 + moved(4);
        sheet.coil.inductance_closed_h *= 1.0 + moved(5);
        sheet.coil.inductance_open_h *= 1.0 + moved(5);
        sheet.chamber.volume_m3 *= 1.0 + moved(6);
        sheet.armature.spring_n_per_m *= 1.0 + moved(7);
        sheet.ecu.command_delay_s += moved(8);
        sheet.gas.supply_pressure_bar_gauge += moved(9);
        rig
    }
}
