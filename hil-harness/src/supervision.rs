//! Supervision settings of an ECU for a kind of rig, from the parameters of its plant.

use controller::fixed::types::I16F16;
use controller::{Compensation, Field, Pulses, Settings};
use ecu::{EcuField, Supervision, VentValve};
use plant_sim::PlantParameters;
use plant_sim::experiment::ValveId;
use plant_sim::parameters::Part;
use plant_sim::plant::{FILL, VENT};
use plant_sim::valve::ValveFunction;

use crate::duty_limits::{DutyLimits, with_limits_of_valves};

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
    let of_coils = |bound: I16F16, by: fn(&PlantParameters) -> f64| match Part::Coil.is_in(plant) {
        true => scaled(bound, by),
        false => bound,
    };
    // No controller can be set to a higher value.
    let limit_bar = I16F16::lit("15");
    Supervision {
        supply_pressure_min_bar: scaled(known.supply_pressure_min_bar, supply_bar).min(limit_bar),
        supply_pressure_max_bar: scaled(known.supply_pressure_max_bar, supply_bar).min(limit_bar),
        fill_rate_per_s: scaled(known.fill_rate_per_s, |plant| {
            plant.open_valve_rate_per_s(FILL)
        }),
        vent_rate_per_s: scaled(known.vent_rate_per_s, |plant| {
            plant.open_valve_rate_per_s(VENT)
        }),
        open_duty_fill_pct: open_duty_pct(plant, ValveId::Fill, known.open_duty_fill_pct),
        open_duty_vent_pct: open_duty_pct(plant, ValveId::Vent, known.open_duty_vent_pct),
        valve_settling_ms: valve_settling_ms(plant, known.valve_settling_ms),
        battery_min_v: of_coils(known.battery_min_v, battery_v),
        battery_max_v: of_coils(known.battery_max_v, battery_v),
        coil_current_min_ma: of_coils(known.coil_current_min_ma, current),
        coil_current_max_ma: of_coils(known.coil_current_max_ma, current),
        ..known
    }
}

/// Returns the lowest duty cycle (%) at which a valve of `plant` is certainly open: `known` for one with a coil, whose limit
/// leaves 20 % to the duty cycle that opens it. Another valve gets the same margin.
fn open_duty_pct(plant: &PlantParameters, valve: ValveId, known: I16F16) -> I16F16 {
    const MARGIN_PCT: f64 = 20.0;
    if !plant.functions[valve.index()].has_conductance() {
        return known;
    }
    DutyLimits::found(plant, valve).map_or(known, |limits| {
        let [opens_pct, ..] = limits.opening_pct;
        I16F16::saturating_from_num((opens_pct + MARGIN_PCT).min(100.0))
    })
}

/// Longest settling time that an ECU follows (samples).
const SETTLING_SAMPLES_MAX: f64 = 32.0;

/// Returns the time (ms) after which the pressure has certainly followed a command to the valves of `plant`: `known` for
/// valves with coils; the switching times of other valves, a longer PWM period and the line to a second chamber come on
/// top. An ECU follows a limited time.
fn valve_settling_ms(plant: &PlantParameters, known: I16F16) -> I16F16 {
    let nominal = PlantParameters::nominal();
    let known_ms: f64 = known.to_num();
    let longer_period_ms =
        1e3 * (plant.ecu.pwm_frequency_hz.recip() - nominal.ecu.pwm_frequency_hz.recip());
    let switching_ms = [FILL, VENT].map(|valve| 1e3 * plant.longest_switching_s(valve));
    let [fill_ms, vent_ms] = switching_ms;
    let later_ms = longer_period_ms.max(0.0) + fill_ms.max(vent_ms) + 1e3 * plant.balance_s();
    let samples_ms = SETTLING_SAMPLES_MAX * 1e3 * plant.ecu.sample_time_s;
    let most_ms = samples_ms.min(EcuField::ValveSettling.range()[1].to_num());
    I16F16::saturating_from_num((known_ms + later_ms).min(most_ms).max(known_ms))
}

/// Shipped controllers.
pub(crate) const SHIPPED: [fn() -> Settings; 3] =
    [Settings::recommended, Settings::thesis, Settings::pulses];

/// Returns the controller with the nominal values of `plant`: voltage and resistance of its compensation, orifice, rates
/// and command delay of its pulses, duty limits of valves of another kind. Each stays if it is not the one of the shipped
/// controllers. The sample time becomes that of `plant` if the whole controller is a shipped one.
pub fn with_nominal_values(controller: Settings, plant: &PlantParameters) -> Settings {
    let shipped = Settings::pulses();
    let is_shipped = SHIPPED.map(|shipped| shipped()).contains(&controller);
    let controller = with_limits_of_valves(controller, plant);
    Settings {
        sample_time_ms: match is_shipped {
            true => I16F16::saturating_from_num(1e3 * plant.ecu.sample_time_s),
            false => controller.sample_time_ms,
        },
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
            plant.open_valve_rate_per_s(FILL)
        }),
        vent_rate_per_s: value(Field::PulseVentRate, pulses.vent_rate_per_s, &|plant| {
            plant.open_valve_rate_per_s(VENT)
        }),
        command_delay_ms: value(Field::PulseDelay, pulses.command_delay_ms, &|plant| {
            plant.ecu.command_delay_s
        }),
        ..pulses
    }
}

/// Duty cycle of a normally open valve around which its limits are shifted: it just opens (0.15 to 0.30 on the nominal
/// plant).
const RELEASE_DUTY: f64 = 0.2;

/// Returns the compensation with the nominal voltage and resistance of `plant`, and the shift that belongs to the time
/// constant of its coils (equation E75); `None` for a plant without coils, or beyond the range of these settings.
fn compensation(plant: &PlantParameters) -> Option<Compensation> {
    if !Part::Coil.is_in(plant) {
        return None;
    }
    let of_plant = |field: Field, value: f64| {
        let [min, max] = field.range();
        let value = I16F16::saturating_from_num(value);
        (min..=max).contains(&value).then_some(value)
    };
    let voltage = of_plant(Field::NominalVoltage, plant.ecu.supply_voltage_v);
    let resistance = of_plant(Field::NominalResistance, plant.coil.resistance_20c_ohm);
    let decay_periods =
        plant.coil.inductance_closed_h / plant.coil.resistance_20c_ohm * plant.ecu.pwm_frequency_hz;
    let shift = decay_periods * (1.0 - (-(1.0 - RELEASE_DUTY) / decay_periods).exp());
    let shift = of_plant(Field::ReleaseShift, (1e3 * shift).round() / 10.0);
    Some(Compensation {
        nominal_voltage_v: voltage?,
        nominal_resistance_ohm: resistance?,
        release_shift_pct: shift?,
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

#[cfg(test)]
mod tests {
    use controller::{Config, Duty, DutyScale};
    use ecu::{EcuConfig, EcuSettings};

    use super::*;
    use crate::scenario::{FIGURE_ORIFICE_M, with_normally_open_vent, with_orifices};

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
        let physical = PlantParameters::nominal().open_valve_rate_per_s(FILL);
        let nominal = Supervision::nominal().fill_rate_per_s.to_num::<f64>();
        assert!(
            (physical / nominal - 1.0).abs() < 0.01,
            "{physical} and {nominal} 1/s"
        );
    }

    /// Goal: the duty cycle that just opens a normally open vent valve follows voltage and temperature. Method: the
    /// experiment on the model at each of them. Without the shift, the values lie up to 15 % apart.
    #[test]
    fn a_normally_open_vent_valve_follows_voltage_and_temperature() {
        let plant = with_normally_open_vent(PlantParameters::nominal());
        let opens_pct = |plant: &PlantParameters| {
            DutyLimits::found(plant, ValveId::Vent).unwrap().opening_pct[0]
        };
        let settings = with_nominal_values(Settings::recommended(), &plant);
        let config = Config::new(&settings).unwrap();
        let compensation = config.compensation().unwrap();
        let nominal = Duty::from_percent(I16F16::from_num(opens_pct(&plant))).unwrap();
        for (volt, ohm) in [
            (18.0, 82.2),
            (28.0, 82.2),
            (32.0, 82.2),
            (24.0, 62.5),
            (24.0, 115.0),
        ] {
            let mut other = plant.clone();
            other.set("ecu.supply_voltage_v", volt, "test").unwrap();
            other.set("coil.resistance_20c_ohm", ohm, "test").unwrap();
            let scale =
                DutyScale::saturating_from_bits((24.0 / volt * ohm / 82.2 * 65_536.0) as u32);
            let followed = compensation.release_shift(scale).duty(nominal);
            let followed_pct: f64 = followed.percent().to_num();
            let error_pct = followed_pct - opens_pct(&other);
            assert!(error_pct.abs() < 4.0, "{volt} V, {ohm} ohm: {error_pct}");
        }
    }

    /// A faster coil, or a slower PWM, needs a smaller shift of its duty cycles.
    #[test]
    fn the_shift_of_a_normally_open_valve_is_that_of_its_coil() {
        let shift_pct = |henry: f64| {
            let mut plant = PlantParameters::nominal();
            plant
                .set("coil.inductance_closed_h", henry, "test")
                .unwrap();
            let settings = with_nominal_values(Settings::recommended(), &plant);
            settings
                .compensation
                .unwrap()
                .release_shift_pct
                .to_num::<f64>()
        };
        assert_eq!(
            Some(shift_pct(0.44)),
            Settings::recommended()
                .compensation
                .map(|one| one.release_shift_pct.to_num())
        );
        // 2 ms: 0.2 (1 - exp(-4)).
        assert!((shift_pct(0.1644) - 19.6).abs() < 0.06);
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
