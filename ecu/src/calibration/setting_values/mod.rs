//! Conversion of settings into numbers and back.

mod refusal;

use hil_protocol::Refusal;
use hil_protocol::crc32::values_digest;

use super::checked::CheckedSettings;
use super::setting::{SETTING_COUNT, SettingId};
use crate::settings::EcuSettings;
use refusal::refusal;

/// All settings as numbers of the table; they may be invalid.
///
/// A quantity that the choices do not use is 0. It may have any value when it comes from a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SettingValues([i32; SETTING_COUNT]);

const LAST: u16 = SETTING_COUNT as u16 - 1;

impl SettingValues {
    /// Returns the numbers of these settings.
    pub fn of(settings: &EcuSettings) -> Self {
        let number = |id: SettingId| id.get(settings).unwrap_or(0);
        Self(SettingId::ALL.map(number))
    }

    /// Returns the settings with these numbers. Only the choices are checked here.
    ///
    /// # Errors
    /// Returns the first choice that does not exist.
    pub fn settings(&self) -> Result<EcuSettings, Refusal> {
        // Every choice is replaced, and then every number that the choices use.
        let mut settings = EcuSettings::bench();
        for (id, value) in SettingId::ALL.into_iter().zip(self.0) {
            let choices = id.choice_count();
            if !id.set(&mut settings, value) && choices > 0 {
                return Err(Refusal::OutOfRange {
                    id: id.number(),
                    value,
                    min: 0,
                    max: choices as i32 - 1,
                    bound_by: None,
                });
            }
        }
        Ok(settings)
    }

    /// Creates the values from numbers in the order of the table.
    pub const fn from_array(values: [i32; SETTING_COUNT]) -> Self {
        Self(values)
    }

    /// Returns the numbers, in the order of the table.
    pub const fn as_array(&self) -> &[i32; SETTING_COUNT] {
        &self.0
    }

    /// Returns the CRC-32 of all numbers.
    pub fn digest(&self) -> u32 {
        values_digest(&self.0)
    }

    /// Returns the number of one setting.
    #[inline]
    pub const fn get(&self, id: SettingId) -> i32 {
        self.0[id.number() as usize]
    }

    /// Replaces the number of one setting.
    #[inline]
    pub const fn set(&mut self, id: SettingId, value: i32) {
        self.0[id.number() as usize] = value;
    }

    /// Replaces the numbers of consecutive settings, either all or none.
    ///
    /// # Errors
    /// Returns the first number that belongs to no setting.
    pub fn set_from(&mut self, first: u16, values: &[i32]) -> Result<(), Refusal> {
        let start = usize::from(first);
        let end = start.saturating_add(values.len());
        let Some(places) = self.0.get_mut(start..end) else {
            let beyond = start.max(SETTING_COUNT);
            return Err(Refusal::UnknownSetting {
                id: u16::try_from(beyond).unwrap_or(u16::MAX),
                last: LAST,
            });
        };
        for (place, &value) in places.iter_mut().zip(values) {
            *place = value;
        }
        Ok(())
    }

    /// Returns the settings with these numbers, checked as a whole.
    ///
    /// # Errors
    /// Returns the first invalid number, with its bounds.
    pub fn checked(&self) -> Result<CheckedSettings, Refusal> {
        CheckedSettings::new(&self.settings()?).map_err(|error| refusal(&error))
    }
}
