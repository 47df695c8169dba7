//! Share of each pressure error by which the model is corrected: the gain of a Kalman filter that trusts its model except for the air that
//! each pulse of a valve moves.
//!
//! Driven by the commands alone, a model carries the error of every pulse to the end of the log, and a per mille of the flow looks like
//! missing physics. Corrected at a constant gain, it forgets a slow leak. Here the gain is high while a valve is switching and falls with
//! the length of a hold, so that the whole hold shows in the error.
//!
//! R. E. Kalman 1960. The gain depends on the commands alone, so that every model is compared with the same filter.

use plant_sim::PlantParameters;

use crate::commands::Commands;
use crate::measured::Restart;
use crate::result::Horizon;

/// Uncertainty of the air that a pulse moves, over the air through a fully open valve in a PWM period: 0.1 ms of 10 ms, the scatter of a
/// valve's switching times.
const PULSE_SCATTER: f64 = 0.01;
/// Variance of a measured initial pressure over that of the noise.
const START_VARIANCE: f64 = 0.1;

/// Returns the description of the errors of `horizon` for people.
pub(crate) fn statement(horizon: Horizon) -> &'static str {
    match horizon {
        Horizon::OneStepAhead => {
            "errors are those of the one-step-ahead prediction: after each sample a part of the pressure error corrects the model, more \
             while a valve switches (the air of a pulse is known to 1 %) and less during a hold; the noise floor is the error of a \
             perfect model. The free run is driven by the commands alone"
        }
        Horizon::FreeRun => {
            "errors are those of the free-run simulation, driven by the commands alone: one step ahead they are within the noise, but the \
             errors of all pulses add up; the noise floor is that of the sensor"
        }
    }
}

/// Gains, and the errors of a perfect model.
#[derive(Debug, Clone)]
pub(crate) struct Predictor {
    /// Gains: after each sample, pressure += gain × (measured - predicted).
    pub(crate) gains: Vec<f64>,
    /// Standard deviation of the prediction error of a perfect model over that of the measurement noise.
    pub(crate) floors: Vec<f64>,
}

impl Predictor {
    /// Returns the predictor for pressures `measured` (NaN where missing) with noise `sigma_bar`. `largest_bar` is the largest change in a
    /// PWM period. At each of `restarts` the model restarts at a measured pressure.
    pub(crate) fn new(
        parameters: &PlantParameters,
        commands: &Commands,
        measured: &[f64],
        sigma_bar: f64,
        largest_bar: f64,
        (starts_measured, restarts): (bool, &[Restart]),
    ) -> Self {
        let switching = switching(parameters, commands);
        let pulse = (PULSE_SCATTER * largest_bar / sigma_bar).powi(2);
        let start = if starts_measured { START_VARIANCE } else { 0.0 };
        // Variances over that of the noise: the filter's estimate, and that of a perfect model.
        let (mut believed, mut perfect) = (start, start);
        let mut gains = Vec::with_capacity(measured.len());
        let mut floors = Vec::with_capacity(measured.len());
        for (row, value) in measured.iter().enumerate() {
            if switching[row] {
                let begin_s = commands.times_s[row.saturating_sub(1)];
                let pulses = (commands.times_s[row] - begin_s) * parameters.ecu.pwm_frequency_hz;
                believed += pulse * pulses;
            }
            floors.push(f64::sqrt(perfect + 1.0));
            let gain = if value.is_nan() {
                0.0
            } else {
                believed / (believed + 1.0)
            };
            believed *= 1.0 - gain;
            perfect = (1.0 - gain).powi(2) * perfect + gain * gain;
            gains.push(gain);
            if let Some(restart) = Restart::at(restarts, row) {
                (believed, perfect) = (restart.variance, restart.variance);
            }
        }
        Self { gains, floors }
    }

    /// Returns the predictor of a model driven by the commands alone, with gain 0.
    pub(crate) fn free_run(samples: usize) -> Self {
        Self {
            gains: vec![0.0; samples],
            floors: vec![1.0; samples],
        }
    }
}

/// Returns for each sample whether a coil may have switched before it.
fn switching(parameters: &PlantParameters, commands: &Commands) -> Vec<bool> {
    let mut switching = vec![false; commands.len()];
    for valve in (0..2).filter(|&valve| parameters.functions[valve].is_commanded()) {
        let mut quiet = vec![false; commands.len()];
        for segment in commands.dead_coil(valve, 0.0) {
            quiet[segment].fill(true);
        }
        for (switching, quiet) in switching.iter_mut().zip(&quiet) {
            *switching |= !quiet;
        }
    }
    switching
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands() -> Commands {
        let log = crate::bench::Bench::default().measure();
        Commands::new(&PlantParameters::nominal(), &log).unwrap()
    }

    #[test]
    fn a_hold_is_averaged_and_a_pulse_is_forgiven() {
        let commands = commands();
        let measured = vec![1.0; commands.len()];
        let predictor = Predictor::new(
            &PlantParameters::nominal(),
            &commands,
            &measured,
            0.005,
            0.13,
            (false, &[]),
        );
        let first = predictor.gains.iter().position(|gain| *gain > 0.0).unwrap();
        let holds = commands.holds(0.0);
        assert!(
            first >= holds[0].end - 1,
            "nothing is doubted before the first command"
        );
        let hold = holds.iter().skip(1).max_by_key(|hold| hold.len()).unwrap();
        let (begin, end) = (predictor.gains[hold.start], predictor.gains[hold.end - 1]);
        assert!(
            end < begin && end < 1.2 / hold.len() as f64,
            "{begin} {end}"
        );
    }

    #[test]
    fn the_floor_of_a_constant_gain_is_that_of_the_literature() {
        // sqrt(2 / (2 - L)) in the steady state.
        let commands = commands();
        let measured = vec![1.0; commands.len()];
        let predictor = Predictor::new(
            &PlantParameters::nominal(),
            &commands,
            &measured,
            0.005,
            0.13,
            (false, &[]),
        );
        for (gain, floor) in predictor.gains.iter().zip(&predictor.floors).skip(1) {
            let most = (2.0 / (2.0 - gain.max(0.5))).sqrt();
            assert!((1.0..=most).contains(floor), "{gain} {floor}");
        }
    }
}
