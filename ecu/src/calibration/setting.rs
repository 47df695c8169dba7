//! Table of settings.

use hil_protocol::crc32::Digest;

/// Description of one setting: the meaning of its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Name of the field in [`EcuSettings`](crate::EcuSettings), with its unit at the end.
    pub name: &'static str,
    /// Unit of the setting; the number counts 2⁻¹⁶ of it. Empty for a choice.
    pub unit: &'static str,
    /// Allowed choices, beginning with number 0; empty for a quantity.
    pub choices: &'static [&'static str],
}

macro_rules! settings {
    ($($id:ident: $name:literal, $unit:literal, [$($choice:literal),*];)*) => {
        /// Number of a setting: its row in [`SETTINGS`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u16)]
        pub enum SettingId {
            $(#[doc = concat!("`", $name, "`")] $id,)*
        }

        /// Number of settings.
        pub const SETTING_COUNT: usize = [$(SettingId::$id),*].len();

        impl SettingId {
            /// All settings, in the order of the table.
            pub const ALL: [Self; SETTING_COUNT] = [$(Self::$id),*];
        }

        /// All settings, in the order of their numbers.
        pub static SETTINGS: [Setting; SETTING_COUNT] = TABLE;

        const TABLE: [Setting; SETTING_COUNT] = [
            $(Setting { name: $name, unit: $unit, choices: &[$($choice),*] },)*
        ];
    };
}

settings! {
    SampleTime: "sample_time_ms", "ms", [];
    Gain: "gain_pct_per_bar", "%/bar", [];
    IntegralAction: "integral_action", "", ["off", "on"];
    IntegralTime: "integral_time_ms", "ms", [];
    DerivativeAction: "derivative_action", "", ["off", "on"];
    DerivativeTime: "derivative_time_ms", "ms", [];
    IntegralMax: "integral_max_pct", "%", [];
    IntegralAtReference: "integral_at_reference", "", ["hold", "clear"];
    AntiWindup: "anti_windup", "", ["off", "conditional_integration", "back_calculation"];
    TrackingTime: "tracking_time_ms", "ms", [];
    Tolerance: "tolerance_bar", "bar", [];
    Prediction: "prediction", "", ["off", "one_step", "two_step"];
    PredictionBasis: "prediction_basis", "", ["error", "pressure"];
    SwitchOff: "switch_off", "", ["inside_tolerance", "inside_or_beyond"];
    Boost: "boost", "", ["off", "on"];
    BoostRate: "boost_rate_pct_per_bar_s", "%/(bar s)", [];
    BoostMax: "boost_max_pct", "%", [];
    BoostResponse: "boost_response_bar", "bar", [];
    Distributor: "distributor", "", ["traditional", "scheme_1", "scheme_2"];
    DutyMiddleFill: "middle_fill_pct", "%", [];
    DutyMiddleVent: "middle_vent_pct", "%", [];
    DutyMin: "duty_min", "", ["constant", "pressure_dependent"];
    DutyMinFill: "duty_min_fill_pct", "%", [];
    DutyHalfFill: "duty_min_fill_at_half_supply_pressure_pct", "%", [];
    DutyMinFillWithSupplyPressure: "duty_min_fill_with_supply_pressure_pct", "%", [];
    DutyMinVent: "duty_min_vent_pct", "%", [];
    DutyHalfVent: "duty_min_vent_at_half_supply_pressure_pct", "%", [];
    DutyMinVentWithSupplyPressure: "duty_min_vent_with_supply_pressure_pct", "%", [];
    DutyMaxFill: "duty_max_fill_pct", "%", [];
    DutyMaxVent: "duty_max_vent_pct", "%", [];
    SupplyPressure: "supply_pressure_bar", "bar gauge", [];
    VentValve: "vent_valve", "", ["normally_closed", "normally_open"];
    SupplyPressureMin: "supply_pressure_min_bar", "bar gauge", [];
    SupplyPressureMax: "supply_pressure_max_bar", "bar gauge", [];
    FillRate: "fill_rate_per_s", "1/s", [];
    VentRate: "vent_rate_per_s", "1/s", [];
    OpenDutyFill: "open_duty_fill_pct", "%", [];
    OpenDutyVent: "open_duty_vent_pct", "%", [];
    ValveSettling: "valve_settling_ms", "ms", [];
    Ramp: "ramp_bar_per_s", "bar/s", [];
    BatteryMin: "battery_min_v", "V", [];
    BatteryMax: "battery_max_v", "V", [];
    CoilCurrentMin: "coil_current_min_ma", "mA", [];
    CoilCurrentMax: "coil_current_max_ma", "mA", [];
}

impl SettingId {
    /// Returns the setting's row in the table.
    pub const fn setting(self) -> &'static Setting {
        &TABLE[self as usize]
    }

    /// Returns the number of the setting with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|id| id.setting().name == name)
    }
}

/// CRC-32 of the table: names, units, choices, each terminated by a zero.
pub const SETTINGS_DIGEST: u32 = digest();

const fn digest() -> u32 {
    let mut digest = Digest::new();
    let mut row = 0;
    while row < SETTING_COUNT {
        let Setting {
            name,
            unit,
            choices,
        } = TABLE[row];
        digest.update_text(name);
        digest.update_text(unit);
        let mut choice = 0;
        while choice < choices.len() {
            digest.update_text(choices[choice]);
            choice += 1;
        }
        digest.update(0);
        row += 1;
    }
    digest.value()
}
