//! Inputs of the self-test: a random walk through all regimes of the controller, and through invalid inputs.

use core::num::NonZeroU32;

use controller::{Input, Pressure};

use super::random::Random;

/// Seed, equal on each machine and for each configuration, so that digests differ by configuration only.
const SEED: NonZeroU32 = NonZeroU32::new(0x6c07_8965).unwrap();
/// Longest interval with one kind of motion (samples).
const STRETCH_MAX: u32 = 200;
/// Supply pressure of the thesis' rigs, 8.4 bar gauge (2⁻¹⁶ bar).
const SUPPLY: u32 = 550_502;
/// Ten times the thesis' deadband of 0.1 bar (2⁻¹⁶ bar).
const NEAR: u32 = 65_536;

/// Motion of the pressure during an interval.
#[derive(Clone, Copy)]
enum Manner {
    /// Towards the reference, by a part of the distance in each sample, with some noise: a loop that works.
    Approach {
        /// log₂ of the number of samples for the distance.
        slowness: u32,
    },
    /// Around the reference, inside and outside of the deadband.
    Linger,
    /// Independent of the reference: a leak, a stuck valve.
    Drift {
        /// Rate of the drift (2⁻¹⁶ bar per sample).
        rate: i32,
    },
    /// Any 32 bits for reference and pressure: a broken sensor, a broken bus.
    Anything,
}

/// Inputs of one run, without end.
pub(crate) struct Walk {
    random: Random,
    manner: Manner,
    /// Number of samples left in this interval.
    left: u32,
    /// Reference (2⁻¹⁶ bar gauge); the pressure has the same unit.
    reference: i32,
    pressure: i32,
}

impl Walk {
    pub(crate) const fn new() -> Self {
        Self {
            random: Random::new(SEED),
            manner: Manner::Linger,
            left: 0,
            reference: 0,
            pressure: 0,
        }
    }

    /// Returns the next sample's input.
    pub(crate) fn input(&mut self) -> Input {
        if self.left == 0 {
            self.turn();
        }
        self.left -= 1;
        self.pressure = match self.manner {
            Manner::Approach { slowness } => {
                let distance = self.reference.saturating_sub(self.pressure);
                let way = distance.wrapping_shr(slowness);
                self.pressure
                    .saturating_add(way)
                    .saturating_add(self.random.around_zero(NEAR / 64))
            }
            Manner::Linger => self
                .reference
                .saturating_add(self.random.around_zero(NEAR / 4)),
            Manner::Drift { rate } => self.pressure.saturating_add(rate),
            Manner::Anything => {
                self.reference = self.random.bits() as i32;
                self.random.bits() as i32
            }
        };
        Input {
            reference: Pressure::from_bits(self.reference),
            pressure: Pressure::from_bits(self.pressure),
        }
    }

    /// Begins an interval with another kind of motion and, in some cases, another reference.
    fn turn(&mut self) {
        let broken = matches!(self.manner, Manner::Anything);
        if broken || self.random.below(2) == 0 {
            self.reference = self.random.below(SUPPLY) as i32;
        }
        if broken {
            self.pressure = self.random.below(SUPPLY) as i32;
        }
        self.manner = match self.random.below(8) {
            0..=3 => Manner::Approach {
                slowness: self.random.below(6),
            },
            4..=5 => Manner::Linger,
            6 => Manner::Drift {
                rate: self.random.around_zero(NEAR / 16),
            },
            _ => Manner::Anything,
        };
        self.left = 1 + self.random.below(STRETCH_MAX);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors_bar() -> Vec<f64> {
        let mut walk = Walk::new();
        let inputs = (0..65_536).map(|_| walk.input());
        let bits = |pressure: Pressure| f64::from(pressure.to_bits()) / 65_536.0;
        inputs
            .map(|input| bits(input.reference) - bits(input.pressure))
            .collect()
    }

    /// A walk that stayed in one place would compare the same step a million times.
    #[test]
    fn the_walk_spends_its_time_inside_the_tolerance_outside_it_and_beyond_all_bounds() {
        let errors = errors_bar();
        let share = |within: fn(f64) -> bool| {
            let count = errors.iter().filter(|error| within(error.abs())).count();
            count as f64 / errors.len() as f64
        };
        assert!(share(|error| error < 0.1) > 0.2);
        assert!(share(|error| (0.1..16.0).contains(&error)) > 0.2);
        assert!(share(|error| error > 32.0) > 0.05);
    }

    #[test]
    fn filling_and_venting_are_asked_for_about_equally_often() {
        let errors = errors_bar();
        let filling = errors.iter().filter(|&&error| error > 0.1).count() as f64;
        let venting = errors.iter().filter(|&&error| error < -0.1).count() as f64;
        assert!(
            (0.5..2.0).contains(&(filling / venting)),
            "{filling} to {venting}"
        );
    }
}
