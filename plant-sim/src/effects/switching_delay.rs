//! Effect: an on/off valve opens the later, the less voltage it has and the more pressure it works against.

use crate::additions::OpeningDelay;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.switching_delay":
    EXPONENT = voltage_exponent [""] 0.01 ..= 8.0, Log 1.5, off 0.0,
        "decrease of the opening delay in percent for each percent of voltage (E70)";
    SHARE = pressure_share [""] -2.0 ..= 0.9, Linear 0.2, off 0.0,
        "increase of the opening delay from no pressure difference to that of the supply, over its value there (E70)";
}

static ABOUT: About = About {
    id: "switching_delay",
    sentence: "An on/off valve opens later where the voltage is low or the pressure holds its seat, so the same pulse lets through more or less air.",
    source: "E70: charging of a coil up to the current that moves the armature (E4)",
    acts_on: EntryPoint::Armature,
    variants: &[
        Variant {
            name: "pressure",
            about: "by the pressure difference at the valve",
            parameters: &[&SHARE],
        },
        Variant {
            name: "voltage",
            about: "by the supply voltage",
            parameters: &[&EXPONENT],
        },
        Variant {
            name: "both",
            about: "by the pressure difference and the voltage",
            parameters: &[&SHARE, &EXPONENT],
        },
    ],
    excited_by: "short pulses at low and at high pressure, and at several supply voltages",
    confused_with: &["series_restriction", "critical_ratio", "supply_line_droop"],
};

/// The effect.
#[derive(Debug)]
pub struct SwitchingDelay;

impl Effect for SwitchingDelay {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let gas = &parameters.gas;
        let nominal_drop = gas.supply_pressure_pa() - gas.ambient_pressure_pa;
        let delay = OpeningDelay {
            voltage_exponent: setting.get("voltage_exponent").unwrap_or(0.0),
            pressure_share: setting.get("pressure_share").unwrap_or(0.0),
            nominal_voltage: parameters.ecu.supply_voltage_v,
            nominal_drop,
        };
        let is_off = delay.voltage_exponent == 0.0 && delay.pressure_share == 0.0;
        let has_drop = nominal_drop > 0.0;
        plant.additions.opening_delay = (!is_off && has_drop).then_some(delay);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::valve::ValveFunction;
    use crate::{Command, Simulator};

    /// Returns the time (ns) at which the valve begins to open, with a chamber at `pressure` (Pa abs) and a voltage (V). Its delay is 8 ms.
    fn opens_ns(setting: EffectSetting, valve: usize, pressure: f64, volt: f64) -> u64 {
        let mut plant = PlantParameters::nominal();
        plant.functions = [ValveFunction::OnOff; 2];
        plant.ecu.command_delay_s = 0.0;
        for valve in [&mut plant.on_off_fill, &mut plant.on_off_vent] {
            (valve.conductance_dm3_per_s_bar, valve.critical_ratio) = (0.1, 0.3);
            (valve.opening_delay_s, valve.closing_delay_s) = (8e-3, 6e-3);
            (valve.opening_ramp_s, valve.closing_ramp_s) = (4e-3, 2e-3);
        }
        let mut simulator = Simulator::new(&plant.with_effect(setting));
        simulator.set_chamber_pressure(pressure);
        simulator.set_supply_voltage(volt);
        let mut duties = [0.0; 2];
        duties[valve] = 100.0;
        simulator.command(Command {
            duty_fill_pct: duties[0],
            duty_vent_pct: duties[1],
        });
        let mut instants_ns = (0..20_000_000).step_by(1_000);
        let opens = |&now_ns: &u64| {
            simulator.advance_to_ns(now_ns);
            simulator.state().valves[valve].x > 0.0
        };
        instants_ns.find(opens).unwrap()
    }

    fn setting(variant: &str) -> EffectSetting {
        EffectSetting::typical_variant(&SwitchingDelay, ABOUT.variant(variant).unwrap())
    }

    /// E70, the fill valve against the whole supply pressure and against none, the vent valve the other way round.
    #[test]
    fn a_pressure_difference_delays_the_opening() {
        let gas = PlantParameters::nominal().gas;
        let [supply, ambient] = [gas.supply_pressure_pa(), gas.ambient_pressure_pa];
        let setting = setting("pressure").with("pressure_share", 0.25);
        for (valve, pressure, expected_ns) in [
            (0, ambient, 8_000_000),
            (0, supply, 6_000_000),
            (1, ambient, 6_000_000),
            (1, 0.5 * (ambient + supply), 7_000_000),
            (1, supply, 8_000_000),
        ] {
            let found = opens_ns(setting.clone(), valve, pressure, 24.0);
            assert!(found.abs_diff(expected_ns) <= 2_000, "{valve}: {found}");
        }
    }

    #[test]
    fn a_lower_voltage_delays_the_opening() {
        let ambient = PlantParameters::nominal().gas.ambient_pressure_pa;
        let setting = setting("voltage").with("voltage_exponent", 2.0);
        for (volt, expected_ns) in [(24.0, 8_000_000), (20.0, 11_520_000), (30.0, 5_120_000)] {
            let found = opens_ns(setting.clone(), 0, ambient, volt);
            assert!(found.abs_diff(expected_ns) <= 2_000, "{volt}: {found}");
        }
    }

    /// The exponent of a coil that is charged up to the share s of its final current is s/((1 - s) ln(1/(1 - s))).
    #[test]
    fn the_exponent_is_that_of_a_coil_that_is_charged() {
        let delay = |volt: f64| -(1.0 - 0.5 * 24.0 / volt).ln();
        let exponent = 0.5 / (0.5 * 2_f64.ln());
        let law = OpeningDelay {
            voltage_exponent: exponent,
            pressure_share: 0.0,
            nominal_voltage: 24.0,
            nominal_drop: 1e5,
        };
        for volt in [23.0, 25.0] {
            let [found, expected] = [law.factor(volt, 1e5), delay(volt) / delay(24.0)];
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
    }
}
