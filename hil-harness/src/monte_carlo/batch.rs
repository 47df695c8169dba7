//! Batch: a scenario on many rigs.

use super::row::RigRow;
use super::settings::RunSettings;
use crate::controller_file;
use crate::operating_conditions::ConditionScatter;
use crate::requirement::Requirement;
use crate::rigs::{RigError, rig_verdict};
use crate::scenario::Scenario;

/// Scenario on many rigs of its plant's kind, and the requirements that judge it.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Scenario.
    pub scenario: Scenario,
    /// Requirements.
    pub requirement: Requirement,
    /// Scatter of the operating conditions.
    pub conditions: ConditionScatter,
    /// Number of rigs.
    pub rigs: u32,
}

/// Name of the setting with the number of rigs of the whole batch.
pub(super) const RIGS: &str = "number of rigs";

impl Batch {
    /// Runs one rig.
    ///
    /// # Errors
    /// Returns an error if a scattered value leaves the range of its parameter, or the scenario cannot be run.
    pub fn row(&self, rig: u32) -> Result<RigRow, RigError> {
        let verdict = rig_verdict(&self.scenario, &self.requirement, rig, self.conditions)?;
        Ok(RigRow::new(&verdict, &self.requirement))
    }

    /// Returns all that decides the rows.
    pub fn settings(&self) -> RunSettings {
        let Scenario {
            name,
            reference,
            duration_samples,
            plant,
            start_pressure_bar,
            controller,
            supervision,
            sensor_noise_mbar_rms,
            supply,
            seed,
        } = &self.scenario;
        let supply = supply.map(|supply| supply.to_string());
        RunSettings::new(
            [
                ("program version", env!("CARGO_PKG_VERSION").to_owned()),
                (RIGS, self.rigs.to_string()),
                ("seed", seed.to_string()),
                ("scenario", name.clone()),
                ("reference", reference.to_string()),
                ("duration in samples", duration_samples.to_string()),
                ("start pressure in bar", start_pressure_bar.to_string()),
                (
                    "sensor noise in mbar rms",
                    sensor_noise_mbar_rms.to_string(),
                ),
                ("supply voltage", supply.unwrap_or_default()),
                (
                    "scatter of the conditions",
                    format!("{:#?}", self.conditions),
                ),
                ("requirements", format!("{:#?}", self.requirement)),
                ("controller", controller_file::write(controller)),
                ("plant", plant.to_toml()),
                ("supervision", format!("{supervision:#?}")),
            ]
            .map(|(name, text)| (name.to_owned(), text)),
        )
    }
}
