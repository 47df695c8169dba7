//! Definition of a user's own effect, as in a plant file.

use core::fmt::Write as _;

/// Definition of a user's own effect: one `[own_effects.*]` table of a plant file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Definition {
    /// Name; the effect's id is `own.` and the name.
    pub name: String,
    /// Effect in one sentence.
    pub sentence: String,
    /// Name of the [`Point`](super::Point) on which it acts.
    pub acts_on: String,
    /// Value at the point, from variables and parameters in SI units.
    pub expression: String,
    /// Excitation that reveals it.
    pub excited_by: String,
    /// Source of its law.
    pub source: String,
    /// Parameters, in the order of the file.
    pub parameters: Vec<OwnParameter>,
}

/// Parameter of a user's own effect.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OwnParameter {
    /// Name in the expression, and key in the `[effects.own.*]` table.
    pub key: String,
    /// Size that occurs in practice: a fit begins there.
    pub typical: f64,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Unit, if it is stated; without it, the parts with this parameter are not checked.
    pub unit: Option<String>,
    /// Meaning, if it is stated.
    pub about: Option<String>,
}

/// Table of a plant file with the definitions.
pub(crate) const OWN_EFFECTS: &str = "own_effects";
/// Beginning of the id of a user's own effect.
pub(crate) const OWN: &str = "own";

pub(crate) const SENTENCE: &str = "sentence";
pub(crate) const ACTS_ON: &str = "acts_on";
pub(crate) const EXPRESSION: &str = "expression";
pub(crate) const EXCITED_BY: &str = "excited_by";
pub(crate) const SOURCE: &str = "source";
pub(crate) const PARAMETERS: &str = "parameters";
pub(crate) const TYPICAL: &str = "typical";
pub(crate) const RANGE: &str = "range";
pub(crate) const UNIT: &str = "unit";
pub(crate) const ABOUT: &str = "about";

impl Definition {
    /// Returns the definition as a table of a plant file.
    pub(super) fn to_toml(&self) -> String {
        let quoted = |text: &str| toml_edit::Value::from(text).to_string();
        let mut text = format!("[{OWN_EFFECTS}.{}]\n", self.name);
        for (key, value) in [
            (SENTENCE, &self.sentence),
            (ACTS_ON, &self.acts_on),
            (EXPRESSION, &self.expression),
            (EXCITED_BY, &self.excited_by),
            (SOURCE, &self.source),
        ] {
            if !value.is_empty() {
                let _ = writeln!(text, "{key} = {}", quoted(value));
            }
        }
        for parameter in &self.parameters {
            let (least, most) = parameter.range;
            let _ = write!(
                text,
                "{PARAMETERS}.{} = {{ {TYPICAL} = {:?}, {RANGE} = [{least:?}, {most:?}]",
                parameter.key, parameter.typical
            );
            for (key, value) in [(UNIT, &parameter.unit), (ABOUT, &parameter.about)] {
                if let Some(value) = value {
                    let _ = write!(text, ", {key} = {}", quoted(value));
                }
            }
            text += " }\n";
        }
        text
    }
}
