//! Controller files: a controller's settings as TOML, the unit at the end of every key.
//!
//! Decimal text becomes fixed-point without a float in between, nearest 2⁻¹⁶ of the key's unit; what that would change by
//! more than 1 % is refused. The ranges are the controller's own: this module knows keys and words, not bounds.

mod error;
mod form;
mod keys;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::{ControllerFileError, Problem};
pub use form::{values, with_values};
pub use keys::{KEYS, Key};

use controller::Settings;

/// The controller of the thesis, as shipped.
pub const THESIS_TOML: &str = include_str!("../../controllers/thesis.toml");
/// The recommended controller, as shipped.
pub const RECOMMENDED_TOML: &str = include_str!("../../controllers/recommended.toml");

/// Reads a controller file; `name` is what errors call it. What comes back is accepted by [`controller::Config::new`].
///
/// # Errors
/// All problems of the file, each with line, allowed range and what to do.
pub fn read(text: &str, name: &str) -> Result<Settings, ControllerFileError> {
    read::read(text, name)
}

/// The settings as a controller file that reads back to the same bits.
pub fn write(settings: &Settings) -> String {
    write::write(settings)
}

/// The shipped controller of the thesis.
pub fn thesis() -> Settings {
    read(THESIS_TOML, "thesis.toml").expect("the shipped file is read by a test")
}

/// The shipped controller that we recommend.
pub fn recommended() -> Settings {
    read(RECOMMENDED_TOML, "recommended.toml").expect("the shipped file is read by a test")
}
