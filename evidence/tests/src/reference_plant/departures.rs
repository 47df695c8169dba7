//! Departures of a rig from the plain plant. All zero is the plain plant, bit for bit.

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

/// Windings and iron; both valves are equal except for their surroundings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CoilDepartures {
    /// Temperature of the surroundings of each coil above 20 °C (K).
    pub surroundings_k: [f64; 2],
    /// Final temperature of the surroundings of both coils above 20 °C (K), while a cabinet warms up.
    pub surroundings_in_the_end_k: f64,
    /// Time constant of that warming (s).
    pub surroundings_s: f64,
    /// Thermal resistance between winding and body of the coil (K/W).
    pub winding_k_per_w: f64,
    /// Time constant of the winding (s).
    pub winding_s: f64,
    /// Thermal resistance between body of the coil and surroundings (K/W).
    pub body_k_per_w: f64,
    /// Time constant of the body (s).
    pub body_s: f64,
    /// Excess of the inductance without current over that at rated current, which the datasheet states.
    pub saturation: f64,
    /// Power of the flux in the saturation.
    pub saturation_power: i32,
    /// Excess current at rated flux, if the datasheet states the inductance without current.
    pub knee: f64,
    /// Power of the flux in that excess.
    pub knee_power: i32,
    /// Conductance of the iron as a shorted turn, referred to the coil (S).
    pub eddy_s: f64,
    /// Build-up time of the eddy currents (s).
    pub eddy_lag_s: f64,
}

/// Battery, harness and freewheeling path.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DriverDepartures {
    /// Voltage of the freewheeling path beyond the diode's (V).
    pub clamp_v: f64,
    /// Resistance in the freewheeling path (ohm).
    pub snubber_ohm: f64,
    /// Resistance of the wire that both coils share (ohm).
    pub harness_ohm: f64,
    /// Resistance of the battery that acts with a delay (ohm).
    pub polarisation_ohm: f64,
    /// Time constant of that delay (s).
    pub polarisation_s: f64,
    /// Amplitude of a battery voltage variation that no log contains (V).
    pub wander_v: f64,
    /// Lowest frequency of the variation (Hz).
    pub wander_hz: f64,
}

/// Friction, stops and the flow force.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ArmatureDepartures {
    /// Sliding friction that follows the velocity (N).
    pub coulomb_n: f64,
    /// Additional friction at the lowest velocities (N).
    pub breakaway_n: f64,
    /// Sliding friction that follows the deflection of bristles (N).
    pub bristle_n: f64,
    /// Adhesion force of a seat after a long rest (N).
    pub adhesion_n: f64,
    /// Build-up time of the adhesion (s).
    pub adhesion_s: f64,
    /// Share of the velocity after an impact: rest stop, full stroke.
    pub restitution: [f64; 2],
    /// Share of the pressure force that is lost far from the seat.
    pub pressure_force_loss: f64,
    /// Lift at which half of it is lost (m); if negative, the lift of an exponential loss to 1/e.
    pub pressure_force_lift_m: f64,
}

/// Supply and drain.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SupplyDepartures {
    /// Amplitude of a pulsation of the supply (Pa).
    pub pulsation_pa: f64,
    /// Frequency of the pulsation (Hz).
    pub pulsation_hz: f64,
    /// Pressure loss of the regulator per mass flow (Pa s/kg).
    pub regulator_pa_s_per_kg: f64,
    /// Time constant of the regulator (s).
    pub regulator_s: f64,
    /// Effective area of a restriction upstream of the line (m²).
    pub line_m2: f64,
    /// Volume of the line (m³).
    pub line_m3: f64,
    /// Effective area of an orifice in the inlet of the fill valve (m²).
    pub inlet_m2: f64,
    /// Volume between that orifice and the seat (m³); without it the two areas act as one.
    pub inlet_m3: f64,
    /// Constant pressure of the drain (Pa).
    pub drain_pa: f64,
    /// Pressure of the drain per mass flow (Pa s/kg).
    pub drain_pa_s_per_kg: f64,
    /// Time constant of the drain's pressure (s).
    pub drain_s: f64,
}

/// Leaks, and the law of the flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FlowDepartures {
    /// Leak from the chamber to the surroundings.
    pub chamber_leak: Leak,
    /// Leak from the supply past the seat of the fill valve.
    pub seat_leak: Leak,
    /// Difference of the critical ratio below that of the nozzle.
    pub critical_ratio_drop: f64,
    /// Excess of the subsonic index over 0.5, if the critical ratio is lower.
    pub subsonic_index_rise: f64,
}

/// Leak: the sum of its laws.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Leak {
    /// Effective area of a hole (m²).
    pub hole_m2: f64,
    /// Laminar gap: kg/(s Pa²) by the difference of the squared pressures.
    pub gap_kg_per_s_pa2: f64,
    /// Rough gap: mass flow (kg/s) at 1 bar of difference.
    pub rough_kg_per_s: f64,
    /// Power of the difference in the rough gap.
    pub rough_power: f64,
}

/// Heat, walls and volumes at chamber pressure.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ChamberDepartures {
    /// Time constant with which gas of ambient density takes the temperature of the wall (s).
    pub thermal_s: f64,
    /// Power of the density in the heat transfer.
    pub thermal_density_power: f64,
    /// Heat capacity of the part of the wall that warms (J/K); infinite if 0.
    pub wall_j_per_k: f64,
    /// Time constant of that part to the rest of the wall (s).
    pub wall_s: f64,
    /// Volume that a plunger adds (m³).
    pub plunger_m3: f64,
    /// Gauge pressures between which the plunger moves (Pa).
    pub plunger_pa: [f64; 2],
    /// Time constant of the plunger (s).
    pub plunger_s: f64,
    /// Share of the plunger's stroke by which friction holds it back.
    pub plunger_hysteresis: f64,
    /// Volume of tube and sensor cavity (m³).
    pub cavity_m3: f64,
    /// Laminar conductance of the tube (kg/(s Pa)).
    pub cavity_kg_per_s_pa: f64,
    /// Effective area of the tube, if it is an orifice (m²).
    pub cavity_m2: f64,
    /// Whether the sensor measures the cavity's pressure.
    pub sensor_in_cavity: bool,
    /// Relative volume by which a hose stretches per pressure (1/Pa).
    pub hose_per_pa: f64,
    /// Time constant of the stretching (s).
    pub hose_s: f64,
}

/// Timing of the output stage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PulseDepartures {
    /// Share of the fill valve's periods without a pulse.
    pub missed_share: f64,
    /// Seed of the missed periods.
    pub missed_seed: u64,
    /// Relative slowness of the ECU's clock against the log's.
    pub clock_drift: f64,
    /// Amplitude of the variation of the command delay (s).
    pub delay_wander_s: f64,
    /// Period of the variation (s).
    pub delay_wander_period_s: f64,
}

/// Pressure sensor and current measurement.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SensorDepartures {
    /// Lag of the pressure sensor (s).
    pub lag_s: f64,
    /// Second lag (s).
    pub second_lag_s: f64,
    /// Offset (Pa).
    pub offset_pa: f64,
    /// Offset that appears while the sensor warms up (Pa).
    pub warm_offset_pa: f64,
    /// Time constant of the warm-up (s).
    pub warm_s: f64,
    /// Width of the play in the sensor's reading (Pa).
    pub play_pa: f64,
    /// Largest deviation from a straight line, at 4 bar gauge (Pa).
    pub bow_pa: f64,
    /// Amplitude of a disturbance of both current measurements (A).
    pub interference_a: f64,
    /// Apparent frequency of the disturbance in the samples (Hz).
    pub interference_hz: f64,
}
