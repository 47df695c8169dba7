//! Guesses of single columns and of whole files.

use super::*;

fn values(numbers: &[f64]) -> ColumnValues {
    ColumnValues::of(numbers)
}

/// Returns columns with these headers and values, without units.
fn subjects<'a, const N: usize>(
    headers: [&'a str; N],
    all: &'a [ColumnValues; N],
) -> Vec<Subject<'a>> {
    let pairs = headers.into_iter().zip(all);
    let subject = |(header, values)| Subject {
        header,
        unit: "",
        values,
    };
    pairs.map(subject).collect()
}

/// Returns the guesses for columns with these headers, units and values.
fn guesses(columns: &[(&str, &str, &[f64])]) -> Vec<ColumnGuess> {
    let all: Vec<ColumnValues> = columns
        .iter()
        .map(|(_, _, numbers)| values(numbers))
        .collect();
    let subjects: Vec<Subject> = columns
        .iter()
        .zip(&all)
        .map(|(&(header, unit, _), values)| Subject {
            header,
            unit,
            values,
        })
        .collect();
    guess(&subjects, None, false, &|_, _, _| None)
}

/// Returns signal and unit of a column beside a time.
fn one(header: &str, unit: &str, numbers: &[f64]) -> (Option<&'static str>, String) {
    let all = guesses(&[("time_s", "", &[0.0, 0.01, 0.02]), (header, unit, numbers)]);
    let unit = all[1]
        .unit
        .as_ref()
        .map_or("", GuessedUnit::token)
        .to_owned();
    (all[1].signal, unit)
}

#[test]
fn names_in_english_and_german_name_their_signal() {
    let (duty, pressure, milliampere) = ([0.0, 60.0, 100.0], [0.0, 3.0, 1.0], [0.0, 290.0, 5.0]);
    for (header, signal, unit, numbers) in [
        ("Tastverhältnis Füllventil [%]", "duty_fill", "pct", &duty),
        ("Fuellventil", "duty_fill", "pct", &duty),
        ("PWM_Entlueftung", "duty_vent", "pct", &duty),
        ("exhaust valve duty (%)", "duty_vent", "pct", &duty),
        ("InletValve", "duty_fill", "pct", &duty),
        ("Kammerdruck/bar", "p_ch", "bar", &pressure),
        ("Druck Kammer (barg)", "p_ch", "bar_gauge", &pressure),
        ("chamber pressure kPa", "p_ch", "kPa", &pressure),
        ("pChamber", "p_ch", "bar", &pressure),
        ("Druck", "p_ch", "bar", &pressure),
        ("Versorgungsdruck_bar", "p_sup", "bar", &pressure),
        ("p_in [BAR]", "p_sup", "bar", &pressure),
        ("Strom Füllventil [mA]", "i_fill", "mA", &milliampere),
        ("I_Entlueftungsventil_mA", "i_vent", "mA", &milliampere),
        ("UBat [V]", "u_bat", "V", &duty),
        ("Umgebungstemperatur in °C", "t_amb", "degC", &duty),
        ("Solldruck [bar abs]", "p_ref", "bar_abs", &pressure),
    ] {
        assert_eq!(
            one(header, "", numbers),
            (Some(signal), unit.to_owned()),
            "{header}"
        );
    }
    assert_eq!(
        one("Druck", "bar", &pressure),
        (Some("p_ch"), "bar".to_owned())
    );
}

#[test]
fn what_the_model_does_not_have_is_no_signal() {
    let numbers = [1.0, 2.0, 1.5];
    for header in [
        "Event",
        "Öldruck [bar]",
        "Volumenstrom",
        "Humidity [%]",
        "Index",
        "Drehzahl [1/min]",
        "",
    ] {
        assert_eq!(one(header, "", &numbers).0, None, "{header}");
    }
}

#[test]
fn values_tell_the_unit_of_a_duty_cycle() {
    let unit = |numbers: &[f64]| one("Fuellventil", "", numbers).1;
    assert_eq!(unit(&[0.0, 1.0, 0.0]), "frac");
    assert_eq!(unit(&[0.0, 0.6, 1.0]), "frac");
    assert_eq!(unit(&[0.0, 60.0, 1.0]), "pct");
    assert_eq!(unit(&[0.0, 1000.0, 600.0]), "permille");
    assert_eq!(unit(&[0.0, -5.0, 60.0]), "");
    let counts = guesses(&[("t_s", "", &[0.0, 1.0]), ("Fuellventil", "", &[0.0, 255.0])]);
    assert_eq!(counts[1].scale, Some(100.0 / 255.0));
    assert!(counts[1].assumed.contains("255 is 100 %"), "{counts:?}");
}

#[test]
fn the_time_is_the_named_column_or_the_first_that_increases() {
    let (steps, pressure) = ([0.0, 10.0, 20.0], [0.0, 1.0, 0.5]);
    let unit = |all: &[ColumnGuess], index: usize| {
        let unit = all[index].unit.as_ref().map_or("", GuessedUnit::token);
        (all[index].signal, unit.to_owned())
    };
    let all = guesses(&[
        ("Nr", "", &[1.0, 2.0, 3.0]),
        ("Zeit", "", &steps),
        ("Druck", "bar", &pressure),
    ]);
    assert_eq!(unit(&all, 1), (Some(TIME), "ms".to_owned()));
    assert_eq!(all[0].signal, None);
    let all = guesses(&[("A", "", &[5.0, 5.0, 5.0]), ("B", "", &[0.0, 0.01, 0.02])]);
    assert_eq!(unit(&all, 1), (Some(TIME), "s".to_owned()));
    assert!(
        all[1].assumed.contains("this column is the time"),
        "{all:?}"
    );
    let all = guesses(&[("Zeit [s]", "", &[0.0, 2.0, 1.0]), ("B", "", &pressure)]);
    assert_eq!(all[0].signal, None);
    assert!(all[0].reason.contains("does not increase"), "{all:?}");
}

#[test]
fn gauge_or_absolute_is_a_question_with_evidence() {
    let suggested = |numbers: &[f64]| {
        let all = guesses(&[
            ("time_s", "", &[0.0, 1.0, 2.0]),
            ("Druck [bar]", "", numbers),
        ]);
        match &all[1].question {
            Some(Question::Reference { suggested }) => {
                suggested.as_ref().map(|(reference, _)| *reference)
            }
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(suggested(&[0.02, 3.0, 1.0]), Some(PressureReference::Gauge));
    assert_eq!(
        suggested(&[1.01, 4.0, 2.0]),
        Some(PressureReference::Absolute)
    );
    assert_eq!(suggested(&[2.0, 4.0, 3.0]), None);
}

#[test]
fn a_sensor_voltage_asks_for_scale_and_offset() {
    let all = guesses(&[
        ("time_s", "", &[0.0, 1.0]),
        ("Kammerdruck [V]", "", &[0.5, 2.0]),
    ]);
    assert_eq!(all[1].signal, None);
    assert_eq!(all[1].question, Some(Question::Scale("p_ch")));
}

#[test]
fn states_without_a_name_are_valves_if_the_pressure_follows_them() {
    let columns = [
        ("time_s", [0.0, 1.0, 2.0]),
        ("p_ch_bar_gauge", [0.0, 3.0, 1.0]),
        ("DO 3", [0.0, 1.0, 0.0]),
        ("DO 4", [0.0, 0.0, 1.0]),
        ("constant", [1.0, 1.0, 1.0]),
    ];
    let all = columns.map(|(_, numbers)| values(&numbers));
    let subjects = subjects(columns.map(|(header, _)| header), &all);
    let rise = |valve: usize, _: Option<usize>, _: usize| Some(if valve == 2 { 0.9 } else { -0.9 });
    let found = guess(&subjects, None, false, &rise);
    assert_eq!(
        (found[2].signal, found[3].signal, found[4].signal),
        (Some("duty_fill"), Some("duty_vent"), None)
    );
    assert_eq!(
        found[2].reason,
        "values 0/1: a valve state; the pressure rises while it is on"
    );
}

/// Returns the guess of a column beside a time and a pressure that does not follow it.
fn beside_a_pressure(header: &str, numbers: &[f64]) -> ColumnGuess {
    let (time, pressure) = ([0.0, 1.0, 2.0], [0.0, 3.0, 1.0]);
    let columns: [(&str, &str, &[f64]); 3] = [
        ("time_s", "", &time),
        ("p_ch_bar_gauge", "", &pressure),
        (header, "", numbers),
    ];
    guesses(&columns).swap_remove(2)
}

#[test]
fn a_command_of_both_valves_fills_at_positive_numbers_unless_the_pressure_says_otherwise() {
    for (header, full) in [("state", 1.0), ("u", 1.0), ("valve command", 100.0)] {
        let found = beside_a_pressure(header, &[0.0, full, -full]);
        let pair = found.pair.unwrap();
        assert_eq!((pair.full, pair.signals), (full, DUTIES));
        assert_eq!(found.assumed, "positive numbers fill");
    }
    // No valve is named, and any signal may lie in this range.
    assert_eq!(
        beside_a_pressure("steering", &[0.0, 100.0, -100.0]).pair,
        None
    );
    assert_eq!(beside_a_pressure("state", &[0.5, 1.0, -1.0]).pair, None);
    assert_eq!(beside_a_pressure("voltage", &[0.0, 1.0, -1.0]).pair, None);
}

#[test]
fn equal_names_are_a_question_and_a_clearer_one_wins() {
    let (time, pressure) = ([0.0, 1.0, 2.0], [0.0, 3.0, 1.0]);
    let all = guesses(&[
        ("time_s", "", &time),
        ("p1 [bar]", "", &pressure),
        ("p2 [bar]", "", &pressure),
    ]);
    assert_eq!(all[1].question, Some(Question::Rival("p_ch")));
    let all = guesses(&[
        ("time_s", "", &time),
        ("p [bar]", "", &pressure),
        ("Kammerdruck [bar]", "", &pressure),
    ]);
    assert_eq!((all[1].signal, all[2].signal), (None, Some("p_ch")));
    let steady = [8.3, 8.4, 8.35];
    let all = guesses(&[
        ("time_s", "", &time),
        ("p1 [bar]", "", &steady),
        ("p2 [bar]", "", &pressure),
    ]);
    assert_eq!(
        (all[1].signal, all[2].signal),
        (Some("p_sup"), Some("p_ch"))
    );
}

#[test]
fn numbered_valves_are_named_by_what_the_pressure_does() {
    let named = |first: Option<f64>, second: Option<f64>| {
        let columns = [
            ("time_s", [0.0, 1.0, 2.0]),
            ("p_ch_bar_gauge", [0.0, 3.0, 1.0]),
            ("PWM1", [0.0, 50.0, 0.0]),
            ("PWM2", [0.0, 0.0, 50.0]),
        ];
        let all = columns.map(|(_, numbers)| values(&numbers));
        let subjects = subjects(columns.map(|(header, _)| header), &all);
        let rise = move |valve: usize, _: Option<usize>, _: usize| {
            if valve == 2 { first } else { second }
        };
        let all = guess(&subjects, None, false, &rise);
        (all[2].signal, all[3].signal)
    };
    assert_eq!(
        named(Some(0.9), Some(-0.8)),
        (Some("duty_fill"), Some("duty_vent"))
    );
    assert_eq!(
        named(Some(-0.9), Some(0.8)),
        (Some("duty_vent"), Some("duty_fill"))
    );
    assert_eq!(named(Some(0.9), Some(0.8)), (None, None));
    assert_eq!(named(Some(0.9), Some(-0.01)), (None, None));
    assert_eq!(named(None, None), (None, None));
}
