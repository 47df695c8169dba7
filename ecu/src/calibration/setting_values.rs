//! Settings as numbers, and back.

mod choices;
mod from_settings;
mod refusal;
mod to_settings;

use hil_protocol::Refusal;
use hil_protocol::crc32::values_digest;

use super::checked::CheckedSettings;
use super::setting::{SETTING_COUNT, SettingId};
use refusal::refusal;

/// All settings as the numbers of the table, which may or may not be possible ones.
///
/// A quantity that the choices leave without use is 0, and may be anything when it comes from a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SettingValues([i32; SETTING_COUNT]);

const LAST: u16 = SETTING_COUNT as u16 - 1;

impl SettingValues {
    /// The numbers, in the order of the table.
    pub const fn from_array(values: [i32; SETTING_COUNT]) -> Self {
        Self(values)
    }

    /// The numbers, in the order of the table.
    pub const fn as_array(&self) -> &[i32; SETTING_COUNT] {
        &self.0
    }

    /// CRC-32 over all of them.
    pub fn digest(&self) -> u32 {
        values_digest(&self.0)
    }

    /// The number of one setting.
    #[inline]
    pub const fn get(&self, id: SettingId) -> i32 {
        self.0[id as usize]
    }

    /// Another number for one setting.
    #[inline]
    pub const fn set(&mut self, id: SettingId, value: i32) {
        self.0[id as usize] = value;
    }

    /// Other numbers for settings that follow each other; all or none.
    ///
    /// # Errors
    /// The first number that no setting belongs to.
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

    /// The settings that have these numbers, checked as a whole.
    ///
    /// # Errors
    /// The first number that is impossible, with its bounds.
    pub fn checked(&self) -> Result<CheckedSettings, Refusal> {
        CheckedSettings::new(&self.settings()?).map_err(|error| refusal(&error))
    }
}
