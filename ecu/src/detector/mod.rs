//! Fault detectors, one per file.
//!
//! Each detector takes the data of a sample and returns the confirmed faults. N, the number of samples for a
//! confirmation, is that of the table in `fault.rs`. No detector has a loop, a division or a float.

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

pub(crate) use debounce::Debounce;
pub(crate) use pressure_input::PressureInput;

use battery::BatteryDetector;
use coil::CoilDetector;
use offset::OffsetDetector;
use reference::ReferenceInput;
use response::ResponseDetector;
use sample_time::SampleTimeDetector;

use crate::config::Limits;
use crate::fault::{Fault, FaultSet};
use crate::input_output::{Inputs, Outputs};
use crate::valve::Valves;

/// All detectors of one ECU except the one of its memory.
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

/// Commands to the valves until now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Command {
    pub(crate) valves: Valves,
    /// Valve opening in the last sample.
    pub(crate) opening: Output,
}

/// Observations of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Observation {
    /// Chamber pressure; `None` if this sample's code is implausible.
    pub(crate) pressure: Option<Pressure>,
    /// Last valid reference.
    pub(crate) reference: Pressure,
    /// Whether the reference came with this sample.
    pub(crate) reference_is_new: bool,
    /// Confirmed faults.
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

    /// Runs one sample; `command` contains the commands to the valves until now.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        limits: &Limits,
        command: &Command,
        inputs: &Inputs,
    ) -> Observation {
        let reference_is_new = self.reference.sample(limits, inputs.reference);
        let pressure = self
            .pressure
            .sample(limits, command.opening, inputs.pressure);
        let bits = pressure.map(Pressure::to_bits);
        self.response.sample(limits, &command.valves, bits);
        self.offset.sample(limits, &command.valves, bits);
        let battery_mv = inputs.battery_mv;
        self.fill_coil
            .sample(limits, inputs.current_fill_ma, battery_mv);
        self.vent_coil
            .sample(limits, inputs.current_vent_ma, battery_mv);
        self.battery.sample(limits, battery_mv);
        self.sample_time.sample(limits, inputs.elapsed_us);
        Observation {
            pressure,
            reference: self.reference.last(),
            reference_is_new,
            faults: limits.mechanisms.seen(self.faults(limits)),
        }
    }

    /// Records the duty cycles that were just applied to the coils.
    #[inline(always)]
    pub(crate) fn command(&mut self, outputs: Outputs) {
        self.fill_coil.command(outputs.duty_fill);
        self.vent_coil.command(outputs.duty_vent);
    }

    #[inline(always)]
    fn faults(&self, limits: &Limits) -> FaultSet {
        let fill_coil = self
            .fill_coil
            .faults(Fault::FillCoilOpen, Fault::FillCoilShort);
        let vent_coil = self
            .vent_coil
            .faults(Fault::VentCoilOpen, Fault::VentCoilShort);
        self.reference
            .faults()
            .union(self.pressure.faults(limits))
            .union(self.response.faults())
            .union(self.offset.faults())
            .union(fill_coil)
            .union(vent_coil)
            .union(self.battery.faults())
            .union(self.sample_time.faults())
    }
}

/// Returns the limits of the bench, for the tests of each detector.
#[cfg(test)]
pub(crate) fn bench_limits() -> Limits {
    let settings = crate::settings::EcuSettings::bench();
    crate::config::EcuConfig::new(&settings).unwrap().limits
}
