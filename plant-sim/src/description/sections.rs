//! Tables of a plant file.

/// Sampling and output stage of the ECU.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct EcuParameters {
    pub sample_time_s: f64,
    pub pwm_frequency_hz: f64,
    pub command_delay_s: f64,
    pub supply_voltage_v: f64,
    pub free_wheel_diode_drop_v: f64,
}

/// Coil of each valve.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct CoilParameters {
    pub resistance_20c_ohm: f64,
    pub resistance_temperature_coefficient_per_k: f64,
    pub inductance_closed_h: f64,
    pub inductance_open_h: f64,
}

/// Magnetic circuit of each valve.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct MagnetParameters {
    pub force_constant_n_m2_per_a2: f64,
    pub gap_closed_m: f64,
}

/// Armature and spring of each valve.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct ArmatureParameters {
    pub mass_kg: f64,
    pub stroke_m: f64,
    pub viscous_friction_ns_per_m: f64,
    pub spring_n_per_m: f64,
    pub pressure_force_diameter_m: f64,
    pub preload_fill_n: f64,
    pub preload_vent_n: f64,
}

/// Orifices and flow law.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct FlowParameters {
    pub orifice_fill_m: f64,
    pub orifice_vent_m: f64,
    pub discharge_fill: f64,
    pub discharge_vent: f64,
    pub critical_ratio: f64,
}

/// On/off valve that is known by its switching times and its conductance.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct OnOffValveParameters {
    pub conductance_dm3_per_s_bar: f64,
    pub critical_ratio: f64,
    pub opening_delay_s: f64,
    pub closing_delay_s: f64,
    pub opening_ramp_s: f64,
    pub closing_ramp_s: f64,
}

/// Proportional valve that is known by its characteristic and its conductance.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct ProportionalValveParameters {
    pub conductance_dm3_per_s_bar: f64,
    pub critical_ratio: f64,
    pub time_constant_s: f64,
    pub opens_at_pct: f64,
    pub above_line_25_pct: f64,
    pub above_line_50_pct: f64,
    pub above_line_75_pct: f64,
    /// Part of the valve that follows with the lag; none where the plant file leaves this open.
    pub lag_of: Option<LagOf>,
}

/// Part of a proportional valve that follows with a lag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LagOf {
    /// The spool follows the command, and its position gives the opening.
    #[default]
    Spool,
    /// The opening follows what the command gives at rest.
    Opening,
}

/// Gas, and the pressures around the plant.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct GasParameters {
    pub gas_constant_j_per_kg_k: f64,
    pub heat_capacity_ratio: f64,
    pub temperature_k: f64,
    pub supply_pressure_bar_gauge: f64,
    pub ambient_pressure_pa: f64,
    pub thermometer_wall_share: f64,
    pub supply_gauge_offset_bar: f64,
}

/// Chamber.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct ChamberParameters {
    pub volume_m3: f64,
    pub growth_m3_per_bar: f64,
    pub growth_pressure_bar: f64,
}

/// Second chamber behind a line.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct SecondChamberParameters {
    pub volume_m3: f64,
    pub conductance_dm3_per_s_bar: f64,
    pub critical_ratio: f64,
    /// Place of the pressure sensor.
    pub sensor: SensorPlace,
}

/// Place of the pressure sensor in a plant with two chambers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SensorPlace {
    /// In the second chamber, behind the line.
    #[default]
    SecondChamber,
    /// In the chamber between the valves.
    Chamber,
}

/// Regulating valve behind the chamber.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct RegulatingValveParameters {
    pub plunger_mass_kg: f64,
    pub air_area_m2: f64,
    pub oil_area_m2: f64,
    pub oil_pressure_bar_gauge: f64,
    pub spring_n_per_m: f64,
    pub preload_n: f64,
    pub static_friction_n: f64,
    pub dynamic_friction_n: f64,
    pub stroke_m: f64,
}

/// Pascal per bar.
pub const PA_PER_BAR: f64 = 1e5;

impl EcuParameters {
    /// Returns the ECU sample time (ns).
    pub fn sample_time_ns(&self) -> u64 {
        nanoseconds(self.sample_time_s)
    }

    /// Returns the PWM period (ns).
    pub fn pwm_period_ns(&self) -> u64 {
        nanoseconds(1.0 / self.pwm_frequency_hz)
    }

    /// Returns the delay from a command to its effect at the output (ns).
    pub fn command_delay_ns(&self) -> u64 {
        nanoseconds(self.command_delay_s)
    }
}

impl OnOffValveParameters {
    /// Returns the opening and the closing delay (ns).
    pub fn delays_ns(&self) -> [u64; 2] {
        [self.opening_delay_s, self.closing_delay_s].map(nanoseconds)
    }
}

fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

impl GasParameters {
    /// Returns R T (J/kg).
    pub(crate) fn rt(&self) -> f64 {
        self.gas_constant_j_per_kg_k * self.temperature_k
    }

    /// Returns the supply pressure (Pa abs).
    pub fn supply_pressure_pa(&self) -> f64 {
        self.supply_pressure_bar_gauge * PA_PER_BAR + self.ambient_pressure_pa
    }
}
