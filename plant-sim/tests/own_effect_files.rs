//! Definitions of own effects in plant files: what is refused and how, what is kept, and any text.

use plant_sim::own_effects::{POINTS, VARIABLES};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Simulator, Tolerance};
use proptest::prelude::*;

/// Definition in which each line may be replaced.
const DEFINITION: [(&str, &str); 6] = [
    (
        "sentence",
        "sentence = \"The lip of the seal lifts above a pressure.\"",
    ),
    ("acts_on", "acts_on = \"leak_flow\""),
    ("expression", "expression = \"k * max(p - p_lift, 0)\""),
    ("excited_by", "excited_by = \"a hold\""),
    (
        "k",
        "parameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = \"kg/s/Pa\" }",
    ),
    (
        "p_lift",
        "parameters.p_lift = { typical = 5e5, range = [1.5e5, 9e5], unit = \"Pa\" }",
    ),
];
const USE: &str =
    "\n[effects.own.seal]\nk = 2e-10   # fitted\np_lift = { value = 6e5, tolerance = 1e4 }\n";

/// Returns a plant file with the definition, whose lines of these keys are replaced.
fn file(lines: &[(&str, &str)]) -> String {
    let mut text = PlantParameters::nominal().to_toml();
    text += "\n[own_effects.seal]\n";
    for (key, line) in DEFINITION {
        let replaced = lines.iter().find(|(one, _)| *one == key);
        text += replaced.map_or(line, |(_, line)| line);
        text.push('\n');
    }
    text
}

fn read(text: &str) -> Result<PlantParameters, String> {
    PlantParameters::from_toml(text, "rig.toml").map_err(|error| error.to_string())
}

#[test]
fn a_written_file_keeps_the_definition_and_its_values() {
    for use_of_it in ["", USE] {
        let plant = read(&(file(&[]) + use_of_it)).unwrap();
        let written = plant.to_toml();
        let again = read(&written).unwrap();
        assert_eq!(again, plant);
        assert_eq!(again.to_toml(), written);
        assert_eq!(again.own.iter().count(), 1);
        assert_eq!(again.effect("own.seal").is_some(), !use_of_it.is_empty());
    }
    let plant = read(&(file(&[]) + USE)).unwrap();
    assert_eq!(plant.get("effects.own.seal.k"), Some(2e-10));
    assert_eq!(plant.provenance["effects.own.seal.k"], "fitted");
    assert!(plant.knowledge.contains_key("effects.own.seal.p_lift"));
    // The use may precede the definition.
    let text = file(&[]).replace("[own_effects.seal]", &format!("{USE}\n[own_effects.seal]"));
    assert_eq!(read(&text).unwrap(), plant);
}

#[test]
fn quotes_and_controls_in_a_text_are_written_so_that_they_are_read() {
    let sentence = r#"sentence = "A \"quoted\" seal,\n two lines \u001b ü \\ #.""#;
    let plant = read(&file(&[("sentence", sentence)])).unwrap();
    assert_eq!(read(&plant.to_toml()).unwrap(), plant);
}

#[test]
fn an_own_effect_is_set_added_and_removed_as_any_other() {
    let mut plant = read(&file(&[])).unwrap();
    let candidate = plant.candidate("own.seal").unwrap();
    assert_eq!(
        candidate.about().sentence,
        "The lip of the seal lifts above a pressure."
    );
    assert_eq!(plant.get("effects.own.seal.k"), None);
    plant.set("effects.own.seal.k", 3e-10, "test").unwrap();
    assert_eq!(plant.get("effects.own.seal.p_lift"), Some(5e5));
    let wrong = plant
        .set("effects.own.seal.k", 1.0, "test")
        .unwrap_err()
        .to_string();
    assert!(
        wrong.contains("out of range: allowed 1e-12 to 1e-8 kg/s/Pa, or 0 for none"),
        "{wrong}"
    );
    let wrong = plant
        .set("effects.own.sael.k", 1e-9, "test")
        .unwrap_err()
        .to_string();
    assert!(wrong.contains("`effects.own.seal.k`"), "{wrong}");
    // Without strength it is off.
    plant.set("effects.own.seal.k", 0.0, "test").unwrap();
    assert!(plant.effect("own.seal").unwrap().is_off());
    let plain = plant.without_effect("own.seal");
    assert!(plain.effects.is_empty() && plain.own.iter().count() == 1);
}

/// Every mistake has its line, its place in the expression, and the next step.
#[test]
fn every_mistake_in_a_definition_is_named_with_its_place_and_remedy() {
    let first = file(&[])
        .lines()
        .position(|line| line == "[own_effects.seal]")
        .unwrap()
        + 1;
    for (key, line, after, expected) in [
        (
            "sentence",
            "",
            0,
            "`own_effects.seal.sentence` is missing: the effect in one sentence",
        ),
        (
            "acts_on",
            "acts_on = \"leek_flow\"",
            2,
            "= \"leek_flow\" is no point of the plant, did you mean `leak_flow`?; the points are leak_flow [kg/s], ",
        ),
        (
            "acts_on",
            "acts_on = 3",
            2,
            "`own_effects.seal.acts_on` is integer, expected a text in quotes",
        ),
        (
            "expression",
            "expression = \"k * max(p - p_lift, 0\"",
            3,
            "`own_effects.seal.expression`: character 22 of the formula: expected an operator, a comma or a closing parenthesis, found its end",
        ),
        (
            "expression",
            "expression = \"k * max(p - p_lft, 0)\"",
            3,
            "character 13 of the formula: `p_lft` is neither a parameter nor a variable, did you mean `p_lift`?; the parameters are k, p_lift; the variables are p, p_supply, ",
        ),
        (
            "expression",
            "expression = \"k * max(p - p_lift, 0) + t_gas\"",
            3,
            "character 24 of the formula: `+` has on its left kg/s, and on its right K; correct",
        ),
        (
            "expression",
            "expression = \"k * max(p - p_lift, 0) / p\"",
            3,
            "gives m*s, and `leak_flow` needs kg/s",
        ),
        (
            "expression",
            "expression = \"k * (p - p_lift) ^ 0.5 * p ^ 0.5\"",
            3,
            "is NaN at k = 1e-12, p = 10000, p_lift = 150000; a root or a power of a negative number has no value, so write `max(..., 0)`",
        ),
        (
            "expression",
            "expression = \"k * p * p / (p - p_lift)\"",
            3,
            "character 11 of the formula: the divisor is positive for some values and negative for others",
        ),
        (
            "expression",
            "expression = \"k * max(p - p_lift, 0) / p * p / time\"",
            3,
            "gives kg/s^2, and `leak_flow` needs kg/s",
        ),
        (
            "expression",
            "expression = \"k * max(p - p_lift, 0) + 1e-9\"",
            3,
            "no parameter switches it off: with one of them at 0 the value must be 0; multiply the deviation by a strength, as in `k * (p - p_ambient)`",
        ),
        (
            "expression",
            "expression = \"k * p\"",
            6,
            "`own_effects.seal.parameters.p_lift` is not in the expression; use it there, or remove it",
        ),
        (
            "excited_by",
            "excited = \"a hold\"",
            4,
            "`own_effects.seal.excited` is no key of a definition, did you mean `excited_by`?; the keys are sentence, acts_on, ",
        ),
        (
            "k",
            "parameters.k = { typical = 1e-7, range = [1e-12, 1e-8], unit = \"kg/s/Pa\" }",
            5,
            "`own_effects.seal.parameters.k.typical` = 1e-7 is outside of its range, 1e-12 to 1e-8",
        ),
        (
            "k",
            "parameters.k = { typical = 1e-10, range = [1e-8, 1e-12], unit = \"kg/s/Pa\" }",
            5,
            "range` = [1e-8, 1e-12] is no range; write finite numbers with the smaller one first",
        ),
        (
            "k",
            "parameters.k = { typical = 1e-10, range = [1e-12], unit = \"kg/s/Pa\" }",
            5,
            "`own_effects.seal.parameters.k.range` is array, expected [least, most], two numbers",
        ),
        (
            "k",
            "parameters.k = { value = 1e-10, range = [1e-12, 1e-8], unit = \"kg/s/Pa\" }",
            5,
            "`own_effects.seal.parameters.k.value` is no key of a definition; the keys are typical, range, unit, about",
        ),
        (
            "k",
            "parameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = \"g/s/Pa\" }",
            5,
            "`g/s/Pa`: `g` is no SI unit, and a formula computes in SI units: write `kg` instead, and multiply the values by 1e-3",
        ),
        (
            "k",
            "parameters.k = 1e-10",
            5,
            "`own_effects.seal.parameters.k` is float, expected a table, such as { typical",
        ),
        (
            "p_lift",
            "parameters.p = { typical = 5e5, range = [1.5e5, 9e5] }\nparameters.p_lift = { typical = 5e5, range = [1.5e5, 9e5], unit = \"Pa\" }",
            6,
            "`own_effects.seal.parameters.p` is the name of a variable; rename the parameter",
        ),
    ] {
        let error = read(&file(&[(key, line)]))
            .err()
            .unwrap_or_else(|| panic!("{line}"));
        let place = format!("rig.toml:{}: ", first + after);
        let found = error
            .lines()
            .any(|one| one.starts_with(&place) && one.contains(expected));
        assert!(found, "{line}\n{place}…{expected}\n{error}");
    }
}

/// A factor that may become negative, and a volume that depends on a state whose rate is not known.
#[test]
fn a_value_that_a_point_does_not_admit_is_refused() {
    let k = ("k", "parameters.k = { typical = 0.5, range = [0, 2] }");
    let p_lift = ("p_lift", "");
    for (acts_on, expression, expected) in [
        (
            "vent_area",
            "1 - k",
            "is -1 at k = 2, and `vent_area` (factor of the area of the vent valve) is at least 0",
        ),
        (
            "chamber_volume",
            "1 + k * open_fill",
            "character 9 of the formula: `chamber_volume` may not depend on `open_fill`",
        ),
        (
            "chamber_volume",
            "1 + 20 * k * exp(-k * p / 1e5)",
            "shrinks so fast with the pressure at k = ",
        ),
        (
            "fill_area",
            "k",
            "with one of them at 0 the value must be 1; multiply the deviation by a strength, as in `1 + k *",
        ),
    ] {
        let acts_on = format!("acts_on = \"{acts_on}\"");
        let expression = format!("expression = \"{expression}\"");
        let lines = [
            ("acts_on", acts_on.as_str()),
            ("expression", &expression),
            k,
            p_lift,
        ];
        let error = read(&file(&lines)).unwrap_err();
        assert!(error.contains(expected), "{expression}: {error}");
    }
}

#[test]
fn an_effect_without_definition_and_an_unknown_name_are_told_apart() {
    let undefined = format!("{}{USE}", PlantParameters::nominal().to_toml());
    let error = read(&undefined).unwrap_err();
    assert!(
        error.contains("unknown effect [effects.own.seal]"),
        "{error}"
    );
    let misspelled = file(&[]) + &USE.replace("own.seal", "own.sael");
    let error = read(&misspelled).unwrap_err();
    assert!(error.contains("write `[effects.own.seal]`"), "{error}");
    // A definition with a mistake is reported once, not as an unknown effect as well.
    let error = read(&(file(&[("acts_on", "acts_on = \"x\"")]) + USE)).unwrap_err();
    assert_eq!(error.lines().count(), 1, "{error}");
}

#[test]
fn units_that_cannot_be_checked_are_said() {
    let source = |k: &str, expression: &str| {
        let expression = format!("expression = \"{expression}\"");
        let lines = [("k", k), ("expression", &expression)];
        let plant = read(&file(&lines)).unwrap();
        plant.candidate("own.seal").unwrap().about().source
    };
    let checked = DEFINITION[4].1;
    assert_eq!(
        source(checked, "k * max(p - p_lift, 0)"),
        "plant file; its units are checked"
    );
    let free = "parameters.k = { typical = 1e-10, range = [1e-12, 1e-8] }";
    assert_eq!(
        source(free, "k * max(p - p_lift, 0)"),
        "plant file; units of parts are not checked: the unit of `k` is not fixed"
    );
}

/// An effect of the plant file acts on a part that the plant has.
#[test]
fn an_own_effect_of_an_absent_part_is_refused() {
    let lines = [
        ("acts_on", "acts_on = \"coil_resistance\""),
        ("expression", "expression = \"1 + k\""),
        ("k", "parameters.k = { typical = 0.1, range = [0, 1] }"),
        ("p_lift", ""),
    ];
    let mut plant = read(&(file(&lines) + "\n[effects.own.seal]\nk = 0.2\n")).unwrap();
    assert!(plant.check().is_ok());
    plant.functions = [ValveFunction::AlwaysOpen; 2];
    let error = plant.check().unwrap_err().to_string();
    let expected =
        "[effects.own.seal] has nothing to act on, since this plant has no coil; remove it";
    assert!(error.contains(expected), "{error}");
}

#[test]
fn the_tables_of_points_and_variables_have_units_that_formulas_know() {
    for unit in POINTS
        .iter()
        .map(|one| one.unit)
        .chain(VARIABLES.iter().map(|one| one.unit))
    {
        assert!(matches!(formula::parse_unit(unit), Ok(Some(_))), "{unit}");
    }
    let mut names: Vec<_> = VARIABLES.iter().map(|one| one.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), VARIABLES.len());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any expression is read or refused with a line, and a plant that is read is written and read again.
    #[test]
    fn any_expression_is_read_or_refused(
        words in prop::collection::vec(prop::sample::select(vec![
            "k", "p", "p_lift", "p_ambient", "time", "open_fill", "1", "0", "2.5e-3", "+", "-", "*", "/", "^", "(", ")",
            ",", "max(", "sqrt(", "exp(", " ", "ü",
        ]), 0..16),
    ) {
        let expression = format!("expression = \"{}\"", words.concat());
        let k = "parameters.k = { typical = 1e-10, range = [1e-12, 1e-8] }";
        match read(&file(&[("expression", &expression), ("k", k)])) {
            Ok(plant) => prop_assert_eq!(read(&plant.to_toml()), Ok(plant)),
            Err(error) => prop_assert!(error.lines().all(|line| line.starts_with("rig.toml:")), "{}", error),
        }
    }
}

/// Returns the chamber pressures (Pa abs) while the plant fills, vents and holds in between.
fn pressures(plant: &PlantParameters) -> Vec<f64> {
    // With the default tolerance, the two ways of integration differ by 50 Pa; they agree as both converge.
    let mut simulator = Simulator::with_tolerance(plant, Tolerance::scaled(0.1));
    let pressure = |tenth: u64| {
        let (fill, vent) = match tenth {
            2..4 => (100.0, 0.0),
            30..31 => (0.0, 100.0),
            _ => (0.0, 0.0),
        };
        simulator.command(Command {
            duty_fill_pct: fill,
            duty_vent_pct: vent,
        });
        simulator.advance_to_ns((tenth + 1) * 100_000_000);
        simulator.sample().pressure
    };
    (0..60).map(pressure).collect()
}

/// Both laws are those of the same nozzle, so that further orifices need no effect of the library.
#[test]
fn an_orifice_of_an_own_effect_passes_as_much_as_that_of_the_library() {
    for (flow, effect) in [
        ("area * flux_ambient", "chamber_leak"),
        ("-area * flux_supply", "supply_seat_leak"),
    ] {
        let nominal = PlantParameters::nominal().to_toml();
        let own = format!(
            "{nominal}\n[own_effects.hole]\nsentence = \"A hole.\"\nacts_on = \"leak_flow\"\nexpression = \"{flow}\"\n\
             parameters.area = {{ typical = 3e-8, range = [1e-10, 1e-6], unit = \"m^2\" }}\n\
             \n[effects.own.hole]\narea = 3e-8\n"
        );
        let library =
            format!("{nominal}\n[effects.{effect}]\nvariant = \"orifice\"\narea_m2 = 3e-8\n");
        let [own, library, tight] =
            [&own, &library, &nominal].map(|text| pressures(&read(text).unwrap()));
        let largest = |other: &[f64]| {
            let differences = own
                .iter()
                .zip(other)
                .map(|(one, other)| (one - other).abs());
            differences.fold(0.0, f64::max)
        };
        assert!(largest(&tight) > 0.1e5, "{effect}: {}", largest(&tight));
        assert!(largest(&library) < 2.0, "{effect}: {}", largest(&library));
    }
}
