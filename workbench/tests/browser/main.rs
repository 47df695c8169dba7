//! The page in a real browser: Debian's `chromium` and `chromium-driver`.
//!
//! Images are saved in the target folder, under `tmp/`.

mod accessibility;
mod alignment;
mod closer;
mod compare;
mod control;
mod driver;
mod estimate;
mod figures;
mod history;
mod hostile;
mod layout;
mod long_log;
mod newcomer;
mod rates;
mod reading;
mod reconnect;
mod refine;
mod tabs;
