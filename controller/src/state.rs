//! Everything that one sample leaves to the next.

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

/// What one sample leaves to the next: pressure and error of the sample, integral part, boost.
///
/// Both parts are counted in the direction of that error: positive where they work towards the reference.
///
/// Two targets that started alike and saw the same inputs hold equal states, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State {
    pub(crate) previous: Sample,
    pub(crate) integral: Integrator,
    pub(crate) boost: Integrator,
}

/// An input, limited to the control range, as its two differences need it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sample {
    /// \[bar\], 2⁻²⁵, within the control range: 30 bits.
    pub(crate) pressure: i32,
    /// Reference - pressure \[bar\], 2⁻²⁵: 31 bits.
    pub(crate) error: i32,
}

impl Sample {
    /// Largest magnitude of an error [2⁻¹⁶ bar]: the width of the control range.
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

    /// Chamber at ambient pressure, reference 0, nothing summed: the truck was just started.
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

    /// A start without a kick while the pressure may be anything: the input is taken as having been there before, so the
    /// first sample sees no change of error or pressure. Nothing is summed.
    pub fn new(input: Input) -> Self {
        Self {
            previous: Sample::of(input),
            ..Self::at_rest()
        }
    }

    /// A bumpless takeover: as [`State::new`], with the integral part such that the first sample, if the error is outside the
    /// tolerance and the input the same, continues from the control signal `u` that was applied until now.
    ///
    /// The integral part is held within its bound, and is zero for a controller without integral action.
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

    /// Forgets what only counts until the reference is reached.
    #[inline(always)]
    pub(crate) const fn clear_at_reference(&mut self, integral: IntegralAtReference) {
        self.boost = Integrator::ZERO;
        if matches!(integral, IntegralAtReference::Clear) {
            self.integral = Integrator::ZERO;
        }
    }

    /// The direction of the last error, along which the two sums are counted.
    #[inline(always)]
    pub(crate) const fn direction(&self) -> Direction {
        Direction::of(self.previous.error)
    }

    /// The integral part of the control signal.
    pub const fn integral(&self) -> ControlSignal {
        self.signal(Pid::integral_part(self.integral))
    }

    /// The boost's part of the control signal.
    pub const fn boost(&self) -> ControlSignal {
        self.signal(self.boost.part())
    }

    /// A part that is counted in the direction of the error.
    const fn signal(&self, part: i32) -> ControlSignal {
        ControlSignal::from_units(self.direction().along(part))
    }

    /// The state as words: pressure and error of the last sample [2⁻¹⁶ bar], then integral part [2⁻⁵⁹ of 100 %] and boost
    /// [2⁻⁵² of 100 %] in the direction of that error, lower word first.
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

    /// The state that [`State::to_words`] gave.
    ///
    /// # Errors
    /// Words that no sequence of samples leads to; the state is not usable then, start with [`State::new`].
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
        if integral_bits < -INTEGRAL_MAX || integral_bits > INTEGRAL_MAX {
            return Err(StateError::Integral {
                bits: integral_bits,
            });
        }
        let boost_bits = double_word(boost_low, boost_high);
        if boost_bits < 0 || boost_bits > BOOST_MAX {
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

/// The largest bound that settings can give the integral part: 1000 %, 2⁻⁵⁹ of 100 %.
const INTEGRAL_MAX: i64 = 10 << 59;
/// The largest bound that settings can give the boost: 1000 %, 2⁻⁵² of 100 %.
const BOOST_MAX: i64 = 10 << 52;

const fn double_word(low: i32, high: i32) -> i64 {
    from_high_word(high).wrapping_add(low as u32 as i64)
}
