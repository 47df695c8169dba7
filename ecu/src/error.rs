//! Errors in the settings of an ECU.

use core::fmt;

use controller::ConfigError;
use controller::fixed::types::I16F16;

/// Reason why [`EcuSettings`](crate::EcuSettings) give no configuration. No ECU can run with such settings: correct the
/// named field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EcuConfigError {
    /// Error in the controller's settings.
    #[error("controller: {0}")]
    Controller(#[from] ConfigError),
    /// A field of the supervision outside its range.
    #[error("{field} = {value} {unit} is out of range: must be {min} ..= {max} {unit}", unit = field.unit())]
    OutOfRange {
        /// Rejected field.
        field: SupervisionField,
        /// Value of the field.
        value: I16F16,
        /// Smallest allowed value.
        min: I16F16,
        /// Largest allowed value.
        max: I16F16,
    },
}

/// Field of [`Supervision`](crate::Supervision).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SupervisionField {
    /// `supply_pressure_min_bar`
    SupplyPressureMin,
    /// `supply_pressure_max_bar`
    SupplyPressureMax,
    /// `fill_rate_per_s`
    FillRate,
    /// `vent_rate_per_s`
    VentRate,
    /// `open_duty_fill_pct`
    OpenDutyFill,
    /// `open_duty_vent_pct`
    OpenDutyVent,
    /// `valve_settling_ms`
    ValveSettling,
    /// `ramp_bar_per_s`
    Ramp,
    /// `battery_min_v`
    BatteryMin,
    /// `battery_max_v`
    BatteryMax,
    /// `coil_current_min_ma`
    CoilCurrentMin,
    /// `coil_current_max_ma`
    CoilCurrentMax,
}

impl SupervisionField {
    /// Returns the field's name in [`Supervision`](crate::Supervision).
    pub const fn name(self) -> &'static str {
        match self {
            Self::SupplyPressureMin => "supply_pressure_min_bar",
            Self::SupplyPressureMax => "supply_pressure_max_bar",
            Self::FillRate => "fill_rate_per_s",
            Self::VentRate => "vent_rate_per_s",
            Self::OpenDutyFill => "open_duty_fill_pct",
            Self::OpenDutyVent => "open_duty_vent_pct",
            Self::ValveSettling => "valve_settling_ms",
            Self::Ramp => "ramp_bar_per_s",
            Self::BatteryMin => "battery_min_v",
            Self::BatteryMax => "battery_max_v",
            Self::CoilCurrentMin => "coil_current_min_ma",
            Self::CoilCurrentMax => "coil_current_max_ma",
        }
    }

    /// Returns the smallest and largest allowed value; another field may narrow the range.
    pub const fn range(self) -> [I16F16; 2] {
        // Constants, so that the compiler parses the decimal text and not the target.
        const PRESSURE: [I16F16; 2] = range("1", "15");
        const RATE: [I16F16; 2] = range("0.1", "50");
        const DUTY: [I16F16; 2] = range("1", "100");
        const SETTLING: [I16F16; 2] = range("1", "1000");
        const RAMP: [I16F16; 2] = range("0.1", "100");
        const BATTERY: [I16F16; 2] = range("5", "60");
        const CURRENT: [I16F16; 2] = range("1", "10000");
        match self {
            Self::SupplyPressureMin | Self::SupplyPressureMax => PRESSURE,
            Self::FillRate | Self::VentRate => RATE,
            Self::OpenDutyFill | Self::OpenDutyVent => DUTY,
            Self::ValveSettling => SETTLING,
            Self::Ramp => RAMP,
            Self::BatteryMin | Self::BatteryMax => BATTERY,
            Self::CoilCurrentMin | Self::CoilCurrentMax => CURRENT,
        }
    }

    /// Returns the unit of the field.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::SupplyPressureMin | Self::SupplyPressureMax => "bar",
            Self::FillRate | Self::VentRate => "1/s",
            Self::OpenDutyFill | Self::OpenDutyVent => "%",
            Self::ValveSettling => "ms",
            Self::Ramp => "bar/s",
            Self::BatteryMin | Self::BatteryMax => "V",
            Self::CoilCurrentMin | Self::CoilCurrentMax => "mA",
        }
    }
}

const fn range(min: &str, max: &str) -> [I16F16; 2] {
    [I16F16::lit(min), I16F16::lit(max)]
}

impl fmt::Display for SupervisionField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
