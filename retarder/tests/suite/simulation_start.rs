//! Start of `simulate`: the beginning of the log, or a given state.

use recording::{Recording, csv};

use crate::runner::{Bench, assert_contains};

/// Returns a log of two seconds without commands; it begins at `first_bar`.
fn hold(first_bar: f64) -> String {
    (0..200).fold(
        "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge\n".to_owned(),
        |text, row| text + &format!("{:.2},0,0,{first_bar}\n", f64::from(row) * 0.01),
    )
}

fn simulated(bench: &Bench, more: &[&str]) -> Recording {
    let simulate = ["simulate", "--log", "log.csv", "--out", "model.csv"];
    bench.run(&[&simulate, more].concat()).ended_with(0);
    csv::read_file(bench.path("model.csv"), &csv::Options::default()).unwrap()
}

fn column(model: &Recording, name: &str) -> Vec<f64> {
    model.signal(name).unwrap().values_or_nan().to_vec()
}

#[test]
fn a_simulation_begins_at_the_pressure_of_its_log_or_at_a_given_one() {
    let bench = Bench::new();
    bench.file("log.csv", &hold(5.2));
    let pressure = column(&simulated(&bench, &[]), "p_ch");
    assert!(
        pressure.iter().all(|bar| (bar - 5.2).abs() < 1e-6),
        "{pressure:?}"
    );
    let pressure = column(&simulated(&bench, &["--start", "p_ch=3.1"]), "p_ch");
    assert!(
        pressure.iter().all(|bar| (bar - 3.1).abs() < 1e-6),
        "{pressure:?}"
    );
    let json = bench
        .run(&[
            "simulate",
            "--log",
            "log.csv",
            "--out",
            "model.csv",
            "--json",
            "--start",
            "p_ch=3.1",
        ])
        .ended_with(0);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["start_pressure_bar_gauge"], 3.1);
    assert_eq!(json["start"], "from the given pressure, 3.1 bar gauge");
}

/// Shut chamber at constant mass: p is proportional to T, and T - T_w to exp(-t h A (k - 1) T_0 / (p_0 V)), E52.
#[test]
fn a_simulation_begins_with_the_given_gas_temperature() {
    let bench = Bench::new();
    bench.file("log.csv", &hold(0.0));
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    let effect = "\n[effects.gas_temperature]\nvariant = \"constant_wall\"\nwall_heat_transfer_w_per_k = 0.1\n";
    bench.file("warm.toml", &(plant + effect));
    let start = [
        "--plant",
        "warm.toml",
        "--start",
        "p_ch=7",
        "--start",
        "t_gas=333.15",
    ];
    let model = simulated(&bench, &start);
    let (pressure, gas) = (column(&model, "p_ch"), column(&model, "t_gas"));
    assert!((gas[0] - 333.15).abs() < 1e-3, "{}", gas[0]);
    let begin_pa = 7e5 + 101_325.0;
    let rate = 0.1 * 0.4 * 333.15 / (begin_pa * 75e-6);
    let expected = 293.15 + 40.0 * (-rate * 1.99_f64).exp();
    assert!(
        (gas[199] - expected).abs() < 0.01,
        "{} {expected}",
        gas[199]
    );
    let expected = (begin_pa * gas[199] / gas[0] - 101_325.0) / 1e5;
    assert!(
        (pressure[199] - expected).abs() < 1e-5,
        "{} {expected}",
        pressure[199]
    );
}

#[test]
fn a_state_that_cannot_be_is_refused_with_what_to_do() {
    let bench = Bench::new();
    bench.file("log.csv", &hold(0.0));
    for (given, remedy) in [
        (
            "t_gas=330",
            "add the effect gas_temperature to the plant file",
        ),
        ("p_ch=-2", "allowed"),
        ("p_cH=2", "give p_ch in bar gauge or t_gas in K"),
    ] {
        let ran = bench.run(&["simulate", "--log", "log.csv", "--start", given]);
        let text = ran.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_contains(&text, &["--start", remedy]);
        ran.ended_with(2);
    }
}

/// Constants of a mapping are the surroundings of a log.
#[test]
fn a_mapping_states_the_surroundings() {
    let bench = Bench::new();
    bench.file("log.csv", &hold(0.0));
    let mapping = |value: f64| {
        format!("schema = 1\n[constant.p_amb]\nvalue = {value}\nunit = \"mbar_abs\"\n")
    };
    bench.file("high.toml", &mapping(800.0));
    let model = simulated(&bench, &["--mapping", "high.toml"]);
    assert!(column(&model, "p_ch").iter().all(|bar| bar.abs() < 1e-6));
    bench.file("space.toml", &mapping(80.0));
    let ran = bench.run(&["simulate", "--log", "log.csv", "--mapping", "space.toml"]);
    let text = ran.err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_contains(
        &text,
        &["log.csv", "p_amb", "8000", "allowed 30000 to 120000"],
    );
    ran.ended_with(2);
}
