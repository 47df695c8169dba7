//! Layout of the states that effects add after those of the valves.

use super::physics::{FEW, MANY, Width};
use crate::additions::{Cavity, Line};
use crate::plant::{FILL, Plant, VENT};

/// Indices of the added states.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    /// Time (s), for user-defined laws.
    pub(super) time: Option<usize>,
    /// Pressure in the supply line (Pa abs).
    pub(super) line: Option<usize>,
    /// Pressure in the drain line (Pa abs).
    pub(super) drain: Option<usize>,
    /// Gas temperature (K).
    pub(super) temperature: Option<usize>,
    /// Wall temperature (K).
    pub(super) wall: Option<usize>,
    /// Gas temperature in the second chamber (K).
    pub(super) second_temperature: Option<usize>,
    /// Pressure in the cavity (Pa abs).
    pub(super) cavity: Option<usize>,
    /// Voltage loss of the battery (V).
    pub(super) polarisation: Option<usize>,
    /// Eddy current of the fill valve's coil (A); that of the vent valve's follows.
    pub(super) eddy_currents: Option<usize>,
    /// Share of its travel of a damped plunger (-).
    pub(super) plunger: Option<usize>,
    /// Position of the actuator (m).
    pub(super) actuator: Option<usize>,
    /// First index and number of the user-defined states.
    pub(super) own: (usize, usize),
    /// Whether each valve alone limits the flow through it.
    pub(super) is_alone: [bool; 2],
    len: usize,
}

impl Layout {
    pub(super) fn new(plant: &Plant) -> Self {
        let additions = &plant.additions;
        let mut layout = Self::default();
        let mut place = |present: bool| {
            let index = layout.len;
            layout.len += usize::from(present);
            present.then_some(index)
        };
        let time = place(!additions.hooks.is_empty());
        let line = place(additions.supply_line.is_some_and(Line::has_pressure));
        let drain = place(additions.drain_line.is_some());
        let temperature = place(additions.wall_heat.is_some());
        let wall = place(additions.wall_heat.is_some_and(|heat| heat.wall.is_some()));
        let has_second = additions
            .cavity
            .as_ref()
            .is_some_and(Cavity::is_second_chamber);
        let second_temperature = place(additions.wall_heat.is_some() && has_second);
        let cavity = place(additions.cavity.is_some());
        let polarisation = place(additions.polarisation.is_some());
        let eddy_currents = [FILL, VENT].map(|_| place(additions.eddy_loop.is_state()))[FILL];
        let plunger = place(
            additions
                .plunger
                .is_some_and(|plunger| plunger.damping.is_some()),
        );
        let actuator = place(additions.actuator.is_some());
        let own = additions.hooks.states.len();
        let has_line = additions.supply_line.and_then(Line::orifice).is_some();
        let is_alone = [FILL, VENT].map(|index| {
            let orifices = [additions.combined[index], additions.restrictions[index]];
            orifices == [None; 2] && !(has_line && index == FILL)
        });
        Self {
            time,
            line,
            drain,
            temperature,
            wall,
            second_temperature,
            cavity,
            polarisation,
            eddy_currents,
            plunger,
            actuator,
            own: (layout.len, own),
            is_alone,
            len: layout.len + own,
        }
    }

    pub(super) fn width(&self) -> Width {
        match self.len {
            0 => Width::None,
            1..=FEW => Width::Few,
            _ => Width::Many,
        }
    }

    /// Returns the states at the start, and the inverse of their tolerances for a pressure tolerance (Pa).
    pub(super) fn start(&self, plant: &Plant, pressure_tolerance: f64) -> [[f64; MANY]; 2] {
        let (mut states, mut weights) = ([0.0; MANY], [0.0; MANY]);
        let mut set = |index: Option<usize>, start: f64, tolerance: f64| {
            if let Some(index) = index {
                (states[index], weights[index]) = (start, tolerance.recip());
            }
        };
        let surroundings = plant
            .additions
            .wall_heat
            .map_or(0.0, |heat| heat.surroundings);
        // Ten pascal correspond to ten millikelvin.
        let kelvin = pressure_tolerance * 1e-3;
        set(self.time, 0.0, f64::INFINITY);
        set(self.line, plant.supply_pressure, pressure_tolerance);
        set(self.drain, plant.drain_pressure, pressure_tolerance);
        set(self.temperature, surroundings, kelvin);
        set(self.wall, surroundings, kelvin);
        set(self.second_temperature, surroundings, kelvin);
        set(self.cavity, plant.ambient_pressure, pressure_tolerance);
        // Its volume is a part of the chamber's.
        set(
            self.plunger,
            plant.swept_at_rest(),
            pressure_tolerance * 2e-6,
        );
        // Its velocity is constant between two rows, so that no method has an error: a micrometre, for the differences of
        // a Jacobian.
        set(self.actuator, 0.0, pressure_tolerance * 1e-7);
        // The same share of 24 V as of the supply pressure.
        set(self.polarisation, 0.0, pressure_tolerance * 2.5e-5);
        if let Some(first) = self.eddy_currents {
            // The same share of 0.3 A as of the supply pressure.
            for valve in [FILL, VENT] {
                set(Some(first + valve), 0.0, pressure_tolerance * 3e-7);
            }
        }
        let relative = pressure_tolerance / super::Tolerance::default().pressure;
        for (n, own) in plant.additions.hooks.states.iter().enumerate() {
            set(Some(self.own.0 + n), own.initial, own.tolerance * relative);
        }
        [states, weights]
    }
}
