//! Supported machines, one folder each; one of them is the board of this image.

#[cfg(not(target_os = "none"))]
pub(crate) mod host;

#[cfg(all(target_os = "none", feature = "board-mps2-an386"))]
#[path = "mps2_an386/mod.rs"]
pub(crate) mod board;

#[cfg(all(target_os = "none", feature = "board-nucleo-g474re"))]
#[path = "nucleo_g474re/mod.rs"]
pub(crate) mod board;
