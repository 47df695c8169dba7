//! Controller files: a controller's settings as TOML, with the unit at the end of every key.
//!
//! Decimal text is converted to fixed point without a float in between, to the nearest 2⁻¹⁶ of the key's unit. A change
//! by more than 1 % is refused. The ranges belong to the controller: this module contains keys and words, no bounds.

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

/// Shipped controller of the thesis.
pub const THESIS_TOML: &str = include_str!("../../controllers/thesis.toml");
/// Shipped recommended controller.
pub const RECOMMENDED_TOML: &str = include_str!("../../controllers/recommended.toml");

/// Shipped model-based pulses for orifices of 1.9 mm.
pub const PULSES_1_9_MM_TOML: &str = include_str!("../../controllers/pulses-1.9mm.toml");
/// Shipped model-based pulses for orifices of 1.3 mm.
pub const PULSES_1_3_MM_TOML: &str = include_str!("../../controllers/pulses-1.3mm.toml");

/// Reads a controller file; errors use `name` for it. [`controller::Config::new`] accepts the result.
///
/// # Errors
/// Returns all problems of the file, each with line, allowed range and next step.
pub fn read(text: &str, name: &str) -> Result<Settings, ControllerFileError> {
    read::read(text, name)
}

/// Writes the settings as a controller file that reads back to the same bits.
pub fn write(settings: &Settings) -> String {
    write::write(settings)
}

/// Returns the shipped controller of the thesis.
pub fn thesis() -> Settings {
    read(THESIS_TOML, "thesis.toml").expect("the shipped file is read by a test")
}

/// Returns the shipped recommended controller.
pub fn recommended() -> Settings {
    read(RECOMMENDED_TOML, "recommended.toml").expect("the shipped file is read by a test")
}

/// Returns the shipped model-based pulses for orifices of 1.9 mm.
pub fn pulses_1_9_mm() -> Settings {
    read(PULSES_1_9_MM_TOML, "pulses-1.9mm.toml").expect("the shipped file is read by a test")
}

/// Returns the shipped model-based pulses for orifices of 1.3 mm.
pub fn pulses_1_3_mm() -> Settings {
    read(PULSES_1_3_MM_TOML, "pulses-1.3mm.toml").expect("the shipped file is read by a test")
}
