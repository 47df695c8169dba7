//! Freeing and fixing of the parameters of a plant for a fit.

use plant_sim::PlantParameters;
use plant_sim::parameters::Knowledge;

use super::nuisance::{first_file_spread, ordinary_names};

/// Name that stands for all ordinary parameters.
const ALL: &str = "all";

/// Reason why a parameter can be neither freed nor fixed, nor determined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnowledgeError {
    /// No parameter and no table has this name.
    #[error(
        "the plant has no parameter or table `{name}`; write a key such as `{example}`, a table such as `coil`, or `all`; \
         `retarder parameters` lists the keys"
    )]
    Unknown {
        /// Name that was given.
        name: String,
        /// Name that exists.
        example: &'static str,
    },
    /// A range is given for more than one parameter.
    #[error("a range needs one parameter, not `{name}`; write `section.key={low}..{high}`")]
    RangeOfMany {
        /// Name that was given.
        name: String,
        /// Lower end of the range.
        low: f64,
        /// Upper end of the range.
        high: f64,
    },
    /// The range is empty or exceeds the possible values of the parameter.
    #[error(
        "`{name}` = {low}..{high} is no range of it: the lower end comes first, and both lie in {least} to {most} {unit}"
    )]
    Range {
        /// Name of the parameter.
        name: String,
        /// Lower end of the range.
        low: f64,
        /// Upper end of the range.
        high: f64,
        /// Least possible value.
        least: f64,
        /// Largest possible value.
        most: f64,
        /// Unit of the parameter.
        unit: &'static str,
    },
    /// The tolerance is negative or not finite.
    #[error("`{name}`: a tolerance of {width} is none; state 0 or more")]
    Tolerance {
        /// Name of the parameter.
        name: String,
        /// Tolerance that was given, % or in the unit of the parameter.
        width: f64,
    },
}

/// States in `plant` how well the value of the parameter `name` is known; without `knowledge`, it becomes a bare value. A value outside of a
/// range moves to its nearer end.
///
/// # Errors
/// [`KnowledgeError`]; the plant is then unchanged.
pub fn state(
    plant: &mut PlantParameters,
    name: &str,
    knowledge: Option<Knowledge>,
) -> Result<(), KnowledgeError> {
    if plant.get(name).is_none() {
        return Err(unknown(name));
    }
    match knowledge {
        None => {
            plant.knowledge.remove(name);
        }
        Some(Knowledge::Range(low, high)) => return free_within(plant, name, low, high),
        Some(Knowledge::TolerancePct(width) | Knowledge::Tolerance(width))
            if !(width >= 0.0 && width.is_finite()) =>
        {
            let name = name.to_owned();
            return Err(KnowledgeError::Tolerance { name, width });
        }
        Some(knowledge) => {
            plant.knowledge.insert(name.to_owned(), knowledge);
        }
    }
    Ok(())
}

fn unknown(name: &str) -> KnowledgeError {
    KnowledgeError::Unknown {
        name: name.to_owned(),
        example: "chamber.volume_m3",
    }
}

/// Frees `what` in fits: a parameter `section.key`, the ordinary parameters of a table such as `coil`, or `all` ordinary parameters. They
/// may move within `range`. Without a range, an ordinary parameter may move as far as a first plant file may be wrong, and any other one
/// within its physical range.
///
/// # Errors
/// [`KnowledgeError`]; the plant is then unchanged.
pub fn free(
    plant: &mut PlantParameters,
    what: &str,
    range: Option<(f64, f64)>,
) -> Result<(), KnowledgeError> {
    let names = named(plant, what)?;
    if let Some((low, high)) = range {
        let [name] = &names[..] else {
            let name = what.to_owned();
            return Err(KnowledgeError::RangeOfMany { name, low, high });
        };
        return free_within(plant, name, low, high);
    }
    for name in names {
        let value = plant.get(&name).unwrap_or_default();
        let knowledge =
            first_file_spread(&name, value).map_or(Knowledge::Unknown, Knowledge::Tolerance);
        plant.knowledge.insert(name, knowledge);
    }
    Ok(())
}

/// States for every ordinary parameter without a statement in `plant` that it may be as wrong as in a first plant file.
pub(super) fn state_first_file(plant: &mut PlantParameters) {
    for name in ordinary_names() {
        let Some(value) = plant
            .get(name)
            .filter(|_| !plant.knowledge.contains_key(name))
        else {
            continue;
        };
        if let Some(half) = first_file_spread(name, value) {
            plant
                .knowledge
                .insert(name.to_owned(), Knowledge::Tolerance(half));
        }
    }
}

fn free_within(
    plant: &mut PlantParameters,
    name: &str,
    low: f64,
    high: f64,
) -> Result<(), KnowledgeError> {
    let spec = plant.any_spec(name).expect("a name of the plant");
    let (least, most) = spec.range;
    if !(low < high && low >= least && high <= most) {
        return Err(KnowledgeError::Range {
            name: name.to_owned(),
            low,
            high,
            least,
            most,
            unit: spec.unit,
        });
    }
    let value = plant.get(name).unwrap_or(low);
    spec.put(plant, value.clamp(low, high));
    plant
        .knowledge
        .insert(name.to_owned(), Knowledge::Range(low, high));
    Ok(())
}

/// Fixes `what`, named as for [`free`], in fits.
///
/// # Errors
/// [`KnowledgeError::Unknown`].
pub fn fix(plant: &mut PlantParameters, what: &str) -> Result<(), KnowledgeError> {
    for name in named(plant, what)? {
        plant.knowledge.insert(name, Knowledge::Exact);
    }
    Ok(())
}

/// Returns the parameters that `what` names: one, the ordinary ones of a table, or all ordinary ones.
///
/// # Errors
/// [`KnowledgeError::Unknown`].
pub(super) fn named(plant: &PlantParameters, what: &str) -> Result<Vec<String>, KnowledgeError> {
    if plant.get(what).is_some() {
        return Ok(vec![what.to_owned()]);
    }
    let is_meant =
        |name: &&str| what == ALL || name.split_once('.').is_some_and(|(table, _)| table == what);
    let names: Vec<String> = ordinary_names()
        .filter(is_meant)
        .filter(|name| {
            let value = plant.get(name);
            value.is_some_and(|value| first_file_spread(name, value).is_some())
        })
        .map(str::to_owned)
        .collect();
    if names.is_empty() {
        return Err(unknown(what));
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_a_table_or_all_can_be_freed_and_fixed() {
        let mut plant = PlantParameters::nominal();
        free(&mut plant, "coil", None).unwrap();
        let freed: Vec<&str> = plant.knowledge.keys().map(String::as_str).collect();
        assert_eq!(
            freed,
            [
                "coil.inductance_closed_h",
                "coil.inductance_open_h",
                "coil.resistance_20c_ohm"
            ]
        );
        fix(&mut plant, "coil.resistance_20c_ohm").unwrap();
        assert_eq!(plant.knowledge["coil.resistance_20c_ohm"], Knowledge::Exact);
        free(&mut plant, "armature.stroke_m", None).unwrap();
        assert_eq!(plant.knowledge["armature.stroke_m"], Knowledge::Unknown);
        free(&mut plant, "all", None).unwrap();
        // 14 values of a rig with coils and a stiff chamber, and the stroke.
        assert_eq!(plant.knowledge.len(), 15);
    }

    #[test]
    fn a_range_moves_the_value_into_it() {
        let mut plant = PlantParameters::nominal();
        free(&mut plant, "chamber.volume_m3", Some((80e-6, 120e-6))).unwrap();
        assert_eq!(plant.chamber.volume_m3, 80e-6);
        assert_eq!(
            plant.knowledge["chamber.volume_m3"],
            Knowledge::Range(80e-6, 120e-6)
        );
    }

    #[test]
    fn what_cannot_be_freed_is_refused_with_what_can() {
        let mut plant = PlantParameters::nominal();
        let mut refused = |what, range| free(&mut plant, what, range).unwrap_err().to_string();
        assert!(refused("chamber.volume", None).contains("`chamber.volume_m3`"));
        assert!(refused("coil", Some((1.0, 2.0))).contains("`section.key=1..2`"));
        let empty = refused("chamber.volume_m3", Some((2e-6, 1e-6)));
        assert!(empty.contains("in 0.0000001 to 1 m3"), "{empty}");
        assert_eq!(plant, PlantParameters::nominal());
    }

    #[test]
    fn a_statement_is_made_replaced_and_taken_back() {
        let mut plant = PlantParameters::nominal();
        let volume = "chamber.volume_m3";
        for knowledge in [
            Knowledge::Exact,
            Knowledge::TolerancePct(5.0),
            Knowledge::Range(6e-5, 9e-5),
            Knowledge::Unknown,
        ] {
            state(&mut plant, volume, Some(knowledge)).unwrap();
            assert_eq!(plant.knowledge.get(volume), Some(&knowledge));
        }
        state(&mut plant, volume, None).unwrap();
        assert_eq!(plant, PlantParameters::nominal());
        for (name, knowledge, says) in [
            (
                "chamber.volume",
                Knowledge::Exact,
                "no parameter or table `chamber.volume`",
            ),
            (
                volume,
                Knowledge::Range(9e-5, 6e-5),
                "the lower end comes first",
            ),
            (
                volume,
                Knowledge::TolerancePct(-5.0),
                "a tolerance of -5 is none",
            ),
            (
                volume,
                Knowledge::TolerancePct(f64::NAN),
                "a tolerance of NaN is none",
            ),
        ] {
            let refused = state(&mut plant, name, Some(knowledge)).unwrap_err();
            assert!(refused.to_string().contains(says), "{refused}");
            assert_eq!(plant, PlantParameters::nominal());
        }
    }
}
