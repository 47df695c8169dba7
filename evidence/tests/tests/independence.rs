//! Independence of the blind benchmark: the reference plant is the thesis' model, and differs from the simulator.

use std::fs;

use retarder_tests::bench_log::{self, repository};
use retarder_tests::plain_fit::misfit;
use retarder_tests::reference_plant::{Rig, Scatter, replay};

/// Returns twelve seconds of a bench log's commands.
fn commands() -> Vec<[f64; 2]> {
    let inputs = bench_log::commands("practice-00-check");
    let commands = inputs.iter().filter_map(|input| input.command);
    commands
        .map(|command| [command.duty_fill_pct, command.duty_vent_pct])
        .take(1200)
        .collect()
}

/// A rig without effects and without noise: error of the simulator's plain model after a fit of its uncertain
/// parameters. An error of zero would mean that both plants are the same program. An error of half the noise would mean
/// that the equations of a plain rig differ too much.
#[test]
fn a_plain_rig_is_the_thesis_model_to_a_third_of_the_noise_and_no_better() {
    let scatter = Scatter([0.5, -0.3, 0.8, -0.6, 0.2, -0.9, 0.4, 0.1, -0.5, 0.7]);
    for rig in [Rig::nominal(), Rig::nominal().scattered(&scatter)] {
        let commands = commands();
        let left = misfit(&commands, &replay(&rig, &commands));
        println!("in units of the noise (pressure, fill current, vent current): {left:.3?}");
        let [pressure, currents @ ..] = left.fitted;
        assert!((0.02..0.5).contains(&pressure), "{left:?}");
        assert!(
            currents.iter().all(|left| (0.002..0.5).contains(left)),
            "{left:?}"
        );
    }
}

/// The physics of both plants comes from no crate of the product.
#[test]
fn no_plant_uses_a_crate_of_the_product() {
    let sources = repository().join("evidence/tests/src");
    let mut count = 0;
    for plant in [
        "reference_plant",
        "reference_plant/catalogue",
        "kinds_plant",
    ] {
        for entry in fs::read_dir(sources.join(plant)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                continue;
            }
            count += 1;
            let text = fs::read_to_string(&path).unwrap();
            let code = text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            for line in code {
                for product in ["plant_sim", "model_lab", "recording"] {
                    assert!(!line.contains(product), "{}: {line}", path.display());
                }
            }
        }
    }
    assert!(count > 20, "{count} files");
}
