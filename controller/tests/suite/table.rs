//! Table of settings: each row finds its own place in the settings.

use std::collections::HashSet;

use controller::{Coefficient, Field, Form, Settings};

use crate::support::configurations;

/// Returns settings in each of which another choice is in use, so that together they have every number.
fn every_choice() -> Vec<Settings> {
    let mut all = vec![Settings::recommended()];
    for field in Field::ALL {
        let numbers = 0..field.spec().choices.len() as i32;
        if !numbers.is_empty() {
            all = all
                .iter()
                .flat_map(|settings| {
                    numbers.clone().map(|number| {
                        let mut chosen = *settings;
                        assert!(field.set(&mut chosen, number));
                        chosen
                    })
                })
                .collect();
        }
    }
    all
}

#[test]
fn a_number_or_choice_that_is_set_is_read_back_and_changes_no_other_row() {
    let mut reached = HashSet::new();
    for before in every_choice() {
        for field in Field::ALL {
            let Some(old) = field.get(&before) else {
                continue;
            };
            let count = field.spec().choices.len() as i32;
            if count > 0 {
                for number in 0..count {
                    let mut after = before;
                    assert!(field.set(&mut after, number));
                    assert_eq!(field.get(&after), Some(number), "{field}");
                    assert_eq!(after == before, number == old, "{field}");
                }
            } else {
                let mut after = before;
                assert!(field.set(&mut after, old + 1));
                let changed: Vec<Field> = Field::ALL
                    .into_iter()
                    .filter(|one| one.get(&after) != one.get(&before))
                    .collect();
                assert_eq!(changed, [field]);
            }
            reached.insert(field);
        }
    }
    assert_eq!(reached.len(), Field::COUNT);
}

#[test]
fn what_the_choices_do_not_use_has_no_value_no_key_and_cannot_be_set() {
    for before in every_choice() {
        for field in Field::ALL {
            let is_used = field.get(&before).is_some();
            assert_eq!(field.key(&before).is_some(), is_used, "{field}");
            let mut after = before;
            if !is_used {
                assert!(!field.set(&mut after, 1), "{field}");
                assert_eq!(after, before);
            }
        }
    }
}

#[test]
fn a_choice_that_does_not_exist_changes_nothing() {
    for (_, before) in configurations() {
        for field in Field::ALL {
            let count = field.spec().choices.len() as i32;
            for wrong in [i32::MIN, -1, count, i32::MAX] {
                let mut after = before;
                if count > 0 {
                    assert!(!field.set(&mut after, wrong), "{field} {wrong}");
                    assert_eq!(after, before);
                }
            }
        }
    }
}

#[test]
fn each_row_describes_either_a_number_with_its_range_or_a_choice() {
    let names: HashSet<&str> = Field::ALL.iter().map(|field| field.name()).collect();
    assert_eq!(names.len(), Field::COUNT);
    for field in Field::ALL {
        let spec = field.spec();
        let [min, max] = spec.range;
        let is_number = spec.form == Form::Number;
        assert_eq!(min < max, is_number, "{field}");
        assert_eq!(spec.choices.is_empty(), is_number, "{field}");
        assert_eq!(!spec.unit.is_empty(), is_number, "{field}");
        assert!(spec.about.len() > 5 && !spec.keys.is_empty(), "{field}");
        assert_eq!(field.to_string(), spec.name);
    }
}

/// A file and a message from a host are taken row by row: the choice comes before the numbers that it uses.
#[test]
fn settings_are_rebuilt_from_their_rows_in_the_order_of_the_table() {
    for settings in every_choice() {
        let mut rebuilt = Settings::thesis();
        for field in Field::ALL {
            if let Some(number) = field.get(&settings) {
                assert!(field.set(&mut rebuilt, number), "{field}");
            }
        }
        assert_eq!(rebuilt, settings);
    }
}

/// Defect seen: an image that reads whole descriptions links their texts, 5.9 KB.
#[test]
fn the_range_and_the_number_of_choices_are_those_of_the_description() {
    for field in Field::ALL {
        let spec = field.spec();
        assert_eq!(field.range(), spec.range, "{field}");
        assert_eq!(field.choice_count(), spec.choices.len(), "{field}");
    }
}

#[test]
fn a_coefficient_names_the_setting_on_which_only_it_depends() {
    for (coefficient, field) in [
        (Coefficient::Integral, Field::IntegralTime),
        (Coefficient::Derivative, Field::DerivativeTime),
        (Coefficient::Boost, Field::BoostRate),
    ] {
        assert_eq!(coefficient.factor(), field);
    }
}
