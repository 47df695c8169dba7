//! Plant file with its name, as stored in a project.

use plant_sim::PlantParameters;
use plant_sim::parameters::NOMINAL_PLANT_TOML;
use serde::{Deserialize, Serialize};

use crate::refusal::Refusal;

/// Plant file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlantFile {
    pub(crate) name: String,
    pub(crate) toml: String,
}

impl PlantFile {
    pub(crate) fn nominal() -> Self {
        Self {
            name: "nominal-plant.toml".to_owned(),
            toml: NOMINAL_PLANT_TOML.to_owned(),
        }
    }

    pub(crate) fn parameters(&self) -> Result<PlantParameters, Refusal> {
        Ok(PlantParameters::from_toml(&self.toml, &self.name)?)
    }
}
