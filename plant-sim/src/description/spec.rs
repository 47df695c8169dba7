//! One parameter of a plant file.

/// The table of a plant file that holds one table per effect.
pub(crate) const EFFECTS: &str = "effects";

/// One parameter: where it stands, its unit, its range and what it means.
#[derive(Debug)]
#[non_exhaustive]
pub struct ParameterSpec {
    /// TOML table.
    pub section: &'static str,
    /// TOML key; its end is the unit.
    pub key: &'static str,
    /// Unit for people; empty for a pure number.
    pub unit: &'static str,
    /// Smallest and largest allowed value, both included. The off value of a strength is allowed as well.
    pub range: (f64, f64),
    /// Meaning, with the equation of the thesis where there is one.
    pub about: &'static str,
    /// How large it is, where it belongs to an effect.
    pub size: Option<Size>,
}

/// How large a parameter of an effect is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// A size that is met in practice, in the unit of the parameter.
    pub typical: f64,
    /// In which measure its values are evenly spread.
    pub scale: Scale,
    /// The value at which nothing is left of the effect: 0, or infinite; none for a parameter of form.
    pub off: Option<f64>,
}

impl Size {
    /// A strength that is spread over decades, and none at 0.
    pub const fn strength(typical: f64) -> Self {
        Self {
            typical,
            scale: Scale::Log,
            off: Some(0.0),
        }
    }
}

/// The measure in which a parameter is varied and fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Its logarithm: positive, over decades.
    Log,
    /// The value itself.
    Linear,
}

impl ParameterSpec {
    /// A parameter of an effect of your own. `section` is `effects.` and the effect's id.
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

    /// `section.key`.
    pub fn name(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }

    /// The id of the effect that the parameter belongs to.
    pub fn effect_id(&self) -> Option<&'static str> {
        let (table, id) = self.section.split_once('.')?;
        (table == EFFECTS).then_some(id)
    }

    /// Whether `value` is allowed; NaN is not.
    pub fn contains(&self, value: f64) -> bool {
        let off = self.size.and_then(|size| size.off);
        (value >= self.range.0 && value <= self.range.1) || off == Some(value)
    }
}

/// The parameters of an effect: `NAME = key [unit] least ..= most, Scale typical, off value, meaning;`
macro_rules! effect_parameters {
    ($section:literal: $($name:ident = $key:ident [$unit:literal] $min:literal ..= $max:literal,
        $scale:ident $typical:literal, $(off $off:expr,)? $about:literal;)*) => {
        $(static $name: $crate::description::ParameterSpec = $crate::description::ParameterSpec::of_effect(
            $section,
            stringify!($key),
            $unit,
            ($min, $max),
            $crate::description::Size {
                typical: $typical,
                scale: $crate::description::Scale::$scale,
                off: effect_parameters!(@off $($off)?),
            },
            $about,
        );)*
    };
    (@off) => { None };
    (@off $off:expr) => { Some($off) };
}
pub(crate) use effect_parameters;
