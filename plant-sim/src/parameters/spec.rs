//! One parameter of a plant file.

use super::table::{EFFECTS, PARAMETERS, REGULATING_VALVE};
use super::values::PlantParameters;

/// One parameter: where it stands, its unit, its range and what it means.
#[derive(Debug)]
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
    pub(super) place: Place,
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

/// Where the value sits.
#[derive(Debug)]
pub(super) enum Place {
    /// A field of the parameters; none where its section is absent.
    Field {
        slot: fn(&mut PlantParameters) -> Option<&mut f64>,
        read: fn(&PlantParameters) -> Option<f64>,
    },
    /// A value of an effect.
    Effect,
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
            place: Place::Effect,
        }
    }

    /// The spec of `section.key`, of a plant file without effects of your own.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        let (section, key) = name.rsplit_once('.')?;
        PARAMETERS
            .iter()
            .copied()
            .find(|spec| spec.section == section && spec.key == key)
    }

    /// `section.key`.
    pub fn name(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }

    /// The value in `parameters`; none where its section is absent.
    pub fn value(&self, parameters: &PlantParameters) -> Option<f64> {
        match self.place {
            Place::Field { read, .. } => read(parameters),
            Place::Effect => parameters.effect(self.effect_id()?)?.get(self.key),
        }
    }

    /// Puts `value` into `parameters` as it is, for fits that keep to the ranges themselves; false where its section
    /// is absent. [`PlantParameters::set`] checks, and notes where a value comes from.
    pub fn put(&self, parameters: &mut PlantParameters, value: f64) -> bool {
        self.slot(parameters).map(|slot| *slot = value).is_some()
    }

    /// The place of the value in `parameters`; none where its section is absent.
    pub(super) fn slot<'a>(&self, parameters: &'a mut PlantParameters) -> Option<&'a mut f64> {
        match self.place {
            Place::Field { slot, .. } => slot(parameters),
            Place::Effect => {
                let id = self.effect_id()?;
                let setting = parameters.effects.iter_mut().find(|set| set.id() == id)?;
                setting.slot(self.key)
            }
        }
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

    /// Whether a plant file may leave the section out.
    pub fn is_optional(&self) -> bool {
        self.section == REGULATING_VALVE || self.effect_id().is_some()
    }
}

/// The parameters of an effect: `NAME = key [unit] least ..= most, Scale typical, off value, meaning;`
macro_rules! effect_parameters {
    ($section:literal: $($name:ident = $key:ident [$unit:literal] $min:literal ..= $max:literal,
        $scale:ident $typical:literal, $(off $off:expr,)? $about:literal;)*) => {
        $(static $name: $crate::parameters::ParameterSpec = $crate::parameters::ParameterSpec::of_effect(
            $section,
            stringify!($key),
            $unit,
            ($min, $max),
            $crate::parameters::Size {
                typical: $typical,
                scale: $crate::parameters::Scale::$scale,
                off: effect_parameters!(@off $($off)?),
            },
            $about,
        );)*
    };
    (@off) => { None };
    (@off $off:expr) => { Some($off) };
}
pub(crate) use effect_parameters;
