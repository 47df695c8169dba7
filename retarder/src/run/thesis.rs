//! Figures of the thesis.

use model_lab::thesis::{Explanation, Measurements, ThesisTable, compare_with_model};

use crate::input::NamedPlant;
use crate::progress::Progress;

/// Measured and simulated figures.
pub(crate) struct Figures {
    pub(crate) plant: NamedPlant,
    pub(crate) table: ThesisTable,
}

/// Repeats the experiments of the thesis on the model.
pub(crate) fn run(plant: NamedPlant) -> Figures {
    let _progress = Progress::of_unknown_length("repeating the experiments of the thesis");
    Figures {
        table: compare_with_model(&plant.parameters, &Measurements::bundled()),
        plant,
    }
}

/// Effects that explain the filling times.
pub(crate) struct Explained {
    pub(crate) plant: NamedPlant,
    pub(crate) explanation: Explanation,
}

/// Fits effects to the filling times.
pub(crate) fn explain(plant: NamedPlant) -> Explained {
    let _progress = Progress::of_unknown_length("fitting effects to the filling times");
    Explained {
        explanation: model_lab::thesis::explain(&plant.parameters, &Measurements::bundled()),
        plant,
    }
}
