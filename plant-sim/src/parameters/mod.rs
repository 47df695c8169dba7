//! Parameters of the plant, as they stand in a plant file.
//!
//! A plant file is TOML with the unit in every key. [`PARAMETERS`] is the one list of all keys with unit,
//! range and meaning; reading, writing, checking and fitting all go through it.

mod build;
mod consistency;
mod error;
mod read;
mod table;
mod units;
mod values;
mod write;

pub use error::{ParameterError, Problem};
pub use table::{PARAMETERS, ParameterSpec};
pub use values::{
    ArmatureParameters, ChamberParameters, CoilParameters, EcuParameters, FlowParameters,
    GasParameters, MagnetParameters, PA_PER_BAR, PlantParameters, RegulatingValveParameters,
};

use consistency::inconsistency;

/// The plant file shipped with the crate: the thesis model.
pub const NOMINAL_PLANT_TOML: &str = include_str!("../../models/nominal-plant.toml");

impl PlantParameters {
    /// The thesis model as shipped.
    pub fn nominal() -> Self {
        Self::from_toml(NOMINAL_PLANT_TOML, "nominal-plant.toml")
            .expect("the shipped plant file is checked by a test")
    }

    /// Reads a plant file; `name` is what errors call it.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, ParameterError> {
        read::read(text, name)
    }

    /// The parameters as a plant file, with units, ranges and provenance as comments.
    pub fn to_toml(&self) -> String {
        write::write(self)
    }

    /// The value of `section.key`, where the plant has it.
    pub fn get(&self, name: &str) -> Option<f64> {
        ParameterSpec::by_name(name).and_then(|spec| spec.value(self))
    }

    /// Sets `section.key` after checking its range; says `provenance` from now on.
    pub fn set(&mut self, name: &str, value: f64, provenance: &str) -> Result<(), ParameterError> {
        let refuse = |problem| ParameterError::new(name, vec![problem]);
        let spec = ParameterSpec::by_name(name).ok_or_else(|| {
            refuse(Problem::UnknownKey {
                line: 0,
                key: name.to_owned(),
                suggestion: None,
            })
        })?;
        if !spec.contains(value) {
            return Err(refuse(Problem::OutOfRange {
                line: 0,
                spec,
                value,
            }));
        }
        let mut changed = self.clone();
        if let Some(slot) = (spec.slot)(&mut changed) {
            *slot = value;
        }
        changed
            .provenance
            .insert(name.to_owned(), provenance.to_owned());
        if let Some(problem) = inconsistency(&changed) {
            return Err(refuse(problem));
        }
        *self = changed;
        Ok(())
    }
}
