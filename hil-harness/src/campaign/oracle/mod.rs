//! The verdict over a run, from outside the target.
//!
//! ```text
//!  Sensors on the wire ─┬─► Conditions: which faults of the table are present?  ─► obligations ─► Ways: is each kept?
//!  duties at the coils ─┤                                                             │
//!  true pressure       ─┴─► Always: what no fault excuses                             └──► Permission: may it fill?
//! ```

mod always;
mod condition;
mod memory;
mod on_the_way;
mod permission;
mod takeover;
mod way;

use core::fmt;

use ecu::SensorCode;

use super::bounds;
use super::driver::Drive;
use super::injection::Injection;
use crate::scenario::Scenario;
use crate::wire::{Actuators, Sensors, measured_bar};
use condition::Conditions;
use memory::Memory;
use permission::Permission;
use takeover::Takeover;

/// One sample as it is seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// What the target was told.
    pub sensors: Sensors,
    /// What the coils of fill and vent valve then got \[%\].
    pub coils: [f64; 2],
    /// The true chamber pressure when the target was told [bar gauge].
    pub pressure_bar: f64,
    /// What the driver asks for, whatever came of it on the link [bar gauge].
    pub reference_bar: f64,
    /// The target started with this sample.
    pub is_first: bool,
    /// The target's memory was damaged before this sample.
    pub is_damaged: bool,
    /// A release was granted before this sample.
    pub is_released: bool,
}

impl Seen {
    /// The pressure that the target is shown [bar gauge]; none where the code is none of a 12-bit converter.
    fn shown_bar(&self) -> Option<f64> {
        let code = self.sensors.pressure?;
        SensorCode::from_bits(code).map(|_| measured_bar(code))
    }
}

/// What was promised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Promise {
    /// Never both coils at once.
    OneCoil,
    /// Each coil gets 0, or a duty cycle within the limits of its valve, or the vent valve 100 % to empty the chamber.
    DutyLimits,
    /// No pressure above the supply's.
    BelowSupply,
    /// Both valves are shut in a sample whose pressure cannot be believed, or the chamber is being emptied.
    ShutInDoubt,
    /// No sample without a reference opens the fill valve further.
    NoIncreaseWithoutReference,
    /// Nothing is filled far above the reference.
    TowardsTheReference,
    /// Nothing is filled after a reset, or after the chamber was given up, until the reference was at zero.
    NeutralFirst,
    /// Nothing is filled from N samples of a fault on, until it is gone.
    NoFillAfterN,
    /// Once nothing is filled, the pressure does not rise.
    NoRiseAfterN,
    /// While a fault may pass, the pressure is held: no valve moves.
    Held,
    /// The pressure is led down, not dropped.
    NoSuddenLoss,
    /// Both coils are off in the end.
    SafeInTime,
    /// The chamber is empty in the end.
    EmptyInTime,
    /// The pressure comes back on the ramp, without a bump.
    NoBump,
    /// The first duty cycle after both valves were shut is no larger than the next, where nothing has changed in between.
    NoKick,
    /// A fault that came back too often, or damaged memory, locks.
    StaysLocked,
    /// The loop comes back by itself from a fault that the table lets pass.
    ResumesByItself,
    /// The loop is at the reference again once the fault is gone and the reference was taken back.
    Live,
}

impl Promise {
    /// Whether it is about safety, not about being live again.
    pub const fn is_safety(self) -> bool {
        !matches!(self, Self::ResumesByItself | Self::Live)
    }
}

/// A promise that was not kept, where it was broken first.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// Which.
    pub promise: Promise,
    /// In which sample.
    pub sample: u32,
    /// What was seen.
    pub evidence: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:?} in sample {}: {}",
            self.promise, self.sample, self.evidence
        )
    }
}

/// Judges a run, sample by sample.
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
            conditions: Conditions::new(&scenario.supervision),
            permission: Permission::new(injection.class.is_plain()),
            takeover: Takeover::default(),
            violations: Vec::new(),
        }
    }

    /// One sample in which the target was asked.
    pub fn see(&mut self, seen: &Seen) {
        if seen.is_first {
            self.conditions.forget();
            self.memory.forget();
            self.takeover = Takeover::default();
        }
        self.conditions.look(seen, &self.memory);
        self.permission.look(seen, &self.conditions);
        self.takeover.look(seen, &self.memory, &self.conditions);
        let broken = always::broken(seen, self)
            .into_iter()
            .chain(permission::broken(seen, self))
            .chain(on_the_way::broken(seen, self))
            .chain([self.takeover.broken(seen)])
            .chain(self.liveness(seen));
        let broken: Vec<(Promise, String)> = broken.flatten().collect();
        for (promise, evidence) in broken {
            self.add(promise, seen.sensors.sample, evidence);
        }
        self.memory.remember(seen);
    }

    /// One sample in which the target started again instead of answering: nobody has a reason to drive a coil.
    pub(super) fn see_reset(&mut self, sample: u32, actuators: Actuators) {
        if actuators != Actuators::OFF {
            let evidence = format!("after a reset the coils get {actuators:?}");
            self.add(Promise::SafeInTime, sample, evidence);
        }
    }

    /// What was not kept, the first of each promise, in the order of time.
    pub fn violations(self) -> Vec<Violation> {
        self.violations
    }

    fn add(&mut self, promise: Promise, sample: u32, evidence: String) {
        if self
            .violations
            .iter()
            .all(|violation| violation.promise != promise)
        {
            self.violations.push(Violation {
                promise,
                sample,
                evidence,
            });
        }
    }

    fn liveness(&self, seen: &Seen) -> [Option<(Promise, String)>; 2] {
        let sample = seen.sensors.sample;
        let is_near = (seen.pressure_bar - seen.reference_bar).abs() <= bounds::LIVE_BAR;
        let broken = |promise, is_due: bool| {
            let evidence = || {
                let Seen {
                    pressure_bar,
                    reference_bar,
                    ..
                } = seen;
                format!("{pressure_bar:.3} bar at a reference of {reference_bar:.3} bar")
            };
            (is_due && !is_near).then(|| (promise, evidence()))
        };
        let is_live_due = self.drive.has_to_be_live(sample) && !self.permission.is_damaged();
        [
            broken(
                Promise::ResumesByItself,
                self.drive.has_to_have_resumed(sample),
            ),
            broken(Promise::Live, is_live_due),
        ]
    }
}

/// What a rule says of a sample: nothing, or which promise is broken and what was seen.
type Finding = Option<(Promise, String)>;

/// `promise` is broken unless it `holds`.
fn unless(holds: bool, promise: Promise, evidence: impl FnOnce() -> String) -> Finding {
    (!holds).then(|| (promise, evidence()))
}
