//! How well each value of a plant file is known, in words, and the plant file to start from, which asks for it.

use core::fmt::Write as _;

use plant_sim::PlantParameters;
use plant_sim::parameters::{Knowledge, ParameterSpec};

use super::nuisance::{first_file_spread, is_ordinary, leader_of, usual_spread};

/// How far fits may move a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Known {
    /// As the plant file states.
    Stated {
        /// The statement.
        knowledge: Knowledge,
        /// Least and largest value, in the unit of the parameter.
        within: (f64, f64),
    },
    /// The plant file states nothing of an ordinary parameter.
    Bare {
        /// Least and largest value for `diagnose` and `refine --add`; none if they take the value as exact.
        usual: Option<(f64, f64)>,
        /// Parameter in proportion with which they move it.
        together_with: Option<&'static str>,
        /// Least and largest value for an estimation.
        estimated: (f64, f64),
    },
    /// A size of an effect of the plant: fits move it anywhere in its physical range.
    Size,
    /// Any other value: exact.
    Exact,
}

/// Returns how well `plant` knows the parameter `name`, written `section.key`; none where the plant does not have it.
pub fn known(plant: &PlantParameters, name: &str) -> Option<Known> {
    let value = plant.get(name)?;
    let spec = plant.specs().find(|spec| spec.name() == name)?;
    if let Some(&knowledge) = plant.knowledge.get(name) {
        let within = knowledge.bounds(spec, value);
        return Some(Known::Stated { knowledge, within });
    }
    if spec.effect_id().is_some() {
        return Some(Known::Size);
    }
    let around = |half| Knowledge::Tolerance(half).bounds(spec, value);
    let leader = leader_of(name).filter(|leader| !is_exact(plant, leader));
    Some(match first_file_spread(name, value) {
        None => Known::Exact,
        Some(half) => Known::Bare {
            usual: usual_spread(name, value).map(around),
            together_with: leader,
            estimated: around(half),
        },
    })
}

/// Parameter that a state of the rig moves by more than a first plant file is wrong: the temperature of the winding.
const MOVED_BY_STATE: &str = "coil.resistance_20c_ohm";

/// Whether `value` may be the true one of the parameter `name` beside a first plant file: `plant` states nothing of it, and an estimation
/// would look for it there.
pub(super) fn may_be_beside_first_file(plant: &PlantParameters, name: &str, value: f64) -> bool {
    match known(plant, name).filter(|_| name != MOVED_BY_STATE) {
        Some(Known::Bare {
            estimated: (least, most),
            ..
        }) => (least..=most).contains(&value),
        _ => false,
    }
}

fn is_exact(plant: &PlantParameters, name: &str) -> bool {
    plant.knowledge.get(name) == Some(&Knowledge::Exact)
}

impl Known {
    /// What it means, for people; `unit` is that of the parameter.
    pub fn words(&self, unit: &str) -> String {
        let range = |(least, most): (f64, f64)| {
            let text = format!("{} to {} {unit}", brief(least), brief(most));
            text.trim_end().to_owned()
        };
        match *self {
            Self::Stated {
                knowledge: Knowledge::Exact,
                ..
            } => "exact, no fit moves it".to_owned(),
            Self::Stated { knowledge, within } => match knowledge {
                Knowledge::TolerancePct(percent) => {
                    format!("within {} %, {}", brief(percent), range(within))
                }
                Knowledge::Unknown => format!("unknown, {}", range(within)),
                _ => format!("within {}", range(within)),
            },
            Self::Bare {
                usual,
                together_with,
                estimated,
            } => {
                let diagnosed = match (usual, together_with) {
                    (Some(usual), _) => format!("usual tolerance of the part, {}", range(usual)),
                    (None, Some(leader)) => format!("in proportion with {leader}"),
                    (None, None) => "exact".to_owned(),
                };
                format!("{diagnosed}; for `refine` {}", range(estimated))
            }
            Self::Size => "size of an effect, every fit moves it".to_owned(),
            Self::Exact => "exact".to_owned(),
        }
    }

    /// Whether a fit may move the parameter.
    pub fn is_open(&self) -> bool {
        match self {
            Self::Stated { within, .. } => within.0 < within.1,
            Self::Bare { .. } | Self::Size => true,
            Self::Exact => false,
        }
    }
}

/// `value` with three significant digits.
fn brief(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-3..1e6).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// Head of a plant file to start from. Its examples are read by a test.
const HEAD: &str = "\
# A plant file to start from: the rig of the thesis. Write the values of your rig; docs/your-rig.md says where they stand
# in a datasheet.
#
# Say how well you know each value that has a comment `Known` above it. `retarder refine` estimates it from a log:
#   volume_m3 = 75e-6                                        a bare value: known as the comment above it says
#   volume_m3 = { value = 75e-6, exact = true }              measured, no fit moves it
#   volume_m3 = { value = 75e-6, tolerance_pct = 30 }        within 30 %
#   command_delay_s = { value = 15e-3, tolerance = 6e-3 }    within 6 ms, in the unit of the key
#   volume_m3 = { min = 40e-6, max = 120e-6 }                between these; a fit begins in the middle
#   volume_m3 = \"unknown\"                                    anywhere in the physical range
# Values without such a comment count as exact. A comment behind a value says where it comes from.
";

/// Returns the plant file `text` of `plant` with a head that explains how to state how well values are known, and above each
/// ordinary value that states nothing a comment that says what this means.
pub fn asking_plant_file(text: &str, plant: &PlantParameters) -> String {
    let mut asking = format!("{HEAD}\n");
    let mut section = "";
    for line in text.lines() {
        if let Some(title) = line.strip_prefix('[') {
            section = title.split(']').next().unwrap_or_default();
        }
        let key = line.split_once('=').map_or("", |(key, _)| key.trim());
        let name = format!("{section}.{key}");
        if let Some(spec) = ParameterSpec::by_name(&name).filter(|_| is_ordinary(&name))
            && let Some(known @ Known::Bare { .. }) = known(plant, &name)
        {
            let _ = writeln!(asking, "# Known: {}", known.words(spec.unit));
        }
        asking += line;
        asking.push('\n');
    }
    asking
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::{EffectSetting, by_id};
    use plant_sim::parameters::NOMINAL_PLANT_TOML;

    use super::*;
    use crate::diagnosis::nuisance::ordinary_names;

    fn words(plant: &PlantParameters, name: &str) -> String {
        let spec = ParameterSpec::by_name(name).unwrap();
        known(plant, name).unwrap().words(spec.unit)
    }

    /// A first file may have an orifice 25 % too wide. A file that states a tolerance is no first one, and a coil is warm.
    #[test]
    fn a_first_plant_file_may_be_wrong_by_as_much_as_an_estimation_looks() {
        let mut plant = PlantParameters::nominal();
        let discharge = "flow.discharge_fill";
        assert!(may_be_beside_first_file(&plant, discharge, 0.71));
        assert!(!may_be_beside_first_file(&plant, discharge, 0.3));
        assert!(!may_be_beside_first_file(&plant, MOVED_BY_STATE, 91.8));
        let stated = Knowledge::TolerancePct(50.0);
        plant.knowledge.insert(discharge.to_owned(), stated);
        assert!(!may_be_beside_first_file(&plant, discharge, 0.71));
    }

    #[test]
    fn every_statement_has_its_words() {
        let mut plant = PlantParameters::nominal();
        let volume = "chamber.volume_m3";
        assert_eq!(
            words(&plant, volume),
            "usual tolerance of the part, 7.2e-5 to 7.8e-5 m3; for `refine` 4.5e-5 to 1.05e-4 m3"
        );
        for (knowledge, expected) in [
            (Knowledge::Exact, "exact, no fit moves it"),
            (
                Knowledge::TolerancePct(30.0),
                "within 30 %, 5.25e-5 to 9.75e-5 m3",
            ),
            (Knowledge::Tolerance(1e-5), "within 6.5e-5 to 8.5e-5 m3"),
            (Knowledge::Range(4e-5, 1.2e-4), "within 4e-5 to 1.2e-4 m3"),
            (Knowledge::Unknown, "unknown, 1e-7 to 1 m3"),
        ] {
            plant.knowledge.insert(volume.to_owned(), knowledge);
            assert_eq!(words(&plant, volume), expected);
        }
        assert_eq!(
            words(&plant, "coil.inductance_open_h"),
            "in proportion with coil.inductance_closed_h; for `refine` 0.288 to 0.672 H"
        );
        assert_eq!(
            words(&plant, "armature.mass_kg"),
            "exact; for `refine` 0.003 to 0.007 kg"
        );
        assert_eq!(words(&plant, "armature.stroke_m"), "exact");
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
        let area = "effects.chamber_leak.area_m2";
        assert_eq!(known(&plant, area), None);
        assert_eq!(
            words(&plant.with_effect(leak), area),
            "size of an effect, every fit moves it"
        );
    }

    /// Goal: a person who follows the head of the file writes what is read. Method: its examples, put into the file.
    #[test]
    fn the_examples_of_the_head_are_read() {
        let plant = PlantParameters::nominal();
        let asking = asking_plant_file(NOMINAL_PLANT_TOML, &plant);
        let same = PlantParameters::from_toml(&asking, "asking").unwrap();
        assert_eq!(same, plant);
        let examples = HEAD.lines().filter_map(|line| line.strip_prefix("#   "));
        let mut stated = 0;
        for example in examples {
            let example = example.split("   ").next().unwrap();
            let (key, _) = example.split_once(" = ").unwrap();
            let lines = asking.lines().map(|line| {
                if line.starts_with(&format!("{key} = ")) {
                    example
                } else {
                    line
                }
            });
            let text = lines.collect::<Vec<_>>().join("\n");
            let read = PlantParameters::from_toml(&text, "example").unwrap();
            stated += read.knowledge.len();
        }
        assert_eq!(stated, 5);
    }

    #[test]
    fn the_file_to_start_from_asks_for_every_ordinary_value_and_for_nothing_that_is_stated() {
        let mut plant = PlantParameters::nominal();
        let asked = |plant: &PlantParameters| {
            let file = asking_plant_file(&plant.to_toml(), plant);
            file.matches("# Known: ").count()
        };
        let file = plant.to_toml();
        // Values of other kinds of valves and chambers are absent, and so is the offset of a gauge where it is 0.
        let is_in_file = |name: &&str| {
            let key = name.split_once('.').map_or(*name, |(_, key)| key);
            plant.get(name).is_some() && file.contains(&format!("\n{key} = "))
        };
        let ordinary = ordinary_names().filter(is_in_file).count();
        assert_eq!(ordinary, 13);
        assert_eq!(asked(&plant), ordinary);
        plant
            .knowledge
            .insert("chamber.volume_m3".to_owned(), Knowledge::Unknown);
        assert_eq!(asked(&plant), ordinary - 1);
    }
}
