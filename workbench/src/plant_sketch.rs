//! Sketch of the plant for the page.

use plant_sim::PlantParameters;
use serde::Serialize;

/// Sketch of the plant, as images for both themes and in words.
#[derive(Serialize)]
pub(crate) struct SketchView {
    light: String,
    dark: String,
    text: String,
}

impl SketchView {
    /// Draws the sketch; `None` if it cannot be drawn.
    pub(crate) fn of(plant: &PlantParameters) -> Option<Self> {
        let sketch = report::plant_sketch(plant)?;
        Some(Self {
            light: sketch.on_white,
            dark: sketch.on_dark,
            text: sketch.text,
        })
    }
}
