//! Recording of a rig: its plant runs with the commands, and a logger with its own clock reads it.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::super::draw::log::Channel;
use super::format::KindLogger;
use crate::chance::Chance;
use crate::kinds_plant::{Drive, KindPlant, KindReading, KindRig};

const PA_PER_BAR: f64 = 1e5;
const SUPPLY_BAR: Channel = Channel {
    noise: 10e-3,
    step: 10e-3,
};

const POSITION_MM: Channel = Channel {
    noise: 0.02,
    step: 0.02,
};
const VOLTAGE_V: Channel = Channel {
    noise: 0.02,
    step: 0.02,
};

/// Row of a run: logged time (s), commands (%) that stand then, and readings without noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    logged_s: f64,
    commands: [f64; 2],
    reading: KindReading,
}

/// Runs a rig with these commands, and returns the rows of one of its logs, gaps left out.
pub(super) fn run(
    rig: &KindRig,
    logger: &KindLogger,
    log: usize,
    commands: &[[f64; 2]],
) -> Vec<Row> {
    let mut plant = KindPlant::new(rig);
    let mut begun = 0;
    let count = (logger.lengths_s[log] * logger.rate_hz) as usize;
    let mut rows = Vec::with_capacity(count);
    for n in 0..count {
        let logged_s = n as f64 / logger.rate_hz;
        let true_s =
            logger.offset_of_first_row_s[log] + logged_s * (1.0 + 1e-6 * logger.clock_error_ppm);
        while begun < commands.len() && begun as f64 * rig.command_period_s <= true_s {
            plant.run_until(begun as f64 * rig.command_period_s);
            plant.begin_period(commands[begun]);
            begun += 1;
        }
        plant.run_until(true_s);
        let mut gaps = logger.gaps_s[log].iter();
        if !gaps.any(|gap| (gap[0]..gap[1]).contains(&logged_s)) {
            rows.push(Row {
                logged_s,
                commands: commands[begun - 1],
                reading: plant.reading(),
            });
        }
    }
    rows
}

fn pressure_bar(logger: &KindLogger) -> Channel {
    Channel {
        noise: logger.noise_bar,
        step: logger.range_bar / f64::from(1_u32 << logger.bits),
    }
}

/// Returns the name of the column with the pressure of a chamber.
fn pressure_column(logger: &KindLogger, chamber: usize) -> String {
    let reference = if logger.pressure_absolute {
        "abs"
    } else {
        "gauge"
    };
    format!("p_{}_bar_{reference}", ["ch", "second"][chamber])
}

/// Returns the rms differences between two runs of the same rows, by column of a pressure, in units of noise and
/// converter steps.
pub(super) fn differences(
    logger: &KindLogger,
    rows: &[Row],
    others: &[Row],
) -> BTreeMap<String, f64> {
    let rms = |chamber: usize| {
        let pairs = rows.iter().zip(others);
        let squares = pairs.map(|(row, other)| {
            let [a, b] = [row, other].map(|row| row.reading.chambers_pa[chamber]);
            ((a - b) / PA_PER_BAR).powi(2)
        });
        (squares.sum::<f64>() / rows.len() as f64).sqrt() / pressure_bar(logger).rms()
    };
    let chambers = logger.chambers.iter();
    chambers
        .map(|&chamber| (pressure_column(logger, chamber), rms(chamber)))
        .collect()
}

/// Returns the rows as CSV, with noise and converter steps.
pub(super) fn csv(rig: &KindRig, logger: &KindLogger, rows: &[Row], chance: &mut Chance) -> String {
    let mut text = header(rig, logger);
    let reference_pa = if logger.pressure_absolute {
        0.0
    } else {
        rig.ambient_pa
    };
    for row in rows {
        _ = write!(text, "{:.4}", row.logged_s);
        for command_pct in row.commands {
            _ = if logger.states {
                write!(text, ",{}", u8::from(command_pct > 0.0))
            } else {
                write!(text, ",{command_pct:.1}")
            };
        }
        for &chamber in &logger.chambers {
            let pressure = (row.reading.chambers_pa[chamber] - reference_pa) / PA_PER_BAR;
            let read = pressure_bar(logger).read(pressure, 1.0, chance);
            _ = write!(text, ",{read:.4}");
        }
        if logger.supply_pressure {
            let supply = (row.reading.inlet_pa - rig.ambient_pa) / PA_PER_BAR;
            _ = write!(text, ",{:.2}", SUPPLY_BAR.read(supply, 1.0, chance));
        }
        let inputs = [
            (logger.position, row.reading.position_m * 1e3, POSITION_MM),
            (logger.voltage, row.reading.volt, VOLTAGE_V),
        ];
        for (_, value, channel) in inputs.into_iter().filter(|input| input.0) {
            _ = write!(text, ",{:.3}", channel.read(value, 1.0, chance));
        }
        text.push('\n');
    }
    text
}

fn header(rig: &KindRig, logger: &KindLogger) -> String {
    let mut text = "time_s".to_owned();
    for (valve, name) in rig.valves.iter().zip(["fill", "vent"]) {
        text += &match valve.drive {
            _ if logger.states => format!(",state_{name}"),
            Drive::OnOff(_) => format!(",duty_{name}_pct"),
            Drive::Proportional(_) => format!(",cmd_{name}_pct"),
        };
    }
    for &chamber in &logger.chambers {
        text += ",";
        text += &pressure_column(logger, chamber);
    }
    if logger.supply_pressure {
        text += ",p_sup_bar_gauge";
    }
    if logger.position {
        text += ",x_actuator_mm";
    }
    if logger.voltage {
        text += ",u_bat_V";
    }
    text + "\n"
}
