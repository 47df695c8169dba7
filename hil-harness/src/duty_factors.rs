//! Factors by which supply voltage and coil resistance multiply the duty limits of a controller with compensation.

use controller::Compensation;
use plant_sim::PlantParameters;
use plant_sim::plant::{FILL, VENT};

use crate::scenario::Scenario;
use crate::wire::Exchange;

/// Relative error of the ECU's factor: noise and steps of the measured current and voltage, the duty cycle that counts as
/// constant, and the change of the coil's flux within a period.
const ERROR: f64 = 0.06;
/// Voltages that the duty limits follow, and the lowest plausible one (V).
const FOLLOWED_V: [f64; 2] = [9.0, 60.0];
const PLAUSIBLE_MIN_V: f64 = 6.0;

/// Returns the smallest and the largest factor that the conditions of a run allow: from U_0/U of each measured voltage,
/// and from R/R_0 between 1, with which the ECU begins, and the resistance of either coil. Without compensation both are
/// 1.
pub(crate) fn duty_factors(scenario: &Scenario, exchanges: &[Exchange]) -> [f64; 2] {
    let Some(compensation) = scenario.controller.compensation else {
        return [1.0, 1.0];
    };
    let nominal_v: f64 = compensation.nominal_voltage_v.to_num();
    let ratios = resistance_ratios(&scenario.plant, compensation);
    let measured = exchanges
        .iter()
        .filter_map(|exchange| exchange.sensors.battery_mv);
    let voltages = measured.map(|millivolts| factor(nominal_v, f64::from(millivolts) * 1e-3));
    let [low, high] = voltages.fold([1.0_f64, 1.0_f64], |[low, high], factor| {
        [low.min(factor), high.max(factor)]
    });
    let ratio_min = ratios.into_iter().fold(1.0, f64::min);
    let ratio_max = ratios.into_iter().fold(1.0, f64::max);
    [
        low * ratio_min * (1.0 - ERROR),
        high * ratio_max * (1.0 + ERROR),
    ]
}

/// Returns R/R_0 of the coils of the fill and the vent valve at the start.
pub(crate) fn resistance_ratios(plant: &PlantParameters, compensation: Compensation) -> [f64; 2] {
    let nominal_ohm: f64 = compensation.nominal_resistance_ohm.to_num();
    let valves = plant.plant().valves;
    [FILL, VENT].map(|valve| valves[valve].coil.resistance / nominal_ohm)
}

/// Returns U_0/U for a measured voltage (V) as the ECU may use it; 1 for an implausible voltage.
pub(crate) fn factor(nominal_v: f64, measured_v: f64) -> f64 {
    let [min, max] = FOLLOWED_V;
    if (PLAUSIBLE_MIN_V..=max).contains(&measured_v) {
        nominal_v / measured_v.max(min)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::CheckId;
    use crate::{OperatingConditions, ReferenceProfile, Requirement, Supply, run_in_process};

    fn scenario() -> Scenario {
        Scenario::new(
            "two steps",
            ReferenceProfile::starting_at(0.0)
                .step_to(3.0)
                .hold_ms(1000)
                .step_to(2.0)
                .hold_ms(1000),
        )
    }

    fn under(volt: f64, coil_temperature_c: f64, controller: controller::Settings) -> crate::Run {
        let conditions = OperatingConditions {
            supply: Some(Supply::Constant(volt)),
            coil_temperature_c: Some(coil_temperature_c),
        };
        let scenario = scenario().controlled_by(controller);
        run_in_process(&conditions.applied_to(scenario).unwrap()).unwrap()
    }

    /// Defect seen: at 28 V, the recommended controller was late, and NoFall was confirmed on hot coils.
    #[test]
    fn the_recommended_loop_is_in_time_and_within_its_limits_at_each_voltage_and_temperature() {
        for (volt, celsius) in [
            (20.0, 20.0),
            (28.0, 80.0),
            (32.0, 20.0),
            (24.0, -40.0),
            (24.0, 120.0),
        ] {
            let run = under(volt, celsius, controller::Settings::recommended());
            let verdict = run.verdict(&Requirement::THESIS).unwrap();
            for id in [CheckId::SettlingTime, CheckId::DutyLimits] {
                let check = verdict.checks.iter().find(|check| check.id == id).unwrap();
                assert!(check.holds, "{volt} V, {celsius} C: {verdict}");
            }
            assert_eq!(run.confirmed_faults(), []);
        }
    }

    #[test]
    fn only_a_controller_with_compensation_may_leave_the_nominal_limits() {
        let thesis = under(28.0, 20.0, controller::Settings::thesis());
        assert_eq!(thesis.duty_factors, [1.0, 1.0]);
        let [low, high] = under(28.0, 20.0, controller::Settings::recommended()).duty_factors;
        assert!(
            (low - 0.8).abs() < 0.02 && (high - 1.06).abs() < 0.02,
            "{low} {high}"
        );
    }
}
