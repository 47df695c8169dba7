//! Inspection of logs of unknown layout: the proposed mapping reads the log, and what is open is asked.

use std::fs;
use std::path::{Path, PathBuf};

use recording::csv::Mapping;
use recording::table::{write_matlab, write_parquet};
use recording::{
    Inspection, LogOptions, PressureReference, Provenance, Recording, TimeBase, Unit, inspect_file,
    mf4, read_log_file,
};

/// Writes a file and inspects it.
fn inspected_with(
    text: &[u8],
    reference: Option<PressureReference>,
) -> (Inspection, PathBuf, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.csv");
    fs::write(&path, text).unwrap();
    let options = LogOptions {
        mapping: Mapping::default().with_reference(reference),
        ..LogOptions::default()
    };
    let inspection = inspect_file(&path, &options, None).unwrap();
    (inspection, path, folder)
}

fn inspected(text: &str) -> Inspection {
    inspected_with(text.as_bytes(), None).0
}

/// Rows of a German logger: a fill valve, a vent valve and the chamber pressure, which follows them.
fn german(header: &str) -> String {
    let mut pressure: f64 = 0.01;
    (0..400).fold(header.to_owned(), |text, row| {
        let (fill, vent) = match row % 100 {
            10..40 => (60, 0),
            60..90 => (0, 80),
            _ => (0, 0),
        };
        pressure = (pressure + 1e-3 * f64::from(fill) - 7.5e-4 * f64::from(vent)).max(0.01);
        let line = format!("{};{pressure:.4};{fill};{vent};ok\n", row * 10);
        text + &line.replace('.', ",")
    })
}

fn signal_of<'a>(inspection: &'a Inspection, key: &str) -> Option<&'a str> {
    let column = inspection.columns.iter().find(|column| column.key == key);
    column
        .unwrap_or_else(|| panic!("{key}: {inspection:#?}"))
        .signal
        .as_deref()
}

#[test]
fn a_german_log_with_a_preamble_is_read_with_the_proposed_mapping() {
    let text = german(
        "Messung;Retarder 7\nDatum;23.11.2026\n\nZeit;Kammerdruck;Tastverhältnis Füllventil;Entlüftungsventil;Bemerkung\nms;barü;%;%;\n",
    );
    let (inspection, path, _folder) = inspected_with(text.as_bytes(), None);
    assert!(inspection.is_ready(), "{inspection:#?}");
    assert_eq!(inspection.found, ["duty_fill", "duty_vent", "p_ch"]);
    assert_eq!(inspection.duration_s, Some(3.99));
    assert_eq!(signal_of(&inspection, "Bemerkung"), None);
    let mapping = Mapping::parse("proposed", inspection.mapping.as_ref().unwrap()).unwrap();
    let options = LogOptions {
        mapping,
        ..LogOptions::default()
    };
    let recording = read_log_file(path, &options).unwrap();
    let names: Vec<&str> = recording
        .signals()
        .iter()
        .map(|signal| signal.name())
        .collect();
    assert_eq!(names, ["p_ch", "duty_fill", "duty_vent"]);
    assert_eq!(recording.time_base_of("p_ch").unwrap().end_s(), 3.99);
}

#[test]
fn a_file_with_standard_names_needs_no_mapping() {
    for name in ["practice-01-id.csv", "practice-00-scope-40.csv"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../data/synthetic")
            .join(name);
        let inspection = inspect_file(path, &LogOptions::default(), None).unwrap();
        assert_eq!(inspection.mapping, None, "{name}");
        assert!(
            inspection.trial.is_ok() && inspection.open.is_empty(),
            "{name}: {inspection:#?}"
        );
    }
}

#[test]
fn bar_without_reference_is_asked_and_answered_by_the_reference() {
    let text = german("Zeit [ms];Druck [bar];Füllventil [%];Entlüftung [%];Bemerkung\n");
    let open = inspected(&text);
    assert!(!open.is_ready());
    assert_eq!(open.suggested, Some(PressureReference::Gauge));
    assert_eq!(open.open.len(), 1);
    assert!(
        open.open[0].question.contains("neither gauge nor absolute"),
        "{open:#?}"
    );
    assert_eq!(open.open[0].answer, "--pressure gauge");
    let (answered, ..) = inspected_with(text.as_bytes(), Some(PressureReference::Gauge));
    assert!(answered.is_ready(), "{answered:#?}");
    assert!(answered.mapping.unwrap().contains("unit = \"bar_gauge\""));
    // A reference that the file states is kept.
    let stated = text.replace("[bar]", "[bar abs]").replace("0,01", "1,01");
    let (kept, ..) = inspected_with(stated.as_bytes(), Some(PressureReference::Gauge));
    assert!(kept.mapping.unwrap().contains("unit = \"bar_abs\""));
}

#[test]
fn numbered_valves_are_named_by_the_direction_of_the_pressure() {
    let text = german("t/ms;p/bar_gauge;PWM1;PWM2;Bemerkung\n");
    let inspection = inspected(&text);
    assert_eq!(
        signal_of(&inspection, "PWM1"),
        Some("duty_fill"),
        "{inspection:#?}"
    );
    assert_eq!(signal_of(&inspection, "PWM2"), Some("duty_vent"));
    // The same numbers in the other order.
    let inspection = inspected(&german("t/ms;p/bar_gauge;PWM2;PWM1;Bemerkung\n"));
    assert_eq!(signal_of(&inspection, "PWM2"), Some("duty_fill"));
    assert!(inspection.is_ready(), "{inspection:#?}");
}

#[test]
fn what_is_missing_is_named_and_a_bad_row_is_reported_with_its_line() {
    let inspection = inspected("time_s,Kammerdruck (barg)\n0,0.1\n0.01,NaN\n0.02,0.2\n");
    assert_eq!(inspection.missing, ["duty_fill", "duty_vent"]);
    assert!(
        inspection
            .mapping
            .as_ref()
            .unwrap()
            .contains("# [constant.duty_vent]")
    );
    assert!(inspection.trial.is_ok(), "{inspection:#?}");
    let inspection = inspected("time_s,Kammerdruck (barg)\n0,0.1\n0.01\n0.02,x\n0.03,0.2\n");
    assert_eq!(
        inspection.trial.as_ref().unwrap_err().code(),
        "E-CSV-RAGGED"
    );
    assert!(
        inspection.remarks.iter().any(|one| one.contains("line 3")),
        "{inspection:#?}"
    );
    assert!(
        inspection.remarks.iter().any(|one| one.contains("line 4")),
        "{inspection:#?}"
    );
}

#[test]
fn a_given_mapping_is_kept_and_completed() {
    let text = german("Zeit [ms];U_Sensor [V];Füllventil [%];Entlüftung [%];Bemerkung\n");
    let given = "schema = 1\n# the sensor of the bench\n[signal.p_ch]\ncolumn = \"U_Sensor [V]\"\nunit = \"bar_gauge\"\nscale = 0.5\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.csv");
    fs::write(&path, text).unwrap();
    let options = LogOptions {
        mapping: Mapping::parse("given", given).unwrap(),
        ..LogOptions::default()
    };
    let inspection = inspect_file(&path, &options, Some(given)).unwrap();
    assert!(inspection.is_ready(), "{inspection:#?}");
    let mapping = inspection.mapping.unwrap();
    assert!(
        mapping.contains("# the sensor of the bench") && mapping.contains("[signal.duty_vent]"),
        "{mapping}"
    );
}

#[test]
fn channels_of_mf4_are_guessed_like_columns() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/mf4/rates-transposed.mf4");
    let options = |reference| LogOptions {
        mapping: Mapping::default().with_reference(reference),
        ..LogOptions::default()
    };
    let open = inspect_file(&path, &options(None), None).unwrap();
    assert_eq!(signal_of(&open, "p_sup"), Some("p_sup"));
    assert!(
        open.open.iter().any(|one| one.question.contains("p_sup")),
        "{open:#?}"
    );
    let answered = inspect_file(&path, &options(Some(PressureReference::Gauge)), None).unwrap();
    assert!(
        answered.open.is_empty() && answered.needs_reference,
        "{answered:#?}"
    );
    assert!(
        answered
            .trial
            .unwrap()
            .signals
            .contains(&"p_sup".to_owned())
    );
}

/// Every file of the corpus, damaged ones included, ends with an inspection or an error.
#[test]
fn every_file_of_the_corpus_is_inspected_or_refused() {
    let mut count = 0;
    for folder in [
        "corpus/good",
        "corpus/wrong",
        "corpus/out-of-bounds",
        "fixtures/mf4",
    ] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests")
            .join(folder);
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let inspection = inspect_file(&path, &LogOptions::default(), None);
            if let Ok(mapping) = inspection.map(|inspection| inspection.mapping) {
                let gauge = Some(PressureReference::Gauge);
                if let Some(text) = mapping {
                    let parsed = Mapping::parse_with_reference("proposed", &text, gauge);
                    assert!(
                        parsed.is_ok(),
                        "{}: {:?}\n{text}",
                        path.display(),
                        parsed.err()
                    );
                }
            }
            count += 1;
        }
    }
    assert!(count > 80, "{count}");
}

/// 200 without a unit may be kPa, psi or mbar.
#[test]
fn a_signal_whose_unit_is_not_known_is_asked_and_not_mapped() {
    let inspection = inspected("time_s,Kammerdruck\n0,0\n0.01,200\n0.02,150\n");
    assert_eq!(signal_of(&inspection, "Kammerdruck"), None);
    assert!(inspection.missing.contains(&"p_ch"));
    let asked = inspection
        .open
        .iter()
        .find(|one| one.question.contains("its unit is not known"));
    assert!(
        asked.unwrap().answer.contains("signal.p_ch = "),
        "{inspection:#?}"
    );
}

#[test]
fn bad_rows_are_skipped_up_to_their_number_and_listed() {
    let text = "time_s,p_ch_bar_gauge\n0,0.1\n0.01\n0.02,x\n0.03,0.2\n0.02,0.2\n0.04,0.3\n";
    let read = |bad_rows| {
        let mut options = recording::csv::Options::default();
        options.limits.bad_rows = bad_rows;
        recording::csv::read("b.csv", text.as_bytes(), &options)
    };
    for (count, code, line) in [
        (0, "E-CSV-RAGGED", 3),
        (1, "E-CSV-NUMBER", 4),
        (2, "E-CSV-TIME-ORDER", 6),
    ] {
        let error = read(count).unwrap_err();
        assert_eq!(
            (error.code(), error.place().line),
            (code, Some(line)),
            "{error}"
        );
    }
    let recording = read(3).unwrap();
    assert_eq!(
        recording.signal("p_ch").unwrap().values_or_nan(),
        [0.1, 0.2, 0.3]
    );
    let sentences = recording.defects().sentences();
    assert_eq!(sentences.len(), 3, "{sentences:?}");
    assert_eq!(
        sentences[1],
        "line 4 is skipped: column 2: found \"x\", expected a number with the decimal separator '.'"
    );
    // A header that cannot be read is no row.
    let mut options = recording::csv::Options::default();
    options.limits.bad_rows = 9;
    let error = recording::csv::read("b.csv", &b"time_s,p_ch\n0,1\n"[..], &options).unwrap_err();
    assert_eq!(error.code(), "E-CSV-UNIT-MISSING");
}

/// Older loggers and spreadsheets do not write UTF-8.
#[test]
fn other_encodings_are_named_and_read() {
    let text =
        german("Zeit [ms];Überdruck Kammer [barg];Füllventil [%];Entlüftung [%];Bemerkung\n");
    let windows: Vec<u8> = text.chars().map(|character| character as u8).collect();
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, name) in [
        (windows, "Windows-1252"),
        ([&[0xff, 0xfe][..], &utf16].concat(), "UTF-16"),
    ] {
        let (inspection, path, _folder) = inspected_with(&bytes, None);
        assert!(inspection.is_ready(), "{inspection:#?}");
        assert!(inspection.layout.ends_with(name), "{}", inspection.layout);
        let mapping = Mapping::parse("proposed", inspection.mapping.as_ref().unwrap()).unwrap();
        let options = LogOptions {
            mapping,
            ..LogOptions::default()
        };
        let recording = read_log_file(path, &options).unwrap();
        let provenance = recording.provenance();
        assert_eq!(provenance.input.unwrap().size_bytes, bytes.len() as u64);
        assert!(
            provenance
                .notes
                .iter()
                .any(|note| note.value.contains(name)),
            "{provenance:?}"
        );
        assert_eq!(recording.signal("p_ch").unwrap().len(), 400);
    }
}

#[test]
fn a_damaged_character_is_refused() {
    let mut bytes: Vec<u8> = "time_s,p_ch_bar_gauge\n0,1.5\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    bytes.push(b'1');
    let options = recording::csv::Options::default();
    let error = recording::csv::read("cut.csv", &bytes[..], &options).unwrap_err();
    assert_eq!(error.code(), "E-CSV-ENCODING", "{error}");
}

#[test]
fn dates_and_times_of_day_are_read_from_the_first_row_on() {
    let row =
        |row: u32, time: &str| format!("{time};{};60;0\n", f64::from(row) * 0.1).replace('.', ",");
    for (header, times, start) in [
        (
            "Zeit",
            [
                "23.11.2026 14:05:06,125",
                "23.11.2026 14:05:06,375",
                "23.11.2026 14:05:06,625",
            ],
            Some("2026-11-23 14:05:06 local time"),
        ),
        (
            "Zeitstempel",
            [
                "2026-11-23T14:05:06,0Z",
                "2026-11-23T14:05:06,25Z",
                "2026-11-23T14:05:06,5Z",
            ],
            Some("2026-11-23 14:05:06 UTC"),
        ),
        ("Uhr", ["23:59:59,75", "00:00:00", "00:00:00,25"], None),
    ] {
        let rows: String = (0..)
            .zip(times)
            .map(|(index, time)| {
                let line = row(index, "TIME");
                line.replace("TIME", time)
            })
            .collect();
        let text = format!("{header};Kammerdruck (barg);Füllventil (%);Entlüftung (%)\n{rows}");
        let (inspection, path, _folder) = inspected_with(text.as_bytes(), None);
        assert!(inspection.is_ready(), "{inspection:#?}");
        let mapping = inspection.mapping.as_ref().unwrap();
        assert!(mapping.contains("unit = \"clock\""), "{mapping}");
        let options = LogOptions {
            mapping: Mapping::parse("proposed", mapping).unwrap(),
            ..LogOptions::default()
        };
        let recording = read_log_file(&path, &options).unwrap();
        assert_eq!(
            recording.time_base_of("p_ch").unwrap().times_s(),
            [0.0, 0.25, 0.5]
        );
        let found = recording.provenance().start.map(|start| start.to_string());
        assert_eq!(found.as_deref(), start);
        let broken = text.replace(times[1], "yesterday");
        let error = recording::csv::read("b.csv", broken.as_bytes(), &options.csv()).unwrap_err();
        assert_eq!(
            (error.code(), error.place().line),
            ("E-CSV-CLOCK", Some(3)),
            "{error}"
        );
    }
}

/// The awkward logs of `data/unknown` are read with the proposed mapping once the open reference is given.
#[test]
fn the_bundled_unknown_logs_are_read_with_the_proposed_mapping() {
    for (name, signals, assumed) in [
        (
            "german-logger.csv",
            &["duty_fill", "duty_vent", "i_fill", "i_vent", "p_ch"][..],
            0,
        ),
        (
            "unnamed-columns.csv",
            &["duty_fill", "duty_vent", "p_ch", "p_sup"],
            4,
        ),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../data/unknown")
            .join(name);
        let inspect = |reference| {
            let mapping = Mapping::default().with_reference(reference);
            inspect_file(
                &path,
                &LogOptions {
                    mapping,
                    ..LogOptions::default()
                },
                None,
            )
            .unwrap()
        };
        let open = inspect(None);
        assert_eq!(open.suggested, Some(PressureReference::Gauge), "{open:#?}");
        let answered = inspect(Some(PressureReference::Gauge));
        assert!(answered.is_ready(), "{answered:#?}");
        assert_eq!(answered.assumed.len(), assumed, "{:?}", answered.assumed);
        let text = answered.mapping.as_ref().unwrap();
        assert_eq!(text.matches("assumed: ").count(), assumed, "{text}");
        let mapping = Mapping::parse("proposed", text).unwrap();
        let recording = read_log_file(
            &path,
            &LogOptions {
                mapping,
                ..LogOptions::default()
            },
        )
        .unwrap();
        let mut names: Vec<&str> = recording
            .signals()
            .iter()
            .map(|signal| signal.name())
            .collect();
        names.sort_unstable();
        assert_eq!(names, signals, "{name}");
        // The same rows as in the log from which they were made.
        let source =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/synthetic/practice-01-id.csv");
        let source = read_log_file(source, &LogOptions::default()).unwrap();
        for signal in ["p_ch", "duty_fill", "duty_vent"] {
            let unit = source.signal(signal).unwrap().unit();
            let found = recording.signal(signal).unwrap().values_in(unit).unwrap();
            let expected = &source.signal(signal).unwrap().values_or_nan()[..600];
            let is_same = |(found, expected): (&f64, &f64)| {
                found.is_nan() || (found - expected).abs() < 0.051
            };
            assert!(found.iter().zip(expected).all(is_same), "{name}: {signal}");
        }
    }
}

mod damaged {
    use proptest::prelude::*;
    use recording::PressureReference;
    use recording::csv::Mapping;
    use recording::{LogOptions, inspect_file};

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

        /// Any damage ends with an inspection or an error, and a proposed mapping is always one that can be parsed.
        #[test]
        fn any_damage_ends_with_an_inspection_or_an_error(
            changes in proptest::collection::vec((0.0..1.0_f64, any::<u8>(), 0..3_u8), 0..12),
            cut in 0.0..1.0_f64,
            is_cut in any::<bool>(),
            file in 0..3_usize,
        ) {
            let names = ["data/unknown/german-logger.csv", "data/unknown/unnamed-columns.csv",
                "recording/tests/fixtures/mf4/rates-transposed.mf4"];
            let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../");
            let mut bytes = std::fs::read(format!("{root}{}", names[file])).unwrap();
            bytes.truncate(if file == 2 { usize::MAX } else { 4000 });
            for (place, value, kind) in changes {
                // Most damage is in the head, which decides about the layout.
                let at = ((place * place * bytes.len() as f64) as usize).min(bytes.len().saturating_sub(1));
                match kind {
                    0 if at < bytes.len() => bytes[at] = value,
                    1 if at < bytes.len() => drop(bytes.remove(at)),
                    _ => bytes.insert(at, b";,\n\r\"[]_ 0"[usize::from(value) % 10]),
                }
            }
            if is_cut {
                bytes.truncate((cut * bytes.len() as f64) as usize);
            }
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("any.log");
            std::fs::write(&path, &bytes).unwrap();
            if let Ok(inspection) = inspect_file(&path, &LogOptions::default(), None)
                && let Some(text) = inspection.mapping
            {
                let parsed = Mapping::parse_with_reference("any", &text, Some(PressureReference::Gauge));
                prop_assert!(parsed.is_ok(), "{:?}\n{text}", parsed.err());
            }
        }
    }
}

/// Glitches of a sensor at the end of its range, in a pressure whose values otherwise fit.
fn with_glitches() -> String {
    let rows = (0..200).map(|row| {
        let pressure = match row {
            20 => 655.35,
            150 | 151 => 327.67,
            row => 2.0 + 0.25 * f64::from(row % 5),
        };
        format!("{:.2},{pressure},50,0\n", 0.01 * f64::from(row))
    });
    rows.fold(
        "time_s,p_ch_bar_gauge,duty_fill_pct,duty_vent_pct\n".to_owned(),
        |text, row| text + &row,
    )
}

#[test]
fn glitches_become_missing_cells_by_the_proposed_plausible_range_and_are_listed() {
    let (inspection, path, _folder) = inspected_with(with_glitches().as_bytes(), None);
    assert_eq!(
        inspection.assumed,
        ["\"p_ch_bar_gauge\": 3 values are glitches, the first is 655.35: outside 1 to 4"]
    );
    let mapping = inspection.mapping.as_deref().unwrap();
    assert!(mapping.contains("plausible = [1.0, 4.0]"), "{mapping}");
    let trial = inspection.trial.unwrap();
    assert_eq!(
        trial.defects,
        [
            "3 of 200 cells of p_ch are missing, the first at 0.200 s; 3 cells of p_ch out of bounds (allowed: 1 to 4 \
             bar gauge), counted as missing: line 22, column 2: 655.35 bar gauge; line 152, column 2: 327.67 bar gauge; \
             line 153, column 2: 327.67 bar gauge"
        ]
    );
    // Without the mapping, the glitches are as wrong as a wrong unit.
    let error = read_log_file(path, &LogOptions::default()).unwrap_err();
    assert_eq!(error.code(), "E-CSV-SCALE", "{error}");
}

#[test]
fn a_plausible_range_of_a_mapping_applies_after_the_scale_and_to_commands() {
    let mapping = "schema = 1\n[signal.p_ch]\ncolumn = 2\nunit = \"bar_gauge\"\nscale = 0.5\nplausible = [0, 4]\n\
                   [signal.duty_fill]\ncolumn = 3\nunit = \"pct\"\nplausible = [0, 100]\n";
    let log = "time_s,U,PWM\n0.00,7,50\n0.01,9,255\n0.02,8,50\n0.03,6,50\n";
    let options = recording::csv::Options {
        mapping: Mapping::parse("mapping", mapping).unwrap(),
        ..recording::csv::Options::default()
    };
    let recording = recording::csv::read("log", log.as_bytes(), &options).unwrap();
    let cells =
        |name: &str| -> Vec<Option<f64>> { recording.signal(name).unwrap().iter().collect() };
    assert_eq!(cells("p_ch"), [Some(3.5), None, Some(4.0), Some(3.0)]);
    assert_eq!(
        cells("duty_fill"),
        [Some(50.0), None, Some(50.0), Some(50.0)]
    );
    assert_eq!(recording.out_of_bounds().len(), 2);
}

#[test]
fn a_single_bad_row_or_cell_is_reported_in_the_singular() {
    let rows = (0..100).map(|row| match row {
        99 => "0.99,3\n".to_owned(),
        50 => "0.50,broken,50,0\n".to_owned(),
        row => format!("{:.2},3.5,50,0\n", 0.01 * f64::from(row)),
    });
    let header = "time_s,p_ch_bar_gauge,duty_fill_pct,duty_vent_pct\n";
    let inspection = inspected(&rows.fold(header.to_owned(), |text, row| text + &row));
    assert_eq!(
        inspection.remarks,
        [
            "\"p_ch_bar_gauge\": the cell \"broken\" in line 52 is no number",
            "line 101 has 2 fields, the other rows have 4"
        ]
    );
}

/// One column with -1, 0 and 1 commands both valves. Defect seen: its name said nothing known, and no mapping made two commands of it.
#[test]
fn a_state_of_both_valves_becomes_two_commands() {
    for (sign, filled, vented) in [(1, 1, -1), (-1, -1, 1)] {
        let mut pressure: f64 = 0.0;
        let text = (0..400).fold("time_s,p_ch_bar_gauge,y\n".to_owned(), |text, row| {
            let state = match row % 100 {
                10..40 => filled,
                60..90 => vented,
                _ => 0,
            };
            pressure = (pressure + 0.06 * f64::from(sign * state)).max(0.0);
            text + &format!("{:.2},{pressure:.4},{state}\n", 0.01 * f64::from(row))
        });
        let (inspection, path, _folder) = inspected_with(text.as_bytes(), None);
        assert!(inspection.is_ready(), "{inspection:#?}");
        assert_eq!(inspection.found, ["duty_fill", "duty_vent", "p_ch"]);
        let proposed = inspection.mapping.as_ref().unwrap();
        let options = LogOptions {
            mapping: Mapping::parse("proposed", proposed).unwrap(),
            ..LogOptions::default()
        };
        let recording = read_log_file(&path, &options).unwrap();
        let duty = |name: &str| recording.signal(name).unwrap().values_or_nan().to_vec();
        let (fill, vent) = (duty("duty_fill"), duty("duty_vent"));
        assert_eq!((fill[5], fill[20], fill[70]), (0.0, 1.0, 0.0));
        assert_eq!((vent[5], vent[20], vent[70]), (0.0, 0.0, 1.0));

        // The mapping is given: both signals come from the column.
        let again = inspect_file(&path, &options, Some(proposed)).unwrap();
        assert!(again.is_ready(), "{again:#?}");
        let columns = again.columns.iter().filter(|column| column.key == "y");
        let signals: Vec<_> = columns.map(|column| column.signal.as_deref()).collect();
        assert_eq!(signals, [Some("duty_fill"), Some("duty_vent")]);
    }
}

#[test]
fn a_state_of_both_valves_is_read_in_every_format() {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = log.add_time_base(TimeBase::uniform(0.0, 0.01, 5).unwrap());
    let (state, pressure) = (
        vec![0.0, 1.0, 0.0, -1.0, 0.0],
        vec![0.0, 0.0, 2.0, 2.0, 1.0],
    );
    log.add_signal("valve_state", Unit::Fraction, base, state)
        .unwrap();
    log.add_signal("p_ch", Unit::BarGauge, base, pressure)
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [
        ("bench.mf4", mf4::write(Vec::new(), &log).unwrap()),
        (
            "bench.parquet",
            write_parquet(Vec::new(), &log, base).unwrap(),
        ),
        ("bench.mat", write_matlab(Vec::new(), &log, base).unwrap()),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let inspection = inspect_file(&path, &LogOptions::default(), None).unwrap();
        assert!(inspection.is_ready(), "{name}: {inspection:#?}");
        let options = LogOptions {
            mapping: Mapping::parse("proposed", inspection.mapping.as_ref().unwrap()).unwrap(),
            ..LogOptions::default()
        };
        let again = read_log_file(&path, &options).unwrap();
        let values = |name: &str| again.signal(name).unwrap().values_or_nan().to_vec();
        assert_eq!(values("duty_fill"), [0.0, 1.0, 0.0, 0.0, 0.0], "{name}");
        assert_eq!(values("duty_vent"), [0.0, 0.0, 0.0, 1.0, 0.0], "{name}");
    }
}
