//! Library of effects in the form that the pages show.

use plant_sim::PlantParameters;
use plant_sim::effects::{About, EntryPoint};
use plant_sim::parameters::{ParameterSpec, Scale};
use serde::Serialize;

/// Document with all equations; the page shows the equation of each effect.
const EQUATIONS: &str = include_str!("../../docs/equations.md");

/// Description of an effect.
#[derive(Serialize)]
pub(crate) struct EffectView {
    id: &'static str,
    title: String,
    sentence: &'static str,
    /// Part of the plant that it acts on, in words.
    acts_on: &'static str,
    /// Law as printed in `docs/equations.md`, or the expression of an own effect.
    equation: &'static str,
    source: &'static str,
    excited_by: &'static str,
    /// Ids of effects that look similar in a log.
    confused_with: &'static [&'static str],
    forms: Vec<FormView>,
}

#[derive(Serialize)]
struct FormView {
    name: &'static str,
    about: &'static str,
    parameters: Vec<ParameterView>,
}

/// Parameter of an effect, with the properties of its slider.
#[derive(Serialize)]
struct ParameterView {
    key: &'static str,
    unit: &'static str,
    about: &'static str,
    lowest: f64,
    highest: f64,
    typical: Option<f64>,
    /// Whether its values span decades.
    is_log: bool,
    /// Whether a smaller value is a stronger effect, as for the area of a restriction.
    is_stronger_below: bool,
}

impl EffectView {
    fn of(about: &'static About) -> Self {
        Self {
            id: about.id,
            title: about.title(),
            sentence: about.sentence,
            acts_on: acts_on(about.acts_on),
            equation: equation(about).unwrap_or_default(),
            source: about.source,
            excited_by: about.excited_by,
            confused_with: about.confused_with,
            forms: about
                .variants
                .iter()
                .map(|variant| FormView {
                    name: variant.name,
                    about: variant.about,
                    parameters: variant
                        .parameters
                        .iter()
                        .map(|spec| parameter(spec))
                        .collect(),
                })
                .collect(),
        }
    }
}

/// Returns the effects that a plant may have: the library, and the user's own ones.
pub(crate) fn all(plant: &PlantParameters) -> Vec<EffectView> {
    plant
        .candidates()
        .map(|effect| {
            let mut view = EffectView::of(effect.about());
            if effect.definition_toml().is_some() {
                view.equation = effect.about().variants[0].about;
            }
            view
        })
        .collect()
}

fn parameter(spec: &'static ParameterSpec) -> ParameterView {
    let (lowest, highest) = spec.range;
    ParameterView {
        key: spec.key,
        unit: spec.unit,
        about: spec.about,
        lowest,
        highest,
        typical: spec.size.map(|size| size.typical),
        is_log: spec.size.is_some_and(|size| size.scale == Scale::Log) && lowest > 0.0,
        is_stronger_below: spec
            .size
            .is_some_and(|size| size.off == Some(f64::INFINITY)),
    }
}

/// Returns the first block of formulas below the heading that names the effect.
fn equation(about: &About) -> Option<&'static str> {
    let name = format!("`{}`", about.id);
    let mut sections = EQUATIONS.split("\n### ");
    let section = sections.find(|section| {
        let heading = section.lines().next();
        heading.is_some_and(|heading| heading.contains(&name))
    })?;
    let (_, block) = section.split_once("```text\n")?;
    block.split("\n```").next()
}

fn acts_on(point: EntryPoint) -> &'static str {
    match point {
        EntryPoint::Leak => "air that leaves or enters the chamber past the valves",
        EntryPoint::Coil => "the coils and their currents",
        EntryPoint::Armature => "the motion of the armatures",
        EntryPoint::Switching => "the switching times of on/off valves",
        EntryPoint::ElectricSupply => "the voltage at the coils",
        EntryPoint::AirSupply => "the supply of air",
        EntryPoint::Flow => "the flow through the valves",
        EntryPoint::GasEnergy => "the temperature of the gas",
        EntryPoint::Volume => "the volume that the air fills",
        EntryPoint::Drain => "the way from the vent valve to the surroundings",
        EntryPoint::Sensor => "the pressure sensor, not the pressure",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant_sim::effects::LIBRARY;

    #[test]
    fn every_effect_has_its_equation_and_bounds_that_a_slider_can_have() {
        for effect in all(&PlantParameters::nominal()) {
            assert!(!effect.equation.is_empty(), "{}", effect.id);
            for parameter in effect.forms.iter().flat_map(|form| &form.parameters) {
                assert!(parameter.lowest < parameter.highest, "{}", parameter.key);
                assert!(parameter.highest.is_finite(), "{}", parameter.key);
            }
        }
        let leak = equation(LIBRARY[0].about()).unwrap();
        assert!(
            leak.starts_with("orifice") && leak.ends_with("^n"),
            "{leak}"
        );
    }
}
