//! How a message becomes bytes on a wire.

/// Most bytes of a frame, its delimiter included.
pub const FRAME_MAX: usize = 1024;
