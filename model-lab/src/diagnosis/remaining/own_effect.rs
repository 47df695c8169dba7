//! Missing flow as a user's own effect: a table of a plant file.

use plant_sim::PlantParameters;

use super::flow_table::MissingFlow;
use crate::diagnosis::result::Diagnosis;

/// Name of the effect; a number follows where the plant has it already.
const NAME: &str = "missing_flow";
/// Factor by which the flow of a fit may differ from that of the curve.
const RANGE: f64 = 20.0;

/// Plant with the missing flow as an effect that it may have.
#[derive(Debug, Clone, PartialEq)]
pub struct WithMissingFlow {
    /// Plant as given, with the definition of the effect.
    pub plant: PlantParameters,
    /// Id of the effect, such as `own.missing_flow`.
    pub effect: String,
}

impl WithMissingFlow {
    /// Adds the missing flow of `diagnosis` to the `plant` that was diagnosed; none where no flow that depends on the chamber pressure
    /// remains.
    pub fn of(diagnosis: &Diagnosis, plant: &PlantParameters) -> Option<Self> {
        let curves = diagnosis.remaining.missing_flow.iter();
        let table = curves.filter_map(|curve| MissingFlow::new(curve, plant));
        let table = table.into_iter().next()?;
        let is_free = |name: &String| plant.candidate(&format!("own.{name}")).is_none();
        let numbered = (2..).map(|number| format!("{NAME}_{number}"));
        let name = core::iter::once(NAME.to_owned())
            .chain(numbered)
            .find(is_free)?;
        let definition = definition(&table, &name, &diagnosis.logs.join(", "), plant)?;
        let text = plant.to_toml() + &definition;
        Some(Self {
            plant: PlantParameters::from_toml(&text, "the plant with its missing flow").ok()?,
            effect: format!("own.{name}"),
        })
    }
}

/// Returns the table of a plant file that defines the effect; none for a flow of zero. The law is linear between the knots, and constant
/// beyond them.
fn definition(
    table: &MissingFlow,
    name: &str,
    logs: &str,
    plant: &PlantParameters,
) -> Option<String> {
    let ambient_pa = plant.gas.ambient_pressure_pa;
    let largest = table
        .knots()
        .iter()
        .map(|(_, flow)| flow.abs())
        .fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    // A leak takes what the table brings.
    let knots: Vec<(f64, f64)> = table
        .knots()
        .iter()
        .map(|(pressure_pa, flow)| (pressure_pa / ambient_pa, -flow / largest))
        .collect();
    let sections: String = knots
        .windows(2)
        .map(|two| {
            let [(begin, from), (end, to)] = [two[0], two[1]];
            (begin, end, (to - from) / (end - begin))
        })
        .filter(|(.., slope)| *slope != 0.0)
        .map(|(begin, end, slope)| {
            format!(" + {slope:.5} * (min(max(p / p_ambient, {begin:.5}), {end:.5}) - {begin:.5})")
        })
        .collect();
    let (first, source) = (knots[0].1, logs.replace(['"', '\\'], "'"));
    Some(format!(
        "\n[own_effects.{name}]\n\
         sentence = \"Air that no effect of the library explains leaves or enters the chamber, by its pressure.\"\n\
         acts_on = \"leak_flow\"\n\
         expression = \"k * ({first:.5}{sections})\"\n\
         excited_by = \"holds at several pressures\"\n\
         source = \"missing flow of {source}\"\n\
         parameters.k = {{ typical = {largest:e}, range = [{:e}, {:e}], unit = \"kg/s\", about = \"largest flow\" }}\n",
        largest / RANGE,
        largest * RANGE,
    ))
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::EffectSetting;
    use plant_sim::{Simulator, Tolerance};

    use super::*;
    use crate::bench::Bench;
    use crate::diagnosis::diagnose_with;

    /// The bench's leak takes 4 % of the gauge pressure per second. Without a library, its flow remains, and as an effect of the user it
    /// empties the chamber as fast.
    #[test]
    fn a_missing_flow_is_an_effect_that_takes_as_much_air() {
        let rig = Bench {
            leak_per_s: 0.04,
            ..Bench::default()
        };
        let watch = |_| core::ops::ControlFlow::Continue(());
        let diagnosis = diagnose_with(&[], &rig.plant, &[rig.measure()], &[], &watch).unwrap();
        let with = WithMissingFlow::of(&diagnosis, &rig.plant).unwrap();
        assert_eq!(with.effect, "own.missing_flow");
        let effect = with.plant.candidate(&with.effect).unwrap();
        let leaky = with.plant.with_effect(EffectSetting::typical(effect));
        let mut simulator = Simulator::with_tolerance(&leaky, Tolerance::default());
        let ambient_pa = leaky.gas.ambient_pressure_pa;
        simulator.set_chamber_pressure(ambient_pa + 6e5);
        simulator.advance_to_ns(10_000_000_000);
        let left = (simulator.state().pressure - ambient_pa) / 6e5;
        assert!((left / f64::exp(-0.4) - 1.0).abs() < 0.05, "{left}");
        // A second one gets a name of its own.
        let again = WithMissingFlow::of(&diagnosis, &with.plant).unwrap();
        assert_eq!(again.effect, "own.missing_flow_2");
    }

    #[test]
    fn where_nothing_is_missing_there_is_no_effect() {
        let rig = Bench::default();
        let watch = |_| core::ops::ControlFlow::Continue(());
        let diagnosis = diagnose_with(&[], &rig.plant, &[rig.measure()], &[], &watch).unwrap();
        assert_eq!(WithMissingFlow::of(&diagnosis, &rig.plant), None);
    }
}
