//! Further sensors that would distinguish rivals where no excitation does.

use plant_sim::{Command, PlantParameters, Simulator};

use super::distance::Rival;
use super::driver::end_ns;
use super::result::Sensor;
use super::test_signal::Sequence;
use crate::diagnosis::evidence::Evidence;
use crate::measured::PRESSURE;

/// Quantity that could also be logged.
struct Quantity {
    name: &'static str,
    unit: &'static str,
    /// Standard deviation of a usual sensor for it.
    noise: f64,
    /// Logged signal of the same quantity; none for one that no log contains.
    signal: Option<&'static str>,
    value: fn(&mut Simulator, &PlantParameters) -> f64,
}

fn state(simulator: &Simulator, name: &str) -> Option<f64> {
    simulator
        .effect_states()
        .find(|state| state.name == name)
        .map(|state| state.value)
}

static QUANTITIES: [Quantity; 8] = [
    Quantity {
        name: "chamber pressure",
        unit: "bar",
        noise: 0.005,
        signal: Some(PRESSURE),
        value: |simulator, _| simulator.state().pressure * 1e-5,
    },
    Quantity {
        name: "supply pressure at the valve",
        unit: "bar",
        noise: 0.01,
        signal: None,
        value: |simulator, plant| {
            let constant = plant.gas.supply_pressure_pa();
            state(simulator, "p_line").unwrap_or(constant) * 1e-5
        },
    },
    Quantity {
        name: "second pressure, at the far end of the tube, beside the chamber's",
        unit: "bar",
        noise: 0.005,
        signal: None,
        value: |simulator, _| {
            let chamber = simulator.state().pressure;
            (state(simulator, "p_cavity").unwrap_or(chamber) - chamber) * 1e-5
        },
    },
    Quantity {
        name: "gas temperature",
        unit: "K",
        noise: 0.5,
        signal: None,
        value: |simulator, plant| state(simulator, "t_gas").unwrap_or(plant.gas.temperature_k),
    },
    Quantity {
        name: "coil temperature of the fill valve",
        unit: "K",
        noise: 1.0,
        signal: None,
        value: |simulator, _| state(simulator, "t_coil_fill").unwrap_or(REFERENCE_K),
    },
    Quantity {
        name: "coil temperature of the vent valve",
        unit: "K",
        noise: 1.0,
        signal: None,
        value: |simulator, _| state(simulator, "t_coil_vent").unwrap_or(REFERENCE_K),
    },
    Quantity {
        name: "coil current of the fill valve",
        unit: "mA",
        noise: 1.0,
        signal: Some("i_fill"),
        value: |simulator, _| simulator.sample().current[0] * 1e3,
    },
    Quantity {
        name: "coil current of the vent valve",
        unit: "mA",
        noise: 1.0,
        signal: Some("i_vent"),
        value: |simulator, _| simulator.sample().current[1] * 1e3,
    },
];

/// Temperature of a coil that nothing heats (K).
const REFERENCE_K: f64 = 293.15;

/// Returns the sensors that the logs lack, the most informative first, by the rms difference of the rivals on `sequence`.
pub(super) fn sensors(rivals: &[Rival], sequence: &Sequence, logged: &Evidence) -> Vec<Sensor> {
    let is_logged = |signal: &str| {
        logged
            .channels()
            .any(|(_, channel, _)| channel.signal == signal)
    };
    let mut sensors: Vec<Sensor> = QUANTITIES
        .iter()
        .filter(|quantity| !quantity.signal.is_some_and(is_logged))
        .map(|quantity| {
            let traces: Vec<Vec<f64>> = rivals
                .iter()
                .map(|rival| trace(&rival.plant, sequence, quantity))
                .collect();
            let pairs = traces
                .iter()
                .enumerate()
                .flat_map(|(n, a)| traces[..n].iter().map(move |b| (a, b)));
            let rms = |(a, b): (&Vec<f64>, &Vec<f64>)| {
                let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
                (square / a.len() as f64).sqrt()
            };
            let difference = pairs.map(rms).fold(f64::INFINITY, f64::min);
            Sensor {
                quantity: quantity.name.to_owned(),
                unit: quantity.unit.to_owned(),
                difference_rms: difference,
                in_noise: difference / quantity.noise,
            }
        })
        .filter(|sensor| sensor.in_noise > 1.0)
        .collect();
    sensors.sort_by(|a, b| b.in_noise.total_cmp(&a.in_noise));
    sensors
}

fn trace(plant: &PlantParameters, sequence: &Sequence, quantity: &Quantity) -> Vec<f64> {
    let mut simulator = Simulator::new(plant);
    let duties = sequence.duties.iter().enumerate();
    duties
        .map(|(row, &[duty_fill_pct, duty_vent_pct])| {
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct,
            });
            simulator.advance_to_ns(end_ns(row, sequence.interval_s));
            (quantity.value)(&mut simulator, plant)
        })
        .collect()
}
