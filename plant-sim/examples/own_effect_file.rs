//! Effect of your own without Rust: a table of the plant file, the leak of a seal that lifts above a pressure. Prints
//! the pressure with and without it, and what its law costs.

use std::time::Instant;

use plant_sim::{Command, PlantParameters, Simulator};

/// Simulated time of the measurement of the cost (s).
const SIMULATED_S: u64 = 20;

const SEAL: &str = r#"
[own_effects.lifting_seal]
sentence = "The lip of the shaft seal lifts above a pressure, and air escapes past it."
acts_on = "leak_flow"
expression = "k * max(p - p_lift, 0)"
parameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = "kg/s/Pa" }
parameters.p_lift = { typical = 5e5, range = [1.5e5, 9e5], unit = "Pa" }

[effects.own.lifting_seal]
k = 1.6e-10
p_lift = 6.2e5
"#;

fn main() -> Result<(), plant_sim::ParameterError> {
    let plain = PlantParameters::nominal();
    let file = format!("{}\n{SEAL}", plain.to_toml());
    let leaking = PlantParameters::from_toml(&file, "rig.toml")?;

    println!("time [s]   pressure [bar abs] without and with the seal");
    let [mut tight, mut leaky] = [&plain, &leaking].map(Simulator::new);
    for half_second in 1..=6 {
        let pressures = [&mut tight, &mut leaky].map(|simulator| {
            simulator.command(Command {
                duty_fill_pct: if half_second == 1 { 100.0 } else { 0.0 },
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(half_second * 500_000_000);
            simulator.sample().pressure
        });
        let [tight, leaky] = pressures.map(|pressure| pressure / 1e5);
        println!("{:8.1}   {tight:.3}   {leaky:.3}", 0.5 * half_second as f64);
        assert!(half_second == 1 || leaky < tight);
    }

    let [without, with] = [&plain, &leaking].map(seconds);
    let times_real_time = |seconds: f64| SIMULATED_S as f64 / seconds;
    println!(
        "both valves pulsed: {:.0} times real time without, {:.0} with it; it takes {:.1} times as long",
        times_real_time(without),
        times_real_time(with),
        with / without
    );
    Ok(())
}

/// Returns the time that a simulation takes in which both valves are pulsed in each period (s): the best of three.
fn seconds(plant: &PlantParameters) -> f64 {
    let run = |_| {
        let mut simulator = Simulator::new(plant);
        let begin = Instant::now();
        for row in 0..SIMULATED_S * 100 {
            simulator.command(Command {
                duty_fill_pct: 40.0 + (row % 40) as f64,
                duty_vent_pct: 70.0 - (row % 35) as f64,
            });
            simulator.advance_to_ns((row + 1) * 10_000_000);
        }
        assert!(simulator.sample().pressure.is_finite());
        begin.elapsed().as_secs_f64()
    };
    (0..3).map(run).fold(f64::INFINITY, f64::min)
}
