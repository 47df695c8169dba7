//! Variables of the expression of a user's own effect: states and commands of the plant.

use crate::hooks::Now;
use crate::orifice::NozzleLaw;
use crate::plant::{FILL, Plant, VENT};
use crate::valve::Valve;

/// Variable of an expression.
#[derive(Debug)]
pub struct Variable {
    /// Name in an expression.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Range in which an expression has to be finite.
    pub range: (f64, f64),
    /// Meaning.
    pub about: &'static str,
    pub(super) read: fn(&Now, &Constants) -> f64,
}

/// Constants of a plant that variables need.
#[derive(Debug, Clone)]
pub(super) struct Constants {
    /// Gas temperature (K) where it is no state.
    temperature: f64,
    /// Both valves.
    valves: [Valve; 2],
    /// Law of the flow through an orifice.
    nozzle: NozzleLaw,
}

impl Constants {
    pub(super) fn of(plant: &Plant, temperature_k: f64) -> Self {
        Self {
            temperature: temperature_k,
            valves: plant.valves.clone(),
            nozzle: plant.nozzle.clone(),
        }
    }
}

/// Returns the open share of a valve.
fn open(now: &Now, constants: &Constants, valve: usize) -> f64 {
    let position = now.position[valve];
    let valve = &constants.valves[valve];
    let stroke = valve.armature.stroke;
    if stroke > 0.0 {
        (valve.lift(position) / stroke).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// All variables. A pressure is absolute.
pub static VARIABLES: [Variable; 17] = [
    Variable {
        name: "p",
        unit: "Pa",
        range: (1e4, 2e6),
        about: "chamber pressure, absolute",
        read: |now, _| now.pressure,
    },
    Variable {
        name: "p_supply",
        unit: "Pa",
        range: (1e5, 2e6),
        about: "supply pressure of the plant file, absolute",
        read: |now, _| now.supply_pressure,
    },
    Variable {
        name: "p_ambient",
        unit: "Pa",
        range: (5e4, 1.1e5),
        about: "ambient pressure, absolute",
        read: |now, _| now.ambient_pressure,
    },
    Variable {
        name: "flux_ambient",
        unit: "kg/s/m^2",
        range: (-300.0, 6000.0),
        about: "mass flow of an orifice from the chamber to the surroundings, per effective area",
        read: |now, constants| {
            let nozzle = &constants.nozzle;
            nozzle.mass_flow(1.0, now.pressure, now.ambient_pressure)
        },
    },
    Variable {
        name: "flux_supply",
        unit: "kg/s/m^2",
        range: (-6000.0, 6000.0),
        about: "mass flow of an orifice from the supply to the chamber, per effective area",
        read: |now, constants| {
            let nozzle = &constants.nozzle;
            nozzle.mass_flow(1.0, now.supply_pressure, now.pressure)
        },
    },
    Variable {
        name: "time",
        unit: "s",
        range: (0.0, 1e4),
        about: "time since the start",
        read: |now, _| now.time,
    },
    Variable {
        name: "t_gas",
        unit: "K",
        range: (150.0, 600.0),
        about: "gas temperature in the chamber",
        read: |now, constants| {
            if now.temperature.is_nan() {
                constants.temperature
            } else {
                now.temperature
            }
        },
    },
    Variable {
        name: "i_fill",
        unit: "A",
        range: (0.0, 10.0),
        about: "coil current of the fill valve",
        read: |now, _| now.current[FILL],
    },
    Variable {
        name: "i_vent",
        unit: "A",
        range: (0.0, 10.0),
        about: "coil current of the vent valve",
        read: |now, _| now.current[VENT],
    },
    Variable {
        name: "lift_fill",
        unit: "m",
        range: (0.0, 5e-3),
        about: "armature position of the fill valve, from its rest stop",
        read: |now, _| now.position[FILL],
    },
    Variable {
        name: "lift_vent",
        unit: "m",
        range: (0.0, 5e-3),
        about: "armature position of the vent valve, from its rest stop",
        read: |now, _| now.position[VENT],
    },
    Variable {
        name: "velocity_fill",
        unit: "m/s",
        range: (-10.0, 10.0),
        about: "armature velocity of the fill valve",
        read: |now, _| now.velocity[FILL],
    },
    Variable {
        name: "velocity_vent",
        unit: "m/s",
        range: (-10.0, 10.0),
        about: "armature velocity of the vent valve",
        read: |now, _| now.velocity[VENT],
    },
    Variable {
        name: "open_fill",
        unit: "1",
        range: (0.0, 1.0),
        about: "share of the full opening of the fill valve",
        read: |now, constants| open(now, constants, FILL),
    },
    Variable {
        name: "open_vent",
        unit: "1",
        range: (0.0, 1.0),
        about: "share of the full opening of the vent valve",
        read: |now, constants| open(now, constants, VENT),
    },
    Variable {
        name: "duty_fill",
        unit: "1",
        range: (0.0, 1.0),
        about: "duty cycle of the fill valve in force, after the command delay",
        read: |now, _| now.duty[FILL],
    },
    Variable {
        name: "duty_vent",
        unit: "1",
        range: (0.0, 1.0),
        about: "duty cycle of the vent valve in force, after the command delay",
        read: |now, _| now.duty[VENT],
    },
];

impl Variable {
    /// Returns the variable of a name.
    pub(super) fn named(name: &str) -> Option<&'static Self> {
        VARIABLES.iter().find(|variable| variable.name == name)
    }
}
