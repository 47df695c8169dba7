#![doc = include_str!("../README.md")]

pub mod additions;
pub mod armature;
pub mod chamber;
pub mod coil;
mod description;
pub mod ecu_output;
pub mod effects;
pub mod experiment;
pub mod hooks;
pub mod linearisation;
pub mod logger_clock;
pub mod magnet;
pub mod on_off_valve;
pub mod orifice;
pub mod own_effects;
pub mod parameters;
pub mod plant;
pub mod proportional_valve;
pub mod regulating_valve;
pub mod replay;
mod response;
pub mod resting_pressure;
pub mod restriction;
mod simulator;
mod solver;
pub mod subsonic_curves;
pub mod toml_file;
pub mod valve;

pub use ecu_output::Command;
pub use parameters::{ParameterError, PlantParameters};
pub use simulator::{EffectState, Sample, Simulator, Statistics, Tolerance};
