//! The page in a real browser, as a person has it: Debian's `chromium` and `chromium-driver`.
//!
//! Pictures of what was seen are left in the target folder, under `tmp/`.

mod closer;
mod compare;
mod control;
mod driver;
mod figures;
mod hostile;
mod long_log;
mod newcomer;
mod refine;
mod tabs;
