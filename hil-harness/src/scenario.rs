//! Scenario: all data that determines a run.

use core::fmt;

use controller::Settings;
use ecu::{EcuSettings, PressureSensor, Supervision};
use plant_sim::PlantParameters;
use plant_sim::parameters::Part;
use plant_sim::plant::{FILL, VENT};
use plant_sim::valve::ValveFunction;

use crate::controller_file;
use crate::lead_in::LeadIn;
use crate::reference_profile::ReferenceProfile;
use crate::requirement::Requirement;
use crate::supervision::{SHIPPED, supervision, vent_valve, with_nominal_values};
use crate::voltage_profile::Supply;

/// All data that determines a run. Two runs of one scenario are equal bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Short name, for tables and file names.
    pub name: String,
    /// Reference of the chamber pressure.
    pub reference: ReferenceProfile,
    /// Duration (samples); the profile's last reference stays valid if the profile ends earlier.
    pub duration_samples: u32,
    /// Parameters of the plant.
    pub plant: PlantParameters,
    /// Chamber pressure at the start (bar gauge).
    pub start_pressure_bar: f64,
    /// Settings of the controller.
    pub controller: Settings,
    /// Data of the ECU about the plant's kind of rig.
    pub supervision: Supervision,
    /// Noise of the pressure sensor before the ADC (mbar rms).
    pub sensor_noise_mbar_rms: f64,
    /// Supply voltage from time 0 on; `None`: that of the plant.
    pub supply: Option<Supply>,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// Noise of the pressure sensor on the bench (mbar rms), data/README.md.
pub const BENCH_NOISE_MBAR_RMS: f64 = 4.0;

/// Largest noise of a scenario (mbar rms).
pub const NOISE_MAX_MBAR_RMS: f64 = 1000.0;

/// Longest scenario (samples): a day at 100 Hz, so that a run's recording fits into memory.
pub const DURATION_MAX_SAMPLES: u32 = 8_640_000;

impl Scenario {
    /// Creates a scenario with this reference profile, the nominal plant, the recommended controller and the bench's
    /// sensor noise, from ambient pressure to the end of the profile.
    pub fn new(name: impl Into<String>, reference: ReferenceProfile) -> Self {
        let plant = PlantParameters::nominal();
        let duration_samples = samples(reference.end_ns(), &plant);
        Self {
            name: name.into(),
            reference,
            duration_samples: duration_samples.saturating_add(1),
            supervision: supervision(&plant),
            plant,
            start_pressure_bar: 0.0,
            controller: controller_file::recommended(),
            sensor_noise_mbar_rms: BENCH_NOISE_MBAR_RMS,
            supply: None,
            seed: 1,
        }
    }

    /// Returns the scenario on another kind of plant, with the matching settings of the ECU. Its duration (s) is the
    /// same for any sample time.
    #[must_use]
    pub fn on(self, plant: PlantParameters) -> Self {
        let controller = followed(self.controller, &self.plant, &plant);
        Self {
            supervision: supervision(&plant),
            controller,
            ..self.on_rig(plant)
        }
    }

    /// Returns the scenario on another rig of the same kind: the ECU's settings are unchanged.
    #[must_use]
    pub fn on_rig(self, plant: PlantParameters) -> Self {
        let intervals = u64::from(self.duration_samples.saturating_sub(1));
        let duration_ns = intervals.saturating_mul(self.plant.ecu.sample_time_ns());
        Self {
            duration_samples: samples(duration_ns, &plant).saturating_add(1),
            plant,
            ..self
        }
    }

    /// Returns the scenario with another controller. The nominal values of a shipped controller become those of the plant.
    #[must_use]
    pub fn controlled_by(self, controller: Settings) -> Self {
        Self {
            controller: with_nominal_values(controller, &self.plant),
            ..self
        }
    }

    /// Returns the scenario with another seed.
    #[must_use]
    pub fn seeded(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Returns the built-in scenario of this name.
    pub fn built_in(name: &str) -> Option<Self> {
        BUILT_IN
            .iter()
            .find(|built_in| built_in.name == name)
            .map(BuiltIn::scenario)
    }

    /// Returns the settings of the ECU.
    pub fn ecu_settings(&self) -> EcuSettings {
        EcuSettings {
            controller: self.controller,
            vent_valve: vent_valve(&self.plant),
            supervision: self.supervision,
        }
    }

    /// Returns the lead-in before time 0.
    pub fn lead_in(&self) -> LeadIn {
        LeadIn::to(self.start_pressure_bar, self.plant.ecu.sample_time_s)
    }

    /// Returns the chamber pressure at time 0 (Pa abs).
    pub fn start_pressure_pa(&self) -> f64 {
        self.plant.gas.ambient_pressure_pa + self.start_pressure_bar * 1e5
    }

    /// Checks the values that the types do not restrict.
    ///
    /// # Errors
    /// Returns the first problem.
    pub fn check(&self) -> Result<(), ScenarioError> {
        self.reference.check()?;
        if !(1..=DURATION_MAX_SAMPLES).contains(&self.duration_samples) {
            return Err(ScenarioError::Duration {
                samples: self.duration_samples,
            });
        }
        let supply_bar = self.plant.gas.supply_pressure_bar_gauge;
        if !(0.0..=supply_bar).contains(&self.start_pressure_bar) {
            return Err(ScenarioError::StartPressure {
                bar: self.start_pressure_bar,
                supply_bar,
            });
        }
        if !(0.0..=NOISE_MAX_MBAR_RMS).contains(&self.sensor_noise_mbar_rms) {
            return Err(ScenarioError::Noise {
                mbar_rms: self.sensor_noise_mbar_rms,
            });
        }
        let controller_ms: f64 = self.controller.sample_time_ms.to_num();
        let plant_ms = self.plant.ecu.sample_time_s * 1e3;
        // A controller file has a resolution of 2⁻¹⁶ ms.
        if (controller_ms - plant_ms).abs() > 1.0 / 65536.0 {
            return Err(ScenarioError::SampleTimes {
                controller_ms,
                plant_ms,
            });
        }
        if self.controller.pulses.is_some() {
            self.check_pulses()?;
        }
        Ok(())
    }

    /// Checks what model-based pulses need of the plant.
    fn check_pulses(&self) -> Result<(), ScenarioError> {
        let sample_ms = self.plant.ecu.sample_time_s * 1e3;
        let period_ms = plant_period_ms(&self.plant);
        if (period_ms - sample_ms).abs() > 1e-6 {
            return Err(ScenarioError::PulsePeriod {
                period_ms,
                sample_ms,
            });
        }
        let functions = self.plant.functions;
        if functions.into_iter().any(ValveFunction::has_conductance) {
            return Err(ScenarioError::PulsesWithoutCoil);
        }
        Ok(())
    }
}

/// Returns the part that a closed loop needs and `plant` lacks: a commanded valve to fill and one to vent, and the chamber.
pub fn missing_part(plant: &PlantParameters) -> Option<Part> {
    let parts = [
        Part::CommandedValve(FILL),
        Part::CommandedValve(VENT),
        Part::Chamber,
    ];
    parts.into_iter().find(|part| !part.is_in(plant))
}

/// Returns the PWM period of a plant (ms).
fn plant_period_ms(plant: &PlantParameters) -> f64 {
    plant.ecu.pwm_period_ns() as f64 * 1e-6
}

/// Returns the controller with the nominal values of the plant `to` where it has those of the plant `from`.
fn followed(controller: Settings, from: &PlantParameters, to: &PlantParameters) -> Settings {
    let mut shipped_ones = SHIPPED.iter().map(|shipped| shipped());
    let on_its_plant = |&shipped: &Settings| with_nominal_values(shipped, from) == controller;
    if let Some(shipped) = shipped_ones.find(on_its_plant) {
        return with_nominal_values(shipped, to);
    }
    let shipped = Settings::pulses();
    let with_shipped = Settings {
        compensation: shipped.compensation,
        pulses: shipped.pulses,
        duty_min: shipped.duty_min,
        duty_max_fill_pct: shipped.duty_max_fill_pct,
        duty_max_vent_pct: shipped.duty_max_vent_pct,
        ..controller
    };
    let [old, new] = [from, to].map(|plant| with_nominal_values(with_shipped, plant));
    let has_old_limits = controller.duty_min == old.duty_min
        && controller.duty_max_fill_pct == old.duty_max_fill_pct
        && controller.duty_max_vent_pct == old.duty_max_vent_pct;
    let limits = if has_old_limits { new } else { controller };
    Settings {
        duty_min: limits.duty_min,
        duty_max_fill_pct: limits.duty_max_fill_pct,
        duty_max_vent_pct: limits.duty_max_vent_pct,
        compensation: match controller.compensation {
            Some(_) if controller.compensation == old.compensation => new.compensation,
            other => other,
        },
        pulses: match controller.pulses {
            Some(_) if controller.pulses == old.pulses => new.pulses,
            other => other,
        },
        ..controller
    }
}

/// Returns the number of whole samples of the ECU of `plant` in a time.
fn samples(time_ns: u64, plant: &PlantParameters) -> u32 {
    u32::try_from(time_ns / plant.ecu.sample_time_ns().max(1)).unwrap_or(u32::MAX)
}

impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sample_s = self.plant.ecu.sample_time_s;
        writeln!(f, "# Scenario {}", self.name)?;
        writeln!(f, "# seed: {}", self.seed)?;
        writeln!(
            f,
            "# duration: {} samples of {} ms = {:.2} s",
            self.duration_samples,
            sample_s * 1e3,
            f64::from(self.duration_samples) * sample_s
        )?;
        writeln!(f, "# start: {} bar gauge", self.start_pressure_bar)?;
        writeln!(f, "# reference, gauge: {}", self.reference)?;
        writeln!(
            f,
            "# pressure sensor: {} to {} Pa absolute, {} Pa per code, noise {} mbar rms",
            PressureSensor::LOWEST_PA,
            PressureSensor::HIGHEST_PA,
            PressureSensor::STEP_PA,
            self.sensor_noise_mbar_rms
        )?;
        if let Some(supply) = self.supply {
            writeln!(f, "# supply voltage from time 0 on: {supply}")?;
        }
        writeln!(f, "\n{}", controller_file::write(&self.controller))?;
        f.write_str(&self.plant.to_toml())
    }
}

/// Scenario that comes with the crate.
#[derive(Debug)]
pub struct BuiltIn {
    /// Name for the command line.
    pub name: &'static str,
    /// Purpose of the scenario, in one sentence.
    pub about: &'static str,
    profile: fn() -> ReferenceProfile,
    start: Start,
    orifice_m: f64,
}

/// Chamber pressure at the start of a built-in scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// Ambient pressure.
    Ambient,
    /// First reference of the profile.
    AtReference,
}

impl BuiltIn {
    /// Returns the scenario.
    pub fn scenario(&self) -> Scenario {
        let scenario = Scenario::new(self.name, (self.profile)());
        let plant = with_orifices(scenario.plant.clone(), self.orifice_m);
        let mut scenario = scenario.on(plant);
        if self.start == Start::AtReference {
            scenario.start_pressure_bar = scenario.reference.at_ns(0);
        }
        scenario
    }
}

/// Returns the plant with both orifices of this diameter (m), such as prototype 2 with 1.3 mm.
pub fn with_orifices(mut plant: PlantParameters, diameter_m: f64) -> PlantParameters {
    plant.flow.orifice_fill_m = diameter_m;
    plant.flow.orifice_vent_m = diameter_m;
    for key in ["flow.orifice_fill_m", "flow.orifice_vent_m"] {
        plant
            .provenance
            .insert(key.to_owned(), "thesis, prototype 2".to_owned());
    }
    plant
}

/// Returns the plant with a normally open vent valve, as the thesis intends for a retarder (section 1.4). Its spring opens
/// it against no pressure, and the coil shuts it at a low voltage too: 1 N of preload in place of 3.3 N (assumed).
pub fn with_normally_open_vent(mut plant: PlantParameters) -> PlantParameters {
    plant.functions[VENT] = ValveFunction::NormallyOpen;
    plant.armature.preload_vent_n = NORMALLY_OPEN_PRELOAD_N;
    plant
}

/// Preload of a normally open vent valve (N), assumed.
const NORMALLY_OPEN_PRELOAD_N: f64 = 1.0;

/// Orifice of the rig of figures 6.5 and 6.7 (m).
pub const FIGURE_ORIFICE_M: f64 = 1.3e-3;

/// Orifice that the thesis finds necessary (m), section 6.4.2; that of the nominal plant.
pub const REQUIRED_ORIFICE_M: f64 = 1.9e-3;

/// All built-in scenarios.
pub const BUILT_IN: &[BuiltIn] = &[
    BuiltIn {
        name: "figure-6.5",
        about: "staircase up and down between 1.5 and 8 bar in 16 s, with orifices of 1.3 mm where no plant is given; levels \
                and instants are ours, the axes are those of figure 6.5",
        profile: || staircase(1000, 600, 600),
        start: Start::Ambient,
        orifice_m: FIGURE_ORIFICE_M,
    },
    BuiltIn {
        name: "figure-6.7",
        about: "the same staircase in 30 s, the time axis of figure 6.7",
        profile: || staircase(1900, 500, 1000),
        start: Start::Ambient,
        orifice_m: FIGURE_ORIFICE_M,
    },
    BuiltIn {
        name: "fill-requirement",
        about: "from ambient pressure to 0.26 p_sup (section 1.4), five times",
        profile: fill_requirement,
        start: Start::Ambient,
        orifice_m: REQUIRED_ORIFICE_M,
    },
    BuiltIn {
        name: "vent-requirement",
        about: "from 0.88 p_sup to 0.71 p_sup (section 1.4), five times",
        profile: vent_requirement,
        start: Start::Ambient,
        orifice_m: REQUIRED_ORIFICE_M,
    },
    BuiltIn {
        name: "hold",
        about: "steps of 0.05 to 0.5 bar around 3.5 bar: small errors, and rest between them",
        profile: small_steps,
        start: Start::AtReference,
        orifice_m: REQUIRED_ORIFICE_M,
    },
    BuiltIn {
        name: "operating-range",
        about: "steps of every size between 0.18 and 0.71 p_sup (section 6.4.2), up and down",
        profile: operating_range,
        start: Start::AtReference,
        orifice_m: REQUIRED_ORIFICE_M,
    },
    BuiltIn {
        name: "full-range",
        about: "between ambient pressure and 0.95 p_sup, beyond the operating range",
        profile: full_range,
        start: Start::Ambient,
        orifice_m: REQUIRED_ORIFICE_M,
    },
];

fn psup(share: f64) -> f64 {
    Requirement::THESIS.psup(share)
}

/// Returns a staircase like figures 6.5 and 6.7, which print axes only: 0 to 16 s and 0 to 30 s, up to about 8 bar. The
/// text mentions a fill step near 4 s that overshoots, and figure 6.6 a step near 15.6 s between 4 and 7 bar. This
/// staircase has both; its levels are ours.
fn staircase(stair_ms: u32, before_last_ms: u32, last_ms: u32) -> ReferenceProfile {
    [
        1.5, 3.0, 4.5, 6.0, 7.0, 8.0, 7.0, 6.0, 4.5, 3.0, 1.5, 3.5, 5.5, 4.0,
    ]
    .into_iter()
    .fold(
        ReferenceProfile::starting_at(0.0).hold_ms(stair_ms),
        |profile, level_bar| profile.step_to(level_bar).hold_ms(stair_ms),
    )
    .hold_ms(before_last_ms)
    .step_to(6.5)
    .hold_ms(last_ms)
}

fn fill_requirement() -> ReferenceProfile {
    (0..5).fold(
        ReferenceProfile::starting_at(0.0).hold_ms(100),
        |profile, _| {
            profile
                .step_to(psup(0.26))
                .hold_ms(1000)
                .step_to(0.0)
                .hold_ms(1500)
        },
    )
}

fn vent_requirement() -> ReferenceProfile {
    (0..5).fold(
        ReferenceProfile::starting_at(0.0).hold_ms(100),
        |profile, _| {
            profile
                .step_to(psup(0.88))
                .hold_ms(2000)
                .step_to(psup(0.71))
                .hold_ms(1000)
        },
    )
}

fn small_steps() -> ReferenceProfile {
    let hold_bar = 3.5;
    let start = ReferenceProfile::starting_at(hold_bar).hold_ms(2000);
    [0.05, 0.1, 0.2, 0.3, 0.5]
        .into_iter()
        .fold(start, |profile, size_bar| {
            [size_bar, 0.0, -size_bar, 0.0]
                .into_iter()
                .fold(profile, |profile, offset_bar| {
                    profile.step_to(hold_bar + offset_bar).hold_ms(1500)
                })
        })
}

/// Returns steps from each of six references to each other one: every size, both directions, at every pressure.
fn operating_range() -> ReferenceProfile {
    let levels = [0.18, 0.28, 0.38, 0.49, 0.60, 0.71].map(psup);
    let start = ReferenceProfile::starting_at(levels[0]).hold_ms(1000);
    (0..levels.len())
        .flat_map(|low| (0..low).map(move |high| (low, high)))
        .fold(start, |profile, (first, second)| {
            let hold_ms = 1000;
            profile
                .step_to(levels[first])
                .hold_ms(hold_ms)
                .step_to(levels[second])
                .hold_ms(hold_ms)
        })
}

fn full_range() -> ReferenceProfile {
    [0.95, 0.0, 0.5, 0.95, 0.5, 0.0, 0.1, 0.9, 0.05, 0.0]
        .into_iter()
        .fold(
            ReferenceProfile::starting_at(0.0).hold_ms(500),
            |profile, share| profile.step_to(psup(share)).hold_ms(2000),
        )
}

/// Problem of a scenario that cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// A reference is out of range.
    #[error(transparent)]
    Reference(#[from] crate::reference_profile::ProfileError),
    /// The duration has no sample, or more than fit into the planned memory.
    #[error(
        "a duration of {samples} samples is out of range: 1 to {DURATION_MAX_SAMPLES}; split the profile"
    )]
    Duration {
        /// Wanted duration (samples).
        samples: u32,
    },
    /// The chamber cannot start at this pressure.
    #[error(
        "start at {bar} bar gauge is out of range: 0 to the plant's supply pressure, {supply_bar} bar gauge"
    )]
    StartPressure {
        /// Wanted start (bar gauge).
        bar: f64,
        /// Supply pressure of the plant (bar gauge).
        supply_bar: f64,
    },
    /// The noise is impossible for a pressure sensor.
    #[error("sensor noise {mbar_rms} mbar rms is out of range: 0 to {NOISE_MAX_MBAR_RMS} mbar rms")]
    Noise {
        /// Wanted noise (mbar rms).
        mbar_rms: f64,
    },
    /// Model-based pulses with another PWM period than the sample time.
    #[error(
        "model-based pulses need a PWM period of one sample: ecu.pwm_frequency_hz gives {period_ms} ms, \
         ecu.sample_time_s {sample_ms} ms; make both equal, or leave out the table [pulses]"
    )]
    PulsePeriod {
        /// PWM period of the plant (ms).
        period_ms: f64,
        /// Sample time of the plant (ms).
        sample_ms: f64,
    },
    /// Model-based pulses with a valve whose opening times are not those of the tables.
    #[error(
        "model-based pulses need two valves with coils: their tables have the opening times of such valves; take \
         `--controller recommended`, or leave out the table [pulses]"
    )]
    PulsesWithoutCoil,
    /// Controller and plant have different sample times.
    #[error(
        "the controller's sample_time_ms = {controller_ms} is not the plant's ecu.sample_time_s = {plant_ms} ms: \
         set both to the ECU's period"
    )]
    SampleTimes {
        /// Sample time of the controller (ms).
        controller_ms: f64,
        /// Sample time of the plant (ms).
        plant_ms: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_scenario_can_be_run_and_found_by_its_name() {
        for built_in in BUILT_IN {
            let scenario = Scenario::built_in(built_in.name).unwrap();
            assert_eq!(scenario.name, built_in.name);
            assert_eq!(scenario.check(), Ok(()));
            assert!(!built_in.about.is_empty());
        }
        assert!(Scenario::built_in("no such").is_none());
    }

    #[test]
    fn the_two_figures_run_as_long_as_their_axes() {
        for (name, expected_s) in [("figure-6.5", 16.0), ("figure-6.7", 30.0)] {
            let found_s = Scenario::built_in(name).unwrap().reference.end_ns() as f64 * 1e-9;
            assert!((found_s - expected_s).abs() < 0.5, "{name}: {found_s} s");
        }
    }

    #[test]
    fn the_operating_range_is_swept_to_both_ends_and_never_left() {
        let requirement = Requirement::THESIS;
        let scenario = Scenario::built_in("operating-range").unwrap();
        let references: Vec<f64> = (0..scenario.reference.end_ns() / 10_000_000)
            .map(|sample| scenario.reference.at_ns(sample * 10_000_000))
            .collect();
        assert!(
            references
                .iter()
                .all(|&bar| requirement.is_operating_reference(bar))
        );
        let [low, high] = requirement.operating_range_psup.map(psup);
        assert!(references.contains(&low) && references.contains(&high));
    }

    /// Found in use: a profile of 30 s ran for 60 s on a plant that samples every 20 ms.
    #[test]
    fn a_scenario_lasts_as_long_whatever_the_sample_time() {
        for built_in in BUILT_IN {
            let scenario = built_in.scenario();
            let end_s = scenario.reference.end_ns() as f64 * 1e-9;
            for sample_time_s in [0.001, 0.005, 0.01, 0.02, 0.1] {
                let mut plant = scenario.plant.clone();
                plant.ecu.sample_time_s = sample_time_s;
                let there = scenario.clone().on(plant.clone());
                let last_s = f64::from(there.duration_samples - 1) * sample_time_s;
                assert!(
                    (last_s - end_s).abs() < sample_time_s + 1e-9,
                    "{}: {last_s} s, not {end_s} s",
                    built_in.name
                );
                let lead_in_s = f64::from(there.lead_in().samples()) * sample_time_s;
                assert!(there.start_pressure_bar == 0.0 || lead_in_s >= 2.0);
                // The conversion back restores the duration.
                let back = there.on_rig(scenario.plant.clone());
                assert!(back.duration_samples.abs_diff(scenario.duration_samples) <= 10);
            }
            let same = scenario.clone().on(scenario.plant.clone());
            assert_eq!(same.duration_samples, scenario.duration_samples);
        }
    }

    #[test]
    fn what_cannot_be_run_is_refused_with_the_value_and_the_bound() {
        let sound = Scenario::built_in("hold").unwrap();
        let mut slow_plant = sound.clone();
        slow_plant.plant.ecu.sample_time_s = 0.02;
        let cases = [
            (
                Scenario {
                    duration_samples: 0,
                    ..sound.clone()
                },
                "0 samples is out of range: 1 to 8640000",
            ),
            (
                Scenario {
                    start_pressure_bar: 9.0,
                    ..sound.clone()
                },
                "start at 9 bar gauge is out of range: 0 to",
            ),
            (
                Scenario {
                    sensor_noise_mbar_rms: f64::NAN,
                    ..sound.clone()
                },
                "NaN mbar rms is out of range",
            ),
            (
                Scenario {
                    reference: ReferenceProfile::starting_at(99.0),
                    ..sound
                },
                "99 bar gauge",
            ),
            (
                slow_plant,
                "sample_time_ms = 10 is not the plant's ecu.sample_time_s = 20 ms",
            ),
        ];
        for (scenario, expected) in cases {
            let error = scenario.check().unwrap_err().to_string();
            assert!(
                error.contains(expected),
                "{error:?} does not say {expected:?}"
            );
        }
    }

    #[test]
    fn a_scenario_prints_everything_that_decides_it() {
        let scenario = Scenario::built_in("hold").unwrap().seeded(42);
        let text = scenario.to_string();
        for part in [
            "hold",
            "seed: 42",
            "start: 3.5 bar gauge",
            "step to 3.55 bar",
            "noise 4 mbar rms",
            "510 Pa per code",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
        assert!(text.contains(&controller_file::write(&scenario.controller)));
        assert!(text.contains(&scenario.plant.to_toml()));
    }
}
