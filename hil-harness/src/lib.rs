#![doc = include_str!("../README.md")]

pub mod checks;
pub mod controller_file;
pub mod device;
pub mod random;
pub mod reference_profile;
pub mod requirement;
pub mod rigs;
pub mod run;
pub mod scenario;
pub mod sensor;
pub mod wire;

pub use checks::{Check, Verdict, judge};
pub use device::{DeviceUnderTest, DutError, InProcess, Telemetry};
pub use reference_profile::ReferenceProfile;
pub use requirement::Requirement;
pub use rigs::scattered;
pub use run::{Run, RunError, run, run_in_process};
pub use scenario::Scenario;
pub use sensor::PressureSensor;
pub use wire::{Actuators, Sensors};
