#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(test)]
extern crate std;

mod counters;
pub mod crc32;
mod device;
pub mod frame;
pub mod mailbox;
mod message;
mod session;

pub use counters::LinkCounters;
pub use device::Device;
pub use frame::FRAME_MAX;
pub use heapless;
pub use message::{
    Actuators, Answer, BlackBoxPage, BlackBoxRecord, BlackBoxStatus, Identity, ImageIdentity,
    LOG_MAX, LogBytes, MEASURED_MAX, Measured, Name, RECORDS_MAX, Refusal, Reply, Request,
    ResetCause, STATE_WORDS, Sensors, SettingsSource, SignalIds, Telemetry, VALUES_MAX, VERSION,
    Values, name,
};
pub use session::{DeviceSession, Event, HostError, HostSession};
