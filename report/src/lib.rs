#![doc = include_str!("../README.md")]

mod contents;
mod control;
mod diagnosis;
mod element;
mod history;
mod logs;
mod model;
mod number;
mod origin;
mod page;
mod plant;
mod plot;
mod thesis;
mod tuning;

pub use contents::{
    BeforeAndAfter, Contents, ControlPart, DiagnosisPart, HistoryPart, HistoryStep, Input, LogPart,
    ModelPart, NextCommand, Origin, PlantPart, TuningPart,
};
pub use page::{html, is_report, style};
pub use plot::{SmallUnit, capitalised, pressure_first, signal_words, unit_of};

#[cfg(test)]
mod tests;
