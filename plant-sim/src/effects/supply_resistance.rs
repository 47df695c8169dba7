//! Battery and harness have a resistance.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.supply_resistance":
    RESISTANCE = resistance_ohm ["ohm"] 0.01 ..= 200.0, Log 3.0, off 0.0,
        "resistance between the supply voltage that is known and the coils (E50)";
}

static ABOUT: About = About {
    id: "supply_resistance",
    sentence: "Long or corroded leads eat a part of the voltage: each coil gets less current, and less still while both are on.",
    source: "E50: Kirchhoff's voltage law with a common lead",
    acts_on: EntryPoint::ElectricSupply,
    variants: &[
        Variant {
            name: "shared",
            about: "battery and a lead that both coils share; the free-wheeling current does not pass it",
            parameters: &[&RESISTANCE],
        },
        Variant {
            name: "per_coil",
            about: "a lead of each coil's own, which the free-wheeling current passes as well",
            parameters: &[&RESISTANCE],
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
        if setting.variant().name == "per_coil" {
            for valve in &mut plant.valves {
                valve.coil.resistance += resistance;
            }
        } else {
            plant.additions.supply_resistance = resistance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    fn steady(variant: &str, duty_vent_pct: f64) -> f64 {
        let variant = ABOUT.variant(variant).unwrap();
        let setting =
            EffectSetting::typical_variant(&SupplyResistance, variant).with("resistance_ohm", 10.0);
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct,
        });
        simulator.advance_to_ns(500_000_000);
        simulator.sample().current[0]
    }

    /// e = (R + R_s) i alone; e = (R + 2 R_s) i together, where the lead is shared.
    #[test]
    fn a_shared_lead_couples_the_coils_and_one_of_their_own_does_not() {
        for (variant, together, expected) in [
            ("shared", 0.0, 24.0 / 92.2),
            ("shared", 100.0, 24.0 / 102.2),
            ("per_coil", 0.0, 24.0 / 92.2),
            ("per_coil", 100.0, 24.0 / 92.2),
        ] {
            let current = steady(variant, together);
            assert!(
                (current - expected).abs() < 1e-5,
                "{variant}: {current} {expected}"
            );
        }
    }
}
