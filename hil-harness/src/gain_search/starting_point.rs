//! Gains by the rules of Ziegler and Nichols, from experiments on the model.

use core::f64::consts::PI;

use controller::fixed::types::I16F16;
use controller::{Config, Prediction, Settings};
use recording::{Recording, Unit};

use super::gain::GAINS;
use crate::reference_profile::ReferenceProfile;
use crate::requirement::Requirement;
use crate::run::{RunError, run_in_process};
use crate::scenario::Scenario;

/// Named method for the gains of a PID controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartingPoint {
    /// Relay feedback (Åström and Hägglund 1984): amplitude and period of its oscillation give the ultimate gain.
    Relay,
    /// Reaction curve (Ziegler and Nichols 1942): slope and dead time after a step of the control signal.
    ReactionCurve,
}

/// Reason why an experiment gives no gains.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NoStartingPoint {
    /// The loop does not run.
    #[error(transparent)]
    Run(#[from] Box<RunError>),
    /// The pressure does not answer the experiment.
    #[error(
        "the pressure does not answer the experiment `{experiment}`; does the chamber fill and vent?"
    )]
    NoAnswer {
        /// Name of the experiment.
        experiment: &'static str,
    },
}

/// Gain of the experiments (%/bar), with which the control signal is ±100 % beyond 0.1 bar: a relay.
const RELAY_PCT_PER_BAR: u16 = 1000;
/// Control signal of such a relay (%).
const RELAY_PCT: f64 = 100.0;
/// Middle of the pressure range (p_sup).
const MIDDLE_PSUP: f64 = 0.45;
/// Duration of the oscillation (ms), and its last part, which counts (s).
const OSCILLATION_MS: u32 = 4000;
const SETTLED_AFTER_S: f64 = 2.0;
/// Factor by which an integral time is lengthened until the controller accepts it, and how often at most.
const LENGTHENING: f64 = 1.1;
const LENGTHENED_MAX: i32 = 40;
/// Share of the supply pressure that the reaction curve fills to.
const HIGH_PSUP: f64 = 0.71;

impl StartingPoint {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Relay, Self::ReactionCurve];

    /// Returns the name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Relay => "relay",
            Self::ReactionCurve => "ziegler-nichols",
        }
    }

    /// Returns `scenario`'s controller with the gains that the experiment on its plant gives.
    ///
    /// # Errors
    /// Returns an error if the loop does not run, or the pressure does not answer.
    pub fn gains(
        self,
        scenario: &Scenario,
        requirement: &Requirement,
    ) -> Result<Settings, NoStartingPoint> {
        let none = NoStartingPoint::NoAnswer {
            experiment: self.name(),
        };
        let (gain_pct_per_bar, integral_s, derivative_s) = match self {
            Self::Relay => {
                let oscillation = oscillation(scenario, requirement)?.ok_or(none)?;
                let ultimate = 4.0 * RELAY_PCT / (PI * oscillation.amplitude_bar);
                let period_s = oscillation.period_s;
                (0.6 * ultimate, 0.5 * period_s, 0.125 * period_s)
            }
            Self::ReactionCurve => {
                let reaction = reaction(scenario, requirement)?.ok_or(none)?;
                let per_pct = reaction.slope_bar_per_s / RELAY_PCT;
                let delay_s = reaction.dead_time_s;
                (1.2 / (per_pct * delay_s), 2.0 * delay_s, 0.5 * delay_s)
            }
        };
        let mut settings = scenario.controller;
        let [gain, integral, derivative, ..] = &GAINS;
        gain.set(&mut settings, gain_pct_per_bar);
        derivative.set(&mut settings, 1e3 * derivative_s);
        // The controller computes K T_s/T_i with a fixed point and refuses a large one: T_i is lengthened.
        for attempt in 0..LENGTHENED_MAX {
            let longer = LENGTHENING.powi(attempt);
            integral.set(&mut settings, longer * 1e3 * integral_s);
            if Config::new(&settings).is_ok() {
                break;
            }
        }
        Ok(settings)
    }
}

/// Oscillation under relay feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Oscillation {
    amplitude_bar: f64,
    period_s: f64,
}

/// Beginning of the reaction curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reaction {
    /// Largest slope (bar/s).
    slope_bar_per_s: f64,
    /// Time from the step to the tangent of this slope (s).
    dead_time_s: f64,
}

fn oscillation(
    scenario: &Scenario,
    requirement: &Requirement,
) -> Result<Option<Oscillation>, NoStartingPoint> {
    let middle_bar = psup(scenario, requirement, MIDDLE_PSUP);
    let profile = ReferenceProfile::starting_at(middle_bar).hold_ms(OSCILLATION_MS);
    let points: Vec<_> = pressure(scenario, profile, middle_bar)?
        .into_iter()
        .filter(|(time_s, _)| *time_s >= SETTLED_AFTER_S)
        .collect();
    Ok(oscillation_of(&points))
}

/// Returns amplitude and period of `points` (s, bar); `None` without two periods.
fn oscillation_of(points: &[(f64, f64)]) -> Option<Oscillation> {
    let mean = points.iter().map(|(_, bar)| bar).sum::<f64>() / points.len().max(1) as f64;
    let rising = points.windows(2).filter_map(|pair| match *pair {
        [(one_s, one), (other_s, other)] if one < mean && other >= mean => {
            Some(one_s + (other_s - one_s) * (mean - one) / (other - one))
        }
        _ => None,
    });
    let rising: Vec<f64> = rising.collect();
    let [first, .., last] = rising[..] else {
        return None;
    };
    let bars = || points.iter().map(|(_, bar)| *bar);
    let [high, low] = [bars().fold(mean, f64::max), bars().fold(mean, f64::min)];
    (rising.len() > 2).then(|| Oscillation {
        amplitude_bar: 0.5 * (high - low),
        period_s: (last - first) / (rising.len() - 1) as f64,
    })
}

fn reaction(
    scenario: &Scenario,
    requirement: &Requirement,
) -> Result<Option<Reaction>, NoStartingPoint> {
    let [low, high] = [0.0, psup(scenario, requirement, HIGH_PSUP)];
    let before_ms = 500;
    let profile = ReferenceProfile::starting_at(low)
        .hold_ms(before_ms)
        .step_to(high)
        .hold_ms(2000);
    let step_s = 1e-3 * f64::from(before_ms);
    let points: Vec<_> = pressure(scenario, profile, low)?
        .into_iter()
        .map(|(time_s, bar)| (time_s - step_s, bar))
        .collect();
    Ok(reaction_of(&points))
}

/// Returns slope and dead time of `points` (s after the step, bar) that begin at rest; `None` if nothing rises.
fn reaction_of(points: &[(f64, f64)]) -> Option<Reaction> {
    let (_, rest_bar) = *points.first()?;
    let slopes = points.windows(2).filter_map(|pair| match *pair {
        [(one_s, one), (other_s, other)] if one_s >= 0.0 => {
            Some(((other - one) / (other_s - one_s), (one_s, one)))
        }
        _ => None,
    });
    let (slope_bar_per_s, (time_s, bar)) =
        slopes.max_by(|(one, _), (other, _)| one.total_cmp(other))?;
    let dead_time_s = time_s - (bar - rest_bar) / slope_bar_per_s;
    (slope_bar_per_s > 0.0 && dead_time_s > 0.0).then_some(Reaction {
        slope_bar_per_s,
        dead_time_s,
    })
}

/// Returns a share of the lower of both supply pressures (bar gauge): that of the plant and that of the requirements.
fn psup(scenario: &Scenario, requirement: &Requirement, share: f64) -> f64 {
    let of_plant = scenario.plant.gas.supply_pressure_bar_gauge;
    share * of_plant.min(requirement.supply_pressure_bar)
}

/// Returns the pressure (s, bar gauge) while the controller acts as a relay, without noise.
fn pressure(
    scenario: &Scenario,
    profile: ReferenceProfile,
    start_pressure_bar: f64,
) -> Result<Vec<(f64, f64)>, NoStartingPoint> {
    let controller = Settings {
        gain_pct_per_bar: I16F16::from_num(RELAY_PCT_PER_BAR),
        integral_time_ms: None,
        derivative_time_ms: None,
        tolerance_bar: I16F16::ZERO,
        prediction: Prediction::Off,
        boost: None,
        ..scenario.controller
    };
    let experiment = Scenario {
        start_pressure_bar,
        controller,
        sensor_noise_mbar_rms: 0.0,
        ..Scenario::new("starting point", profile).on(scenario.plant.clone())
    };
    let run = run_in_process(&experiment).map_err(Box::new)?;
    Ok(points(&run.recording))
}

fn points(recording: &Recording) -> Vec<(f64, f64)> {
    let Some((times, signal)) = recording.time_base_of("p_ch").zip(recording.signal("p_ch")) else {
        return Vec::new();
    };
    let bars = signal.values_in(Unit::BarGauge).unwrap_or_default();
    times.times_s().iter().copied().zip(bars).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_its_amplitude_and_period() {
        let points: Vec<_> = (0..400)
            .map(|n| {
                let time_s = 0.01 * f64::from(n);
                (time_s, 3.0 + 0.7 * (2.0 * PI * time_s / 0.33).sin())
            })
            .collect();
        let found = oscillation_of(&points).unwrap();
        assert!((found.amplitude_bar - 0.7).abs() < 2e-3, "{found:?}");
        assert!((found.period_s - 0.33).abs() < 2e-3, "{found:?}");
        assert_eq!(oscillation_of(&[(0.0, 1.0), (1.0, 1.0)]), None);
    }

    /// A ramp of 20 bar/s that begins 30 ms after the step.
    #[test]
    fn a_delayed_ramp_has_its_slope_and_dead_time() {
        let points: Vec<_> = (-20..50)
            .map(|n| {
                let time_s = 0.01 * f64::from(n);
                (time_s, 1.0 + 20.0 * (time_s - 0.03).max(0.0))
            })
            .collect();
        let found = reaction_of(&points).unwrap();
        assert!((found.slope_bar_per_s - 20.0).abs() < 1e-9, "{found:?}");
        assert!((found.dead_time_s - 0.03).abs() < 1e-9, "{found:?}");
        let rest: Vec<_> = points.iter().map(|(time_s, _)| (*time_s, 1.0)).collect();
        assert_eq!(reaction_of(&rest), None);
    }

    /// The rules, applied by hand to the experiment on the thesis' rig: the ultimate gain is between 50 and 200 %/bar, as
    /// a dead time of 25 to 40 ms and 40 to 60 bar/s at full duty give (π/2 / (L slope)).
    #[test]
    fn both_experiments_give_gains_of_the_order_of_the_shipped_ones() {
        let scenario = Scenario::built_in("hold").unwrap();
        for method in StartingPoint::ALL {
            let settings = method.gains(&scenario, &Requirement::THESIS).unwrap();
            let [gain, integral, derivative, ..] = &GAINS;
            let value = |gain: &super::super::Gain| gain.value(&settings).unwrap();
            let name = method.name();
            assert!(
                (15.0..150.0).contains(&value(gain)),
                "{name}: {}",
                value(gain)
            );
            assert!((30.0..300.0).contains(&value(integral)), "{name}");
            let ratio = value(integral) / value(derivative);
            assert!(ratio >= 3.8, "{name}: {ratio}");
            assert!(Config::new(&settings).is_ok(), "{name}");
        }
    }
}
