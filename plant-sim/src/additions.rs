//! What effects add to the thesis' model: filled by [`Effect::install`](crate::effects::Effect::install), read by the
//! simulator. Each law stands in the file of its effect.

use crate::effects::chamber_leak::Leak;
use crate::effects::coil_heating::Heating;
use crate::effects::dead_volume::Cavity;
use crate::effects::gas_temperature::WallHeat;
use crate::effects::iron_saturation::Saturation;
use crate::effects::regulating_valve_volume::Plunger;
use crate::effects::static_friction::Friction;
use crate::effects::supply_line_droop::SupplyLine;
use crate::hooks::Hooks;
use crate::restriction::Restriction;

/// Additions to the plant; the default is none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Additions {
    /// Flow from the chamber to ambient, and from the supply into the chamber.
    pub leaks: [Option<Leak>; 2],
    /// What lies between the supply and the fill valve.
    pub supply_line: Option<SupplyLine>,
    /// Fixed orifices behind the fill and the vent valve.
    pub restrictions: [Option<Restriction>; 2],
    /// Energy balance of the gas.
    pub wall_heat: Option<WallHeat>,
    /// A second volume behind a tube, at whose end the sensor sits.
    pub cavity: Option<Cavity>,
    /// The plunger that enlarges the chamber.
    pub plunger: Option<Plunger>,
    /// Saturation of the iron.
    pub saturation: Option<Saturation>,
    /// Conductance of the eddy currents' loop, referred to the coil (1/Ω).
    pub eddy_conductance: f64,
    /// Resistance that both coils' currents pass (Ω).
    pub supply_resistance: f64,
    /// Resistance in the free-wheeling loop alone (Ω).
    pub free_wheel_resistance: f64,
    /// The coils warm up.
    pub heating: Option<Heating>,
    /// Dry friction of the armatures.
    pub friction: Option<Friction>,
    /// Share of the velocity that an armature keeps at an end stop (-).
    pub restitution: f64,
    /// Share of the pressure force that is lost at full lift (-).
    pub flow_force: f64,
    /// Time constant of the pressure sensor (s).
    pub sensor_lag: f64,
    /// What the sensor shows too much (Pa).
    pub sensor_offset: f64,
    /// What the sensor shows too much per gauge pressure (-).
    pub sensor_gain: f64,
    /// Laws of your own.
    pub hooks: Hooks,
}
