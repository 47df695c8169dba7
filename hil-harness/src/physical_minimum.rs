//! Physical minimum of the settling time: the valve towards the reference is driven without end.

use plant_sim::valve::ValveFunction;

use crate::checks::StepResponse;
use crate::requirement::Requirement;
use crate::scenario::Scenario;
use crate::wire::{Actuators, FULL_DUTY};
use crate::world::World;

/// Returns the time (samples) in which the open valve of this rig brings the pressure of a step to within the tolerance:
/// no controller settles it sooner. It includes the dead time. `None`: not within T_req, because the coil has too little
/// current to lift its armature, the orifice is too small, or the supply pressure too low.
pub fn physical_minimum_samples(
    scenario: &Scenario,
    step: &StepResponse,
    requirement: &Requirement,
) -> Option<u32> {
    let StepResponse {
        time_s,
        from_bar,
        to_bar,
        ..
    } = *step;
    let on_rig = Scenario {
        start_pressure_bar: from_bar,
        ..scenario.clone()
    };
    let mut world = World::new(&on_rig);
    let (shut, open) = commands(scenario, to_bar > from_bar);
    for _ in 0..on_rig.lead_in().samples() {
        world.sense();
        world.actuate(shut);
    }
    (0..=requirement.t_req_samples).find(|sample| {
        world.sense();
        let missing_bar = (to_bar - world.pressure_bar()) * (to_bar - from_bar).signum();
        if let Some(supply) = scenario.supply {
            let sample_s = on_rig.plant.ecu.sample_time_ns() as f64 * 1e-9;
            world.force_supply(Some(supply.at_s(time_s + f64::from(*sample) * sample_s)));
        }
        world.actuate(open);
        missing_bar <= requirement.p_tol_bar
    })
}

/// Returns the duty cycles that shut both valves, and those that open the fill valve or the vent valve alone.
fn commands(scenario: &Scenario, fills: bool) -> (Actuators, Actuators) {
    let [_, vent] = scenario.plant.functions;
    let [shut_vent, open_vent] = match vent {
        ValveFunction::NormallyOpen => [FULL_DUTY, 0],
        _ => [0, FULL_DUTY],
    };
    let shut = Actuators {
        duty_vent: shut_vent,
        ..Actuators::OFF
    };
    let open = if fills {
        Actuators {
            duty_fill: FULL_DUTY,
            ..shut
        }
    } else {
        Actuators {
            duty_vent: open_vent,
            ..shut
        }
    };
    (shut, open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::run_in_process;
    use crate::voltage_profile::Supply;
    use crate::{ReferenceProfile, controller_file};

    fn scenario() -> Scenario {
        let reference = ReferenceProfile::starting_at(2.0).hold_ms(600).step_to(5.0);
        let reference = reference.hold_ms(600).step_to(3.0).hold_ms(600);
        Scenario::new("two steps", reference)
    }

    fn steps(scenario: &Scenario) -> Vec<StepResponse> {
        let run = run_in_process(scenario).unwrap();
        run.verdict(&Requirement::THESIS).unwrap().steps
    }

    fn minimum(scenario: &Scenario, step: &StepResponse) -> Option<u32> {
        physical_minimum_samples(scenario, step, &Requirement::THESIS)
    }

    #[test]
    fn no_controller_settles_a_step_sooner() {
        for settings in [
            controller_file::thesis(),
            controller_file::recommended(),
            controller_file::pulses_1_9_mm(),
        ] {
            let scenario = scenario().controlled_by(settings);
            let steps = steps(&scenario);
            assert_eq!(steps.len(), 3);
            for step in steps {
                let minimum = minimum(&scenario, &step).unwrap();
                assert!(minimum <= step.settled_samples.unwrap(), "{step:?}");
                assert!(minimum >= 4, "{minimum}: less than the dead time");
            }
        }
    }

    /// Choked flow: after the dead time, the time is inversely proportional to the area of the orifice.
    #[test]
    fn a_smaller_orifice_takes_longer_in_inverse_proportion_to_its_area() {
        let step = steps(&scenario())[2];
        let times = [1.9, 0.9, 0.7].map(|bore_mm| {
            let plant = crate::scenario::with_orifices(scenario().plant, 1e-3 * bore_mm);
            let minimum = minimum(&scenario().on(plant), &step).unwrap();
            (f64::from(minimum), 1.0 / (bore_mm * bore_mm))
        });
        let slope = |one: usize, other: usize| {
            let [(time_1, area_1), (time_2, area_2)] = [times[one], times[other]];
            (time_2 - time_1) / (area_2 - area_1)
        };
        let ratio = slope(1, 2) / slope(0, 1);
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}: {times:?}");
    }

    #[test]
    fn a_coil_without_enough_current_never_reaches_the_reference() {
        let step = steps(&scenario())[1];
        let at = |volt| Scenario {
            supply: Some(Supply::Constant(volt)),
            ..scenario()
        };
        assert_eq!(minimum(&at(10.0), &step), None);
        assert_eq!(minimum(&at(24.0), &step), minimum(&scenario(), &step));
    }

    #[test]
    fn a_normally_open_vent_valve_opens_without_current() {
        let mut plant = scenario().plant;
        plant.functions[1] = ValveFunction::NormallyOpen;
        let scenario = scenario().on(plant);
        let step = StepResponse {
            from_bar: 5.0,
            to_bar: 3.0,
            ..steps(&self::scenario())[2]
        };
        assert!(minimum(&scenario, &step).is_some_and(|samples| samples < 20));
        let step = StepResponse {
            from_bar: 2.0,
            to_bar: 5.0,
            ..step
        };
        assert!(minimum(&scenario, &step).is_some_and(|samples| samples < 20));
    }
}
