//! Oracle: the verdict on a run, from outside the target.
//!
//! ```text
//!  Sensors on the wire ─┬─► Conditions: which faults of the table are present?  ─► obligations ─► Reactions: is each met?
//!  duties at the coils ─┤                                                             │
//!  true pressure       ─┴─► Always: what no fault excuses                             └──► Permission: may it fill?
//! ```

mod always;
mod condition;
mod during_reaction;
mod fault_reaction;
mod memory;
mod permission;
mod takeover;

use core::fmt;

use ecu::SensorCode;

use super::bounds;
use super::driver::Drive;
use super::injection::Injection;
use crate::duty_factors::factor;
use crate::scenario::Scenario;
use crate::wire::{Actuators, Sensors, measured_bar};
use condition::Conditions;
use memory::Memory;
use permission::Permission;
use takeover::Takeover;

/// One sample as observation from outside.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Sensors and reference sent to the target.
    pub sensors: Sensors,
    /// Resulting duty cycles of the coils of fill and vent valve (%).
    pub coils: [f64; 2],
    /// True chamber pressure when the sensors were sent (bar gauge).
    pub pressure_bar: f64,
    /// Reference of the driver, without faults of the link (bar gauge).
    pub reference_bar: f64,
    /// Whether the target started with this sample.
    pub is_first: bool,
    /// Whether the target's memory was damaged before this sample.
    pub is_damaged: bool,
    /// Whether a release was granted before this sample.
    pub is_released: bool,
}

impl Observation {
    /// Returns the factor of the duty limits by the measured supply voltage.
    fn voltage_factor(&self) -> f64 {
        let measured_v = self
            .sensors
            .battery_mv
            .map(|millivolts| f64::from(millivolts) * 1e-3);
        measured_v.map_or(1.0, |volt| factor(bounds::NOMINAL_V, volt))
    }

    /// Returns the pressure shown to the target (bar gauge); `None` for a code that a 12-bit converter cannot give.
    fn shown_bar(&self) -> Option<f64> {
        let code = self.sensors.pressure?;
        SensorCode::from_bits(code).map(|_| measured_bar(code))
    }
}

/// Requirement on the ECU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CampaignRequirement {
    /// Both coils are never driven at once.
    OneCoil,
    /// Each coil gets 0, or a duty cycle within the limits of its valve, or the vent valve gets 100 % to empty the
    /// chamber.
    DutyLimits,
    /// The pressure is never above the supply pressure.
    BelowSupply,
    /// Both valves are shut in a sample with an implausible pressure, or the chamber is being emptied.
    ShutInDoubt,
    /// No sample without a reference opens the fill valve further.
    NoIncreaseWithoutReference,
    /// The chamber is not filled far above the reference.
    TowardsTheReference,
    /// The chamber is not filled after a reset, or after it was emptied, until the reference was zero.
    NeutralFirst,
    /// The chamber is not filled from N samples of a fault on, until the fault is gone.
    NoFillAfterN,
    /// The pressure does not rise after filling has stopped.
    NoRiseAfterN,
    /// While a fault may pass, both valves are shut and the pressure stays.
    Held,
    /// The pressure follows a ramp down and does not drop.
    NoSuddenLoss,
    /// Both coils are off at the end of the reaction.
    SafeInTime,
    /// The chamber is empty at the end of the reaction.
    EmptyInTime,
    /// The pressure recovers on the ramp, without a bump.
    NoBump,
    /// The first duty cycle after both valves were shut is no larger than the next one, if no input has changed in
    /// between.
    NoKick,
    /// A fault that came back too often, or damaged memory, locks the ECU.
    StaysLocked,
    /// The loop recovers without intervention from a fault that ends before the reaction empties the chamber.
    ResumesByItself,
    /// The loop is at the reference again once the fault is gone and the reference was zero.
    Live,
}

impl CampaignRequirement {
    /// Returns whether it is a safety requirement, not one of recovery.
    pub const fn is_safety(self) -> bool {
        !matches!(self, Self::ResumesByItself | Self::Live)
    }
}

/// Violated requirement, at its first violation.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// Violated requirement.
    pub requirement: CampaignRequirement,
    /// Number of the sample.
    pub sample: u32,
    /// Evidence of the violation.
    pub evidence: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:?} in sample {}: {}",
            self.requirement, self.sample, self.evidence
        )
    }
}

/// Judge of a run, sample by sample.
#[derive(Debug)]
pub struct Oracle {
    drive: Drive,
    supply_bar: f64,
    leaves_venting: bool,
    is_plain: bool,
    memory: Memory,
    conditions: Conditions,
    permission: Permission,
    takeover: Takeover,
    violations: Vec<Violation>,
}

impl Oracle {
    pub(super) fn new(injection: &Injection, scenario: &Scenario, drive: Drive) -> Self {
        Self {
            drive,
            supply_bar: scenario.plant.gas.supply_pressure_bar_gauge,
            leaves_venting: injection.class.leaves_venting(),
            is_plain: injection.class.is_plain(),
            memory: Memory::new(),
            conditions: Conditions::new(scenario),
            permission: Permission::new(injection.class.is_plain()),
            takeover: Takeover::default(),
            violations: Vec::new(),
        }
    }

    /// Takes one sample with an answer of the target.
    pub fn see(&mut self, observation: &Observation) {
        if observation.is_first {
            self.conditions.forget();
            self.memory.forget();
            self.takeover = Takeover::default();
        }
        self.conditions.look(observation, &self.memory);
        self.permission.look(observation, &self.conditions);
        self.takeover
            .look(observation, &self.memory, &self.conditions);
        let broken = always::broken(observation, self)
            .into_iter()
            .chain(permission::broken(observation, self))
            .chain(during_reaction::broken(observation, self))
            .chain([self.takeover.broken(observation)])
            .chain(self.liveness(observation));
        let broken: Vec<(CampaignRequirement, String)> = broken.flatten().collect();
        for (requirement, evidence) in broken {
            self.add(requirement, observation.sensors.sample, evidence);
        }
        self.memory.remember(observation);
    }

    /// Takes one sample in which the target restarted instead of answering: no coil may be driven.
    pub(super) fn see_reset(&mut self, sample: u32, actuators: Actuators) {
        if actuators != Actuators::OFF {
            let evidence = format!("after a reset the coils get {actuators:?}");
            self.add(CampaignRequirement::SafeInTime, sample, evidence);
        }
    }

    /// Returns the violations, the first of each requirement, in the order of time.
    pub fn violations(self) -> Vec<Violation> {
        self.violations
    }

    fn add(&mut self, requirement: CampaignRequirement, sample: u32, evidence: String) {
        if self
            .violations
            .iter()
            .all(|violation| violation.requirement != requirement)
        {
            self.violations.push(Violation {
                requirement,
                sample,
                evidence,
            });
        }
    }

    fn liveness(&self, observation: &Observation) -> [Option<(CampaignRequirement, String)>; 2] {
        let sample = observation.sensors.sample;
        let is_near =
            (observation.pressure_bar - observation.reference_bar).abs() <= bounds::LIVE_BAR;
        let broken = |requirement, is_due: bool| {
            let evidence = || {
                let Observation {
                    pressure_bar,
                    reference_bar,
                    ..
                } = observation;
                format!("{pressure_bar:.3} bar at a reference of {reference_bar:.3} bar")
            };
            (is_due && !is_near).then(|| (requirement, evidence()))
        };
        let is_live_due = self.drive.has_to_be_live(sample) && !self.permission.is_damaged();
        [
            broken(
                CampaignRequirement::ResumesByItself,
                self.drive.has_to_have_resumed(sample),
            ),
            broken(CampaignRequirement::Live, is_live_due),
        ]
    }
}

/// Result of a rule for a sample: none, or the violated requirement and the evidence.
type Finding = Option<(CampaignRequirement, String)>;

/// Returns a violation of `requirement` unless it `is_met`.
fn unless(
    is_met: bool,
    requirement: CampaignRequirement,
    evidence: impl FnOnce() -> String,
) -> Finding {
    (!is_met).then(|| (requirement, evidence()))
}
