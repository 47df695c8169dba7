//! One run: an injection, a rig, a target, an oracle.

use std::sync::OnceLock;

use plant_sim::{ParameterError, PlantParameters};

use super::class::FaultClass;
use super::driver::{Drive, lead_in_samples};
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::oracle::{Observation, Oracle, Violation};
use super::target::{Reaction, Target};
use super::{ecu, image, link, plant, sensor};
use crate::device::DutError;
use crate::reference_profile::ReferenceProfile;
use crate::rigs::scattered;
use crate::scenario::{FIGURE_ORIFICE_M, Scenario, with_orifices};
use crate::wire;
use crate::world::World;

/// Result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Injection of the run.
    pub injection: Injection,
    /// Number of samples from the onset until the target reported a fault; `None` if it never did.
    pub latency: Option<u32>,
    /// Length of the run (samples).
    pub samples: u32,
    /// Number of restarts that the target initiated.
    pub resets: u32,
    /// Violated requirements, each at its first violation.
    pub violations: Vec<Violation>,
}

impl Outcome {
    /// Returns whether a safety requirement was violated.
    pub fn is_unsafe(&self) -> bool {
        self.violations
            .iter()
            .any(|violation| violation.requirement.is_safety())
    }

    /// Returns whether the loop stayed safe but did not recover.
    pub fn is_not_live(&self) -> bool {
        !self.violations.is_empty() && !self.is_unsafe()
    }
}

/// Reason why a run has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// The target failed.
    #[error("{injection}: {error}")]
    Target {
        /// Injection of the run.
        injection: Injection,
        /// Error of the target.
        error: Box<DutError>,
    },
    /// The rig's parameters are invalid.
    #[error("{injection}: {error}")]
    Rig {
        /// Injection of the run.
        injection: Injection,
        /// Error of the parameter.
        error: Box<ParameterError>,
    },
}

/// Runs one injection on `target` from power-on.
///
/// # Errors
/// Returns an error if the target failed, or there is no such rig.
pub fn run(injection: &Injection, target: &mut dyn Target) -> Result<Outcome, CampaignError> {
    run_watched(injection, target, &mut |_, _| {})
}

/// Runs one injection and passes each sample and the target's mode to `watch`.
///
/// # Errors
/// Returns the same errors as [`run`].
pub fn run_watched(
    injection: &Injection,
    target: &mut dyn Target,
    watch: &mut dyn FnMut(&Observation, &wire::Telemetry),
) -> Result<Outcome, CampaignError> {
    let drive = Drive::of(injection);
    let scenario = scenario(injection, &drive).map_err(|error| CampaignError::Rig {
        injection: *injection,
        error: Box::new(error),
    })?;
    judged(injection, &drive, &scenario, target, watch).map_err(|error| CampaignError::Target {
        injection: *injection,
        error: Box::new(error),
    })
}

fn judged(
    injection: &Injection,
    drive: &Drive,
    scenario: &Scenario,
    target: &mut dyn Target,
    watch: &mut dyn FnMut(&Observation, &wire::Telemetry),
) -> Result<Outcome, DutError> {
    let mut world = World::new(scenario);
    let mut injector = injector(injection, &scenario.plant);
    let mut oracle = Oracle::new(injection, scenario, *drive);
    let mut latency = None;
    let mut resets = 0;
    let (mut starts, mut was_off) = (true, false);
    target.start(&scenario.ecu_settings())?;
    for sample in 0..drive.samples() {
        let now = Now {
            sample,
            age: injection.age(sample),
        };
        let mut sensors = world.sense();
        let reference_bar = wire::bar(sensors.reference.unwrap_or_default());
        injector.sense(now, &mut sensors);
        let is_damaged = injector.disturb(now, target)?;
        if !injector.is_powered(now) {
            (starts, was_off) = (true, true);
            injector.actuate(now, &mut world, wire::Actuators::OFF);
            continue;
        }
        if was_off {
            target.restart()?;
            was_off = false;
        }
        let is_released = sample == drive.release_at() && target.release()?;
        let answer = match target.exchange(&sensors)? {
            Reaction::Answer(answer) => answer,
            Reaction::Reset(actuators) => {
                oracle.see_reset(sample, actuators);
                resets += 1;
                starts = true;
                injector.actuate(now, &mut world, actuators);
                continue;
            }
        };
        let wire::Actuators {
            duty_fill,
            duty_vent,
        } = answer.actuators;
        let observation = Observation {
            sensors,
            coils: [duty_fill, duty_vent].map(wire::duty_pct),
            pressure_bar: world.pressure_bar(),
            reference_bar,
            is_first: starts,
            is_damaged,
            is_released,
        };
        starts = false;
        oracle.see(&observation);
        watch(&observation, &answer.telemetry);
        if sample >= injection.onset && answer.telemetry.faults != 0 {
            latency = latency.or(Some(sample - injection.onset));
        }
        injector.actuate(now, &mut world, answer.actuators);
    }
    Ok(Outcome {
        injection: *injection,
        latency,
        samples: drive.samples(),
        resets,
        violations: oracle.violations(),
    })
}

/// Returns the scenario of an injection: its rig and its reference.
fn scenario(injection: &Injection, drive: &Drive) -> Result<Scenario, ParameterError> {
    static KINDS: OnceLock<[Scenario; 2]> = OnceLock::new();
    let kinds = KINDS.get_or_init(|| {
        let nominal = Scenario::new("campaign", ReferenceProfile::starting_at(0.0));
        let small = with_orifices(nominal.plant.clone(), FIGURE_ORIFICE_M);
        [nominal.clone(), nominal.on(small)]
    });
    let [nominal, small] = kinds;
    let kind = if injection.rig.is_multiple_of(2) {
        nominal
    } else {
        small
    };
    let plant = scattered(&kind.plant, injection.rig.into())?;
    Ok(Scenario {
        reference: drive.reference(injection),
        duration_samples: drive.samples() - lead_in_samples(),
        ..kind.clone().on_rig(plant).seeded(injection.seed)
    })
}

/// Returns the injector of `injection` on the rig `plant`.
fn injector<'a>(injection: &Injection, plant: &'a PlantParameters) -> Box<dyn Injector + 'a> {
    match injection.class {
        FaultClass::Plant(fault) => Box::new(plant::Broken::new(fault, injection, plant)),
        FaultClass::Sensor(fault) => Box::new(sensor::Broken::new(fault, injection)),
        FaultClass::Link(fault) => Box::new(link::Broken::new(fault, injection)),
        FaultClass::Ecu(fault) => Box::new(ecu::Broken::new(fault, injection, plant)),
        FaultClass::Image(fault) => Box::new(image::Broken::new(fault, injection)),
    }
}
