//! Negative controls: answers that the diagnosis must not give.

mod practice;

use core::ops::ControlFlow;

use model_lab::diagnosis::result::{Diagnosis, Verdict};
use model_lab::diagnosis::{DiagnoseError, diagnose, diagnose_with};
use plant_sim::effects::{Effect, EffectSetting, LIBRARY, by_id};
use plant_sim::replay::replay;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Provenance, Recording, Unit};

const WATCH: fn(model_lab::diagnosis::Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

/// Number of seconds of a log that suffices here.
const SECONDS: usize = 20;

fn beginning(name: &str) -> Recording {
    practice::beginning(name, SECONDS)
}

fn rig(rig: u8, library: &[&'static dyn Effect]) -> Diagnosis {
    let read = |kind: &str| [beginning(&format!("practice-{rig:02}-{kind}.csv"))];
    let plant = PlantParameters::nominal();
    diagnose_with(library, &plant, &read("id"), &read("check"), &WATCH).unwrap()
}

fn without(id: &str) -> Vec<&'static dyn Effect> {
    let all = LIBRARY.into_iter();
    all.filter(|effect| effect.about().id != id).collect()
}

/// Rebuilds a log from its columns, some of them replaced.
fn rebuilt(log: &Recording, replace: impl Fn(&str, Vec<f64>) -> Vec<f64>) -> Recording {
    let mut new = Recording::new(Provenance::from_source("rebuilt"));
    let base = log.signals()[0].time_base();
    let id = new.add_time_base(log.time_base(base).unwrap().clone());
    for signal in log.signals() {
        let values = replace(signal.name(), signal.values_or_nan().to_vec());
        new.add_signal(signal.name(), signal.unit(), id, values)
            .unwrap();
    }
    new
}

/// With a library that lacks the hidden effect, no rig gets a wrong name.
#[test]
fn a_library_without_the_effect_names_no_other() {
    for (hides, id) in [(1, "chamber_leak"), (5, "gas_temperature")] {
        let diagnosis = rig(hides, &without(id));
        assert_eq!(
            diagnosis.verdict,
            Verdict::NotInLibrary,
            "{id}: {}",
            diagnosis.sentence
        );
    }
}

/// Effects that no rig has, with parameters that make them flexible: a leak that follows a clock, and a hum on a coil.
mod nonsense {
    use plant_sim::PlantParameters;
    use plant_sim::effects::{About, Effect, EffectSetting, EntryPoint, Variant};
    use plant_sim::parameters::{ParameterSpec, Size};
    use plant_sim::plant::Plant;

    static FLOW: ParameterSpec = ParameterSpec::of_effect(
        "effects.clock_flow",
        "flow_kg_per_s",
        "kg/s",
        (1e-9, 1e-2),
        Size::strength(1e-6),
        "flow that comes and goes with a clock",
    );
    static CLOCK_FLOW: About = About {
        id: "clock_flow",
        sentence: "Air comes and goes with a clock that nothing on the rig has.",
        source: "nonsense",
        acts_on: EntryPoint::Leak,
        variants: &[Variant::only(&[&FLOW])],
        excited_by: "nothing",
        confused_with: &[],
    };
    static HUM: ParameterSpec = ParameterSpec::of_effect(
        "effects.coil_hum",
        "hum_v",
        "V",
        (1e-4, 10.0),
        Size::strength(0.1),
        "voltage that hums in the fill coil",
    );
    static COIL_HUM: About = About {
        id: "coil_hum",
        sentence: "The fill coil hums at a frequency that nothing on the rig has.",
        source: "nonsense",
        acts_on: EntryPoint::Coil,
        variants: &[Variant::only(&[&HUM])],
        excited_by: "nothing",
        confused_with: &[],
    };

    #[derive(Debug)]
    pub(super) struct ClockFlow;
    impl Effect for ClockFlow {
        fn about(&self) -> &'static About {
            &CLOCK_FLOW
        }
        fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
            let flow = setting.value("flow_kg_per_s");
            let hooks = &mut plant.additions.hooks;
            hooks.add_inflow(move |now| flow * (4.71 * now.time).sin());
        }
    }

    #[derive(Debug)]
    pub(super) struct CoilHum;
    impl Effect for CoilHum {
        fn about(&self) -> &'static About {
            &COIL_HUM
        }
        fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
            let hum = setting.value("hum_v");
            let hooks = &mut plant.additions.hooks;
            hooks.add_voltage(0, move |now| hum * (9.1 * now.time).sin());
        }
    }
}

/// Nonsensical effects are never named: neither where nothing is missing, nor together with the missing effect, nor instead of it.
#[test]
fn nonsense_is_never_named() {
    let with_nonsense = |mut library: Vec<&'static dyn Effect>| {
        library.extend([
            &nonsense::ClockFlow as &'static dyn Effect,
            &nonsense::CoilHum,
        ]);
        library
    };
    let whole = with_nonsense(LIBRARY.to_vec());
    let without_leak = with_nonsense(without("chamber_leak"));
    for (hides, library, verdict, effects) in [
        (0, &whole, Verdict::Adequate, vec![]),
        (1, &whole, Verdict::Found, vec!["chamber_leak"]),
        (1, &without_leak, Verdict::NotInLibrary, vec![]),
    ] {
        let diagnosis = rig(hides, library);
        assert_eq!(
            diagnosis.verdict, verdict,
            "{hides}: {}",
            diagnosis.sentence
        );
        assert_eq!(
            diagnosis.effects, effects,
            "{hides}: {}",
            diagnosis.sentence
        );
    }
}

/// Commands from another time explain nothing, and neither does any effect.
#[test]
fn duty_cycles_of_another_time_give_no_name() {
    let shifted = |log: &Recording| {
        rebuilt(log, |name, mut values| {
            if name.starts_with("duty") {
                let third = values.len() / 3;
                values.rotate_left(third);
            }
            values
        })
    };
    let logs = [shifted(&beginning("practice-01-id.csv"))];
    let check = [shifted(&beginning("practice-01-check.csv"))];
    let diagnosis = diagnose(&PlantParameters::nominal(), &logs, &check, &WATCH).unwrap();
    assert_eq!(
        diagnosis.verdict,
        Verdict::NotInLibrary,
        "{}",
        diagnosis.sentence
    );
    assert!(diagnosis.effects.is_empty());
}

/// Data of the model itself with noise: every effect that was simulated is named, at its size.
#[test]
fn the_models_own_data_is_answered_perfectly() {
    for (id, key) in [
        ("chamber_leak", "area_m2"),
        ("coil_ambient_temperature", "difference_k"),
        ("sensor_lag", "time_constant_s"),
    ] {
        let effect = EffectSetting::typical(by_id(id).unwrap());
        let truth = effect.get(key).unwrap();
        let plant = PlantParameters::nominal().with_effect(effect);
        let made = |name: &str, seed: u64| {
            let commands = beginning(name);
            let model = replay(&plant, &commands, Tolerance::default(), |_, _| {}).unwrap();
            let noise = noise(seed);
            rebuilt(&commands, |name, values| {
                let sigma = match name {
                    "p_ch" => 0.004,
                    "i_fill" | "i_vent" => 0.7,
                    _ => return values,
                };
                let modelled = model.recording.signal(name).unwrap().values_or_nan();
                let salt = name.len();
                let pairs = modelled.iter().enumerate();
                pairs
                    .map(|(row, value)| value + sigma * noise(row * 31 + salt))
                    .collect()
            })
        };
        let logs = [made("practice-00-id.csv", 1)];
        let check = [made("practice-00-check.csv", 2)];
        let diagnosis = diagnose(&PlantParameters::nominal(), &logs, &check, &WATCH).unwrap();
        assert_eq!(
            diagnosis.verdict,
            Verdict::Found,
            "{id}: {}",
            diagnosis.sentence
        );
        // A warm coil and a long lead are identical in every logged signal.
        let stands_for =
            |named: &String| diagnosis.equivalents[named].iter().any(|same| same == id);
        assert_eq!(diagnosis.effects.len(), 1, "{id}: {}", diagnosis.sentence);
        assert!(
            stands_for(&diagnosis.effects[0]),
            "{id}: {}",
            diagnosis.sentence
        );
        if diagnosis.effects[0] != id {
            continue;
        }
        let mut candidates = diagnosis.candidates.iter();
        let candidate = candidates.find(|candidate| candidate.effect == id).unwrap();
        let parameter = candidate
            .parameters
            .iter()
            .find(|fitted| fitted.key == key)
            .unwrap();
        let (low, high) = (parameter.low, parameter.high);
        assert!(
            low <= truth && truth <= high,
            "{id}: {truth} in {low} to {high}"
        );
    }
}

/// Returns standard normal numbers by index: a hash of the index, and the central limit of twelve uniform ones.
fn noise(seed: u64) -> impl Fn(usize) -> f64 {
    move |index| {
        let even = |part: u64| {
            let mut x = (index as u64 * 12 + part) ^ (seed << 48);
            x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (x ^ (x >> 31)) as f64 / u64::MAX as f64
        };
        (0..12).map(even).sum::<f64>() - 6.0
    }
}

#[test]
fn who_watches_may_stop_it() {
    let (logs, check) = (
        [practice::log("practice-01-id.csv")],
        [practice::log("practice-01-check.csv")],
    );
    let stop = |_| ControlFlow::Break(());
    let result = diagnose(&PlantParameters::nominal(), &logs, &check, &stop);
    assert_eq!(result.unwrap_err(), DiagnoseError::Interrupted);
    let none = diagnose(&PlantParameters::nominal(), &[], &check, &WATCH);
    assert_eq!(none.unwrap_err(), DiagnoseError::NoLog);
}

/// Without pressure and currents there is no signal to compare.
#[test]
fn a_log_that_shows_nothing_is_refused() {
    let log = practice::log("practice-01-id.csv");
    let mut commands = Recording::new(Provenance::from_source("commands.csv"));
    let base = log.signals()[0].time_base();
    let id = commands.add_time_base(log.time_base(base).unwrap().clone());
    for name in ["duty_fill", "duty_vent"] {
        let values = log.signal(name).unwrap().values_or_nan().to_vec();
        commands
            .add_signal(name, Unit::Percent, id, values)
            .unwrap();
    }
    let error = diagnose(&PlantParameters::nominal(), &[commands], &[], &WATCH).unwrap_err();
    assert!(error.to_string().contains("commands.csv"), "{error}");
}
