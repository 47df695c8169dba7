//! What else a named effect could be, in words for the terminal, the report and the page.

use std::collections::BTreeMap;

use plant_sim::effects::{EntryPoint, by_id};

use super::result::Diagnosis;
use super::verdict::DISTINGUISHABLE;
use super::words::{significant, spaced};

/// So many of the nearest effects are told.
const NEAREST_TOLD: usize = 4;

/// What shows the effect `id`, in words: an experiment, or a sensor that sees it alone.
fn shown_by(id: &str) -> Option<String> {
    let about = by_id(id)?.about();
    let sensor = match about.acts_on {
        EntryPoint::GasEnergy => ", or a logged gas temperature t_gas",
        EntryPoint::AirSupply => ", or a logged supply pressure p_sup",
        EntryPoint::Sensor => ", or a second sensor",
        _ => "",
    };
    Some(format!("{}, {}{sensor}", spaced(id), about.excited_by))
}

impl Diagnosis {
    /// What else each named effect could be, in words: which effects are mistaken for it, which explain nearly as much, and how far
    /// away the nearest ones are.
    pub fn alternatives(&self) -> Vec<String> {
        let of_effect = |(id, distances): (&String, &BTreeMap<String, f64>)| {
            let alike = self.equivalents.get(id).map_or(&[][..], Vec::as_slice);
            let others = alike.iter().filter(|other| *other != id);
            let is_mistaken = |other: &&String| {
                let far = distances.get(*other);
                far.is_none_or(|&far| far < DISTINGUISHABLE)
            };
            let (mistaken, close): (Vec<&String>, Vec<&String>) = others.partition(is_mistaken);
            let list = |ids: Vec<&String>| {
                let ids: Vec<String> = ids.into_iter().map(|id| spaced(id)).collect();
                ids.join(", ")
            };
            let mut told = Vec::new();
            if !mistaken.is_empty() {
                let all = [id].into_iter().chain(mistaken.iter().copied());
                let shown: Vec<String> = all.filter_map(|id| shown_by(id)).collect();
                let mistaken = list(mistaken);
                told.push(format!(
                    "These logs cannot tell {} from {mistaken}. What shows each: {}.",
                    spaced(id),
                    shown.join("; ")
                ));
            }
            if !close.is_empty() {
                told.push(format!(
                    "Nearly as much as by {} is explained by {}: what tells them apart is no more than the error of a model.",
                    spaced(id),
                    list(close)
                ));
            }
            if told.is_empty() {
                told.push(format!(
                    "Nothing else in the library does what {} does here.",
                    spaced(id)
                ));
            }
            let mut nearest: Vec<(&String, &f64)> = distances.iter().collect();
            nearest.sort_by(|a, b| a.1.total_cmp(b.1));
            let nearest: Vec<String> = nearest
                .into_iter()
                .take(NEAREST_TOLD)
                .map(|(id, far)| format!("{} {}", spaced(id), significant(*far, 2)))
                .collect();
            told.push(if nearest.is_empty() {
                "No other effect explains anything.".to_owned()
            } else {
                format!(
                    "Nearest, in standard deviations of the noise: {} (below {DISTINGUISHABLE} they are mistaken for each other).",
                    nearest.join(", ")
                )
            });
            told.join(" ")
        };
        self.distinguishability.iter().map(of_effect).collect()
    }
}
