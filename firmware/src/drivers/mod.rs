//! Drivers of the parts around the processor, based on `embedded-hal` only: the same code on each board and in the
//! tests on the host.

pub mod analog;
mod mcp3201;
mod valve;

pub use mcp3201::{Mcp3201, ReadError, frame_of};
pub use valve::Valve;
