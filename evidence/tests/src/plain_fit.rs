//! Fit of the simulator's plain model to the noise-free readings of the reference plant: the residual is the difference
//! of the two plants, and the contribution of an effect.

use plant_sim::replay::{CurrentSampling, Replay, ReplayInput};
use plant_sim::{Command, PlantParameters, Tolerance};

use crate::least_squares::{rms, weights};
use crate::reference_plant::{Reading, SCATTERED};

/// Noise of a bench log: pressure (bar), currents (mA).
pub const NOISE: [f64; 3] = [4e-3, 0.7, 0.7];
/// Range of a parameter, in half widths of the scatter.
const REACH: f64 = 1.5;
const ROUNDS: usize = 8;
const TRIES: usize = 4;
/// Half the step of the differences, in half widths.
const STEP: f64 = 0.02;

type Scatter = [f64; SCATTERED.len()];

/// Error of the plain model before and after the fit: rms in units of the noise, pressure and both currents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// Error with the datasheet's values.
    pub nominal: [f64; 3],
    /// Error with every scattered quantity fitted.
    pub fitted: [f64; 3],
}

/// Fits the plain model to the readings for these commands (%), one pair per sample.
///
/// # Panics
/// Panics if a fitted value is outside of the simulator's range.
pub fn misfit(commands: &[[f64; 2]], readings: &[Reading]) -> Misfit {
    let truth: Vec<f64> = readings
        .iter()
        .flat_map(|r| [r.pressure * 1e-5, r.currents[0] * 1e3, r.currents[1] * 1e3])
        .zip(NOISE.into_iter().cycle())
        .map(|(value, noise)| value / noise)
        .collect();
    let residuals = |at: &Scatter| -> Vec<f64> {
        let model = simulated(&plant(at), commands);
        truth
            .iter()
            .zip(model)
            .map(|(truth, model)| truth - model)
            .collect()
    };
    let mut at = [0.0; SCATTERED.len()];
    let mut left = residuals(&at);
    let nominal = by_signal(&left);
    // Levenberg and Marquardt: the damping `pull` grows after a step that does not reduce the error. Volume and
    // discharge coefficients are nearly dependent; without damping they would diverge together.
    let mut pull = 1.0;
    for _ in 0..ROUNDS {
        let columns: Vec<Vec<f64>> = (0..at.len())
            .map(|n| {
                let moved = |step: f64| {
                    let mut moved = at;
                    moved[n] += step;
                    simulated(&plant(&moved), commands)
                };
                let (up, down) = (moved(STEP), moved(-STEP));
                up.iter()
                    .zip(down)
                    .map(|(up, down)| (up - down) / (2.0 * STEP))
                    .collect()
            })
            .collect();
        for _ in 0..TRIES {
            let steps = weights(&columns, &left, &[pull; SCATTERED.len()]);
            let mut there = at;
            for (value, step) in there.iter_mut().zip(steps) {
                *value = (*value + step).clamp(-REACH, REACH);
            }
            let left_there = residuals(&there);
            if rms(left_there.iter().copied()) < rms(left.iter().copied()) {
                (at, left) = (there, left_there);
                pull = (0.1 * pull).max(1.0);
                break;
            }
            pull *= 30.0;
        }
    }
    Misfit {
        nominal,
        fitted: by_signal(&left),
    }
}

fn by_signal(residuals: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|signal| rms(residuals.iter().skip(signal).step_by(3).copied()))
}

/// Returns pressure and currents in units of the noise, sample by sample.
fn simulated(plant: &PlantParameters, commands: &[[f64; 2]]) -> Vec<f64> {
    let mut model = Replay::new(plant, CurrentSampling::MeanOfInterval, Tolerance::default());
    let period = plant.ecu.sample_time_ns();
    let mut time_ns = 0;
    let rows = commands.iter().flat_map(|&[duty_fill_pct, duty_vent_pct]| {
        let row = model.row(ReplayInput {
            command: Some(Command {
                duty_fill_pct,
                duty_vent_pct,
            }),
            ..ReplayInput::at(time_ns)
        });
        time_ns += period;
        [row[2] / NOISE[0], row[3] / NOISE[1], row[4] / NOISE[2]]
    });
    rows.collect()
}

/// Returns the nominal plant, with its scattered quantities moved by these numbers of half widths.
fn plant(at: &Scatter) -> PlantParameters {
    let nominal = PlantParameters::nominal();
    let mut plant = nominal.clone();
    for ((name, half_width), &at) in SCATTERED.into_iter().zip(at) {
        let (keys, is_relative): (&[&str], bool) = match name {
            "discharge_fill" => (&["flow.discharge_fill"], true),
            "discharge_vent" => (&["flow.discharge_vent"], true),
            "preload_fill" => (&["armature.preload_fill_n"], true),
            "preload_vent" => (&["armature.preload_vent_n"], true),
            "resistance" => (&["coil.resistance_20c_ohm"], true),
            "inductance" => (
                &["coil.inductance_closed_h", "coil.inductance_open_h"],
                true,
            ),
            "volume" => (&["chamber.volume_m3"], true),
            "spring" => (&["armature.spring_n_per_m"], true),
            "command_delay_s" => (&["ecu.command_delay_s"], false),
            "supply_pressure_bar" => (&["gas.supply_pressure_bar_gauge"], false),
            other => panic!("{other} is no quantity of the simulator"),
        };
        for key in keys {
            let value = nominal.get(key).expect("the simulator has this parameter");
            let moved = if is_relative {
                value * (1.0 + half_width * at)
            } else {
                value + half_width * at
            };
            plant
                .set(key, moved, "fitted")
                .expect("the scatter is within the range");
        }
    }
    plant
}
