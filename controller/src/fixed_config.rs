//! A configuration whose mechanisms the compiler knows.

use core::fmt;
use core::marker::PhantomData;

use crate::config::Config;
use crate::error::OtherMechanism;
use crate::input_output::{Input, Output};
use crate::settings::Settings;
use crate::state::State;
use crate::step::sample;
use crate::structure::Structure;
use crate::trace::Trace;

/// The mechanisms that are compiled into the sample of a [`FixedConfig`].
pub trait Mechanisms {
    /// Settings that choose these mechanisms. Their numbers do not count.
    const SETTINGS: Settings;
}

/// A [`Config`] whose mechanisms are fixed at compile time, while each number stays tunable.
///
/// Its sample gives the bits of [`step`](crate::step()) with that configuration, at less than half the cost: what is not chosen
/// is not there.
/// ```
/// use controller::{Config, FixedConfig, Input, Mechanisms, Pressure, Settings, State};
///
/// struct Thesis;
/// impl Mechanisms for Thesis {
///     const SETTINGS: Settings = Settings::thesis();
/// }
///
/// let config = Config::new(&Settings::thesis())?;
/// let fixed = FixedConfig::<Thesis>::new(config)?;
/// let mut state = State::at_rest();
/// let output = fixed.step(&mut state, Input { reference: Pressure::ZERO, pressure: Pressure::ZERO });
/// assert!(output.duty_fill.is_off());
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
pub struct FixedConfig<M> {
    config: Config,
    mechanisms: PhantomData<fn() -> M>,
}

impl<M: Mechanisms> FixedConfig<M> {
    const STRUCTURE: Structure = Structure::of(&M::SETTINGS);

    /// The same configuration, if it has these mechanisms.
    ///
    /// # Errors
    /// The first mechanism that is another one than was compiled in.
    pub const fn new(config: Config) -> Result<Self, OtherMechanism> {
        match config.structure.difference(Self::STRUCTURE) {
            Some(mechanism) => Err(OtherMechanism { mechanism }),
            None => Ok(Self {
                config,
                mechanisms: PhantomData,
            }),
        }
    }

    /// The configuration.
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// One sample, as [`step`](crate::step()).
    #[inline]
    pub fn step(&self, state: &mut State, input: Input) -> Output {
        sample(Self::STRUCTURE, &self.config.coefficients, state, input).0
    }

    /// One sample and how it came to its output, as [`step_traced`](crate::step_traced).
    #[inline]
    pub fn step_traced(&self, state: &mut State, input: Input) -> (Output, Trace) {
        sample(Self::STRUCTURE, &self.config.coefficients, state, input)
    }
}

// Derived, these would ask the same of `M`, which is only a name.
impl<M> Clone for FixedConfig<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for FixedConfig<M> {}

impl<M> PartialEq for FixedConfig<M> {
    fn eq(&self, other: &Self) -> bool {
        self.config == other.config
    }
}

impl<M> Eq for FixedConfig<M> {}

impl<M> fmt::Debug for FixedConfig<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("FixedConfig").field(&self.config).finish()
    }
}
