//! Errors in the settings of an ECU.

use controller::ConfigError;
use controller::fixed::types::I16F16;

use crate::table::EcuField;

/// Reason why [`EcuSettings`](crate::EcuSettings) give no configuration. No ECU can run with such settings: correct the
/// named field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EcuConfigError {
    /// Error in the controller's settings.
    #[error("controller: {0}")]
    Controller(#[from] ConfigError),
    /// Model-based pulses on a vent valve that is open without current: their tables are those of a valve that a current
    /// opens.
    #[error(
        "model-based pulses need a vent valve that is closed without current: leave out the table [pulses], or set \
         vent_valve to normally closed"
    )]
    PulsesOnNormallyOpen,
    /// A field of the supervision outside its range.
    #[error("{field} = {value} {unit} is out of range: must be {min} ..= {max} {unit}", unit = field.unit())]
    OutOfRange {
        /// Rejected field.
        field: EcuField,
        /// Value of the field.
        value: I16F16,
        /// Smallest allowed value.
        min: I16F16,
        /// Largest allowed value.
        max: I16F16,
    },
}
