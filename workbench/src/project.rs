//! Project: logs with their mappings and offsets, a plant, and the limits of the comparison.

use std::collections::BTreeMap;

use model_lab::CompareOptions;
use recording::Recording;
use serde::{Deserialize, Serialize};

use crate::calculated::Calculated;
use crate::closed_loop::ClosedLoop;
use crate::history::History;
use crate::names::LogHash;
pub(crate) use crate::plant_file::PlantFile;
use crate::refusal::Refusal;
use crate::tolerance::Tolerance;

/// Name and version of the project file.
pub(crate) const PROJECT_SCHEMA: &str = "retarder.project/1";

/// Largest number of logs in a project.
pub(crate) const LOGS_MAX: usize = 32;

/// Project, stored over a restart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Project {
    pub(crate) schema: String,
    pub(crate) logs: Vec<LogEntry>,
    pub(crate) plant: PlantFile,
    pub(crate) strictness: AcceptanceLimits,
    /// Mappings by the header that they were made for, to be proposed again.
    pub(crate) mappings: BTreeMap<String, String>,
    /// History of the plant; absent in files of earlier versions.
    #[serde(default)]
    pub(crate) history: History,
    /// Settings of the closed loop; absent in files of earlier versions.
    #[serde(default)]
    pub(crate) closed_loop: ClosedLoop,
    /// Calculated channels; absent in files of earlier versions.
    #[serde(default)]
    pub(crate) calculated: Vec<Calculated>,
}

/// Log of the project.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LogEntry {
    /// Number within the project.
    pub(crate) number: u32,
    /// File name for display. It is not a path on the disk.
    pub(crate) name: String,
    pub(crate) file: LogHash,
    /// Mapping, TOML.
    pub(crate) mapping: Option<String>,
    /// Offset added to the times of the log (s) when it is shown with others.
    pub(crate) offset_s: f64,
}

/// Acceptance limits of signals; see [`CompareOptions`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AcceptanceLimits {
    pub(crate) allowed_noise_multiples: f64,
    /// Largest rms error of a signal within tolerance.
    pub(crate) tolerances: BTreeMap<String, f64>,
    /// Bands around single samples; absent in files of earlier versions.
    #[serde(default)]
    pub(crate) bands: BTreeMap<String, Tolerance>,
}

impl Default for AcceptanceLimits {
    fn default() -> Self {
        let options = CompareOptions::default();
        Self {
            allowed_noise_multiples: options.allowed_noise_multiples,
            tolerances: options.tolerances,
            bands: BTreeMap::new(),
        }
    }
}

impl AcceptanceLimits {
    /// Refuses invalid limits.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let is_positive = |value: f64| value > 0.0 && value.is_finite();
        if !is_positive(self.allowed_noise_multiples) {
            return Err(Refusal::value(format!(
                "the allowed multiple of the noise floor is {}; enter a value above 0",
                self.allowed_noise_multiples
            )));
        }
        let mut tolerances = self.tolerances.iter();
        if let Some((name, value)) = tolerances.find(|(_, value)| !is_positive(**value)) {
            return Err(Refusal::value(format!(
                "the rms limit of {name} is {value}; enter a value above 0"
            )));
        }
        let mut bands = self.bands.iter();
        bands.try_for_each(|(name, band)| band.check(name))
    }

    /// Returns whether a comparison that was made with `before` has another verdict with these limits.
    pub(crate) fn judges_otherwise(&self, before: &Self) -> bool {
        self.allowed_noise_multiples != before.allowed_noise_multiples
            || self.tolerances != before.tolerances
    }

    /// Returns the options for `log`; tolerances of signals that it lacks are for other logs of the project.
    pub(crate) fn options_for(&self, log: &Recording) -> CompareOptions {
        let tolerances = self.tolerances.iter();
        CompareOptions {
            allowed_noise_multiples: self.allowed_noise_multiples,
            tolerances: tolerances
                .filter(|(name, _)| log.signal(name).is_some())
                .map(|(name, value)| (name.clone(), *value))
                .collect(),
            ..CompareOptions::default()
        }
    }
}

impl Default for Project {
    fn default() -> Self {
        Self {
            schema: PROJECT_SCHEMA.to_owned(),
            logs: Vec::new(),
            plant: PlantFile::nominal(),
            strictness: AcceptanceLimits::default(),
            mappings: BTreeMap::new(),
            history: History::default(),
            closed_loop: ClosedLoop::default(),
            calculated: Vec::new(),
        }
    }
}

impl Project {
    /// Adds a log and returns its number.
    pub(crate) fn add(&mut self, name: String, file: LogHash, mapping: Option<String>) -> u32 {
        let number = self.logs.iter().map(|log| log.number).max().unwrap_or(0) + 1;
        self.logs.push(LogEntry {
            number,
            name,
            file,
            mapping,
            offset_s: 0.0,
        });
        number
    }

    pub(crate) fn log(&self, number: u32) -> Result<&LogEntry, Refusal> {
        self.logs
            .iter()
            .find(|log| log.number == number)
            .ok_or_else(|| Refusal::not_found("log"))
    }

    pub(crate) fn log_mut(&mut self, number: u32) -> Result<&mut LogEntry, Refusal> {
        self.logs
            .iter_mut()
            .find(|log| log.number == number)
            .ok_or_else(|| Refusal::not_found("log"))
    }
}
