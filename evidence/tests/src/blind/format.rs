//! Common formats of the programs: paths of files, and sealed answers.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::reference_plant::catalogue::Kinship;

/// Version of the sealed answers.
pub const SCHEMA: &str = "retarder.blind-answer/1";

/// Folders of a draw.
#[derive(Debug, Clone)]
pub struct Folders(PathBuf);

impl Folders {
    /// Returns the folders within one folder.
    pub fn new(draw: impl Into<PathBuf>) -> Self {
        Self(draw.into())
    }

    /// Returns the folder of the bench logs.
    pub fn logs(&self) -> PathBuf {
        self.0.join("logs")
    }

    /// Returns a rig's log for training.
    pub fn id_log(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}-id.csv"))
    }

    /// Returns a rig's log for validation.
    pub fn check_log(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}-check.csv"))
    }

    /// Returns the folder of the answers.
    pub fn sealed(&self) -> PathBuf {
        self.0.join("sealed")
    }

    /// Returns the answer of a rig.
    pub fn answer(&self, rig: &str) -> PathBuf {
        self.sealed().join(format!("{rig}.json"))
    }

    /// Returns the plant file that a user would have of a field rig.
    pub fn plant(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}.toml"))
    }

    /// Returns the plate of a rig of another kind: what a user knows of it.
    pub fn plate(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}-plate.toml"))
    }

    /// Returns the folder with the errors of the true parameters of field rigs.
    pub fn truth(&self) -> PathBuf {
        self.0.join("truth")
    }

    /// Returns the file with the errors of the true parameters of a field rig.
    pub fn judged_truth(&self, rig: &str) -> PathBuf {
        self.truth().join(format!("{rig}.json"))
    }

    /// Returns the stage with the diagnosis of bench rigs, or the refinement of field rigs.
    pub fn found(&self) -> Stage {
        Stage(self.0.join("found"))
    }

    /// Returns the stage with the diagnosis of field rigs.
    pub fn named(&self) -> Stage {
        Stage(self.0.join("named"))
    }

    /// Returns the stage with the refined plants of field rigs with the named effects.
    pub fn fitted(&self) -> Stage {
        Stage(self.0.join("fitted"))
    }

    /// Returns the folder with the errors of models with one of two hidden effects.
    pub fn alone(&self) -> PathBuf {
        self.0.join("alone")
    }

    /// Returns the file with the errors of one effect on one rig.
    pub fn alone_with(&self, rig: &str, effect: &str) -> PathBuf {
        self.alone().join(format!("{rig}-{effect}.json"))
    }

    /// Returns the folder of the draw itself.
    pub fn root(&self) -> &Path {
        &self.0
    }
}

/// Folder of one run of the released command over the rigs of a draw.
#[derive(Debug, Clone)]
pub struct Stage(PathBuf);

impl Stage {
    /// Returns the folder itself.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Returns the finding on a rig, as JSON.
    pub fn finding(&self, rig: &str) -> PathBuf {
        self.0.join(format!("{rig}.json"))
    }

    /// Returns the output of a command that left no finding on a rig.
    pub fn failed(&self, rig: &str) -> PathBuf {
        self.0.join(format!("{rig}.failed"))
    }

    /// Returns the plant file that was written for a rig.
    pub fn plant(&self, rig: &str) -> PathBuf {
        self.0.join(format!("{rig}.toml"))
    }

    /// Returns the file with the time of each command (s) and its exit code, one line per command.
    pub fn times(&self) -> PathBuf {
        self.0.join("times.csv")
    }
}

/// Answer of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name of the rig, as in the names of its logs.
    pub rig: String,
    /// Kind of question.
    pub class: Class,
    /// Shortcoming of its logs, if they are poor.
    pub poor: Option<Poor>,
    /// Effects beyond the plain plant.
    pub hidden: Vec<Hidden>,
    /// Change of each signal on the check log by the hidden effects: rms in units of the noise, before any parameter is
    /// refitted.
    pub raw_excess: BTreeMap<String, f64>,
    /// Command profiles of the id log and the check log.
    pub profiles: [Profile; 2],
    /// Position of the rig within the scatter, in the order of `reference_plant::SCATTERED`.
    pub scatter: Vec<f64>,
}

/// Kind of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Plain plant with scatter.
    Plain,
    /// One effect of the library in the law of the textbook.
    Matched,
    /// One effect of the library in another law.
    Variant,
    /// Two effects of the library that act in different places.
    Two,
    /// One effect that the library does not have.
    Beyond,
}

/// Shortcoming of a poor log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Poor {
    /// Length of 10 to 20 s.
    Short,
    /// No sample in which both valves are off.
    NoHold,
    /// Three times the noise.
    Noisy,
    /// One row in 50 ms.
    Slow,
    /// No currents.
    PressureOnly,
    /// No pressure.
    CurrentsOnly,
}

impl Poor {
    /// All shortcomings.
    pub const ALL: [Self; 6] = [
        Self::Short,
        Self::NoHold,
        Self::Noisy,
        Self::Slow,
        Self::PressureOnly,
        Self::CurrentsOnly,
    ];
}

/// Command profile of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// List of a bench engineer: steps, holds, stairs, both valves, heating, then random commands.
    Bench,
    /// Random duty cycles with holds.
    Chance,
    /// Random duty cycles without holds.
    Restless,
    /// Trains of pulses of one PWM period.
    Pulses,
    /// A controller follows references.
    ClosedLoop,
}

/// Hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hidden {
    /// Id in the library, or the nearest name outside it.
    pub effect: String,
    /// Law in the reference plant.
    pub law: String,
    /// Relation of that law to the library.
    pub kinship: Kinship,
    /// Ids of the library that are physically the same: naming one of them is also right.
    pub same: Vec<String>,
    /// Size, and its unit.
    pub size: f64,
    /// Unit of the size.
    pub unit: String,
    /// Size relative to the one that changes the readings by about the noise.
    pub size_over_typical: f64,
    /// Position of the law's other parameters in their ranges, 0 to 1.
    pub shape: f64,
    /// Library parameter with the same meaning and its value, if there is one.
    pub parameter: Option<(String, f64)>,
}

impl Hidden {
    /// Returns whether the library has the effect, in this law or in another one.
    pub fn is_in_library(&self) -> bool {
        self.kinship != Kinship::Beyond
    }
}
