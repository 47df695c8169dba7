//! The bench. For the ECU's processor: measures and prints. On the host: says how it is run.
#![cfg_attr(target_os = "none", no_std, no_main)]
#[cfg(not(target_os = "none"))]
fn main() {}
#[cfg(target_os = "none")]
use cortex_m_rt as _;
