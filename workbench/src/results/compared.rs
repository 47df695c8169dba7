//! A comparison.

use model_lab::Comparison;
use plant_sim::PlantParameters;

use crate::pyramid::Pyramid;
use crate::shelf::values_of;

/// A comparison with what a view of it needs.
pub(crate) struct Compared {
    pub(crate) comparison: Comparison,
    pub(crate) parameters: PlantParameters,
    /// Of each compared signal, in the order of the comparison.
    pub(crate) pyramids: Vec<Pyramids>,
}

/// Extremes of the computed courses of one signal.
pub(crate) struct Pyramids {
    pub(crate) model: Pyramid,
    pub(crate) residual: Pyramid,
}

impl Compared {
    /// Values that it keeps in memory.
    pub(crate) fn values(&self) -> usize {
        let traces = &self.comparison.traces;
        let all = [
            &traces.free_run,
            &traces.free_run_residual,
            &traces.short_horizon,
            &traces.short_horizon_residual,
        ];
        all.into_iter().map(values_of).sum()
    }

    pub(crate) fn new(comparison: Comparison, parameters: PlantParameters) -> Self {
        let traces = &comparison.traces;
        let pyramid = |recording: &recording::Recording, name: &str| {
            recording
                .signal(name)
                .map_or_else(Pyramid::default, |signal| {
                    Pyramid::new(signal.values_or_nan())
                })
        };
        let of_signal = |signal: &model_lab::result::SignalComparison| Pyramids {
            model: pyramid(&traces.free_run, &signal.name),
            residual: pyramid(&traces.free_run_residual, &signal.name),
        };
        Self {
            pyramids: comparison.signals.iter().map(of_signal).collect(),
            parameters,
            comparison,
        }
    }
}
