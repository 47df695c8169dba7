#![doc = include_str!("../README.md")]

#[cfg(test)]
mod bench;
mod commands;
mod compare;
mod error;
mod metrics;
mod noise_floor;
mod offset;
mod regime;
pub mod result;
mod run;
mod summary;
mod whiteness;

pub use compare::{CompareOptions, compare};
pub use error::CompareError;
pub use result::Comparison;
