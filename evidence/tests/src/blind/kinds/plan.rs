//! Plan of a rig of another kind: its values, its hidden effects and its logger.

use super::super::field::{gaps, logarithmic};
use super::draw::Wishes;
use super::effects::{Effect, actuator, hide, voltage};
use super::format::{Kind, KindLogger};
use crate::chance::Chance;
use crate::kinds_plant::{
    Characteristic, Conductance, Drive, HiddenEffects, KindRig, NOMINAL_V, SecondChamber, Swing,
    SwitchingTimes, ValvePart, Walls,
};

/// Supply pressure (Pa gauge), ambient pressure (Pa abs) and temperature (K).
const SUPPLY_PA: [f64; 2] = [5e5, 8.5e5];
const AMBIENT_PA: [f64; 2] = [0.95e5, 1.02e5];
const TEMPERATURE_K: [f64; 2] = [290.0, 301.0];
/// Share of the rigs that begin under pressure, and that pressure (Pa gauge).
const STARTS_FILLED: f64 = 0.2;
const START_PA: [f64; 2] = [0.5e5, 3e5];
/// Conductance of the fill valve (dm³/(s bar)), that of the vent valve relative to it, and their critical ratios.
const FILL_DM3_PER_S_BAR: [f64; 2] = [0.2, 1.0];
const VENT_OVER_FILL: [f64; 2] = [1.0, 1.6];
const VALVE_RATIO: [f64; 2] = [0.2, 0.5];
/// Volume of all chambers over the conductance of the fill valve (s): about the time that a filling takes.
const FILL_S: [f64; 2] = [0.4, 1.2];
/// Delays and ramps of on/off valves (s); closing over opening.
const DELAY_S: [f64; 2] = [1.5e-3, 10e-3];
const CLOSING_OVER_OPENING: [f64; 2] = [0.5, 1.1];
const RAMP_S: [f64; 2] = [2e-3, 4e-3];
/// Least period of a PWM over the longest delay of its valves.
const PERIOD_OVER_DELAY_MIN: f64 = 2.0;
/// Frequencies of the commands (Hz).
const FREQUENCIES_HZ: [f64; 3] = [25.0, 50.0, 100.0];
/// Growth of a hose per bar over its volume at ambient pressure, and pressure at which a growth comes to an end (Pa).
const GROWTH_PER_BAR: [f64; 2] = [0.05, 0.2];
const GROWTH_PRESSURE_PA: [f64; 2] = [1.5e5, 6e5];
/// Share of the hoses whose growth comes to an end.
const GROWTH_ENDS: f64 = 0.4;
/// Share of the first chamber of two in their volume; conductance of their line over that of the fill valve.
const FIRST_SHARE: [f64; 2] = [0.3, 0.7];
const LINE_OVER_FILL: [f64; 2] = [0.3, 1.2];
const LINE_RATIO: [f64; 2] = [0.1, 0.4];
/// Dead zone (%), time constant (s) and command delay (s) of proportional valves; exponent of the characteristic.
const OPENS_AT_PCT: [f64; 2] = [8.0, 25.0];
const LAG_S: [f64; 2] = [8e-3, 40e-3];
const COMMAND_DELAY_S: [f64; 2] = [2e-3, 15e-3];
const BOW: [f64; 2] = [0.8, 1.6];
/// Share of the proportional rigs with an on/off vent valve, and of the on/off rigs that log states.
const MIXED: f64 = 0.35;
const STATES: f64 = 0.5;

/// Rates of the loggers (Hz), largest clock error (ppm), bits and range (bar) of the converter, noise (bar).
const RATES_HZ: [f64; 6] = [20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];
const CLOCK_ERROR_PPM: f64 = 200.0;
const BITS: [usize; 2] = [9, 12];
const RANGES_BAR: [f64; 2] = [10.0, 12.0];
const NOISE_BAR: [f64; 2] = [1e-3, 16e-3];
/// Share of the loggers with absolute pressures, and of those with the supply pressure.
const ABSOLUTE: f64 = 0.25;
const SUPPLY_LOGGED: f64 = 0.3;
/// Share of the rigs whose log has the position of an actuator that is outside of the chamber; the same for a voltage without influence.
const IDLE_INPUT: f64 = 0.1;
/// Range of the lengths of the id log and of the check log (s).
const LENGTHS_S: [[f64; 2]; 2] = [[60.0, 90.0], [40.0, 50.0]];
/// Length from which on a log has gaps (s): a shorter one has no room for three.
const LENGTH_WITH_GAPS_S_MIN: f64 = 20.0;

/// Rig to run.
#[derive(Debug, Clone)]
pub(super) struct KindPlan {
    pub(super) kind: Kind,
    pub(super) rig: KindRig,
    pub(super) effects: Vec<Effect>,
    pub(super) logger: KindLogger,
}

impl KindPlan {
    /// Draws the rig with this number, from 1.
    pub(super) fn draw(number: usize, wishes: &Wishes, chance: &mut Chance) -> Self {
        let kind = Kind::ALL[(number - 1) % Kind::ALL.len()];
        let mut rig = rig(kind, chance);
        let mut logger = logger(kind, &rig, wishes, chance);
        let effects = hide(&mut rig, wishes.effects, chance);
        // A gauge at the inlet of the fill valve would show the droop.
        logger.supply_pressure &= !effects.contains(&Effect::SupplyLine);
        // A log may have inputs that change nothing.
        if rig.actuator == Swing::constant(0.0) && chance.happens(IDLE_INPUT) {
            rig.actuator = actuator(chance);
        }
        let is_driven = rig.hidden.pull_in.is_some();
        if !is_driven && chance.happens(IDLE_INPUT) {
            rig.voltage = voltage(chance);
        }
        logger.position = rig.actuator != Swing::constant(0.0);
        logger.voltage = rig.voltage != Swing::constant(NOMINAL_V);
        Self {
            kind,
            rig,
            effects,
            logger,
        }
    }
}

fn between([low, high]: [f64; 2], chance: &mut Chance) -> f64 {
    chance.between(low, high)
}

fn rig(kind: Kind, chance: &mut Chance) -> KindRig {
    let ambient_pa = between(AMBIENT_PA, chance);
    let gauge_pa = if chance.happens(STARTS_FILLED) {
        between(START_PA, chance)
    } else {
        0.0
    };
    let valves = valves(kind, chance);
    let fill = valves[0].open.dm3_per_s_bar;
    let volume_m3 = 1e-3 * fill * between(FILL_S, chance);
    let mut rig = KindRig {
        supply_pa: ambient_pa + between(SUPPLY_PA, chance),
        ambient_pa,
        temperature_k: between(TEMPERATURE_K, chance),
        start_pa: ambient_pa + gauge_pa,
        command_period_s: 1.0 / frequency_hz(&valves, chance),
        command_delay_s: 0.0,
        chamber_m3: volume_m3,
        walls: Walls::Rigid,
        second: None,
        valves,
        actuator: Swing::constant(0.0),
        voltage: Swing::constant(NOMINAL_V),
        hidden: HiddenEffects::default(),
    };
    match kind {
        Kind::OnOff => {}
        Kind::Hose => rig.walls = hose(volume_m3, chance),
        Kind::SecondChamber => {
            rig.chamber_m3 *= between(FIRST_SHARE, chance);
            rig.second = Some(SecondChamber {
                volume_m3: volume_m3 - rig.chamber_m3,
                line: Conductance {
                    dm3_per_s_bar: fill * between(LINE_OVER_FILL, chance),
                    critical_ratio: between(LINE_RATIO, chance),
                },
            });
        }
        Kind::Proportional => rig.command_delay_s = between(COMMAND_DELAY_S, chance),
    }
    rig
}

fn valves(kind: Kind, chance: &mut Chance) -> [ValvePart; 2] {
    let is_mixed = chance.happens(MIXED);
    let fill = logarithmic(FILL_DM3_PER_S_BAR, chance);
    [1.0, between(VENT_OVER_FILL, chance)].map(|over_fill| ValvePart {
        open: Conductance {
            dm3_per_s_bar: fill * over_fill,
            critical_ratio: between(VALVE_RATIO, chance),
        },
        drive: if kind == Kind::Proportional && !(is_mixed && over_fill > 1.0) {
            proportional(chance)
        } else {
            on_off(chance)
        },
    })
}

fn on_off(chance: &mut Chance) -> Drive {
    let opening_delay_s = logarithmic(DELAY_S, chance);
    Drive::OnOff(SwitchingTimes {
        opening_delay_s,
        closing_delay_s: opening_delay_s * between(CLOSING_OVER_OPENING, chance),
        opening_ramp_s: between(RAMP_S, chance),
        closing_ramp_s: between(RAMP_S, chance),
    })
}

fn proportional(chance: &mut Chance) -> Drive {
    let exponent = between(BOW, chance);
    Drive::Proportional(Characteristic {
        opens_at_pct: between(OPENS_AT_PCT, chance),
        quarter_shares: [0.25_f64, 0.5, 0.75].map(|way| way.powf(exponent)),
        time_constant_s: between(LAG_S, chance),
    })
}

/// Draws a frequency of the commands whose period is long enough for the delays of on/off valves.
fn frequency_hz(valves: &[ValvePart; 2], chance: &mut Chance) -> f64 {
    let delays = valves.iter().map(|valve| match valve.drive {
        Drive::OnOff(times) => times.opening_delay_s.max(times.closing_delay_s),
        Drive::Proportional(_) => 0.0,
    });
    let longest_s = delays.fold(0.0, f64::max);
    let slow_enough = |hz: &&f64| 1.0 / **hz >= PERIOD_OVER_DELAY_MIN * longest_s;
    let count = FREQUENCIES_HZ.iter().filter(slow_enough).count();
    chance.one_of(&FREQUENCIES_HZ[..count])
}

fn hose(volume_m3: f64, chance: &mut Chance) -> Walls {
    let growth_m3_per_pa = 1e-5 * volume_m3 * between(GROWTH_PER_BAR, chance);
    if chance.happens(GROWTH_ENDS) {
        let growth_pressure_pa = between(GROWTH_PRESSURE_PA, chance);
        Walls::HoseAtMost {
            growth_at_most_m3: growth_m3_per_pa * growth_pressure_pa,
            growth_pressure_pa,
        }
    } else {
        Walls::Hose { growth_m3_per_pa }
    }
}

fn logger(kind: Kind, rig: &KindRig, wishes: &Wishes, chance: &mut Chance) -> KindLogger {
    let drawn_s = LENGTHS_S.map(|range| between(range, chance));
    let lengths_s = wishes.lengths_s.unwrap_or(drawn_s);
    let drawn_hz = chance.one_of(&RATES_HZ);
    let chambers = match kind {
        Kind::SecondChamber => chance.one_of(&[&[1][..], &[1], &[0], &[0, 1]]),
        _ => &[0],
    };
    KindLogger {
        rate_hz: wishes.rate_hz.unwrap_or(drawn_hz),
        offset_of_first_row_s: [0; 2].map(|_| chance.between(0.0, rig.command_period_s)),
        clock_error_ppm: chance.between(-CLOCK_ERROR_PPM, CLOCK_ERROR_PPM),
        gaps_s: lengths_s.map(|length_s| {
            if length_s < LENGTH_WITH_GAPS_S_MIN {
                Vec::new()
            } else {
                gaps(length_s, chance)
            }
        }),
        lengths_s,
        bits: chance.whole(BITS[0], BITS[1]),
        range_bar: chance.one_of(&RANGES_BAR),
        noise_bar: logarithmic(NOISE_BAR, chance),
        pressure_absolute: chance.happens(ABSOLUTE),
        supply_pressure: chance.happens(SUPPLY_LOGGED),
        states: chance.happens(STATES) && kind == Kind::OnOff,
        position: false,
        voltage: false,
        chambers: chambers.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_effect_and_logger_is_drawn_within_its_range() {
        let plans: Vec<KindPlan> = (1..=400)
            .map(|number| {
                let mut chance = Chance::of(3, number as u64);
                KindPlan::draw(number, &Wishes::default(), &mut chance)
            })
            .collect();
        let share = |is: &dyn Fn(&KindPlan) -> bool| {
            plans.iter().filter(|plan| is(plan)).count() as f64 / plans.len() as f64
        };
        for kind in Kind::ALL {
            assert_eq!(share(&|plan| plan.kind == kind), 0.25);
        }
        for (count, expected) in [(0, 0.25), (1, 0.5), (2, 0.25)] {
            let found = share(&|plan| plan.effects.len() == count);
            assert!((found - expected).abs() < 0.08, "{count}: {found}");
        }
        let mixed = share(&|plan| {
            plan.kind == Kind::Proportional && matches!(plan.rig.valves[1].drive, Drive::OnOff(_))
        });
        assert!((mixed - MIXED / 4.0).abs() < 0.04, "{mixed}");
        for KindPlan {
            rig,
            logger,
            effects,
            ..
        } in &plans
        {
            assert!((9..=12).contains(&logger.bits) && logger.clock_error_ppm.abs() <= 200.0);
            assert!((1e-3..16e-3).contains(&logger.noise_bar));
            assert!(logger.gaps_s.iter().all(|gaps| gaps.len() <= 3));
            assert!((60.0..90.0).contains(&logger.lengths_s[0]));
            assert!(!(logger.supply_pressure && effects.contains(&Effect::SupplyLine)));
            let has = |effect: Effect| effects.contains(&effect);
            assert!(logger.position || !has(Effect::Actuator));
            assert!(rig.supply_pa > rig.start_pa && rig.chamber_m3 > 20e-6);
        }
    }
}
