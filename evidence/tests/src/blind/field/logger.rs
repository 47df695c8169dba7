//! Recording of a field rig: a logger with its own rate, phase, clock and gaps beside the ECU with its samples.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::super::draw::log::{Channel, PRESSURE_BAR, signals};
use super::super::draw::profile::Commands;
use super::format::{LogAnswer, LoggerAnswer};
use super::plan::LogPlan;
use crate::chance::Chance;
use crate::reference_plant::{Reading, ReferencePlant, Rig};

/// Range of the pressure's converter (bar).
pub(super) const RANGE_BAR: f64 = 12.0;
const CURRENT_MA: Channel = Channel {
    noise: 1.0,
    step: 1.0,
};
const SUPPLY_BAR: Channel = Channel {
    noise: 10e-3,
    step: 10e-3,
};

/// Instant of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instant {
    /// Time by the logger's clock (s).
    pub(super) logged_s: f64,
    /// True time since the first sample of the ECU (ns).
    pub(super) true_ns: u64,
}

/// Returns the instants of all rows, including those in gaps; `first_ns` is the true instant of the first one.
pub(super) fn instants(
    logger: &LoggerAnswer,
    length_s: f64,
    first_ns: u64,
    chance: &mut Chance,
) -> Vec<Instant> {
    let rows = (length_s * logger.rate_hz) as usize;
    let half = logger.unevenness;
    let instant = |n: usize| {
        let late = if n > 0 && half > 0.0 {
            chance.between(-half, half)
        } else {
            0.0
        };
        let logged_s = (n as f64 + late) / logger.rate_hz;
        let true_s = logged_s * (1.0 + 1e-6 * logger.clock_error_ppm);
        Instant {
            logged_s,
            true_ns: first_ns + (true_s * 1e9).round() as u64,
        }
    };
    (0..rows).map(instant).collect()
}

/// ECU with its rig.
struct Bench<'a> {
    plant: ReferencePlant,
    plan: &'a LogPlan,
    commands: Commands,
    /// Commands so far, one pair per sample of the log's command profile.
    given: Vec<[f64; 2]>,
    sample_ns: u64,
    /// Samples so far.
    samples: u64,
    /// Duty cycles of the last sample.
    duty: [f64; 2],
    is_vent_normally_open: bool,
}

impl<'a> Bench<'a> {
    fn new(rig: &Rig, plan: &'a LogPlan, commands: Commands) -> Self {
        Self {
            plant: ReferencePlant::new(rig),
            plan,
            commands,
            given: Vec::new(),
            sample_ns: (rig.datasheet.ecu.sample_time_s * 1e9).round() as u64,
            samples: 0,
            duty: [0.0; 2],
            is_vent_normally_open: rig.is_vent_normally_open,
        }
    }

    /// Returns the number of ECU samples before the log.
    fn lead(&self) -> usize {
        let warm = self.plan.warm;
        warm.map_or(0, |warm| warm.fill_samples + warm.shut_samples)
    }

    /// Returns the true instant of the first row (ns).
    fn first_ns(&self) -> u64 {
        self.lead() as u64 * self.sample_ns + (self.plan.phase_s * 1e9).round() as u64
    }

    /// Runs to one interval before the first row, so that its means also cover an interval.
    fn begin(&mut self, logger: &LoggerAnswer, chance: &mut Chance) {
        let interval_ns = (1e9 / logger.rate_hz) as u64;
        self.run_until(self.first_ns().saturating_sub(interval_ns), chance);
        self.plant.begin_means();
    }

    /// Runs to the instant of a row, and reads it.
    fn read_at(&mut self, instant: &Instant, chance: &mut Chance) -> Reading {
        self.run_until(instant.true_ns, chance);
        let reading = self.plant.reading();
        assert!(
            reading.pressure.is_finite(),
            "the reference plant's step is too long for this rig"
        );
        self.plant.begin_means();
        reading
    }

    /// Runs to an instant, through all samples of the ECU before it.
    fn run_until(&mut self, to_ns: u64, chance: &mut Chance) {
        while self.samples * self.sample_ns <= to_ns {
            self.plant.run_until(self.samples * self.sample_ns);
            self.sample(chance);
        }
        self.plant.run_until(to_ns);
    }

    fn sample(&mut self, chance: &mut Chance) {
        let n = self.samples as usize;
        let [fill, vent] = match self.plan.warm {
            Some(warm) if n < warm.fill_samples => [100.0, 0.0],
            Some(warm) if n < self.lead() + warm.hold_samples => [0.0; 2],
            warm => {
                let begun = self.lead() + warm.map_or(0, |warm| warm.hold_samples);
                let pressure = self.plant.reading().pressure * 1e-5;
                let pressure = PRESSURE_BAR.read(pressure, 1.0, chance);
                let command = self.commands.at(n - begun, pressure);
                self.given.push(command);
                command
            }
        };
        if let Some(warm) = self.plan.warm
            && n + 1 == self.lead()
        {
            self.plant.warm_gas(warm.surplus_k, warm.relaxation_s);
        }
        // A normally open valve is closed by its command.
        let vent = if self.is_vent_normally_open {
            100.0 - vent
        } else {
            vent
        };
        self.duty = [fill, vent];
        self.plant.command(self.duty);
        self.samples += 1;
    }
}

/// Recorded log.
#[derive(Debug, Clone)]
pub(super) struct Recorded {
    pub(super) answer: LogAnswer,
    /// Text as CSV.
    pub(super) text: String,
    pub(super) run: Run,
}

/// Run of a rig: its commands, and its readings without noise.
#[derive(Debug, Clone)]
pub(super) struct Run {
    commands: Vec<[f64; 2]>,
    /// Instants of all rows, including those in gaps, and their readings.
    instants: Vec<Instant>,
    pub(super) readings: Vec<Reading>,
}

/// Records one log of `rig`.
pub(super) fn record(
    rig: &Rig,
    logger: &LoggerAnswer,
    plan: &LogPlan,
    chance: &mut Chance,
) -> Recorded {
    // One percent more, since a clock may be slightly slow.
    let samples = (1.01 * plan.length_s / rig.datasheet.ecu.sample_time_s) as usize;
    let commands = Commands::new(plan.profile, samples, plan.command_grid, chance);
    let mut bench = Bench::new(rig, plan, commands);
    let instants = instants(logger, plan.length_s, bench.first_ns(), chance);
    bench.begin(logger, chance);
    let mut text = header(logger);
    let mut readings = Vec::with_capacity(instants.len());
    let mut first_temperature = None;
    for instant in &instants {
        let reading = bench.read_at(instant, chance);
        readings.push(reading);
        first_temperature.get_or_insert_with(|| bench.plant.gas_temperature());
        if plan.is_logged(instant.logged_s) {
            row(
                &mut text,
                rig,
                logger,
                instant.logged_s,
                bench.duty,
                &reading,
                chance,
            );
        }
    }
    let first_temperature = first_temperature.expect("a log has rows");
    let answer = LogAnswer {
        profile: plan.profile,
        command_grid: plan.command_grid,
        phase_s: plan.phase_s,
        gaps: plan.gaps.clone(),
        first_pressure_bar_gauge: readings[0].pressure * 1e-5,
        first_surplus_k: first_temperature - rig.datasheet.gas.temperature_k,
        relaxation_s: plan.warm.map_or(0.0, |warm| warm.relaxation_s),
    };
    Recorded {
        answer,
        text,
        run: Run {
            commands: bench.given,
            instants,
            readings,
        },
    }
}

/// Returns the readings of another rig with the commands of a run of `plan`, at the same instants.
pub(super) fn replay(rig: &Rig, logger: &LoggerAnswer, plan: &LogPlan, run: &Run) -> Vec<Reading> {
    let mut bench = Bench::new(rig, plan, Commands::Listed(run.commands.clone()));
    // Noise of the ECU's sensor; the given commands do not depend on it.
    let mut chance = Chance::new(0);
    bench.begin(logger, &mut chance);
    let read_at = |instant| bench.read_at(instant, &mut chance);
    run.instants.iter().map(read_at).collect()
}

/// Returns the differences between `readings` and `others` in the logged rows of `run`, by logged signal, in units of
/// the noise and converter steps of the channel.
pub(super) fn differences(
    (logger, plan, run): (&LoggerAnswer, &LogPlan, &Run),
    readings: &[Reading],
    others: &[Reading],
) -> BTreeMap<&'static str, Vec<f64>> {
    let rows = run.instants.iter().zip(readings.iter().zip(others));
    let logged = rows.filter(|(instant, _)| plan.is_logged(instant.logged_s));
    let mut differences: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for (_, (reading, other)) in logged {
        for ((signal, value), (_, other)) in signals(reading).into_iter().zip(signals(other)) {
            if let Some(channel) = channel(logger, signal) {
                let of_signal = differences.entry(signal).or_default();
                of_signal.push((value - other) / channel.rms());
            }
        }
    }
    differences
}

/// Returns the channel of a signal (bar, mA); `None` if it is not logged.
fn channel(logger: &LoggerAnswer, signal: &str) -> Option<Channel> {
    if signal == "p_ch" {
        Some(pressure_bar(logger))
    } else {
        logger.currents.then(|| current_ma(logger))
    }
}

fn pressure_bar(logger: &LoggerAnswer) -> Channel {
    Channel {
        noise: logger.noise_bar,
        step: RANGE_BAR / f64::from(1_u32 << logger.bits),
    }
    .scaled(logger.sensor_share)
}

fn current_ma(logger: &LoggerAnswer) -> Channel {
    CURRENT_MA.scaled(logger.sensor_share)
}

fn header(logger: &LoggerAnswer) -> String {
    let mut text = String::from("time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge");
    if logger.currents {
        text += ",i_fill_mA,i_vent_mA";
    }
    if logger.supply_pressure {
        text += ",p_sup_bar_gauge";
    }
    text + "\n"
}

fn row(
    text: &mut String,
    rig: &Rig,
    logger: &LoggerAnswer,
    logged_s: f64,
    duty: [f64; 2],
    reading: &Reading,
    chance: &mut Chance,
) {
    let pressure = pressure_bar(logger).read(reading.pressure * 1e-5, 1.0, chance);
    let [fill, vent] = duty;
    // Further digits for finer steps.
    let more = logger.sensor_share.recip().log10().ceil().max(0.0) as usize;
    let digits = 4 + more;
    _ = write!(
        text,
        "{logged_s:.6},{fill:.1},{vent:.1},{pressure:.digits$}"
    );
    if logger.currents {
        for current in reading.currents {
            let current = current_ma(logger).read(1e3 * current, 1.0, chance);
            _ = write!(text, ",{current:.more$}");
        }
    }
    if logger.supply_pressure {
        let supply = rig.datasheet.gas.supply_pressure_bar_gauge;
        let gauge = SUPPLY_BAR.scaled(logger.sensor_share);
        let digits = 2 + more;
        _ = write!(text, ",{:.digits$}", gauge.read(supply, 1.0, chance));
    }
    text.push('\n');
}
