//! One run, sample by sample.

use ecu::{FaultSet, Mode};
use hil_harness::campaign::{CampaignError, Injection, Target, run_watched};
use hil_harness::wire::measured_bar;

/// Runs `injection`, prints every sample, and returns the number of runs that violated a requirement: 0 or 1.
pub(crate) fn print(injection: &Injection, target: &mut dyn Target) -> Result<u32, CampaignError> {
    println!("sample  p_ref   p_ch  shown   fill%  vent%  fill_mA vent_mA  mode     faults");
    let outcome = run_watched(injection, target, &mut |seen, telemetry| {
        let sample = seen.sensors.sample;
        let mode = Mode::ALL
            .into_iter()
            .find(|mode| *mode as u8 == telemetry.mode);
        let [fill, vent] = seen.coils;
        let shown = seen
            .sensors
            .pressure
            .map_or("-".to_owned(), |code| format!("{:.3}", measured_bar(code)));
        let current =
            |milliampere: Option<u16>| milliampere.map_or("-".to_owned(), |ma| ma.to_string());
        println!(
            "{sample:6} {:6.3} {:6.3} {shown:>6}  {fill:6.2} {vent:6.2}  {:>7} {:>7}  {:8} {}{}",
            seen.reference_bar,
            seen.pressure_bar,
            current(seen.sensors.current_fill_ma),
            current(seen.sensors.current_vent_ma),
            mode.map_or("?".to_owned(), |mode| format!("{mode:?}")),
            FaultSet::from_bits(telemetry.faults),
            injection.age(sample).map_or("", |_| "  <- broken"),
        );
    })?;
    println!("{injection}");
    for violation in &outcome.violations {
        println!("    {violation}");
    }
    println!(
        "{}",
        if outcome.violations.is_empty() {
            "every requirement was met"
        } else {
            "a requirement was violated"
        }
    );
    Ok(u32::from(!outcome.violations.is_empty()))
}
