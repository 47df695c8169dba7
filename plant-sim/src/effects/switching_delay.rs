//! Effect: the opening delay of an on/off valve depends on the pressure difference across it.

use crate::additions::OpeningDelay;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.switching_delay":
    SHARE = pressure_share [""] -2.0 ..= 0.9, Linear 0.2, off 0.0,
        "increase of the opening delay from no pressure difference to that of the supply, over its value there (E70)";
}

static ABOUT: About = About {
    id: "switching_delay",
    sentence: "The opening delay of an on/off valve depends on the pressure difference across it, so the same pulse passes more or less air.",
    source: "E70: balance of forces on an armature whose coil charges up (E3, E8)",
    acts_on: EntryPoint::Switching,
    variants: &[Variant::only(&[&SHARE])],
    excited_by: "short pulses at low and at high pressure",
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
        let pressure_share = setting.value("pressure_share");
        let acts = pressure_share != 0.0 && nominal_drop > 0.0;
        plant.additions.opening_delay = acts.then_some(OpeningDelay {
            pressure_share,
            nominal_drop,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::valve::ValveFunction;
    use crate::{Command, Simulator};

    /// Returns the time (ns) at which the valve begins to open, with a chamber at `pressure` (Pa abs). Its delay is 8 ms.
    fn opens_ns(setting: EffectSetting, valve: usize, pressure: f64) -> u64 {
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

    /// E70, the fill valve against the whole supply pressure and against none, the vent valve the other way round.
    #[test]
    fn a_pressure_difference_delays_the_opening() {
        let gas = PlantParameters::nominal().gas;
        let [supply, ambient] = [gas.supply_pressure_pa(), gas.ambient_pressure_pa];
        let setting = EffectSetting::typical(&SwitchingDelay).with("pressure_share", 0.25);
        for (valve, pressure, expected_ns) in [
            (0, ambient, 8_000_000),
            (0, supply, 6_000_000),
            (1, ambient, 6_000_000),
            (1, 0.5 * (ambient + supply), 7_000_000),
            (1, supply, 8_000_000),
        ] {
            let found = opens_ns(setting.clone(), valve, pressure);
            assert!(found.abs_diff(expected_ns) <= 2_000, "{valve}: {found}");
        }
    }

    /// An armature that moves at the share s of the final current, half of whose force is the pressure's: the line through both ends is
    /// never further from it than 4 % of the delay.
    #[test]
    fn the_line_is_near_the_delay_of_a_coil_that_charges_up() {
        for share in [0.3, 0.6, 0.8] {
            let delay = |drop: f64| -(1.0 - share * f64::sqrt(0.5 + 0.5 * drop)).ln();
            let law = OpeningDelay {
                pressure_share: 1.0 - delay(0.0) / delay(1.0),
                nominal_drop: 1.0,
            };
            for drop in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let [found, expected] = [law.factor(drop), delay(drop) / delay(1.0)];
                assert!(
                    (found - expected).abs() < 0.04,
                    "{share} {drop}: {found} {expected}"
                );
            }
        }
    }
}
