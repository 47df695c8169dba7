//! Result of a comparison.

use model_lab::Comparison;
use plant_sim::PlantParameters;
use recording::Pyramid;

use crate::cache::values_of;

/// Comparison with the data that a view needs.
pub(crate) struct Compared {
    pub(crate) comparison: Comparison,
    pub(crate) parameters: PlantParameters,
    /// Pyramids of each compared signal, in the order of the comparison.
    pub(crate) pyramids: Vec<Pyramids>,
}

/// Extremes of the computed series of one signal.
pub(crate) struct Pyramids {
    pub(crate) model: Pyramid,
    pub(crate) residual: Pyramid,
}

impl Compared {
    /// Returns the number of values in memory.
    pub(crate) fn values(&self) -> usize {
        let traces = &self.comparison.traces;
        let all = [&traces.measured, &traces.free_run, &traces.one_step_ahead];
        let placements = traces.placements.iter();
        let bytes: usize = placements.map(|placement| placement.bin_of.bytes()).sum();
        all.into_iter().map(values_of).sum::<usize>() + bytes / 8
    }

    pub(crate) fn new(comparison: Comparison, parameters: PlantParameters) -> Self {
        let traces = &comparison.traces;
        let of_signal = |signal: &model_lab::result::SignalComparison| {
            let model = traces.free_run.signal(&signal.name);
            let residual = traces.free_run_residual(&signal.name);
            Pyramids {
                model: model
                    .map(|model| Pyramid::new(model.values_or_nan()))
                    .unwrap_or_default(),
                residual: residual
                    .map(|residual| Pyramid::new(&residual))
                    .unwrap_or_default(),
            }
        };
        Self {
            pyramids: comparison.signals.iter().map(of_signal).collect(),
            parameters,
            comparison,
        }
    }
}
