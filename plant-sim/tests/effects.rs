//! Library of effects: requirements on every effect.

use plant_sim::effects::{EffectSetting, LIBRARY, Variant, by_id};
use plant_sim::parameters::{NOMINAL_PLANT_TOML, PARAMETERS};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Sample, Simulator, Statistics, Tolerance};
use proptest::prelude::*;

/// Returns every variant of every effect at its typical size.
fn settings() -> Vec<EffectSetting> {
    let variants = |effect: &&'static dyn plant_sim::effects::Effect| {
        let effect = *effect;
        let typical =
            move |variant: &'static Variant| EffectSetting::typical_variant(effect, variant);
        effect.about().variants.iter().map(typical)
    };
    LIBRARY.iter().flat_map(variants).collect()
}

/// Returns the setting with all strengths at their off values.
fn off(mut setting: EffectSetting) -> EffectSetting {
    for (index, spec) in setting.parameters().iter().enumerate() {
        if let Some(off) = spec.size.and_then(|size| size.off) {
            setting.values_mut()[index] = off;
        }
    }
    setting
}

/// Returns a plant with every effect of the library that acts on it, in the first variant.
fn with_all(plant: &PlantParameters) -> PlantParameters {
    let acting = LIBRARY
        .iter()
        .filter_map(|effect| plant.forms_of(*effect).into_iter().next());
    acting.fold(plant.clone(), |plant, effect| plant.with_effect(effect))
}

/// Returns the samples of a simulation under conditions in which every effect acts.
fn run(
    plant: &PlantParameters,
    duties: &[(f64, f64)],
    tolerance: Tolerance,
) -> (Vec<Sample>, Statistics) {
    let mut simulator = Simulator::with_tolerance(plant, tolerance);
    simulator.set_supply_voltage(22.0);
    let mut samples = Vec::new();
    for (index, &(duty_fill_pct, duty_vent_pct)) in duties.iter().enumerate() {
        simulator.advance_to_ns(index as u64 * 10_000_000);
        simulator.move_actuator(1e-5 * (index % 20) as f64, 0.01);
        samples.push(simulator.sample());
        simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct,
        });
    }
    (samples, simulator.statistics())
}

/// Returns an excitation that fills, holds, vents and overlaps: every part of the plant works.
fn test_signal() -> Vec<(f64, f64)> {
    let phases = [
        (15, 100.0, 0.0),
        (20, 0.0, 0.0),
        (25, 45.0, 0.0),
        (10, 0.0, 45.0),
        (20, 60.0, 50.0),
        (20, 0.0, 0.0),
        (25, 0.0, 100.0),
        (15, 70.0, 0.0),
    ];
    phases
        .into_iter()
        .flat_map(|(samples, fill, vent)| vec![(fill, vent); samples])
        .collect()
}

#[test]
fn every_effect_says_what_it_is() {
    let ids: Vec<_> = LIBRARY.iter().map(|effect| effect.about().id).collect();
    for effect in LIBRARY {
        let about = effect.about();
        assert!(
            about.sentence.ends_with('.') && about.sentence.len() > 60,
            "{}",
            about.id
        );
        assert!(about.source.starts_with('E'), "{}", about.id);
        assert!(
            !about.excited_by.is_empty() && !about.confused_with.is_empty(),
            "{}",
            about.id
        );
        for other in about.confused_with {
            assert!(
                ids.contains(other) && *other != about.id,
                "{}: {other}",
                about.id
            );
        }
        for variant in about.variants {
            let mut strengths = 0;
            for spec in variant.parameters {
                let size = spec.size.expect("an effect's parameter has a size");
                assert_eq!(spec.effect_id(), Some(about.id));
                assert!(spec.contains(size.typical), "{}", spec.name());
                assert!(
                    spec.about.contains("(E"),
                    "{} names its equation",
                    spec.name()
                );
                strengths += usize::from(size.off.is_some());
            }
            assert!(strengths > 0, "{} can be off", about.id);
        }
    }
}

#[test]
fn the_ids_are_those_of_the_design() {
    let mut ids: Vec<_> = LIBRARY.iter().map(|effect| effect.about().id).collect();
    ids.sort_unstable();
    assert_eq!(
        ids,
        [
            "actuator_volume",
            "chamber_leak",
            "coil_ambient_temperature",
            "coil_heating",
            "critical_ratio",
            "dead_volume",
            "drain_back_pressure",
            "eddy_currents",
            "end_stop_bounce",
            "flow_force",
            "flyback_clamp",
            "gas_temperature",
            "iron_saturation",
            "regulating_valve_volume",
            "sensor_hysteresis",
            "sensor_lag",
            "sensor_offset",
            "series_restriction",
            "static_friction",
            "supply_line_droop",
            "supply_resistance",
            "supply_seat_leak",
            "switching_delay",
        ]
    );
}

/// Returns the nominal plant with two on/off valves.
fn on_off() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    plant.functions = [ValveFunction::OnOff; 2];
    for valve in [&mut plant.on_off_fill, &mut plant.on_off_vent] {
        (valve.conductance_dm3_per_s_bar, valve.critical_ratio) = (0.1, 0.3);
        (valve.opening_delay_s, valve.closing_delay_s) = (2e-3, 1e-3);
        (valve.opening_ramp_s, valve.closing_ramp_s) = (1e-3, 1e-3);
    }
    // Without the values of coils, of which a file of such a plant has none.
    PlantParameters::from_toml(&plant.to_toml(), "on/off").unwrap()
}

/// Returns a plant on which the effect acts: the nominal one, or else that with two on/off valves.
fn kind_for(setting: &EffectSetting) -> PlantParameters {
    let nominal = PlantParameters::nominal();
    match nominal.forms_of(setting.effect()).is_empty() {
        true => on_off(),
        false => nominal,
    }
}

#[test]
fn every_effect_at_its_typical_size_shows_in_pressure_or_current() {
    // Fifteen seconds warm the coils.
    let duties = [vec![(100.0, 0.0); 1500], test_signal()].concat();
    for setting in settings() {
        let name = format!("{} as {}", setting.id(), setting.variant().name);
        let kind = kind_for(&setting);
        let [plain, with] = [kind.clone(), kind.with_effect(setting)]
            .map(|plant| run(&plant, &duties, Tolerance::default()).0);
        let worst = |what: &dyn Fn(&Sample) -> f64| {
            let differences = with
                .iter()
                .zip(&plain)
                .map(|(a, b)| (what(a) - what(b)).abs());
            differences.fold(0.0, f64::max)
        };
        let pressure = worst(&|sample| sample.measured_pressure);
        let current = worst(&|sample| sample.mean_current[0]);
        assert!(
            pressure > 500.0 || current > 1e-3,
            "{name}: {pressure} Pa, {current} A"
        );
    }
}

/// The event-driven solution with effects converges like the plain one.
#[test]
fn every_effect_converges_with_the_tolerance() {
    let duties = &test_signal()[..100];
    let nominal = PlantParameters::nominal();
    let mut plants: Vec<_> = settings()
        .into_iter()
        .map(|setting| {
            let name = format!("{} as {}", setting.id(), setting.variant().name);
            (name, nominal.with_effect(setting))
        })
        .collect();
    plants.push(("all together".to_owned(), with_all(&nominal)));
    let mut failures = Vec::new();
    for (name, plant) in plants {
        let [coarse, fine, finest] =
            [1.0, 1e-2, 1e-4].map(|factor| run(&plant, duties, Tolerance::scaled(factor)).0);
        let worst = |samples: &[Sample], what: &dyn Fn(&Sample) -> f64| {
            let errors = samples
                .iter()
                .zip(&finest)
                .map(|(a, b)| (what(a) - what(b)).abs());
            errors.fold(0.0, f64::max)
        };
        let pressure = |sample: &Sample| sample.measured_pressure;
        let current = |sample: &Sample| sample.mean_current[0];
        let found = [
            worst(&coarse, &pressure),
            worst(&fine, &pressure),
            worst(&coarse, &current),
        ];
        if !(found[0] < 300.0 && found[1] < 30.0 && found[2] < 1e-4) {
            failures.push(format!("{name}: {found:?}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// A line so short and wide, and a cavity so small, that their pressures follow in microseconds. The plant is the plain
/// one except for the cavity's half percent of air, and does not take millions of steps.
#[test]
fn what_is_much_faster_than_the_plant_costs_few_steps_and_changes_nothing() {
    let duties = test_signal();
    let nominal = PlantParameters::nominal();
    let (plain, _) = run(&nominal, &duties, Tolerance::default());
    for (id, values) in [
        ("supply_line_droop", [1e-3, 1e-7]),
        ("dead_volume", [1e-8, 1e-4]),
    ] {
        let mut setting = EffectSetting::typical(by_id(id).unwrap());
        setting.values_mut().copy_from_slice(&values);
        let (fast, statistics) = run(&nominal.with_effect(setting), &duties, Tolerance::default());
        for (fast, plain) in fast.iter().zip(&plain) {
            let off = (fast.measured_pressure - plain.pressure).abs();
            assert!(off < 300.0, "{id}: {fast:?} {plain:?}");
        }
        let steps = (statistics.steps + statistics.rejected_steps) / duties.len() as u64;
        assert!(steps < 300, "{id}: {steps} steps in a period");
    }
}

#[test]
fn a_plant_file_keeps_every_effect_to_the_bit() {
    for setting in settings() {
        let kind = kind_for(&setting);
        let mut plant = kind.with_effect(setting.clone());
        plant
            .provenance
            .insert(setting.parameters()[0].name(), "fitted to rig 7".to_owned());
        let text = plant.to_toml();
        assert!(
            text.contains(&format!("[effects.{}]", setting.id())),
            "{text}"
        );
        let again = PlantParameters::from_toml(&text, "again").unwrap();
        assert_eq!(plant, again);
        let off = kind.with_effect(off(setting));
        assert_eq!(
            off,
            PlantParameters::from_toml(&off.to_toml(), "off").unwrap()
        );
    }
    let all = with_all(&PlantParameters::nominal());
    assert_eq!(
        all,
        PlantParameters::from_toml(&all.to_toml(), "all").unwrap()
    );
}

/// Defect seen: without a `variant`, a parameter of another than the first one was refused as unknown.
#[test]
fn the_parameters_of_an_effect_tell_its_variant() {
    for (table, expected) in [
        (
            "[effects.coil_heating]\nheat_capacity_j_per_k = 25",
            "adiabatic",
        ),
        (
            "[effects.coil_heating]\ncooling_w_per_k = 0.1\nheat_capacity_j_per_k = 25",
            "cooled",
        ),
        ("[effects.series_restriction]\nvent_area_ratio = 1", "vent"),
    ] {
        let text = format!("{NOMINAL_PLANT_TOML}\n{table}\n");
        let plant = PlantParameters::from_toml(&text, "rig.toml").expect(table);
        assert_eq!(plant.effects[0].variant().name, expected, "{table}");
    }
    let table = "[effects.coil_heating]\ncooling_w_per_k = 0.1";
    let text = format!("{NOMINAL_PLANT_TOML}\n{table}\n");
    let error = PlantParameters::from_toml(&text, "rig.toml").expect_err(table);
    let says = "`heat_capacity_j_per_k` is missing in [effects.coil_heating]";
    assert!(error.to_string().contains(says), "{error}");
}

#[test]
fn refusals_of_effects_name_what_is_meant() {
    for (table, says) in [
        (
            "[effects.chamber_leek]\narea_m2 = 1e-8",
            "rig.toml:49: unknown effect [effects.chamber_leek]; write `[effects.chamber_leak]`",
        ),
        (
            "[effects.gremlins]\nnumber = 3",
            "unknown effect [effects.gremlins]; remove it, or list the known ones with `retarder parameters`",
        ),
        (
            "[effects.chamber_leak]\naera_m2 = 1e-8",
            "unknown parameter `effects.chamber_leak.aera_m2`; write `area_m2`",
        ),
        (
            "[effects.chamber_leak]\narea_mm2 = 0.02",
            "unknown parameter `effects.chamber_leak.area_mm2`; write `area_m2 = 2e-8`",
        ),
        (
            "[effects.chamber_leak]\narea_m2 = 0.02",
            "`effects.chamber_leak.area_m2` = 0.02 is out of range: allowed 1e-11 to 1e-5 m2, or 0 for none",
        ),
        (
            "[effects.chamber_leak]\nvariant = \"hole\"\narea_m2 = 2e-8",
            "`effects.chamber_leak.variant` = \"hole\" is not one of orifice, laminar, mixed, power",
        ),
        (
            "[effects.chamber_leak]\nvariant = \"power\"\narea_m2 = 2e-8",
            "`exponent` is missing in [effects.chamber_leak]: exponent of the leak's flow",
        ),
        (
            "[effects]\nchamber_leak = 2e-8",
            "`effects.chamber_leak` is float, expected a table of parameters",
        ),
        (
            "[effects.coil_heating]\nheat_capacity_j_per_k = -1",
            "allowed 0.5 to 5000 J/K, or inf for none",
        ),
    ] {
        let text = format!("{NOMINAL_PLANT_TOML}\n{table}\n");
        let message = PlantParameters::from_toml(&text, "rig.toml")
            .expect_err(table)
            .to_string();
        assert!(message.contains(says), "expected: {says}\nfound: {message}");
    }
}

#[test]
fn setting_a_parameter_adds_its_effect() {
    let mut plant = PlantParameters::nominal();
    let before = plant.clone();
    assert!(
        plant
            .set("effects.chamber_leak.area_m2", 1.0, "test")
            .is_err()
    );
    assert_eq!(plant, before, "a refusal changes nothing");
    plant
        .set("effects.chamber_leak.exponent", 1.2, "test")
        .unwrap();
    let leak = plant.effect("chamber_leak").unwrap();
    assert_eq!(leak.variant().name, "power");
    assert_eq!(plant.get("effects.chamber_leak.exponent"), Some(1.2));
    assert_eq!(plant.get("effects.chamber_leak.area_m2"), Some(2e-8));
    assert_eq!(plant.without_effect("chamber_leak"), before);
}

#[test]
fn every_effect_is_in_the_list_of_parameters() {
    for setting in settings() {
        for spec in setting.parameters() {
            let listed = PARAMETERS.iter().any(|listed| listed.name() == spec.name());
            assert!(listed, "{}", spec.name());
        }
    }
}

/// The requirement on each effect also applies to all effects together: the state stays physical and the work bounded.
#[test]
fn all_effects_together_stay_in_bounds() {
    let plant = with_all(&PlantParameters::nominal());
    let (samples, statistics) = run(&plant, &test_signal().repeat(4), Tolerance::default());
    for sample in &samples {
        assert!((1.0e5..9.6e5).contains(&sample.pressure), "{sample:?}");
        for index in 0..2 {
            assert!((0.0..0.4).contains(&sample.current[index]), "{sample:?}");
            assert!(
                (0.0..=0.5e-3).contains(&sample.position[index]),
                "{sample:?}"
            );
        }
    }
    let periods = samples.len() as u64;
    assert!(
        statistics.steps < 60 * periods,
        "{statistics:?} in {periods} periods"
    );
}

/// E5 and E49: the current of a coil that is switched off reaches zero after L/R ln(1 + i_0 R/V), with the resistance R and the voltage V of
/// the freewheeling loop. It begins at 24 V over the resistance of the loop that is switched on; a switch is no part of the other one.
#[test]
fn the_freewheeling_current_ends_when_its_loop_says() {
    for (id, variant, key, value, [on_ohm, off_ohm, off_v]) in [
        (
            "flyback_clamp",
            "zener",
            "extra_drop_v",
            20.0,
            [82.2, 82.2, 20.8],
        ),
        (
            "flyback_clamp",
            "resistor",
            "resistance_ohm",
            50.0,
            [82.2, 132.2, 0.8],
        ),
        (
            "supply_resistance",
            "switch",
            "resistance_ohm",
            10.0,
            [92.2, 82.2, 0.8],
        ),
        (
            "supply_resistance",
            "per_coil",
            "resistance_ohm",
            10.0,
            [92.2, 92.2, 0.8],
        ),
    ] {
        let effect = by_id(id).unwrap();
        let variant = effect.about().variant(variant).unwrap();
        let setting = EffectSetting::typical_variant(effect, variant).with(key, value);
        let mut plant = PlantParameters::nominal().with_effect(setting);
        // The valve stays shut: its motion would induce a voltage.
        plant.armature.preload_fill_n = 100.0;
        plant.ecu.command_delay_s = 0.0;
        let mut simulator = Simulator::new(&plant);
        for (at_ns, duty_fill_pct) in [(0, 100.0), (100_000_000, 0.0)] {
            simulator.advance_to_ns(at_ns);
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct: 0.0,
            });
        }
        let end_s: f64 = 0.44 / off_ohm * f64::ln_1p(24.0 / on_ohm * off_ohm / off_v);
        for (share, flows) in [(0.99, true), (1.01, false)] {
            simulator.advance_to_ns(100_000_000 + (share * end_s * 1e9) as u64);
            let current = simulator.sample().current[0];
            assert_eq!(current > 0.0, flows, "{id} {}: {current}", variant.name);
        }
    }
}

fn plants() -> impl Strategy<Value = PlantParameters> {
    prop::collection::vec(-1.0..1.0_f64, PARAMETERS.len()).prop_map(|exponents| {
        let mut plant = PlantParameters::nominal();
        for (spec, exponent) in PARAMETERS.iter().zip(exponents) {
            let Some(value) = spec.value(&plant) else {
                continue;
            };
            let value = (value * 2.0_f64.powf(exponent)).clamp(spec.range.0, spec.range.1);
            // A gap shorter than the stroke is refused: the nominal value stays.
            let _ = plant.set(&spec.name(), value, "drawn");
        }
        plant
    })
}

fn duties() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let duty = prop_oneof![Just(0.0), Just(100.0), 0.0..100.0_f64];
    prop::collection::vec((duty.clone(), duty), 1..30)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20, failure_persistence: None, ..ProptestConfig::default() })]

    /// Every variant of every effect, off, on a random plant.
    #[test]
    fn off_is_the_plain_plant_bit_for_bit(plant in plants(), duties in duties()) {
        let plain = run(&plant, &duties, Tolerance::default());
        for setting in settings() {
            let setting = off(setting);
            prop_assert!(setting.is_off());
            let with = run(&plant.with_effect(setting.clone()), &duties, Tolerance::default());
            prop_assert_eq!(&with, &plain, "{}", setting.id());
        }
    }

    /// Any effects together, at sizes up to ten times off the typical ones.
    #[test]
    fn any_effects_combine(
        plant in plants(),
        duties in duties(),
        chosen in prop::collection::vec((any::<bool>(), 0.0..1.0_f64, -1.0..1.0_f64), LIBRARY.len()),
    ) {
        let mut plant = plant;
        for (effect, (on, which, exponent)) in LIBRARY.iter().zip(chosen) {
            let variants = effect.about().variants;
            let variant = &variants[(which * variants.len() as f64) as usize];
            let mut setting = EffectSetting::typical_variant(*effect, variant);
            for (value, spec) in setting.values_mut().iter_mut().zip(variant.parameters) {
                *value = (*value * 10.0_f64.powf(exponent)).clamp(spec.range.0, spec.range.1);
            }
            if on {
                plant = plant.with_effect(setting);
            }
        }
        let (samples, statistics) = run(&plant, &duties, Tolerance::default());
        for sample in &samples {
            prop_assert!(sample.pressure > 0.0 && sample.pressure.is_finite(), "{sample:?}");
            prop_assert!(sample.measured_pressure.is_finite(), "{sample:?}");
            prop_assert!(sample.mean_current.iter().all(|current| current.is_finite()), "{sample:?}");
        }
        prop_assert_eq!(run(&plant, &duties, Tolerance::default()).0, samples, "the same bits twice");
        prop_assert!(statistics.steps + statistics.rejected_steps < 20_000 * duties.len() as u64, "{statistics:?}");
    }
}
