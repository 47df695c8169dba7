//! Coil driver of a valve on a PWM output.

use controller::Duty;
use embedded_hal::pwm::SetDutyCycle;

/// Coil driver of one on/off valve, on a PWM output of the ECU.
///
/// Active high: a longer pulse gives more current. The board defines the output without pulses by a pull-down at the
/// gate, so that the coil is off while the processor is in reset.
#[derive(Debug)]
pub struct Valve<P> {
    pwm: P,
}

impl<P: SetDutyCycle> Valve<P> {
    /// Takes over the output and switches it off.
    ///
    /// # Errors
    /// Returns the error of the output.
    pub fn new(pwm: P) -> Result<Self, P::Error> {
        let mut valve = Self { pwm };
        valve.off()?;
        Ok(valve)
    }

    /// Sets the coil's duty cycle, from the next PWM period on.
    ///
    /// The duty cycle is rounded to the nearest count of the timer. The error is at most half a count, which is 76 ns
    /// of a 10 ms period for a timer of 65 535 counts, a thousandth of the shortest pulse that lifts an armature. 0 %
    /// and 100 % are exact. A duty cycle below half a count is off: there the rounding is towards the safe state.
    ///
    /// # Errors
    /// Returns the error of the output; the coil then has an unknown duty cycle.
    pub fn drive(&mut self, duty: Duty) -> Result<(), P::Error> {
        let counts = duty.to_counts(self.pwm.max_duty_cycle());
        self.pwm.set_duty_cycle(counts)
    }

    /// Switches the coil off from the next PWM period on.
    ///
    /// # Errors
    /// Returns the error of the output.
    pub fn off(&mut self) -> Result<(), P::Error> {
        self.pwm.set_duty_cycle_fully_off()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal_mock::eh1::MockError;
    use embedded_hal_mock::eh1::pwm::{Mock, Transaction};
    use std::io::ErrorKind;

    fn duty(percent: f64) -> Duty {
        Duty::saturating_from_bits((percent * 65536.0) as i32)
    }

    /// Checks the timer's counts for each duty cycle, for a timer of `counts_max`.
    fn check(counts_max: u16, expected: &[(Duty, u16)]) {
        let mut transactions = vec![Transaction::set_duty_cycle(0)];
        for (_, counts) in expected {
            transactions.push(Transaction::max_duty_cycle(counts_max));
            transactions.push(Transaction::set_duty_cycle(*counts));
        }
        let mut pwm = Mock::new(&transactions);
        let mut valve = Valve::new(pwm.clone()).unwrap();
        for (duty, _) in expected {
            valve.drive(*duty).unwrap();
        }
        pwm.done();
    }

    #[test]
    fn a_valve_that_is_taken_over_is_switched_off_before_anything_else() {
        check(65_535, &[]);
    }

    #[test]
    fn nothing_and_everything_are_exact_for_every_size_of_timer() {
        for counts_max in [1, 2, 100, 999, 26_562, 62_963, 65_535] {
            check(
                counts_max,
                &[(Duty::OFF, 0), (Duty::FULL, counts_max), (Duty::OFF, 0)],
            );
        }
    }

    #[test]
    fn a_duty_is_the_nearest_count() {
        // 28.5 % of 62 963 counts is 17 944.455; 54.5 % is 34 314.835; half a count is 0.000 794 %.
        let expected = [
            (duty(28.5), 17_944),
            (duty(54.5), 34_315),
            (duty(0.000_78), 0),
            (duty(0.000_82), 1),
            (duty(99.999_22), 62_963),
            (duty(99.999_18), 62_962),
        ];
        check(62_963, &expected);
    }

    #[test]
    fn an_output_that_fails_is_reported() {
        let error = MockError::Io(ErrorKind::NotConnected);
        let transactions = [
            Transaction::set_duty_cycle(0),
            Transaction::max_duty_cycle(100),
            Transaction::set_duty_cycle(50).with_error(error.clone()),
            Transaction::set_duty_cycle(0).with_error(error.clone()),
        ];
        let mut pwm = Mock::new(&transactions);
        let mut valve = Valve::new(pwm.clone()).unwrap();
        assert_eq!(valve.drive(duty(50.0)), Err(error.clone()));
        assert_eq!(valve.off(), Err(error));
        pwm.done();
    }
}
