//! Choice of the pulse of a sample.

use crate::duty::Duty;
use crate::input_output::{Input, Output};
use crate::pulses::adaptation::Lag;
use crate::pulses::config::{PERIOD_US, PulseConfig};
use crate::pulses::pulse_table::CoilSlowness;
use crate::pulses::run::{Phase, Run, Valve};
use crate::pulses::state::PulseState;
use crate::pulses::valve::DrivenValve;

/// Time after the flow of a run before its pressure counts (µs): the scatter of the command delay.
const MARGIN_US: i32 = 2_000;
/// Longest time for which a pressure that still moves is waited for (µs).
const SETTLING_US: i32 = 60_000;

/// Computes one sample of the model-based pulses: a pure function of configuration, state, input and coils.
///
/// Call it once per sample time. One valve at most is driven. The pulse begins after the command delay and lasts for the
/// returned share of the period.
#[inline]
pub fn pulse_step(
    config: &PulseConfig,
    state: &mut PulseState,
    input: Input,
    coils: CoilSlowness,
) -> Output {
    let PulseState {
        run,
        fill,
        vent,
        leak,
        lag,
    } = state;
    let pressure = input.pressure.saturated_to_control_range().to_bits();
    let reference = input.reference.saturated_to_control_range().to_bits();
    run.advance(PERIOD_US);
    let is_moving = leak.sample(config.leak_max, run, pressure);
    if run.phase == Phase::Shut {
        let error = reference
            .wrapping_add(leak.lead_of_start())
            .wrapping_sub(pressure);
        if error < config.deadband && error > config.deadband.wrapping_neg() {
            return Output::OFF;
        }
        *run = Run::beginning(error > 0, pressure);
    }
    let choice = Choice {
        config,
        pressure,
        target: reference.wrapping_add(leak.lead_of_landing(config.deadband)),
        is_moving,
    };
    let valve = run.valve;
    let mut driven = match valve {
        Valve::Fill => DrivenValve::fill(config, fill, coils.fill, run.start_pressure),
        Valve::Vent => DrivenValve::vent(config, vent, coils.vent, run.start_pressure),
    };
    let pulse = choice.pulse(&mut driven, run, lag);
    match valve {
        Valve::Fill => Output {
            duty_fill: pulse,
            duty_vent: Duty::OFF,
        },
        Valve::Vent => Output {
            duty_fill: Duty::OFF,
            duty_vent: pulse,
        },
    }
}

/// Data for the choice of one sample.
struct Choice<'a> {
    config: &'a PulseConfig,
    /// Measured pressure (bar gauge), 2⁻¹⁶.
    pressure: i32,
    /// Pressure to land on (bar gauge), 2⁻¹⁶.
    target: i32,
    is_moving: bool,
}

impl Choice<'_> {
    /// Returns the duty cycle of the driven valve, and advances its run.
    #[inline(always)]
    fn pulse(&self, valve: &mut DrivenValve<'_>, run: &mut Run, lag: &mut Lag) -> Duty {
        let since_edge = run
            .samples
            .wrapping_mul(PERIOD_US)
            .wrapping_sub(self.config.delay_us);
        let since_opening = since_edge
            .wrapping_sub(valve.opening())
            .wrapping_sub(lag.get());
        let seen = valve.open_time(run.start_pressure, self.pressure);
        if run.phase == Phase::UnderWay {
            let over = since_opening.wrapping_sub(run.open_us);
            if over >= SETTLING_US || over >= MARGIN_US && !self.is_moving {
                if run.is_evidence {
                    valve.learn(&self.config.bounds, seen, run.open_us);
                    lag.learn(self.config.lag_max, run.lag_us);
                }
                run.phase = Phase::Shut;
            }
            return Duty::OFF;
        }
        let passed = since_opening.max(0).min(run.open_us);
        let needed = passed.wrapping_add(valve.open_time(self.pressure, self.target));
        let on = valve.on_time(needed);
        let pulse = on.wrapping_sub(run.periods.wrapping_mul(PERIOD_US));
        if needed <= run.open_us || pulse <= 0 {
            run.end();
            return Duty::OFF;
        }
        if pulse >= PERIOD_US {
            run.periods = run.periods.wrapping_add(1);
            run.open_us = valve.open_after(run.periods);
            return Duty::FULL;
        }
        if passed < run.open_us {
            run.lag_us = Lag::error(seen, passed);
        }
        run.open_us = needed;
        run.phase = Phase::UnderWay;
        duty(pulse)
    }
}

/// Returns the duty cycle of a pulse (µs, up to a period).
#[inline(always)]
fn duty(pulse_us: i32) -> Duty {
    // 100 % over the period is 655.36 units of 2⁻¹⁶ % per µs, so the sum is at most 10 000 · (655 + 0.36).
    let whole = pulse_us.wrapping_mul(655);
    let rest = pulse_us.wrapping_mul(23_593) >> 16;
    Duty::saturating_from_bits(whole.wrapping_add(rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::pressure::Pressure;
    use crate::settings::Settings;

    fn config() -> PulseConfig {
        let config = Config::new(&Settings::pulses()).unwrap();
        *config.pulses().unwrap()
    }

    fn at(reference: i32, pressure: i32) -> Input {
        Input {
            reference: Pressure::from_bits(reference),
            pressure: Pressure::from_bits(pressure),
        }
    }

    #[test]
    fn an_error_of_the_deadband_is_corrected_and_a_smaller_one_not() {
        let config = config();
        let (pressure, deadband) = (3 << 16, config.deadband);
        for (error, is_driven) in [
            (deadband, true),
            (-deadband, true),
            (deadband - 1, false),
            (1 - deadband, false),
        ] {
            let mut state = PulseState::at_rest();
            let input = at(pressure + error, pressure);
            let output = pulse_step(&config, &mut state, input, CoilSlowness::NOMINAL);
            assert_eq!(output != Output::OFF, is_driven, "{error}");
        }
    }

    /// The pressure stays while flow passes, and then rises by less: it lags, at most by 8 ms.
    #[test]
    fn a_pressure_that_shows_less_than_the_flow_that_has_passed_lags() {
        let config = config();
        let (start, reference) = (3 << 16, 5 << 16);
        let mut state = PulseState::at_rest();
        for _ in 0..8 {
            let input = at(reference, start);
            let output = pulse_step(&config, &mut state, input, CoilSlowness::NOMINAL);
            assert_eq!(output.duty_fill, Duty::FULL);
        }
        let last = (start..reference).step_by(256).find_map(|pressure| {
            let mut state = state;
            let input = at(reference, pressure);
            let output = pulse_step(&config, &mut state, input, CoilSlowness::NOMINAL);
            (output.duty_fill < Duty::FULL && !output.duty_fill.is_off()).then_some(state.run)
        });
        // Between the last pulse and none, the table asks for less than was given.
        for pressure in start..reference {
            let mut state = state;
            let output = pulse_step(
                &config,
                &mut state,
                at(reference, pressure),
                CoilSlowness::NOMINAL,
            );
            assert!(output.duty_vent.is_off());
        }
        let run = last.expect("a pulse that lands on the reference");
        assert_eq!((run.phase, run.lag_us), (Phase::UnderWay, 8_000));
    }

    /// The on-time of the table is at most that of the periods so far, although a little open time is missing.
    #[test]
    fn periods_that_last_long_enough_are_followed_by_no_pulse() {
        let config = config();
        let (pressure, reference) = (3 << 16, (3 << 16) + config.deadband);
        let mut state = PulseState::at_rest();
        state.run = Run {
            periods: 1,
            open_us: 1,
            ..Run::beginning(true, pressure)
        };
        let input = at(reference, pressure);
        let output = pulse_step(&config, &mut state, input, CoilSlowness::NOMINAL);
        assert_eq!((output, state.run.phase), (Output::OFF, Phase::UnderWay));
        assert_eq!(state.run.open_us, 1);
    }
}
