//! What the programs agree on: where files lie, and how a sealed answer is written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::reference_plant::catalogue::Kinship;

/// Version of the sealed answers.
pub const SCHEMA: &str = "retarder.blind-answer/1";

/// The folders of a draw.
#[derive(Debug, Clone)]
pub struct Folders(PathBuf);

impl Folders {
    /// Those in one folder.
    pub fn new(draw: impl Into<PathBuf>) -> Self {
        Self(draw.into())
    }

    /// The bench logs.
    pub fn logs(&self) -> PathBuf {
        self.0.join("logs")
    }

    /// The log of a rig that is for finding and fitting.
    pub fn id_log(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}-id.csv"))
    }

    /// The log of a rig that is held out.
    pub fn check_log(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}-check.csv"))
    }

    /// The answers.
    pub fn sealed(&self) -> PathBuf {
        self.0.join("sealed")
    }

    /// The answer of a rig.
    pub fn answer(&self, rig: &str) -> PathBuf {
        self.sealed().join(format!("{rig}.json"))
    }

    /// The plant file that a person would have of a field rig.
    pub fn plant(&self, rig: &str) -> PathBuf {
        self.logs().join(format!("{rig}.toml"))
    }

    /// What the true parameters of field rigs leave.
    pub fn truth(&self) -> PathBuf {
        self.0.join("truth")
    }

    /// What the true parameters of a field rig leave.
    pub fn judged_truth(&self, rig: &str) -> PathBuf {
        self.truth().join(format!("{rig}.json"))
    }

    /// The diagnosis of bench rigs, the refinement of field rigs.
    pub fn found(&self) -> Stage {
        Stage(self.0.join("found"))
    }

    /// The diagnosis of field rigs.
    pub fn named(&self) -> Stage {
        Stage(self.0.join("named"))
    }

    /// The refined plants of field rigs with the named effects.
    pub fn fitted(&self) -> Stage {
        Stage(self.0.join("fitted"))
    }

    /// What a model with one of two hidden effects leaves.
    pub fn alone(&self) -> PathBuf {
        self.0.join("alone")
    }

    /// The same of one effect on one rig.
    pub fn alone_with(&self, rig: &str, effect: &str) -> PathBuf {
        self.alone().join(format!("{rig}-{effect}.json"))
    }

    /// The folder of the draw itself.
    pub fn root(&self) -> &Path {
        &self.0
    }
}

/// Folder of one run of the released command over the rigs of a draw.
#[derive(Debug, Clone)]
pub struct Stage(PathBuf);

impl Stage {
    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Finding on a rig, as JSON.
    pub fn finding(&self, rig: &str) -> PathBuf {
        self.0.join(format!("{rig}.json"))
    }

    /// Output of a command that left no finding on a rig.
    pub fn failed(&self, rig: &str) -> PathBuf {
        self.0.join(format!("{rig}.failed"))
    }

    /// Plant file that was written for a rig.
    pub fn plant(&self, rig: &str) -> PathBuf {
        self.0.join(format!("{rig}.toml"))
    }

    /// Time of each command (s) and its exit code, one line a command.
    pub fn times(&self) -> PathBuf {
        self.0.join("times.csv")
    }
}

/// What a rig hides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name of the rig, as in the names of its logs.
    pub rig: String,
    /// Which kind of question it is.
    pub class: Class,
    /// What its logs lack, in a poor one.
    pub poor: Option<Poor>,
    /// What it has beyond the plain plant.
    pub hidden: Vec<Hidden>,
    /// How much the hidden effects change each signal on the check log: rms in units of the noise, before any parameter
    /// is refitted.
    pub raw_excess: BTreeMap<String, f64>,
    /// How the id log and the check log were commanded.
    pub profiles: [Profile; 2],
    /// Where the rig lies within the scatter, in the order of `reference_plant::SCATTERED`.
    pub scatter: Vec<f64>,
}

/// Kinds of rigs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// The plain plant with scatter.
    Plain,
    /// One effect of the library in its textbook's law.
    Matched,
    /// One effect of the library in another law.
    Variant,
    /// Two effects of the library that act in different places.
    Two,
    /// One effect that the library does not have.
    Beyond,
}

/// What a poor log lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Poor {
    /// 10 to 20 s long.
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
    /// All kinds.
    pub const ALL: [Self; 6] = [
        Self::Short,
        Self::NoHold,
        Self::Noisy,
        Self::Slow,
        Self::PressureOnly,
        Self::CurrentsOnly,
    ];
}

/// How a log is commanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// A bench engineer's list: steps, holds, stairs, both valves, heating, then some chance.
    Bench,
    /// Chance: one duty cycle after the other, with holds.
    Chance,
    /// Chance without holds.
    Restless,
    /// Trains of pulses of one PWM period.
    Pulses,
    /// A controller follows references.
    ClosedLoop,
}

/// One hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hidden {
    /// Id of the library, or the nearest name of its own.
    pub effect: String,
    /// Its law in the reference plant.
    pub law: String,
    /// Relation of that law to the library.
    pub kinship: Kinship,
    /// Ids of the library that are physically the same thing: naming one of them is right as well.
    pub same: Vec<String>,
    /// Size, and its unit.
    pub size: f64,
    /// Unit of the size.
    pub unit: String,
    /// Size over that which changes the readings by about the noise.
    pub size_over_typical: f64,
    /// Where the law's other parameters lie in their ranges, 0 to 1.
    pub shape: f64,
    /// The library's parameter that means the same, and its value, where there is one.
    pub parameter: Option<(String, f64)>,
}

impl Hidden {
    /// Whether the library has the effect, in this law or in another one.
    pub fn is_in_library(&self) -> bool {
        self.kinship != Kinship::Beyond
    }
}
