//! Points of a plant on which a user's own effect acts.

use crate::description::EntryPoint;
use crate::hooks::{Hooks, Now};
use crate::plant::{FILL, Plant, VENT};

/// Point of a plant on which a user's own effect acts.
#[derive(Debug)]
pub struct Point {
    /// Name in a plant file, `acts_on = "leak_flow"`.
    pub name: &'static str,
    /// Meaning of the value of the expression.
    pub about: &'static str,
    /// Unit of the value; `1` for a factor.
    pub unit: &'static str,
    /// Value without effect: 0 for what is added, 1 for a factor.
    pub neutral: f64,
    /// Smallest value that is physically possible.
    pub least: f64,
    /// Part of the plant, for people and for a diagnosis.
    pub(super) entry: EntryPoint,
    /// Adds the law to a plant.
    pub(super) add: fn(BoundLaw, &mut Plant),
}

/// Law with its parameters.
pub(super) type BoundLaw = Box<dyn Fn(&Now) -> f64 + Send + Sync>;

/// Smallest factor of a volume or a resistance: both stay positive.
const LEAST_FACTOR: f64 = 0.01;

/// All points.
pub static POINTS: [Point; 9] = [
    Point {
        name: "leak_flow",
        about: "mass flow from the chamber to the surroundings, added",
        unit: "kg/s",
        neutral: 0.0,
        least: f64::NEG_INFINITY,
        entry: EntryPoint::Leak,
        add: |law, plant| hooks(plant).add_inflow(move |now| -law(now)),
    },
    Point {
        name: "fill_area",
        about: "factor of the area of the fill valve",
        unit: "1",
        neutral: 1.0,
        least: 0.0,
        entry: EntryPoint::Flow,
        add: |law, plant| hooks(plant).add_area_factor(FILL, law),
    },
    Point {
        name: "vent_area",
        about: "factor of the area of the vent valve",
        unit: "1",
        neutral: 1.0,
        least: 0.0,
        entry: EntryPoint::Flow,
        add: |law, plant| hooks(plant).add_area_factor(VENT, law),
    },
    Point {
        name: "sensor_output",
        about: "pressure that the sensor shows too much, added",
        unit: "Pa",
        neutral: 0.0,
        least: f64::NEG_INFINITY,
        entry: EntryPoint::Sensor,
        add: |law, plant| hooks(plant).add_measured(law),
    },
    Point {
        name: "supply_pressure",
        about: "pressure added to that of the supply",
        unit: "Pa",
        neutral: 0.0,
        least: f64::NEG_INFINITY,
        entry: EntryPoint::AirSupply,
        add: |law, plant| hooks(plant).add_supply_pressure(above_vacuum(law)),
    },
    Point {
        name: "coil_resistance",
        about: "factor of the resistance of both coils, as they are installed",
        unit: "1",
        neutral: 1.0,
        least: LEAST_FACTOR,
        entry: EntryPoint::Coil,
        add: add_resistance,
    },
    Point {
        name: "fill_force",
        about: "force on the armature of the fill valve, added; positive opens it",
        unit: "N",
        neutral: 0.0,
        least: f64::NEG_INFINITY,
        entry: EntryPoint::Armature,
        add: |law, plant| hooks(plant).add_force(FILL, law),
    },
    Point {
        name: "vent_force",
        about: "force on the armature of the vent valve, added; positive opens it",
        unit: "N",
        neutral: 0.0,
        least: f64::NEG_INFINITY,
        entry: EntryPoint::Armature,
        add: |law, plant| hooks(plant).add_force(VENT, law),
    },
    Point {
        name: "chamber_volume",
        about: "factor of the chamber's volume, from `p`, `p_supply`, `p_ambient` and `time` alone",
        unit: "1",
        neutral: 1.0,
        least: LEAST_FACTOR,
        entry: EntryPoint::Volume,
        add: |law, plant| hooks(plant).add_volume_factor(law),
    },
];

impl Point {
    /// Returns the point of a name.
    pub(super) fn named(name: &str) -> Option<&'static Self> {
        POINTS.iter().find(|point| point.name == name)
    }

    pub(super) fn is_volume(&self) -> bool {
        self.name == "chamber_volume"
    }

    /// Returns whether the expression may use a variable: the growth of a volume is known from the pressure and the
    /// time alone.
    pub(super) fn admits(&self, variable: &str) -> bool {
        !self.is_volume() || ["p", "p_supply", "p_ambient", "time"].contains(&variable)
    }
}

fn hooks(plant: &mut Plant) -> &mut Hooks {
    &mut plant.additions.hooks
}

/// Returns a law that aborts the simulation where the supply would be below vacuum.
fn above_vacuum(law: BoundLaw) -> BoundLaw {
    Box::new(move |now| {
        let more = law(now);
        if now.supply_pressure + more > 0.0 {
            more
        } else {
            f64::NAN
        }
    })
}

/// Adds a factor f of the resistance R of both coils: the voltage -(f - 1) R i in the loop of each.
fn add_resistance(law: BoundLaw, plant: &mut Plant) {
    let law = std::sync::Arc::new(law);
    for valve in [FILL, VENT] {
        let (law, resistance) = (law.clone(), plant.valves[valve].coil.resistance);
        hooks(plant).add_voltage(valve, move |now| {
            -(law(now) - 1.0) * resistance * now.current[valve]
        });
    }
}
