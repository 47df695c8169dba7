//! Plants far from the nominal one, under any duty cycles: the state stays physical, the work stays bounded, and
//! the same input gives the same bits.

use plant_sim::parameters::PARAMETERS;
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Sample, Simulator, Tolerance};
use proptest::prelude::*;

/// Generates the nominal plant with every parameter multiplied or divided by up to `spread`, within its range.
fn plants(spread: f64) -> impl Strategy<Value = PlantParameters> {
    prop::collection::vec(-1.0..1.0_f64, PARAMETERS.len()).prop_map(move |exponents| {
        let mut plant = PlantParameters::nominal();
        for (spec, exponent) in PARAMETERS.iter().zip(exponents) {
            let Some(value) = spec.value(&plant) else {
                continue;
            };
            let (least, most) = spec.range;
            let value = (value * spread.powf(exponent)).clamp(least, most);
            // A gap shorter than the stroke is refused: the nominal value stays.
            let _ = plant.set(&spec.name(), value, "drawn");
        }
        plant
    })
}

/// Generates any plant without effects that a plant file may describe, with every value uniform over the decades of its
/// range, and valves normally closed or open. PWM and delay are in the range of ECUs, so that a case ends in acceptable
/// time.
fn any_plants() -> impl Strategy<Value = PlantParameters> {
    let draws = prop::collection::vec(0.0..1.0_f64, PARAMETERS.len());
    (draws, any::<[bool; 2]>()).prop_map(|(draws, open)| {
        let mut plant = PlantParameters::nominal();
        let plain = PARAMETERS.iter().filter(|spec| spec.effect_id().is_none());
        for (spec, draw) in plain.zip(draws) {
            let (least, most) = match spec.key {
                "pwm_frequency_hz" => (20.0, 500.0),
                "command_delay_s" => (1e-4, 0.02),
                _ => spec.range,
            };
            let least = least.max(most * 1e-6);
            let value = (least * (most / least).powf(draw)).clamp(least, most);
            let _ = plant.set(&spec.name(), value, "drawn");
        }
        plant.functions = open.map(|open| match open {
            true => ValveFunction::NormallyOpen,
            false => ValveFunction::NormallyClosed,
        });
        plant
    })
}

fn duties() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let duty = prop_oneof![Just(0.0), Just(100.0), 0.0..100.0_f64];
    prop::collection::vec((duty.clone(), duty), 1..60)
}

/// Work at which a run is aborted.
const MOST_WORK: u64 = 2_000_000;

fn run(plant: &PlantParameters, duties: &[(f64, f64)]) -> (Vec<Sample>, u64) {
    let mut simulator = Simulator::new(plant);
    simulator.set_work_limit(MOST_WORK);
    let mut samples = Vec::new();
    for (index, &(duty_fill_pct, duty_vent_pct)) in duties.iter().enumerate() {
        simulator.advance_to_ns(index as u64 * 10_000_000);
        samples.push(simulator.sample());
        simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct,
        });
    }
    (samples, simulator.statistics().work())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_state_stays_physical_for_any_plant_and_any_duty(plant in plants(3.0), duties in duties()) {
        let (samples, work) = run(&plant, &duties);
        let gas = &plant.gas;
        let (supply, ambient) = (gas.supply_pressure_pa(), gas.ambient_pressure_pa);
        // Ten times the allowed error of a step: a fifth of a millibar.
        let slack = 10.0 * Tolerance::default().pressure;
        // At most the steady current, increased by the flux that a moving armature displaces.
        let coil = &plant.coil;
        let displaced = coil.inductance_open_h / coil.inductance_closed_h;
        let most = plant.ecu.supply_voltage_v / coil.resistance_20c_ohm * displaced.max(1.0 / displaced);
        for sample in &samples {
            prop_assert!(sample.pressure >= ambient - slack && sample.pressure <= supply + slack, "{sample:?}");
            for index in 0..2 {
                let (current, x) = (sample.current[index], sample.position[index]);
                prop_assert!((0.0..=most * (1.0 + 1e-6)).contains(&current), "{sample:?}");
                prop_assert!((0.0..=plant.armature.stroke_m).contains(&x), "{sample:?}");
            }
        }
        let periods = duties.len() as f64 * 0.01 * plant.ecu.pwm_frequency_hz;
        prop_assert!((work as f64) < 2000.0 * (periods + duties.len() as f64), "{work} steps in {periods} periods");
    }

    /// Chattering at a seat once caused 14 million events in a tenth of a second.
    #[test]
    fn the_work_stays_bounded_for_any_plant_file(plant in any_plants(), duties in duties()) {
        let duties = &duties[..duties.len().min(15)];
        let (samples, work) = run(&plant, duties);
        let finite = samples.iter().all(|sample| sample.pressure.is_finite() && sample.pressure > 0.0);
        prop_assert!(work < MOST_WORK, "{work} steps in {} samples", duties.len());
        prop_assert!(finite, "{samples:?}");
    }

    #[test]
    fn the_same_input_gives_the_same_bits(plant in plants(1.2), duties in duties()) {
        prop_assert_eq!(run(&plant, &duties), run(&plant, &duties));
    }
}
