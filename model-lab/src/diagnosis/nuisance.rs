//! What differs from rig to rig without any physics missing: the datasheet's tolerances.

use plant_sim::PlantParameters;
use plant_sim::parameters::ParameterSpec;

/// A parameter that every fit may move within the tolerance of the datasheet.
#[derive(Debug)]
pub(crate) struct Nuisance {
    /// Name in a plant file.
    pub(crate) name: &'static str,
    /// Parameters that move in proportion with it.
    pub(crate) together_with: &'static [&'static str],
    pub(crate) tolerance: Tolerance,
    /// Signals that show it.
    pub(crate) shown_by: Shown,
}

/// How far from its datasheet value a part may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Tolerance {
    /// Share of the datasheet value.
    Relative(f64),
    /// In the unit of the parameter.
    Absolute(f64),
}

/// What has to be logged for it to matter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shown {
    Always,
    /// By the chamber pressure alone.
    InPressure,
}

const fn relative(name: &'static str, tolerance: f64, shown_by: Shown) -> Nuisance {
    Nuisance {
        name,
        together_with: &[],
        tolerance: Tolerance::Relative(tolerance),
        shown_by,
    }
}

/// Usual tolerances of parts: machined orifices 10 %, wound springs 5 to 8 %, copper coils 5 %, a machined volume
/// 4 %, magnetic circuits 8 %; the delay of an output stage, and a pressure regulator with its gauge.
pub(crate) static NUISANCES: [Nuisance; 10] = [
    relative("flow.discharge_fill", 0.10, Shown::InPressure),
    relative("flow.discharge_vent", 0.10, Shown::InPressure),
    relative("chamber.volume_m3", 0.04, Shown::InPressure),
    Nuisance {
        name: "gas.supply_pressure_bar_gauge",
        together_with: &[],
        tolerance: Tolerance::Absolute(0.2),
        shown_by: Shown::InPressure,
    },
    Nuisance {
        name: "ecu.command_delay_s",
        together_with: &[],
        tolerance: Tolerance::Absolute(2e-3),
        shown_by: Shown::Always,
    },
    relative("coil.resistance_20c_ohm", 0.05, Shown::Always),
    Nuisance {
        name: "coil.inductance_closed_h",
        together_with: &["coil.inductance_open_h"],
        tolerance: Tolerance::Relative(0.08),
        shown_by: Shown::Always,
    },
    relative("armature.preload_fill_n", 0.05, Shown::Always),
    relative("armature.preload_vent_n", 0.05, Shown::Always),
    relative("armature.spring_n_per_m", 0.08, Shown::Always),
];

impl Nuisance {
    /// The tolerance in the unit of the parameter.
    pub(crate) fn tolerance_of(&self, datasheet: f64) -> f64 {
        match self.tolerance {
            Tolerance::Relative(share) => share * datasheet.abs(),
            Tolerance::Absolute(tolerance) => tolerance,
        }
    }

    /// Sets it to `value`, and what moves with it in proportion.
    pub(crate) fn set(&self, plant: &mut PlantParameters, datasheet: &PlantParameters, value: f64) {
        let spec = |name| ParameterSpec::by_name(name).zip(datasheet.get(name));
        let Some((own, nominal)) = spec(self.name) else {
            return;
        };
        own.put(plant, value);
        for (other, there) in self.together_with.iter().copied().filter_map(spec) {
            other.put(plant, there * (value / nominal));
        }
    }
}
