//! Environment of the ECU: the plant, its pressure sensor, its coil currents, its battery, and the reference.

use plant_sim::parameters::Part;
use plant_sim::plant::{FILL, VENT};
use plant_sim::regulating_valve::RegulatingValve;
use plant_sim::{Command, Sample, Simulator};

use crate::random::{Random, Stream};
use crate::scenario::Scenario;
use crate::sensor;
use crate::wire::{self, Actuators, Sensors};

/// Interval at which a supply voltage follows its profile (ns): a tenth of the fastest edge of a profile. The plunger of a
/// regulating valve, for which the pressure is linear in time, follows at the same interval.
const INTERVAL_NS: u64 = 1_000_000;

/// Noise of the measured supply voltage (V rms): two steps of the ADC, with the ripple of an alternator filtered
/// (assumed).
const VOLTAGE_NOISE_V_RMS: f64 = 0.03;
/// Noise of a measured mean coil current (A rms): a shunt amplifier with a full scale of 1 A (assumed).
const CURRENT_NOISE_A_RMS: f64 = 1e-3;

/// World of a scenario, sample by sample: sense, then actuate.
#[derive(Clone, Debug)]
pub struct World<'a> {
    scenario: &'a Scenario,
    simulator: Simulator,
    noise: Random,
    voltage_noise: Random,
    current_noise: Random,
    sample_ns: u64,
    /// Number of samples sensed so far.
    samples: u32,
    shown: Sample,
    /// Regulating valve behind the chamber; `None` if the plant has none.
    regulating_valve: Option<RegulatingValve>,
    /// Supply voltage in place of that of the scenario (V).
    forced_supply_v: Option<f64>,
}

impl<'a> World<'a> {
    /// Creates the scenario's world at power-on: the chamber at ambient pressure, valves at rest.
    pub fn new(scenario: &'a Scenario) -> Self {
        let mut simulator = Simulator::new(&scenario.plant);
        Self {
            scenario,
            shown: simulator.sample(),
            regulating_valve: scenario
                .plant
                .regulating_valve
                .clone()
                .map(RegulatingValve::new),
            simulator,
            noise: Random::new(scenario.seed, Stream::SensorNoise),
            voltage_noise: Random::new(scenario.seed, Stream::VoltageNoise),
            current_noise: Random::new(scenario.seed, Stream::CurrentNoise),
            sample_ns: scenario.plant.ecu.sample_time_ns(),
            samples: 0,
            forced_supply_v: None,
        }
    }

    /// Returns the inputs of the ECU in the next sample, without a fault.
    pub fn sense(&mut self) -> Sensors {
        let sample = self.samples;
        self.samples += 1;
        let lead_in = self.scenario.lead_in();
        if sample == lead_in.samples() && self.scenario.start_pressure_bar > 0.0 {
            self.simulator
                .set_chamber_pressure(self.scenario.start_pressure_pa());
        }
        self.shown = self.simulator.sample();
        let reference_bar = match sample.checked_sub(lead_in.samples()) {
            Some(run) => self
                .scenario
                .reference
                .at_ns(u64::from(run) * self.sample_ns),
            None => lead_in.reference_bar(sample),
        };
        // Counted from time 0, so that a longer lead-in changes no draw after it.
        let draw = u64::from(sample).wrapping_sub(lead_in.samples().into());
        let noise_pa = 100.0 * self.scenario.sensor_noise_mbar_rms * self.noise.normal(draw);
        let voltage_v =
            self.supply_voltage_v() + VOLTAGE_NOISE_V_RMS * self.voltage_noise.normal(draw);
        let [current_fill, current_vent] = self.sensed_currents(draw);
        Sensors {
            sample,
            elapsed_us: u32::try_from(self.sample_ns / 1000).unwrap_or(u32::MAX),
            reference: Some(wire::reference_bits(reference_bar)),
            pressure: Some(sensor::code(self.shown.measured_pressure + noise_pa).bits()),
            current_fill_ma: current_fill.map(wire::current_ma),
            current_vent_ma: current_vent.map(wire::current_ma),
            battery_mv: self.has_coil().then(|| sensor::battery_mv(voltage_v)),
        }
    }

    /// Applies duty cycles to the coils until the next sample.
    pub fn actuate(&mut self, actuators: Actuators) {
        self.simulator.command(Command {
            duty_fill_pct: wire::duty_pct(actuators.duty_fill),
            duty_vent_pct: wire::duty_pct(actuators.duty_vent),
        });
        let end_ns = self.simulator.time_ns() + self.sample_ns;
        let is_divided = self.scenario.supply.is_some() || self.regulating_valve.is_some();
        let interval_ns = if is_divided {
            INTERVAL_NS
        } else {
            self.sample_ns
        };
        while self.simulator.time_ns() < end_ns {
            if self.has_coil() {
                self.simulator.set_supply_voltage(self.supply_voltage_v());
            }
            let begin_ns = self.simulator.time_ns();
            let begin_pa = self.gauge_pressure_pa();
            self.simulator
                .advance_to_ns((begin_ns + interval_ns).min(end_ns));
            let passed_s = (self.simulator.time_ns() - begin_ns) as f64 * 1e-9;
            let end_pa = self.gauge_pressure_pa();
            if let Some(valve) = &mut self.regulating_valve {
                valve.advance(passed_s, begin_pa, end_pa);
            }
        }
    }

    /// Returns the chamber pressure now (Pa gauge).
    fn gauge_pressure_pa(&self) -> f64 {
        self.simulator.state().pressure - self.scenario.plant.gas.ambient_pressure_pa
    }

    /// Returns the position of the regulating valve's plunger now (m); `None` if the plant has none.
    pub fn plunger_m(&self) -> Option<f64> {
        let valve = self.regulating_valve.as_ref()?;
        Some(valve.position())
    }

    /// Sets the supply voltage (V) of plant and measurement, to apply a fault; none restores that of the scenario.
    pub fn force_supply(&mut self, volt: Option<f64>) {
        self.forced_supply_v = volt;
    }

    /// Returns whether the plant has a coil, and the ECU measures its supply voltage.
    fn has_coil(&self) -> bool {
        Part::Coil.is_in(&self.scenario.plant)
    }

    /// Returns the supply voltage at the ECU now (V).
    fn supply_voltage_v(&self) -> f64 {
        if let Some(volt) = self.forced_supply_v {
            return volt;
        }
        let lead_in_ns = u64::from(self.scenario.lead_in().samples()) * self.sample_ns;
        let since_start_ns = self.simulator.time_ns().checked_sub(lead_in_ns);
        match (self.scenario.supply, since_start_ns) {
            (Some(supply), Some(since_start_ns)) => supply.at_s(since_start_ns as f64 * 1e-9),
            _ => self.scenario.plant.ecu.supply_voltage_v,
        }
    }

    /// Returns the mean coil currents with the noise of draw number `draw` (A); none of a valve without a coil.
    fn sensed_currents(&self, draw: u64) -> [Option<f64>; 2] {
        [FILL, VENT].map(|valve| {
            let draw = draw.wrapping_mul(2).wrapping_add(valve as u64);
            let noise = CURRENT_NOISE_A_RMS * self.current_noise.normal(draw);
            let current = (self.shown.mean_current[valve] + noise).max(0.0);
            let has_coil = self.scenario.plant.functions[valve].has_coil();
            has_coil.then_some(current)
        })
    }

    /// Returns the plant at the ECU's last measurement.
    pub fn shown(&self) -> &Sample {
        &self.shown
    }

    /// Returns the chamber pressure where the sensor is, at the ECU's last measurement (bar gauge).
    pub fn pressure_bar(&self) -> f64 {
        (self.shown.pressure_at_sensor - self.scenario.plant.gas.ambient_pressure_pa) / 1e5
    }

    /// Returns the numbers of lifts of the fill and the vent valve since power-on, each bounce included.
    pub fn lifts(&self) -> [u64; 2] {
        self.simulator.lifts()
    }

    /// Returns the plant, to apply a fault.
    pub fn simulator_mut(&mut self) -> &mut Simulator {
        &mut self.simulator
    }
}
