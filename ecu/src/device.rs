//! ECU with its settings store and its black box, as a device on a link: the same code in the image and in process.

use embedded_storage::nor_flash::NorFlash;
use hil_protocol::{
    Answer, BlackBoxRecord, Device, Identity, ImageIdentity, Measured, Refusal, Reply, Request,
    ResetCause, SettingsSource, SignalIds, VALUES_MAX, VERSION, Values,
};

use crate::black_box::BlackBox;
use crate::calibration::{
    CheckedSettings, SETTING_COUNT, SETTINGS_DIGEST, SIGNAL_COUNT, SIGNALS_DIGEST, SettingValues,
    SignalId, Snapshot,
};
use crate::ecu::Ecu;
use crate::input_output::Inputs;
use crate::store::SettingsStore;

/// ECU, its store in the flash memory `F` and its black box in the words `M`.
///
/// ```text
///  sample ──► Ecu ──► answer              Write ──► shadow copy ──► Apply: checked whole, in effect with the next sample
///              │ └──► black box                                            │
///              └────► signals ──► Measure                               in effect ──► Save: store
/// ```
#[derive(Clone, Debug)]
pub struct EcuDevice<F, M> {
    image: ImageIdentity,
    defaults: CheckedSettings,
    ecu: Ecu,
    cause: ResetCause,
    source: SettingsSource,
    in_effect: CheckedSettings,
    /// Shadow copy that the host writes; none of its values is in effect.
    shadow: SettingValues,
    store: SettingsStore<F>,
    black_box: BlackBox<M>,
    measured: SignalIds,
    last: Option<Snapshot>,
}

impl<F: NorFlash, M: AsRef<[u32]> + AsMut<[u32]>> EcuDevice<F, M> {
    /// Starts the device as after a reset with this cause: settings from the store or, if there are none, `defaults`;
    /// the black box from the content that the reset left. The digests of the tables are filled into `image`.
    pub fn start(
        image: ImageIdentity,
        defaults: &CheckedSettings,
        flash: F,
        memory: M,
        cause: ResetCause,
    ) -> Self {
        let mut store = SettingsStore::new(flash);
        let (in_effect, source) = store.load(defaults);
        Self {
            image: ImageIdentity {
                signals: SIGNALS_DIGEST,
                settings: SETTINGS_DIGEST,
                ..image
            },
            defaults: *defaults,
            ecu: Ecu::new(in_effect.config(), cause),
            cause,
            source,
            in_effect,
            shadow: SettingValues::of(in_effect.settings()),
            store,
            black_box: BlackBox::adopt(memory, cause),
            measured: SignalIds::new(),
            last: None,
        }
    }

    /// Runs one sample, started by the timer or by the link. Returns the duty cycles until the next sample, and
    /// internal values.
    pub fn sample(&mut self, sample: u32, inputs: &Inputs) -> Answer {
        let actuators = self.ecu.sample(inputs).into();
        let telemetry = self.ecu.telemetry();
        self.last = Some(Snapshot {
            sample,
            inputs: *inputs,
            actuators,
            telemetry,
        });
        self.black_box.record(BlackBoxRecord {
            number: 0,
            reference: inputs.reference.map(|reference| reference.to_bits()),
            pressure: inputs.pressure.map(|code| code.bits()),
            duty_fill: actuators.duty_fill,
            duty_vent: actuators.duty_vent,
            control_signal: telemetry.control_signal,
            mode: telemetry.mode,
            faults: telemetry.faults,
        });
        Answer {
            sample,
            actuators,
            telemetry,
        }
    }

    /// Returns the signals that a host measures, after the last sample; `None` if it measures none. Send them
    /// unsolicited where the timer sets the pace.
    pub fn measured(&self) -> Option<Reply> {
        let snapshot = self.last.filter(|_| !self.measured.is_empty())?;
        Some(Reply::Measured {
            sample: snapshot.sample,
            values: self.values(&snapshot),
        })
    }

    /// Returns the settings' memory, with the content that a loss of supply would leave.
    pub fn into_flash(self) -> F {
        self.store.into_flash()
    }

    /// Returns the ECU.
    pub const fn ecu(&self) -> &Ecu {
        &self.ecu
    }

    /// Returns the cause of the last reset.
    pub const fn reset_cause(&self) -> ResetCause {
        self.cause
    }

    /// Returns the source of the settings in effect.
    pub const fn settings_source(&self) -> SettingsSource {
        self.source
    }

    fn values(&self, snapshot: &Snapshot) -> Measured {
        let mut values = Measured::new();
        for id in self.measured.iter().copied().filter_map(SignalId::numbered) {
            // The number of values equals the number of ids, and both lists have the same capacity.
            let _ = values.push(snapshot.signal(id));
        }
        values
    }

    fn signal(&self, id: u16) -> Result<Reply, Refusal> {
        let signal = SignalId::numbered(id).ok_or(unknown_signal(id))?;
        let value = self
            .last
            .map_or(crate::calibration::MISSING, |last| last.signal(signal));
        Ok(Reply::Values {
            first: id,
            values: Values::from_array([value]),
        })
    }

    fn measure(&mut self, ids: &SignalIds) -> Result<Reply, Refusal> {
        match ids.iter().find(|&&id| SignalId::numbered(id).is_none()) {
            Some(&id) => Err(unknown_signal(id)),
            None => {
                self.measured = ids.clone();
                Ok(Reply::Done)
            }
        }
    }

    fn settings(&self, first: u16) -> Result<Reply, Refusal> {
        let values = SettingValues::of(self.in_effect.settings());
        match values.as_array().get(usize::from(first)..) {
            Some(rest) if !rest.is_empty() => Ok(Reply::Values {
                first,
                values: Values::from_slice(rest.get(..VALUES_MAX).unwrap_or(rest))
                    .unwrap_or_default(),
            }),
            _ => Err(Refusal::UnknownSetting {
                id: first,
                last: SETTING_COUNT as u16 - 1,
            }),
        }
    }

    fn apply(&mut self, digest: u32) -> Result<Reply, Refusal> {
        let found = self.shadow.digest();
        if found != digest {
            return Err(Refusal::Torn {
                expected: digest,
                found,
            });
        }
        let settings = self.shadow.checked()?;
        // This happens between two samples: the next one uses all new settings, the last one used none of them.
        self.ecu.retune(settings.config());
        self.in_effect = settings;
        self.shadow = SettingValues::of(settings.settings());
        self.source = SettingsSource::Link;
        Ok(Reply::Done)
    }

    fn save(&mut self) -> Result<Reply, Refusal> {
        if self.last.is_some_and(is_in_use) {
            return Err(Refusal::ValvesInUse);
        }
        let values = SettingValues::of(self.in_effect.settings());
        match self.store.save(&values) {
            Ok(source) => {
                self.source = source;
                Ok(Reply::Done)
            }
            Err(_) => Err(Refusal::Storage),
        }
    }

    /// Restarts the logic as after power-on or a reset. The settings in effect, the measured signals and the memory
    /// stay.
    fn restart(&mut self, cause: ResetCause) -> Reply {
        self.ecu = Ecu::new(self.in_effect.config(), cause);
        self.cause = cause;
        self.last = None;
        self.black_box.reset(cause);
        Reply::Done
    }

    fn carry_out(&mut self, request: &Request) -> Result<Reply, Refusal> {
        match request {
            Request::Sample(sensors) => {
                let answer = self.sample(sensors.sample, &Inputs::from(*sensors));
                let measured = self.last.map_or(Measured::new(), |last| self.values(&last));
                Ok(Reply::Sample { answer, measured })
            }
            Request::Signal { id } => self.signal(*id),
            Request::Measure { ids } => self.measure(ids),
            Request::Settings { first } => self.settings(*first),
            Request::Write { first, values } => {
                self.shadow.set_from(*first, values)?;
                Ok(Reply::Done)
            }
            Request::Apply { digest } => self.apply(*digest),
            Request::Discard => {
                self.shadow = SettingValues::of(self.in_effect.settings());
                Ok(Reply::Done)
            }
            Request::Defaults => {
                self.shadow = SettingValues::of(self.defaults.settings());
                Ok(Reply::Done)
            }
            Request::Save => self.save(),
            Request::BlackBox { page } => self.black_box.page(*page).map(Reply::BlackBox),
            Request::ClearBlackBox => {
                self.black_box.clear();
                Ok(Reply::Done)
            }
            Request::Restart { cause } => Ok(self.restart(*cause)),
            // Requests for the session or for the machine.
            Request::Hello { .. } | Request::Counters | Request::Log | Request::Reset => {
                Err(Refusal::Unsupported)
            }
        }
    }
}

impl<F: NorFlash, M: AsRef<[u32]> + AsMut<[u32]>> Device for EcuDevice<F, M> {
    fn open(&mut self, _lock_step: bool) -> Identity {
        // Values that an earlier host left half written do not belong to this one.
        self.shadow = SettingValues::of(self.in_effect.settings());
        self.measured.clear();
        Identity {
            version: VERSION,
            boot: 0,
            image: self.image.clone(),
            reset_cause: self.cause,
            settings_source: self.source,
            settings_digest: self.shadow.digest(),
        }
    }

    fn answer(&mut self, request: &Request) -> Reply {
        self.carry_out(request).unwrap_or_else(Reply::Refused)
    }
}

const fn unknown_signal(id: u16) -> Refusal {
    Refusal::UnknownSignal {
        id,
        last: SIGNAL_COUNT as u16 - 1,
    }
}

/// Returns whether a coil is driven or a pressure is requested.
fn is_in_use(last: Snapshot) -> bool {
    let asked_for = last
        .inputs
        .reference
        .is_some_and(|reference| reference.to_bits() > 0);
    asked_for || last.actuators.duty_fill != 0 || last.actuators.duty_vent != 0
}
