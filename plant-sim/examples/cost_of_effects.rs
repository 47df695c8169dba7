//! Cost of each effect: solver steps per PWM period on one minute of mixed duty cycles, counted, not timed.

use plant_sim::effects::{EffectSetting, LIBRARY};
use plant_sim::{Command, PlantParameters, Simulator};

const SAMPLES: u64 = 6000;

/// Returns steps (including repeated ones), intervals passed by formula, and events per PWM period.
fn cost(plant: &PlantParameters) -> [f64; 3] {
    let mut simulator = Simulator::new(plant);
    for sample in 0..SAMPLES {
        // Each pair of duty cycles is constant for a fifth of a second; fill and vent alternate and overlap.
        let phase = sample / 20;
        let level = (phase * 37 % 100) as f64;
        let (duty_fill_pct, duty_vent_pct) = match phase % 5 {
            0 | 2 => (level, 0.0),
            1 => (0.0, 0.0),
            3 => (0.0, level),
            _ => (level, 60.0),
        };
        simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct,
        });
        simulator.advance_to_ns((sample + 1) * 10_000_000);
    }
    let statistics = simulator.statistics();
    [
        statistics.steps + statistics.rejected_steps,
        statistics.exact_intervals,
        statistics.events,
    ]
    .map(|count| count as f64 / SAMPLES as f64)
}

fn main() {
    let plain = PlantParameters::nominal();
    println!("| effect | variant | steps | formulas | events |\n|---|---|--:|--:|--:|");
    let row = |effect: &str, variant: &str, plant: &PlantParameters| {
        let [steps, formulas, events] = cost(plant);
        println!("| {effect} | {variant} | {steps:.1} | {formulas:.1} | {events:.1} |");
        steps
    };
    row("none", "-", &plain);
    let mut all = plain.clone();
    for effect in LIBRARY {
        let about = effect.about();
        for variant in about.variants {
            let setting = EffectSetting::typical_variant(effect, variant);
            let steps = row(about.id, variant.name, &plain.with_effect(setting));
            assert!(steps < 20.0, "{} is cheap at its typical size", about.id);
        }
        all = all.with_effect(EffectSetting::typical(effect));
    }
    let steps = row("all", "first of each", &all);
    assert!(steps < 30.0, "all effects together stay cheap");
}
