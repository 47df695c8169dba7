//! Compares measurements by others with models of their rigs: which physics explains them, with the error before and after.
//! `docs/real-measurements.md` describes the results.
//!
//! Run `cargo run --release -p model-lab --example real_measurements`; with `-- --write` it also writes the pictures and the fitted plant
//! files of the repository.

mod fit;
mod picture;
mod rigs;

use std::fs;

use picture::Picture;
use rigs::{Outcome, RIGS, Rig, repository};

fn main() {
    let writes = std::env::args().any(|argument| argument == "--write");
    for rig in &RIGS {
        let outcomes = rig.outcomes();
        print(rig, &outcomes);
        let [first, .., last] = &outcomes[..] else {
            panic!("{}: at least two models", rig.name);
        };
        for ((name, before), (_, after)) in first.rms.iter().zip(&last.rms) {
            assert!(after < before, "{}: {name}", rig.name);
        }
        if writes {
            write(rig, first, last);
        }
    }
}

fn print(rig: &Rig, outcomes: &[Outcome]) {
    println!("\n{}", rig.title);
    for outcome in outcomes {
        print!("  {:34}", outcome.model);
        for (name, rms) in &outcome.rms {
            print!("  {name} {rms:.4}");
        }
        println!();
        for name in outcome.fitted {
            let value = outcome.plant.get(name).expect("what was fitted is there");
            println!("      {name} = {value:.4e}");
        }
    }
}

fn write(rig: &Rig, first: &Outcome, last: &Outcome) {
    let log = rig.log();
    let measured = rig.measured(&log);
    for (n, signal) in measured.iter().enumerate() {
        let base = log.time_base_of(signal.name).expect("a signal of the log");
        let trace = |outcome: &'_ Outcome| {
            format!("{}: {} rms", outcome.model, significant(outcome.rms[n].1))
        };
        let picture = Picture {
            title: rig.title.to_owned(),
            axis: match signal.name {
                "p_ch" => "pressure (bar gauge)",
                "t_gas" => "gas temperature (K)",
                _ => "coil current (mA)",
            },
            times_s: base.times_s(),
            measured: &signal.values,
            traces: vec![
                (trace(first), "#c0392b", &first.traces[n]),
                (trace(last), "#1f6fb2", &last.traces[n]),
            ],
        };
        let path = format!("docs/pictures/{}-{}.svg", rig.name, signal.name);
        fs::write(repository(&path), picture.svg()).expect("the repository may be written");
    }
    let path = format!("data/plants/fitted-{}.toml", rig.name);
    fs::write(repository(&path), last.plant.to_toml()).expect("the repository may be written");
}

/// Returns a value with two significant digits.
fn significant(value: f64) -> String {
    let decimals = (1.0 - value.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}
