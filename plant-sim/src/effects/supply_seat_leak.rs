//! Effect: the fill valve does not close tightly.

use super::chamber_leak::leak;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.supply_seat_leak":
    AREA = area_m2 ["m2"] 1e-11 ..= 1e-5, Log 2e-8, off 0.0,
        "effective area of the orifice that leaks as much from full supply pressure to ambient (E41)";
}

static ABOUT: About = About {
    id: "supply_seat_leak",
    sentence: "Dirt or wear on the seat of the fill valve lets supply air into the chamber although the valve is shut.",
    source: "E41 from the supply to the chamber: ISO 6358-1, or Hagen and Poiseuille for a scratched seat",
    acts_on: EntryPoint::AirSupply,
    variants: &[
        Variant {
            name: "orifice",
            about: "a particle holds the seat open: an orifice beside the valve",
            parameters: &[&AREA],
        },
        Variant {
            name: "laminar",
            about: "a scratch: flow as the difference of the squared pressures",
            parameters: &[&AREA],
        },
    ],
    excited_by: "both valves shut for 5 s near ambient pressure and near supply pressure",
    confused_with: &["chamber_leak", "gas_temperature", "sensor_offset"],
};

/// The effect.
#[derive(Debug)]
pub struct SupplySeatLeak;

impl Effect for SupplySeatLeak {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        plant.additions.leaks[1] = Some(leak(setting, parameters, plant));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Simulator;

    /// Choked: mass flow Ψ A p_sup, independent of the chamber's pressure.
    #[test]
    fn a_leaking_seat_fills_the_chamber_at_a_constant_rate() {
        let parameters =
            PlantParameters::nominal().with_effect(EffectSetting::typical(&SupplySeatLeak));
        let mut simulator = Simulator::new(&parameters);
        simulator.advance_to_ns(2_000_000_000);
        let plant = parameters.plant();
        let flow = plant.nozzle.choked_factor() * 2e-8 * plant.supply_pressure;
        let expected = plant.ambient_pressure + 2.0 * plant.chamber.pressure_per_mass * flow;
        let found = simulator.state().pressure;
        assert!((found - expected).abs() < 1.0, "{found} {expected}");
    }
}
