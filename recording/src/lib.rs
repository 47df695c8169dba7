#![doc = include_str!("../README.md")]

mod bounds;
pub mod csv;
mod defects;
mod file;
mod guess;
mod inspection;
mod known;
mod log;
pub mod mf4;
mod name;
mod nearest;
mod plausibility;
mod proposal;
mod provenance;
mod quantity;
mod recording;
mod signal;
mod start_time;
pub mod table;
mod time_base;
mod trace;
mod unit;
mod united;
mod values;

pub use bounds::{Bounds, OutOfBounds, Outlier};
pub use defects::{DefectCounter, Defects, MissingCells, Pause, SkippedRow};
pub use file::{AtomicFile, FileIdentity, write_file_atomically};
pub use inspection::{
    ColumnView, INSPECTION_SCHEMA, InspectedColumn, InspectedDialect, InspectedLog, InspectedLogs,
    Inspection, OpenPoint, ProblemView, QuestionView, Trial, inspect_file, inspect_named_file,
};
pub use log::{
    LogError, LogFormat, LogOptions, OpenLog, open_log, open_log_file, read_log, read_log_file,
};
pub use name::{NAME_BYTES_MAX, NameError};
pub use nearest::{names_meant, nearest_name};
pub use plausibility::Implausible;
pub use provenance::{InputFile, Note, Provenance};
pub use quantity::Quantity;
pub use recording::{AddSignalError, LeftOut, MissingSignal, Recording, TimeBaseId};
pub use signal::Signal;
pub use start_time::{Clock, StartTime};
pub use time_base::{Gap, Sampling, TimeBase, TimeBaseError, median_step_s};
pub use trace::{Pyramid, Samples, Trace};
pub use unit::{ConversionError, Converter, PressureReference, STANDARD_ATMOSPHERE_PA, Unit};
pub use united::{OwnSamples, own_rows};
pub use values::ColumnValues;
