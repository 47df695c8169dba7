//! Synthetic bench for tests: a plant, a log of commands, noise and resolution, all from one seed.

use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::{CurrentSampling, Replay, ReplayInput, replay};
use plant_sim::{Command, PlantParameters, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

use crate::commands::Commands;
use crate::noise::Noise;

/// Returns the nearest multiple of `step`; a `step` of 0 returns `value` unchanged.
pub(crate) fn quantise(value: f64, step: f64) -> f64 {
    if step > 0.0 {
        (value / step).round() * step
    } else {
        value
    }
}

/// Returns `log` without these rows, as after a pause of the logger.
pub(crate) fn without_rows(log: &Recording, rows: std::ops::Range<usize>) -> Recording {
    let kept = |values: &[f64]| [&values[..rows.start], &values[rows.end..]].concat();
    let mut paused = Recording::new(log.provenance().clone());
    let (_, base) = log.time_bases().next().unwrap();
    let id = paused.add_time_base(TimeBase::new(kept(base.times_s())).unwrap());
    for signal in log.signals() {
        let values = kept(signal.values_or_nan());
        paused
            .add_signal(signal.name(), signal.unit(), id, values)
            .unwrap();
    }
    paused
}

/// Returns the log with other signals: `change` gets name, unit and samples, and its result replaces them.
pub(crate) fn changed(
    log: &Recording,
    mut change: impl FnMut(&str, Unit, Vec<f64>) -> Option<(Unit, Vec<f64>)>,
) -> Recording {
    let mut other = Recording::new(log.provenance().clone());
    let base = log.time_base(log.signals()[0].time_base()).unwrap();
    let id = other.add_time_base(base.clone());
    for signal in log.signals() {
        let samples = signal.values_or_nan().to_vec();
        if let Some((unit, samples)) = change(signal.name(), signal.unit(), samples) {
            other.add_signal(signal.name(), unit, id, samples).unwrap();
        }
    }
    other
}

/// Returns the log with only the signals whose names `keep` accepts.
pub(crate) fn with_signals(log: &Recording, keep: impl Fn(&str) -> bool) -> Recording {
    changed(log, |name, unit, samples| {
        keep(name).then_some((unit, samples))
    })
}

/// Returns the log with other values of the signal `of`.
pub(crate) fn with_values(
    log: &Recording,
    of: &str,
    mut value: impl FnMut(usize, f64) -> f64,
) -> Recording {
    changed(log, |name, unit, mut samples| {
        if name == of {
            for (row, sample) in samples.iter_mut().enumerate() {
                *sample = value(row, *sample);
            }
        }
        Some((unit, samples))
    })
}

/// Returns `log` with the height of each spike added to the samples of `signal` in its rows.
pub(crate) fn spiked(
    log: &Recording,
    signal: &str,
    spikes: &[(std::ops::Range<usize>, f64)],
) -> Recording {
    let height = |row: usize| {
        let there = spikes.iter().filter(|(rows, _)| rows.contains(&row));
        there.map(|(_, height)| height).sum::<f64>()
    };
    with_values(log, signal, |row, value| value + height(row))
}

/// Returns the log without its currents.
pub(crate) fn pressure_alone(log: &Recording) -> Recording {
    with_signals(log, |name| !name.starts_with("i_"))
}

/// Returns the log with its chamber pressure as an absolute one, at this ambient pressure.
pub(crate) fn with_absolute_pressure(log: &Recording, ambient_bar: f64) -> Recording {
    let above_vacuum = with_values(log, "p_ch", |_, gauge_bar| gauge_bar + ambient_bar);
    changed(&above_vacuum, |name, unit, samples| {
        let is_pressure = name == "p_ch";
        Some((if is_pressure { Unit::BarAbsolute } else { unit }, samples))
    })
}

/// Returns a log of `count` samples in which nothing is commanded.
pub(crate) fn shut_for(count: usize, interval_s: f64) -> Commands {
    let mut log = Recording::new(Provenance::from_source("shut"));
    let id = log.add_time_base(TimeBase::uniform(0.0, interval_s, count).unwrap());
    for name in crate::commands::DUTIES {
        log.add_signal(name, Unit::Percent, id, vec![0.0; count])
            .unwrap();
    }
    Commands::new(&PlantParameters::nominal(), &log).unwrap()
}

/// Standard deviation of the logger's noise: pressure (bar), currents (mA).
const NOISE: [f64; 3] = [2e-3, 0.7, 0.7];

/// Returns the log that a logger with `clock` records of `plant`, with a row every `interval_s`: fills, holds and vents.
pub(crate) fn logged(
    plant: &PlantParameters,
    clock: LoggerClock,
    interval_s: f64,
    seed: u64,
) -> Recording {
    logged_through(plant, clock, interval_s, seed, &Bench::default().phases)
}

/// Returns the same as `logged`, with other commands: duration (s) with the duty cycles (%) of fill and vent valve.
pub(crate) fn logged_through(
    plant: &PlantParameters,
    clock: LoggerClock,
    interval_s: f64,
    seed: u64,
    phases: &[(f64, f64, f64)],
) -> Recording {
    let sample_time_ns = plant.ecu.sample_time_ns();
    let profile: Vec<Command> = phases
        .iter()
        .flat_map(|&(seconds, duty_fill_pct, duty_vent_pct)| {
            let command = Command {
                duty_fill_pct,
                duty_vent_pct,
            };
            std::iter::repeat_n(command, (seconds / 0.01_f64).round() as usize)
        })
        .collect();
    let rows = ((profile.len() - 2) as f64 * 0.01 / interval_s) as usize;
    let mut replay = Replay::new(plant, CurrentSampling::MeanOfInterval, Tolerance::default());
    let mut noise = Noise::new(seed);
    let mut columns: [Vec<f64>; 5] = Default::default();
    let given = |time_ns: u64, sample: u64| ReplayInput {
        issued_ns: sample * sample_time_ns,
        command: Some(profile[sample as usize]),
        ..ReplayInput::at(time_ns)
    };
    let mut next = 0;
    for row in 0..rows {
        let log_ns = (row as f64 * interval_s * 1e9).round() as u64;
        let time_ns = clock.ecu_time_ns(log_ns);
        let sample = time_ns / sample_time_ns;
        // The ECU also gives commands between two rows. The mean of a current restarts there.
        for unseen in next..sample {
            replay.row(given(unseen * sample_time_ns, unseen));
        }
        next = sample + 1;
        let row = replay.row(given(time_ns, sample));
        for (column, value) in columns.iter_mut().zip(row) {
            column.push(value);
        }
    }
    for (column, sigma) in columns[2..].iter_mut().zip(NOISE) {
        column
            .iter_mut()
            .for_each(|value| *value += sigma * noise.normal());
    }
    let mut log = Recording::new(Provenance::from_source(format!("logger-{seed}")));
    let id = log.add_time_base(TimeBase::uniform(0.0, interval_s, rows).unwrap());
    let signals = [
        ("duty_fill", Unit::Percent),
        ("duty_vent", Unit::Percent),
        ("p_ch", Unit::BarGauge),
        ("i_fill", Unit::Milliampere),
        ("i_vent", Unit::Milliampere),
    ];
    for ((name, unit), column) in signals.into_iter().zip(columns) {
        log.add_signal(name, unit, id, column).unwrap();
    }
    log
}

/// Signals that a logger records together: names, interval (s) and instant of the first sample (s).
pub(crate) type Rate<'a> = (&'a [&'a str], f64, f64);

/// Returns the log of [`logged`], with each group of signals at a rate of its own and with a time base of its own.
pub(crate) fn logged_at_rates(
    plant: &PlantParameters,
    clock: LoggerClock,
    rates: &[Rate],
) -> Recording {
    let mut log = Recording::new(Provenance::from_source("rates"));
    for (seed, &(names, interval_s, begin_s)) in (1..).zip(rates) {
        let later = LoggerClock {
            phase_s: clock.phase_at_s(begin_s) + begin_s,
            ..clock
        };
        let part = logged(plant, later, interval_s, seed);
        let count = part.time_bases().next().unwrap().1.len();
        let id = log.add_time_base(TimeBase::uniform(begin_s, interval_s, count).unwrap());
        for &name in names {
            let signal = part.signal(name).unwrap();
            let values = signal.values_or_nan().to_vec();
            log.add_signal(name, signal.unit(), id, values).unwrap();
        }
    }
    log
}

/// Rig whose plant a test changes before it measures.
pub(crate) struct Bench {
    /// Plant on the rig.
    pub(crate) plant: PlantParameters,
    /// Phases of commands: duration (s), duty cycles of fill and of vent valve (%).
    pub(crate) phases: Vec<(f64, f64, f64)>,
    /// Sample interval (s).
    pub(crate) interval_s: f64,
    /// Noise (bar rms) and resolution (bar) of the pressure.
    pub(crate) pressure_noise: (f64, f64),
    /// Noise (mA rms) and resolution (mA) of the currents.
    pub(crate) current_noise: (f64, f64),
    /// Initial pressure (bar gauge).
    pub(crate) initial_bar: f64,
    /// Logged supply pressure over time (bar gauge over s); none uses the plant's, which is not logged.
    pub(crate) supply_bar: Option<fn(f64) -> f64>,
    /// Share of the gauge pressure that leaks per second (1/s).
    pub(crate) leak_per_s: f64,
    pub(crate) seed: u64,
}

impl Default for Bench {
    /// Returns the nominal plant with fills and vents separated by holds, and sensors as in the bundled logs.
    fn default() -> Self {
        let mut phases = vec![(1.0, 0.0, 0.0)];
        for duty in [100.0, 60.0, 45.0, 80.0] {
            phases.extend([
                (0.10, duty, 0.0),
                (0.6, 0.0, 0.0),
                (0.15, duty, 0.0),
                (0.6, 0.0, 0.0),
                (0.15, 0.0, duty),
                (0.6, 0.0, 0.0),
                (0.5, 0.0, 100.0),
                (0.3, 0.0, 0.0),
            ]);
        }
        Self {
            plant: PlantParameters::nominal(),
            phases,
            interval_s: 0.01,
            pressure_noise: (4e-3, 5.1e-3),
            current_noise: (0.7, 0.5),
            initial_bar: 0.0,
            supply_bar: None,
            leak_per_s: 0.0,
            seed: 1,
        }
    }
}

impl Bench {
    /// Returns the log of a run on this rig.
    pub(crate) fn measure(&self) -> Recording {
        let mut log = self.commands();
        let mut pressures_bar = Vec::new();
        let true_run = replay(&self.plant, &log, Tolerance::default(), |row, simulator| {
            let ambient = self.plant.gas.ambient_pressure_pa;
            if row == 0 {
                simulator.set_chamber_pressure(ambient + self.initial_bar * 1e5);
            }
            let shown = simulator.sample().measured_pressure;
            pressures_bar.push((shown - ambient) / 1e5);
            let gauge = simulator.state().pressure - ambient;
            simulator
                .set_chamber_pressure(ambient + gauge * (-self.leak_per_s * self.interval_s).exp());
        });
        let simulated = true_run.unwrap().recording;
        let mut noise = Noise::new(self.seed);
        let id = log.signals()[0].time_base();
        let mut add = |name: &str, unit, values: &[f64], (sigma, step): (f64, f64)| {
            let sampled = values
                .iter()
                .map(|value| quantise(value + sigma * noise.normal(), step));
            let sampled = sampled.collect();
            log.add_signal(name, unit, id, sampled).unwrap();
        };
        // A part that the plant lacks has no sensor.
        if simulated.signal("p_ch").is_some() {
            add("p_ch", Unit::BarGauge, &pressures_bar, self.pressure_noise);
        }
        for current in ["i_fill", "i_vent"].map(|name| simulated.signal(name)) {
            let Some(current) = current else { continue };
            add(
                current.name(),
                current.unit(),
                current.values_or_nan(),
                self.current_noise,
            );
        }
        log
    }

    fn commands(&self) -> Recording {
        let mut duties = [Vec::new(), Vec::new()];
        for &(seconds, fill, vent) in &self.phases {
            let count = (seconds / self.interval_s).round() as usize;
            duties[0].extend(std::iter::repeat_n(fill, count));
            duties[1].extend(std::iter::repeat_n(vent, count));
        }
        let mut log = Recording::new(Provenance::from_source("bench"));
        let base = TimeBase::uniform(0.0, self.interval_s, duties[0].len()).unwrap();
        let supply = self.supply_bar.map(|supply_bar| {
            let times_s = base.times_s().iter();
            times_s.map(|&time_s| supply_bar(time_s)).collect()
        });
        let id = log.add_time_base(base);
        if let Some(supply) = supply {
            log.add_signal("p_sup", Unit::BarGauge, id, supply).unwrap();
        }
        for (name, duty) in crate::commands::DUTIES.into_iter().zip(duties) {
            log.add_signal(name, Unit::Percent, id, duty).unwrap();
        }
        log
    }
}
