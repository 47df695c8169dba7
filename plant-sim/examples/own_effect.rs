//! User-defined effect: the compressor makes the supply pressure swing.
//!
//! Describe it, install it, name it in a plant file. The code between the two rulers is the effect, less than thirty
//! lines.

use plant_sim::effects::{About, Effect, EffectSetting, EntryPoint, Variant};
use plant_sim::parameters::{NOMINAL_PLANT_TOML, ParameterSpec, Size};
use plant_sim::plant::Plant;
use plant_sim::{Command, PlantParameters, Simulator};

// ---------------------------------------------------------------------------------------------------------------
static SWING: ParameterSpec = ParameterSpec::of_effect(
    "effects.supply_pulsation",
    "swing_bar",
    "bar",
    (1e-3, 3.0),
    Size::strength(0.3),
    "half of the swing of the supply pressure",
);
static ABOUT: About = About {
    id: "supply_pulsation",
    sentence: "The compressor switches on and off, and the supply pressure swings with it.",
    source: "ours: a sine of 2.83 rad/s",
    acts_on: EntryPoint::AirSupply,
    variants: &[Variant::only(&[&SWING])],
    excited_by: "the fill valve open at high pressure for several seconds",
    confused_with: &["supply_line_droop"],
};
#[derive(Debug)]
struct SupplyPulsation;
impl Effect for SupplyPulsation {
    fn about(&self) -> &'static About {
        &ABOUT
    }
    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        let swing = setting.value("swing_bar") * 1e5;
        let hooks = &mut plant.additions.hooks;
        hooks.add_supply_pressure(move |now| swing * (2.83 * now.time).sin());
    }
}
// ---------------------------------------------------------------------------------------------------------------

fn main() -> Result<(), plant_sim::ParameterError> {
    let file = format!("{NOMINAL_PLANT_TOML}\n[effects.supply_pulsation]\nswing_bar = 0.3\n");
    let plant = PlantParameters::from_toml_with(&file, "rig.toml", &[&SupplyPulsation])?;

    let mut simulator = Simulator::new(&plant);
    simulator.command(Command {
        duty_fill_pct: 100.0,
        duty_vent_pct: 0.0,
    });
    let supply = plant.gas.supply_pressure_pa();
    let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
    for millisecond in (2_000..10_000_u64).step_by(10) {
        simulator.advance_to_ns(millisecond * 1_000_000);
        let off = simulator.sample().pressure - supply;
        (least, largest) = (least.min(off), largest.max(off));
    }
    println!(
        "the chamber follows the supply by {:+.3} to {:+.3} bar",
        least * 1e-5,
        largest * 1e-5
    );
    assert!((-0.3e5..-0.28e5).contains(&least), "{least}");
    assert!((0.28e5..0.3e5).contains(&largest), "{largest}");

    // With the effect switched off, the results equal those of the plain plant bit for bit.
    let mut off = plant.clone();
    off.set("effects.supply_pulsation.swing_bar", 0.0, "off")?;
    assert!(off.effects[0].is_off());
    Ok(())
}
