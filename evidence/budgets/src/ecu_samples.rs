//! Samples of an ECU with everything around the controller, out of line, as the bench calls every candidate.

use core::cell::Cell;

use controller::Pressure;
use ecu::{
    CheckedLoop, CheckedLoopConfig, Ecu, EcuConfig, EcuSettings, Inputs, LoopTelemetry, ResetCause,
    SensorCode,
};

use crate::ours::{Recommended, in_registers};
use crate::plant::{Plant, Sample};

/// Recommended controller on the bench of the thesis.
pub const BENCH: EcuConfig = {
    let Ok(config) = EcuConfig::new(&EcuSettings::bench()) else {
        panic!("settings are out of bounds");
    };
    config
};

/// Same configuration for the checked loop.
pub const CHECKED: CheckedLoopConfig<Recommended> = {
    let Ok(config) = CheckedLoopConfig::new(&BENCH) else {
        panic!("the bench chooses other mechanisms than the recommended ones");
    };
    config
};

/// Checked loop, and its telemetry for the log.
pub struct Checked {
    /// State, used by the next sample.
    pub checked_loop: CheckedLoop,
    /// Telemetry of the last sample.
    pub telemetry: Option<LoopTelemetry>,
}

impl Checked {
    /// State after a reset.
    pub const NEW: Self = Self {
        checked_loop: CheckedLoop::NEW,
        telemetry: None,
    };
}

/// Runs the full step with pressure-dependent limits, plausibility check of its pressure, and telemetry. The input is
/// the converter's register, which may have any value.
pub extern "C" fn checked_loop(
    config: &CheckedLoopConfig<Recommended>,
    checked: &mut Checked,
    reference: i32,
    converter: i32,
) -> u64 {
    let reference = Pressure::from_bits(reference);
    let code = SensorCode::from_bits(converter as u16);
    let (output, telemetry) = checked.checked_loop.sample(config, reference, code);
    checked.telemetry = Some(telemetry);
    in_registers(output.duty_fill, output.duty_vent)
}

/// Runs the whole sample: detectors, supervisor and controller, without telemetry. The last two arguments are not used.
pub extern "C" fn ecu_sample(inputs: &Cell<Inputs>, ecu: &mut Ecu, _: i32, _: i32) -> u64 {
    let outputs = ecu.sample(&inputs.get());
    in_registers(outputs.duty_fill, outputs.duty_vent)
}

/// Returns the ECU on the bench, as after power-on.
pub const fn bench_ecu() -> Ecu {
    Ecu::new(BENCH, ResetCause::PowerOn)
}

/// Plant of the ECU, with its measurements.
pub struct Rig {
    plant: Plant,
    duties: [i32; 2],
}

impl Rig {
    /// Creates the rig before the first sample.
    pub const fn new() -> Self {
        Self {
            plant: Plant::new(),
            duties: [0; 2],
        }
    }

    /// Returns the inputs of the next sample.
    pub fn sample(&mut self) -> Inputs {
        let Sample {
            reference, code, ..
        } = self.plant.sample();
        let [fill, vent] = self.duties.map(|duty| Some(current_ma(duty)));
        Inputs {
            elapsed_us: 10_000,
            reference: Some(Pressure::from_bits(reference)),
            pressure: Some(code),
            current_fill_ma: fill,
            current_vent_ma: vent,
            battery_mv: Some(24_000),
        }
    }

    /// Drives the coils with these duty cycles, fill and vent (2⁻¹⁶ %), until the next sample.
    pub fn drive(&mut self, duties: [i32; 2]) {
        self.duties = duties;
        self.plant.drive(duties);
    }
}

impl Default for Rig {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the mean current (mA) of a coil of 82.2 ohm at this duty cycle (2⁻¹⁶ %): 24 V while it is driven, and the drop
/// of the freewheeling diode of 0.8 V against it otherwise. Another resistance would change the duty limits.
fn current_ma(duty: i32) -> u16 {
    // 100 % is 100 · 2¹⁶, and 24 800 mV are 248 mV per percent.
    let mean_mv = (248 * (duty >> 8) / 256 - 800).max(0);
    (10 * mean_mv / 822) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::SAMPLES;
    use controller::Duty;
    use ecu::Mode;

    /// Goal: the ECU is measured while it controls, not while it waits or vents.
    #[test]
    fn the_ecu_runs_on_its_own_plant_without_a_fault() {
        let (mut ecu, mut rig, mut running) = (bench_ecu(), Rig::new(), 0);
        for sample in 0..SAMPLES {
            let outputs = ecu.sample(&rig.sample());
            rig.drive([outputs.duty_fill, outputs.duty_vent].map(Duty::to_bits));
            assert!(ecu.faults().is_empty(), "{sample}: {:?}", ecu.faults());
            running += usize::from(ecu.mode() == Mode::Running);
        }
        assert!(running > SAMPLES - 25, "{running}");
    }
}
