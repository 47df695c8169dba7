//! Everything in which a rig may depart from the plain plant. All zero is the plain plant, bit for bit.

use serde::{Deserialize, Serialize};

/// All departures of one rig.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[allow(missing_docs, reason = "each type says what it is")]
pub struct Departures {
    pub coil: CoilDepartures,
    pub driver: DriverDepartures,
    pub armature: ArmatureDepartures,
    pub supply: SupplyDepartures,
    pub flow: FlowDepartures,
    pub chamber: ChamberDepartures,
    pub pulses: PulseDepartures,
    pub sensor: SensorDepartures,
}

/// Windings and iron, of both valves alike but for their surroundings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CoilDepartures {
    /// Surroundings of each coil over 20 °C (K).
    pub surroundings_k: [f64; 2],
    /// Surroundings of both coils over 20 °C in the end (K), while a cabinet warms up.
    pub surroundings_in_the_end_k: f64,
    /// Time constant of that (s).
    pub surroundings_s: f64,
    /// Winding over the body of the coil per heat (K/W).
    pub winding_k_per_w: f64,
    /// Time constant of the winding (s).
    pub winding_s: f64,
    /// Body of the coil over the surroundings per heat (K/W).
    pub body_k_per_w: f64,
    /// Time constant of the body (s).
    pub body_s: f64,
    /// By how much the inductance without current exceeds that at rated current, which the datasheet states.
    pub saturation: f64,
    /// Power of the flux with which the iron saturates.
    pub saturation_power: i32,
    /// Excess current at rated flux, where the datasheet states the inductance without current.
    pub knee: f64,
    /// Power of the flux with which that grows.
    pub knee_power: i32,
    /// Conductance of the iron as a shorted turn, referred to the coil (S).
    pub eddy_s: f64,
    /// Time in which the eddy currents build up (s).
    pub eddy_lag_s: f64,
}

/// Battery, harness and free-wheeling path.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DriverDepartures {
    /// Voltage of the free-wheeling path beyond the diode's (V).
    pub clamp_v: f64,
    /// Resistance in the free-wheeling path (ohm).
    pub snubber_ohm: f64,
    /// Resistance of the wire that both coils share (ohm).
    pub harness_ohm: f64,
    /// Resistance of the battery that appears with a delay (ohm).
    pub polarisation_ohm: f64,
    /// Time constant of that (s).
    pub polarisation_s: f64,
    /// Wander of the battery that no log shows (V).
    pub wander_v: f64,
    /// Its slowest frequency (Hz).
    pub wander_hz: f64,
}

/// Friction, stops and the force of the flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ArmatureDepartures {
    /// Sliding friction that follows the velocity (N).
    pub coulomb_n: f64,
    /// Friction at the lowest velocities beyond that (N).
    pub breakaway_n: f64,
    /// Sliding friction that follows the deflection of bristles (N).
    pub bristle_n: f64,
    /// Force with which a seat holds an armature that has rested long (N).
    pub adhesion_n: f64,
    /// Time in which that comes (s).
    pub adhesion_s: f64,
    /// Share of the velocity that is left after a stop: rest stop, full stroke.
    pub restitution: [f64; 2],
    /// Share of the pressure force that is lost far from the seat.
    pub pressure_force_loss: f64,
    /// Lift at which half of it is lost (m); exponential if negative, then to 1/e.
    pub pressure_force_lift_m: f64,
}

/// What lies before the fill valve and behind the vent valve.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SupplyDepartures {
    /// Amplitude of a pulsation of the supply (Pa).
    pub pulsation_pa: f64,
    /// Its frequency (Hz).
    pub pulsation_hz: f64,
    /// Pressure that the regulator loses per mass flow (Pa s/kg).
    pub regulator_pa_s_per_kg: f64,
    /// Time constant of the regulator (s).
    pub regulator_s: f64,
    /// Effective area of a restriction before the line (m²).
    pub line_m2: f64,
    /// Volume of the line (m³).
    pub line_m3: f64,
    /// Effective area of an orifice in the inlet of the fill valve (m²).
    pub inlet_m2: f64,
    /// Volume between it and the seat (m³); without it the two areas act as one.
    pub inlet_m3: f64,
    /// Constant pressure of the drain (Pa).
    pub drain_pa: f64,
    /// Pressure of the drain per mass flow (Pa s/kg).
    pub drain_pa_s_per_kg: f64,
    /// Time in which the drain's pressure follows (s).
    pub drain_s: f64,
}

/// Leaks, and the law of the flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FlowDepartures {
    /// From the chamber to the surroundings.
    pub chamber_leak: Leak,
    /// From the supply past the seat of the fill valve.
    pub seat_leak: Leak,
    /// How far the critical ratio lies below that of the nozzle.
    pub critical_ratio_drop: f64,
    /// How far the subsonic index lies above 0.5, where the critical ratio is lower.
    pub subsonic_index_rise: f64,
}

/// A leak: the sum of its laws.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Leak {
    /// A hole: effective area (m²).
    pub hole_m2: f64,
    /// A laminar gap: kg/(s Pa²) by the difference of the squared pressures.
    pub gap_kg_per_s_pa2: f64,
    /// A rough gap: kg/s at 1 bar of difference...
    pub rough_kg_per_s: f64,
    /// ... and the power of the difference.
    pub rough_power: f64,
}

/// Heat, walls and volumes at chamber pressure.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ChamberDepartures {
    /// Time in which gas of ambient density takes the temperature of the wall (s).
    pub thermal_s: f64,
    /// Power of the density with which the heat transfer grows.
    pub thermal_density_power: f64,
    /// Heat capacity of the part of the wall that takes part (J/K); infinite if 0.
    pub wall_j_per_k: f64,
    /// Time in which that part follows the rest (s).
    pub wall_s: f64,
    /// Volume that a plunger sets free (m³).
    pub plunger_m3: f64,
    /// Gauge pressures between which it does (Pa).
    pub plunger_pa: [f64; 2],
    /// Time in which it follows (s).
    pub plunger_s: f64,
    /// Share of its way by which friction holds it back.
    pub plunger_hysteresis: f64,
    /// Volume of tube and sensor cavity (m³).
    pub cavity_m3: f64,
    /// Laminar conductance of the tube (kg/(s Pa)) ...
    pub cavity_kg_per_s_pa: f64,
    /// ... or its effective area (m²).
    pub cavity_m2: f64,
    /// Whether the sensor sits in the cavity.
    pub sensor_in_cavity: bool,
    /// Share of the volume by which a hose stretches per pressure (1/Pa).
    pub hose_per_pa: f64,
    /// Time in which it stretches (s).
    pub hose_s: f64,
}

/// Timing of the output stage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PulseDepartures {
    /// Share of the fill valve's periods without a pulse.
    pub missed_share: f64,
    /// Which ones.
    pub missed_seed: u64,
    /// By how much the ECU's clock is slow against the log's.
    pub clock_drift: f64,
    /// Half the way by which the command delay wanders (s).
    pub delay_wander_s: f64,
    /// Period of that (s).
    pub delay_wander_period_s: f64,
}

/// Pressure sensor and current measurement.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SensorDepartures {
    /// Lag of the pressure sensor (s).
    pub lag_s: f64,
    /// A second lag (s).
    pub second_lag_s: f64,
    /// Offset (Pa).
    pub offset_pa: f64,
    /// Offset that comes while the sensor warms up (Pa).
    pub warm_offset_pa: f64,
    /// Time constant of that (s).
    pub warm_s: f64,
    /// Width of the play in the sensor's reading (Pa).
    pub play_pa: f64,
    /// Largest deviation from a straight line, at 4 bar gauge (Pa).
    pub bow_pa: f64,
    /// Amplitude of a disturbance of both current measurements (A).
    pub interference_a: f64,
    /// Its frequency as the samples show it (Hz).
    pub interference_hz: f64,
}
