//! User-defined laws: closures that a plant calls during the simulation.
//!
//! Each returns one quantity of the plant at an instant ([`Now`]); the results of several are added.

use core::fmt;
use std::sync::Arc;

/// Plant at an instant, as seen by a law. SI units, absolute pressures; fill valve first.
#[derive(Debug, Clone, Copy)]
pub struct Now<'a> {
    /// Time since the start (s).
    pub time: f64,
    /// Chamber pressure (Pa abs).
    pub pressure: f64,
    /// Supply pressure of the plant file (Pa abs).
    pub supply_pressure: f64,
    /// Ambient pressure (Pa abs).
    pub ambient_pressure: f64,
    /// Gas temperature in the chamber (K).
    pub temperature: f64,
    /// Coil currents (A).
    pub current: [f64; 2],
    /// Armature positions (m).
    pub position: [f64; 2],
    /// Armature velocities (m/s).
    pub velocity: [f64; 2],
    /// Duty cycles in force (0 to 1).
    pub duty: [f64; 2],
    /// States added by user-defined effects, in the order of adding.
    pub own: &'a [f64],
}

/// Law that returns a number for every instant.
#[derive(Clone)]
pub struct Law(Arc<dyn Fn(&Now) -> f64 + Send + Sync>);

impl Law {
    fn new(law: impl Fn(&Now) -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(law))
    }

    pub(crate) fn at(&self, now: &Now) -> f64 {
        (self.0)(now)
    }
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Law")
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// User-defined state, integrated with the plant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OwnState {
    pub(crate) initial: f64,
    pub(crate) tolerance: f64,
    pub(crate) rate: Law,
}

/// All laws of a plant's user-defined effects.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Hooks {
    pub(crate) inflow: Vec<Law>,
    pub(crate) supply_pressure: Vec<Law>,
    pub(crate) force: [Vec<Law>; 2],
    pub(crate) voltage: [Vec<Law>; 2],
    pub(crate) measured: Vec<Law>,
    pub(crate) area_factor: [Vec<Law>; 2],
    pub(crate) volume_factor: Vec<Law>,
    pub(crate) states: Vec<OwnState>,
}

impl Hooks {
    /// Maximum number of states that user-defined effects may add.
    pub const MAX_STATES: usize = 4;

    /// Adds a mass flow into the chamber (kg/s), at the chamber's temperature.
    pub fn add_inflow(&mut self, law: impl Fn(&Now) -> f64 + Send + Sync + 'static) {
        self.inflow.push(Law::new(law));
    }

    /// Adds a difference to the supply pressure of the plant file (Pa).
    pub fn add_supply_pressure(&mut self, law: impl Fn(&Now) -> f64 + Send + Sync + 'static) {
        self.supply_pressure.push(Law::new(law));
    }

    /// Adds a force on the armature of a valve, fill 0, vent 1 (N), positive towards full stroke.
    ///
    /// # Panics
    /// Panics if there is no such valve.
    pub fn add_force(&mut self, valve: usize, law: impl Fn(&Now) -> f64 + Send + Sync + 'static) {
        self.force[valve].push(Law::new(law));
    }

    /// Adds a voltage in the loop of a coil, fill 0, vent 1 (V); a positive voltage drives the current.
    ///
    /// # Panics
    /// Panics if there is no such valve.
    pub fn add_voltage(&mut self, valve: usize, law: impl Fn(&Now) -> f64 + Send + Sync + 'static) {
        self.voltage[valve].push(Law::new(law));
    }

    /// Adds a difference to the pressure that the sensor shows (Pa).
    pub fn add_measured(&mut self, law: impl Fn(&Now) -> f64 + Send + Sync + 'static) {
        self.measured.push(Law::new(law));
    }

    /// Adds a factor of the area of a valve, fill 0, vent 1 (-).
    ///
    /// # Panics
    /// Panics if there is no such valve.
    pub fn add_area_factor(
        &mut self,
        valve: usize,
        law: impl Fn(&Now) -> f64 + Send + Sync + 'static,
    ) {
        self.area_factor[valve].push(Law::new(law));
    }

    /// Adds a factor of the chamber's volume (-), a function of [`Now::pressure`] and [`Now::time`] alone.
    pub fn add_volume_factor(&mut self, law: impl Fn(&Now) -> f64 + Send + Sync + 'static) {
        self.volume_factor.push(Law::new(law));
    }

    /// Adds a state that begins at `initial` and changes by `rate` (per second), solved to `tolerance` per step.
    /// Returns its index in [`Now::own`].
    ///
    /// # Panics
    /// Panics if there are [`Self::MAX_STATES`] already, or the tolerance is not positive.
    pub fn add_state(
        &mut self,
        initial: f64,
        tolerance: f64,
        rate: impl Fn(&Now) -> f64 + Send + Sync + 'static,
    ) -> usize {
        assert!(
            self.states.len() < Self::MAX_STATES,
            "at most {} states of your own",
            Self::MAX_STATES
        );
        assert!(tolerance > 0.0, "a tolerance is positive, not {tolerance}");
        self.states.push(OwnState {
            initial,
            tolerance,
            rate: Law::new(rate),
        });
        self.states.len() - 1
    }

    /// Returns whether there is no law that acts on the plant's motion.
    pub(crate) fn is_empty(&self) -> bool {
        let Self {
            inflow,
            supply_pressure,
            force,
            voltage,
            measured,
            area_factor,
            volume_factor,
            states,
        } = self;
        [inflow, supply_pressure, &force[0], &force[1]]
            .into_iter()
            .chain([&voltage[0], &voltage[1], measured])
            .chain([&area_factor[0], &area_factor[1], volume_factor])
            .all(Vec::is_empty)
            && states.is_empty()
    }
}

/// Returns the sum of the laws.
#[inline]
pub(crate) fn sum(laws: &[Law], now: &Now) -> f64 {
    laws.iter().map(|law| law.at(now)).sum()
}

/// Returns the product of the laws.
#[inline]
pub(crate) fn product(laws: &[Law], now: &Now) -> f64 {
    laws.iter().map(|law| law.at(now)).product()
}
