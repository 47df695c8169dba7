//! What the controller is fed: a random walk through everything it meets, and through what it should never meet.

use core::num::NonZeroU32;

use controller::{Input, Pressure};

use super::random::Random;

/// Each machine and each configuration starts here, so that digests differ by configuration only.
const SEED: NonZeroU32 = NonZeroU32::new(0x6c07_8965).unwrap();
/// Longest time in one manner, in samples.
const STRETCH_MAX: u32 = 200;
/// Supply pressure of the thesis' rigs, 8.4 bar gauge [2⁻¹⁶ bar].
const SUPPLY: u32 = 550_502;
/// Ten times the thesis' tolerance of 0.1 bar [2⁻¹⁶ bar].
const NEAR: u32 = 65_536;

/// How the pressure moves for a while.
#[derive(Clone, Copy)]
enum Manner {
    /// Towards the reference, by a part of the way in each sample, with some noise: a loop that works.
    Approach {
        /// log₂ of the samples that the way takes.
        slowness: u32,
    },
    /// Around the reference, in and out of the tolerance.
    Linger,
    /// By itself, whatever the reference is: a leak, a stuck valve.
    Drift {
        /// [2⁻¹⁶ bar per sample]
        rate: i32,
    },
    /// Reference and pressure are any 32 bits: a broken sensor, a broken bus.
    Anything,
}

/// The inputs of one run, without end.
pub(crate) struct Walk {
    random: Random,
    manner: Manner,
    /// Samples left in this manner.
    left: u32,
    /// [2⁻¹⁶ bar gauge], as all below.
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

    /// The next sample's input.
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

    /// Another manner and, after some of them, another reference.
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

    /// A walk that stayed in one place would compare a million times the same step.
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
