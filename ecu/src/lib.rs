#![doc = include_str!("../README.md")]
#![no_std]

pub mod black_box;
pub mod calibration;
mod config;
pub mod device;
mod ecu;
mod error;
mod fault;
mod input_output;
mod mode;
mod sensor;
mod settings;
pub mod store;

pub use config::EcuConfig;
pub use controller;
pub use ecu::Ecu;
pub use error::{EcuConfigError, SupervisionField};
pub use fault::{Fault, FaultSet};
pub use hil_protocol::{ResetCause, Telemetry};
pub use input_output::{Inputs, Outputs, safe_outputs};
pub use mode::Mode;
pub use sensor::{PressureSensor, SensorCode};
pub use settings::{EcuSettings, Supervision, VentValve};
