//! List of all parameters.

use super::names::{REGULATING_VALVE, VALVES};
use crate::description::{EFFECTS, ParameterSpec, PlantParameters};
use crate::effects::LIBRARY;
use crate::own_effects::OWN_EFFECTS;

/// Defines the list `$list`, and access to the fields that its rows describe: `required` tables always exist, an
/// `optional` one is an `Option`.
macro_rules! parameters {
    ($list:ident $field:ident $field_mut:ident $kind:ident:
        $($section:ident.$key:ident [$unit:literal] $min:literal ..= $max:literal, $about:literal;)*) => {
        const $list: &[ParameterSpec] = &[$(ParameterSpec {
            section: stringify!($section),
            key: stringify!($key),
            unit: $unit,
            range: ($min, $max),
            about: $about,
            size: None,
        }),*];

        fn $field(plant: &PlantParameters, section: &str, key: &str) -> Option<f64> {
            match (section, key) {
                $((stringify!($section), stringify!($key)) => {
                    parameters!(@read $kind plant $section $key)
                })*
                _ => None,
            }
        }

        fn $field_mut<'a>(
            plant: &'a mut PlantParameters,
            section: &str,
            key: &str,
        ) -> Option<&'a mut f64> {
            match (section, key) {
                $((stringify!($section), stringify!($key)) => {
                    parameters!(@slot $kind plant $section $key)
                })*
                _ => None,
            }
        }
    };
    (@slot required $plant:ident $section:ident $key:ident) => { Some(&mut $plant.$section.$key) };
    (@read required $plant:ident $section:ident $key:ident) => { Some($plant.$section.$key) };
    (@slot optional $plant:ident $section:ident $key:ident) => {
        $plant.$section.as_mut().map(|section| &mut section.$key)
    };
    (@read optional $plant:ident $section:ident $key:ident) => {
        $plant.$section.as_ref().map(|section| section.$key)
    };
}

parameters! { THESIS_MODEL thesis_field thesis_field_mut required:
    ecu.sample_time_s ["s"] 1e-4 ..= 1.0, "ECU sample time T_ECU; the grid of commands and samples";
    ecu.pwm_frequency_hz ["Hz"] 5.0 ..= 5000.0, "PWM frequency f_PWM of both outputs (equation 3.1)";
    ecu.command_delay_s ["s"] 0.0 ..= 1.0, "time from a command to its effect at the output (section 4.2.4)";
    ecu.supply_voltage_v ["V"] 5.0 ..= 60.0, "supply voltage e at the ECU output (equation 3.2); may be absent for valves without a coil and is 24 V then";
    ecu.free_wheel_diode_drop_v ["V"] 0.0 ..= 60.0, "drop V_D of the freewheeling diode (equation 3.5)";
    coil.resistance_20c_ohm ["ohm"] 0.5 ..= 5000.0, "coil resistance R at 20 degC (equation 3.2)";
    coil.resistance_temperature_coefficient_per_k ["1/K"] 0.0 ..= 0.01, "temperature coefficient of the resistance (equation 5.7), copper 0.0039; without effect while the coil stays at 20 degC, as in the plain model";
    coil.inductance_closed_h ["H"] 1e-4 ..= 20.0, "inductance L_off with the armature at its rest stop (equation 3.6)";
    coil.inductance_open_h ["H"] 1e-4 ..= 20.0, "inductance L_on with the armature at full stroke (equation 3.6)";
    magnet.force_constant_n_m2_per_a2 ["N m2/A2"] 1e-8 ..= 1.0, "mu0 A_p N^2 / 2 of the magnetic force (equation 3.10)";
    magnet.gap_closed_m ["m"] 5e-5 ..= 0.05, "effective air gap with the armature at its rest stop (equation 3.9)";
    armature.mass_kg ["kg"] 1e-4 ..= 1.0, "moving mass (equation 3.11)";
    armature.stroke_m ["m"] 2e-5 ..= 0.02, "distance between the end stops";
    armature.viscous_friction_ns_per_m ["N s/m"] 0.0 ..= 500.0, "viscous friction b (equation 3.14)";
    armature.spring_n_per_m ["N/m"] 0.0 ..= 1e6, "spring rate k_s (equation 3.15)";
    armature.pressure_force_diameter_m ["m"] 0.0 ..= 0.05, "diameter of the area on which the pressure difference acts (equation 3.13)";
    armature.preload_fill_n ["N"] 0.0 ..= 1000.0, "spring preload of the fill valve (equation 3.16)";
    armature.preload_vent_n ["N"] 0.0 ..= 1000.0, "spring preload of the vent valve (equation 3.16)";
    flow.orifice_fill_m ["m"] 5e-5 ..= 0.05, "orifice diameter of the fill valve (equation 3.21)";
    flow.orifice_vent_m ["m"] 5e-5 ..= 0.05, "orifice diameter of the vent valve (equation 3.21)";
    flow.discharge_fill [""] 0.05 ..= 1.5, "discharge coefficient of the fill valve (equations 3.19, 5.1)";
    flow.discharge_vent [""] 0.05 ..= 1.5, "discharge coefficient of the vent valve (equations 3.19, 5.1)";
    flow.critical_ratio [""] 0.1 ..= 0.6, "pressure ratio below which the flow is choked (equation 3.22); real components have less than 0.528";
    on_off_fill.conductance_dm3_per_s_bar ["dm3/(s bar)"] 1e-4 ..= 100.0, "sonic conductance C of the open fill valve (ISO 6358, equation E63)";
    on_off_fill.critical_ratio [""] 0.01 ..= 0.6, "critical pressure ratio b of the fill valve (ISO 6358, equation E63)";
    on_off_fill.opening_delay_s ["s"] 0.0 ..= 1.0, "time for which a command must stand until the fill valve begins to open (equation E64)";
    on_off_fill.closing_delay_s ["s"] 0.0 ..= 1.0, "time for which a pause must last until the fill valve begins to close (equation E64)";
    on_off_fill.opening_ramp_s ["s"] 1e-5 ..= 1.0, "time in which the fill valve opens, linearly, from closed to fully open (equation E64)";
    on_off_fill.closing_ramp_s ["s"] 1e-5 ..= 1.0, "time in which the fill valve closes, linearly, from fully open to closed (equation E64)";
    on_off_vent.conductance_dm3_per_s_bar ["dm3/(s bar)"] 1e-4 ..= 100.0, "sonic conductance C of the open vent valve (ISO 6358, equation E63)";
    on_off_vent.critical_ratio [""] 0.01 ..= 0.6, "critical pressure ratio b of the vent valve (ISO 6358, equation E63)";
    on_off_vent.opening_delay_s ["s"] 0.0 ..= 1.0, "time for which a command must stand until the vent valve begins to open (equation E64)";
    on_off_vent.closing_delay_s ["s"] 0.0 ..= 1.0, "time for which a pause must last until the vent valve begins to close (equation E64)";
    on_off_vent.opening_ramp_s ["s"] 1e-5 ..= 1.0, "time in which the vent valve opens, linearly, from closed to fully open (equation E64)";
    on_off_vent.closing_ramp_s ["s"] 1e-5 ..= 1.0, "time in which the vent valve closes, linearly, from fully open to closed (equation E64)";
    proportional_fill.conductance_dm3_per_s_bar ["dm3/(s bar)"] 1e-4 ..= 100.0, "sonic conductance C of the fully open fill valve (ISO 6358, equation E63)";
    proportional_fill.critical_ratio [""] 0.01 ..= 0.6, "critical pressure ratio b of the fill valve (ISO 6358, equation E63)";
    proportional_fill.time_constant_s ["s"] 1e-4 ..= 10.0, "time constant with which the fill valve follows its command (equation E67)";
    proportional_fill.opens_at_pct ["%"] 0.0 ..= 90.0, "command above which the fill valve opens; 100 % opens it fully (equation E67); may be absent and is 0 then";
    proportional_fill.above_line_25_pct ["%"] -25.0 ..= 75.0, "open share above the straight characteristic at a quarter of the way from opens_at_pct to 100 % (equation E67); may be absent and is 0 then";
    proportional_fill.above_line_50_pct ["%"] -50.0 ..= 50.0, "open share above the straight characteristic at half the way from opens_at_pct to 100 % (equation E67); may be absent and is 0 then";
    proportional_fill.above_line_75_pct ["%"] -75.0 ..= 25.0, "open share above the straight characteristic at three quarters of the way from opens_at_pct to 100 % (equation E67); may be absent and is 0 then";
    proportional_vent.conductance_dm3_per_s_bar ["dm3/(s bar)"] 1e-4 ..= 100.0, "sonic conductance C of the fully open vent valve (ISO 6358, equation E63)";
    proportional_vent.critical_ratio [""] 0.01 ..= 0.6, "critical pressure ratio b of the vent valve (ISO 6358, equation E63)";
    proportional_vent.time_constant_s ["s"] 1e-4 ..= 10.0, "time constant with which the vent valve follows its command (equation E67)";
    proportional_vent.opens_at_pct ["%"] 0.0 ..= 90.0, "command above which the vent valve opens; 100 % opens it fully (equation E67); may be absent and is 0 then";
    proportional_vent.above_line_25_pct ["%"] -25.0 ..= 75.0, "open share above the straight characteristic at a quarter of the way from opens_at_pct to 100 % (equation E67); may be absent and is 0 then";
    proportional_vent.above_line_50_pct ["%"] -50.0 ..= 50.0, "open share above the straight characteristic at half the way from opens_at_pct to 100 % (equation E67); may be absent and is 0 then";
    proportional_vent.above_line_75_pct ["%"] -75.0 ..= 25.0, "open share above the straight characteristic at three quarters of the way from opens_at_pct to 100 % (equation E67); may be absent and is 0 then";
    gas.gas_constant_j_per_kg_k ["J/(kg K)"] 50.0 ..= 5000.0, "gas constant (equation 3.17); air 287.05";
    gas.heat_capacity_ratio [""] 1.05 ..= 1.7, "ratio of heat capacities k (equation 3.19); air 1.4";
    gas.temperature_k ["K"] 200.0 ..= 500.0, "gas temperature, constant (equation 3.24)";
    gas.supply_pressure_bar_gauge ["bar gauge"] 0.0 ..= 40.0, "supply pressure P_sup";
    gas.ambient_pressure_pa ["Pa abs"] 3e4 ..= 1.2e5, "ambient pressure P_atm, also of the drain";
    gas.thermometer_wall_share [""] 0.0 ..= 0.9, "share of the wall's temperature in what a thermometer in the gas shows, by radiation and along its stem; may be absent and is 0 then";
    gas.supply_gauge_offset_bar ["bar"] -1.0 ..= 1.0, "what a logged supply pressure p_sup shows more than there is (E60); may be absent and is 0 then";
    chamber.volume_m3 ["m3"] 1e-7 ..= 1.0, "dead volume V_ch of chamber, channels and actuator (section 2.2)";
    chamber.growth_m3_per_bar ["m3/bar"] 0.0 ..= 0.01, "growth of a hose per bar gauge, beyond volume_m3 at ambient pressure (E65); may be absent and is 0 then";
    chamber.growth_pressure_bar ["bar"] 0.0 ..= 100.0, "gauge pressure over which the growth fades to 1/e (E65); may be absent, the growth is in proportion to the pressure then";
    second_chamber.volume_m3 ["m3"] 1e-7 ..= 1.0, "volume of a second chamber behind a line, with the pressure sensor (E66)";
    second_chamber.conductance_dm3_per_s_bar ["dm3/(s bar)"] 1e-4 ..= 100.0, "sonic conductance C of the line to the second chamber (ISO 6358, equation E63)";
    second_chamber.critical_ratio [""] 0.01 ..= 0.6, "critical pressure ratio b of the line to the second chamber (ISO 6358, equation E63)";
}

parameters! { REGULATING_VALVE_MODEL regulating_valve_field regulating_valve_field_mut optional:
    regulating_valve.plunger_mass_kg ["kg"] 1e-3 ..= 10.0, "mass of the plunger (equation 3.25)";
    regulating_valve.air_area_m2 ["m2"] 1e-6 ..= 0.1, "plunger area on the air side (equation 3.25)";
    regulating_valve.oil_area_m2 ["m2"] 0.0 ..= 0.1, "plunger area on the oil side (equation 3.25)";
    regulating_valve.oil_pressure_bar_gauge ["bar gauge"] 0.0 ..= 60.0, "oil pressure against the plunger (equation 3.25)";
    regulating_valve.spring_n_per_m ["N/m"] 1.0 ..= 1e6, "spring rate against the plunger (equation 3.25)";
    regulating_valve.preload_n ["N"] 0.0 ..= 1e4, "spring preload against the plunger (equation 3.25)";
    regulating_valve.static_friction_n ["N"] 0.0 ..= 1e3, "friction that must be overcome from rest (equation 3.25)";
    regulating_valve.dynamic_friction_n ["N"] 0.0 ..= 1e3, "friction while the plunger moves (equation 3.25)";
    regulating_valve.stroke_m ["m"] 1e-4 ..= 0.5, "travel of the plunger between its stops";
}

/// All parameters of a plant file, in its order.
pub static PARAMETERS: std::sync::LazyLock<Vec<&'static ParameterSpec>> =
    std::sync::LazyLock::new(|| {
        let effects = LIBRARY
            .iter()
            .flat_map(|effect| effect.about().parameters());
        THESIS_MODEL
            .iter()
            .chain(REGULATING_VALVE_MODEL)
            .chain(effects)
            .collect()
    });

/// Returns the value of a field; `None` if its table is absent.
pub(super) fn field(plant: &PlantParameters, section: &str, key: &str) -> Option<f64> {
    if section == REGULATING_VALVE {
        regulating_valve_field(plant, section, key)
    } else {
        thesis_field(plant, section, key)
    }
}

/// Returns a field for changes; `None` if its table is absent.
pub(super) fn field_mut<'a>(
    plant: &'a mut PlantParameters,
    section: &str,
    key: &str,
) -> Option<&'a mut f64> {
    if section == REGULATING_VALVE {
        regulating_valve_field_mut(plant, section, key)
    } else {
        thesis_field_mut(plant, section, key)
    }
}

/// Returns the tables of a plant file, in their written form.
pub(super) fn sections() -> Vec<String> {
    let mut sections: Vec<String> = Vec::new();
    for spec in PARAMETERS.iter() {
        let section = match spec.effect_id() {
            Some(_) => format!("[{EFFECTS}.*]"),
            None => format!("[{}]", spec.section),
        };
        if !sections.contains(&section) {
            sections.push(section);
        }
    }
    sections.push(format!("[{VALVES}]"));
    sections.push(format!("[{OWN_EFFECTS}.*]"));
    sections
}
