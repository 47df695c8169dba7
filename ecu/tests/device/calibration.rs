//! Tables of settings and signals.

use std::collections::HashSet;

use ecu::calibration::{
    CheckedSettings, MISSING, SETTING_COUNT, SETTINGS, SIGNALS, SettingId, SettingValues, SignalId,
    Snapshot,
};
use ecu::controller::{Field, Settings};
use ecu::{EcuField, EcuSettings, Inputs};
use hil_protocol::{Actuators, Refusal, Telemetry, VALUES_MAX};
use proptest::prelude::*;

use crate::support::healthy;

/// Returns values with every choice in use, so that every number counts.
fn all_in_use() -> SettingValues {
    let one = 1 << 16;
    let mut values = SettingValues::of(&EcuSettings::bench());
    for (id, value) in [
        (SettingId::Controller(Field::AntiWindup), 2),
        (SettingId::Controller(Field::TrackingTime), 200 * one),
        (SettingId::Controller(Field::Distributor), 2),
        (SettingId::Controller(Field::DutyMiddleFill), 60 * one),
        (SettingId::Controller(Field::DutyMiddleVent), 60 * one),
    ] {
        values.set(id, value);
    }
    let pulses = EcuSettings {
        controller: Settings::pulses(),
        ..EcuSettings::bench()
    };
    for field in Field::ALL.into_iter().skip(Field::Pulses as usize) {
        let id = SettingId::Controller(field);
        values.set(id, SettingValues::of(&pulses).get(id));
    }
    assert!(values.checked().is_ok());
    values
}

#[test]
fn names_are_unique_and_end_in_their_unit() {
    let names: HashSet<&str> = SETTINGS.iter().map(|setting| setting.name).collect();
    assert_eq!(names.len(), SETTING_COUNT);
    for setting in &SETTINGS {
        let suffix = match setting.unit {
            "" => "",
            "ms" => "_ms",
            "%" => "_pct",
            "bar" | "bar gauge" => "_bar",
            "%/bar" => "_pct_per_bar",
            "%/(bar s)" => "_pct_per_bar_s",
            "bar/s" => "_bar_per_s",
            "1/s" => "_per_s",
            "V" => "_v",
            "mA" => "_ma",
            "ohm" => "_ohm",
            "mm" => "_mm",
            other => panic!("{}: unit {other}", setting.name),
        };
        assert!(setting.name.ends_with(suffix), "{setting:?}");
        assert_eq!(setting.unit.is_empty(), setting.choices.len() > 1);
    }
    let names: HashSet<&str> = SIGNALS.iter().map(|signal| signal.name).collect();
    assert_eq!(names.len(), SIGNALS.len());
}

#[test]
fn a_name_leads_to_its_number_and_back() {
    for (number, setting) in SETTINGS.iter().enumerate() {
        let id = SettingId::named(setting.name).unwrap();
        assert_eq!((id.number() as usize, id.spec()), (number, setting));
    }
    for (number, signal) in SIGNALS.iter().enumerate() {
        let id = SignalId::named(signal.name).unwrap();
        assert_eq!((id as usize, id.signal()), (number, signal));
        assert_eq!(SignalId::numbered(number as u16), Some(id));
    }
    assert_eq!(SettingId::named("gain"), None);
    assert_eq!(SignalId::numbered(SIGNALS.len() as u16), None);
}

#[test]
fn all_settings_fit_into_one_message() {
    const { assert!(SETTING_COUNT <= VALUES_MAX) };
}

#[test]
fn a_quantity_out_of_range_is_refused_under_its_own_number() {
    for id in SettingId::ALL {
        if !id.spec().choices.is_empty() {
            continue;
        }
        for wrong in [i32::MIN, i32::MAX] {
            let mut values = all_in_use();
            values.set(id, wrong);
            let Err(Refusal::OutOfRange {
                id: found,
                value,
                min,
                max,
                bound_by,
            }) = values.checked()
            else {
                panic!("{} = {wrong} is accepted", id.spec().name);
            };
            assert_eq!((found, value), (id.number(), wrong), "{}", id.spec().name);
            assert!(min <= max && !(min..=max).contains(&wrong));
            assert_ne!(bound_by, Some(id.number()));
        }
    }
}

#[test]
fn a_choice_that_does_not_exist_is_refused_under_its_own_number() {
    for id in SettingId::ALL {
        let choices = id.spec().choices.len() as i32;
        if choices == 0 {
            continue;
        }
        let mut seen = HashSet::new();
        for choice in 0..choices {
            let mut values = all_in_use();
            values.set(id, choice);
            let settings = values.settings().unwrap();
            assert_eq!(SettingValues::of(&settings).get(id), choice);
            assert!(seen.insert(SettingValues::of(&settings)));
        }
        for wrong in [i32::MIN, -1, choices, i32::MAX] {
            let mut values = all_in_use();
            values.set(id, wrong);
            let expected = Refusal::OutOfRange {
                id: id.number(),
                value: wrong,
                min: 0,
                max: choices - 1,
                bound_by: None,
            };
            assert_eq!(values.settings(), Err(expected));
        }
    }
}

#[test]
fn a_number_bounded_by_another_names_it() {
    let mut values = all_in_use();
    values.set(SettingId::Controller(Field::DutyMaxFill), 40 << 16);
    let refusal = values.checked().unwrap_err();
    assert_eq!(
        refusal,
        Refusal::OutOfRange {
            id: SettingId::Controller(Field::DutyMaxFill).number(),
            value: 40 << 16,
            min: values.get(SettingId::Controller(Field::DutyMinFill)),
            max: 100 << 16,
            bound_by: Some(SettingId::Controller(Field::DutyMinFill).number()),
        }
    );
}

#[test]
fn numbers_that_are_impossible_together_are_refused() {
    let mut values = all_in_use();
    values.set(SettingId::Controller(Field::Gain), 1_000 << 16);
    values.set(SettingId::Controller(Field::IntegralTime), 1 << 16);
    assert!(
        matches!(values.checked(), Err(Refusal::Product { .. })),
        "{:?}",
        values.checked()
    );
}

#[test]
fn numbers_beyond_the_table_are_refused_and_none_is_taken() {
    let last = SETTING_COUNT as u16 - 1;
    let mut values = all_in_use();
    for (first, count, id) in [
        (last, 2, last + 1),
        (last + 1, 1, last + 1),
        (u16::MAX, 64, u16::MAX),
    ] {
        let refusal = values.set_from(first, &vec![1; count]).unwrap_err();
        assert_eq!(refusal, Refusal::UnknownSetting { id, last });
    }
    assert_eq!(values, all_in_use());
    values.set_from(last, &[1]).unwrap();
    assert_eq!(values.get(SettingId::Ecu(EcuField::CoilCurrentMax)), 1);
}

/// Each number has its own place: settings that differ in one number differ in one field.
#[test]
fn each_number_belongs_to_one_field() {
    let base = all_in_use();
    let mut seen = vec![base.settings().unwrap()];
    for id in SettingId::ALL {
        if !id.spec().choices.is_empty() {
            continue;
        }
        let mut values = base;
        values.set(id, values.get(id) + 1);
        let settings = values.settings().unwrap();
        assert!(!seen.contains(&settings), "{}", id.spec().name);
        seen.push(settings);
        assert_eq!(SettingValues::of(&settings), values);
    }
}

proptest! {
    /// Numbers that are not in use come back as 0; further conversions do not change the settings.
    #[test]
    fn settings_and_numbers_are_the_same_thing(
        quantities in prop::array::uniform::<_, SETTING_COUNT>(any::<i32>()),
        choices in prop::array::uniform::<_, SETTING_COUNT>(any::<u32>()),
    ) {
        let mut values = SettingValues::from_array(quantities);
        for id in SettingId::ALL {
            let count = id.spec().choices.len() as u32;
            if count > 0 {
                values.set(id, (choices[id.number() as usize] % count).cast_signed());
            }
        }
        let settings = values.settings().unwrap();
        let again = SettingValues::of(&settings);
        prop_assert_eq!(again.settings(), Ok(settings));
        for id in SettingId::ALL {
            prop_assert!(again.get(id) == values.get(id) || again.get(id) == 0);
        }
        prop_assert_eq!(again.checked().is_ok(), CheckedSettings::new(&settings).is_ok());
    }
}

#[test]
fn a_signal_reads_what_its_name_says() {
    let snapshot = Snapshot {
        sample: 7,
        inputs: Inputs::from(healthy(100)),
        actuators: Actuators {
            duty_fill: 11,
            duty_vent: 12,
        },
        telemetry: Telemetry {
            control_signal: 13,
            controller_state: [14, 15, 16, 17, 18, 19],
            mode: 20,
            faults: 0x8000_0001,
            ecu_digest: 0xFFFF_FFFE,
        },
    };
    let sensors = healthy(100);
    let expected = [
        ("sample", 7),
        ("elapsed", 10_000),
        ("p_ref", sensors.reference.unwrap()),
        ("pressure_code", i32::from(sensors.pressure.unwrap())),
        ("p_ch_measured", snapshot.signal(SignalId::Pressure)),
        ("i_fill", MISSING),
        ("i_vent", MISSING),
        ("u_bat", 24_000),
        ("duty_fill", 11),
        ("duty_vent", 12),
        ("u", 13),
        ("controller_pressure", 14),
        ("controller_error", 15),
        ("integral_low_word", 16),
        ("integral", 17),
        ("boost_low_word", 18),
        ("boost", 19),
        ("mode", 20),
        ("faults", 0x8000_0001_u32.cast_signed()),
        ("ecu_digest", -2),
    ];
    let found = SignalId::ALL.map(|id| (id.signal().name, snapshot.signal(id)));
    assert_eq!(found, expected);
    let pressure = snapshot.signal(SignalId::Pressure);
    assert!(
        (pressure - (75 << 16) * 3 / 200).abs() < 1_000,
        "{pressure}"
    );
}
