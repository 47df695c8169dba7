//! Library of physical effects in addition to the thesis' model.
//!
//! One file contains one effect: its description, the source of its law, its parameters, the excitation that reveals
//! it, and similar effects. A plant file names the effects of a rig, `[effects.chamber_leak]`; they can be combined. If
//! all strengths of an effect are at their *off* value, the results equal those of the plain model bit for bit.
//!
//! An effect is resolved once: [`Effect::install`] changes a prepared [`Plant`](crate::plant::Plant). Some effects only
//! change existing parameters; the others fill [`Additions`](crate::additions::Additions). A user-defined effect does
//! the same, or adds closures to [`Hooks`](crate::hooks::Hooks), as in `examples/own_effect.rs`.

pub mod actuator_volume;
pub mod chamber_leak;
pub mod coil_ambient_temperature;
pub mod coil_heating;
pub mod critical_ratio;
pub mod dead_volume;
pub mod drain_back_pressure;
pub mod eddy_currents;
pub mod end_stop_bounce;
pub mod flow_force;
pub mod flyback_clamp;
pub mod gas_temperature;
pub mod iron_saturation;
pub mod regulating_valve_volume;
pub mod sensor_hysteresis;
pub mod sensor_lag;
pub mod sensor_offset;
pub mod series_restriction;
pub mod static_friction;
pub mod supply_line_droop;
pub mod supply_resistance;
pub mod supply_seat_leak;
pub mod switching_delay;

pub use crate::description::{About, Effect, EffectSetting, EntryPoint, OwnEffects, Variant};

/// All effects of the library. They are installed in this order, independent of the order in the plant file.
pub static LIBRARY: [&dyn Effect; 23] = [
    &chamber_leak::ChamberLeak,
    &supply_seat_leak::SupplySeatLeak,
    &coil_ambient_temperature::CoilAmbientTemperature,
    &coil_heating::CoilHeating,
    &iron_saturation::IronSaturation,
    &eddy_currents::EddyCurrents,
    &static_friction::StaticFriction,
    &end_stop_bounce::EndStopBounce,
    &flyback_clamp::FlybackClamp,
    &supply_resistance::SupplyResistance,
    &supply_line_droop::SupplyLineDroop,
    &gas_temperature::GasTemperature,
    &regulating_valve_volume::RegulatingValveVolume,
    &sensor_lag::SensorLag,
    &sensor_hysteresis::SensorHysteresis,
    &sensor_offset::SensorOffset,
    &drain_back_pressure::DrainBackPressure,
    &critical_ratio::CriticalRatio,
    &flow_force::FlowForce,
    &series_restriction::SeriesRestriction,
    &dead_volume::DeadVolume,
    &switching_delay::SwitchingDelay,
    &actuator_volume::ActuatorVolume,
];

/// Returns the effect of the library with this id.
pub fn by_id(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY
        .iter()
        .copied()
        .find(|effect| effect.about().id == id)
}
