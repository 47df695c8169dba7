//! Sessions.

mod device;
mod host;

pub use device::DeviceSession;
pub use host::{Event, HostError, HostSession};
