//! Records a field rig: a logger with rate, phase, clock and gaps of its own beside an ECU with its samples.

use std::fmt::Write;

use super::super::draw::log::{Channel, PRESSURE_BAR};
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

/// A row's instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instant {
    /// By the logger's clock (s).
    pub(super) logged_s: f64,
    /// In truth, since the first sample of the ECU (ns).
    pub(super) true_ns: u64,
}

/// The instants of all rows, those in gaps included; `first_ns` is the true instant of the first one.
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

/// The ECU with its rig.
struct Bench<'a> {
    plant: ReferencePlant,
    plan: &'a LogPlan,
    commands: Commands,
    sample_ns: u64,
    /// Samples so far.
    samples: u64,
    /// The command of the last one.
    command: [f64; 2],
    is_vent_normally_open: bool,
}

impl<'a> Bench<'a> {
    fn new(rig: &Rig, plan: &'a LogPlan, chance: &mut Chance) -> Self {
        let sample_s = rig.datasheet.ecu.sample_time_s;
        // A clock may be a little slow.
        let samples = (1.01 * plan.length_s / sample_s) as usize;
        Self {
            plant: ReferencePlant::new(rig),
            plan,
            commands: Commands::new(plan.profile, samples, plan.command_grid, chance),
            sample_ns: (sample_s * 1e9).round() as u64,
            samples: 0,
            command: [0.0; 2],
            is_vent_normally_open: rig.is_vent_normally_open,
        }
    }

    /// ECU samples before the log.
    fn lead(&self) -> usize {
        let warm = self.plan.warm;
        warm.map_or(0, |warm| warm.fill_samples + warm.shut_samples)
    }

    /// Runs to an instant, through the samples of the ECU until there.
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
                self.commands.at(n - begun, pressure)
            }
        };
        if let Some(warm) = self.plan.warm
            && n + 1 == self.lead()
        {
            self.plant.warm_gas(warm.surplus_k, warm.relaxation_s);
        }
        // A normally open valve is shut by its command.
        let vent = if self.is_vent_normally_open {
            100.0 - vent
        } else {
            vent
        };
        self.command = [fill, vent];
        self.plant.command(self.command);
        self.samples += 1;
    }
}

/// Records one log of `rig`.
pub(super) fn record(
    rig: &Rig,
    logger: &LoggerAnswer,
    plan: &LogPlan,
    chance: &mut Chance,
) -> (LogAnswer, String) {
    let mut bench = Bench::new(rig, plan, chance);
    let first_ns = bench.lead() as u64 * bench.sample_ns + (plan.phase_s * 1e9).round() as u64;
    let instants = instants(logger, plan.length_s, first_ns, chance);
    // The first mean is over an interval as well.
    let interval_ns = (1e9 / logger.rate_hz) as u64;
    bench.run_until(first_ns.saturating_sub(interval_ns), chance);
    bench.plant.begin_means();
    let mut text = header(logger);
    let mut first = None;
    for instant in &instants {
        bench.run_until(instant.true_ns, chance);
        let reading = bench.plant.reading();
        assert!(
            reading.pressure.is_finite(),
            "the reference plant's step is too long for this rig"
        );
        bench.plant.begin_means();
        first.get_or_insert_with(|| (reading.pressure * 1e-5, bench.plant.gas_temperature()));
        let is_in = |gap: &[f64; 2]| (gap[0]..gap[1]).contains(&instant.logged_s);
        if !plan.gaps.iter().any(is_in) {
            row(
                &mut text,
                rig,
                logger,
                instant.logged_s,
                bench.command,
                &reading,
                chance,
            );
        }
    }
    let (first_pressure_bar_gauge, first_temperature) = first.expect("a log has rows");
    let answer = LogAnswer {
        profile: plan.profile,
        command_grid: plan.command_grid,
        phase_s: plan.phase_s,
        gaps: plan.gaps.clone(),
        first_pressure_bar_gauge,
        first_surplus_k: first_temperature - rig.datasheet.gas.temperature_k,
        relaxation_s: plan.warm.map_or(0.0, |warm| warm.relaxation_s),
    };
    (answer, text)
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
    command: [f64; 2],
    reading: &Reading,
    chance: &mut Chance,
) {
    let pressure = Channel {
        noise: logger.noise_bar,
        step: RANGE_BAR / (1_u32 << logger.bits) as f64,
    };
    let pressure = pressure.read(reading.pressure * 1e-5, 1.0, chance);
    let [fill, vent] = command;
    _ = write!(text, "{logged_s:.6},{fill:.1},{vent:.1},{pressure:.4}");
    if logger.currents {
        for current in reading.currents {
            _ = write!(text, ",{:.0}", CURRENT_MA.read(1e3 * current, 1.0, chance));
        }
    }
    if logger.supply_pressure {
        let supply = rig.datasheet.gas.supply_pressure_bar_gauge;
        _ = write!(text, ",{:.2}", SUPPLY_BAR.read(supply, 1.0, chance));
    }
    text.push('\n');
}
