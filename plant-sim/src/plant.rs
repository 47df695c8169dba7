//! Two valves and a chamber: the right-hand side of equations 3.26 to 3.32, and the additions of effects.

use crate::additions::Additions;
use crate::chamber::Chamber;
use crate::coil::Drive;
use crate::orifice::NozzleLaw;
use crate::subsonic_curves::SubsonicCurves;
use crate::valve::{Valve, ValveState};

/// Index of the fill valve.
pub const FILL: usize = 0;
/// Index of the vent valve.
pub const VENT: usize = 1;

/// Physics of the plant, prepared from the parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    /// Fill and vent valve.
    pub valves: [Valve; 2],
    /// Flow law of all other orifices, such as leaks and restrictions.
    pub nozzle: NozzleLaw,
    /// Universal curves of subsonic flow through the valves.
    pub subsonic: SubsonicCurves,
    /// Chamber of the plant.
    pub chamber: Chamber,
    /// Supply pressure (Pa abs), upstream of the fill valve.
    pub supply_pressure: f64,
    /// Ambient pressure (Pa abs).
    pub ambient_pressure: f64,
    /// Pressure of the drain (Pa abs), downstream of the vent valve: ambient without effects.
    pub drain_pressure: f64,
    /// Drop of the freewheeling diode (V).
    pub diode_drop: f64,
    /// Additions of effects; the methods here ignore them, the simulator does not.
    pub additions: Additions,
}

/// State of the plant: x1 to x7 of section 3.5 with the discrete state of each valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantState {
    /// Fill and vent valve.
    pub valves: [ValveState; 2],
    /// Chamber pressure (Pa abs).
    pub pressure: f64,
}

impl Plant {
    /// Returns the state at rest: coils without current, armatures at their rest stops, chamber at ambient pressure.
    pub fn rest_state(&self) -> PlantState {
        PlantState {
            valves: [ValveState::AT_REST; 2],
            pressure: self.ambient_pressure,
        }
    }

    /// Returns the share of its travel that a plunger has at rest (-).
    pub(crate) fn swept_at_rest(&self) -> f64 {
        let plunger = &self.additions.plunger;
        plunger.map_or(0.0, |plunger| plunger.share(0.0, self.ambient_pressure))
    }

    /// Returns the upstream minus downstream pressure of a valve (Pa) at chamber pressure `pressure` (Pa abs).
    #[inline]
    pub fn pressure_drop(&self, valve: usize, pressure: f64) -> f64 {
        if valve == FILL {
            self.supply_pressure - pressure
        } else {
            pressure - self.drain_pressure
        }
    }

    /// Returns the mass flow through a valve with `effective_area` (m²) (kg/s), positive downstream.
    #[inline]
    pub fn mass_flow(&self, valve: usize, effective_area: f64, pressure: f64) -> f64 {
        if effective_area == 0.0 {
            0.0
        } else if valve == FILL {
            self.valves[FILL]
                .nozzle
                .mass_flow(effective_area, self.supply_pressure, pressure)
        } else {
            self.valves[VENT]
                .nozzle
                .mass_flow(effective_area, pressure, self.drain_pressure)
        }
    }

    /// Returns dp/dt (Pa/s) for the effective areas of fill and vent valve (m²) (equation 3.29).
    #[inline]
    pub fn pressure_rate(&self, effective_areas: [f64; 2], pressure: f64) -> f64 {
        self.chamber.pressure_rate(
            self.mass_flow(FILL, effective_areas[FILL], pressure),
            self.mass_flow(VENT, effective_areas[VENT], pressure),
        )
    }

    /// Returns the whole right-hand side between the end stops, equations 3.26 to 3.32 with the back-EMF of equation
    /// 3.4, for the states in the order of section 3.5: i, x, v of the fill valve, chamber pressure, i, x, v of the
    /// vent valve (SI units). The simulator integrates the moving part of it. This form is for linearisation and for
    /// other solvers, and ignores additions.
    pub fn rates(&self, drives: [Drive; 2], state: &[f64; 7]) -> [f64; 7] {
        let [i_fill, x_fill, v_fill, pressure, i_vent, x_vent, v_vent] = *state;
        let [fill, vent] = &self.valves;
        let fill_rates = fill.rates(
            drives[FILL],
            i_fill,
            x_fill,
            v_fill,
            self.pressure_drop(FILL, pressure),
        );
        let vent_rates = vent.rates(
            drives[VENT],
            i_vent,
            x_vent,
            v_vent,
            self.pressure_drop(VENT, pressure),
        );
        let areas = [fill.effective_area(x_fill), vent.effective_area(x_vent)];
        [
            fill_rates[0],
            fill_rates[1],
            fill_rates[2],
            self.pressure_rate(areas, pressure),
            vent_rates[0],
            vent_rates[1],
            vent_rates[2],
        ]
    }
}
