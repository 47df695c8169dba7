//! Image on its emulated machine as a target: its coils are the compare values of its PWM, and its memory can be
//! damaged.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use ecu::calibration::SettingValues;
use ecu::{EcuSettings, Mode};
use hil_protocol::{FRAME_MAX, Request, ResetCause, mailbox};

use super::class::FaultClass;
use super::fault::ecu::EcuFault;
use super::target::{Accident, Reaction, Target};
use crate::device::{DeviceUnderTest as _, DutError};
use crate::ecu_under_test::{EcuUnderTest, carry_out, set};
use crate::image::{Image, ImageError};
use crate::link::{Framed, LinkError, Pace, Patience, Transport, TransportError};
use crate::qemu::{Clock, QemuError, QemuLink, Wire};
use crate::wire::{Actuators, Answer, FULL_DUTY, Sensors};

/// Reason why there is no emulated target.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EmulatedError {
    /// There is no image.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The emulator does not start.
    #[error(transparent)]
    Qemu(Box<QemuError>),
    /// The image does not answer.
    #[error(transparent)]
    Link(#[from] LinkError),
}

impl From<QemuError> for EmulatedError {
    fn from(error: QemuError) -> Self {
        Self::Qemu(Box::new(error))
    }
}

/// Image in the emulator.
#[derive(Debug)]
pub struct EmulatedTarget {
    image: Option<PathBuf>,
    machine: Machine,
    settings: EcuSettings,
    mode: u8,
    /// Whether damage remains that the start of a session does not repair.
    is_hurt: bool,
}

/// Machine, and a session with its image.
#[derive(Debug)]
struct Machine {
    link: Shared,
    device: EcuUnderTest<Framed<Shared>>,
}

/// Link of a machine, shared by its consecutive sessions.
#[derive(Clone, Debug)]
struct Shared(Rc<RefCell<QemuLink>>);

impl Transport for Shared {
    fn name(&self) -> String {
        self.0.borrow().name()
    }

    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError> {
        self.0.borrow_mut().send(frame, deadline)
    }

    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError> {
        self.0.borrow_mut().receive(buffer, deadline)
    }

    fn last_words(&self) -> Vec<String> {
        self.0.borrow().last_words()
    }
}

/// Timeouts: a damaged machine may be silent until its watchdog resets it, 10 s while a host sets the pace.
const PATIENCE: Patience = Patience {
    reply: Duration::from_secs(2),
    tries: 2,
    start: Duration::from_secs(60),
};
/// Address of the image's variables, and number of their bytes in which bits are flipped.
const VARIABLES: (usize, u64) = (mailbox::ADDRESS + 0x1_0000, 0x1800);
/// Used part of the stack, from its end upwards: the image's and the ECU's state are there.
const STACK: (usize, u64) = (
    mailbox::ADDRESS + 0x3_0000 - STACK_BYTES as usize,
    STACK_BYTES,
);
const STACK_BYTES: u64 = 12 << 10;
/// Address and values of a request for an accident (`firmware/src/boards/mps2_an386/pins.rs`).
const ACCIDENT: usize = mailbox::ADDRESS + 0x1000 + 4 * 17;
const HANG: u32 = u32::from_be_bytes(*b"hang");
const TRAP: u32 = u32::from_be_bytes(*b"trap");
/// Compare value of a PWM that is always on.
const COMPARE_FULL: u64 = 65_535;

impl Machine {
    fn start(image: Option<&Path>) -> Result<Self, EmulatedError> {
        let image = Image::find(image)?;
        let link = QemuLink::start(&image, Wire::Mailbox, Clock::Host)?;
        let link = Shared(Rc::new(RefCell::new(link)));
        Ok(Self {
            device: session(link.clone(), image)?,
            link,
        })
    }

    fn coils(&self) -> Actuators {
        let values = self.link.0.borrow().compare_values();
        let [duty_fill, duty_vent] =
            values.map(|value| (u64::from(value) * u64::from(FULL_DUTY) / COMPARE_FULL) as u32);
        Actuators {
            duty_fill,
            duty_vent,
        }
    }

    fn flip(&self, (address, bytes): (usize, u64), draw: u64) {
        let word = address + 4 * (draw % (bytes / 4)) as usize;
        if let Some(word) = self.link.0.borrow().memory().word_at(word) {
            word.fetch_xor(1 << (draw >> 32 & 31), Ordering::AcqRel);
        }
    }

    fn have(&self, accident: u32) {
        if let Some(word) = self.link.0.borrow().memory().word_at(ACCIDENT) {
            word.store(accident, Ordering::Release);
        }
    }
}

fn session(link: Shared, image: Image) -> Result<EcuUnderTest<Framed<Shared>>, LinkError> {
    Framed::open(link, Pace::LockStep, PATIENCE, image.into_log()).map(EcuUnderTest::at)
}

impl EmulatedTarget {
    /// Starts the image in this file, or the one built by `cargo xtask image`.
    ///
    /// # Errors
    /// Returns an error if there is no image, or it does not start.
    pub fn start(image: Option<&Path>) -> Result<Self, EmulatedError> {
        Ok(Self {
            machine: Machine::start(image)?,
            image: image.map(Path::to_owned),
            settings: EcuSettings::bench(),
            mode: Mode::Waiting as u8,
            is_hurt: false,
        })
    }

    /// Opens a session with the image after it has restarted, with its previous settings.
    fn reopen(&mut self) -> Result<(), DutError> {
        let image = Image::find(self.image.as_deref()).map_err(|error| gone(&error))?;
        self.machine.device = session(self.machine.link.clone(), image)?;
        let link = self.machine.device.link_mut();
        set(link, &SettingValues::of(&self.settings))?;
        let cause = ResetCause::Watchdog;
        Ok(carry_out(link, &Request::Restart { cause })?)
    }
}

fn gone(error: &dyn core::error::Error) -> DutError {
    let error = std::io::Error::other(error.to_string());
    DutError::Link(LinkError::Transport {
        request: "the start of another machine".to_owned(),
        error: TransportError::Io(error),
        said: crate::link::LastWords(Vec::new()),
    })
}

impl Target for EmulatedTarget {
    fn identity(&self) -> String {
        self.machine.device.identity()
    }

    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError> {
        if self.is_hurt {
            self.machine = Machine::start(self.image.as_deref()).map_err(|error| gone(&error))?;
            self.is_hurt = false;
        }
        self.settings = *settings;
        self.machine.device.start(settings)
    }

    fn exchange(&mut self, sensors: &Sensors) -> Result<Reaction, DutError> {
        match self.machine.device.exchange(sensors) {
            Ok(answer) => {
                self.mode = answer.telemetry.mode;
                let actuators = self.machine.coils();
                Ok(Reaction::Answer(Answer {
                    actuators,
                    ..answer
                }))
            }
            Err(_) if self.is_hurt => {
                self.reopen()?;
                Ok(Reaction::Reset(self.machine.coils()))
            }
            Err(error) => Err(error),
        }
    }

    fn restart(&mut self) -> Result<(), DutError> {
        // A damaged image may not receive it; then its watchdog resets it.
        let asked = carry_out(self.machine.device.link_mut(), &Request::Reset);
        if !self.is_hurt {
            asked?;
        }
        self.reopen()
    }

    /// Releases by a reset: the mechanic switches the supply off and on.
    fn release(&mut self) -> Result<bool, DutError> {
        let is_stuck = self.is_hurt || self.mode == Mode::Locked as u8;
        if is_stuck {
            self.restart()?;
        }
        Ok(is_stuck)
    }

    fn breaks(&self, class: FaultClass) -> bool {
        !matches!(class, FaultClass::Ecu(fault) if EcuFault::DAMAGES.contains(&fault))
    }

    fn suffer(&mut self, accident: Accident) -> Result<(), DutError> {
        self.is_hurt = true;
        match accident {
            Accident::FlippedVariable(draw) => self.machine.flip(VARIABLES, draw),
            Accident::FlippedStack(draw) => self.machine.flip(STACK, draw),
            Accident::Hang => self.machine.have(HANG),
            Accident::Trap => self.machine.have(TRAP),
        }
        Ok(())
    }
}
