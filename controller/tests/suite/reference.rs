//! Comparison of the fixed-point controller with one in floating point, sample by sample.
//!
//! The reference implementation follows the equations of the thesis and the README's rules, not the code: no shift, no
//! bound on an input, one `f64` per quantity. A decision may depend on a number that is closer to its threshold than
//! the claimed bound for that number (u at ±100 %, u at 0). Then both answers are correct: the reference takes the
//! controller's, and such samples are counted.

use std::fmt;

use controller::{
    Activity, AntiWindup, Distributor, Input, IntegralAtReference, LowerLimit, OpeningDuty, Output,
    Prediction, PredictionBasis, Saturation, Settings, State, SwitchOff, Trace, step_traced,
};

use crate::support::{Bench, config, configurations};

/// Claimed bound: the largest deviation of u and of the duty cycles from floating point (%).
const BOUND_PCT: f64 = 0.001;
const SAMPLES: u32 = 2_000_000;

struct Reference<'a> {
    settings: &'a Settings,
    pressure: f64,
    error: f64,
    integral: f64,
    boost: f64,
}

/// Expected result of one sample, from the reference implementation.
struct Expected {
    u: f64,
    fill: f64,
    vent: f64,
    tie: bool,
}

fn value(number: controller::fixed::types::I16F16) -> f64 {
    number.to_num()
}

impl Reference<'_> {
    fn step(&mut self, input: Input, seen: &Trace) -> Expected {
        let s = self.settings;
        let pressure = value(input.pressure.bar());
        let error = value(input.reference.bar()) - pressure;
        let (old_error, old_pressure) = (self.error, self.pressure);
        (self.error, self.pressure) = (error, pressure);

        let tolerance = value(s.tolerance_bar);
        let inside = error.abs() < tolerance || error == 0.0;
        if inside || error * old_error < 0.0 {
            self.boost = 0.0;
            if s.integral_at_reference == IntegralAtReference::Clear {
                self.integral = 0.0;
            }
        }
        let before = match s.prediction_basis {
            PredictionBasis::Error => old_error,
            PredictionBasis::Pressure => error + pressure - old_pressure,
        };
        let predicted = match s.prediction {
            Prediction::Off => error,
            Prediction::OneStep => 2.0 * error - before,
            Prediction::TwoStep => 3.0 * error - 2.0 * before,
        };
        let arrives = predicted.abs() < tolerance
            || predicted == 0.0
            || s.switch_off == SwitchOff::InsideOrBeyond && predicted * error < 0.0;
        if inside || arrives {
            return Expected {
                u: 0.0,
                fill: 0.0,
                vent: 0.0,
                tie: false,
            };
        }

        // Equation 6.2; times in ms as in the settings.
        let gain = value(s.gain_pct_per_bar);
        let sample_time = value(s.sample_time_ms);
        let derivative = s.derivative_time_ms.map_or(0.0, |time| {
            let (change, motion) = (error - old_error, old_pressure - pressure);
            let change = match s.prediction_basis {
                PredictionBasis::Pressure if (motion - change) * error > 0.0 => motion,
                PredictionBasis::Error | PredictionBasis::Pressure => change,
            };
            gain * value(time) * change / sample_time
        });
        let integral_max = value(s.integral_max_pct);
        let summed = s.integral_time_ms.map_or(self.integral, |time| {
            self.integral + gain * sample_time / value(time) * error
        });
        let integral = summed.clamp(-integral_max, integral_max);
        let boost = s.boost.map_or(0.0, |boost| {
            let responds = (pressure - old_pressure) * error.signum() >= value(boost.response_bar);
            let max = value(boost.max_pct);
            let more = value(boost.rate_pct_per_bar_s) * sample_time / 1000.0 * error;
            if responds {
                self.boost
            } else {
                (self.boost + more).clamp(-max, max)
            }
        });
        let unsaturated = gain * error + derivative + integral + boost;

        // Near 100 % both answers about the saturation of u are correct.
        let at_its_end = (unsaturated.abs() - 100.0).abs() < BOUND_PCT;
        let cut = if at_its_end {
            seen.saturation != Saturation::None
        } else {
            unsaturated.abs() > 100.0
        };
        let driven = cut && unsaturated * error > 0.0;
        let u = unsaturated.clamp(-100.0, 100.0);
        if !driven {
            self.boost = boost;
        }
        match s.anti_windup {
            AntiWindup::ConditionalIntegration if driven => {}
            AntiWindup::Off | AntiWindup::ConditionalIntegration => self.integral = integral,
            AntiWindup::BackCalculation { tracking_time_ms } => {
                let drawn = integral + (u - unsaturated) * sample_time / value(tracking_time_ms);
                self.integral = drawn.clamp(-integral_max, integral_max);
            }
        }

        // Near u = 0 each answer about the driven valve is correct: fill, vent or none.
        let tie = u.abs() < BOUND_PCT;
        let (fill, vent) = distributed(s, u, pressure);
        Expected { u, fill, vent, tie }
    }
}

/// Returns the duty cycles of fill and vent valve (%), section 6.3.
fn distributed(s: &Settings, u: f64, pressure: f64) -> (f64, f64) {
    let supply = value(s.supply_pressure_bar);
    let (fill_min, vent_min) = match s.duty_min {
        LowerLimit::Constant { fill_pct, vent_pct } => (value(fill_pct), value(vent_pct)),
        LowerLimit::PressureDependent { fill, vent } => (
            opening(&fill, (supply - pressure) / supply),
            opening(&vent, pressure / supply),
        ),
    };
    let (fill_max, vent_max) = (value(s.duty_max_fill_pct), value(s.duty_max_vent_pct));
    let towards = |from: f64, to: f64| from + (to - from) * u.abs() / 100.0;
    match s.distributor {
        Distributor::Traditional => (u.max(0.0), (-u).max(0.0)),
        Distributor::Scheme1 if u > 0.0 => (towards(fill_min, fill_max), 0.0),
        Distributor::Scheme1 if u < 0.0 => (0.0, towards(vent_min, vent_max)),
        Distributor::Scheme1 => (0.0, 0.0),
        Distributor::Scheme2 {
            middle_fill_pct,
            middle_vent_pct,
        } => {
            let (fill, vent) = (value(middle_fill_pct), value(middle_vent_pct));
            if u >= 0.0 {
                (towards(fill, fill_max), towards(vent, vent_min))
            } else {
                (towards(fill, fill_min), towards(vent, vent_max))
            }
        }
    }
}

/// Returns the parabola through three points, by Lagrange's formula.
fn opening(duty: &OpeningDuty, share: f64) -> f64 {
    let y = share.clamp(0.0, 1.0);
    let (start, half, end) = (
        value(duty.without_pressure_pct),
        value(duty.at_half_pct),
        value(duty.with_supply_pressure_pct),
    );
    start * 2.0 * (y - 0.5) * (y - 1.0) - half * 4.0 * y * (y - 1.0) + end * 2.0 * y * (y - 0.5)
}

/// Largest and root mean square deviation of one quantity (%).
#[derive(Default)]
struct Norm {
    worst: f64,
    squares: f64,
}

impl Norm {
    fn add(&mut self, deviation: f64) {
        self.worst = self.worst.max(deviation.abs());
        self.squares += deviation * deviation;
    }
}

impl fmt::Display for Norm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.6} worst {:.6} rms",
            self.worst,
            (self.squares / f64::from(SAMPLES)).sqrt()
        )
    }
}

/// Follows the controller through the bench's regimes and compares every sample.
fn check(name: &str, settings: &Settings) {
    let config = config(settings);
    let mut state = State::at_rest();
    let mut reference = Reference {
        settings,
        pressure: 0.0,
        error: 0.0,
        integral: 0.0,
        boost: 0.0,
    };
    let mut bench = Bench::new(2_008);
    let mut output = Output::OFF;
    let (mut u, mut duty, mut ties) = (Norm::default(), Norm::default(), 0_u32);
    let (mut controlled, mut saturated) = (0_u32, 0_u32);
    for sample in 0..SAMPLES {
        let input = bench.next(output.duty_fill.to_bits(), output.duty_vent.to_bits());
        let trace;
        (output, trace) = step_traced(&config, &mut state, input);
        let expected = reference.step(input, &trace);
        controlled += u32::from(trace.activity == Activity::Controlling);
        saturated += u32::from(trace.saturation != Saturation::None);
        ties += u32::from(expected.tie);
        u.add(trace.u.percent().to_num::<f64>() - expected.u);
        if !expected.tie {
            duty.add(value(output.duty_fill.percent()) - expected.fill);
            duty.add(value(output.duty_vent.percent()) - expected.vent);
        }
        assert!(
            u.worst <= BOUND_PCT && duty.worst <= BOUND_PCT,
            "{name}, sample {sample}: u {} is not {} %, {output:?}, {trace:?}",
            trace.u,
            expected.u
        );
    }
    println!(
        "{name:>22}: u {u}, duty {duty} [%]; {ties} ties, {controlled} controlled, {saturated} saturated of {SAMPLES}"
    );
    assert!(
        ties < SAMPLES / 100_000,
        "{name}: {ties} ties excuse too much"
    );
    assert!(
        controlled > SAMPLES / 10 && saturated > 1000,
        "{name}: the bench did not visit the regimes"
    );
}

#[test]
fn u_and_the_duty_cycles_stay_within_0_001_percent_of_floating_point() {
    for (name, settings) in configurations() {
        check(name, &settings);
    }
}
