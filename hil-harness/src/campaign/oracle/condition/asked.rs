//! What is asked for, and since when.

use crate::campaign::bounds;

/// The reference over time.
#[derive(Debug, Default)]
pub(super) struct Asked {
    last_bar: f64,
    /// Samples since it stepped.
    rested_for: u32,
}

impl Asked {
    /// One sample with this reference, if somebody can mean it; `is_hurled`: the pressure moved faster than a valve can move it.
    pub(super) fn look(&mut self, reference_bar: Option<f64>, is_hurled: bool) {
        let reference_bar = reference_bar.unwrap_or(self.last_bar);
        let has_stepped = (reference_bar - self.last_bar).abs() > bounds::STEP_BAR;
        self.rested_for = if has_stepped || is_hurled {
            0
        } else {
            self.rested_for.saturating_add(1)
        };
        self.last_bar = reference_bar;
    }

    /// The last that somebody can mean [bar gauge]; zero before the first.
    pub(super) fn last_bar(&self) -> f64 {
        self.last_bar
    }

    /// Whether nothing has stepped lately: a derivative part answers to a step, and not to the pressure.
    pub(super) fn rests(&self) -> bool {
        self.rested_for >= bounds::SETTLING
    }
}
