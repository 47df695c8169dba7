#![doc = include_str!("../README.md")]

mod contents;
mod control;
mod diagnosis;
mod element;
mod history;
mod logs;
mod model;
mod number;
mod origin;
mod page;
mod plant;
mod plot;
mod thesis;
mod tuning;

pub use contents::{
    BeforeAndAfter, Contents, ControlPart, DiagnosisPart, HistoryPart, HistoryStep, Input, LogPart,
    ModelPart, NextCommand, Origin, PlantPart, TuningPart,
};
pub use page::{html, is_report, style};
pub use plot::{SmallUnit, capitalised, pressure_first, signal_words, unit_of};

use plant_sim::PlantParameters;

/// Sketch of a plant: its parts with their values, and its effects where they act.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlantSketch {
    /// SVG image for a white background.
    pub on_white: String,
    /// SVG image for a dark background.
    pub on_dark: String,
    /// The same in words.
    pub text: String,
}

/// Returns the sketch of a plant; `None` if it cannot be drawn.
pub fn plant_sketch(plant: &PlantParameters) -> Option<PlantSketch> {
    let sketch = plot::sketch(plant).ok()?;
    let [on_white, on_dark] = sketch.images();
    Some(PlantSketch {
        on_white,
        on_dark,
        text: sketch.description().to_owned(),
    })
}

#[cfg(test)]
mod tests;
