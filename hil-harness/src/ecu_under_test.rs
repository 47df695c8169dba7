//! ECU at the end of a link, and the ECU in this process.

use ecu::black_box;
use ecu::calibration::{CheckedSettings, SettingValues};
use ecu::device::EcuDevice;
use ecu::store::{RamFlash, SettingsStore};
use ecu::{EcuConfig, EcuSettings};
use hil_protocol::{ImageIdentity, Reply, Request, ResetCause, VALUES_MAX, Values, name};

use crate::device::{DeviceUnderTest, DutError, plausible};
use crate::link::{Direct, Link, LinkError};
use crate::wire::{Answer, Sensors};

/// ECU at the end of any link.
#[derive(Clone, Debug)]
pub struct EcuUnderTest<L> {
    link: L,
}

impl<L: Link> EcuUnderTest<L> {
    /// Creates the ECU at the end of this link.
    pub const fn at(link: L) -> Self {
        Self { link }
    }

    /// Returns the link.
    pub const fn link(&self) -> &L {
        &self.link
    }

    /// Returns the link, for requests that a run does not make.
    pub const fn link_mut(&mut self) -> &mut L {
        &mut self.link
    }
}

/// Applies settings, all at once from the next sample on, and does not change the ECU's state.
///
/// # Errors
/// Returns an error if the device cannot be reached or refuses; nothing has changed then.
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

/// Sends a request whose reply is only a confirmation.
///
/// # Errors
/// Returns an error if the device cannot be reached or refuses.
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
        // Here the error names the field that is out of bounds; the device would return its number.
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

/// Number of words of the black box, for the same number of records as the image, so that both read equally.
const BLACK_BOX_WORDS: usize = black_box::words(512);
/// Size of the settings' memory (bytes): two copies.
const FLASH_BYTES: usize = SettingsStore::<RamFlash<0>>::BYTES;

/// ECU with its settings store and black box, outside of any machine.
pub type EcuInProcess = EcuDevice<RamFlash<FLASH_BYTES>, Vec<u32>>;

/// Creates a new ECU, set for the bench.
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

/// Logic of the ECU in this process, with which every other device is compared.
pub type InProcess = EcuUnderTest<Direct<EcuInProcess>>;

impl InProcess {
    /// Creates an ECU that was just switched on.
    pub fn new() -> Self {
        Self::at(Direct::open(ecu_in_process()))
    }
}

impl Default for InProcess {
    fn default() -> Self {
        Self::new()
    }
}
