//! Unexplained residual after the named effects: the missing flow as a function of quantities on which it may depend, spectral lines,
//! single lost pulses.

mod alike;
mod curves;
mod flow_table;
mod lines;
mod own_effect;
mod periodogram;
mod pulses;
mod sentences;
mod trace;

use plant_sim::PlantParameters;
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::Row;

use super::evidence::log::Log;
use super::result::{Remaining, SpectralLine};
use lines::{Sensitivity, Swing};
use trace::{Regime, Trace, predicted};

pub use flow_table::MissingFlow;
pub use own_effect::WithMissingFlow;

/// Difference steps of the sensitivities: supply pressure (bar), share of the vent valve's flow.
const SUPPLY_STEP_BAR: f64 = 0.05;
const FLOW_STEP: f64 = 0.02;

/// Returns the unexplained residual of `logs` with `plant`. Curves are computed where the error `is_material`; lines and lost pulses must
/// be significant by themselves.
pub(crate) fn remaining(plant: &PlantParameters, logs: &[&Log], is_material: bool) -> Remaining {
    let Some(rows) = predicted(logs, plant) else {
        return Remaining::default();
    };
    let traces: Vec<(usize, Trace)> = logs
        .iter()
        .zip(&rows)
        .enumerate()
        .filter_map(|(n, (log, rows))| Some((n, Trace::new(log, rows)?)))
        .collect();
    let mut swings = Vec::new();
    for sensitivities in sensitivities(plant, logs, &rows, &traces) {
        for ((_, trace), sensitivity) in traces.iter().zip(&sensitivities) {
            swings.extend(Swing::of_pressure(trace, sensitivity, plant));
        }
    }
    for (log, rows) in logs.iter().zip(&rows) {
        for channel in log
            .channels
            .iter()
            .filter(|channel| crate::measured::is_current(channel.signal))
        {
            let errors: Vec<f64> = channel
                .values
                .iter()
                .zip(rows)
                .map(|(value, row)| value - row[channel.column])
                .collect();
            swings.extend(Swing::of_current(log, channel, &errors, plant));
        }
    }
    let traces: Vec<Trace> = traces.into_iter().map(|(_, trace)| trace).collect();
    let mut remaining = Remaining {
        sentences: Vec::new(),
        missing_flow: if is_material {
            curves::curves(&traces)
        } else {
            Vec::new()
        },
        spectral_lines: spectral_lines(swings),
        lost_pulses: traces.iter().flat_map(pulses::lost_pulses).collect(),
    };
    remaining.sentences = sentences::sentences(&remaining, is_material);
    remaining
}

fn spectral_lines(swings: Vec<Swing>) -> Vec<SpectralLine> {
    let trials = swings.iter().map(Swing::trials).sum();
    let mut lines: Vec<SpectralLine> = swings
        .into_iter()
        .flat_map(|swing| swing.lines(trials))
        .collect();
    lines.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    let mut kept: Vec<SpectralLine> = Vec::new();
    for line in lines {
        // Several logs show the same line; the clearest one counts.
        let is_same = |other: &SpectralLine| {
            other.signal == line.signal
                && other.condition == line.condition
                && (other.frequency_hz / line.frequency_hz - 1.0).abs() < SAME_FREQUENCY
        };
        if !kept.iter().any(is_same) {
            kept.push(line);
        }
    }
    kept
}

/// Relative difference within which two frequencies are the same.
const SAME_FREQUENCY: f64 = 0.03;

/// Returns for each cause its influence on each time series.
fn sensitivities(
    plant: &PlantParameters,
    logs: &[&Log],
    rows: &[Vec<Row>],
    traces: &[(usize, Trace)],
) -> Vec<Vec<Sensitivity>> {
    let mut all = Vec::new();
    let supply = (
        "gas.supply_pressure_bar_gauge",
        SUPPLY_STEP_BAR,
        Regime::Filling,
        "bar of supply pressure",
    );
    let vent = (
        "flow.discharge_vent",
        FLOW_STEP,
        Regime::Venting,
        "of the flow",
    );
    for (valve, (name, step, regime, unit)) in [(FILL, supply), (VENT, vent)] {
        let Some(there) = plant
            .get(name)
            .filter(|_| plant.functions[valve].is_commanded())
        else {
            continue;
        };
        let mut moved = plant.clone();
        let change = if regime == Regime::Venting {
            step * there
        } else {
            step
        };
        if moved.set(name, there + change, "what it does").is_err() {
            continue;
        }
        let Some(moved) = predicted(logs, &moved) else {
            continue;
        };
        // A supply oscillates by its own pressure at most, and a flow by all of it.
        let largest = if regime == Regime::Venting {
            1.0
        } else {
            plant.gas.supply_pressure_bar_gauge
        };
        let of = |(n, trace): &(usize, Trace)| {
            let column = trace.channel.column;
            let pairs = moved[*n].iter().zip(&rows[*n]);
            let bar = pairs
                .map(|(moved, row)| (moved[column] - row[column]) / step)
                .collect();
            Sensitivity {
                regime,
                unit,
                largest,
                bar,
            }
        };
        all.push(traces.iter().map(of).collect());
    }
    all.push(traces.iter().map(|(_, trace)| leak(trace)).collect());
    all
}

/// Returns the influence of a missing rate on the prediction while both valves are shut.
fn leak(trace: &Trace) -> Sensitivity {
    let times_s = trace.times_s();
    let mut bar = vec![0.0; trace.len()];
    for row in 1..trace.len() {
        if trace.regimes[row] == Regime::Shut {
            let kept = 1.0 - trace.log.predictor.gains[row - 1];
            bar[row] = kept * bar[row - 1] + times_s[row] - times_s[row - 1];
        }
    }
    Sensitivity {
        regime: Regime::Shut,
        unit: "bar/s",
        largest: f64::INFINITY,
        bar,
    }
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::{About, Effect, EffectSetting, EntryPoint, Variant};
    use plant_sim::parameters::{ParameterSpec, Size};
    use plant_sim::plant::Plant;
    use recording::Recording;

    use super::*;
    use crate::bench::{Bench, changed};
    use crate::diagnosis::fit::gather::gather;
    use crate::diagnosis::result::FlowCurve;

    /// Returns the unexplained residual of the nominal model in the log of `rig`.
    fn seen(rig: &Recording) -> Remaining {
        let plant = PlantParameters::nominal();
        let evidence = gather(&plant, core::slice::from_ref(rig)).unwrap();
        remaining(&plant, &evidence.logs.iter().collect::<Vec<_>>(), true)
    }

    fn against_pressure(remaining: &Remaining) -> &FlowCurve {
        let curve = remaining.missing_flow.first().expect("a curve");
        assert_eq!(
            (curve.against.as_str(), curve.condition.as_str()),
            ("p_ch", "both valves shut")
        );
        curve
    }

    #[test]
    fn noise_alone_has_no_shape() {
        for seed in 1..=8 {
            let rig = Bench {
                seed,
                ..Bench::default()
            };
            let remaining = seen(&rig.measure());
            assert_eq!(remaining.missing_flow, [], "seed {seed}");
            assert_eq!(remaining.spectral_lines, [], "seed {seed}");
            assert_eq!(remaining.lost_pulses, [], "seed {seed}");
        }
    }

    /// The bench's leak takes 4 % of the gauge pressure per second: this rate (bar/s) is found at every pressure.
    #[test]
    fn a_leak_comes_out_as_its_rate() {
        let rig = Bench {
            leak_per_s: 0.04,
            ..Bench::default()
        };
        let remaining = seen(&rig.measure());
        let curve = against_pressure(&remaining);
        assert!(curve.explained_share > 0.9, "{curve:?}");
        for point in &curve.points {
            let off = (point.bar_per_s + 0.04 * point.at).abs();
            assert!(off < 4.0 * point.standard_error, "{point:?}");
            assert!(point.standard_error < 0.05, "{point:?}");
        }
        assert!(
            remaining.sentences[0].contains("follows p_ch"),
            "{:?}",
            remaining.sentences
        );
        assert_eq!(remaining.spectral_lines, []);
    }

    #[test]
    fn a_leak_becomes_a_table_that_takes_as_much_air() {
        let rig = Bench {
            leak_per_s: 0.04,
            ..Bench::default()
        };
        let remaining = seen(&rig.measure());
        let table = MissingFlow::new(against_pressure(&remaining), &rig.plant).unwrap();
        assert!((2..=5).contains(&table.knots().len()));
        // p V / (R T) of the gauge pressure, 4 % of it per second.
        for gauge_pa in [2e5, 4e5, 6e5] {
            let expected = -0.04 * gauge_pa / rig.plant.plant().chamber.pressure_per_mass;
            let off = table.at(rig.plant.gas.ambient_pressure_pa + gauge_pa) / expected - 1.0;
            assert!(off.abs() < 0.15, "{gauge_pa}: {off}");
        }
    }

    static SWING: ParameterSpec = ParameterSpec::of_effect(
        "effects.swing",
        "swing_bar",
        "bar",
        (1e-3, 3.0),
        Size::strength(0.3),
        "half of the swing",
    );
    static ABOUT: About = About {
        id: "swing",
        sentence: "The supply pressure swings.",
        source: "the test's own",
        acts_on: EntryPoint::AirSupply,
        variants: &[Variant::only(&[&SWING])],
        excited_by: "filling",
        confused_with: &[],
    };
    #[derive(Debug)]
    struct Swings;
    impl Effect for Swings {
        fn about(&self) -> &'static About {
            &ABOUT
        }
        fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
            let swing = setting.value("swing_bar") * 1e5;
            plant.additions.hooks.add_supply_pressure(move |now| {
                swing * (core::f64::consts::TAU * 0.7 * now.time).sin()
            });
        }
    }

    /// Returns fills at aperiodic instants.
    fn fills_of_no_period() -> Vec<(f64, f64, f64)> {
        let mut phases = vec![(1.0, 0.0, 0.0)];
        for n in 0..40 {
            phases.extend([
                (0.3, 45.0, 0.0),
                (0.1 + 0.037 * f64::from(n % 7), 0.0, 0.0),
                (0.4, 0.0, 100.0),
            ]);
        }
        phases
    }

    #[test]
    fn a_supply_that_swings_is_a_line() {
        let plant = PlantParameters::nominal().with_effect(EffectSetting::typical(&Swings));
        let remaining = seen(
            &Bench {
                plant,
                phases: fills_of_no_period(),
                ..Bench::default()
            }
            .measure(),
        );
        let line = remaining.spectral_lines.first().expect("a line");
        assert_eq!(line.condition, "filling");
        assert!((line.frequency_hz - 0.7).abs() < 0.01, "{line:?}");
        assert!((0.2..0.45).contains(&line.amplitude), "{line:?}");
        assert!(line.p_value < 1e-4);
        assert!(
            remaining.sentences[0].contains("supply pressure swung"),
            "{:?}",
            remaining.sentences
        );
    }

    /// Defect seen: a supply of 8.4 bar was reported to oscillate by ±21.8 bar. Here the same error requires an oscillation of the supply
    /// by 0.3 bar, or by a hundred times that.
    #[test]
    fn a_supply_does_not_swing_by_more_than_its_pressure() {
        let plant = PlantParameters::nominal();
        let rig = Bench {
            plant: plant.with_effect(EffectSetting::typical(&Swings)),
            phases: fills_of_no_period(),
            ..Bench::default()
        };
        let evidence = gather(&plant, [&rig.measure()]).unwrap();
        let logs: Vec<&Log> = evidence.logs.iter().collect();
        let rows = predicted(&logs, &plant).unwrap();
        let traces = [(0, Trace::new(logs[0], &rows[0]).unwrap())];
        let lines = |weaker: f64| {
            let mut supply = sensitivities(&plant, &logs, &rows, &traces).remove(0);
            let mut supply = supply.remove(0);
            supply.bar.iter_mut().for_each(|bar| *bar /= weaker);
            let swing = Swing::of_pressure(&traces[0].1, &supply, &plant).unwrap();
            let trials = swing.trials();
            swing.lines(trials)
        };
        let [line] = &lines(1.0)[..] else {
            panic!("one line");
        };
        assert!((0.2..0.45).contains(&line.amplitude), "{line:?}");
        assert_eq!(lines(100.0), []);
    }

    /// The supply oscillates at the second harmonic of fills every 2.86 s: a line that coincides with the commands may come from them.
    #[test]
    fn a_harmonic_of_the_commands_is_no_line() {
        let plant = PlantParameters::nominal().with_effect(EffectSetting::typical(&Swings));
        let mut phases = vec![(1.0, 0.0, 0.0)];
        for n in 0..20 {
            let duty = 35.0 + 8.0 * f64::from(n * 5 % 7);
            let length_s = 0.2 + 0.05 * f64::from(n * 3 % 8);
            phases.extend([
                (length_s, duty, 0.0),
                (1.86 - length_s, 0.0, 0.0),
                (1.0, 0.0, 100.0),
            ]);
        }
        let rig = Bench {
            plant,
            phases,
            ..Bench::default()
        };
        assert_eq!(seen(&rig.measure()).spectral_lines, []);
    }

    /// Twenty equal pulses, of which the rig misses one.
    #[test]
    fn a_missed_pulse_is_reported() {
        let mut phases = vec![(1.0, 0.0, 0.0)];
        for _ in 0..20 {
            phases.extend([(0.05, 80.0, 0.0), (0.35, 0.0, 0.0), (0.4, 0.0, 100.0)]);
        }
        let commanded = Bench {
            phases: phases.clone(),
            ..Bench::default()
        };
        phases[1 + 3 * 12].1 = 0.0;
        let done = Bench {
            phases,
            ..Bench::default()
        };
        // The measurement, with the commands of the other log.
        let (measured, log) = (done.measure(), commanded.measure());
        let mixed = changed(&log, |name, unit, commands| {
            let of_other = measured.signal(name).unwrap().values_or_nan();
            let is_command = name.starts_with("duty");
            Some((
                unit,
                if is_command {
                    commands
                } else {
                    of_other.to_vec()
                },
            ))
        });
        let remaining = seen(&mixed);
        let [pulse] = &remaining.lost_pulses[..] else {
            panic!("{:?}", remaining.lost_pulses)
        };
        assert!((pulse.time_s - (1.0 + 12.0 * 0.8)).abs() < 0.1, "{pulse:?}");
        assert!(pulse.jump_bar < -0.3, "{pulse:?}");
        assert!(
            remaining
                .sentences
                .iter()
                .any(|sentence| sentence.contains("sticks"))
        );
    }

    #[test]
    fn commands_that_repeat_make_no_line() {
        // Another volume causes the same error at every pulse, every 0.8 s.
        let mut plant = PlantParameters::nominal();
        plant
            .set(
                "chamber.volume_m3",
                1.2 * plant.get("chamber.volume_m3").unwrap(),
                "a larger one",
            )
            .unwrap();
        let mut phases = vec![(1.0, 0.0, 0.0)];
        for _ in 0..30 {
            phases.extend([(0.2, 60.0, 0.0), (0.2, 0.0, 0.0), (0.4, 0.0, 100.0)]);
        }
        let remaining = seen(
            &Bench {
                plant,
                phases,
                ..Bench::default()
            }
            .measure(),
        );
        assert_eq!(remaining.spectral_lines, []);
        assert_eq!(remaining.lost_pulses, []);
    }
}
