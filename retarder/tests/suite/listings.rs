use plant_sim::PlantParameters;
use plant_sim::parameters::{PARAMETERS, ParameterSpec, Part};

use crate::runner::{Bench, assert_contains};

/// Commands with examples in their help.
const COMMANDS: [&str; 16] = [
    "inspect",
    "simulate",
    "compare",
    "diagnose",
    "refine",
    "next-experiment",
    "control",
    "merge-rigs",
    "blackbox",
    "calibrate",
    "thesis",
    "parameters",
    "settings",
    "tune",
    "schema",
    "completions",
];

#[test]
fn a_printed_plant_file_is_a_plant_file_and_every_parameter_is_listed() {
    let bench = Bench::new();
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    bench.file("plant.toml", &plant);
    let out = bench
        .run(&["parameters", "--plant", "plant.toml"])
        .ended_with(0);
    let nominal = PlantParameters::nominal();
    let is_there = |spec: &&&ParameterSpec| match spec.effect_id() {
        Some(_) => Part::of_parameter(spec).is_in(&nominal),
        None => spec.value(&nominal).is_some(),
    };
    for spec in PARAMETERS.iter().filter(is_there) {
        assert_contains(&out, &[&format!("{} = ", spec.key)]);
    }
    assert_contains(
        &out,
        &[
            "resistance_20c_ohm = 82.2",
            "0.5 to 5000 ohm",
            "derived: 24 V / 292 mA",
            // The knowledge of each ordinary value.
            "Known: usual tolerance of the part, 78.1 to 86.3 ohm; for `refine` 65.8 to 98.6 ohm",
            "Values without `Known` count as exact.",
        ],
    );
    assert_contains(
        &plant,
        &[
            "{ value = 75e-6, tolerance_pct = 30 }",
            "# Known: exact; for",
        ],
    );
    let stated = plant.replace(
        "volume_m3 = 75e-6\n",
        "volume_m3 = { min = 40e-6, max = 120e-6 }\n",
    );
    bench.file("stated.toml", &stated);
    let out = bench
        .run(&["parameters", "--plant", "stated.toml"])
        .ended_with(0);
    assert_contains(&out, &["Known: within 4e-5 to 1.2e-4 m3"]);
    let changed = bench
        .run(&[
            "parameters",
            "--set",
            "coil.resistance_20c_ohm=80",
            "--toml",
        ])
        .ended_with(0);
    assert_contains(
        &changed,
        &["resistance_20c_ohm = 80", "--set on the command line"],
    );
}

#[test]
fn a_printed_controller_file_is_a_controller_file_and_every_setting_is_listed() {
    let bench = Bench::new();
    for name in ["thesis", "recommended"] {
        let text = bench
            .run(&["settings", "--controller", name, "--toml"])
            .ended_with(0);
        bench.file("controller.toml", &text);
        let out = bench
            .run(&["settings", "--controller", "controller.toml"])
            .ended_with(0);
        for key in hil_harness::controller_file::KEYS.iter() {
            assert_contains(
                &out,
                &[
                    &format!("{} = ", key.name),
                    key.about.split(' ').next().unwrap(),
                ],
            );
        }
    }
}

#[test]
fn every_command_has_help_with_an_example_and_completions_name_every_command() {
    let bench = Bench::new();
    for command in COMMANDS {
        let help = bench.run(&[command, "--help"]).ended_with(0);
        assert_contains(
            &help,
            &["Usage:", "Example", &format!("  retarder {command}")],
        );
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let script = bench.run(&["completions", shell]).ended_with(0);
        assert_contains(&script, &COMMANDS);
    }
}

/// `--help` at the end still refuses wrong arguments before it, and runs nothing.
#[test]
fn every_command_that_the_demo_and_the_help_propose_is_understood() {
    let bench = Bench::new();
    let mut texts = bench.run(&[]).ended_with(0);
    for command in [""].into_iter().chain(COMMANDS) {
        let arguments = [command, "--help"];
        texts += &bench
            .run(if command.is_empty() {
                &arguments[1..]
            } else {
                &arguments
            })
            .ended_with(0);
    }
    let count = understood(&bench, &texts);
    assert!(count > 25, "{count} commands");
}

#[test]
fn every_command_that_the_documents_show_is_understood() {
    let bench = Bench::new();
    for (document, least) in [
        ("README.md", 15),
        ("docs/your-rig.md", 8),
        ("docs/diagnosis.md", 5),
    ] {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
        let text = std::fs::read_to_string(format!("{path}/{document}")).unwrap();
        let blocks = text.split("```").skip(1).step_by(2);
        let shown: String = blocks
            .collect::<String>()
            .replace("\n$ retarder ", "\nretarder ");
        let count = understood(&bench, &shown);
        assert!(count >= least, "{document}: {count} commands");
    }
}

/// Asserts that the command understands every line of `texts` that begins with its name; returns their number.
fn understood(bench: &Bench, texts: &str) -> usize {
    let lines = texts.lines().map(str::trim_start);
    let lines = lines.filter(|line| line.starts_with("retarder "));
    let mut count = 0;
    for line in lines {
        // A shell takes the rest of the line; a remark begins after two blanks.
        let command = line
            .split(['>', '|'])
            .next()
            .unwrap()
            .split("  ")
            .next()
            .unwrap();
        let arguments: Vec<&str> = command
            .split_whitespace()
            .skip(1)
            .chain(["--help"])
            .collect();
        let ran = bench.run(&arguments);
        assert_eq!(ran.status, 0, "{line}\n{}", ran.err);
        count += 1;
    }
    count
}
