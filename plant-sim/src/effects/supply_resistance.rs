//! Effect: battery and harness have a resistance.

use crate::additions::Polarisation;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.supply_resistance":
    RESISTANCE = resistance_ohm ["ohm"] 0.01 ..= 200.0, Log 3.0, off 0.0,
        "resistance between the supply voltage that is known and the coils (E50)";
    POLARISATION = polarisation_ohm ["ohm"] 0.01 ..= 200.0, Log 2.0, off 0.0,
        "further resistance of the battery under a lasting current (E50)";
    TIME = polarisation_time_s ["s"] 0.01 ..= 100.0, Log 0.3,
        "time constant of the battery's polarisation (E50)";
}

static ABOUT: About = About {
    id: "supply_resistance",
    sentence: "Long or corroded leads eat a part of the voltage: each coil gets less current, and less still while both are on.",
    source: "E50: Kirchhoff's voltage law with a common lead; a battery with one RC element",
    acts_on: EntryPoint::ElectricSupply,
    variants: &[
        Variant {
            name: "shared",
            about: "battery and a lead that both coils share; the freewheeling current does not pass it",
            parameters: &[&RESISTANCE],
        },
        Variant {
            name: "per_coil",
            about: "a lead of each coil's own, which the freewheeling current passes as well",
            parameters: &[&RESISTANCE],
        },
        Variant {
            name: "switch",
            about: "the switch of each coil in the ECU, which the freewheeling current does not pass",
            parameters: &[&RESISTANCE],
        },
        Variant {
            name: "polarisation",
            about: "a shared lead, and a battery whose voltage gives way further under a lasting current",
            parameters: &[&RESISTANCE, &POLARISATION, &TIME],
        },
    ],
    excited_by: "both valves at 100 % duty together, then each alone",
    confused_with: &["coil_ambient_temperature", "coil_heating"],
};

/// The effect.
#[derive(Debug)]
pub struct SupplyResistance;

impl Effect for SupplyResistance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        let resistance = setting.value("resistance_ohm");
        match setting.variant().name {
            "per_coil" => {
                for valve in &mut plant.valves {
                    valve.coil.resistance += resistance;
                }
            }
            "switch" => plant.additions.switch_resistance = resistance,
            _ => plant.additions.supply_resistance = resistance,
        }
        let polarisation = setting.get("polarisation_ohm").filter(|ohm| *ohm > 0.0);
        plant.additions.polarisation = polarisation.map(|resistance| Polarisation {
            resistance,
            time_constant: setting.value("polarisation_time_s"),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    /// Returns the fill valve's current (A) with a lead of 10 ohm, `milliseconds` after the beginning.
    fn current(variant: &str, duty_vent_pct: f64, milliseconds: u64) -> f64 {
        let variant = ABOUT.variant(variant).unwrap();
        let setting =
            EffectSetting::typical_variant(&SupplyResistance, variant).with("resistance_ohm", 10.0);
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct,
        });
        simulator.advance_to_ns(milliseconds * 1_000_000);
        simulator.sample().current[0]
    }

    /// e = (R + R_s) i for one coil; e = (R + 2 R_s) i for both, if the lead is shared.
    #[test]
    fn a_shared_lead_couples_the_coils_and_one_of_their_own_does_not() {
        for (variant, together, expected) in [
            ("shared", 0.0, 24.0 / 92.2),
            ("shared", 100.0, 24.0 / 102.2),
            ("per_coil", 0.0, 24.0 / 92.2),
            ("per_coil", 100.0, 24.0 / 92.2),
            ("switch", 0.0, 24.0 / 92.2),
            ("switch", 100.0, 24.0 / 92.2),
        ] {
            let current = current(variant, together, 500);
            assert!(
                (current - expected).abs() < 1e-5,
                "{variant}: {current} {expected}"
            );
        }
    }

    /// Polarisation of 2 ohm with 0.3 s: the current falls while U = R_p i (1 - exp(-t/T)) rises. T is that of the
    /// loop, 0.3 s (R + R_s)/(R + R_s + R_p), and in the end R_p acts as a part of the lead.
    #[test]
    fn a_battery_gives_way_under_a_lasting_current() {
        for coils in [1.0, 2.0] {
            let at = |milliseconds| current("polarisation", 100.0 * (coils - 1.0), milliseconds);
            let with = |polarised: f64| 24.0 / (82.2 + coils * (10.0 + polarised));
            assert!(
                (at(5000) - with(2.0)).abs() < 1e-5,
                "{} {}",
                at(5000),
                with(2.0)
            );
            let time = 0.3 * with(2.0) / with(0.0);
            let left = |milliseconds| (at(milliseconds) - with(2.0)) / (with(0.0) - with(2.0));
            let decay = (left(600) / left(300)).ln() / 0.3;
            assert!((decay * time + 1.0).abs() < 0.01, "{coils}: {decay} {time}");
        }
    }
}
