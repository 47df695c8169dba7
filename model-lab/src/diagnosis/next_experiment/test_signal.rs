//! Excitations that a rig can run, as duty cycles within limits.

use plant_sim::plant::{FILL, VENT};
use plant_sim::{Command, PlantParameters, Simulator};
use recording::{Provenance, Recording, TimeBase, Unit};

use super::driver::{Driver, end_ns};
use super::result::Limits;
use crate::diagnosis::error::DiagnoseError;

/// Time before a violation of the limits at which a run ends (s), and time for which it is then emptied.
const EARLIER_S: f64 = 0.1;
const EMPTYING_S: f64 = 1.0;
/// Shortest run (s) that provides information.
const SHORTEST_S: f64 = 2.0;

/// Duty cycles (%) of fill and vent valve, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sequence {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) duties: Vec<[f64; 2]>,
    /// Time from row to row (s).
    pub(super) interval_s: f64,
    /// Highest chamber pressure in any rival's model (bar gauge).
    pub(super) highest_bar: f64,
}

impl Sequence {
    pub(super) fn recording(&self) -> Recording {
        let mut log = Recording::new(Provenance::from_source(self.name));
        let base = TimeBase::uniform(0.0, self.interval_s, self.duties.len());
        let base = log.add_time_base(base.expect("a sequence has rows"));
        for (valve, name) in crate::commands::DUTIES.into_iter().enumerate() {
            let duty = self.duties.iter().map(|duties| duties[valve]).collect();
            log.add_signal(name, Unit::Percent, base, duty)
                .expect("two names");
        }
        log
    }
}

/// Excitation: its name, the effects that it shows, and one round of it.
struct Plan {
    name: &'static str,
    about: &'static str,
    round: fn(&mut Driver, usize),
}

static PLANS: [Plan; 9] = [
    Plan {
        name: "hold at two pressures",
        about: "leaks and offsets: what moves while both valves are shut, high and low",
        round: |driver, _| {
            driver.fill_to(100.0, HIGH);
            driver.hold(4.0);
            driver.vent_to(100.0, LOW);
            driver.hold(4.0);
            driver.vent_to(100.0, 0.0);
            driver.hold(1.0);
        },
    },
    Plan {
        name: "pulse-width staircase",
        about: "delays, saturation and friction: single pulses from too short to long",
        round: |driver, _| {
            for step in 0..16 {
                let duty = 20.0 + 5.0 * f64::from(step);
                driver.pulse(FILL, duty, 2);
                driver.hold(0.2);
                driver.vent_above(HIGH, 0.3);
            }
            driver.fill_to(100.0, HIGH);
            for step in 0..16 {
                driver.pulse(VENT, 20.0 + 5.0 * f64::from(step), 2);
                driver.hold(0.2);
            }
            driver.vent_to(100.0, 0.0);
        },
    },
    Plan {
        name: "one long fill, many short ones",
        about: "supply line and series restriction: the same pressure at once and in pulses",
        round: |driver, _| {
            driver.fill_to(100.0, HIGH);
            driver.hold(0.7);
            driver.vent_to(100.0, 0.0);
            driver.hold(0.3);
            for _ in 0..40 {
                if driver.is_above(HIGH) {
                    break;
                }
                driver.pulse(FILL, 80.0, 2);
                driver.hold(0.15);
            }
            driver.hold(0.7);
            driver.vent_to(100.0, 0.0);
        },
    },
    Plan {
        name: "vent to atmosphere",
        about: "drain back pressure and the law of flow below the critical ratio",
        round: |driver, _| {
            driver.fill_to(100.0, HIGH);
            driver.hold(0.3);
            driver.vent(100.0, 1.2);
            driver.hold(0.3);
            driver.fill_to(60.0, LOW);
            driver.vent(60.0, 1.0);
            driver.hold(0.3);
        },
    },
    Plan {
        name: "the same pulses cold and hot",
        about: "coil temperature and supply voltage: pulses, a long constant duty of the vent valve, the same pulses",
        round: |driver, round| {
            for duty in [40.0, 55.0, 70.0, 85.0] {
                driver.fill(duty, 0.1);
                driver.hold(0.2);
                driver.vent(duty, 0.1);
                driver.hold(0.2);
                driver.vent_above(HIGH, 0.3);
            }
            let share = if round == 0 { 0.5 } else { 0.1 };
            driver.energise_vent(share * driver.duration_s());
            driver.hold(0.2);
        },
    },
    Plan {
        name: "slow and fast fill",
        about: "heat of the gas: the faster it is compressed, the more the pressure falls afterwards",
        round: |driver, _| {
            for duty in [100.0, 50.0] {
                driver.fill_to(duty, HIGH);
                driver.hold(1.5);
                driver.vent_to(duty, LOW);
                driver.hold(1.0);
            }
            driver.vent_to(100.0, 0.0);
        },
    },
    Plan {
        name: "near the supply pressure",
        about: "supply pressure and the law of flow below the critical ratio: long fills to the end",
        round: |driver, _| {
            driver.fill(100.0, 1.5);
            driver.hold(0.3);
            driver.pulse(VENT, 100.0, 5);
            driver.hold(0.2);
            driver.fill(60.0, 0.5);
            driver.hold(0.3);
            driver.vent_to(100.0, 0.0);
        },
    },
    Plan {
        name: "the same pulse at every pressure",
        about: "what depends on the pressure difference: flow forces, seats, the chamber's law",
        round: |driver, _| {
            for valve in [FILL, VENT] {
                for _ in 0..60 {
                    if if valve == FILL {
                        driver.is_above(HIGH)
                    } else {
                        !driver.is_above(0.05)
                    } {
                        break;
                    }
                    driver.pulse(valve, 60.0, 3);
                    driver.hold(0.25);
                }
            }
        },
    },
    Plan {
        name: "quick alternation",
        about: "lags and dead volumes: filling and venting in turn, faster and faster",
        round: |driver, _| {
            driver.fill_to(100.0, MIDDLE);
            for periods in [12, 8, 6, 4, 3, 2] {
                for _ in 0..4 {
                    driver.pulse(FILL, 70.0, periods);
                    driver.pulse(VENT, 70.0, periods);
                }
                driver.hold(0.1);
                driver.vent_above(HIGH, 0.2);
            }
            driver.vent_to(100.0, 0.0);
            driver.hold(0.2);
        },
    },
];

/// Target pressures, over the highest allowed.
const HIGH: f64 = 0.85;
const MIDDLE: f64 = 0.5;
const LOW: f64 = 0.3;

/// Returns all excitations that satisfy `limits` with every plant.
///
/// # Errors
/// [`DiagnoseError::NoTestSignal`]: no excitation does.
pub(super) fn sequences(
    plants: &[&PlantParameters],
    limits: &Limits,
) -> Result<Vec<Sequence>, DiagnoseError> {
    let plans = PLANS.iter();
    let sequences: Vec<_> = plans
        .filter_map(|plan| within(plan, plants, limits))
        .collect();
    if sequences.is_empty() {
        return Err(DiagnoseError::NoTestSignal {
            duration_s: limits.duration_s,
            max_bar: limits.max_bar,
            max_duty_pct: limits.max_duty_pct,
        });
    }
    Ok(sequences)
}

fn within(plan: &Plan, plants: &[&PlantParameters], limits: &Limits) -> Option<Sequence> {
    let mut driver = Driver::new(plants[0], limits);
    let mut round = 0;
    while !driver.is_over() {
        let before = driver.duties.len();
        (plan.round)(&mut driver, round);
        if driver.duties.len() == before {
            return None;
        }
        round += 1;
    }
    let interval_s = driver.interval_s;
    let emptying = driver.wide_open(VENT);
    let shut = driver.shut();
    let mut duties = driver.duties;
    // Each cut leaves a shorter run; with the emptying at its end it may satisfy the limits.
    let rows = |span_s: f64| (span_s / interval_s).round() as usize;
    for _ in 0..3 {
        let does_something = duties.iter().any(|duties| *duties != shut);
        if duties.len() < rows(SHORTEST_S) || !does_something {
            return None;
        }
        let traces: Vec<Vec<f64>> = plants
            .iter()
            .map(|plant| pressures_bar(plant, &duties, interval_s))
            .collect();
        let highest_bar = traces.iter().flatten().copied().fold(0.0, f64::max);
        if highest_bar <= limits.max_bar {
            let (name, about) = (plan.name, plan.about);
            return Some(Sequence {
                name,
                about,
                duties,
                interval_s,
                highest_bar,
            });
        }
        let leaves = |trace: &Vec<f64>| trace.iter().position(|bar| *bar > limits.max_bar);
        let row = traces.iter().filter_map(leaves).min()?;
        duties.truncate(row.saturating_sub(rows(EARLIER_S)));
        duties.extend(core::iter::repeat_n(emptying, rows(EMPTYING_S)));
        duties.truncate(rows(limits.duration_s));
    }
    None
}

fn pressures_bar(plant: &PlantParameters, duties: &[[f64; 2]], interval_s: f64) -> Vec<f64> {
    let mut simulator = Simulator::new(plant);
    let duties = duties.iter().enumerate();
    duties
        .map(|(row, &[duty_fill_pct, duty_vent_pct])| {
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct,
            });
            simulator.advance_to_ns(end_ns(row, interval_s));
            (simulator.state().pressure - plant.gas.ambient_pressure_pa) * 1e-5
        })
        .collect()
}
