#![doc = include_str!("../README.md")]

pub mod campaign;
pub mod checks;
pub mod compared;
pub mod controller_file;
pub mod device;
mod difference;
pub mod ecu_under_test;
pub mod image;
pub mod image_log;
pub mod lead_in;
pub mod link;
#[cfg(unix)]
pub mod qemu;
pub mod random;
pub mod reference_profile;
pub mod requirement;
pub mod rigs;
pub mod run;
pub mod scenario;
pub mod sensor;
pub mod sensor_walk;
pub mod settling_times;
pub mod signals;
pub mod supervision;
mod trace;
pub mod wire;
pub mod world;

pub use checks::{Check, Verdict, judge};
pub use compared::Compared;
pub use device::{DeviceUnderTest, DutError};
pub use difference::Difference;
pub use ecu_under_test::InProcess;
pub use reference_profile::ReferenceProfile;
pub use requirement::Requirement;
pub use rigs::scattered;
pub use run::{Run, RunError, run, run_in_process, run_watched};
pub use scenario::Scenario;
pub use settling_times::SettlingTimes;
pub use trace::NotRecorded;
pub use wire::{Actuators, Answer, Exchange, Sensors, Telemetry};
