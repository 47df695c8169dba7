//! Alternatives to each named effect, as sentences for the terminal, the report and the page.

use std::collections::BTreeMap;

use plant_sim::effects::{Effect, EntryPoint, by_id};

use super::Diagnosis;
use super::words::{significant, spaced};
use crate::diagnosis::verdict::DISTINGUISHABLE;

/// Number of nearest effects that are listed.
const NEAREST_LISTED: usize = 4;

impl Diagnosis {
    /// Returns one paragraph per named effect: the effects that are mistaken for it, those that explain nearly as much, and the distances
    /// of the nearest ones.
    pub fn alternatives(&self) -> Vec<String> {
        let of_effect = |(id, distances): (&String, &BTreeMap<String, f64>)| {
            let confused = self.confused_with(id, distances);
            format!("{confused} {}", nearest(distances))
        };
        self.distinguishability.iter().map(of_effect).collect()
    }

    /// Returns the effects that these logs cannot distinguish from `id`, and the excitation or sensor that can.
    fn confused_with(&self, id: &String, distances: &BTreeMap<String, f64>) -> String {
        let alike = self.equivalents.get(id).map_or(&[][..], Vec::as_slice);
        let others = alike.iter().filter(|other| *other != id);
        let is_mistaken = |other: &&String| {
            let distance = distances.get(*other);
            distance.is_none_or(|&distance| distance < DISTINGUISHABLE)
        };
        let (mistaken, close): (Vec<&String>, Vec<&String>) = others.partition(is_mistaken);
        let mut sentences = Vec::new();
        if !mistaken.is_empty() {
            let all = core::iter::once(id).chain(mistaken.iter().copied());
            let shown: Vec<String> = all.filter_map(|id| shown_by(id)).collect();
            sentences.push(format!(
                "These logs cannot tell {} from {}. Each of them shows in: {}.",
                spaced(id),
                list(&mistaken),
                shown.join("; ")
            ));
        }
        if !close.is_empty() {
            sentences.push(format!(
                "{} explains nearly as much as {}: the difference is no more than the error of a model.",
                capital(&list(&close)),
                spaced(id)
            ));
        }
        if sentences.is_empty() {
            sentences.push(format!(
                "No other effect of the library does what {} does here.",
                spaced(id)
            ));
        }
        sentences.join(" ")
    }
}

/// Returns the experiment that shows the effect `id`, or a sensor that shows it alone.
fn shown_by(id: &str) -> Option<String> {
    let Some(about) = by_id(id).map(Effect::about) else {
        return Some(format!(
            "{}, the excitation that the plant file states",
            spaced(id)
        ));
    };
    let sensor = match about.acts_on {
        EntryPoint::GasEnergy => ", or a logged gas temperature t_gas",
        EntryPoint::AirSupply => ", or a logged supply pressure p_sup",
        EntryPoint::Sensor => ", or a second sensor",
        _ => "",
    };
    Some(format!("{}, {}{sensor}", spaced(id), about.excited_by))
}

/// Returns the effects at the smallest `distances`, which are standard deviations of the noise.
fn nearest(distances: &BTreeMap<String, f64>) -> String {
    let mut nearest: Vec<(&String, &f64)> = distances.iter().collect();
    nearest.sort_by(|a, b| a.1.total_cmp(b.1));
    let listed: Vec<String> = nearest
        .into_iter()
        .take(NEAREST_LISTED)
        .map(|(id, distance)| format!("{} {}", spaced(id), significant(*distance, 2)))
        .collect();
    if listed.is_empty() {
        return "No other effect explains anything.".to_owned();
    }
    format!(
        "Nearest, in standard deviations of the noise: {} (below {DISTINGUISHABLE} they are mistaken for each other).",
        listed.join(", ")
    )
}

fn list(ids: &[&String]) -> String {
    let ids: Vec<String> = ids.iter().map(|id| spaced(id)).collect();
    ids.join(", ")
}

fn capital(text: &str) -> String {
    let mut text = text.to_owned();
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the alternatives to a chamber leak where these effects are its equivalents, at these distances.
    fn alternatives(equivalents: &[&str], distances: &[(&str, f64)]) -> String {
        let example = include_str!("../../../../docs/schema/diagnosis.example.json");
        let mut diagnosis: Diagnosis = serde_json::from_str(example).unwrap();
        let leak = || "chamber_leak".to_owned();
        let equivalents = equivalents.iter().map(|&id| id.to_owned());
        let distances = distances.iter().map(|&(id, far)| (id.to_owned(), far));
        diagnosis.equivalents =
            [(leak(), [leak()].into_iter().chain(equivalents).collect())].into();
        diagnosis.distinguishability = [(leak(), distances.collect())].into();
        diagnosis.alternatives().join(" ")
    }

    #[test]
    fn effects_that_a_decay_cannot_separate_come_with_what_separates_them() {
        let said = alternatives(
            &["sensor_offset", "gas_temperature"],
            &[("sensor_offset", 0.4), ("gas_temperature", 1.2)],
        );
        assert!(
            said.contains("cannot tell chamber leak from sensor offset, gas temperature"),
            "{said}"
        );
        assert!(
            said.contains("both valves shut for 5 s") && said.contains("t_gas"),
            "{said}"
        );
    }

    /// Defect seen: "Cannot tell A from B" stood beside a distance of 57.
    #[test]
    fn an_effect_that_is_far_away_is_not_said_to_be_mistaken() {
        let said = alternatives(&["sensor_offset"], &[("sensor_offset", 57.0)]);
        assert!(
            said.starts_with("Sensor offset explains nearly as much as chamber leak")
                && said.contains("sensor offset 57")
                && !said.contains("cannot tell"),
            "{said}"
        );
        assert!(alternatives(&[], &[]).starts_with("No other effect of the library"));
    }
}
