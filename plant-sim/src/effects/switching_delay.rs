//! Effect: the opening delay of an on/off valve depends on the pressure difference across it and on the supply voltage.

use crate::additions::OpeningDelay;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.switching_delay":
    SHARE = pressure_share [""] -2.0 ..= 0.9, Linear 0.2, off 0.0,
        "increase of the opening delay from no pressure difference to that of the supply, over its value there (E73)";
    EXPONENT = voltage_exponent [""] 0.01 ..= 8.0, Log 1.5, off 0.0, driven_by "u_bat",
        "exponent by which the opening delay grows as the supply voltage falls (E73)";
}

static ABOUT: About = About {
    id: "switching_delay",
    sentence: "The opening delay of an on/off valve depends on the pressure difference across it or on the supply voltage, so the same pulse passes more or less air.",
    source: "E73: balance of forces on an armature whose coil charges up (E3, E8)",
    acts_on: EntryPoint::Switching,
    variants: &[
        Variant {
            name: "pressure",
            about: "by the pressure difference",
            parameters: &[&SHARE],
        },
        Variant {
            name: "voltage",
            about: "by the supply voltage",
            parameters: &[&EXPONENT],
        },
        Variant {
            name: "both",
            about: "by the pressure difference and the supply voltage",
            parameters: &[&SHARE, &EXPONENT],
        },
    ],
    excited_by: "short pulses at low and at high pressure, and at several logged supply voltages",
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
            pressure_share: setting.get("pressure_share").unwrap_or(0.0),
            voltage_exponent: setting.get("voltage_exponent").unwrap_or(0.0),
            nominal_drop,
            nominal_voltage: parameters.ecu.supply_voltage_v,
        };
        let acts = delay.pressure_share != 0.0 || delay.voltage_exponent != 0.0;
        plant.additions.opening_delay = (acts && nominal_drop > 0.0).then_some(delay);
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

    /// E73, the fill valve against the whole supply pressure and against none, the vent valve the other way round.
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
            let found = opens_ns(setting.clone(), valve, pressure, 20.0);
            assert!(found.abs_diff(expected_ns) <= 2_000, "{valve}: {found}");
        }
    }

    /// E73: 8 ms times the square of 24 V over the voltage, and with half the pressure difference three quarters of that.
    #[test]
    fn a_low_voltage_delays_the_opening() {
        let gas = PlantParameters::nominal().gas;
        let [supply, ambient] = [gas.supply_pressure_pa(), gas.ambient_pressure_pa];
        let voltage = setting("voltage").with("voltage_exponent", 2.0);
        let both = setting("both")
            .with("voltage_exponent", 2.0)
            .with("pressure_share", 0.5);
        for (setting, pressure, volt, expected_ns) in [
            (&voltage, ambient, 24.0, 8_000_000),
            (&voltage, ambient, 20.0, 11_520_000),
            (&voltage, supply, 30.0, 5_120_000),
            (&both, 0.5 * (ambient + supply), 30.0, 3_840_000),
        ] {
            let found = opens_ns(setting.clone(), 0, pressure, volt);
            assert!(found.abs_diff(expected_ns) <= 2_000, "{volt}: {found}");
        }
    }

    /// Returns the law with the delays of a coil, divided by its delay at a drop of 1 and a voltage of 1.
    fn law(pressure_share: f64, voltage_exponent: f64) -> OpeningDelay {
        OpeningDelay {
            pressure_share,
            voltage_exponent,
            nominal_drop: 1.0,
            nominal_voltage: 1.0,
        }
    }

    /// An armature that moves at the share s of the final current, half of whose force is the pressure's: the line through both ends is
    /// never further from it than 4 % of the delay.
    #[test]
    fn the_line_is_near_the_delay_of_a_coil_that_charges_up() {
        for share in [0.3, 0.6, 0.8] {
            let delay = |drop: f64| -(1.0 - share * f64::sqrt(0.5 + 0.5 * drop)).ln();
            let law = law(1.0 - delay(0.0) / delay(1.0), 0.0);
            for drop in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let [found, expected] = [law.factor(drop, 1.0), delay(drop) / delay(1.0)];
                assert!(
                    (found - expected).abs() < 0.04,
                    "{share} {drop}: {found} {expected}"
                );
            }
        }
    }

    /// Such an armature at 18 to 32 V of nominal 24 V, and the power through the delays at 20 and at 28 V.
    #[test]
    fn the_power_is_near_the_delay_of_a_coil_at_another_voltage() {
        for (share, bound) in [(0.3, 0.02), (0.5, 0.04), (0.6, 0.08)] {
            let delay = |volt: f64| -(1.0 - share * 24.0 / volt).ln();
            let exponent = (delay(20.0) / delay(28.0)).ln() / (28.0_f64 / 20.0).ln();
            let law = law(0.0, exponent);
            for volt in [18.0, 20.0, 24.0, 28.0, 32.0] {
                let [found, expected] = [law.factor(1.0, volt / 24.0), delay(volt) / delay(24.0)];
                assert!(
                    (found / expected - 1.0).abs() < bound,
                    "{share} {volt}: {found} {expected}"
                );
            }
        }
    }
}
