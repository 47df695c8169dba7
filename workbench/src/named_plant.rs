//! Plants of a project for the closed loop: the current one, and the plain one beside it.

use hil_harness::scenario::missing_part;
use plant_sim::PlantParameters;

use crate::project::Project;
use crate::refusal::Refusal;

/// Plant of a closed loop.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedPlant {
    /// `plain` or `refined` if there are two, otherwise `plant`.
    pub(crate) role: &'static str,
    pub(crate) name: String,
    pub(crate) parameters: PlantParameters,
}

impl NamedPlant {
    /// Returns the plants of a project: the current one, and before it the plain one if that differs.
    pub(crate) fn all_of(project: &Project) -> Result<Vec<Self>, Refusal> {
        let now = &project.plant;
        let parameters = now.parameters()?;
        let mut plants = Vec::new();
        if let Some((name, plain)) = plain(project, &parameters)? {
            plants.push(Self::new("plain", name, plain)?);
        }
        let role = if plants.is_empty() {
            "plant"
        } else {
            "refined"
        };
        plants.push(Self::new(role, now.name.clone(), parameters)?);
        Ok(plants)
    }

    fn new(role: &'static str, name: String, parameters: PlantParameters) -> Result<Self, Refusal> {
        match missing_part(&parameters) {
            Some(part) => Err(Refusal::value(format!(
                "{name}: the plant has no {part}; the loop needs both valves and the chamber"
            ))),
            None => Ok(Self {
                role,
                name,
                parameters,
            }),
        }
    }
}

/// Returns the plant before its refinement: as opened, or without its effects if it was opened with them.
fn plain(
    project: &Project,
    parameters: &PlantParameters,
) -> Result<Option<(String, PlantParameters)>, Refusal> {
    let (now, history) = (&project.plant, &project.history);
    if history.is_of(now) && history.first().plant != *now {
        let opened = &history.first().plant;
        return Ok(Some((opened.name.clone(), opened.parameters()?)));
    }
    let effects = &parameters.effects;
    if effects.is_empty() {
        return Ok(None);
    }
    let without = effects.iter().fold(parameters.clone(), |plant, effect| {
        plant.without_effect(effect.id())
    });
    Ok(Some((format!("{} without effects", now.name), without)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_with_effects_is_run_beside_itself_without_them() {
        let mut project = Project::default();
        assert_eq!(NamedPlant::all_of(&project).unwrap().len(), 1);
        project.plant.toml += "\n[effects.chamber_leak]\nvariant = \"orifice\"\narea_m2 = 2e-8\n";
        let plants = NamedPlant::all_of(&project).unwrap();
        let roles: Vec<_> = plants.iter().map(|plant| plant.role).collect();
        assert_eq!(roles, ["plain", "refined"]);
        assert_eq!(plants[0].parameters.effects.len(), 0);
        assert_eq!(plants[1].parameters.effects.len(), 1);
    }
}
