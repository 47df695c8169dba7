//! The machines that the image knows, one file each.

#[cfg(not(target_os = "none"))]
pub(crate) mod host;
#[cfg(target_os = "none")]
pub(crate) mod mps2_an386;
