//! Effects that a rig may hide: the library's effects in laws of this plant, variants of them, and effects outside any
//! library. A form is a law with a size; size zero is the plain plant.

mod armature;
mod beyond;
mod electric;
mod gas;
mod sensor;
mod supply;

use serde::{Deserialize, Serialize};

use super::datasheet::Datasheet;
use super::departures::Departures;

/// Relation of a form to the library of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kinship {
    /// Law of the textbook for an effect of the library.
    Matched,
    /// Another law of an effect of the library.
    Variant,
    /// Not in the library.
    Beyond,
}

/// Law of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// Id of the effect: that of the library, or another one if the library does not have it.
    pub effect: &'static str,
    /// Name that distinguishes this law from other laws of the effect.
    pub law: &'static str,
    /// Relation to the library.
    pub kinship: Kinship,
    /// Unit of the size.
    pub unit: &'static str,
    /// Size that leaves about the noise in some signal after a fit of the scattered parameters of the simulator's plain
    /// model (`plain_fit`, twenty seconds of a bench log).
    pub typical: f64,
    /// Effects of the library that are physically the same here; naming one of them is also right.
    pub same: &'static [&'static str],
    /// Parameter of the library's effect with the same meaning, if there is one.
    parameter: Option<LibraryParameter>,
    apply: fn(&Parameters<'_>, &mut Departures),
}

/// Key of a parameter of the library, and its value for a law.
type LibraryParameter = (&'static str, fn(&Parameters<'_>) -> f64);

/// Inputs of a law.
struct Parameters<'a> {
    size: f64,
    /// Position of the law's other parameters in their ranges, 0 to 1.
    shape: f64,
    datasheet: &'a Datasheet,
}

impl Parameters<'_> {
    /// Returns a second parameter between two positive bounds, uniform on a logarithmic scale.
    fn between(&self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.shape)
    }

    /// Returns the heat capacity at constant volume of the chamber's gas at ambient density (J/K).
    fn ambient_heat_capacity(&self) -> f64 {
        let gas = &self.datasheet.gas;
        gas.ambient_pressure_pa * self.datasheet.chamber.volume_m3
            / (gas.temperature_k * (gas.heat_capacity_ratio - 1.0))
    }

    /// Returns the effective area of the fully open fill valve (m²).
    fn fill_bore(&self) -> f64 {
        let flow = &self.datasheet.flow;
        flow.discharge_fill * std::f64::consts::FRAC_PI_4 * flow.orifice_fill_m.powi(2)
    }
}

impl Form {
    /// Creates a law of an effect of the library.
    const fn library(
        effect: &'static str,
        kinship: Kinship,
        law: &'static str,
        (typical, unit): (f64, &'static str),
        apply: fn(&Parameters<'_>, &mut Departures),
    ) -> Self {
        Self {
            effect,
            law,
            kinship,
            unit,
            typical,
            same: &[],
            parameter: None,
            apply,
        }
    }

    /// Adds effects of the library that are physically the same.
    const fn same(self, same: &'static [&'static str]) -> Self {
        Self { same, ..self }
    }

    /// Adds the library parameter with the same meaning.
    const fn parameter(self, key: &'static str, value: fn(&Parameters<'_>) -> f64) -> Self {
        Self {
            parameter: Some((key, value)),
            ..self
        }
    }

    /// Returns key and value of the library's parameter with the same meaning, if there is one.
    pub fn library_parameter(
        &self,
        size: f64,
        shape: f64,
        datasheet: &Datasheet,
    ) -> Option<(&'static str, f64)> {
        let parameters = Parameters {
            size,
            shape,
            datasheet,
        };
        self.parameter.map(|(key, value)| (key, value(&parameters)))
    }

    /// Writes this law into `departures`. `shape`, 0 to 1, sets its other parameters.
    pub fn apply(&self, size: f64, shape: f64, datasheet: &Datasheet, departures: &mut Departures) {
        if size > 0.0 {
            let parameters = Parameters {
                size,
                shape,
                datasheet,
            };
            (self.apply)(&parameters, departures);
        }
    }
}

/// Returns every form.
pub fn forms() -> impl Iterator<Item = &'static Form> {
    [
        electric::FORMS,
        armature::FORMS,
        supply::FORMS,
        gas::FORMS,
        sensor::FORMS,
        beyond::FORMS,
    ]
    .into_iter()
    .flatten()
}

/// Returns every form of one kinship.
pub fn forms_of(kinship: Kinship) -> impl Iterator<Item = &'static Form> {
    forms().filter(move |form| form.kinship == kinship)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference_plant::{Reading, Rig, replay};

    /// Simulates fill, hold, vent, and both valves, so that every part moves once.
    fn readings(form: &Form, size: f64) -> Vec<Reading> {
        let rig = Rig::nominal();
        let mut departures = Departures::default();
        form.apply(size, 0.5, &rig.datasheet, &mut departures);
        let mut commands = vec![[0.0, 0.0]; 5];
        commands.extend([[100.0, 0.0]; 12]);
        commands.extend([[60.0, 0.0]; 6]);
        commands.extend([[0.0, 0.0]; 10]);
        commands.extend([[0.0, 80.0]; 10]);
        commands.extend([[70.0, 70.0]; 12]);
        replay(&rig.with(departures), &commands)
    }

    /// Defect seen: bristles a hundred times too stiff for the solver's step gave NaN.
    #[test]
    fn every_law_is_solved_at_both_ends_of_the_sizes_that_are_drawn() {
        for form in forms() {
            for share in [0.15, 10.0] {
                let readings = readings(form, share * form.typical);
                assert!(
                    readings.iter().all(|r| {
                        (-1e5..1.2e6).contains(&r.pressure)
                            && r.currents.iter().all(|current| current.abs() < 0.5)
                    }),
                    "{} ({}) at {share} of the typical size",
                    form.effect,
                    form.law
                );
            }
        }
    }

    /// For the laws that act within half a second: a lost pulse and a sticking seat are rare.
    #[test]
    fn no_size_is_the_plain_plant_and_a_large_one_is_not() {
        let slow = ["missed_pulses", "sticky_seat"];
        for form in forms().filter(|form| !slow.contains(&form.effect)) {
            let [none, large] = [0.0, 10.0].map(|share| readings(form, share * form.typical));
            let mut departures = Departures::default();
            form.apply(0.0, 0.5, &Datasheet::bundled(), &mut departures);
            assert_eq!(departures, Departures::default(), "{}", form.effect);
            assert_ne!(none, large, "{} ({})", form.effect, form.law);
        }
    }
}
