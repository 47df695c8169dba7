//! Names of devices on the command line.

use std::path::Path;
use std::str::FromStr;

use ecu::calibration::{SETTINGS_DIGEST, SIGNALS_DIGEST};
use hil_harness::ecu_under_test::{EcuUnderTest, ecu_in_process};
use hil_harness::image::Image;
use hil_harness::image_log::ImageLog;
use hil_harness::link::{
    BAUD_RATE, Framed, Link, LinkError, Loopback, Pace, Patience, SerialPort, Transport,
};
use hil_harness::{DeviceUnderTest, InProcess};
use hil_protocol::{Identity, Measured};
use std::time::Duration;

use crate::failure::Failure;

/// Device and the connection to it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Dut {
    /// ECU logic in this process.
    InProcess,
    /// Image in an emulator.
    Qemu(Option<QemuWire>),
    /// Board on this serial port.
    Serial(String),
}

/// Connection to an emulated device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QemuWire {
    Mailbox,
    Uart,
}

impl FromStr for Dut {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "in-process" => Ok(Self::InProcess),
            None if text == "qemu" => Ok(Self::Qemu(None)),
            Some(("qemu", "mailbox")) => Ok(Self::Qemu(Some(QemuWire::Mailbox))),
            Some(("qemu", "uart")) => Ok(Self::Qemu(Some(QemuWire::Uart))),
            Some(("serial", port)) if !port.is_empty() => Ok(Self::Serial(port.to_owned())),
            _ => Err(
                "expected in-process, qemu, qemu:uart, qemu:mailbox, or serial:PORT such as serial:/dev/ttyACM0"
                    .to_owned(),
            ),
        }
    }
}

/// Timeouts of a board: a frame takes some milliseconds.
const BOARD_PATIENCE: Patience = Patience {
    reply: Duration::from_millis(500),
    tries: 5,
    start: Duration::from_secs(5),
};

impl Dut {
    /// Opens the device in lock step, as the device under test.
    pub(crate) fn under_test(
        &self,
        image: Option<&Path>,
    ) -> Result<Box<dyn DeviceUnderTest>, Failure> {
        Ok(match self {
            Self::InProcess => Box::new(InProcess::new()),
            Self::Qemu(wire) => {
                let wire = wire.unwrap_or(QemuWire::Mailbox);
                Box::new(EcuUnderTest::at(qemu(wire, image, Pace::LockStep)?))
            }
            Self::Serial(port) => Box::new(EcuUnderTest::at(serial(port, image, Pace::LockStep)?)),
        })
    }

    /// Opens a session that runs beside the device's own timer and does not disturb it.
    pub(crate) fn session(&self, image: Option<&Path>) -> Result<Box<dyn Session>, Failure> {
        let session: Box<dyn Session> = match self {
            Self::InProcess => {
                let wire = Loopback::new(ecu_in_process());
                let log = ImageLog::without_texts();
                Box::new(Framed::open(wire, Pace::Timer, BOARD_PATIENCE, log)?)
            }
            Self::Qemu(wire) => {
                let wire = wire.unwrap_or(QemuWire::Uart);
                Box::new(qemu(wire, image, Pace::Timer)?)
            }
            Self::Serial(port) => Box::new(serial(port, image, Pace::Timer)?),
        };
        let image = &session.device().image;
        if (image.signals, image.settings) != (SIGNALS_DIGEST, SETTINGS_DIGEST) {
            return Err(Failure::OtherTables {
                version: image.version.as_str().to_owned(),
            });
        }
        Ok(session)
    }
}

/// Open session with a device.
pub(crate) trait Session: Link {
    /// Returns the identity that the device reported.
    fn device(&self) -> &Identity;

    /// Returns the number and the chosen signals of the next sample.
    fn measured(&mut self) -> Result<(u32, Measured), LinkError>;
}

impl<T: Transport> Session for Framed<T> {
    fn device(&self) -> &Identity {
        Self::device(self)
    }

    fn measured(&mut self) -> Result<(u32, Measured), LinkError> {
        Self::measured(self)
    }
}

fn serial(
    port: &str,
    image: Option<&Path>,
    pace: Pace,
) -> Result<Framed<impl Transport + 'static>, Failure> {
    // A board without the image's file still works; its log then has no texts.
    let log = match (image, Image::find(image)) {
        (_, Ok(image)) => image.into_log(),
        (None, Err(_)) => ImageLog::without_texts(),
        (Some(_), Err(error)) => return Err(error.into()),
    };
    let port = SerialPort::open(port, BAUD_RATE)?;
    Ok(Framed::open(port, pace, BOARD_PATIENCE, log)?)
}

#[cfg(unix)]
fn qemu(
    wire: QemuWire,
    image: Option<&Path>,
    pace: Pace,
) -> Result<Framed<impl Transport + 'static>, Failure> {
    use hil_harness::qemu::{self, Clock, Wire};
    let wire = match wire {
        QemuWire::Mailbox => Wire::Mailbox,
        QemuWire::Uart => Wire::Uart,
    };
    // With its own timer, the image must not depend on the load of this machine.
    let clock = match pace {
        Pace::LockStep => Clock::Host,
        Pace::Timer => Clock::Instructions,
    };
    Ok(qemu::open(Image::find(image)?, wire, clock, pace)?)
}

#[cfg(not(unix))]
fn qemu(
    _: QemuWire,
    _: Option<&Path>,
    _: Pace,
) -> Result<Framed<hil_harness::link::Stream<SerialPort>>, Failure> {
    Err(Failure::NoEmulator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_read_from_their_names_and_nothing_else_is_one() {
        for (text, expected) in [
            ("in-process", Dut::InProcess),
            ("qemu", Dut::Qemu(None)),
            ("qemu:uart", Dut::Qemu(Some(QemuWire::Uart))),
            ("qemu:mailbox", Dut::Qemu(Some(QemuWire::Mailbox))),
            ("serial:COM3", Dut::Serial("COM3".to_owned())),
        ] {
            assert_eq!(text.parse(), Ok(expected));
        }
        for text in ["", "quemu", "qemu:", "serial", "serial:", "in-process:1"] {
            let error = text.parse::<Dut>().unwrap_err();
            assert!(error.contains("serial:PORT"), "{error}");
        }
    }
}
