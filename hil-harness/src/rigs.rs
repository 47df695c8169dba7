//! Rigs of one kind with scattered parameters.

use plant_sim::{ParameterError, PlantParameters};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::checks::{JudgeError, Verdict};
use crate::operating_conditions::{ConditionScatter, coil_temperature_c};
use crate::random::{Random, Stream};
use crate::requirement::Requirement;
use crate::run::{RunError, run_in_process};
use crate::scenario::Scenario;

/// Scatter of one parameter, or of several together, from rig to rig: uniform, within ± `share` of the value and ±
/// `offset`.
struct Scatter {
    keys: &'static [&'static str],
    share: f64,
    offset: f64,
}

const fn relative(keys: &'static [&'static str], share: f64) -> Scatter {
    Scatter {
        keys,
        share,
        offset: 0.0,
    }
}

const fn absolute(keys: &'static [&'static str], offset: f64) -> Scatter {
    Scatter {
        keys,
        share: 0.0,
        offset,
    }
}

/// Scatter of the bench (data/README.md).
const SCATTER: &[Scatter] = &[
    relative(&["flow.discharge_fill"], 0.08),
    relative(&["flow.discharge_vent"], 0.08),
    relative(&["armature.preload_fill_n"], 0.03),
    relative(&["armature.preload_vent_n"], 0.03),
    relative(&["coil.resistance_20c_ohm"], 0.03),
    relative(
        &["coil.inductance_closed_h", "coil.inductance_open_h"],
        0.06,
    ),
    relative(&["chamber.volume_m3"], 0.03),
    relative(&["armature.spring_n_per_m"], 0.05),
    absolute(&["ecu.command_delay_s"], 1.5e-3),
    absolute(&["gas.supply_pressure_bar_gauge"], 0.15),
    // Valves without a coil: conductances like the discharge coefficients, switching times as data sheets state them (assumed).
    relative(&["on_off_fill.conductance_dm3_per_s_bar"], 0.08),
    relative(&["on_off_vent.conductance_dm3_per_s_bar"], 0.08),
    relative(
        &["on_off_fill.opening_delay_s", "on_off_fill.closing_delay_s"],
        0.1,
    ),
    relative(
        &["on_off_vent.opening_delay_s", "on_off_vent.closing_delay_s"],
        0.1,
    ),
    relative(&["proportional_fill.conductance_dm3_per_s_bar"], 0.08),
    relative(&["proportional_vent.conductance_dm3_per_s_bar"], 0.08),
];

/// Returns one scattered rig of the kind of `parameters`: the same seed gives the same rig.
///
/// # Errors
/// Returns an error if a scattered value leaves the range of its parameter, as is possible for a kind at the edge of a
/// range.
pub fn scattered(
    parameters: &PlantParameters,
    seed: u64,
) -> Result<PlantParameters, ParameterError> {
    let random = Random::new(seed, Stream::RigScatter);
    let mut rig = parameters.clone();
    for (counter, scatter) in (0..).zip(SCATTER) {
        let draw = random.symmetric(counter);
        for key in scatter.keys {
            let Some(value) = parameters.get(key) else {
                continue;
            };
            let scattered = value * (1.0 + scatter.share * draw) + scatter.offset * draw;
            rig.set(key, scattered, "rig-to-rig scatter")?;
        }
    }
    Ok(rig)
}

/// Result of one rig of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigVerdict {
    /// Number of the rig, from 0.
    pub rig: u32,
    /// Seed of its scenario: [`scattered`] gives the rig, and the same scenario with this seed repeats the run.
    pub seed: u64,
    /// Supply voltage (V); at time 0, if it changes; `None` without coils.
    pub supply_voltage_v: Option<f64>,
    /// Temperature of the coils (°C); at the start, if it changes; `None` without coils.
    pub coil_temperature_c: Option<f64>,
    /// Verdict on the loop.
    pub verdict: Verdict,
}

/// Reason why a batch has no result for a rig.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// The scattered parameters give no valid plant.
    #[error("rig {rig} (seed {seed}): {error}")]
    Parameters {
        /// Number of the rig.
        rig: u32,
        /// Seed of the rig.
        seed: u64,
        /// Error of the parameter.
        error: Box<ParameterError>,
    },
    /// The rig could not be run.
    #[error("rig {rig} (seed {seed}): {error}")]
    Run {
        /// Number of the rig.
        rig: u32,
        /// Seed of the rig.
        seed: u64,
        /// Error of the run.
        error: Box<RunError>,
    },
    /// A value of the operating conditions is out of range.
    #[error("{condition}: {error}")]
    Condition {
        /// Name of the condition.
        condition: String,
        /// Error of the parameter.
        error: Box<ParameterError>,
    },
    /// The run could not be judged.
    #[error(transparent)]
    Judge(#[from] JudgeError),
}

/// Runs `scenario` on `count` rigs of its plant's kind under its own operating conditions, lazily, one per step of the
/// iterator.
pub fn verdicts<'a>(
    scenario: &'a Scenario,
    requirement: &'a Requirement,
    count: u32,
) -> impl ExactSizeIterator<Item = Result<RigVerdict, RigError>> + 'a {
    verdicts_in_operation(scenario, requirement, count, ConditionScatter::default())
}

/// Runs `scenario` on the same rigs as [`verdicts`], each under its own operating conditions.
pub fn verdicts_in_operation<'a>(
    scenario: &'a Scenario,
    requirement: &'a Requirement,
    count: u32,
    conditions: ConditionScatter,
) -> impl ExactSizeIterator<Item = Result<RigVerdict, RigError>> + 'a {
    (0..count).map(move |rig| rig_verdict(scenario, requirement, rig, conditions))
}

/// Runs `scenario` on one rig of [`verdicts_in_operation`].
///
/// # Errors
/// Returns an error if a scattered value leaves the range of its parameter, or the scenario cannot be run.
pub fn rig_verdict(
    scenario: &Scenario,
    requirement: &Requirement,
    rig: u32,
    conditions: ConditionScatter,
) -> Result<RigVerdict, RigError> {
    let scenario = rig_in_operation(scenario, rig, conditions)?;
    let seed = scenario.seed;
    let run = run_in_process(&scenario).map_err(|error| RigError::Run {
        rig,
        seed,
        error: Box::new(error),
    })?;
    let coil_temperature_c = coil_temperature_c(&scenario.plant);
    let of_plant_v = scenario.plant.ecu.supply_voltage_v;
    let supply_v = || {
        scenario
            .supply
            .map_or(of_plant_v, |supply| supply.at_s(0.0))
    };
    Ok(RigVerdict {
        rig,
        seed,
        supply_voltage_v: coil_temperature_c.map(|_| supply_v()),
        coil_temperature_c,
        verdict: run.verdict(requirement)?,
    })
}

/// Returns the scenario of one rig of [`verdicts_in_operation`]: its plant, seed and operating conditions.
///
/// # Errors
/// Returns an error if a scattered value leaves the range of its parameter.
pub fn rig_in_operation(
    scenario: &Scenario,
    rig: u32,
    conditions: ConditionScatter,
) -> Result<Scenario, RigError> {
    let seed = Random::new(scenario.seed, Stream::RigSeed).bits(rig.into());
    let on_rig = || {
        let plant = scattered(&scenario.plant, seed)?;
        let scenario = scenario.clone().on_rig(plant).seeded(seed);
        conditions.draw(seed).applied_to(scenario)
    };
    on_rig().map_err(|error| RigError::Parameters {
        rig,
        seed,
        error: Box::new(error),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every scattered parameter is within the bounds of data/README.md and uses them, over many rigs.
    #[test]
    fn rigs_differ_within_the_scatter_of_the_bench_and_use_all_of_it() {
        let kind = PlantParameters::nominal();
        let rigs: Vec<_> = (0..300)
            .map(|seed| scattered(&kind, seed).unwrap())
            .collect();
        for (key, half_width) in [
            ("flow.discharge_fill", 0.08 * 0.95),
            ("flow.discharge_vent", 0.08 * 0.97),
            ("armature.preload_fill_n", 0.03 * 3.58),
            ("armature.preload_vent_n", 0.03 * 3.34),
            ("coil.resistance_20c_ohm", 0.03 * 82.2),
            ("coil.inductance_closed_h", 0.06 * 0.44),
            ("coil.inductance_open_h", 0.06 * 0.48),
            ("chamber.volume_m3", 0.03 * 75e-6),
            ("armature.spring_n_per_m", 0.05 * 2800.0),
            ("ecu.command_delay_s", 1.5e-3),
            ("gas.supply_pressure_bar_gauge", 0.15),
        ] {
            let centre = kind.get(key).unwrap();
            let widest = rigs
                .iter()
                .map(|rig| (rig.get(key).unwrap() - centre).abs())
                .fold(0.0, f64::max);
            let share = widest / half_width;
            assert!(
                share > 0.95 && share <= 1.0 + 1e-12,
                "{key}: {share} of its scatter"
            );
        }
    }

    #[test]
    fn inductances_scatter_together_and_the_rest_stays() {
        let kind = PlantParameters::nominal();
        let rig = scattered(&kind, 7).unwrap();
        let ratio =
            |rig: &PlantParameters| rig.coil.inductance_open_h / rig.coil.inductance_closed_h;
        assert!((ratio(&rig) - ratio(&kind)).abs() < 1e-12);
        assert_eq!(rig.armature.mass_kg, kind.armature.mass_kg);
        assert_eq!(rig.flow.orifice_fill_m, kind.flow.orifice_fill_m);
    }

    #[test]
    fn a_seed_is_a_rig() {
        let kind = PlantParameters::nominal();
        assert_eq!(scattered(&kind, 7).unwrap(), scattered(&kind, 7).unwrap());
        assert_ne!(scattered(&kind, 7).unwrap(), scattered(&kind, 8).unwrap());
    }
}
