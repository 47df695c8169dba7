//! Changes of the plant file on page "Estimate"; each is a step that can be undone.

use model_lab::diagnosis::result::FittedParameter;
use model_lab::diagnosis::state;
use plant_sim::PlantParameters;
use plant_sim::parameters::Knowledge;
use serde::Deserialize;

use crate::history::{BY_HAND, History, Step, StepEffect};
use crate::refusal::Refusal;

/// Name of the edited tables in error messages.
const EDITED: &str = "edited tables";

/// Change of the plant file by the user. Without a tag field, for the reason given at the changes of page "Refine".
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Change {
    /// States how well a value is known.
    State {
        name: String,
        known: Statement,
    },
    /// Sets the value of a parameter.
    Value {
        name: String,
        value: f64,
    },
    /// Replaces the tables that are edited as text.
    Tables(String),
    Undo,
    Redo,
}

/// Statement about a value.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Statement {
    /// That of the plant file as opened.
    Opened,
    Fixed,
    TolerancePct(f64),
    Range(f64, f64),
    Unknown,
}

impl Change {
    pub(super) fn apply(&self, history: &mut History) -> Result<(), Refusal> {
        let now = history.now();
        let step = match self {
            Self::State { name, known } => stated(history, name, *known)?,
            Self::Value { name, value } => with_value(history, name, *value)?,
            Self::Tables(text) => {
                let plant = now.plant.parameters()?;
                let plant = plant.with_edited_tables(text, EDITED).map_err(|error| {
                    Refusal::from(error).with_lines_up_to(text.lines().count() as u64)
                })?;
                let effects = effects_of(&plant, &now.effects);
                restated(
                    &plant,
                    "edited the tables of the valves and own effects".to_owned(),
                    effects,
                    history,
                )?
            }
            Self::Undo => return history.undo(),
            Self::Redo => return history.redo(),
        };
        history.push(step);
        Ok(())
    }
}

/// Returns the step to `plant`, which fits start from. The reader of plant files checks the file first.
fn restated(
    plant: &PlantParameters,
    done: String,
    effects: Vec<StepEffect>,
    history: &History,
) -> Result<Step, Refusal> {
    let step = Step::to(plant, done, effects, history.first())?;
    step.plant.parameters()?;
    Ok(Step {
        is_restated: true,
        ..step
    })
}

fn stated(history: &History, name: &str, known: Statement) -> Result<Step, Refusal> {
    let mut plant = history.now().plant.parameters()?;
    let opened = history.first().plant.parameters()?;
    let (knowledge, words) = match known {
        Statement::Opened => (
            opened.knowledge.get(name).copied(),
            "known as opened".to_owned(),
        ),
        Statement::Fixed => (Some(Knowledge::Exact), "fixed".to_owned()),
        Statement::TolerancePct(percent) => (
            Some(Knowledge::TolerancePct(percent)),
            format!("within {percent} %"),
        ),
        Statement::Range(low, high) => (
            Some(Knowledge::Range(low, high)),
            format!("within {low} to {high}"),
        ),
        Statement::Unknown => (Some(Knowledge::Unknown), "unknown".to_owned()),
    };
    state(&mut plant, name, knowledge)?;
    let effects = effects_of(&plant, &history.now().effects);
    restated(&plant, format!("{name}: {words}"), effects, history)
}

fn with_value(history: &History, name: &str, value: f64) -> Result<Step, Refusal> {
    let mut plant = history.now().plant.parameters()?;
    let stated = plant.knowledge.get(name).copied();
    // Setting the value would drop a range that it contradicts.
    if let Some(Knowledge::Range(low, high)) = stated
        && !(low..=high).contains(&value)
    {
        return Err(Refusal::value(format!(
            "{name} is {value} (its range is {low} to {high}); widen the range first"
        )));
    }
    plant.set(name, value, BY_HAND)?;
    let unit = plant.any_spec(name).map_or("", |spec| spec.unit);
    let done = format!("{name} = {value} {unit}").trim_end().to_owned();
    let effects = effects_of(&plant, &history.now().effects);
    restated(&plant, done, effects, history)
}

/// Returns the effects of `plant` after those of the step `before`: one whose values are unchanged keeps its fit, one
/// that is switched off stays if the plant may still have it.
fn effects_of(plant: &PlantParameters, before: &[StepEffect]) -> Vec<StepEffect> {
    let unfitted = |setting| StepEffect::of(setting, &[] as &[FittedParameter]);
    let kept = before
        .iter()
        .filter_map(|old| match plant.effect(&old.effect) {
            Some(setting) => Some(if old.has_values_of(setting) {
                old.clone()
            } else {
                unfitted(setting)
            }),
            None => (!old.is_on && old.setting(plant).is_ok()).then(|| old.clone()),
        });
    let is_new = |id: &str| !before.iter().any(|old| old.effect == id);
    let added = plant.effects.iter().filter(|one| is_new(one.id()));
    kept.chain(added.map(unfitted)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::PlantFile;

    const VOLUME: &str = "chamber.volume_m3";

    fn history() -> History {
        History::begin(&PlantFile::nominal()).unwrap()
    }

    fn change(history: &mut History, json: &str) -> Result<(), Refusal> {
        let change: Change = serde_json::from_str(json).unwrap();
        change.apply(history)
    }

    fn stated_in(history: &History) -> Option<Knowledge> {
        let plant = history.now().plant.parameters().unwrap();
        plant.knowledge.get(VOLUME).copied()
    }

    /// Goal: the command line reads what the page states. Method: the plant file of the step, read again.
    #[test]
    fn each_statement_is_that_of_the_plant_file_and_can_be_taken_back() {
        let mut history = history();
        for (known, expected) in [
            (r#""fixed""#, Some(Knowledge::Exact)),
            (
                r#"{"tolerance_pct": 12.5}"#,
                Some(Knowledge::TolerancePct(12.5)),
            ),
            (
                r#"{"range": [4e-5, 1.2e-4]}"#,
                Some(Knowledge::Range(4e-5, 1.2e-4)),
            ),
            (r#""unknown""#, Some(Knowledge::Unknown)),
            (r#""opened""#, None),
        ] {
            change(
                &mut history,
                &format!(r#"{{"state": {{"name": "{VOLUME}", "known": {known}}}}}"#),
            )
            .unwrap();
            assert_eq!(stated_in(&history), expected, "{known}");
            assert_eq!(history.base(), history.now(), "fits start here");
        }
        assert_eq!(
            history.now().plant,
            PlantFile::nominal(),
            "as it was opened"
        );
        for _ in 0..5 {
            change(&mut history, r#""undo""#).unwrap();
        }
        assert_eq!((history.at(), stated_in(&history)), (0, None));
    }

    #[test]
    fn a_value_outside_of_its_range_or_of_nature_is_refused_and_changes_nothing() {
        let mut history = history();
        let set = |value: &str| format!(r#"{{"value": {{"name": "{VOLUME}", "value": {value}}}}}"#);
        change(&mut history, &set("8e-5")).unwrap();
        let range =
            format!(r#"{{"state": {{"name": "{VOLUME}", "known": {{"range": [7e-5, 9e-5]}}}}}}"#);
        change(&mut history, &range).unwrap();
        for (json, says) in [
            (set("1e-4"), "its range is 0.00007 to 0.00009"),
            (set("2"), "its range is"),
            (
                range.replace("[7e-5, 9e-5]", "[9e-5, 7e-5]"),
                "the lower end comes first",
            ),
            (
                range.replace("\"range\": [7e-5, 9e-5]", "\"tolerance_pct\": -1"),
                "state 0 or more",
            ),
            (
                range.replace(VOLUME, "chamber.nothing"),
                "no parameter or table",
            ),
        ] {
            let refused = change(&mut history, &json).unwrap_err();
            assert!(
                refused.problems[0].message.contains(says),
                "{json}: {refused:?}"
            );
            assert_eq!(history.at(), 2, "{json}");
        }
    }

    #[test]
    fn edited_tables_are_a_step_and_their_problems_have_lines_of_the_text() {
        let mut history = history();
        let text = "[valves]\nfill = \"normally_closed\"\nvent = \"normally_closed\"\n[own_effects.seal]\nsentence = \"It leaks.\"\n\
            acts_on = \"leak_flow\"\nexpression = \"k * max(p - p_ambient, 0)\"\nparameters.k = { typical = 1e-10, range = [1e-12, 1e-8] }\n\
            [effects.own.seal]\nk = 2e-10\n";
        let edit = |text: &str| serde_json::json!({ "tables": text }).to_string();
        change(&mut history, &edit(text)).unwrap();
        let added = &history.now().effects;
        assert_eq!(
            (added.len(), &added[0].effect[..], added[0].is_on),
            (1, "own.seal", true)
        );
        let wrong = change(&mut history, &edit(&text.replace("k * max", "k ** max"))).unwrap_err();
        assert_eq!(wrong.problems[0].line, Some(7), "{wrong:?}");
        // A missing table of the rest of the file has no line in this text.
        let coil = change(
            &mut history,
            &edit("[valves]\nfill = \"on_off\"\nvent = \"normally_closed\"\n"),
        )
        .unwrap_err();
        assert!(
            coil.problems.iter().all(|one| one.line.is_none()),
            "{coil:?}"
        );
        assert_eq!(history.at(), 1);
        change(
            &mut history,
            &edit("[valves]\nfill = \"normally_closed\"\nvent = \"normally_closed\"\n"),
        )
        .unwrap();
        assert!(history.now().effects.is_empty());
    }
}
