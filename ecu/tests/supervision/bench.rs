//! ECU on a simple rig without a simulator: a first-order chamber, and valves with a dead time.

use crate::api::controller::Pressure;
use crate::api::{
    Ecu, EcuConfig, EcuSettings, Fault, Inputs, Mode, Outputs, PressureSensor, ResetCause,
    SensorCode, VentValve, safe_outputs,
};

/// Chamber between two valves, with their faults.
#[derive(Clone, Debug)]
pub(crate) struct Rig {
    pub(crate) pressure_bar: f64,
    pub(crate) supply_bar: f64,
    /// Opening of a stuck valve, 0 to 1.
    pub(crate) fill_stuck_at: Option<f64>,
    pub(crate) vent_stuck_at: Option<f64>,
    /// Commands of the previous sample, which the valves follow in this one (%).
    commanded_pct: [f64; 2],
}

/// Rates of the nominal plant, per sample.
const FILL_RATE: f64 = 0.0713;
const VENT_RATE: f64 = 0.0728;

/// Limit of the samples of a scenario, above the need of any of them.
const SAMPLES_MAX: u32 = 30_000;

impl Rig {
    fn advance(&mut self, opening_pct: [f64; 2]) {
        let [fill_pct, vent_pct] = core::mem::replace(&mut self.commanded_pct, opening_pct);
        let opening = |duty_pct: f64| ((duty_pct - 25.0) / 50.0).clamp(0.0, 1.0);
        let fill = self.fill_stuck_at.unwrap_or(opening(fill_pct));
        let vent = self.vent_stuck_at.unwrap_or(opening(vent_pct));
        let filled = fill * FILL_RATE * (self.supply_bar - self.pressure_bar);
        let vented = vent * VENT_RATE * self.pressure_bar;
        self.pressure_bar += filled - vented;
    }
}

/// ECU with its rig and its reference.
#[derive(Clone, Debug)]
pub(crate) struct Bench {
    pub(crate) ecu: Ecu,
    pub(crate) rig: Rig,
    pub(crate) reference_bar: f64,
    vent_valve: VentValve,
    outputs: Outputs,
    sample: u32,
}

impl Bench {
    /// Creates a bench after a reset, the chamber at ambient pressure.
    pub(crate) fn new() -> Self {
        Self::with(&EcuSettings::bench())
    }

    pub(crate) fn with(settings: &EcuSettings) -> Self {
        let config = EcuConfig::new(settings).unwrap();
        Self::of(Ecu::new(config, ResetCause::PowerOn), settings.vent_valve)
    }

    pub(crate) fn of(ecu: Ecu, vent_valve: VentValve) -> Self {
        Self {
            ecu,
            rig: Rig {
                pressure_bar: 0.0,
                supply_bar: 8.4,
                fill_stuck_at: None,
                vent_stuck_at: None,
                commanded_pct: [0.0; 2],
            },
            reference_bar: 0.0,
            vent_valve,
            outputs: safe_outputs(),
            sample: 0,
        }
    }

    /// Creates a bench whose loop has settled at this pressure.
    pub(crate) fn at(pressure_bar: f64) -> Self {
        Self::new().settled_at(pressure_bar)
    }

    pub(crate) fn settled_at(mut self, pressure_bar: f64) -> Self {
        self.steps(20);
        self.reference_bar = pressure_bar;
        self.steps(200);
        assert_eq!(self.ecu.mode(), Mode::Running);
        assert!(self.ecu.faults().is_empty(), "{}", self.ecu.faults());
        let error_bar = self.rig.pressure_bar - pressure_bar;
        assert!(error_bar.abs() < 0.1, "{error_bar} bar");
        self
    }

    /// Returns the inputs that the ECU measures on a healthy rig; the last bit of the sensor always changes.
    pub(crate) fn inputs(&self) -> Inputs {
        // 24 V, less 0.8 V of the freewheeling diode, and 82.2 ohm.
        let current_ma = |duty: f64| Some((10.0 * (0.248 * duty - 0.8) / 0.822) as u16);
        let [fill_pct, vent_pct] = self.duties();
        let noise = u16::try_from(self.sample % 2).unwrap();
        Inputs {
            elapsed_us: 10_000,
            reference: Some(pressure(self.reference_bar)),
            pressure: SensorCode::from_bits(code(self.rig.pressure_bar).bits() + noise),
            current_fill_ma: current_ma(fill_pct),
            current_vent_ma: current_ma(vent_pct),
            battery_mv: Some(24_000),
        }
    }

    /// Runs a sample with healthy inputs.
    pub(crate) fn step(&mut self) -> Outputs {
        self.step_with(|_| {})
    }

    /// Runs a sample with changed inputs.
    pub(crate) fn step_with(&mut self, change: impl FnOnce(&mut Inputs)) -> Outputs {
        // Ends a test that waits for an event that never occurs.
        assert!(self.sample < SAMPLES_MAX, "{:?} for ever", self.ecu.mode());
        let mut inputs = self.inputs();
        change(&mut inputs);
        self.outputs = self.ecu.sample(&inputs);
        let [fill_pct, vent_pct] = self.duties();
        let vent_pct = match self.vent_valve {
            VentValve::NormallyClosed => vent_pct,
            VentValve::NormallyOpen => 100.0 - vent_pct,
        };
        self.rig.advance([fill_pct, vent_pct]);
        self.sample += 1;
        self.outputs
    }

    pub(crate) fn steps(&mut self, samples: u32) {
        for _ in 0..samples {
            self.step();
        }
    }

    /// Runs samples with the same change in each.
    pub(crate) fn steps_with(&mut self, samples: u32, change: impl Fn(&mut Inputs)) {
        for _ in 0..samples {
            self.step_with(&change);
        }
    }

    /// Returns the number of consecutive samples in `mode`, beginning with the last one.
    pub(crate) fn stays_in(&mut self, mode: Mode, change: impl Fn(&mut Inputs)) -> u32 {
        let mut samples = 0;
        while self.ecu.mode() == mode && samples < 10_000 {
            samples += 1;
            self.step_with(&change);
        }
        samples
    }

    pub(crate) fn has(&self, fault: Fault) -> bool {
        self.ecu.faults().contains(fault)
    }

    /// Returns the duty cycles of the coils in the last sample (%).
    pub(crate) fn duties(&self) -> [f64; 2] {
        let Outputs {
            duty_fill,
            duty_vent,
        } = self.outputs;
        [duty_fill, duty_vent].map(|duty| f64::from(duty.to_bits()) / 65_536.0)
    }

    pub(crate) fn is_off(&self) -> bool {
        self.duties() == [0.0, 0.0]
    }
}

pub(crate) fn pressure(bar: f64) -> Pressure {
    Pressure::from_bits((bar * 65_536.0).round() as i32)
}

/// Returns the sensor's code at a pressure (bar gauge).
pub(crate) fn code(bar: f64) -> SensorCode {
    let abs_pa = bar * 1e5 + PressureSensor::AMBIENT_PA as f64;
    let steps = (abs_pa - PressureSensor::LOWEST_PA as f64) / PressureSensor::STEP_PA as f64;
    let bits = (steps.round() + PressureSensor::CODE_AT_LOWEST as f64) as u16;
    SensorCode::from_bits(bits).unwrap()
}
