//! Configuration whose mechanisms are known at compile time.

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

/// Mechanisms that are compiled into the sample of a [`FixedConfig`].
pub trait Mechanisms {
    /// Settings that choose these mechanisms. Only the choices count, not the numbers.
    const SETTINGS: Settings;
}

/// [`Config`] whose mechanisms are fixed at compile time, while each number stays tunable.
///
/// A sample gives the same bits as [`step`](crate::step()) with that configuration, at less than half the cost:
/// mechanisms that are not chosen are not compiled.
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

    /// Creates a fixed configuration from `config`, if it has these mechanisms.
    ///
    /// # Errors
    /// Returns the first mechanism that differs from the compiled ones.
    pub const fn new(config: Config) -> Result<Self, OtherMechanism> {
        match config.structure.difference(Self::STRUCTURE) {
            Some(mechanism) => Err(OtherMechanism { mechanism }),
            None => Ok(Self {
                config,
                mechanisms: PhantomData,
            }),
        }
    }

    /// Returns the configuration.
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// Computes one sample, as [`step`](crate::step()) does.
    #[inline]
    pub fn step(&self, state: &mut State, input: Input) -> Output {
        sample(Self::STRUCTURE, &self.config.coefficients, state, input).0
    }

    /// Computes one sample and its trace, as [`step_traced`](crate::step_traced) does.
    #[inline]
    pub fn step_traced(&self, state: &mut State, input: Input) -> (Output, Trace) {
        sample(Self::STRUCTURE, &self.config.coefficients, state, input)
    }
}

// Implemented by hand: derived implementations would require the same trait of `M`, which is only a name.
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
