//! Values of a rig that a user knows, and how well.

use crate::chance::Chance;
use crate::kinds_plant::{Conductance, Drive, KindRig, Walls};

/// Certainty of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Certainty {
    Exact,
    /// In percent.
    Percent(f64),
    /// In the unit of the value.
    Within(f64),
    /// In percent, and in the unit of the value.
    PercentAndWithin(f64, f64),
}

use Certainty::{Exact, Percent, PercentAndWithin, Within};

/// Share of the certainty that a value is off at most, so that rounding does not take it out.
const OFF_MAX: f64 = 0.95;

/// Part of the keys of a characteristic.
const OPEN_SHARE: &str = "open_share";

/// Line of a plate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    pub(super) key: String,
    /// True value in the unit of the key.
    pub(super) truth: f64,
    certainty: Certainty,
    origin: &'static str,
}

fn line(key: impl Into<String>, truth: f64, certainty: Certainty, origin: &'static str) -> Line {
    Line {
        key: key.into(),
        truth,
        certainty,
        origin,
    }
}

/// Returns the lines of a rig's plate, with the characteristics of proportional valves.
pub(super) fn lines(rig: &KindRig) -> Vec<Line> {
    let gauge_bar = 1e-5 * (rig.supply_pa - rig.ambient_pa);
    let mut lines = vec![
        line(
            "supply_pressure_bar_gauge",
            gauge_bar,
            Within(0.35),
            "pointer gauge at the regulator",
        ),
        line(
            "ambient_pressure_bar_abs",
            1e-5 * rig.ambient_pa,
            Percent(1.0),
            "weather report and height",
        ),
        line(
            "temperature_c",
            rig.temperature_k - 273.15,
            Within(2.0),
            "thermometer in the room",
        ),
        line(
            "command_frequency_hz",
            1.0 / rig.command_period_s,
            Exact,
            "set in the controller",
        ),
    ];
    if rig.command_delay_s > 0.0 {
        let delay_ms = 1e3 * rig.command_delay_s;
        lines.push(line(
            "command_delay_ms",
            delay_ms,
            Percent(25.0),
            "data sheet, typical",
        ));
    }
    chambers(rig, &mut lines);
    for (valve, name) in rig.valves.iter().zip(["fill", "vent"]) {
        conductance(
            name,
            &valve.open,
            Percent(15.0),
            "data sheet, typical",
            &mut lines,
        );
        drive(name, &valve.drive, &mut lines);
    }
    lines
}

fn chambers(rig: &KindRig, lines: &mut Vec<Line>) {
    let volume_cm3 = 1e6 * rig.chamber_m3;
    lines.push(line(
        "chamber_volume_cm3",
        volume_cm3,
        Percent(15.0),
        "tape measure, fittings guessed",
    ));
    let mut hose = |growth_m3_per_pa: f64| {
        let growth = 1e11 * growth_m3_per_pa;
        let origin = "outside diameter measured with and without pressure";
        lines.push(line(
            "hose_growth_cm3_per_bar",
            growth,
            Percent(25.0),
            origin,
        ));
    };
    match rig.walls {
        Walls::Rigid => {}
        Walls::Hose { growth_m3_per_pa } => hose(growth_m3_per_pa),
        Walls::HoseAtMost {
            growth_at_most_m3,
            growth_pressure_pa,
        } => {
            hose(growth_at_most_m3 / growth_pressure_pa);
            let pressure_bar = 1e-5 * growth_pressure_pa;
            let origin = "outside diameter measured at several pressures";
            lines.push(line(
                "hose_growth_pressure_bar",
                pressure_bar,
                Percent(25.0),
                origin,
            ));
        }
    }
    if let Some(second) = &rig.second {
        let volume_cm3 = 1e6 * second.volume_m3;
        lines.push(line(
            "second_volume_cm3",
            volume_cm3,
            Percent(15.0),
            "tape measure",
        ));
        let origin = "from length and bore of the tube";
        conductance("line", &second.line, Percent(25.0), origin, lines);
    }
}

fn conductance(
    name: &str,
    open: &Conductance,
    certainty: Certainty,
    origin: &'static str,
    lines: &mut Vec<Line>,
) {
    let key = format!("{name}_C_dm3_per_s_bar");
    lines.push(line(key, open.dm3_per_s_bar, certainty, origin));
    let key = format!("{name}_b");
    lines.push(line(key, open.critical_ratio, Within(0.1), "data sheet"));
}

fn drive(name: &str, drive: &Drive, lines: &mut Vec<Line>) {
    match drive {
        Drive::OnOff(times) => {
            let guess = PercentAndWithin(25.0, 1.0);
            let guessed = "not in the data sheet, guessed from similar valves";
            let typical = "data sheet, typical";
            for (key, time_s, certainty, origin) in [
                (
                    "opening_delay",
                    times.opening_delay_s,
                    Percent(25.0),
                    typical,
                ),
                (
                    "closing_delay",
                    times.closing_delay_s,
                    Percent(25.0),
                    typical,
                ),
                ("opening_ramp", times.opening_ramp_s, guess, guessed),
                ("closing_ramp", times.closing_ramp_s, guess, guessed),
            ] {
                let key = format!("{name}_{key}_ms");
                lines.push(line(key, 1e3 * time_s, certainty, origin));
            }
        }
        Drive::Proportional(valve) => {
            let key = format!("{name}_opens_at_pct");
            lines.push(line(key, valve.opens_at_pct, Within(3.0), "data sheet"));
            let key = format!("{name}_time_constant_ms");
            lines.push(line(
                key,
                1e3 * valve.time_constant_s,
                Percent(25.0),
                "data sheet, typical",
            ));
            for (quarter, share) in [25, 50, 75].into_iter().zip(valve.quarter_shares) {
                let key = format!("{name}_{OPEN_SHARE}_{quarter}_pct");
                let origin = "curve of the data sheet";
                lines.push(line(key, 100.0 * share, Within(6.0), origin));
            }
        }
    }
}

impl Line {
    /// Returns whether it is a point of the characteristic of a proportional valve, which some data sheets omit.
    pub(super) fn is_of_curve(&self) -> bool {
        self.key.contains(OPEN_SHARE)
    }

    /// Returns a value from which the true one is off by at most the certainty, with as few digits as that admits, at least three.
    pub(super) fn stated(&self, chance: &mut Chance) -> f64 {
        let off = OFF_MAX * chance.between(-1.0, 1.0);
        let value = match self.certainty {
            Exact => self.truth,
            Percent(percent) => self.truth / (1.0 + 0.01 * percent * off),
            Within(most) => self.truth - most * off,
            PercentAndWithin(percent, most) => {
                (self.truth - most * off) / (1.0 + 0.01 * percent * off)
            }
        };
        let rounded = |decimals: usize| -> f64 {
            let text = format!("{value:.decimals$e}");
            text.parse().expect("it is a number")
        };
        let mut rounded = (2..=4).map(rounded);
        rounded.find(|value| self.admits(*value)).unwrap_or(value)
    }

    /// Returns whether the true value lies within the certainty around a stated one.
    fn admits(&self, stated: f64) -> bool {
        let within = match self.certainty {
            // A frequency is a round number.
            Exact => 1e-3 * stated,
            Percent(percent) => 0.01 * percent * stated,
            Within(most) => most,
            PercentAndWithin(percent, most) => 0.01 * percent * stated + most,
        };
        (stated - self.truth).abs() <= within
    }

    pub(super) fn comment(&self) -> String {
        let origin = self.origin;
        match self.certainty {
            Exact => format!("{origin}, exact"),
            Percent(percent) => format!("{origin}, +-{percent} %"),
            Within(most) => format!("{origin}, +-{most}"),
            PercentAndWithin(percent, most) => format!("{origin}, +-{percent} % and +-{most}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stated_value_admits_the_truth() {
        let mut chance = Chance::new(1);
        for (truth, certainty) in [
            (2.5, Exact),
            (2.5, Percent(25.0)),
            (2.5, Within(0.5)),
            (2.5, PercentAndWithin(25.0, 1.0)),
            // Defect seen: 1.0160 became 1.02, which is off by 1.33 %.
            (1.006_414_36, Percent(1.0)),
        ] {
            let line = line("fill_opening_ramp_ms", truth, certainty, "guessed");
            for _ in 0..200 {
                let stated = line.stated(&mut chance);
                assert!(line.admits(stated) && stated > 0.0, "{stated}");
                assert!(format!("{stated}").len() <= 6, "{stated}");
            }
        }
    }
}
