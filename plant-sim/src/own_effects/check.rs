//! Checks of a definition: names, units, values over all ranges, and the strength.

use formula::{Dimension, Formula, parse_unit};
use recording::nearest_name;

use crate::toml_file::{brief, shown};

use super::definition::{ACTS_ON, Definition, EXPRESSION, OwnParameter, PARAMETERS, UNIT};
use super::points::{POINTS, Point};
use super::reason::{Fault, Reason};
use super::variables::{VARIABLES, Variable};

/// Largest number of parameters.
pub(super) const PARAMETERS_MAX: usize = 6;
/// Largest length of a name, and of a text (characters).
const NAME_MAX: usize = 40;
const TEXT_MAX: usize = 400;
/// Number of samples in the ranges, and the largest number of names of which every corner is a sample.
const SAMPLES: usize = 2048;
const CORNER_NAMES_MAX: usize = 10;
/// Relative step of a difference in pressure.
const PRESSURE_STEP: f64 = 1e-6;

/// Definition whose parts are valid.
pub(super) struct Checked {
    pub(super) point: &'static Point,
    pub(super) formula: Formula,
    /// Meaning of each name of the formula.
    pub(super) sources: Vec<Source>,
    /// Reasons why the units of parts were not checked.
    pub(super) unchecked: Vec<String>,
    /// Whether each parameter switches the effect off at 0.
    pub(super) is_strength: Vec<bool>,
}

/// Meaning of a name.
#[derive(Debug, Clone, Copy)]
pub(super) enum Source {
    Variable(&'static Variable),
    /// Index of a parameter.
    Parameter(usize),
}

pub(super) fn check(definition: &Definition) -> Result<Checked, Vec<Fault>> {
    let mut faults = Vec::new();
    names_and_texts(definition, &mut faults);
    for parameter in &definition.parameters {
        check_parameter(parameter, &mut faults);
    }
    let point = Point::named(&definition.acts_on);
    if point.is_none() && !definition.acts_on.is_empty() {
        let nearest = nearest_name(&definition.acts_on, POINTS.iter().map(|point| point.name));
        let found = shown(&definition.acts_on);
        faults.push(fault(ACTS_ON, Reason::Point { found, nearest }));
    }
    let formula = match Formula::parse(&definition.expression) {
        Ok(formula) => Some(formula),
        Err(_) if definition.expression.is_empty() => None,
        Err(error) => {
            faults.push(fault(EXPRESSION, error.into()));
            None
        }
    };
    let (Some(point), Some(formula)) = (point, formula) else {
        return Err(faults);
    };
    let mut sources = Vec::new();
    for name in formula.names() {
        match source(definition, point, &formula, name) {
            Ok(source) => sources.push(source),
            Err(reason) => faults.push(fault(EXPRESSION, reason)),
        }
    }
    for parameter in &definition.parameters {
        if formula.position(&parameter.key).is_none() {
            let key = format!("{PARAMETERS}.{}", parameter.key);
            faults.push(fault(&key, Reason::Unused));
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let one = |reason| vec![fault(EXPRESSION, reason)];
    let unchecked = units(definition, point, &formula).map_err(one)?;
    let law = Law {
        definition,
        point,
        formula: &formula,
        sources: &sources,
    };
    law.is_possible_everywhere().map_err(one)?;
    let is_strength: Vec<bool> = (0..definition.parameters.len())
        .map(|index| law.is_off_without(index))
        .collect();
    if !is_strength.contains(&true) {
        return Err(one(Reason::NoStrength {
            neutral: point.neutral,
            example: if point.neutral == 0.0 {
                "k * (p - p_ambient)"
            } else {
                "1 + k * (p - p_ambient)"
            },
        }));
    }
    Ok(Checked {
        point,
        formula,
        sources,
        unchecked,
        is_strength,
    })
}

fn fault(key: &str, reason: Reason) -> Fault {
    Fault {
        key: key.to_owned(),
        reason,
    }
}

fn is_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters
        .next()
        .is_some_and(|one| one.is_ascii_alphabetic())
        && characters.all(|one| one.is_ascii_alphanumeric() || one == '_')
        && name.len() <= NAME_MAX
}

fn names_and_texts(definition: &Definition, faults: &mut Vec<Fault>) {
    if !is_name(&definition.name) {
        faults.push(fault("", Reason::Name { most: NAME_MAX }));
    }
    let texts = [
        ("sentence", &definition.sentence),
        ("excited_by", &definition.excited_by),
        ("source", &definition.source),
    ];
    for (key, text) in texts {
        let length = text.chars().count();
        if length > TEXT_MAX {
            let most = TEXT_MAX;
            faults.push(fault(key, Reason::TooLong { length, most }));
        }
    }
    let count = definition.parameters.len();
    if count > PARAMETERS_MAX {
        let most = PARAMETERS_MAX;
        faults.push(fault(PARAMETERS, Reason::TooMany { count, most }));
    }
}

fn check_parameter(parameter: &OwnParameter, faults: &mut Vec<Fault>) {
    let mut refuse = |suffix: &str, reason| {
        let key = format!("{PARAMETERS}.{}{suffix}", parameter.key);
        faults.push(Fault { key, reason });
    };
    if !is_name(&parameter.key) {
        refuse("", Reason::Name { most: NAME_MAX });
    }
    if Variable::named(&parameter.key).is_some() || parameter.key == "variant" {
        refuse("", Reason::Taken);
    }
    let (least, most) = parameter.range;
    if !(least.is_finite() && most.is_finite() && least < most) {
        refuse(".range", Reason::Range { least, most });
    } else if !(least..=most).contains(&parameter.typical) {
        let value = parameter.typical;
        refuse(".typical", Reason::Typical { value, least, most });
    }
    if let Some(unit) = &parameter.unit
        && let Err(error) = parse_unit(unit)
    {
        let unit = shown(unit);
        refuse(&format!(".{UNIT}"), Reason::Unit { unit, error });
    }
    if let Some(about) = &parameter.about
        && about.chars().count() > TEXT_MAX
    {
        let length = about.chars().count();
        let most = TEXT_MAX;
        refuse(".about", Reason::TooLong { length, most });
    }
}

/// Returns the meaning of a name.
fn source(
    definition: &Definition,
    point: &'static Point,
    formula: &Formula,
    name: &str,
) -> Result<Source, Reason> {
    let keys = || definition.parameters.iter().map(|one| one.key.as_str());
    if let Some(index) = keys().position(|key| key == name) {
        return Ok(Source::Parameter(index));
    }
    let position = formula.position(name).unwrap_or(1);
    match Variable::named(name) {
        Some(variable) if point.admits(name) => Ok(Source::Variable(variable)),
        Some(_) => Err(Reason::NotAdmitted {
            position,
            name: name.to_owned(),
            point: point.name,
            about: point.about,
        }),
        None => {
            let variables = VARIABLES.iter().map(|variable| variable.name);
            let nearest = nearest_name(name, keys().chain(variables));
            let listed = keys().collect::<Vec<_>>().join(", ");
            Err(Reason::UnknownName {
                position,
                name: shown(name),
                nearest: nearest.map(str::to_owned),
                parameters: if listed.is_empty() {
                    "none".to_owned()
                } else {
                    listed
                },
            })
        }
    }
}

/// Checks the dimensions, and returns the reasons why parts were not checked.
fn units(
    definition: &Definition,
    point: &'static Point,
    formula: &Formula,
) -> Result<Vec<String>, Reason> {
    let of_name = |name: &str| -> Option<Dimension> {
        let own = definition.parameters.iter().find(|one| one.key == name);
        let unit = match own {
            Some(parameter) => parameter.unit.as_deref()?,
            None => Variable::named(name)?.unit,
        };
        parse_unit(unit).ok()?
    };
    let checked = formula.dimension(of_name).map_err(Reason::Mismatch)?;
    let needed = parse_unit(point.unit).ok().flatten();
    if let Some((found, needed)) = checked.dimension.zip(needed)
        && !found.is(needed)
    {
        return Err(Reason::Dimension {
            found,
            needed,
            point: point.name,
            about: point.about,
        });
    }
    Ok(checked.unchecked)
}

/// Law with what its names mean.
struct Law<'a> {
    definition: &'a Definition,
    point: &'static Point,
    formula: &'a Formula,
    sources: &'a [Source],
}

impl Law<'_> {
    /// Returns the value of a name at `share` of its range; a positive range of decades is a logarithmic one.
    fn at(&self, source: Source, share: f64) -> f64 {
        let (least, most) = match source {
            Source::Variable(variable) => variable.range,
            Source::Parameter(index) => self.definition.parameters[index].range,
        };
        if share <= 0.0 {
            least
        } else if share >= 1.0 {
            most
        } else if least > 0.0 {
            least * (most / least).powf(share)
        } else {
            least + share * (most - least)
        }
    }

    /// Returns samples of the values of all names: corners of the ranges, and points between them.
    fn samples(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let number = self.sources.len();
        let corners = 1_usize << number.min(CORNER_NAMES_MAX);
        let corner = move |corner: usize, name: usize| f64::from((corner >> name) as u32 & 1);
        // Kronecker sequence with the generalised golden ratio g: g^(number + 1) = g + 1 (Roberts, 2018).
        let mut golden: f64 = 2.0;
        for _ in 0..40 {
            golden = (1.0 + golden).powf(1.0 / (number as f64 + 1.0));
        }
        let between = move |sample: usize, name: usize| {
            (0.5 + (sample + 1) as f64 * golden.powi(-(name as i32 + 1))).fract()
        };
        (0..corners + SAMPLES).map(move |sample| {
            let share = |name: usize| match sample.checked_sub(corners) {
                None => corner(sample, name),
                Some(sample) => between(sample, name),
            };
            let sources = self.sources.iter().enumerate();
            sources
                .map(|(name, source)| self.at(*source, share(name)))
                .collect()
        })
    }

    fn is_possible_everywhere(&self) -> Result<(), Reason> {
        for values in self.samples() {
            let value = self.formula.value(&values);
            if !value.is_finite() {
                let place = self.place(&values);
                return Err(Reason::NotFinite { value, place });
            }
            if value < self.point.least {
                return Err(Reason::OutOfBounds {
                    value,
                    place: self.place(&values),
                    point: self.point.name,
                    about: self.point.about,
                    least: self.point.least,
                });
            }
        }
        self.has_no_pole()?;
        self.has_possible_volume()
    }

    /// Refuses a factor f of the volume for which p f falls with the pressure p.
    fn has_possible_volume(&self) -> Result<(), Reason> {
        let pressure = self.formula.names().position(|name| name == "p");
        let Some(pressure) = pressure.filter(|_| self.point.is_volume()) else {
            return Ok(());
        };
        for values in self.samples() {
            let product = |factor: f64| {
                let mut values = values.clone();
                values[pressure] *= factor;
                values[pressure] * self.formula.value(&values)
            };
            if product(1.0 + PRESSURE_STEP) <= product(1.0 - PRESSURE_STEP) {
                let place = self.place(&values);
                return Err(Reason::Shrinks { place });
            }
        }
        Ok(())
    }

    /// Refuses a divisor that has either sign: it is continuous, and 0 in between.
    fn has_no_pole(&self) -> Result<(), Reason> {
        let mut signs: Vec<Option<bool>> = Vec::new();
        for values in self.samples() {
            for (n, (position, value)) in self.formula.divisors(&values).enumerate() {
                if n == signs.len() {
                    signs.push(None);
                }
                let sign = *signs[n].get_or_insert(value > 0.0);
                if sign != (value > 0.0) {
                    return Err(Reason::Divisor { position });
                }
            }
        }
        Ok(())
    }

    fn place(&self, values: &[f64]) -> String {
        let named = self.formula.names().zip(values);
        let named: Vec<String> = named
            .map(|(name, value)| format!("{name} = {}", brief(*value)))
            .collect();
        if named.is_empty() {
            "any state".to_owned()
        } else {
            named.join(", ")
        }
    }

    /// Returns whether the effect vanishes with this parameter at 0, whatever the others are.
    fn is_off_without(&self, parameter: usize) -> bool {
        let is_it =
            |source: &Source| matches!(source, Source::Parameter(index) if *index == parameter);
        self.samples().all(|mut values| {
            for (value, source) in values.iter_mut().zip(self.sources) {
                if is_it(source) {
                    *value = 0.0;
                }
            }
            self.formula.value(&values) == self.point.neutral
        })
    }
}
