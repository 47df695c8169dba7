//! Plant files: reading, refusals, and their messages.

use plant_sim::PlantParameters;
use plant_sim::effects::EffectSetting;
use plant_sim::parameters::{Knowledge, NOMINAL_PLANT_TOML, PARAMETERS, Part};
use plant_sim::valve::ValveFunction;

const REGULATING_VALVE: &str = "
[regulating_valve]
plunger_mass_kg = 0.15
air_area_m2 = 1.4e-3
oil_area_m2 = 0.0
oil_pressure_bar_gauge = 0.0
spring_n_per_m = 42e3
preload_n = 200
static_friction_n = 12
dynamic_friction_n = 8
stroke_m = 15e-3
";

/// Returns the nominal file with `from` replaced by `to`; `from` must occur.
fn changed(from: &str, to: &str) -> String {
    assert!(NOMINAL_PLANT_TOML.contains(from), "{from}");
    NOMINAL_PLANT_TOML.replacen(from, to, 1)
}

/// Reads `text`, which must be refused, and returns the message.
fn refusal(text: &str) -> String {
    PlantParameters::from_toml(text, "rig.toml")
        .expect_err("refused")
        .to_string()
}

#[test]
fn the_shipped_plant_is_read_with_its_provenance() {
    let nominal = PlantParameters::nominal();
    assert_eq!(nominal.chamber.volume_m3, 75e-6);
    assert_eq!(nominal.ecu.command_delay_ns(), 15_000_000);
    assert_eq!(nominal.functions, [ValveFunction::NormallyClosed; 2]);
    assert_eq!(
        nominal.provenance["ecu.command_delay_s"],
        "thesis, section 4.2.4"
    );
}

#[test]
fn a_written_file_reads_back_to_the_same_bits() {
    let mut plant = PlantParameters::nominal();
    plant
        .set("flow.discharge_fill", 0.1 + 0.2, "fitted")
        .unwrap();
    plant.functions[1] = ValveFunction::NormallyOpen;
    let again = PlantParameters::from_toml(&plant.to_toml(), "again").unwrap();
    assert_eq!(plant, again);
}

/// A coil without its voltage is not described; a valve that is known by its delays has one all the same (E73).
#[test]
fn valves_without_a_coil_need_no_supply_voltage_and_may_state_it() {
    let voltage = "ecu.supply_voltage_v";
    let mut plant = PlantParameters::nominal();
    plant.functions = [ValveFunction::OnOff; 2];
    for valve in [&mut plant.on_off_fill, &mut plant.on_off_vent] {
        (valve.conductance_dm3_per_s_bar, valve.critical_ratio) = (0.1, 0.3);
        (valve.opening_ramp_s, valve.closing_ramp_s) = (4e-3, 2e-3);
    }
    let silent = plant.to_toml();
    assert!(!silent.contains("supply_voltage_v"), "{silent}");
    let read = |text: &str| PlantParameters::from_toml(text, "rig.toml").unwrap();
    assert_eq!(read(&silent).get(voltage), Some(24.0));
    plant.set(voltage, 12.0, "bench").unwrap();
    assert_eq!(read(&plant.to_toml()).get(voltage), Some(12.0));
    let without = refusal(&changed("supply_voltage_v", "# supply_voltage_v"));
    assert!(
        without.contains("`supply_voltage_v` is missing"),
        "{without}"
    );
}

#[test]
fn every_parameter_is_refused_beyond_its_range_and_accepted_at_its_ends() {
    let nominal = PlantParameters::nominal();
    let others = [ValveFunction::OnOff, ValveFunction::Proportional].map(|function| {
        let mut other = nominal.clone();
        other.functions = [function; 2];
        other.second_chamber.volume_m3 = 1e-4;
        other
    });
    for spec in PARAMETERS.iter().filter(|spec| !spec.is_optional()) {
        let mut plants = std::iter::once(&nominal).chain(&others);
        let nominal = plants.find(|plant| spec.value(plant).is_some());
        let nominal = nominal.expect("a plant has the part");
        let (least, most) = spec.range;
        for (value, allowed) in [
            (least, true),
            (most, true),
            (least - least.abs().max(1e-9) * 1e-9, false),
            (most + most.abs() * 1e-9, false),
            (f64::NAN, false),
            (f64::INFINITY, false),
        ] {
            let mut plant = nominal.clone();
            let result = plant.set(&spec.name(), value, "test");
            // The gap and the stroke also exclude each other.
            if !["magnet.gap_closed_m", "armature.stroke_m"].contains(&spec.name().as_str())
                || !allowed
            {
                assert_eq!(
                    result.is_ok(),
                    allowed,
                    "{} = {value}: {result:?}",
                    spec.name()
                );
            }
        }
    }
}

#[test]
fn a_value_says_how_well_it_is_known_and_is_written_the_same() {
    let read = |value: &str| {
        let text = changed("volume_m3 = 75e-6", &format!("volume_m3 = {value}"));
        let plant = PlantParameters::from_toml(&text, "rig.toml").unwrap();
        let again = PlantParameters::from_toml(&plant.to_toml(), "written").unwrap();
        assert_eq!(
            (again.knowledge.clone(), again.chamber.volume_m3),
            (plant.knowledge.clone(), plant.chamber.volume_m3),
            "{value}"
        );
        let knowledge = plant.knowledge.get("chamber.volume_m3").copied();
        (plant.chamber.volume_m3, knowledge)
    };
    assert_eq!(read("80e-6"), (80e-6, None));
    for (value, knowledge) in [
        ("{ value = 80e-6, exact = true }", Knowledge::Exact),
        (
            "{ value = 80e-6, tolerance_pct = 30 }",
            Knowledge::TolerancePct(30.0),
        ),
        (
            "{ value = 80e-6, tolerance = 1e-5 }",
            Knowledge::Tolerance(1e-5),
        ),
        (
            "{ value = 80e-6, min = 4e-5, max = 1e-4 }",
            Knowledge::Range(4e-5, 1e-4),
        ),
    ] {
        assert_eq!(read(value), (80e-6, Some(knowledge)));
    }
    let (middle, _) = read("{ min = 40e-6, max = 160e-6 }");
    assert!((middle - 80e-6).abs() < 1e-12, "{middle}");
    // An unknown value begins at that of the shipped plant.
    assert_eq!(read("\"unknown\""), (75e-6, Some(Knowledge::Unknown)));
}

#[test]
fn a_statement_that_makes_no_sense_is_refused_with_the_forms_that_do() {
    for value in [
        "{ value = 80e-6, tolerance_pct = -1 }",
        "{ value = 80e-6, tolerance = nan }",
        "{ min = 1e-4, max = 4e-5 }",
        "{ min = 4e-5 }",
        "{ value = 1e-3, min = 4e-5, max = 1e-4 }",
        "{ value = 80e-6, exact = true, tolerance_pct = 3 }",
        "{ value = 80e-6, exact = false }",
        "{ value = 80e-6, tolerances = 3 }",
        "{ tolerance_pct = 3 }",
        "\"about 80e-6\"",
    ] {
        let text = changed("volume_m3 = 75e-6", &format!("volume_m3 = {value}"));
        let error = PlantParameters::from_toml(&text, "rig.toml")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("rig.toml:47: `chamber.volume_m3`")
                && error.contains("tolerance_pct = T"),
            "{value}: {error}"
        );
    }
}

#[test]
fn refusals_name_file_line_value_bound_and_what_to_do() {
    for (text, says) in [
        (
            changed("volume_m3 = 75e-6", "volume_cm3 = 75"),
            "rig.toml:47: unknown parameter `chamber.volume_cm3`; write `volume_m3 = 7.5e-5`",
        ),
        (
            changed("volume_m3 = 75e-6", "volume_m3 = 75"),
            "rig.toml:47: `chamber.volume_m3` = 75 is out of range: allowed 1e-7 to 1 m3 (dead volume V_ch of chamber, channels and actuator (section 2.2)); if the number is in cm3, write `volume_m3 = 7.5e-5`",
        ),
        (
            changed("mass_kg = 5.0e-3", "mass_kg = \"5 g\""),
            "`armature.mass_kg` is string, expected a number, { value = V, tolerance_pct = T }",
        ),
        (
            changed("[chamber]", "[chambre]"),
            "unknown table [chambre]; a plant file has the tables [ecu], [coil]",
        ),
        (
            changed("mass_kg = 5.0e-3", ""),
            "rig.toml: `mass_kg` is missing in [armature]: moving mass (equation 3.11); add it with a value from 1e-4 to 1 kg",
        ),
        (
            changed("mass_kg = 5.0e-3", "mass_kg = nan"),
            "`armature.mass_kg` = NaN is out of range",
        ),
        (
            changed("mass_kg = 5.0e-3", "mass_kg = 5.0e-3 kg"),
            "rig.toml:23: not valid TOML",
        ),
        (
            changed("mass_kg = 5.0e-3", "mass_kg = 5e-3\nmass_kg = 6e-3"),
            "rig.toml:24: not valid TOML",
        ),
        (
            changed("stroke_m = 0.5e-3", "stroke_m = 9e-3"),
            "`magnet.gap_closed_m`: the effective gap 0.008 m must be larger than armature.stroke_m = 0.009 m",
        ),
        (
            format!("{NOMINAL_PLANT_TOML}\n[valves]\nvent = \"open\"\n"),
            "`valves.vent` = \"open\" is not one of normally_closed, normally_open",
        ),
        (
            format!("{NOMINAL_PLANT_TOML}\n[regulating_valve]\nplunger_mass_kg = 0.1\n"),
            "`stroke_m` is missing in [regulating_valve]",
        ),
        (
            format!("{NOMINAL_PLANT_TOML}{REGULATING_VALVE}")
                .replace("dynamic_friction_n = 8", "dynamic_friction_n = 20"),
            "friction in motion, 20 N, cannot exceed friction at rest, static_friction_n = 12 N",
        ),
    ] {
        let message = refusal(&text);
        assert!(message.contains(says), "expected: {says}\nfound: {message}");
    }
}

#[test]
fn a_regulating_valve_joins_the_plant() {
    let text = format!("{NOMINAL_PLANT_TOML}{REGULATING_VALVE}");
    let plant = PlantParameters::from_toml(&text, "rig.toml").unwrap();
    assert_eq!(plant.regulating_valve.as_ref().unwrap().stroke_m, 15e-3);
    assert_eq!(
        PlantParameters::from_toml(&plant.to_toml(), "again").unwrap(),
        plant
    );
}

#[test]
fn setting_a_value_is_checked_like_reading_it() {
    let mut plant = PlantParameters::nominal();
    let before = plant.clone();
    for (name, value, says) in [
        (
            "regulating_valve.stroke_m",
            0.01,
            "no table [regulating_valve]",
        ),
        (
            "chamber.volume_cm3",
            75.0,
            "write `chamber.volume_m3 = 7.5e-5`",
        ),
        ("chamber.volume_m3", 75.0, "if the number is in cm3"),
        ("chamber.volume_m3", 30.0, "write `volume_m3 = 3e-5`"),
        (
            "armature.stroke_m",
            9e-3,
            "must be larger than armature.stroke_m",
        ),
        ("no.such", 1.0, "unknown parameter"),
    ] {
        let message = plant.set(name, value, "test").unwrap_err().to_string();
        assert!(message.contains(says), "{name}: {message}");
        assert_eq!(plant, before, "{name} changed nothing");
    }
    assert!(plant.check().is_ok());
    plant.ecu.pwm_frequency_hz = 4e9;
    assert!(
        plant
            .check()
            .unwrap_err()
            .to_string()
            .contains("ecu.pwm_frequency_hz")
    );
}

#[test]
fn all_problems_are_reported_at_once() {
    let text = changed("mass_kg = 5.0e-3", "mass_kg = -1").replace("volume_m3", "volumen_m3");
    let error = PlantParameters::from_toml(&text, "rig.toml").unwrap_err();
    assert_eq!(error.problems().len(), 3, "{error}");
}

#[test]
fn hostile_files_are_refused_without_harm() {
    for text in [
        "[".repeat(100_000),
        "a.".repeat(100_000),
        "\u{feff}\u{0}".to_owned(),
        format!("x = \"{}\"", "y".repeat(2 << 20)),
        "[ecu]\nsample_time_s = 1e400".to_owned(),
    ] {
        assert!(PlantParameters::from_toml(&text, "rig.toml").is_err());
    }
}

/// Returns a plant file of the repository.
fn bundled(name: &str) -> PlantParameters {
    let path = format!("{}/../data/plants/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    PlantParameters::from_toml(&text, name).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_plant_has_the_parameters_of_its_parts_and_no_others() {
    for (name, has, has_not) in [
        (
            "leakdown-chamber",
            &["chamber.volume_m3", "flow.critical_ratio"][..],
            &[
                "flow.discharge_fill",
                "coil.resistance_20c_ohm",
                "gas.supply_pressure_bar_gauge",
            ][..],
        ),
        (
            "air-vessel-790kPa",
            &["flow.discharge_vent", "gas.temperature_k"],
            &["flow.discharge_fill", "armature.preload_vent_n"],
        ),
        (
            "burkert-6724-coil",
            &["coil.inductance_closed_h", "ecu.supply_voltage_v"],
            &[
                "coil.inductance_open_h",
                "magnet.gap_closed_m",
                "chamber.volume_m3",
            ],
        ),
    ] {
        let plant = bundled(name);
        for key in has {
            assert!(plant.get(key).is_some(), "{name}: {key}");
        }
        for key in has_not {
            assert_eq!(plant.get(key), None, "{name}: {key}");
            assert!(
                plant.specs().all(|spec| spec.name() != *key),
                "{name}: {key}"
            );
            let mut changed = plant.clone();
            let refusal = changed.set(key, 1.0, "test").unwrap_err().to_string();
            assert!(refusal.contains("describes nothing"), "{refusal}");
        }
        assert!(
            plant.check().is_ok(),
            "{name}: what is left out is not checked"
        );
        let again = PlantParameters::from_toml(&plant.to_toml(), "again").unwrap();
        assert_eq!(plant, again);
    }
}

#[test]
fn an_effect_needs_the_part_that_it_acts_on() {
    let chamber = bundled("leakdown-chamber");
    for (effect, says) in [
        ("coil_heating", "this plant has no coil; remove it"),
        ("supply_seat_leak", "no fill valve that air flows through"),
    ] {
        let effect = plant_sim::effects::by_id(effect).unwrap();
        assert!(!Part::of_effect(effect).is_in(&chamber));
        let plant = chamber.with_effect(EffectSetting::typical(effect));
        let refusal = plant.check().unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
    }
    let leak = plant_sim::effects::by_id("chamber_leak").unwrap();
    assert!(
        chamber
            .with_effect(EffectSetting::typical(leak))
            .check()
            .is_ok()
    );
}

#[test]
fn a_part_is_left_out_by_saying_so_and_not_by_forgetting() {
    for (text, says) in [
        (
            changed("discharge_vent = 0.97", ""),
            "`discharge_vent` is missing in [flow]: discharge coefficient of the vent valve (equations 3.19, 5.1); add it with a value from 0.05 to 1.5; if there is no vent valve that air flows through, write `vent = \"absent\"` in [valves]",
        ),
        (
            changed("preload_vent_n = 3.34", ""),
            "if there is no armature of the vent valve, write `vent = \"always_open\"` in [valves]",
        ),
        (
            format!("{NOMINAL_PLANT_TOML}\n[valves]\nvent = \"absent\"\n"),
            "`flow.discharge_vent` describes nothing, since this plant has no vent valve that air flows through: remove it",
        ),
        (
            changed("[chamber]\nvolume_m3 = 75e-6", ""),
            "`gas.temperature_k` describes nothing, since this plant has no chamber",
        ),
        (
            "[valves]\nfill = \"absent\"\nvent = \"absent\"\n".to_owned(),
            "`valves`: nothing is left to simulate without a valve or a chamber",
        ),
    ] {
        let message = refusal(&text);
        assert!(message.contains(says), "expected: {says}\nfound: {message}");
    }
}
