//! Goals of the closed loop in a vehicle, and what a controller reaches of them on scattered rigs.

use core::fmt;

use controller::Settings;
use controller::fixed::types::I16F16;
use plant_sim::PlantParameters;

use crate::checks::CheckId;
use crate::condition_table::{Condition, Measured, Row};
use crate::controller_file;
use crate::operating_conditions::ConditionScatter;
use crate::requirement::Requirement;
use crate::rigs::{self, RigError};
use crate::scenario::{
    FIGURE_ORIFICE_M, REQUIRED_ORIFICE_M, Scenario, with_normally_open_vent, with_orifices,
};

/// Volumes of the chamber (cm³).
const VOLUMES_CM3: [f64; 4] = [50.0, 75.0, 100.0, 125.0];
/// Diameters of the orifices (m).
const ORIFICES_M: [f64; 2] = [REQUIRED_ORIFICE_M, FIGURE_ORIFICE_M];

/// Largest lifts per second with an effect that the controller does not know.
const EFFECT_LIFTS_MAX_PER_S: f64 = 3.0;
/// Smallest share of the steps that settle in time with such an effect.
const EFFECT_SETTLED_MIN: f64 = 0.99;
/// Number of the effects beyond a bound that are named.
const MISSED_SHOWN: usize = 3;
/// Largest median of the vent passage from 0.88 to 0.71 p_sup (samples).
const VENT_MEDIAN_MAX_SAMPLES: f64 = 2.7;

/// Goal, with what a controller reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// Measured quantity.
    pub name: String,
    /// Bound of the goal.
    pub bound: String,
    /// Reached value, or the reason why there is none.
    pub reached: String,
    /// Whether the controller reaches the goal.
    pub holds: bool,
}

impl Goal {
    fn new(name: &str, bound: impl Into<String>, reached: String, holds: bool) -> Self {
        Self {
            name: name.to_owned(),
            bound: bound.into(),
            reached,
            holds,
        }
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = if self.holds { "yes" } else { "no" };
        write!(f, "{} ({mark})", self.reached)
    }
}

/// Rigs on which a controller is measured.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Number of rigs of each kind: volume, orifice, vent valve.
    pub rigs_of_a_kind: u32,
    /// Number of rigs of each other row.
    pub rigs: u32,
    /// Seed of all rigs.
    pub seed: u64,
}

/// Measures a controller by all goals; each kind of rig gets the duty limits and rates of its plant.
///
/// # Errors
/// Returns an error if a rig cannot be run or judged.
pub fn reached(settings: Settings, extent: &Extent) -> Result<Vec<Goal>, RigError> {
    let requirement = &Requirement::THESIS;
    let nominal = operating_range().plant;
    let mut goals = Vec::new();
    let mut healthy = Vec::new();

    let vehicles = vehicles(settings, extent, |plant| plant)?;
    goals.push(settled("vehicles: steps settled within T_req", &vehicles));
    goals.push(overshoot(&vehicles, requirement));
    goals.push(over_minimum(&vehicles));
    healthy.push(vehicles);
    let name = "vehicles with a normally open vent valve: steps settled within T_req";
    if settings.pulses.is_some() {
        goals.push(Goal::new(name, "≥ 99.9 %", "refused".to_owned(), false));
    } else {
        let vehicles = self::vehicles(settings, extent, with_normally_open_vent)?;
        goals.push(settled(name, &vehicles));
        healthy.push(vehicles);
    }

    for (orifice_m, mean_max, p90_max, lifts_max) in [
        (REQUIRED_ORIFICE_M, 8.0, 13, 1.5),
        (FIGURE_ORIFICE_M, 13.0, 23, 1.3),
    ] {
        let plant = with_orifices(nominal.clone(), orifice_m);
        let scenario = scenario(settings, extent, plant);
        let row = Condition::named("as the plant file").row(&scenario, requirement, extent.rigs)?;
        let p90 = row.settling_p90_samples;
        let p90_text = p90.map_or("never".to_owned(), |samples| samples.to_string());
        goals.push(Goal::new(
            &format!(
                "{:.1} mm: settling mean / p90 (samples); lifts per second",
                1e3 * orifice_m
            ),
            format!("≤ {mean_max:.1} / {p90_max}; {lifts_max}"),
            format!(
                "{:.1} / {p90_text}; {:.1}",
                row.settling_mean_samples, row.lifts_per_s
            ),
            row.settling_mean_samples <= mean_max
                && p90.is_some_and(|samples| samples <= p90_max)
                && row.lifts_per_s <= lifts_max,
        ));
        healthy.push(row);
    }

    goals.extend(vent_passages(settings, extent, requirement)?);
    goals.push(with_effects(settings, extent, requirement)?);
    let faults: usize = healthy.iter().map(|row| row.rigs_with_fault).sum();
    let rigs: usize = healthy.iter().map(|row| row.rigs).sum();
    goals.push(Goal::new(
        "healthy rigs with a confirmed fault",
        "0",
        format!("{faults} of {rigs}"),
        faults == 0,
    ));
    Ok(goals)
}

fn operating_range() -> Scenario {
    match Scenario::built_in("operating-range") {
        Some(scenario) => scenario,
        None => unreachable!("the scenario is built in"),
    }
}

fn scenario(settings: Settings, extent: &Extent, plant: PlantParameters) -> Scenario {
    operating_range()
        .controlled_by(settings)
        .seeded(extent.seed)
        .on(plant)
}

/// Runs all volumes and orifices under the supply voltages and temperatures of a vehicle.
fn vehicles(
    settings: Settings,
    extent: &Extent,
    change: impl Fn(PlantParameters) -> PlantParameters,
) -> Result<Row, RigError> {
    let requirement = &Requirement::THESIS;
    let mut all = Measured::default();
    for orifice_m in ORIFICES_M {
        for volume_cm3 in VOLUMES_CM3 {
            let mut plant = change(with_orifices(operating_range().plant, orifice_m));
            plant
                .set("chamber.volume_m3", 1e-6 * volume_cm3, "goals")
                .map_err(|error| RigError::Condition {
                    condition: format!("{volume_cm3} cm³"),
                    error: Box::new(error),
                })?;
            let condition = Condition {
                scatter: ConditionScatter::vehicle(&plant),
                ..Condition::named("vehicles")
            };
            let scenario = scenario(settings, extent, plant);
            all.extend(condition.measured(&scenario, requirement, extent.rigs_of_a_kind)?);
        }
    }
    Ok(all.row("vehicles".to_owned(), requirement))
}

fn settled(name: &str, row: &Row) -> Goal {
    let percent = 100.0 * (1.0 - row.late_share);
    let of_possible = 100.0 * (1.0 - row.over_minimum.late_share());
    Goal::new(
        name,
        "≥ 99.9 %",
        format!(
            "{percent:.2} % of {}; {of_possible:.2} % of the possible ones",
            row.steps
        ),
        percent >= 99.9,
    )
}

fn overshoot(row: &Row, requirement: &Requirement) -> Goal {
    Goal::new(
        "vehicles: overshoot that 99 % do not exceed (bar)",
        format!("≤ {} (P_tol)", requirement.p_tol_bar),
        format!("{:.3}", row.overshoot_p99_bar),
        row.overshoot_p99_bar <= requirement.p_tol_bar,
    )
}

fn over_minimum(row: &Row) -> Goal {
    let [median, p95] = [0.5, 0.95].map(|share| row.over_minimum.quantile(share));
    let text = |ratio: Option<f64>| ratio.map_or("never".to_owned(), |ratio| format!("{ratio:.2}"));
    let within = |ratio: Option<f64>, most| ratio.is_some_and(|ratio| ratio <= most);
    Goal::new(
        "vehicles: settling over the physical minimum, median / p95",
        "≤ 1.3 / 2",
        format!("{} / {}", text(median), text(p95)),
        within(median, 1.3) && within(p95, 2.0),
    )
}

/// Measures the vent passage with 1.9 mm, beside the valve that stays open.
fn vent_passages(
    settings: Settings,
    extent: &Extent,
    requirement: &Requirement,
) -> Result<[Goal; 2], RigError> {
    let times = |settings: Settings| -> Result<Vec<f64>, RigError> {
        let Some(scenario) = Scenario::built_in("vent-requirement") else {
            unreachable!("the scenario is built in")
        };
        let plant = scenario.plant.clone();
        let scenario = scenario
            .controlled_by(settings)
            .seeded(extent.seed)
            .on(plant);
        rigs::verdicts(&scenario, requirement, extent.rigs)
            .map(|rig| {
                let verdict = rig?.verdict;
                let check = verdict.check(CheckId::VentTime);
                Ok(check
                    .and_then(|check| check.reached)
                    .unwrap_or(f64::INFINITY))
            })
            .collect()
    };
    // A proportional controller of the largest gain: the valve stays open up to the tolerance.
    let open = times(Settings {
        gain_pct_per_bar: I16F16::lit("1000"),
        integral_time_ms: None,
        derivative_time_ms: None,
        boost: None,
        ..controller_file::thesis()
    })?;
    let driven = times(settings)?;
    let mut sorted = driven.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN);
    let limit = requirement.vent_max_t_req * f64::from(requirement.t_req_samples);
    let possible = open.iter().zip(&driven).filter(|(open, _)| **open < limit);
    let (possible, made) = possible.fold((0, 0), |(possible, made), (_, driven)| {
        (possible + 1, made + usize::from(*driven < limit))
    });
    Ok([
        Goal::new(
            "1.9 mm: 0.88 to 0.71 p_sup, median (samples)",
            format!("≤ {VENT_MEDIAN_MAX_SAMPLES}"),
            format!("{median:.2}"),
            median <= VENT_MEDIAN_MAX_SAMPLES,
        ),
        Goal::new(
            "rigs that do it within the limit, of those whose open valve does",
            "all",
            format!("{made} of {possible}"),
            made == possible,
        ),
    ])
}

/// Measures each effect of the library at its typical size, with 1.9 mm.
fn with_effects(
    settings: Settings,
    extent: &Extent,
    requirement: &Requirement,
) -> Result<Goal, RigError> {
    let plant = operating_range().plant;
    let conditions = Condition::all(&plant);
    let scenario = scenario(settings, extent, plant);
    let effects = conditions.iter().filter(|one| one.effect.is_some());
    let rows = effects.map(|condition| condition.row(&scenario, requirement, extent.rigs));
    let rows = rows.collect::<Result<Vec<Row>, _>>()?;
    let is_missed = |row: &&Row| {
        1.0 - row.late_share < EFFECT_SETTLED_MIN || row.lifts_per_s > EFFECT_LIFTS_MAX_PER_S
    };
    let mut missed: Vec<&Row> = rows.iter().filter(is_missed).collect();
    missed.sort_by(|one, other| other.late_share.total_cmp(&one.late_share));
    let mut text = format!("{} of {} effects", rows.len() - missed.len(), rows.len());
    for row in missed.iter().take(MISSED_SHOWN) {
        text += &format!(
            "; `{}` {:.1} %, {:.1}",
            row.condition,
            100.0 * (1.0 - row.late_share),
            row.lifts_per_s
        );
    }
    if let more @ 1.. = missed.len().saturating_sub(MISSED_SHOWN) {
        text += &format!("; {more} more");
    }
    Ok(Goal::new(
        "1.9 mm: effects that the controller does not know; steps settled within T_req, lifts per second",
        "all: ≥ 99 %, ≤ 3",
        text,
        missed.is_empty(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goals(settings: Settings) -> Vec<Goal> {
        let extent = Extent {
            rigs_of_a_kind: 1,
            rigs: 1,
            seed: 5,
        };
        reached(settings, &extent).unwrap()
    }

    /// On one rig of each kind, pulses reach the goals of settling, and are refused on a normally open vent valve.
    #[test]
    fn each_goal_says_what_is_reached_and_whether_that_is_enough() {
        let goals = goals(controller_file::pulses_1_9_mm());
        let named = |name: &str| {
            let found = goals.iter().find(|goal| goal.name.contains(name));
            found.unwrap_or_else(|| panic!("{name}: {goals:#?}"))
        };
        assert_eq!(goals.len(), 10, "{goals:#?}");
        let settled = named("steps settled within T_req");
        assert!(settled.reached.contains("% of 240;"), "{settled:?}");
        for name in ["physical minimum", "1.9 mm: settling", "1.3 mm: settling"] {
            assert!(named(name).holds, "{:?}", named(name));
        }
        let refused = named("normally open vent valve");
        assert_eq!(refused.to_string(), "refused (no)");
        let faults = named("confirmed fault");
        assert_eq!(faults.to_string(), "0 of 10 (yes)");
        let effects = named("does not know");
        assert!(
            effects.reached.contains("`supply_seat_leak`"),
            "{effects:?}"
        );
    }
}
