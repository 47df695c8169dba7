//! Measured rigs: plant file, log, and the models that are compared with it.

use std::path::{Path, PathBuf};

use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, by_id};
use recording::Recording;
use recording::csv::{Mapping, Options, read_file};

use crate::fit::{Measured, fit, measured, rms, simulate};

/// Rig with its log.
#[derive(Debug)]
pub(crate) struct Rig {
    /// Description for people.
    pub(crate) title: &'static str,
    /// Name in file names.
    pub(crate) name: &'static str,
    /// File under `data/plants/`, without ending.
    pub(crate) plant: &'static str,
    /// File under `data/real/`, without ending.
    log: &'static str,
    mapping: Option<&'static str>,
    /// Signals, and the size of the error that counts as 1 in the fit.
    weights: &'static [(&'static str, f64)],
    /// Models, from the plainest to the one that explains most.
    models: &'static [Model],
}

/// Model of a rig.
#[derive(Debug)]
struct Model {
    name: &'static str,
    /// Plant file, where it differs from the rig's.
    plant: Option<&'static str>,
    /// Effects and their variants.
    effects: &'static [(&'static str, &'static str)],
    /// Initial values.
    start: &'static [(&'static str, f64)],
    fitted: &'static [&'static str],
}

/// Model after its fit.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// Name of the model.
    pub(crate) model: &'static str,
    /// Plant with the fitted values.
    pub(crate) plant: PlantParameters,
    /// Fitted parameters.
    pub(crate) fitted: &'static [&'static str],
    /// Rms error of each signal, in the unit of the signal.
    pub(crate) rms: Vec<(&'static str, f64)>,
    /// Trace of each signal in the model.
    pub(crate) traces: Vec<Vec<f64>>,
}

const AREA: &str = "effects.chamber_leak.area_m2";
const SHARE: &str = "effects.chamber_leak.laminar_share";
const EXPONENT: &str = "effects.chamber_leak.exponent";
const OFFSET: &str = "effects.sensor_offset.offset_bar";
const DISCHARGE: &str = "flow.discharge_vent";
const WALL: &str = "effects.gas_temperature.wall_heat_transfer_w_per_k";
const CONVECTION: &str = "effects.gas_temperature.convection_w_per_k";
const THERMOMETER: &str = "gas.thermometer_wall_share";
const RESISTANCE: &str = "coil.resistance_20c_ohm";
const CLOSED: &str = "coil.inductance_closed_h";
const OPEN: &str = "coil.inductance_open_h";
const FORCE: &str = "magnet.force_constant_n_m2_per_a2";
const SPRING: &str = "armature.spring_n_per_m";
const STROKE: &str = "armature.stroke_m";

const fn leak(
    name: &'static str,
    effects: &'static [(&'static str, &'static str)],
    fitted: &'static [&'static str],
) -> Model {
    Model {
        name,
        plant: None,
        effects,
        start: &[],
        fitted,
    }
}

const LEAKS: [Model; 4] = [
    leak("orifice", &[("chamber_leak", "orifice")], &[AREA]),
    leak("laminar gap", &[("chamber_leak", "laminar")], &[AREA]),
    leak("mixed", &[("chamber_leak", "mixed")], &[AREA, SHARE]),
    leak("power law", &[("chamber_leak", "power")], &[AREA, EXPONENT]),
];

const COIL_ALONE: Model = Model {
    name: "coil alone",
    plant: None,
    effects: &[],
    start: &[],
    fitted: &[RESISTANCE, CLOSED],
};

/// Every measured rig.
pub(crate) static RIGS: [Rig; 6] = [
    Rig {
        title: "Leak-down of a printed chamber, 0.15 mm layers",
        name: "leakdown-015",
        plant: "leakdown-chamber",
        log: "leakdown-ultimaker-015",
        mapping: Some("leakdown-ultimaker-015"),
        weights: &[("p_ch", 3e-3)],
        models: &LEAKS,
    },
    Rig {
        title: "Leak-down of a printed chamber, 0.20 mm layers",
        name: "leakdown-020",
        plant: "leakdown-chamber",
        log: "leakdown-ultimaker-020",
        mapping: Some("leakdown-ultimaker-020"),
        weights: &[("p_ch", 3e-3)],
        models: &[
            leak("orifice", &[("chamber_leak", "orifice")], &[AREA]),
            leak("laminar gap", &[("chamber_leak", "laminar")], &[AREA]),
            leak("mixed", &[("chamber_leak", "mixed")], &[AREA, SHARE]),
            leak("power law", &[("chamber_leak", "power")], &[AREA, EXPONENT]),
            leak(
                "power law, sensor offset",
                &[("chamber_leak", "power"), ("sensor_offset", "offset")],
                &[AREA, EXPONENT, OFFSET],
            ),
        ],
    },
    Rig {
        title: "Leak-down of an aluminium chamber",
        name: "leakdown-aluminium",
        plant: "leakdown-chamber",
        log: "leakdown-aluminium",
        mapping: None,
        weights: &[("p_ch", 3e-3)],
        models: &[
            leak("tight", &[], &[]),
            Model {
                start: &[(AREA, 1e-10)],
                ..leak("orifice", &[("chamber_leak", "orifice")], &[AREA])
            },
            Model {
                start: &[(AREA, 1e-10)],
                ..leak("laminar gap", &[("chamber_leak", "laminar")], &[AREA])
            },
        ],
    },
    Rig {
        title: "Blow-down of an air vessel through an orifice",
        name: "blowdown",
        plant: "air-vessel-790kPa",
        log: "blowdown-air-790kPa",
        mapping: None,
        weights: &[("p_ch", 0.03), ("t_gas", 1.0)],
        models: &[
            leak("isothermal", &[], &[DISCHARGE]),
            Model {
                start: &[(WALL, 2.0)],
                ..leak(
                    "constant conductance",
                    &[("gas_temperature", "constant_wall")],
                    &[WALL, DISCHARGE],
                )
            },
            Model {
                start: &[(CONVECTION, 4.0)],
                ..leak(
                    "natural convection",
                    &[("gas_temperature", "convection")],
                    &[CONVECTION, DISCHARGE],
                )
            },
            Model {
                start: &[(CONVECTION, 4.0), (THERMOMETER, 0.3)],
                ..leak(
                    "natural convection, thermometer",
                    &[("gas_temperature", "convection")],
                    &[CONVECTION, DISCHARGE, THERMOMETER],
                )
            },
        ],
    },
    Rig {
        title: "Inrush of a valve that switches",
        name: "inrush-switching",
        plant: "burkert-6724-coil",
        log: "inrush-burkert6724-switching",
        mapping: Some("inrush"),
        weights: &[("i_fill", 0.1)],
        models: &[
            COIL_ALONE,
            Model {
                name: "armature moves",
                plant: Some("burkert-6724-valve"),
                effects: &[],
                start: &[],
                fitted: &[RESISTANCE, CLOSED, OPEN, FORCE, SPRING],
            },
        ],
    },
    Rig {
        title: "Inrush of the same valve, blocked",
        name: "inrush-blocked",
        plant: "burkert-6724-coil",
        log: "inrush-burkert6724-blocked",
        mapping: Some("inrush"),
        weights: &[("i_fill", 0.1)],
        models: &[
            COIL_ALONE,
            Model {
                name: "armature moves, on a shorter way",
                plant: Some("burkert-6724-valve"),
                effects: &[],
                start: &[(OPEN, 0.18), (STROKE, 0.12e-3)],
                fitted: &[RESISTANCE, CLOSED, OPEN, STROKE],
            },
        ],
    },
];

/// Returns the path of a file in the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

impl Rig {
    /// Reads the log through its mapping.
    pub(crate) fn log(&self) -> Recording {
        let mapping = self.mapping.map_or_else(Mapping::default, |name| {
            let path = repository(&format!("data/real/{name}.toml"));
            Mapping::read_file(path).unwrap_or_else(|error| panic!("{error}"))
        });
        let options = Options {
            mapping,
            ..Options::default()
        };
        let path = repository(&format!("data/real/{}.csv", self.log));
        read_file(path, &options).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Returns the signals of the log that count in the fit.
    pub(crate) fn measured(&self, log: &Recording) -> Vec<Measured> {
        measured(&plant_file(self.plant), log, self.weights)
    }

    /// Returns every model fitted to the log, in order.
    pub(crate) fn outcomes(&self) -> Vec<Outcome> {
        let log = self.log();
        let measured = self.measured(&log);
        let outcome = |model: &Model| {
            let plant = fit(&self.begin(model), &log, &measured, model.fitted);
            let traces = simulate(&plant, &log, &measured);
            let errors = measured.iter().zip(&traces);
            Outcome {
                model: model.name,
                fitted: model.fitted,
                rms: errors
                    .map(|(signal, trace)| (signal.name, rms(signal, trace)))
                    .collect(),
                plant,
                traces,
            }
        };
        self.models.iter().map(outcome).collect()
    }

    fn begin(&self, model: &Model) -> PlantParameters {
        let mut plant = plant_file(model.plant.unwrap_or(self.plant));
        for (id, variant) in model.effects {
            let effect = by_id(id).expect("an effect of the library");
            let variant = effect
                .about()
                .variant(variant)
                .expect("one of its variants");
            plant = plant.with_effect(EffectSetting::typical_variant(effect, variant));
        }
        for (name, value) in model.start {
            plant
                .set(name, *value, "start of the fit")
                .unwrap_or_else(|error| panic!("{error}"));
        }
        plant
    }
}

pub(crate) fn plant_file(name: &str) -> PlantParameters {
    let path = repository(&format!("data/plants/{name}.toml"));
    let text = std::fs::read_to_string(&path).expect("a plant file of the repository");
    PlantParameters::from_toml(&text, name).unwrap_or_else(|error| panic!("{error}"))
}
