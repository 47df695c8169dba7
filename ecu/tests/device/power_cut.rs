//! Loss of supply at every byte of a save, and again at every byte of the next save. A start then has the old settings
//! or those that were being saved, never a mix and never the built-in ones.

use ecu::calibration::SettingValues;
use ecu::store::SettingsStore;
use hil_protocol::SettingsSource;

use crate::flash::{Cut, Flash};
use crate::support::{defaults, with_gain};

/// Number of bytes that a save changes: a page is erased, a record written.
const TOUCHED: usize = 2 * Flash::PAGE;

/// Two bytes that are neither old nor new represent random ones.
const CUTS: [Cut; 5] = [
    Cut::Old,
    Cut::New,
    Cut::Erased,
    Cut::Other(0x5A),
    Cut::Other(0),
];

fn store(flash: Flash) -> SettingsStore<Flash> {
    SettingsStore::new(flash)
}

/// Returns the settings of a start, and their source.
fn started(flash: &Flash) -> (SettingValues, SettingsSource) {
    let (settings, source) = store(flash.clone()).load(&defaults());
    (SettingValues::of(settings.settings()), source)
}

/// Returns flash memory in which `values` were saved last, into copy 0 after an odd number of saves.
fn saved(saves: usize, values: &SettingValues) -> Flash {
    let mut store = store(Flash::new(2));
    for _ in 1..saves {
        store.save(&with_gain(11)).unwrap();
    }
    store.save(values).unwrap();
    store.into_flash()
}

/// Returns `flash` after a save during which the supply failed.
fn cut_while_saving(flash: &Flash, values: &SettingValues, at: usize, cut: Cut) -> Flash {
    let mut flash = flash.clone();
    flash.until_cut = Some((at, cut));
    let mut store = store(flash);
    assert!(store.save(values).is_err());
    store.into_flash().revived()
}

#[test]
fn a_save_that_is_cut_leaves_the_old_settings_or_the_new() {
    let (old, new) = (with_gain(22), with_gain(33));
    let mut outcomes = [0, 0];
    for saves in [2, 3] {
        let flash = saved(saves, &old);
        for at in 0..TOUCHED {
            for cut in CUTS {
                let (found, source) = started(&cut_while_saving(&flash, &new, at, cut));
                assert!(
                    found == old || found == new,
                    "{saves} saves, byte {at}, {cut:?}"
                );
                assert!(matches!(source, SettingsSource::Stored { .. }));
                outcomes[usize::from(found == new)] += 1;
            }
        }
    }
    assert_eq!(outcomes.iter().sum::<usize>(), 2 * TOUCHED * CUTS.len());
    // Both outcomes occur: near the end the record is whole before its filling is, which gets shorter with each setting.
    assert!(outcomes[0] > 4_000 && outcomes[1] > 20, "{outcomes:?}");
}

#[test]
fn a_second_cut_in_the_save_after_changes_nothing_about_that() {
    let (old, new, newer) = (with_gain(22), with_gain(33), with_gain(44));
    // Ends and middles of erasing, and of each part of the record.
    let first_cuts = [0, 1, 128, 255, 256, 259, 260, 268, 272, 400, 451, 511];
    for saves in [2, 3] {
        let flash = saved(saves, &old);
        for first in first_cuts {
            for first_cut in CUTS {
                let once = cut_while_saving(&flash, &new, first, first_cut);
                let (before, _) = started(&once);
                for second in 0..TOUCHED {
                    for second_cut in [Cut::Old, Cut::New, Cut::Erased, Cut::Other(0x5A)] {
                        let twice = cut_while_saving(&once, &newer, second, second_cut);
                        let (found, source) = started(&twice);
                        assert!(
                            found == before || found == newer,
                            "{saves} saves, bytes {first} {first_cut:?} and {second} {second_cut:?}"
                        );
                        assert!(matches!(source, SettingsSource::Stored { .. }));
                    }
                }
            }
        }
    }
}

#[test]
fn a_cut_in_the_very_first_save_leaves_the_built_in_settings_or_the_new() {
    let (built_in, new) = (SettingValues::of(defaults().settings()), with_gain(33));
    for at in 0..TOUCHED {
        for cut in CUTS {
            let flash = cut_while_saving(&Flash::new(2), &new, at, cut);
            let (found, source) = started(&flash);
            match source {
                SettingsSource::Stored { .. } => assert_eq!(found, new),
                SettingsSource::DefaultsNeverSaved | SettingsSource::DefaultsDamaged => {
                    assert_eq!(found, built_in);
                }
                SettingsSource::Link => panic!("nobody was on the link"),
            }
        }
    }
}

#[test]
fn a_save_after_a_cut_makes_both_copies_good_again() {
    let flash = cut_while_saving(&saved(2, &with_gain(22)), &with_gain(33), 300, Cut::Old);
    assert!(matches!(
        started(&flash).1,
        SettingsSource::Stored {
            other_damaged: true,
            ..
        }
    ));
    let mut store = store(flash);
    store.save(&with_gain(44)).unwrap();
    store.save(&with_gain(55)).unwrap();
    let (found, source) = started(&store.into_flash());
    assert_eq!(found, with_gain(55));
    assert!(matches!(
        source,
        SettingsSource::Stored {
            other_damaged: false,
            ..
        }
    ));
}
