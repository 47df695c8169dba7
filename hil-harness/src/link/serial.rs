//! Board on a serial port.

use std::io;
use std::time::Duration;

use super::transport::{Stream, TimedStream};

/// Serial port with its time limit.
pub struct SerialPort(Box<dyn serialport::SerialPort>);

/// Bit rate of the boards (bit/s), as in `firmware/src/boards`.
pub const BAUD_RATE: u32 = 921_600;

/// Error: a serial port cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("serial port {port}: {reason}; check its name, its rights, and that nobody else uses it")]
pub struct SerialError {
    /// Name of the port.
    port: String,
    /// Error of the operating system.
    reason: String,
}

impl SerialPort {
    /// Opens the port of this name, such as `/dev/ttyACM0` or `COM3`, with eight bits and no parity.
    ///
    /// # Errors
    /// Returns an error if there is no such port, or it is in use.
    pub fn open(name: &str, baud_rate: u32) -> Result<Stream<Self>, SerialError> {
        let opened = serialport::new(name, baud_rate).open();
        let port = opened.map_err(|error| SerialError {
            port: name.to_owned(),
            reason: error.to_string(),
        })?;
        Ok(Stream::new(format!("serial port {name}"), Self(port)))
    }
}

impl io::Read for SerialPort {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl io::Write for SerialPort {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl TimedStream for SerialPort {
    fn set_time_limit(&mut self, limit: Duration) -> io::Result<()> {
        Ok(self.0.set_timeout(limit)?)
    }
}
