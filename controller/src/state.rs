//! State of the controller between two samples.

use crate::arithmetic::from_high_word;
use crate::config::Config;
use crate::control_signal::ControlSignal;
use crate::direction::Direction;
use crate::error::StateError;
use crate::input_output::Input;
use crate::integrator::Integrator;
use crate::pid::Pid;
use crate::pressure::{ERROR_SHIFT, Pressure};
use crate::settings::IntegralAtReference;

/// State between two samples: pressure and error of the last sample, integral part, boost.
///
/// Integral part and boost are counted in the direction of that error: positive where they work towards the reference.
///
/// Two targets that start with the same state and get the same inputs have equal states, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State {
    pub(crate) previous: Sample,
    pub(crate) integral: Integrator,
    pub(crate) boost: Integrator,
}

/// Input, limited to the control range, in the form in which its two differences are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sample {
    /// Chamber pressure (bar), 2⁻²⁵, within the control range: 30 bits.
    pub(crate) pressure: i32,
    /// Reference - pressure (bar), 2⁻²⁵: 31 bits.
    pub(crate) error: i32,
}

impl Sample {
    /// Largest magnitude of an error (2⁻¹⁶ bar): the width of the control range.
    const ERROR_MAX: i32 = Pressure::MAX_CONTROL.to_bits() - Pressure::MIN_CONTROL.to_bits();

    #[inline(always)]
    pub(crate) fn of(input: Input) -> Self {
        let pressure = input.pressure.saturated_to_control_range().to_bits() << ERROR_SHIFT;
        let reference = input.reference.saturated_to_control_range().to_bits() << ERROR_SHIFT;
        Self {
            pressure,
            error: reference.wrapping_sub(pressure),
        }
    }
}

impl State {
    /// Number of words of a saved state.
    pub const WORDS: usize = 6;

    /// Returns the state after switching the truck on: chamber at ambient pressure, reference 0, integrators 0.
    pub const fn at_rest() -> Self {
        Self {
            previous: Sample {
                pressure: 0,
                error: 0,
            },
            integral: Integrator::ZERO,
            boost: Integrator::ZERO,
        }
    }

    /// Returns a state for a start without a derivative kick at any pressure. The previous sample is set to this input,
    /// so the first sample sees no change of error or pressure. Both integrators are 0.
    pub fn new(input: Input) -> Self {
        Self {
            previous: Sample::of(input),
            ..Self::at_rest()
        }
    }

    /// Returns a state for a bumpless takeover: as [`State::new`], with an integral part that continues from `u`, the
    /// control signal applied until now. This is valid for a first sample with the same input and an error outside the
    /// deadband.
    ///
    /// The integral part is clamped to its bound, and is zero for a controller without integral action.
    pub fn taking_over(config: &Config, input: Input, u: ControlSignal) -> Self {
        let previous = Sample::of(input);
        let towards = Direction::of(previous.error);
        let integral = config
            .coefficients
            .pid
            .integral_that_gives(towards.along(u.units()), towards.along(previous.error));
        Self {
            previous,
            integral,
            boost: Integrator::ZERO,
        }
    }

    /// Clears the boost when the reference is reached and, depending on the settings, the integral part.
    #[inline(always)]
    pub(crate) const fn clear_at_reference(&mut self, integral: IntegralAtReference) {
        self.boost = Integrator::ZERO;
        if matches!(integral, IntegralAtReference::Clear) {
            self.integral = Integrator::ZERO;
        }
    }

    /// Returns the direction of the last error, along which the two integrators are counted.
    #[inline(always)]
    pub(crate) const fn direction(&self) -> Direction {
        Direction::of(self.previous.error)
    }

    /// Returns the integral part of the control signal.
    pub const fn integral(&self) -> ControlSignal {
        self.signal(Pid::integral_part(self.integral))
    }

    /// Returns the boost's part of the control signal.
    pub const fn boost(&self) -> ControlSignal {
        self.signal(self.boost.part())
    }

    /// Converts a part counted along the error into a control signal.
    const fn signal(&self, part: i32) -> ControlSignal {
        ControlSignal::from_units(self.direction().along(part))
    }

    /// Returns the state as words: pressure and error of the last sample (2⁻¹⁶ bar), then integral part (2⁻⁵⁹ of 100 %)
    /// and boost (2⁻⁵² of 100 %) in the direction of that error, lower word first.
    pub const fn to_words(&self) -> [i32; Self::WORDS] {
        let (integral, boost) = (self.integral.bits(), self.boost.bits());
        [
            self.previous.pressure >> ERROR_SHIFT,
            self.previous.error >> ERROR_SHIFT,
            integral as i32,
            (integral >> 32) as i32,
            boost as i32,
            (boost >> 32) as i32,
        ]
    }

    /// Restores the state from the words of [`State::to_words`].
    ///
    /// # Errors
    /// Returns an error for words that no sequence of samples leads to. Start with [`State::new`] then.
    pub const fn from_words(words: [i32; Self::WORDS]) -> Result<Self, StateError> {
        let [
            pressure,
            error,
            integral_low,
            integral_high,
            boost_low,
            boost_high,
        ] = words;
        if pressure < Pressure::MIN_CONTROL.to_bits() || pressure > Pressure::MAX_CONTROL.to_bits()
        {
            return Err(StateError::Pressure { bits: pressure });
        }
        if error < -Sample::ERROR_MAX || error > Sample::ERROR_MAX {
            return Err(StateError::Error { bits: error });
        }
        let integral_bits = double_word(integral_low, integral_high);
        if integral_bits < -INTEGRAL_MAX || integral_bits > INTEGRAL_MAX + LOWER_WORD {
            return Err(StateError::Integral {
                bits: integral_bits,
            });
        }
        let boost_bits = double_word(boost_low, boost_high);
        if boost_bits < 0 || boost_bits > BOOST_MAX + LOWER_WORD {
            return Err(StateError::Boost { bits: boost_bits });
        }
        Ok(Self {
            previous: Sample {
                pressure: pressure << ERROR_SHIFT,
                error: error << ERROR_SHIFT,
            },
            integral: Integrator::from_bits(integral_bits),
            boost: Integrator::from_bits(boost_bits),
        })
    }
}

/// Largest bound of the integral part that settings allow: 1000 %, 2⁻⁵⁹ of 100 %.
const INTEGRAL_MAX: i64 = 10 << 59;
/// Largest bound of the boost that settings allow: 1000 %, 2⁻⁵² of 100 %.
const BOOST_MAX: i64 = 10 << 52;
/// Largest lower word, which a bound does not clamp.
const LOWER_WORD: i64 = 0xFFFF_FFFF;

const fn double_word(low: i32, high: i32) -> i64 {
    from_high_word(high).wrapping_add(low as u32 as i64)
}
