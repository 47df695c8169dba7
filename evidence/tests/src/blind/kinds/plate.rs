//! Text of a plate: what a user knows of a rig from data sheets and a tape measure.

use std::fmt::Write;

use super::format::{Kind, KindLogger};
use super::known::Line;
use super::plan::KindPlan;
use crate::chance::Chance;

/// Share of the plates with the characteristics of proportional valves.
const WITH_CURVES: f64 = 0.5;

/// Returns the text of a plate whose values are as far from the truth as their certainty admits.
pub(super) fn plate(plan: &KindPlan, lines: &[Line], chance: &mut Chance) -> String {
    let mut text = head(plan.kind, &plan.logger);
    let has_curves = chance.happens(WITH_CURVES);
    for line in lines {
        if line.is_of_curve() && !has_curves {
            continue;
        }
        let value = line.stated(chance);
        put(&mut text, &line.key, value, &line.comment());
    }
    let KindLogger {
        rate_hz,
        bits,
        range_bar,
        ..
    } = plan.logger;
    let resolution = format!("nominal; {bits} bits over this range");
    let clock = "its clock is its own; a command is the one that stands at the instant of the row";
    put(&mut text, "sensor_range_bar", range_bar, &resolution);
    put(&mut text, "logger_rate_hz", rate_hz, clock);
    text
}

/// Adds a line to a plate.
fn put(text: &mut String, key: &str, value: f64, comment: &str) {
    let start = format!("{key} = {value}");
    _ = writeln!(text, "{start:42} # {comment}");
}

/// Returns the text of a plate with the true values, without a certainty.
pub(super) fn true_plate(lines: &[Line]) -> String {
    let line = |line: &Line| format!("{} = {}\n", line.key, line.truth);
    lines.iter().map(line).collect()
}

fn head(kind: Kind, logger: &KindLogger) -> String {
    let rig = match kind {
        Kind::OnOff => "two on/off valves, one fills and one vents a rigid chamber",
        Kind::Hose => "two on/off valves, one fills and one vents a hose that grows with pressure",
        Kind::SecondChamber => {
            "two on/off valves at a first chamber; a line leads to a second chamber"
        }
        Kind::Proportional => "a proportional valve fills a rigid chamber, a second valve vents it",
    };
    let drive = if logger.states {
        "each valve is switched by a state 0 or 1 that may change at this frequency"
    } else if kind == Kind::Proportional {
        "a command in percent that may change at this frequency"
    } else {
        "pulse width modulation; the duty may change at the start of each period"
    };
    let mut text = format!(
        "# What is known of this rig from data sheets and a tape measure. Each line says how certain it is.\n\
         rig = \"{rig}\"\ndrive = \"{drive}\"\n"
    );
    if kind == Kind::SecondChamber {
        let place = match logger.chambers[..] {
            [0] => "in the first chamber",
            [1] => "in the second chamber",
            _ => "one in each chamber",
        };
        _ = writeln!(text, "pressure_sensor = \"{place}\"");
    }
    text
}
