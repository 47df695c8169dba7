//! Table of settings: that of the controller, followed by that of the ECU.

use controller::{Field, SettingSpec};
use hil_protocol::crc32::Digest;

use crate::settings::EcuSettings;
use crate::table::EcuField;

/// Setting of an ECU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SettingId {
    /// Setting of the controller.
    Controller(Field),
    /// Setting of the ECU itself.
    Ecu(EcuField),
}

/// Number of settings.
pub const SETTING_COUNT: usize = Field::COUNT + EcuField::COUNT;

/// All settings, in the order of their numbers.
pub static SETTINGS: [SettingSpec; SETTING_COUNT] = TABLE;

const TABLE: [SettingSpec; SETTING_COUNT] = {
    let mut table = [*Field::SampleTime.spec(); SETTING_COUNT];
    let mut row = 0;
    while row < SETTING_COUNT {
        table[row] = *SettingId::ALL[row].spec();
        row += 1;
    }
    table
};

impl SettingId {
    /// All settings, in the order of their numbers.
    pub const ALL: [Self; SETTING_COUNT] = {
        let mut all = [Self::Controller(Field::SampleTime); SETTING_COUNT];
        let mut row = 0;
        while row < Field::COUNT {
            all[row] = Self::Controller(Field::ALL[row]);
            row += 1;
        }
        while row < SETTING_COUNT {
            all[row] = Self::Ecu(EcuField::ALL[row - Field::COUNT]);
            row += 1;
        }
        all
    };

    /// Returns the number of the setting in messages: its row in [`SETTINGS`].
    pub const fn number(self) -> u16 {
        match self {
            Self::Controller(field) => field as u16,
            Self::Ecu(field) => (field as u16).wrapping_add(Field::COUNT as u16),
        }
    }

    /// Returns the description of the setting.
    pub const fn spec(self) -> &'static SettingSpec {
        match self {
            Self::Controller(field) => field.spec(),
            Self::Ecu(field) => field.spec(),
        }
    }

    /// Returns how many words a choice has; 0 for a quantity.
    pub(super) const fn choice_count(self) -> usize {
        match self {
            Self::Controller(field) => field.choice_count(),
            Self::Ecu(field) => field.choice_count(),
        }
    }

    /// Returns the setting with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|id| id.spec().name == name)
    }

    /// Returns the bits of a quantity or the number of a choice; `None` if the choices do not use the quantity.
    pub(super) fn get(self, settings: &EcuSettings) -> Option<i32> {
        match self {
            Self::Controller(field) => field.get(&settings.controller),
            Self::Ecu(field) => field.get(settings),
        }
    }

    /// Sets the bits of a quantity or the number of a choice; returns false if nothing was set.
    pub(super) fn set(self, settings: &mut EcuSettings, value: i32) -> bool {
        match self {
            Self::Controller(field) => field.set(&mut settings.controller, value),
            Self::Ecu(field) => field.set(settings, value),
        }
    }
}

/// CRC-32 of the table: names, units, choices, each terminated by a zero.
pub const SETTINGS_DIGEST: u32 = digest();

const fn digest() -> u32 {
    let mut digest = Digest::new();
    let mut row = 0;
    while row < SETTING_COUNT {
        let SettingSpec {
            name,
            unit,
            choices,
            ..
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
