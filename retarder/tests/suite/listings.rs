use crate::runner::{Bench, assert_contains};

#[test]
fn a_printed_plant_file_is_a_plant_file_and_every_parameter_is_listed() {
    let bench = Bench::new();
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    bench.file("plant.toml", &plant);
    let out = bench
        .run(&["parameters", "--plant", "plant.toml"])
        .ended_with(0);
    for spec in plant_sim::parameters::PARAMETERS.iter() {
        assert_contains(&out, &[&format!("{} = ", spec.key)]);
    }
    assert_contains(
        &out,
        &[
            "resistance_20c_ohm = 82.2",
            "0.5 to 5000 ohm",
            "derived: 24 V / 292 mA",
        ],
    );
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
        for key in hil_harness::controller_file::KEYS {
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
    let commands = [
        "simulate",
        "compare",
        "diagnose",
        "refine",
        "control",
        "blackbox",
        "calibrate",
        "thesis",
        "parameters",
        "settings",
        "schema",
        "completions",
    ];
    for command in commands {
        let help = bench.run(&[command, "--help"]).ended_with(0);
        assert_contains(
            &help,
            &["Usage:", "Example", &format!("  retarder {command}")],
        );
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let script = bench.run(&["completions", shell]).ended_with(0);
        assert_contains(&script, &commands);
    }
}

/// `--help` at the end refuses what stands before it and is wrong, and runs nothing.
#[test]
fn every_command_that_the_tour_and_the_help_propose_is_understood() {
    let bench = Bench::new();
    let mut texts = bench.run(&[]).ended_with(0);
    for command in [
        "",
        "simulate",
        "compare",
        "diagnose",
        "refine",
        "control",
        "blackbox",
        "calibrate",
        "thesis",
        "parameters",
        "settings",
        "schema",
        "completions",
    ] {
        let arguments = [command, "--help"];
        texts += &bench
            .run(if command.is_empty() {
                &arguments[1..]
            } else {
                &arguments
            })
            .ended_with(0);
    }
    let mut count = 0;
    for line in texts
        .lines()
        .map(str::trim_start)
        .filter(|line| line.starts_with("retarder "))
    {
        // A shell takes the rest of the line, and so does the remark behind two blanks.
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
    assert!(count > 25, "{count} commands");
}
