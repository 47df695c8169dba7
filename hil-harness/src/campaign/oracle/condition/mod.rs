//! Faults of the table that are present, judged by the data on the wire and at the coils.

mod doubt;
mod electrical;
mod offset;
mod response;
mod rig;
mod stuck;
mod watch;

use crate::scenario::Scenario;

use super::Observation;
use super::fault_reaction::FaultReaction;
use super::memory::Memory;
use crate::campaign::bounds;
use doubt::Doubt;
use electrical::{battery, coil};
use offset::Offset;
use response::Response;
use rig::Rig;
use stuck::Stuck;

pub(super) use watch::Watch;

/// Row of the table, or several rows with the same symptoms and the same reaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Condition {
    Doubt,
    Stuck,
    Offset,
    /// No rise, uncommanded fall, supply lost.
    TooLittle,
    /// No fall, uncommanded rise.
    TooMuch,
    FillCoilOpen,
    FillCoilShort,
    VentCoilOpen,
    VentCoilShort,
    Battery,
    SampleTime,
    Reference,
    Memory,
}

impl Condition {
    const ALL: [Self; 13] = [
        Self::Doubt,
        Self::Stuck,
        Self::Offset,
        Self::TooLittle,
        Self::TooMuch,
        Self::FillCoilOpen,
        Self::FillCoilShort,
        Self::VentCoilOpen,
        Self::VentCoilShort,
        Self::Battery,
        Self::SampleTime,
        Self::Reference,
        Self::Memory,
    ];

    /// Returns N (samples) and the reaction.
    const fn rule(self) -> (u32, FaultReaction) {
        match self {
            Self::Doubt => (bounds::DOUBT_N, FaultReaction::Hold),
            // The condition contains its own count.
            Self::Stuck => (1, FaultReaction::Release),
            Self::Offset => (1, FaultReaction::Vent),
            Self::TooLittle => (bounds::RESPONSE_N, FaultReaction::Ramp),
            Self::TooMuch => (bounds::RESPONSE_N, FaultReaction::Vent),
            Self::FillCoilOpen => (bounds::COIL_N, FaultReaction::Ramp),
            Self::FillCoilShort => (bounds::COIL_N, FaultReaction::Vent),
            Self::VentCoilOpen | Self::VentCoilShort => (bounds::COIL_N, FaultReaction::Off),
            Self::Battery => (bounds::BATTERY_N, FaultReaction::Hold),
            Self::SampleTime => (bounds::SAMPLE_TIME_N, FaultReaction::Release),
            Self::Reference => (bounds::REFERENCE_N, FaultReaction::Ramp),
            Self::Memory => (bounds::MEMORY_N, FaultReaction::Lock),
        }
    }
}

/// All conditions.
#[derive(Debug)]
pub(super) struct Conditions {
    rig: Rig,
    past: Past,
}

/// History that is invalid after a start of the target.
#[derive(Debug)]
struct Past {
    watches: [Watch; 13],
    /// Number of samples without any condition.
    calm_for: u32,
    last_reference_bar: f64,
    doubt: Doubt,
    stuck: Stuck,
    offset: Offset,
    response: Response,
}

impl Past {
    fn none() -> Self {
        Self {
            watches: Condition::ALL.map(Watch::new),
            calm_for: u32::MAX,
            last_reference_bar: 0.0,
            doubt: Doubt::default(),
            stuck: Stuck::default(),
            offset: Offset::default(),
            response: Response::default(),
        }
    }
}

impl Conditions {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self {
            rig: Rig::new(scenario),
            past: Past::none(),
        }
    }

    /// Clears the history: the target has started without any history.
    pub(super) fn forget(&mut self) {
        self.past = Past::none();
    }

    pub(super) fn look(&mut self, observation: &Observation, memory: &Memory) {
        let reference_bar = self.reference_bar(observation);
        let Self { rig, past } = self;
        let shown_bar = observation.shown_bar();
        past.last_reference_bar = reference_bar.unwrap_or(past.last_reference_bar);
        let is_in_doubt = past.doubt.look(rig, observation);
        let believed_bar = shown_bar.filter(|_| past.doubt.is_long_over());
        let [too_little, too_much] = past.response.look(rig, believed_bar, memory);
        let [fill_open, fill_short] = coil(rig, 0, observation.sensors.current_fill_ma, memory);
        let [vent_open, vent_short] = coil(rig, 1, observation.sensors.current_vent_ma, memory);
        let in_time = bounds::ELAPSED_MIN_US..=bounds::ELAPSED_MAX_US;
        let present = [
            is_in_doubt,
            past.stuck.look(rig, observation, memory),
            past.offset.look(rig, observation, memory),
            too_little,
            too_much,
            fill_open,
            fill_short,
            vent_open,
            vent_short,
            battery(rig, observation),
            !in_time.contains(&observation.sensors.elapsed_us),
            reference_bar.is_none(),
            observation.is_damaged,
        ];
        for (watch, is_present) in past.watches.iter_mut().zip(present) {
            watch.look(is_present, past.calm_for);
        }
        past.calm_for = if present.contains(&true) {
            0
        } else {
            past.calm_for.saturating_add(1)
        };
    }

    /// Returns whether this sample's pressure is implausible.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.past.doubt.is_present()
    }

    /// Returns whether this sample shows no condition.
    pub(super) fn is_calm(&self) -> bool {
        self.past.calm_for > 0
    }

    /// Returns whether only valves have recently changed the shown pressure.
    pub(super) fn is_steady(&self) -> bool {
        self.past.doubt.is_steady()
    }

    /// Returns the conditions that had to be answered and are not gone.
    pub(super) fn answered(&self) -> impl Iterator<Item = &Watch> {
        self.past.watches.iter().filter(|watch| watch.is_answered())
    }

    /// Returns the condition that had to be answered, if no other one was recently present.
    pub(super) fn only(&self) -> Option<&Watch> {
        let mut lately = self.past.watches.iter().filter(|watch| watch.is_recent());
        lately
            .next()
            .filter(|watch| watch.is_answered() && lately.next().is_none())
    }

    /// Returns the reference on the wire (bar gauge), if it is possible.
    pub(super) fn reference_bar(&self, observation: &Observation) -> Option<f64> {
        let bar = f64::from(observation.sensors.reference?) / 65536.0;
        (-1.0..=self.rig.supply_max_bar)
            .contains(&bar)
            .then_some(bar)
    }

    /// Returns the last possible reference (bar gauge); zero before the first.
    pub(super) fn last_reference_bar(&self) -> f64 {
        self.past.last_reference_bar
    }
}
