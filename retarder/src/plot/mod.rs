//! Static plots as SVG: what was measured, what was modelled, and where they part.
//!
//! Every figure is a pure function of results: equal results give equal bytes. Text stays text in the font of the reader,
//! every axis names its quantity and unit, and the colours are those of Okabe and Ito, which colour-blind people tell apart.
//! A figure is drawn in colours for a white ground; a page for dark rooms exchanges them by [`palette::DARK`].

mod canvas;
mod comparison;
mod control;
mod course;
mod error_map;
pub mod palette;
mod quantity;
mod regimes;
mod settling;
mod thesis;

pub use canvas::{Figure, PlotError};
pub use comparison::{comparison, excerpt};
pub use control::{control, step_of_interest};
pub use error_map::error_map;
pub use quantity::{SmallUnit, signal_words};
pub use regimes::regime;
pub use settling::settling;
pub use thesis::thesis;
