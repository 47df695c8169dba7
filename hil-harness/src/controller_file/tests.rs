use controller::fixed::types::I16F16;
use controller::{
    AntiWindup, Boost, Config, Distributor, IntegralAtReference, LowerLimit, OpeningDuty,
    Prediction, PredictionBasis, Settings, SwitchOff,
};
use proptest::prelude::*;

use super::*;

fn problems_of(text: &str) -> String {
    read(text, "C.toml").unwrap_err().to_string()
}

/// Returns the thesis file with one line replaced.
fn thesis_with(line: &str, instead: &str) -> String {
    let start = THESIS_TOML.find(&format!("\n{line}")).unwrap() + 1;
    let end = start + THESIS_TOML[start..].find('\n').unwrap();
    format!("{}{instead}{}", &THESIS_TOML[..start], &THESIS_TOML[end..])
}

#[test]
fn the_shipped_files_are_read_and_accepted_by_the_controller() {
    for settings in [thesis(), recommended(), pulses_1_9_mm(), pulses_1_3_mm()] {
        assert!(Config::new(&settings).is_ok());
    }
}

/// `BLESS=1 cargo nextest run -p hil-harness shipped_files` adds a new setting to the files.
#[test]
fn the_shipped_files_are_the_controllers_own_settings() {
    for (name, shipped, settings) in [
        ("thesis.toml", THESIS_TOML, Settings::thesis()),
        (
            "recommended.toml",
            RECOMMENDED_TOML,
            Settings::recommended(),
        ),
        ("pulses-1.9mm.toml", PULSES_1_9_MM_TOML, Settings::pulses()),
        (
            "pulses-1.3mm.toml",
            PULSES_1_3_MM_TOML,
            pulses_of_a_small_orifice(),
        ),
    ] {
        let mut text = shipped.to_owned();
        if std::env::var_os("BLESS").is_some() {
            text = completed(shipped, &settings);
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/controllers");
            std::fs::write(std::path::Path::new(folder).join(name), &text).unwrap();
        }
        let found = read(&text, name).map_err(|error| error.to_string());
        assert_eq!(found, Ok(settings));
    }
}

/// Returns the pulses of the nominal plant with the rates of orifices of 1.3 mm: those of 1.9 mm times the ratio of areas.
fn pulses_of_a_small_orifice() -> Settings {
    let settings = Settings::pulses();
    let pulses = settings.pulses.map(|pulses| controller::Pulses {
        orifice_mm: I16F16::lit("1.3"),
        fill_rate_per_s: I16F16::lit("3.338"),
        vent_rate_per_s: I16F16::lit("3.408"),
        ..pulses
    });
    Settings { pulses, ..settings }
}

/// Returns the file with the keys of these settings that it lacks, each with its meaning as the comment.
fn completed(text: &str, settings: &Settings) -> String {
    let present: Vec<String> = values(text).iter().map(|(key, _)| key.path()).collect();
    values(&write(settings))
        .into_iter()
        .filter(|(key, _)| !present.contains(&key.path()))
        .fold(text.to_owned(), |text, (key, value)| {
            with_values(&text, &[(key, Some(value.as_str()))], key.about)
        })
}

#[test]
fn a_shipped_file_without_a_setting_is_completed_with_its_value_and_meaning() {
    let text = completed(&thesis_with("response_bar", ""), &Settings::thesis());
    assert_eq!(read(&text, "C").unwrap(), Settings::thesis());
    assert!(
        text.contains("response_bar = 0.02   # the pressure responds"),
        "{text}"
    );
    assert_eq!(
        completed(THESIS_TOML, &Settings::thesis()),
        THESIS_TOML,
        "a complete file is not changed"
    );
}

#[test]
fn every_key_of_the_shipped_files_says_where_its_value_comes_from() {
    for text in [
        THESIS_TOML,
        RECOMMENDED_TOML,
        PULSES_1_9_MM_TOML,
        PULSES_1_3_MM_TOML,
    ] {
        for line in text
            .lines()
            .filter(|line| line.contains(" = ") && !line.starts_with('#'))
        {
            assert!(
                line.split_once("   # ")
                    .is_some_and(|(_, why)| why.len() > 5),
                "{line}"
            );
        }
    }
}

#[test]
fn decimal_text_becomes_the_nearest_fixed_point_number_without_a_float() {
    let exact = thesis_with("tolerance_bar", "tolerance_bar = 0.0999999");
    assert_eq!(
        read(&exact, "C").unwrap().tolerance_bar,
        I16F16::lit("0.0999999")
    );
    for (text, bits) in [
        ("28.5", 1_867_776),
        ("+28.5", 1_867_776),
        ("2_8.5", 1_867_776),
        ("28", 1_835_008),
    ] {
        let file = thesis_with("fill_pct", &format!("fill_pct = {text}"));
        let LowerLimit::Constant { fill_pct, .. } = read(&file, "C").unwrap().duty_min else {
            unreachable!()
        };
        assert_eq!(fill_pct.to_bits(), bits, "{text}");
    }
}

/// The answer to each mistake: place, culprit, bound, next step.
#[test]
fn every_mistake_is_named_with_its_line_and_what_to_do() {
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "gain_pct_per_bar",
            "gain_pct_per_bar = 4000",
            &[
                "C.toml:9:",
                "pid.gain_pct_per_bar",
                "4000",
                "0.01",
                "1000 %/bar",
            ],
        ),
        (
            "gain_pct_per_bar",
            "gain_per_bar = 40",
            &[
                "C.toml:9:",
                "unknown key `pid.gain_per_bar`",
                "pid.gain_pct_per_bar",
                "is missing",
            ],
        ),
        (
            "sample_time_ms",
            "sample_time_s = 0.01",
            &["C.toml:6:", "is `sample.sample_time_ms` meant?"],
        ),
        (
            "gain_pct_per_bar",
            "",
            &[
                "C.toml:8:",
                "`gain_pct_per_bar` is missing in [pid]",
                "add it",
            ],
        ),
        (
            "tolerance_bar",
            "tolerance_bar = \"small\"",
            &["tolerance.tolerance_bar", "= \"small\"", "write a number"],
        ),
        (
            "tolerance_bar",
            "tolerance_bar = nan",
            &["tolerance.tolerance_bar", "nan", "write a number"],
        ),
        (
            "tolerance_bar",
            "tolerance_bar = 1e9",
            &["tolerance.tolerance_bar", "beyond every setting"],
        ),
        (
            "response_bar",
            "response_bar = 0.00001",
            &["boost.response_bar", "0.00002", "more than 1 % off"],
        ),
        (
            "horizon_samples",
            "horizon_samples = 3",
            &["prediction.horizon_samples", "write 0, 1 or 2"],
        ),
        (
            "basis",
            "basis = \"presure\"",
            &["prediction.basis", "\"error\" or \"pressure\""],
        ),
        (
            "anti_windup",
            "anti_windup = \"back_calculation\"",
            &["`tracking_time_ms` is missing in [pid]"],
        ),
        (
            "anti_windup",
            "anti_windup = \"off\"\ntracking_time_ms = 5",
            &["pid.tracking_time_ms", "no effect", "remove it"],
        ),
        (
            "fill_pct",
            "fill_pct = 90",
            &["duty_min.fill_pct", "duty_max_fill_pct"],
        ),
        (
            "[tolerance]",
            "[tolerances]",
            &[
                "unknown table [tolerances]",
                "[tolerance]",
                "`tolerance_bar` is missing",
            ],
        ),
        (
            "[tolerance]",
            "[tolerance",
            &["C.toml:16:", "not valid TOML"],
        ),
    ];
    for (line, instead, expected) in cases {
        let found = problems_of(&thesis_with(line, instead));
        for part in *expected {
            assert!(
                found.contains(part),
                "{instead:?}: {part:?} is not in\n{found}"
            );
        }
    }
}

#[test]
fn all_problems_are_reported_at_once_in_the_order_of_the_file() {
    let text =
        thesis_with("gain_pct_per_bar", "gain_pct_per_bar = \"x\"").replace("scheme_1", "scheme_9");
    let error = read(&text, "C.toml").unwrap_err();
    let lines: Vec<_> = error.problems().iter().filter_map(Problem::line).collect();
    assert_eq!(lines.len(), 2, "{error}");
    assert!(lines.is_sorted());
}

#[test]
fn coefficients_that_only_fail_together_name_the_line_to_change() {
    let text = thesis_with("gain_pct_per_bar", "gain_pct_per_bar = 1000");
    let found = problems_of(&text);
    assert!(
        found.contains("C.toml:10:") && found.contains("change one of them"),
        "{found}"
    );
}

#[test]
fn without_the_table_boost_there_is_no_boost() {
    let start = THESIS_TOML.find("[boost]").unwrap();
    let end = THESIS_TOML.find("[distributor]").unwrap();
    let text = format!("{}{}", &THESIS_TOML[..start], &THESIS_TOML[end..]);
    assert_eq!(
        read(&text, "C").unwrap(),
        Settings {
            boost: None,
            ..Settings::thesis()
        }
    );
}

#[test]
fn the_two_laws_between_the_ends_are_the_controllers_own() {
    let law = |word: &str| {
        let constant = THESIS_TOML.find("[duty_min]").unwrap();
        let valve = |name: &str, ends: [&str; 2]| {
            format!(
                "{name}_without_pressure_pct = {}\n{name}_at_half_supply_pressure_pct = {word}\n\
                 {name}_with_supply_pressure_pct = {}\n",
                ends[0], ends[1]
            )
        };
        let duty_min = format!(
            "[duty_min]\nlaw = \"pressure_dependent\"\n{}{}",
            valve("fill", ["54.5", "28.5"]),
            valve("vent", ["51.5", "25.5"])
        );
        read(&format!("{}{duty_min}", &THESIS_TOML[..constant]), "C")
            .unwrap()
            .duty_min
    };
    let ends = (I16F16::lit("54.5"), I16F16::lit("28.5"));
    let fill_of = |limit| match limit {
        LowerLimit::PressureDependent { fill, .. } => fill,
        LowerLimit::Constant { .. } => unreachable!(),
    };
    assert_eq!(
        fill_of(law("\"force_balance\"")),
        OpeningDuty::force_balance(ends.0, ends.1)
    );
    assert_eq!(
        fill_of(law("\"linear\"")),
        OpeningDuty::linear(ends.0, ends.1)
    );
    assert_eq!(fill_of(law("43")).at_half_pct, I16F16::lit("43"));
}

fn number(min: &'static str, max: &'static str) -> impl Strategy<Value = I16F16> {
    let [min, max] = [min, max].map(|text| text.parse::<I16F16>().unwrap().to_bits());
    (min..=max).prop_map(I16F16::from_bits)
}

prop_compose! {
    fn settings()(
        times in (number("100", "30000"), number("1", "50")),
        off in (any::<bool>(), any::<bool>(), any::<bool>()),
        gains in (number("10", "79"), number("0", "1000"), number("0.01", "10"), number("100", "3000")),
        choices in (0..3_usize, 0..3_usize, 0..3_usize, any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>()),
        duties in (number("1", "30"), number("40", "50"), number("60", "70"), number("80", "100")),
    ) -> Settings {
        let (low, middle, high, max) = duties;
        let opening = OpeningDuty { without_pressure_pct: high, ..OpeningDuty::linear(high, low) };
        Settings {
            gain_pct_per_bar: gains.0,
            integral_time_ms: off.0.then_some(times.0),
            derivative_time_ms: off.1.then_some(times.1),
            integral_max_pct: gains.1,
            integral_at_reference: if choices.3 { IntegralAtReference::Hold } else { IntegralAtReference::Clear },
            anti_windup: match choices.0 {
                0 => AntiWindup::Off,
                1 => AntiWindup::ConditionalIntegration,
                _ => AntiWindup::BackCalculation { tracking_time_ms: times.0 },
            },
            tolerance_bar: gains.2,
            prediction: [Prediction::Off, Prediction::OneStep, Prediction::TwoStep][choices.1],
            prediction_basis: if choices.4 { PredictionBasis::Error } else { PredictionBasis::Pressure },
            switch_off: if choices.5 { SwitchOff::InsideTolerance } else { SwitchOff::InsideOrBeyond },
            boost: off.2.then_some(Boost { rate_pct_per_bar_s: gains.3, max_pct: gains.1, response_bar: gains.2 }),
            distributor: match choices.2 {
                0 => Distributor::Traditional,
                1 => Distributor::Scheme1,
                _ => Distributor::Scheme2 { middle_fill_pct: high, middle_vent_pct: high },
            },
            duty_min: if choices.6 {
                LowerLimit::Constant { fill_pct: low, vent_pct: middle }
            } else {
                LowerLimit::PressureDependent { fill: opening, vent: opening }
            },
            duty_max_fill_pct: max,
            duty_max_vent_pct: max,
            ..Settings::thesis()
        }
    }
}

/// `fixed` alone prints both 6553 and 6554 units as 0.1.
#[test]
fn every_number_up_to_10_is_written_so_that_it_reads_back() {
    for bits in 1..10 << 16 {
        let value = I16F16::from_bits(bits);
        let settings = Settings {
            tolerance_bar: value,
            ..Settings::thesis()
        };
        let text = write(&settings);
        let line = text
            .lines()
            .find(|line| line.starts_with("tolerance_bar"))
            .unwrap();
        let number = line.split_whitespace().nth(2).unwrap();
        assert_eq!(number.parse::<I16F16>(), Ok(value), "{number}");
    }
}

proptest! {
    #[test]
    fn what_is_written_reads_back_to_the_same_bits(settings in settings()) {
        prop_assert_eq!(read(&write(&settings), "C").map_err(|error| error.to_string()), Ok(settings));
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in ".{0,200}", cut in 0..THESIS_TOML.len()) {
        let _ = read(&text, "C");
        let mut damaged = THESIS_TOML.to_owned();
        damaged.insert_str(cut, &text);
        let _ = read(&damaged, "C");
    }
}
