//! One parameter of a plant file.

/// Table of a plant file that contains one table per effect.
pub(crate) const EFFECTS: &str = "effects";

/// Parameter: its place, unit, range and meaning.
#[derive(Debug)]
#[non_exhaustive]
pub struct ParameterSpec {
    /// TOML table.
    pub section: &'static str,
    /// TOML key, which ends in its unit.
    pub key: &'static str,
    /// Unit for people; empty for a pure number.
    pub unit: &'static str,
    /// Smallest and largest allowed value, both included. The off value of a strength is allowed as well.
    pub range: (f64, f64),
    /// Meaning, with the equation of the thesis where there is one.
    pub about: &'static str,
    /// Typical size, if it belongs to an effect.
    pub size: Option<Size>,
}

/// Size of a parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Size that occurs in practice, in the unit of the parameter.
    pub typical: f64,
    /// Scale on which its values are evenly spread.
    pub scale: Scale,
    /// Value at which the effect vanishes: 0, or infinite; `None` for a parameter of form.
    pub off: Option<f64>,
    /// Signal of a log without which the parameter has no effect.
    pub driven_by: Option<&'static str>,
}

impl Size {
    /// Creates a strength that is spread over decades, and off at 0.
    pub const fn strength(typical: f64) -> Self {
        Self {
            typical,
            scale: Scale::Log,
            off: Some(0.0),
            driven_by: None,
        }
    }
}

/// Scale on which a parameter is varied and fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Logarithm of the value: positive, over decades.
    Log,
    /// Value itself.
    Linear,
}

impl ParameterSpec {
    /// Creates a parameter of a user-defined effect. `section` is `effects.` and the effect's id.
    pub const fn of_effect(
        section: &'static str,
        key: &'static str,
        unit: &'static str,
        range: (f64, f64),
        size: Size,
        about: &'static str,
    ) -> Self {
        Self {
            section,
            key,
            unit,
            range,
            about,
            size: Some(size),
        }
    }

    /// Returns `section.key`.
    pub fn name(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }

    /// Returns the id of the effect that the parameter belongs to.
    pub fn effect_id(&self) -> Option<&'static str> {
        let (table, id) = self.section.split_once('.')?;
        (table == EFFECTS).then_some(id)
    }

    /// Returns whether `value` is allowed; NaN is not.
    pub fn contains(&self, value: f64) -> bool {
        let off = self.size.and_then(|size| size.off);
        (value >= self.range.0 && value <= self.range.1) || off == Some(value)
    }
}

/// Defines the parameters of an effect: `NAME = key [unit] least ..= most, Scale typical, off value, driven_by signal, meaning;`
macro_rules! effect_parameters {
    ($section:literal: $($name:ident = $key:ident [$unit:literal] $min:literal ..= $max:literal,
        $scale:ident $typical:literal, $(off $off:expr,)? $(driven_by $signal:literal,)? $about:literal;)*) => {
        $(static $name: $crate::description::ParameterSpec = $crate::description::ParameterSpec::of_effect(
            $section,
            stringify!($key),
            $unit,
            ($min, $max),
            $crate::description::Size {
                typical: $typical,
                scale: $crate::description::Scale::$scale,
                off: effect_parameters!(@option $($off)?),
                driven_by: effect_parameters!(@option $($signal)?),
            },
            $about,
        );)*
    };
    (@option) => { None };
    (@option $value:expr) => { Some($value) };
}
pub(crate) use effect_parameters;
