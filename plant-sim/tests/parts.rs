//! Plants with omitted parts, in every combination.

use plant_sim::effects::{EffectSetting, LIBRARY, by_id};
use plant_sim::parameters::Part;
use plant_sim::replay::{CurrentSampling, ROW_SIGNALS, Replay, ReplayInput, signals};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Tolerance};

const FUNCTIONS: [ValveFunction; 5] = [
    ValveFunction::NormallyClosed,
    ValveFunction::NormallyOpen,
    ValveFunction::AlwaysOpen,
    ValveFunction::Blocked,
    ValveFunction::Absent,
];

/// Returns every plant that has at least a coil or a chamber.
fn plants() -> impl Iterator<Item = PlantParameters> {
    let pairs = FUNCTIONS.map(|fill| FUNCTIONS.map(|vent| [fill, vent]));
    pairs.into_iter().flatten().flat_map(|functions| {
        [true, false].into_iter().filter_map(move |has_chamber| {
            let mut plant = PlantParameters::nominal();
            plant.functions = functions;
            if !has_chamber {
                plant.chamber.volume_m3 = 0.0;
            }
            // Only the keys of existing parts are written to the file.
            PlantParameters::from_toml(&plant.to_toml(), "rig.toml").ok()
        })
    })
}

/// Maximum number of steps of a plant for 0.1 s, with the stiffest effect at its typical size.
const STEPS_MAX: u64 = 20_000;

/// Fills, vents and holds for 0.1 s. The signals of the plant are finite, the others are missing.
fn check(plant: &PlantParameters, what: &str) {
    let mut replay = Replay::new(plant, CurrentSampling::Instant, Tolerance::default());
    for time_ns in (0..=100_u64).map(|ms| ms * 1_000_000) {
        let duty = |from: u64| {
            if time_ns / 1_000_000 % 40 >= from {
                70.0
            } else {
                0.0
            }
        };
        let row = replay.row(ReplayInput {
            command: Some(Command {
                duty_fill_pct: duty(0),
                duty_vent_pct: duty(20),
            }),
            ..ReplayInput::at(time_ns)
        });
        for ((name, _), value) in ROW_SIGNALS.iter().zip(row) {
            let has = signals(plant).any(|(one, _)| one == *name);
            assert!(value.is_finite() || !has, "{what}: {name} = {value}");
        }
    }
    let statistics = replay.simulator().statistics();
    assert!(statistics.steps < STEPS_MAX, "{what}: {statistics:?}");
}

#[test]
fn every_combination_of_parts_is_a_plant_but_nothing_at_all() {
    // Without coil and chamber: an orifice or nothing in place of each valve.
    assert_eq!(plants().count(), 50 - 4);
    for plant in plants() {
        assert!(plant.check().is_ok());
        check(&plant, &format!("{:?}", plant.functions));
        for spec in plant.specs().filter(|spec| !spec.is_optional()) {
            assert!(spec.value(&plant).is_some(), "{}", spec.name());
        }
    }
}

#[test]
fn every_effect_joins_every_plant_that_has_what_it_acts_on() {
    for effect in LIBRARY {
        let id = effect.about().id;
        for plant in plants() {
            let joined = plant.with_effect(EffectSetting::typical(effect));
            let what = format!("{id} on {:?}", plant.functions);
            let may = Part::of_effect(effect).is_in(&plant);
            assert_eq!(joined.check().is_ok(), may, "{what}");
            if may {
                check(&joined, &what);
            }
        }
    }
}

/// A vent valve alone has its own restriction and none that a fill valve would need.
#[test]
fn a_form_of_an_effect_is_there_where_each_of_its_parts_is() {
    let restriction = by_id("series_restriction").unwrap();
    let forms = |fill, vent| {
        let mut plant = PlantParameters::nominal();
        plant.functions = [fill, vent];
        let forms = plant.forms_of(restriction);
        let names = forms.iter().map(|form| form.variant().name);
        names.collect::<Vec<_>>()
    };
    let (there, gone) = (ValveFunction::NormallyClosed, ValveFunction::Absent);
    assert_eq!(forms(there, there), ["both", "fill", "vent", "combined"]);
    assert_eq!(forms(gone, there), ["vent"]);
    assert_eq!(forms(there, gone), ["fill"]);
    assert!(forms(gone, gone).is_empty());
}
