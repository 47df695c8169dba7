//! Problems of a plant file, and how to correct them.

use core::fmt;

use super::edited_tables::edited;
use super::names::{CHAMBER, VALVES};
use super::parts::Part;
use super::table::sections;
use super::units::plausible_unit;
use crate::description::{About, EFFECTS, ParameterSpec};
use crate::own_effects::Reason;
use crate::toml_file::{FileError, FileProblem, Unreadable, brief};

/// All problems of one plant file.
pub type ParameterError = FileError<Problem>;

/// One problem; lines count from 1, and 0 means that the problem has no line.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "the variants' sentences name the fields")]
pub enum Problem {
    /// The file is too large or not TOML.
    Unreadable(Unreadable),
    /// The table does not exist.
    UnknownSection { line: usize, section: String },
    /// The table is not one of those that are edited as a text of their own.
    NotEdited { line: usize, section: String },
    /// The effect does not exist; `nearest` is the name that was probably meant.
    UnknownEffect {
        line: usize,
        id: String,
        nearest: Option<&'static str>,
    },
    /// The law of the effect has no such form.
    UnknownVariant {
        line: usize,
        effect: &'static About,
        found: String,
    },
    /// The key does not exist; `suggestion` is the line to write instead.
    UnknownKey {
        line: usize,
        key: String,
        suggestion: Option<String>,
    },
    /// A required key is missing.
    MissingKey { spec: &'static ParameterSpec },
    /// A datasheet file omits a value that a part of the rig needs.
    MissingValue {
        key: &'static str,
        range: (f64, f64),
        about: &'static str,
        /// Keys from which the value follows.
        instead: Option<&'static str>,
    },
    /// Two keys of a datasheet file give the same value.
    GivenTwice { line: usize, key: &'static str },
    /// A value of a datasheet file is outside its range, in the unit of its key.
    ValueOutOfRange {
        line: usize,
        key: &'static str,
        value: f64,
        range: (f64, f64),
    },
    /// The value has another type than expected.
    WrongType {
        line: usize,
        key: String,
        found: &'static str,
        expected: &'static str,
    },
    /// The value is outside its range.
    OutOfRange {
        line: usize,
        spec: &'static ParameterSpec,
        value: f64,
    },
    /// The word is not one of the choices.
    UnknownChoice {
        line: usize,
        key: String,
        found: String,
        choices: Vec<&'static str>,
    },
    /// A value of the definition of a user's own effect is refused.
    OwnEffect {
        line: usize,
        key: String,
        reason: Reason,
    },
    /// The plant omits the part that the parameter describes.
    AbsentPart {
        line: usize,
        spec: &'static ParameterSpec,
    },
    /// The plant omits the table of the parameter.
    AbsentSection { spec: &'static ParameterSpec },
    /// The plant omits the part on which the effect acts.
    NothingToActOn { effect: &'static About, part: Part },
    /// Values exclude each other.
    Inconsistent { key: &'static str, rule: String },
}

impl Problem {
    /// Returns the line in the file, from 1; `None` if the problem has no line.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Unreadable(unreadable) => unreadable.line(),
            Self::UnknownSection { line, .. }
            | Self::NotEdited { line, .. }
            | Self::UnknownKey { line, .. }
            | Self::UnknownEffect { line, .. }
            | Self::UnknownVariant { line, .. }
            | Self::AbsentPart { line, .. }
            | Self::WrongType { line, .. }
            | Self::OutOfRange { line, .. }
            | Self::ValueOutOfRange { line, .. }
            | Self::GivenTwice { line, .. }
            | Self::OwnEffect { line, .. }
            | Self::UnknownChoice { line, .. } => Some(*line).filter(|&line| line > 0),
            Self::MissingKey { .. }
            | Self::MissingValue { .. }
            | Self::AbsentSection { .. }
            | Self::NothingToActOn { .. }
            | Self::Inconsistent { .. } => None,
        }
    }
}

impl FileProblem for Problem {
    fn line(&self) -> Option<usize> {
        self.line()
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(unreadable) => write!(f, "{unreadable}"),
            Self::UnknownSection { section, .. } => write!(
                f,
                "unknown table [{section}]; a plant file has the tables {}",
                sections().join(", ")
            ),
            Self::NotEdited { section, .. } => write!(
                f,
                "`[{section}]` is not edited here; write only {}",
                edited().join(", ")
            ),
            Self::UnknownEffect { id, nearest, .. } => {
                write!(f, "unknown effect [effects.{id}]")?;
                match nearest {
                    Some(nearest) => write!(f, "; write `[effects.{nearest}]`"),
                    None => write!(
                        f,
                        "; remove it, or list the known ones with `retarder parameters`"
                    ),
                }
            }
            Self::UnknownVariant { effect, found, .. } => {
                let names: Vec<_> = effect.variants.iter().map(|one| one.name).collect();
                write!(
                    f,
                    "`effects.{}.variant` = \"{found}\" is not one of {}",
                    effect.id,
                    names.join(", ")
                )
            }
            Self::UnknownKey {
                key, suggestion, ..
            } => {
                write!(f, "unknown parameter `{key}`")?;
                match suggestion {
                    Some(suggestion) => write!(f, "; write `{suggestion}`"),
                    None => write!(
                        f,
                        "; remove it, or list the known ones with `retarder parameters`"
                    ),
                }
            }
            Self::MissingKey { spec } => {
                write!(
                    f,
                    "`{}` is missing in [{}]: {}; add it with a value from {}",
                    spec.key,
                    spec.section,
                    spec.about,
                    range(spec)
                )?;
                let part = Part::of_parameter(spec);
                match part.left_out_by() {
                    Some(way) => write!(f, "; if there is no {part}, write {way}"),
                    None => Ok(()),
                }
            }
            Self::MissingValue {
                key,
                range,
                about,
                instead,
            } => {
                let (least, most) = (brief(range.0), brief(range.1));
                write!(
                    f,
                    "`{key}` is missing: {about}; add it with a value from {least} to {most}, and its uncertainty behind it, such as `# guessed, ±25 %`"
                )?;
                match instead {
                    Some(keys) => write!(f, "; or give {keys}"),
                    None => Ok(()),
                }
            }
            Self::ValueOutOfRange {
                key, value, range, ..
            } => write!(
                f,
                "`{key}` = {} is out of range: allowed {} to {}",
                brief(*value),
                brief(range.0),
                brief(range.1)
            ),
            Self::WrongType {
                key,
                found,
                expected,
                ..
            } => write!(f, "`{key}` is {found}, expected {expected}"),
            Self::OutOfRange { spec, value, .. } => {
                write!(
                    f,
                    "`{}` = {value} is out of range: allowed {} ({})",
                    spec.name(),
                    range(spec),
                    spec.about
                )?;
                match plausible_unit(spec, *value) {
                    Some((unit, converted)) => write!(
                        f,
                        "; if the number is in {unit}, write `{} = {converted:e}`",
                        spec.key
                    ),
                    None => Ok(()),
                }
            }
            Self::UnknownChoice {
                key,
                found,
                choices,
                ..
            } => write!(
                f,
                "`{key}` = \"{found}\" is not one of {}",
                choices.join(", ")
            ),
            Self::AbsentPart { spec, .. } => {
                let (name, part) = (spec.name(), Part::of_parameter(spec));
                write!(
                    f,
                    "`{name}` describes nothing, since this plant has no {part}: remove it, or correct the tables [{VALVES}] and [{CHAMBER}], which state the parts of the plant"
                )
            }
            Self::AbsentSection { spec } => write!(
                f,
                "this plant has no table [{}]: add it to the plant file, with all its keys, before setting `{}`",
                spec.section, spec.key
            ),
            Self::NothingToActOn { effect, part } => write!(
                f,
                "[{EFFECTS}.{}] has nothing to act on, since this plant has no {part}; remove it",
                effect.id
            ),
            Self::OwnEffect { key, reason, .. } => {
                let text = reason.to_string();
                // A reason is a predicate of the key, or a sentence of its own.
                let verbs = ["= ", "is ", "has ", "gives ", "shrinks "];
                let is_predicate = verbs.iter().any(|verb| text.starts_with(verb));
                let colon = if is_predicate { "" } else { ":" };
                write!(f, "`{key}`{colon} {text}")
            }
            Self::GivenTwice { key, .. } => write!(
                f,
                "`{key}` gives a value that another line gives as well; remove one of them"
            ),
            Self::Inconsistent { key, rule } => write!(f, "`{key}`: {rule}"),
        }
    }
}

fn range(spec: &ParameterSpec) -> String {
    let (min, max) = spec.range;
    let number = |value: f64| {
        if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
            format!("{value:e}")
        } else {
            format!("{value}")
        }
    };
    let range = format!("{} to {} {}", number(min), number(max), spec.unit);
    let range = range.trim_end();
    match spec.size.and_then(|size| size.off) {
        Some(off) if !(min..=max).contains(&off) => format!("{range}, or {off} for none"),
        _ => range.to_owned(),
    }
}
