//! The image in the loop.
