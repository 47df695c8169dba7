#![doc = include_str!("../README.md")]

#[cfg(test)]
mod bench;
mod bins;
mod commands;
mod compare;
mod conditions;
mod defects;
pub mod diagnosis;
mod error;
mod found_conditions;
mod free_run;
mod gaps;
mod gas_after_gap;
mod log_start;
mod measured;
mod metrics;
mod noise;
mod noise_floor;
mod offset;
mod options;
mod regime;
mod repeats;
pub mod result;
mod run;
mod simulation_start;
mod spikes;
mod summary;
pub mod thesis;
mod warning;
mod whiteness;

pub use bins::Bins;
pub use compare::compare_under;
pub use conditions::LogConditions;
pub use error::CompareError;
pub use found_conditions::{compare, compare_watched, find_conditions};
pub use free_run::{FreeRun, SignalError, free_run};
pub use options::CompareOptions;
pub use result::Comparison;
pub use simulation_start::{SimulationStart, StartError};
