//! What tells that something is wrong: one detector, one file.
//!
//! Each takes what a sample shows and says which faults are confirmed. N, the number of samples it takes, is a constant in its file;
//! `docs/safety.md` has the table with the reasons. None has a loop, a division or a float.

mod battery;
mod coil;
mod debounce;
mod jump;
mod offset;
mod pressure_input;
mod range;
mod reference;
mod response;
mod sample_time;
mod stuck;

use controller::{Output, Pressure};

pub(crate) use battery::{BATTERY_N, BatteryDetector};
pub(crate) use coil::{COIL_N, CoilDetector};
pub(crate) use debounce::Debounce;
pub(crate) use offset::{OFFSET_N, OffsetDetector};
pub(crate) use pressure_input::PressureInput;
pub(crate) use reference::{REFERENCE_N, ReferenceInput};
pub(crate) use response::{RESPONSE_N, ResponseDetector};
pub(crate) use sample_time::{SAMPLE_TIME_N, SampleTimeDetector};

use crate::config::EcuConfig;
use crate::fault::{Fault, FaultSet};
use crate::input_output::{Inputs, Outputs};
use crate::valve::Valves;

/// All detectors of one ECU but the one of its memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Detectors {
    reference: ReferenceInput,
    pressure: PressureInput,
    response: ResponseDetector,
    offset: OffsetDetector,
    fill_coil: CoilDetector,
    vent_coil: CoilDetector,
    battery: BatteryDetector,
    sample_time: SampleTimeDetector,
}

/// What the valves were told until now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Told {
    pub(crate) valves: Valves,
    /// In the last sample.
    pub(crate) opening: Output,
}

/// What a sample shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Seen {
    /// The chamber pressure; none if this sample's code cannot be believed.
    pub(crate) pressure: Option<Pressure>,
    /// The last valid reference.
    pub(crate) reference: Pressure,
    /// Whether that is this sample's.
    pub(crate) reference_is_new: bool,
    /// The confirmed faults.
    pub(crate) faults: FaultSet,
}

impl Detectors {
    pub(crate) const NEW: Self = Self {
        reference: ReferenceInput::NEW,
        pressure: PressureInput::NEW,
        response: ResponseDetector::NEW,
        offset: OffsetDetector::NEW,
        fill_coil: CoilDetector::NEW,
        vent_coil: CoilDetector::NEW,
        battery: BatteryDetector::NEW,
        sample_time: SampleTimeDetector::NEW,
    };

    /// One sample; `told` is what the valves were told until now.
    #[inline(always)]
    pub(crate) fn sample(&mut self, config: &EcuConfig, told: &Told, inputs: &Inputs) -> Seen {
        let (limits, mechanisms) = (&config.limits, config.mechanisms);
        let reference_is_new =
            self.reference
                .sample(limits, inputs.reference, mechanisms.limit(REFERENCE_N));
        let pressure = self.pressure.sample(config, told.opening, inputs.pressure);
        let bits = pressure.map(Pressure::to_bits);
        self.response
            .sample(limits, &told.valves, bits, mechanisms.limit(RESPONSE_N));
        self.offset
            .sample(limits, &told.valves, bits, mechanisms.limit(OFFSET_N));
        self.fill_coil
            .sample(limits, inputs.current_fill_ma, mechanisms.limit(COIL_N));
        self.vent_coil
            .sample(limits, inputs.current_vent_ma, mechanisms.limit(COIL_N));
        self.battery
            .sample(limits, inputs.battery_mv, mechanisms.limit(BATTERY_N));
        self.sample_time
            .sample(limits, inputs.elapsed_us, mechanisms.limit(SAMPLE_TIME_N));
        Seen {
            pressure,
            reference: self.reference.last(),
            reference_is_new,
            faults: mechanisms.seen(self.faults(config)),
        }
    }

    /// What the coils just got.
    #[inline(always)]
    pub(crate) fn told(&mut self, outputs: Outputs) {
        self.fill_coil.told(outputs.duty_fill);
        self.vent_coil.told(outputs.duty_vent);
    }

    #[inline(always)]
    fn faults(&self, config: &EcuConfig) -> FaultSet {
        let mechanisms = config.mechanisms;
        let coil_limit = mechanisms.limit(COIL_N);
        let fill_coil =
            self.fill_coil
                .faults(Fault::FillCoilOpen, Fault::FillCoilShort, coil_limit);
        let vent_coil =
            self.vent_coil
                .faults(Fault::VentCoilOpen, Fault::VentCoilShort, coil_limit);
        self.reference
            .faults(mechanisms.limit(REFERENCE_N))
            .union(self.pressure.faults(config))
            .union(self.response.faults(mechanisms.limit(RESPONSE_N)))
            .union(self.offset.faults())
            .union(fill_coil)
            .union(vent_coil)
            .union(self.battery.faults(mechanisms.limit(BATTERY_N)))
            .union(self.sample_time.faults(mechanisms.limit(SAMPLE_TIME_N)))
    }
}
