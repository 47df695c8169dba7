//! Example of an effect that is not in the library, made from the missing flow.
//!
//! The relief valve of a rig weeps above 3 bar; no leak of the library has this law. The diagnosis finds the missing flow and makes a table
//! of it. The table becomes an effect, and the error falls.

use std::sync::OnceLock;

use model_lab::diagnosis::{MissingFlow, remaining};
use model_lab::{CompareOptions, compare};
use plant_sim::effects::{About, Effect, EffectSetting, EntryPoint, Variant};
use plant_sim::parameters::{ParameterSpec, Size};
use plant_sim::plant::Plant;
use plant_sim::replay::replay;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

// ---------------------------------------------------------------------------------------------------------------
/// Table from the log.
static TABLE: OnceLock<MissingFlow> = OnceLock::new();
static SHARE: ParameterSpec = ParameterSpec::of_effect(
    "effects.missing_flow",
    "share",
    "",
    (1e-3, 10.0),
    Size::strength(1.0),
    "how much of the table flows",
);
static ABOUT: About = About {
    id: "missing_flow",
    sentence: "Air comes and goes as the log has shown it.",
    source: "reconstructed from a log",
    acts_on: EntryPoint::Leak,
    variants: &[Variant::only(&[&SHARE])],
    excited_by: "holds at the pressures of the table",
    confused_with: &["chamber_leak"],
};
#[derive(Debug)]
struct Reconstructed;
impl Effect for Reconstructed {
    fn about(&self) -> &'static About {
        &ABOUT
    }
    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        let share = setting.value("share");
        let hooks = &mut plant.additions.hooks;
        hooks
            .add_inflow(move |now| share * TABLE.get().map_or(0.0, |table| table.at(now.pressure)));
    }
}
// ---------------------------------------------------------------------------------------------------------------

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plant = PlantParameters::nominal();
    let log = rig_that_weeps(&plant)?;

    let remaining = remaining(&plant, std::slice::from_ref(&log))?;
    let curve = remaining.missing_flow.first().ok_or("nothing is missing")?;
    println!("{}", remaining.sentences[0]);
    let table = MissingFlow::new(curve, &plant).ok_or("not a curve against pressure")?;
    for (pressure_pa, kg_per_s) in table.knots() {
        println!(
            "{:8.2} bar abs {:+9.2} mg/s",
            pressure_pa * 1e-5,
            kg_per_s * 1e6
        );
    }
    TABLE.set(table).expect("set once");

    let free_run_bar = |plant: &PlantParameters| -> Result<f64, Box<dyn std::error::Error>> {
        let comparison = compare(plant, &log, &CompareOptions::default())?;
        Ok(comparison.signals[0].free_run.rms)
    };
    let before = free_run_bar(&plant)?;
    let after = free_run_bar(&plant.with_effect(EffectSetting::typical(&Reconstructed)))?;
    println!(
        "rms error driven by the commands alone: {before:.3} bar, with the table {after:.3} bar"
    );
    assert!(after < 0.3 * before, "{before} {after}");
    Ok(())
}

/// Returns a log of the plant with a relief valve that weeps above 3 bar gauge; the sensor's resolution is 5 mbar.
fn rig_that_weeps(plant: &PlantParameters) -> Result<Recording, Box<dyn std::error::Error>> {
    const INTERVAL_S: f64 = 0.01;
    let mut duties = [Vec::new(), Vec::new()];
    for (seconds, fill, vent) in (0..24).flat_map(|n| {
        let fills = 0.05 + 0.01 * f64::from(n % 12);
        [
            (fills, 80.0, 0.0),
            (1.5, 0.0, 0.0),
            (0.1, 0.0, 60.0),
            (1.0, 0.0, 0.0),
            (0.5, 0.0, 100.0),
        ]
    }) {
        let count = (seconds / INTERVAL_S) as usize;
        duties[0].extend(std::iter::repeat_n(fill, count));
        duties[1].extend(std::iter::repeat_n(vent, count));
    }
    let mut log = Recording::new(Provenance::from_source("rig"));
    let base = log.add_time_base(TimeBase::uniform(0.0, INTERVAL_S, duties[0].len())?);
    for (name, duty) in ["duty_fill", "duty_vent"].into_iter().zip(duties) {
        log.add_signal(name, Unit::Percent, base, duty)?;
    }
    let ambient_pa = plant.gas.ambient_pressure_pa;
    let mut measured_bar = Vec::new();
    replay(plant, &log, Tolerance::default(), |_, simulator| {
        let pressure = simulator.state().pressure;
        let above_bar = (pressure - ambient_pa) * 1e-5 - 3.0;
        let weeps_bar_per_s = 0.12 * above_bar.max(0.0).sqrt();
        simulator.set_chamber_pressure(pressure - weeps_bar_per_s * INTERVAL_S * 1e5);
        measured_bar.push((200.0 * (pressure - ambient_pa) * 1e-5).round() / 200.0);
    })?;
    log.add_signal("p_ch", Unit::BarGauge, base, measured_bar)?;
    Ok(log)
}
