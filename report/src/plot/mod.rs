//! Static plots as SVG: measurement, model, and their differences.
//!
//! Every figure is a pure function of results: equal results give equal bytes. Text stays text in the font of the
//! reader, every axis names its quantity and unit, and the colours are those of Okabe and Ito, which colour-blind
//! people can distinguish. Figures have the colours for a white background; a page with a dark background replaces them
//! by [`palette::DARK`].

mod canvas;
mod comparison;
mod control;
mod curve;
mod diagnosis;
mod error_map;
mod figure;
pub(crate) mod palette;
mod quantity;
mod regimes;
mod remaining;
mod settling;
mod sketch;
mod thesis;
mod tuning;

pub(crate) use comparison::{comparison, excerpt};
pub(crate) use control::{control, step_of_interest};
pub(crate) use diagnosis::{before_and_after, candidates, error_steps};
pub(crate) use error_map::error_map;
pub(crate) use figure::{Figure, PlotError};
pub use quantity::{SmallUnit, capitalised, pressure_first, signal_words, unit_of};
pub(crate) use regimes::regime;
pub(crate) use remaining::missing_flow;
pub(crate) use settling::{settling, settling_on_rigs};
pub(crate) use sketch::sketch;
pub(crate) use thesis::thesis;
pub(crate) use tuning::trade_off;
