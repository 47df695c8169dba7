//! Solenoid valve: coil, magnet, armature and orifice between an upstream and a downstream pressure.

use crate::armature::Armature;
use crate::coil::{Coil, Drive, RestingCurrent};
use crate::magnet::Magnet;
use crate::orifice::{Limit, NozzleLaw, Orifice};

/// Function of the valve without current (section 2.3), or of the part in its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValveFunction {
    /// Closed without current; the armature's travel is the lift.
    NormallyClosed,
    /// Open without current; the armature's travel closes the orifice.
    NormallyOpen,
    /// On/off valve known by its switching times and its conductance: closed without a command, no coil, no armature.
    OnOff,
    /// Proportional valve known by its characteristic and its conductance: closed without a command, no coil, no armature.
    Proportional,
    /// Orifice that is always open: no coil, no armature.
    AlwaysOpen,
    /// Coil whose armature is blocked at its rest stop: no air flows.
    Blocked,
    /// Neither valve nor orifice.
    Absent,
}

impl ValveFunction {
    /// Returns whether there is a coil to command.
    pub fn has_coil(self) -> bool {
        self.has_armature() || self == Self::Blocked
    }

    /// Returns whether a duty cycle commands it.
    pub fn is_commanded(self) -> bool {
        self.has_coil() || self.has_conductance()
    }

    /// Returns whether a conductance and a critical ratio describe its flow (ISO 6358).
    pub fn has_conductance(self) -> bool {
        matches!(self, Self::OnOff | Self::Proportional)
    }

    /// Returns whether there is an armature that may move.
    pub fn has_armature(self) -> bool {
        matches!(self, Self::NormallyClosed | Self::NormallyOpen)
    }

    /// Returns the duty cycle that shuts the valve (%); none for a part that no duty cycle shuts.
    pub fn shut_duty_pct(self) -> Option<f64> {
        match self {
            Self::NormallyOpen => Some(100.0),
            Self::AlwaysOpen => None,
            Self::NormallyClosed
            | Self::OnOff
            | Self::Proportional
            | Self::Blocked
            | Self::Absent => Some(0.0),
        }
    }

    /// Returns whether air may flow.
    pub fn has_orifice(self) -> bool {
        self.has_armature() || self.has_conductance() || self == Self::AlwaysOpen
    }
}

/// Physics of a valve.
#[derive(Debug, Clone, PartialEq)]
pub struct Valve {
    /// Electrical model.
    pub coil: Coil,
    /// Magnetic model.
    pub magnet: Magnet,
    /// Mechanical model.
    pub armature: Armature,
    /// Pneumatic model: opening.
    pub orifice: Orifice,
    /// Pneumatic model: flow through the opening.
    pub nozzle: NozzleLaw,
    /// Function, such as normally closed or normally open.
    pub function: ValveFunction,
}

/// Motion of the armature.
///
/// ```text
///          departs              arrives
/// AtRestStop ──► Moving ──► AtFullStroke
///      ▲           │ ▲            │
///      └───────────┘ └────────────┘
///        arrives        departs
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// At rest against the stop at x = 0, by spring and preload.
    AtRestStop,
    /// Between the stops: current, position and velocity are integrated together.
    Moving,
    /// At rest against the stop at x = stroke, by the magnet.
    AtFullStroke,
    /// At rest between the stops by dry friction, which the plain model does not have.
    Stuck,
}

/// Change of the motion of a valve without a coil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Turn {
    /// The open share begins to move with a velocity (1/s).
    Moves(f64),
    /// The valve rests with an open share.
    RestsAt(f64),
}

/// State of a valve between two events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValveState {
    /// Coil current (A), never negative.
    pub current: f64,
    /// Armature position (m), 0 to stroke.
    pub x: f64,
    /// Armature velocity (m/s).
    pub v: f64,
    /// Motion of the armature.
    pub motion: Motion,
    /// Drive of the coil.
    pub drive: Drive,
}

impl ValveState {
    /// Coil without current, armature at its rest stop.
    pub const AT_REST: Self = Self {
        current: 0.0,
        x: 0.0,
        v: 0.0,
        motion: Motion::AtRestStop,
        drive: Drive::Blocked,
    };
}

impl Valve {
    /// Returns the lift of the valve seat (m) with the armature at `x`.
    #[inline]
    pub fn lift(&self, x: f64) -> f64 {
        match self.function {
            ValveFunction::NormallyOpen | ValveFunction::AlwaysOpen => self.armature.stroke - x,
            _ => x,
        }
    }

    /// Returns the discharge coefficient times open area (m²) with the armature at `x`.
    #[inline]
    pub fn effective_area(&self, x: f64) -> f64 {
        self.orifice.effective_area(self.lift(x))
    }

    /// Returns the discharge coefficient times open area (m²) of the open valve.
    pub fn largest_area(&self) -> f64 {
        self.orifice.effective_area(self.armature.stroke)
    }

    /// Returns the part of the area law that is valid at `x` and, at the kink itself, in the direction of `v`.
    #[inline]
    pub fn limit(&self, x: f64, v: f64) -> Limit {
        let [lowest, highest] = self.interval(Limit::Curtain);
        let inside = lowest < x && x < highest;
        let entering = (x == lowest && (v > 0.0 || lowest == 0.0))
            || (x == highest && (v <= 0.0 || highest == self.armature.stroke));
        if inside || entering {
            Limit::Curtain
        } else {
            Limit::Bore
        }
    }

    /// Returns the discharge coefficient times open area (m²) by one part of the area law.
    #[inline]
    pub fn effective_area_by(&self, limit: Limit, x: f64) -> f64 {
        self.orifice.effective_area_by(limit, self.lift(x))
    }

    /// Returns the armature positions between which one part of the area law is valid (m): from a stop to the kink,
    /// where curtain and bore are equal, or from there to the other stop.
    pub fn interval(&self, limit: Limit) -> [f64; 2] {
        let stroke = self.armature.stroke;
        let saturation = self.orifice.saturation_lift().min(stroke);
        match (self.function, limit) {
            (ValveFunction::NormallyOpen | ValveFunction::AlwaysOpen, Limit::Curtain) => {
                [stroke - saturation, stroke]
            }
            (ValveFunction::NormallyOpen | ValveFunction::AlwaysOpen, Limit::Bore) => {
                [0.0, stroke - saturation]
            }
            (_, Limit::Curtain) => [0.0, saturation],
            (_, Limit::Bore) => [saturation, stroke],
        }
    }

    /// Returns (di/dt, dx/dt, dv/dt) of a moving valve.
    #[inline]
    pub fn rates(
        &self,
        drive: Drive,
        current: f64,
        x: f64,
        v: f64,
        pressure_drop: f64,
    ) -> [f64; 3] {
        [
            self.coil.current_rate(drive, current, x, v),
            v,
            self.armature
                .acceleration(self.magnet.force(current, x), x, v, pressure_drop),
        ]
    }

    /// Returns the exact current while the armature stays at its position.
    #[inline]
    pub fn resting_current(&self, state: &ValveState) -> RestingCurrent {
        self.coil.at_rest(state.drive, state.current, state.x)
    }

    /// Returns the breakaway force on a resting armature (N): it leaves its stop if this is positive.
    #[inline]
    pub fn breakaway_force(&self, motion: Motion, x: f64, current: f64, pressure_drop: f64) -> f64 {
        let net = self.magnet.force(current, x) + self.armature.static_force(x, pressure_drop);
        match motion {
            Motion::AtRestStop => net,
            Motion::AtFullStroke => -net,
            Motion::Moving | Motion::Stuck => f64::NEG_INFINITY,
        }
    }
}
