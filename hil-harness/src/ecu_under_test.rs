//! An ECU at the end of a link, and the one in this process.

use ecu::black_box;
use ecu::calibration::{CheckedSettings, SettingValues};
use ecu::device::EcuDevice;
use ecu::store::{RamFlash, SettingsStore};
use ecu::{EcuConfig, EcuSettings};
use hil_protocol::{ImageIdentity, Reply, Request, ResetCause, VALUES_MAX, Values, name};

use crate::device::{DeviceUnderTest, DutError, plausible};
use crate::link::{Direct, Link, LinkError};
use crate::wire::{Answer, Sensors};

/// An ECU at the end of a link, whatever the link is.
#[derive(Clone, Debug)]
pub struct EcuUnderTest<L> {
    link: L,
}

impl<L: Link> EcuUnderTest<L> {
    /// The ECU at the end of this link.
    pub const fn at(link: L) -> Self {
        Self { link }
    }

    /// The link.
    pub const fn link(&self) -> &L {
        &self.link
    }

    /// The link, to ask what a run does not ask.
    pub const fn link_mut(&mut self) -> &mut L {
        &mut self.link
    }
}

/// Puts settings into effect, whole and with the next sample, and leaves the ECU's state as it is.
///
/// # Errors
/// The device cannot be reached, or refuses: then nothing has changed.
pub fn set(link: &mut (impl Link + ?Sized), settings: &SettingValues) -> Result<(), LinkError> {
    let mut first = 0;
    for chunk in settings.as_array().chunks(VALUES_MAX) {
        let values = Values::from_iter(chunk.iter().copied());
        carry_out(link, &Request::Write { first, values })?;
        first += chunk.len() as u16;
    }
    let digest = settings.digest();
    carry_out(link, &Request::Apply { digest })
}

/// Asks for what has no answer but that it was done.
///
/// # Errors
/// The device cannot be reached, or refuses.
pub fn carry_out(link: &mut (impl Link + ?Sized), request: &Request) -> Result<(), LinkError> {
    match link.ask(request)? {
        Reply::Done => Ok(()),
        other => Err(LinkError::unexpected(request, &other)),
    }
}

impl<L: Link> DeviceUnderTest for EcuUnderTest<L> {
    fn identity(&self) -> String {
        self.link.identity()
    }

    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError> {
        // Here the field that is out of bounds has its name; the device would say its number.
        EcuConfig::new(settings)?;
        set(&mut self.link, &SettingValues::of(settings))?;
        let cause = ResetCause::PowerOn;
        carry_out(&mut self.link, &Request::Restart { cause })?;
        Ok(carry_out(&mut self.link, &Request::ClearBlackBox)?)
    }

    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
        let request = Request::Sample(*sensors);
        match self.link.ask(&request)? {
            Reply::Sample { answer, .. } => plausible(sensors, answer),
            other => Err(LinkError::unexpected(&request, &other).into()),
        }
    }

    fn take_log(&mut self) -> Result<Vec<String>, DutError> {
        Ok(self.link.take_log()?)
    }
}

/// Words of the black box: as many records as the image keeps, so that the two read the same.
const BLACK_BOX_WORDS: usize = black_box::words(512);
/// Bytes of the settings' memory: two copies.
const FLASH_BYTES: usize = SettingsStore::<RamFlash<0>>::BYTES;

/// The ECU with its settings store and black box, outside of any machine.
pub type EcuInProcess = EcuDevice<RamFlash<FLASH_BYTES>, Vec<u32>>;

/// An ECU as it leaves the factory, set for the bench.
pub fn ecu_in_process() -> EcuInProcess {
    const BENCH: CheckedSettings = match CheckedSettings::new(&EcuSettings::bench()) {
        Ok(settings) => settings,
        Err(_) => panic!("the settings of the bench are impossible"),
    };
    let image = ImageIdentity {
        board: name("in process"),
        version: name(env!("CARGO_PKG_VERSION")),
        build: 0,
        signals: 0,
        settings: 0,
    };
    let memory = vec![0; BLACK_BOX_WORDS];
    EcuDevice::start(image, &BENCH, RamFlash::new(), memory, ResetCause::PowerOn)
}

/// The ECU's logic in this process: what every other device is compared with.
pub type InProcess = EcuUnderTest<Direct<EcuInProcess>>;

impl InProcess {
    /// An ECU that was just switched on.
    pub fn new() -> Self {
        Self::at(Direct::open(ecu_in_process()))
    }
}

impl Default for InProcess {
    fn default() -> Self {
        Self::new()
    }
}
