//! The thesis' own figures as a test of the model: each measured number beside the simulated one.
//!
//! A figure that the plain model cannot reach has its deviation in the row: the starting point for the search of a missing
//! effect.

mod explain;
mod explanation;
mod measurements;
mod table;

pub use explain::explain;
pub use explanation::{
    EXPLANATION_SCHEMA, Explained, ExplainedFigure, ExplainedParameter, Explanation,
};
pub use measurements::{
    CoilMeasurements, DutyLimits, FillingAndVenting, Measurements, MeasurementsError, Requirement,
};
pub use table::{Deviation, Row, THESIS_SCHEMA, ThesisTable, compare_with_model};
