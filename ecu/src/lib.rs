#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(all(feature = "fault-seeding", target_os = "none"))]
compile_error!(
    "`fault-seeding` takes safety mechanisms away, for tests on a host: no image is built with it"
);

// The tests of the supervisor use the same bench inside the crate, where mechanisms can be removed, and outside of it.
#[cfg(test)]
use crate as api;
#[cfg(test)]
extern crate std;

#[cfg(test)]
#[path = "../tests/supervision/bench.rs"]
#[allow(dead_code, reason = "the tests outside use more of it")]
mod bench;
pub mod black_box;
pub mod calibration;
mod checked_loop;
mod coil_resistance;
mod config;
mod counted;
mod detector;
pub mod device;
mod digest;
mod duty_scales;
mod ecu;
mod error;
mod fault;
mod history;
mod input_output;
mod mechanism;
mod mode;
mod sensor;
mod settings;
pub mod store;
mod supervisor;
mod table;
mod valve;

pub use checked_loop::{CheckedLoop, CheckedLoopConfig, LoopTelemetry};
pub use config::EcuConfig;
pub use controller;
pub use ecu::Ecu;
pub use error::EcuConfigError;
pub use fault::{Fault, FaultReaction, FaultSet};
pub use hil_protocol::{ResetCause, Telemetry};
pub use input_output::{Inputs, Outputs, safe_outputs};
#[cfg(any(test, feature = "fault-seeding"))]
pub use mechanism::Damage;
pub use mechanism::Mechanism;
pub use mode::Mode;
pub use sensor::{PressureSensor, SensorCode};
pub use settings::{EcuSettings, Supervision, VentValve};
pub use supervisor::ReleaseRefused;
pub use table::EcuField;
