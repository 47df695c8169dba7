//! The loop under each operating condition and with each effect of the library, on scattered rigs.

use core::fmt;

use plant_sim::effects::{EffectSetting, LIBRARY};
use plant_sim::replay::ACTUATOR_POSITION;
use plant_sim::{ParameterError, PlantParameters};

use crate::checks::StepResponse;
use crate::operating_conditions::{
    COIL_TEMPERATURE_RANGE_C, ConditionScatter, OperatingConditions,
};
use crate::physical_minimum::physical_minimum_samples;
use crate::requirement::Requirement;
use crate::rigs::{self, RigError, RigVerdict};
use crate::scenario::Scenario;
use crate::settling_times::SettlingTimes;
use crate::voltage_profile::{Supply, VOLTAGE_PROFILES};

/// Settling time that a step counts with if it never settles (samples): longer than any that does.
pub const NEVER_SAMPLES: u32 = 100;

/// Condition of the table, applied to every rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Name, such as `supply 18 V`.
    pub name: String,
    /// Operating conditions of every rig.
    pub conditions: OperatingConditions,
    /// Scatter of the operating conditions from rig to rig.
    pub scatter: ConditionScatter,
    /// Effect of the plant that controller and ECU do not know.
    pub effect: Option<EffectSetting>,
}

impl Condition {
    pub(crate) fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            conditions: OperatingConditions::default(),
            scatter: ConditionScatter::default(),
            effect: None,
        }
    }

    fn supply(name: impl Into<String>, supply: Supply) -> Self {
        Self {
            conditions: OperatingConditions {
                supply: Some(supply),
                ..OperatingConditions::default()
            },
            ..Self::named(name)
        }
    }

    fn coils(celsius: f64) -> Self {
        Self {
            conditions: OperatingConditions {
                coil_temperature_c: Some(celsius),
                ..OperatingConditions::default()
            },
            ..Self::named(format!("coils at {celsius} °C"))
        }
    }

    /// Returns the conditions of the table for a kind of rig: the plant's own, the supply voltages and temperatures of a
    /// vehicle, all of these at once, and each effect of the library that acts on it, at its typical size. An actuator
    /// rests in the loop.
    pub fn all(plant: &PlantParameters) -> Vec<Self> {
        let volts = [18.0, 20.0, 22.0, 26.0, 28.0, 30.0, 32.0];
        let constant =
            volts.map(|volt| Self::supply(format!("supply {volt} V"), Supply::Constant(volt)));
        let profiles = VOLTAGE_PROFILES.iter().map(|profile| {
            Self::supply(
                format!("supply {}", profile.name),
                Supply::Profile(*profile),
            )
        });
        let coils = COIL_TEMPERATURE_RANGE_C.map(Self::coils);
        let vehicle = Self {
            scatter: ConditionScatter::vehicle(plant),
            ..Self::named("18 to 32 V, -40 to 120 °C")
        };
        let acting = LIBRARY
            .iter()
            .filter_map(|effect| plant.forms_of(*effect).into_iter().next())
            .filter(|effect| effect.driven_by() != Some(ACTUATOR_POSITION));
        let effects = acting.map(|effect| Self {
            effect: Some(effect.clone()),
            ..Self::named(effect.id())
        });
        core::iter::once(Self::named("as the plant file"))
            .chain(constant)
            .chain(profiles)
            .chain(coils)
            .chain([vehicle])
            .chain(effects)
            .collect()
    }

    /// Returns the scenario under this condition, with the settings of the ECU for the kind of rig.
    ///
    /// # Errors
    /// Returns an error if a value is out of range for its parameter of the plant.
    pub fn applied_to(&self, scenario: Scenario) -> Result<Scenario, ParameterError> {
        let scenario = self.conditions.applied_to(scenario)?;
        Ok(match &self.effect {
            Some(effect) => {
                let plant = scenario.plant.with_effect(effect.clone());
                scenario.on_rig(plant)
            }
            None => scenario,
        })
    }

    /// Runs `scenario` under this condition on `count` rigs.
    ///
    /// # Errors
    /// Returns an error if a rig cannot be run or judged.
    pub fn row(
        &self,
        scenario: &Scenario,
        requirement: &Requirement,
        count: u32,
    ) -> Result<Row, RigError> {
        let measured = self.measured(scenario, requirement, count)?;
        Ok(measured.row(self.name.clone(), requirement))
    }

    /// Runs `scenario` under this condition on `count` rigs, without a summary.
    pub(crate) fn measured(
        &self,
        scenario: &Scenario,
        requirement: &Requirement,
        count: u32,
    ) -> Result<Measured, RigError> {
        let scenario = self
            .applied_to(scenario.clone())
            .map_err(|error| RigError::Condition {
                condition: self.name.clone(),
                error: Box::new(error),
            })?;
        let rigs = rigs::verdicts_in_operation(&scenario, requirement, count, self.scatter)
            .collect::<Result<Vec<_>, _>>()?;
        let mut over_minimum = OverMinimum::default();
        for rig in &rigs {
            let scenario = rigs::rig_in_operation(&scenario, rig.rig, self.scatter)?;
            over_minimum.add(&scenario, &rig.verdict.steps, requirement);
        }
        Ok(Measured { rigs, over_minimum })
    }
}

/// Verdicts on rigs under a condition, beside what their valves allow.
#[derive(Default)]
pub(crate) struct Measured {
    pub(crate) rigs: Vec<RigVerdict>,
    over_minimum: OverMinimum,
}

impl Measured {
    /// Adds rigs of another kind.
    pub(crate) fn extend(&mut self, other: Self) {
        self.rigs.extend(other.rigs);
        self.over_minimum.ratios.extend(other.over_minimum.ratios);
        self.over_minimum.late += other.over_minimum.late;
    }

    /// Returns the summary of all rigs under this name.
    pub(crate) fn row(self, name: String, requirement: &Requirement) -> Row {
        Row {
            over_minimum: self.over_minimum,
            ..Row::of(name, &self.rigs, requirement)
        }
    }
}

/// Row of the table: steps to references of the operating range on all rigs.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the condition.
    pub condition: String,
    /// Mean settling time (samples); a step that never settles counts as [`NEVER_SAMPLES`].
    pub settling_mean_samples: f64,
    /// Time within which 90 % of the steps settle (samples); `None`: never.
    pub settling_p90_samples: Option<u32>,
    /// Share of steps that settle later than T_req, 0 to 1.
    pub late_share: f64,
    /// The same steps beside what the valves of their rig allow.
    pub over_minimum: OverMinimum,
    /// Overshoot that 99 % of the steps do not exceed (bar).
    pub overshoot_p99_bar: f64,
    /// Lifts of both valves (1/s).
    pub lifts_per_s: f64,
    /// Number of rigs on which the ECU confirmed a fault.
    pub rigs_with_fault: usize,
    /// Confirmed faults, each with its number of rigs, the most frequent first.
    pub faults: Vec<(String, usize)>,
    /// Number of rigs.
    pub rigs: usize,
    /// Number of steps on all of them.
    pub steps: usize,
}

impl Row {
    /// Summarises the verdicts on rigs under a condition, without the physical minimum.
    pub(crate) fn of(condition: String, rigs: &[RigVerdict], requirement: &Requirement) -> Self {
        let settling = SettlingTimes::of_steps(rigs);
        let sum: u32 = settling.samples.iter().sum();
        let count = settling.count().max(1) as f64;
        let verdicts = || rigs.iter().map(|rig| &rig.verdict);
        let faults_of = |rig: &RigVerdict| rig.verdict.confirmed_faults.clone().unwrap_or_default();
        let mut faults: Vec<(String, usize)> = Vec::new();
        for fault in rigs.iter().flat_map(faults_of) {
            match faults.iter_mut().find(|(name, _)| *name == fault.fault) {
                Some((_, rigs)) => *rigs += 1,
                None => faults.push((fault.fault, 1)),
            }
        }
        faults.sort_by_key(|(_, rigs)| core::cmp::Reverse(*rigs));
        let per_s = verdicts().filter_map(|verdict| verdict.actuations);
        Self {
            condition,
            settling_mean_samples: (f64::from(sum)
                + (settling.never * NEVER_SAMPLES as usize) as f64)
                / count,
            settling_p90_samples: settling.quantile(0.9),
            late_share: 1.0
                - settling
                    .share_within(requirement.t_req_samples)
                    .unwrap_or(1.0),
            over_minimum: OverMinimum::default(),
            overshoot_p99_bar: overshoot(rigs, 0.99),
            lifts_per_s: per_s.map(|actuations| actuations.per_s).sum::<f64>()
                / rigs.len().max(1) as f64,
            rigs_with_fault: rigs.iter().filter(|rig| !faults_of(rig).is_empty()).count(),
            faults,
            rigs: rigs.len(),
            steps: settling.count(),
        }
    }
}

/// Head of a table of rows, in Markdown.
pub const TABLE_HEAD: &str = "\
| condition | settling mean / p90 | later than T_req | of the possible ones | over the minimum: median / p95 | overshoot p99 (bar) | lifts per s | rigs with a fault |
|---|--:|--:|--:|--:|--:|--:|---|";

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let p90 = self.settling_p90_samples;
        write!(
            f,
            "| {} | {:.1} / {} | {:.1} % | {:.1} % | {} / {} | {:.2} | {:.1} | {}",
            self.condition,
            self.settling_mean_samples,
            p90.map_or("never".to_owned(), |samples| samples.to_string()),
            100.0 * self.late_share,
            100.0 * self.over_minimum.late_share(),
            ratio(self.over_minimum.quantile(0.5)),
            ratio(self.over_minimum.quantile(0.95)),
            self.overshoot_p99_bar,
            self.lifts_per_s,
            self.rigs_with_fault,
        )?;
        for (index, (fault, rigs)) in self.faults.iter().enumerate() {
            let separator = if index == 0 { ":" } else { "," };
            write!(f, "{separator} {fault} {rigs}")?;
        }
        f.write_str(" |")
    }
}

/// Settling times of the steps that the valves of their rig can make within T_req, over the physical minimum.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OverMinimum {
    /// Settling time over the physical minimum of each step; `None`: never settled.
    ratios: Vec<Option<f64>>,
    late: usize,
}

impl OverMinimum {
    fn add(&mut self, scenario: &Scenario, steps: &[StepResponse], requirement: &Requirement) {
        for step in steps.iter().filter(|step| step.in_operating_range) {
            let Some(minimum) = physical_minimum_samples(scenario, step, requirement) else {
                continue;
            };
            let settled = step.settled_samples;
            let is_late = settled.is_none_or(|samples| samples > requirement.t_req_samples);
            self.late += usize::from(is_late);
            let ratio = |samples| f64::from(samples) / f64::from(minimum.max(1));
            self.ratios.push(settled.map(ratio));
        }
    }

    /// Returns the number of steps that are possible.
    pub fn count(&self) -> usize {
        self.ratios.len()
    }

    /// Returns the share of the possible steps that settle later than T_req, 0 to 1.
    pub fn late_share(&self) -> f64 {
        self.late as f64 / self.count().max(1) as f64
    }

    /// Returns the ratio to the physical minimum that this share of the possible steps, 0 to 1, does not exceed; `None`
    /// if too many never settle.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let mut ratios = self.ratios.clone();
        let key = |ratio: &Option<f64>| ratio.unwrap_or(f64::INFINITY);
        ratios.sort_by(|one, other| key(one).total_cmp(&key(other)));
        let rank = (share * ratios.len() as f64).ceil().max(1.0) as usize;
        ratios.get(rank - 1).copied().flatten()
    }
}

fn ratio(ratio: Option<f64>) -> String {
    ratio.map_or("never".to_owned(), |ratio| format!("{ratio:.2}"))
}

/// Returns the overshoot that a share of the steps, 0 to 1, does not exceed (bar).
fn overshoot(rigs: &[RigVerdict], share: f64) -> f64 {
    let steps = rigs.iter().flat_map(|rig| &rig.verdict.steps);
    let in_range = steps.filter(|step| step.in_operating_range);
    let mut overshoots: Vec<f64> = in_range.map(|step| step.overshoot_bar).collect();
    overshoots.sort_by(f64::total_cmp);
    let rank = (share * overshoots.len() as f64).ceil() as usize;
    overshoots
        .get(rank.saturating_sub(1))
        .copied()
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReferenceProfile;

    /// A controller that never fills settles no step, and the row says so.
    #[test]
    fn a_loop_that_never_settles_is_late_on_every_step() {
        let mut scenario = Scenario::new(
            "never",
            ReferenceProfile::starting_at(0.0)
                .step_to(3.0)
                .hold_ms(1000)
                .step_to(2.0)
                .hold_ms(1000),
        );
        let requirement = Requirement::THESIS;
        let plain = Condition::named("plain");
        let row = plain.row(&scenario, &requirement, 3).unwrap();
        assert_eq!((row.rigs, row.late_share, row.rigs_with_fault), (3, 0.0, 0));
        assert!(
            row.settling_mean_samples < 30.0 && row.settling_p90_samples.unwrap() < 40,
            "{row:?}"
        );
        scenario
            .plant
            .set("ecu.supply_voltage_v", 6.0, "test")
            .unwrap();
        let row = plain.row(&scenario, &requirement, 3).unwrap();
        assert_eq!((row.late_share, row.settling_p90_samples), (1.0, None));
        assert_eq!(row.settling_mean_samples, f64::from(NEVER_SAMPLES));
        assert_eq!(row.rigs_with_fault, 3);
        assert!(
            row.faults
                .iter()
                .any(|(fault, rigs)| fault == "BatteryLow" && *rigs == 3),
            "{row:?}"
        );
    }

    #[test]
    fn every_condition_has_its_own_name_and_every_effect_a_row() {
        let conditions = Condition::all(&PlantParameters::nominal());
        let mut names: Vec<&str> = conditions.iter().map(|one| one.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), conditions.len());
        let effects = conditions.iter().filter(|one| one.effect.is_some()).count();
        // All but that of on/off valves and that of an actuator, which rests in the loop.
        assert_eq!(effects, LIBRARY.len() - 2);
    }
}
