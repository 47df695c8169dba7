//! Additions of the effects to the thesis' model: filled by [`Effect::install`](crate::effects::Effect::install), read
//! by the simulator. The laws here are independent of the effects; several effects may share one.

mod actuator;
mod cavity;
mod eddy_loop;
mod flow_force;
mod growth;
mod heating;
mod leak;
mod line;
mod opening_delay;
mod plunger;
mod saturation;
mod sensor_lag;
mod wall_heat;
mod warm_up;

pub use actuator::Actuator;
pub use cavity::Cavity;
pub(crate) use cavity::Tube;
pub use eddy_loop::EddyLoop;
pub use flow_force::FlowForce;
pub use growth::Growth;
pub(crate) use heating::{CoilTemperature, resistance};
pub use heating::{HeatStore, Heating};
pub use leak::Leak;
pub(crate) use leak::LeakLaw;
pub use line::Line;
pub use opening_delay::OpeningDelay;
pub use plunger::Plunger;
pub(crate) use plunger::Volume;
pub use saturation::Saturation;
pub use sensor_lag::SensorLag;
pub(crate) use wall_heat::Balance;
pub use wall_heat::WallHeat;
pub use warm_up::WarmUp;

use crate::hooks::Hooks;
use crate::orifice::NozzleLaw;
use crate::restriction::Restriction;

/// Additions to the plant; the default has none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Additions {
    /// Flow from the chamber to ambient, and from the supply into the chamber.
    pub leaks: [Option<Leak>; 2],
    /// Line between the supply and the fill valve.
    pub supply_line: Option<Line>,
    /// Law of the flow through that line where it is a tube; otherwise that of the nozzle.
    pub tube: Option<Box<NozzleLaw>>,
    /// Line between the vent valve and the drain.
    pub drain_line: Option<Line>,
    /// Fixed orifices downstream of the fill and the vent valve.
    pub restrictions: [Option<Restriction>; 2],
    /// Fixed orifices that form one opening together with the fill and the vent valve.
    pub combined: [Option<Restriction>; 2],
    /// Energy balance of the gas.
    pub wall_heat: Option<WallHeat>,
    /// Second volume behind a tube.
    pub cavity: Option<Cavity>,
    /// Growth of the chamber with the pressure.
    pub growth: Option<Growth>,
    /// Plunger that enlarges the chamber.
    pub plunger: Option<Plunger>,
    /// Actuator that enlarges the chamber.
    pub actuator: Option<Actuator>,
    /// Saturation of the iron.
    pub saturation: Option<Saturation>,
    /// Loop of the eddy currents of each coil.
    pub eddy_loop: EddyLoop,
    /// Resistance that the currents of both coils pass (Ω).
    pub supply_resistance: f64,
    /// Resistance of the switch of each coil, which the freewheeling current does not pass (Ω).
    pub switch_resistance: f64,
    /// Voltage loss of the battery under a lasting current.
    pub polarisation: Option<Polarisation>,
    /// Resistance in the freewheeling loop only (Ω).
    pub freewheeling_resistance: f64,
    /// Warming of the coils or their surroundings.
    pub heating: Option<Heating>,
    /// Dry friction of the armatures.
    pub friction: Option<Friction>,
    /// Share of the velocity that an armature keeps at an end stop (-).
    pub restitution: f64,
    /// Loss of pressure force of an open valve.
    pub flow_force: FlowForce,
    /// Opening delay of the valves without a coil.
    pub opening_delay: Option<OpeningDelay>,
    /// Lag of the pressure sensor.
    pub sensor_lag: Option<SensorLag>,
    /// Hysteresis of the sensor: difference of its readings at one pressure (Pa).
    pub sensor_hysteresis: f64,
    /// Offset of the sensor (Pa).
    pub sensor_offset: f64,
    /// Drift of the sensor's offset while it warms up (Pa).
    pub sensor_drift: Option<WarmUp>,
    /// Gain error of the sensor, per gauge pressure (-).
    pub sensor_gain: f64,
    /// User-defined laws.
    pub hooks: Hooks,
}

impl Additions {
    /// Returns whether the current of a coil does not follow from its voltage, resistance and inductance alone.
    pub(crate) fn has_coil_law(&self) -> bool {
        self.saturation.is_some()
            || self.eddy_loop.is_there()
            || self.supply_resistance > 0.0
            || self.polarisation.is_some()
            || !self.hooks.is_empty()
    }

    /// Returns whether the pressure does not follow from the flows through valves and leaks alone.
    pub(crate) fn has_gas_law(&self) -> bool {
        self.supply_line.is_some()
            || self.drain_line.is_some()
            || self.restrictions != [None; 2]
            || self.combined != [None; 2]
            || self.wall_heat.is_some()
            || self.cavity.is_some()
            || self.growth.is_some()
            || self.plunger.is_some()
            || self.actuator.is_some()
            || !self.hooks.is_empty()
    }
}

/// Voltage behind a resistance that rises and decays with a time constant: a battery under a lasting current (E50).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polarisation {
    /// Final voltage divided by the current of all energised coils (Ω).
    pub resistance: f64,
    /// Time constant (s).
    pub time_constant: f64,
}

/// Friction at rest and in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Largest friction force at rest (N).
    pub at_rest: f64,
    /// Friction force against the motion (N).
    pub sliding: f64,
}

/// Velocity (m/s) below which an armature stays at the stop it meets: its flight would be a micrometre.
pub(crate) const SLOWEST_BOUNCE: f64 = 0.02;
/// Time (s) between two impacts below which an armature stays at the stop as well: under a constant force, infinitely
/// many ever shorter bounces happen in a finite time.
pub(crate) const SHORTEST_FLIGHT: f64 = 1e-6;
