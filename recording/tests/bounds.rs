//! Values that no measurement has: single cells are missing and listed, a column of them is refused, and a mapping that
//! accepts unusual sizes does not change this.

use std::io::Cursor;

use recording::csv::{CsvError, Mapping, Options, Reader, read};
use recording::{Provenance, Recording, TimeBase, Unit, mf4};

fn mapped(mapping: &str, log: &str) -> Result<Recording, CsvError> {
    let mapping = Mapping::parse("bounds.toml", mapping).unwrap();
    let options = Options {
        mapping,
        ..Options::default()
    };
    read("bounds.csv", log.as_bytes(), &options)
}

fn plain(log: &str) -> Result<Recording, CsvError> {
    mapped("schema = 1", log)
}

/// Returns a log of 100 rows with the second column from `cell`.
fn log(header: &str, cell: impl Fn(usize) -> String) -> String {
    let rows = (0..100).map(|row| format!("{:.2},{},0.0\n", row as f64 * 0.01, cell(row)));
    format!(
        "time_s,{header},duty_fill_pct\n{}",
        rows.collect::<String>()
    )
}

fn one_cell(header: &str, usual: &str, cell: &str) -> String {
    log(header, |row| {
        if row == 40 { cell } else { usual }.to_owned()
    })
}

#[test]
fn a_single_cell_out_of_bounds_is_missing_and_listed_with_line_and_column() {
    for (header, usual, cell) in [
        ("p_ch_bar_gauge", "1.5", "-1.02"),
        ("p_ch_bar_gauge", "1.5", "1e9"),
        ("p_ch_bar_abs", "2.5", "0"),
        ("i_fill_mA", "280", "1e200"),
        ("u_bat_V", "24", "-1e9"),
        ("t_gas_degC", "20", "-280"),
    ] {
        let recording = plain(&one_cell(header, usual, cell)).unwrap();
        let [cells] = recording.out_of_bounds() else {
            panic!("{header}: {:?}", recording.out_of_bounds());
        };
        assert_eq!(
            (cells.count, cells.first[0].place, cells.column),
            (1, 42, Some(2))
        );
        assert_eq!(cells.first[0].value, cell.parse::<f64>().unwrap());
        let signal = recording.signal(&cells.signal).unwrap();
        assert_eq!(
            (signal.get(40), signal.missing_count()),
            (None, 1),
            "{header}"
        );
        assert!(cells.to_string().contains("line 42, column 2"), "{cells}");
    }
}

#[test]
fn a_column_out_of_bounds_is_refused_whatever_the_mapping_accepts() {
    let accepts =
        "schema = 1\n[signal.p_ch]\ncolumn = 2\nunit = \"bar_gauge\"\ncheck_scale = false\n";
    let refused = |log: &str, code: &str, line: u64| {
        let error = mapped(accepts, log).unwrap_err();
        assert_eq!(
            (error.code(), error.place().line),
            (code, Some(line)),
            "{error}"
        );
        assert_eq!(error.place().column, Some(2));
        error.to_string()
    };
    let vacuum = log("p_ch_bar_gauge", |_| "-1.02".to_owned());
    let text = refused(&vacuum, "E-CSV-BELOW-VACUUM", 2);
    assert!(
        text.contains("allowed: -1.01225 to 998.987 bar gauge"),
        "{text}"
    );
    assert!(text.contains("100 of 100 cells"), "{text}");
    let half = log("p_ch_bar_gauge", |row| {
        if row % 2 == 1 { "1e4" } else { "1" }.to_owned()
    });
    refused(&half, "E-CSV-BOUNDS", 3);
    let less = log("p_ch_bar_gauge", |row| {
        if row % 3 == 1 { "1e4" } else { "1" }.to_owned()
    });
    assert_eq!(mapped(accepts, &less).unwrap().out_of_bounds()[0].count, 33);
}

#[test]
fn a_column_in_a_wrong_unit_is_reported_with_its_unit_although_it_is_out_of_bounds() {
    let pascal = log("p_ch_bar_gauge", |row| (row * 8000).to_string());
    let error = plain(&pascal).unwrap_err();
    assert_eq!(error.code(), "E-CSV-SCALE", "{error}");
    assert!(error.to_string().contains("Pa_gauge"), "{error}");
}

/// An offset of 2^32 once caused a table of 43 thousand million cells of a bar.
#[test]
fn a_mapping_that_leads_out_of_bounds_is_refused() {
    for line in [
        "offset = 4294967296",
        "offset = 1e9",
        "scale = 1e300",
        "scale = -1_000",
    ] {
        let mapping = format!(
            "schema = 1\n[signal.p_ch]\ncolumn = 2\nunit = \"bar_gauge\"\ncheck_scale = false\n{line}\n"
        );
        let log = log("p_ch_bar_gauge", |row| (3 + row % 3).to_string());
        let code = mapped(&mapping, &log).unwrap_err().code();
        assert!(
            matches!(code, "E-CSV-BOUNDS" | "E-CSV-BELOW-VACUUM"),
            "{line}: {code}"
        );
    }
}

/// No other value can replace a command.
#[test]
fn an_impossible_duty_cycle_is_refused_in_a_single_cell() {
    let error = plain("time_s,duty_fill_pct\n0.00,0.5\n0.01,50\n0.02,101\n").unwrap_err();
    assert_eq!(
        (error.code(), error.place().line),
        ("E-CSV-DUTY-RANGE", Some(4))
    );
}

#[test]
fn rows_that_a_mapping_leaves_out_are_not_judged() {
    let mapping = "schema = 1\n[rows]\nfrom_s = 0.8\n";
    let unplugged = log("p_ch_bar_gauge", |row| {
        if row < 80 { "-1.25" } else { "1.5" }.to_owned()
    });
    let recording = mapped(mapping, &unplugged).unwrap();
    assert_eq!(recording.out_of_bounds(), []);
    assert_eq!(plain(&unplugged).unwrap_err().code(), "E-CSV-BELOW-VACUUM");
}

#[test]
fn a_time_that_no_clock_shows_is_refused() {
    let error = plain("time_s,u_V\n0,1\n2e10,1\n").unwrap_err();
    assert_eq!(
        (error.code(), error.place().line),
        ("E-CSV-TIME-BOUNDS", Some(3))
    );
    assert!(TimeBase::new(vec![-1e10, 1e10]).is_ok());
    assert!(TimeBase::new(vec![0.0, 2e10]).is_err());
}

#[test]
fn a_reader_of_rows_lists_what_it_took_out() {
    let log = one_cell("i_fill_mA", "280", "1e200");
    let mut reader = Reader::new("rows.csv", log.as_bytes(), &Options::default()).unwrap();
    let mut missing = 0;
    while let Some(row) = reader.next_row().unwrap() {
        missing += usize::from(row.get(0).is_none());
    }
    assert_eq!(missing, 1);
    let counts: Vec<u64> = reader.out_of_bounds().map(|cells| cells.count).collect();
    assert_eq!(counts, [1]);
}

fn written_as_mf4(values: Vec<f64>) -> Vec<u8> {
    let mut recording = Recording::new(Provenance::from_source("bench"));
    let times = TimeBase::uniform(0.0, 0.01, values.len()).unwrap();
    let base = recording.add_time_base(times);
    recording
        .add_signal("p_ch", Unit::BarGauge, base, values)
        .unwrap();
    mf4::write(Vec::new(), &recording).unwrap()
}

#[test]
fn mf4_has_the_same_bounds() {
    let read = |values: Vec<f64>| {
        mf4::read(
            "bounds.mf4",
            Cursor::new(written_as_mf4(values)),
            &mf4::Options::default(),
        )
    };
    let mut values = vec![1.5; 100];
    values[40] = -1.02;
    let recording = read(values).unwrap();
    let cells = &recording.out_of_bounds()[0];
    assert_eq!(
        (cells.count, cells.first[0].place, cells.column),
        (1, 40, None)
    );
    assert_eq!(recording.signal("p_ch").unwrap().missing_count(), 1);
    let error = read(vec![-1.02; 100]).unwrap_err();
    assert_eq!(error.code(), "E-MF4-BELOW-VACUUM", "{error}");
    assert_eq!(read(vec![1e5; 100]).unwrap_err().code(), "E-MF4-SCALE");
    // The list is kept when signals are taken at the instants of another one.
    let mut values = vec![1.5; 100];
    values[3] = 5000.0;
    let recording = read(values).unwrap();
    let base = recording.signal("p_ch").unwrap().time_base();
    assert_eq!(recording.known_at(base).unwrap().out_of_bounds().len(), 1);
}

/// A pressure in another unit than declared is recognised by the usual pressure that the right unit gives.
#[test]
fn the_unit_that_makes_a_usual_pressure_of_the_values_is_proposed() {
    let proposed = |per_bar: f64| {
        let row = |row: u32| {
            let bar = 0.004 * f64::from(row % 3) - 0.004 + 0.08 * f64::from(row);
            format!("{:.2},{:.3}\n", f64::from(row) * 0.01, bar * per_bar)
        };
        let rows: String = (0..100).map(row).collect();
        let log = format!("time_s,p_ch_bar_gauge\n{rows}");
        let read = recording::csv::read("log.csv", log.as_bytes(), &Default::default());
        read.unwrap_err().to_string()
    };
    for (per_bar, unit) in [
        (14.504, "psi_gauge"),
        (100.0, "kPa_gauge"),
        (1000.0, "mbar_gauge"),
    ] {
        let error = proposed(per_bar);
        assert!(error.contains(&format!("unit = \"{unit}\"")), "{error}");
    }
}
