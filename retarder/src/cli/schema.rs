//! Results with a JSON form.

use clap::ValueEnum;

/// Result with a JSON form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SchemaName {
    /// retarder.black-box/1, of `blackbox`
    BlackBox,
    /// retarder.comparison/2, of `compare`
    Comparison,
    /// retarder.control/3, of `control`
    Control,
    /// retarder.device/1, of `control --dut`
    Device,
    /// retarder.determining-experiment/2, of `next-experiment --determine`
    DeterminingExperiment,
    /// retarder.diagnosis/2, of `diagnose`
    Diagnosis,
    /// retarder.estimation/1, of `refine` without --add
    Estimation,
    /// retarder.inspection/2, of `inspect`
    Inspection,
    /// retarder.refinement/2, of `refine --add`
    Refinement,
    /// retarder.next-experiment/2, of `next-experiment`
    NextExperiment,
    /// retarder.rigs/4, of `control --rigs`
    Rigs,
    /// retarder.rig-summary/1, of `control --rigs-out` and `merge-rigs`
    RigSummary,
    /// retarder.simulation/1, of `simulate`
    Simulation,
    /// retarder.thesis/1, of `thesis`
    Thesis,
    /// retarder.thesis-explanation/1, of `thesis --explain`
    ThesisExplanation,
}
