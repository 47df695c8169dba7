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

/// Returns a sketch of the plant as SVG for an HTML page: its parts with their values, and its effects where they act.
/// The colours are those for a white background; `None` if it cannot be drawn.
pub fn plant_sketch(plant: &PlantParameters) -> Option<String> {
    let sketch = plot::sketch(plant).ok()?;
    Some(sketch.inline_svg())
}

#[cfg(test)]
mod tests;
