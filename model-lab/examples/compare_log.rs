//! Compares the nominal plant with a log and prints the main results:
//! `cargo run --release -p model-lab --example compare_log -- data/synthetic/practice-01-id.csv`

use std::error::Error;
use std::time::Instant;

use model_lab::{CompareOptions, compare};
use plant_sim::PlantParameters;
use recording::csv;

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args().skip(1) {
        let log = csv::read_file(&path, &csv::Options::default())?;
        let begin = Instant::now();
        let comparison = compare(
            &PlantParameters::nominal(),
            &log,
            &CompareOptions::default(),
        )?;
        println!(
            "{path}: holds: {}, {:.0} ms",
            comparison.verdict.holds,
            begin.elapsed().as_secs_f64() * 1e3
        );
        println!("  {}", comparison.start.statement);
        for signal in &comparison.signals {
            let free = &signal.free_run;
            println!(
                "  {}: free run {:.2e} {} rms = {:.1} x noise, fit {:.1} %; noise: {}",
                signal.name,
                free.rms,
                signal.unit,
                free.rms_in_noise.unwrap_or(f64::NAN),
                free.fit_pct.unwrap_or(f64::NAN),
                signal.noise_floor.statement
            );
            if let Some(short) = &signal.one_step_ahead {
                println!(
                    "    one step ahead {:.2e} rms, perfect {:.2e}",
                    short.rms,
                    short.expected_rms.unwrap_or(0.0)
                );
            }
            if let Some(offset) = &signal.time_offset {
                println!(
                    "    {} {:.5} {:.5}",
                    offset.statement, offset.correlation_unshifted, offset.correlation_shifted
                );
            }
            println!("    {}", signal.finding.sentence);
            if std::env::var_os("REGIMES").is_some() {
                for regime in &signal.regimes {
                    println!("    {}", regime.title);
                    for bin in &regime.bins {
                        let error = bin.one_step_ahead.as_ref().unwrap_or(&bin.free_run);
                        println!(
                            "      {:<24} {:5.1} % of samples, excess {:6.1} % (free {:6.1} %), bias {:+.2e}, rms {:.2e}",
                            bin.label,
                            100.0 * bin.sample_share,
                            100.0 * error.excess_share.unwrap_or(0.0),
                            100.0 * bin.free_run.excess_share.unwrap_or(0.0),
                            error.bias,
                            error.rms
                        );
                    }
                }
            }
        }
    }
    Ok(())
}
