//! Supervision settings of an ECU for a kind of rig, from the parameters of its plant.

use controller::fixed::types::I16F16;
use controller::{Compensation, Field, Pulses, Settings};
use ecu::{Supervision, VentValve};
use plant_sim::PlantParameters;
use plant_sim::plant::VENT;
use plant_sim::valve::ValveFunction;

use crate::duty_limits::with_vent_limits;

/// Returns bounds within which the ECU accepts plants of this kind as healthy. Rates and currents are those of `plant`;
/// a rig with the usual scatter is still healthy.
///
/// Every margin keeps the same relative size as in the supervision of the nominal plant.
pub fn supervision(plant: &PlantParameters) -> Supervision {
    let nominal = PlantParameters::nominal();
    let known = Supervision::nominal();
    let scaled = |bound: I16F16, by: fn(&PlantParameters) -> f64| {
        I16F16::saturating_from_num(bound.to_num::<f64>() * by(plant) / by(&nominal))
    };
    let supply_bar = |plant: &PlantParameters| plant.gas.supply_pressure_bar_gauge;
    let battery_v = |plant: &PlantParameters| plant.ecu.supply_voltage_v;
    let current =
        |plant: &PlantParameters| plant.ecu.supply_voltage_v / plant.coil.resistance_20c_ohm;
    // No controller can be set to a higher value.
    let limit_bar = I16F16::lit("15");
    Supervision {
        supply_pressure_min_bar: scaled(known.supply_pressure_min_bar, supply_bar).min(limit_bar),
        supply_pressure_max_bar: scaled(known.supply_pressure_max_bar, supply_bar).min(limit_bar),
        fill_rate_per_s: scaled(known.fill_rate_per_s, |plant| {
            rate(plant, plant.flow.discharge_fill, plant.flow.orifice_fill_m)
        }),
        vent_rate_per_s: scaled(known.vent_rate_per_s, |plant| {
            rate(plant, plant.flow.discharge_vent, plant.flow.orifice_vent_m)
        }),
        battery_min_v: scaled(known.battery_min_v, battery_v),
        battery_max_v: scaled(known.battery_max_v, battery_v),
        coil_current_min_ma: scaled(known.coil_current_min_ma, current),
        coil_current_max_ma: scaled(known.coil_current_max_ma, current),
        ..known
    }
}

/// Returns the controller with the nominal values of `plant`: voltage and resistance of its compensation, orifice, rates
/// and command delay of its pulses, duty limits of a normally open vent valve. Each stays if it is not the one of the
/// shipped controllers.
pub fn with_nominal_values(controller: Settings, plant: &PlantParameters) -> Settings {
    let shipped = Settings::pulses();
    let controller = with_vent_limits(controller, plant);
    Settings {
        compensation: if controller.compensation == shipped.compensation {
            compensation(plant)
        } else {
            controller.compensation
        },
        pulses: match shipped.pulses {
            Some(pulses) if controller.pulses == shipped.pulses => Some(pulses_on(pulses, plant)),
            _ => controller.pulses,
        },
        ..controller
    }
}

/// Returns the pulses of the nominal plant with the orifice, the rates and the command delay of `plant`. A value beyond
/// the range of its setting is the end of the range.
fn pulses_on(pulses: Pulses, plant: &PlantParameters) -> Pulses {
    let nominal = PlantParameters::nominal();
    let value = |field: Field, shipped: I16F16, by: &dyn Fn(&PlantParameters) -> f64| {
        let [min, max] = field.range();
        let ratio = by(plant) / by(&nominal);
        if ratio == 1.0 {
            return shipped;
        }
        I16F16::saturating_from_num(shipped.to_num::<f64>() * ratio).clamp(min, max)
    };
    Pulses {
        orifice_mm: value(Field::PulseOrifice, pulses.orifice_mm, &|plant| {
            plant.flow.orifice_fill_m
        }),
        fill_rate_per_s: value(Field::PulseFillRate, pulses.fill_rate_per_s, &|plant| {
            rate(plant, plant.flow.discharge_fill, plant.flow.orifice_fill_m)
        }),
        vent_rate_per_s: value(Field::PulseVentRate, pulses.vent_rate_per_s, &|plant| {
            rate(plant, plant.flow.discharge_vent, plant.flow.orifice_vent_m)
        }),
        command_delay_ms: value(Field::PulseDelay, pulses.command_delay_ms, &|plant| {
            plant.ecu.command_delay_s
        }),
        ..pulses
    }
}

/// Returns the compensation with the nominal voltage and resistance of `plant`; `None` for a plant beyond the range of
/// these settings.
fn compensation(plant: &PlantParameters) -> Option<Compensation> {
    let of_plant = |field: Field, value: f64| {
        let [min, max] = field.range();
        let value = I16F16::saturating_from_num(value);
        (min..=max).contains(&value).then_some(value)
    };
    let voltage = of_plant(Field::NominalVoltage, plant.ecu.supply_voltage_v);
    let resistance = of_plant(Field::NominalResistance, plant.coil.resistance_20c_ohm);
    voltage
        .zip(resistance)
        .map(|(nominal_voltage_v, nominal_resistance_ohm)| Compensation {
            nominal_voltage_v,
            nominal_resistance_ohm,
        })
}

/// Returns the position of the vent valve of `plant` without current.
pub fn vent_valve(plant: &PlantParameters) -> VentValve {
    match plant.functions[VENT] {
        ValveFunction::NormallyOpen | ValveFunction::AlwaysOpen => VentValve::NormallyOpen,
        ValveFunction::NormallyClosed
        | ValveFunction::OnOff
        | ValveFunction::Proportional
        | ValveFunction::Blocked
        | ValveFunction::Absent => VentValve::NormallyClosed,
    }
}

/// Returns the rate of an open valve up to a factor common to all plants: choked flow into the chamber's volume.
pub(crate) fn rate(plant: &PlantParameters, discharge: f64, orifice_m: f64) -> f64 {
    let gas = &plant.gas;
    let sound_m_per_s = (gas.gas_constant_j_per_kg_k * gas.temperature_k).sqrt();
    discharge * orifice_m * orifice_m * sound_m_per_s / plant.chamber.volume_m3
}

#[cfg(test)]
mod tests {
    use ecu::{EcuConfig, EcuSettings};

    use super::*;
    use crate::scenario::{FIGURE_ORIFICE_M, with_orifices};

    #[test]
    fn the_nominal_plant_has_the_nominal_supervision_and_a_smaller_orifice_slower_valves() {
        let nominal = Supervision::nominal();
        assert_eq!(supervision(&PlantParameters::nominal()), nominal);
        let small = supervision(&with_orifices(PlantParameters::nominal(), FIGURE_ORIFICE_M));
        let ratio = small.fill_rate_per_s.to_num::<f64>() / nominal.fill_rate_per_s.to_num::<f64>();
        assert!((ratio - (1.3_f64 / 1.9).powi(2)).abs() < 1e-4, "{ratio}");
        assert_eq!(small.battery_min_v, nominal.battery_min_v);
    }

    /// The rates of the nominal supervision are those of choked flow through the nominal orifices.
    #[test]
    fn the_nominal_rates_are_those_of_the_physics() {
        let plant = PlantParameters::nominal();
        let choked = 0.6847; // √γ (2/(γ+1))^((γ+1)/(2(γ-1))) for γ = 1.4
        let physical = rate(&plant, plant.flow.discharge_fill, plant.flow.orifice_fill_m)
            * choked
            * core::f64::consts::FRAC_PI_4;
        let nominal = Supervision::nominal().fill_rate_per_s.to_num::<f64>();
        assert!(
            (physical / nominal - 1.0).abs() < 0.01,
            "{physical} and {nominal} 1/s"
        );
    }

    #[test]
    fn every_bound_of_a_strong_supply_is_still_one_that_an_ecu_takes() {
        let mut plant = PlantParameters::nominal();
        plant
            .set("gas.supply_pressure_bar_gauge", 15.0, "test")
            .unwrap();
        plant.set("ecu.supply_voltage_v", 12.0, "test").unwrap();
        let settings = EcuSettings {
            supervision: supervision(&plant),
            ..EcuSettings::bench()
        };
        EcuConfig::new(&settings).unwrap();
    }
}
