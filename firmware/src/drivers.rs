//! Drivers of the parts around the processor, over `embedded-hal` alone: the same code on each board and in the host's tests.

pub mod analog;
mod mcp3201;
mod valve;

pub use mcp3201::{Mcp3201, ReadError, frame_of};
pub use valve::Valve;
