//! A user's own effect, with the definition and the commands of `docs/your-rig.md`.

use std::fs;

use crate::runner::{Bench, assert_contains};

const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
/// Number of lines of a log that suffices here.
const LINES: usize = 2400;
/// Values of the rig.
const HIDDEN: &str = "\n[effects.own.lifting_seal]\nk = 2.5e-10\np_lift = 5.5e5\n";

/// Returns the section of the page.
fn section() -> String {
    let page = fs::read_to_string(format!("{REPOSITORY}/docs/your-rig.md")).unwrap();
    let begun = page.split_once("## An effect of your own").unwrap().1;
    begun.split_once("\n## ").unwrap().0.to_owned()
}

/// Returns the first block of the section in this language.
fn block(section: &str, language: &str) -> String {
    let begun = section.split_once(&format!("```{language}\n")).unwrap().1;
    begun.split_once("```").unwrap().0.to_owned()
}

/// Returns a folder with the plant file of the page, and logs of a rig that has the effect.
fn bench() -> Bench {
    let bench = Bench::new();
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    let plant = format!("{plant}\n{}", block(&section(), "toml"));
    bench.file("my-plant.toml", &plant);
    bench.file("rig.toml", &format!("{plant}{HIDDEN}"));
    for (name, from) in [("my-log.csv", "id"), ("my-check.csv", "check")] {
        let path = format!("{REPOSITORY}/data/synthetic/practice-00-{from}.csv");
        let text = fs::read_to_string(path).unwrap();
        let lines: Vec<&str> = text.lines().take(LINES).collect();
        bench.file("commands.csv", &lines.join("\n"));
        let simulate = [
            "simulate",
            "commands.csv",
            "--plant",
            "rig.toml",
            "--out",
            name,
        ];
        bench.run(&simulate).ended_with(0);
    }
    bench
}

/// Each command of the section runs, and they lead from the definition to the values of the rig.
#[test]
fn the_commands_of_the_page_lead_from_a_definition_to_its_values() {
    let bench = bench();
    let commands = block(&section(), "sh");
    let mut said = Vec::new();
    for (line, status) in commands.lines().zip([0, 1, 0, 0]) {
        let arguments: Vec<&str> = line.split_whitespace().skip(1).collect();
        let ran = bench.run(&arguments);
        assert!(
            ran.status == status || line.contains(" compare "),
            "{line}\n{ran:?}"
        );
        said.push(ran.out);
    }
    let [parameters, diagnosis, refinement, _] = &said[..] else {
        panic!("four commands");
    };
    let law = "Law: k * max(p - p_lift, 0). Source: plant file; its units are checked.";
    let parameters = parameters.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_contains(&parameters, &["[effects.own.lifting_seal]", law]);
    let sentence = "own.lifting_seal: The lip of the shaft seal lifts above a pressure, and air escapes past it.";
    assert_contains(diagnosis, &["Missing: own lifting seal", sentence]);
    assert_contains(refinement, &["own.lifting_seal, only", "kg/s/Pa"]);
    let refined = bench.read("refined.toml");
    assert_contains(
        &refined,
        &["[own_effects.lifting_seal]", "[effects.own.lifting_seal]"],
    );
    let value = |key: &str| -> f64 {
        let table = refined.split_once("[effects.own.lifting_seal]").unwrap().1;
        let line = table
            .lines()
            .find(|line| line.starts_with(&format!("{key} = ")))
            .unwrap();
        line.split(['=', '#'])
            .nth(1)
            .unwrap()
            .trim()
            .parse()
            .unwrap()
    };
    assert!((value("k") / 2.5e-10 - 1.0).abs() < 0.05, "{}", value("k"));
    assert!(
        (value("p_lift") / 5.5e5 - 1.0).abs() < 0.02,
        "{}",
        value("p_lift")
    );
}

/// The library without the law of the seal leaves a flow. The second block of the page keeps it and fits it.
#[test]
fn a_flow_that_no_effect_explains_becomes_an_effect() {
    let bench = bench();
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    bench.file("my-plant.toml", &plant);
    let section = section();
    let (_, behind) = section
        .split_once("it can write that effect for you")
        .unwrap();
    let commands = block(behind, "sh");
    let mut ran = commands.lines().map(|line| {
        let arguments: Vec<&str> = line.split_whitespace().skip(1).collect();
        bench.run(&arguments)
    });
    let diagnosed = ran.next().unwrap().ended_with(1);
    assert_contains(
        &diagnosed,
        &["Written: with-flow.toml", "--add own.missing_flow"],
    );
    let refined = ran.next().unwrap().ended_with(0);
    assert_contains(&refined, &["own.missing_flow, only"]);
    assert_contains(&bench.read("refined.toml"), &["[effects.own.missing_flow]"]);
}

/// JSON and report name the effect, and the option of the page sets it.
#[test]
fn json_and_report_have_the_own_effect_and_set_changes_it() {
    let bench = bench();
    let diagnose = [
        "diagnose",
        "my-log.csv",
        "--plant",
        "my-plant.toml",
        "--check",
        "my-check.csv",
        "--json",
        "d.json",
        "--html",
        "d.html",
    ];
    bench.run(&diagnose).ended_with(1);
    let json: serde_json::Value = serde_json::from_str(&bench.read("d.json")).unwrap();
    assert_eq!(json["effects"], serde_json::json!(["own.lifting_seal"]));
    assert_contains(
        &bench.read("d.html"),
        &["The lip of the shaft seal lifts above a pressure"],
    );
    let set = [
        "simulate",
        "my-log.csv",
        "--plant",
        "my-plant.toml",
        "--set",
        "effects.own.lifting_seal.k=2e-10",
        "--out",
        "s.csv",
    ];
    bench.run(&set).ended_with(0);
    let wrong = bench.run(&[
        "simulate",
        "my-log.csv",
        "--plant",
        "my-plant.toml",
        "--set",
        "effects.own.lifting_seal.k=1",
    ]);
    assert!(
        wrong.status == 2 && wrong.err.contains("allowed 1e-12 to 1e-8 kg/s/Pa"),
        "{wrong:?}"
    );
}

/// A mistake in a law is shown with file, line and place in the formula.
#[test]
fn a_mistake_in_a_law_is_shown_with_its_line() {
    let bench = bench();
    let plant = bench
        .read("my-plant.toml")
        .replace("(p - p_lift, 0)", "(p - p_lft, 0)");
    bench.file("my-plant.toml", &plant);
    let ran = bench.run(&["simulate", "my-log.csv", "--plant", "my-plant.toml"]);
    assert_eq!(ran.status, 2, "{ran:?}");
    let line = plant
        .lines()
        .position(|line| line.starts_with("expression"))
        .unwrap()
        + 1;
    let error = ran.err.split_whitespace().collect::<Vec<_>>().join(" ");
    let place = format!(
        "my-plant.toml:{line}: `own_effects.lifting_seal.expression`: character 13 of the formula: `p_lft`"
    );
    assert_contains(&error, &[&place, "did you mean `p_lift`?"]);
}
