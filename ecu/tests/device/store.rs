//! Settings store, without losses of supply.

use ecu::calibration::{SettingId, SettingValues};
use ecu::controller::Field;
use ecu::store::{RamFlash, SettingsStore, StoreError};
use hil_protocol::SettingsSource;
use hil_protocol::crc32;

use crate::flash::Flash;
use crate::support::{defaults, with_gain};

fn load(flash: &Flash) -> (SettingValues, SettingsSource) {
    let (settings, source) = SettingsStore::new(flash.clone()).load(&defaults());
    (SettingValues::of(settings.settings()), source)
}

fn saved(gains: &[i32]) -> Flash {
    let mut store = SettingsStore::new(Flash::new(2));
    for &gain in gains {
        store.save(&with_gain(gain)).unwrap();
    }
    store.into_flash()
}

fn stored(copy: u8, sequence: u32, other_damaged: bool) -> SettingsSource {
    SettingsSource::Stored {
        copy,
        sequence,
        other_damaged,
    }
}

#[test]
fn a_new_ecu_starts_with_the_built_in_settings_and_says_so() {
    let (found, source) = load(&Flash::new(2));
    assert_eq!(found, SettingValues::of(defaults().settings()));
    assert_eq!(source, SettingsSource::DefaultsNeverSaved);
}

#[test]
fn the_newest_of_two_copies_is_taken() {
    for saves in 1..6_usize {
        let gains: Vec<i32> = (1..=saves as i32).map(|save| 10 * save).collect();
        let expected = stored((saves as u8 + 1) % 2, saves as u32 - 1, false);
        assert_eq!(
            load(&saved(&gains)),
            (with_gain(10 * saves as i32), expected)
        );
    }
}

#[test]
fn any_flipped_bit_is_found_and_the_other_copy_is_taken() {
    let flash = saved(&[10, 20]);
    for bit in 0..8 * flash.bytes.len() {
        let mut damaged = flash.clone();
        damaged.bytes[bit / 8] ^= 1 << (bit % 8);
        let expected = if bit / 8 < Flash::PAGE {
            (with_gain(20), stored(1, 1, true))
        } else {
            (with_gain(10), stored(0, 0, true))
        };
        assert_eq!(load(&damaged), expected, "bit {bit}");
    }
}

#[test]
fn two_damaged_copies_mean_the_built_in_settings_and_it_is_reported() {
    let mut flash = saved(&[10, 20]);
    flash.bytes[100] ^= 1;
    flash.bytes[Flash::PAGE + 100] ^= 1;
    let built_in = SettingValues::of(defaults().settings());
    assert_eq!(load(&flash), (built_in, SettingsSource::DefaultsDamaged));
}

/// Corrects the record's checksum after a change, so that only its contents are wrong.
fn rechecked(flash: &mut Flash) {
    let length = usize::from(u16::from_le_bytes([flash.bytes[6], flash.bytes[7]]));
    let check = crc32::digest(&flash.bytes[..length - 4]).to_le_bytes();
    flash.bytes[length - 4..length].copy_from_slice(&check);
}

#[test]
fn a_copy_of_another_format_version_length_or_table_is_not_taken() {
    for word in [0, 4, 6, 12] {
        let mut flash = saved(&[10]);
        flash.bytes[word] ^= 1;
        rechecked(&mut flash);
        assert_eq!(
            load(&flash).1,
            SettingsSource::DefaultsDamaged,
            "byte {word}"
        );
    }
    // The sequence number may have any value: the record is valid only because the checksum was corrected.
    let mut flash = saved(&[10]);
    flash.bytes[8] ^= 1;
    rechecked(&mut flash);
    assert_eq!(load(&flash).1, stored(0, 1, false));
}

#[test]
fn a_whole_copy_with_impossible_settings_is_not_taken() {
    let mut flash = saved(&[10]);
    let gain = 16 + 4 * SettingId::Controller(Field::Gain).number() as usize;
    flash.bytes[gain..gain + 4].copy_from_slice(&(-1_i32).to_le_bytes());
    rechecked(&mut flash);
    assert_eq!(load(&flash).1, SettingsSource::DefaultsDamaged);
}

#[test]
fn sequence_numbers_go_round() {
    let mut flash = saved(&[10]);
    flash.bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    rechecked(&mut flash);
    let mut store = SettingsStore::new(flash);
    assert_eq!(store.save(&with_gain(20)), Ok(stored(1, 0, false)));
    let flash = store.into_flash();
    assert_eq!(load(&flash), (with_gain(20), stored(1, 0, false)));
}

#[test]
fn a_worn_memory_is_named_and_costs_the_newer_copy_nothing() {
    let mut flash = saved(&[10]);
    flash.worn = Some(Flash::PAGE + 30);
    let mut store = SettingsStore::new(flash);
    assert_eq!(
        store.save(&with_gain(20)),
        Err(StoreError::Verify { copy: 1 })
    );
    assert_eq!(
        load(&store.into_flash()),
        (with_gain(10), stored(0, 0, true))
    );
}

#[test]
fn a_memory_for_one_copy_is_refused_before_it_is_touched() {
    let mut store = SettingsStore::new(Flash::new(1));
    let error = store.save(&with_gain(10)).unwrap_err();
    assert_eq!(
        error,
        StoreError::TooSmall {
            bytes: Flash::PAGE,
            needed: SettingsStore::<Flash>::BYTES
        }
    );
    assert_eq!(store.into_flash().bytes, Flash::new(1).bytes);
}

#[test]
fn memory_that_is_no_flash_does_as_well() {
    const BYTES: usize = SettingsStore::<RamFlash<0>>::BYTES;
    let mut store = SettingsStore::new(RamFlash::<BYTES>::new());
    store.save(&with_gain(10)).unwrap();
    store.save(&with_gain(20)).unwrap();
    let (settings, source) = store.load(&defaults());
    assert_eq!(SettingValues::of(settings.settings()), with_gain(20));
    assert_eq!(source, stored(1, 1, false));
}
