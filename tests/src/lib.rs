//! Evidence that needs more than one crate.
