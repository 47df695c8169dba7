//! Hidden effects of a rig: draw, names and keys of the library, removal.

use std::collections::BTreeMap;

use super::super::field::logarithmic;
use crate::chance::Chance;
use crate::kinds_plant::{Conductance, Drive, KindRig, NOMINAL_V, PullIn, SupplyLine, Swing};

/// Shares of the rigs with no hidden effect and with one; the others have two.
const NONE: f64 = 0.25;
const ONE: f64 = 0.5;
/// Time constant with which a leak empties the chambers (s), and its critical ratio.
const LEAK_S: [f64; 2] = [30.0, 300.0];
const LEAK_RATIO: [f64; 2] = [0.3, 0.528];
/// Time constant with which the gas takes the temperature of the wall at ambient pressure (s).
const HEAT_S: [f64; 2] = [0.1, 1.0];
/// Spread of the heat transfer of the second chamber around that by the area of its wall.
const SECOND_HEAT: [f64; 2] = [0.85, 1.15];
/// Heat capacity at constant volume (J/K) of a cubic metre of air at ambient pressure.
const AIR_J_PER_K_M3: f64 = 1.19 * 718.0;
/// Conductance of the supply line over that of the fill valve, its critical ratio, and its volume (m³).
const LINE_OVER_VALVE: [f64; 2] = [0.5, 1.5];
const LINE_RATIO: [f64; 2] = [0.2, 0.45];
const LINE_M3: [f64; 2] = [50e-6, 300e-6];
/// Share of the final current at which a valve moves, and share of the pressure in the force.
const PULL_IN: [f64; 2] = [0.4, 0.8];
const PRESSURE_FORCE: [f64; 2] = [0.2, 0.7];
/// Share of these rigs whose supply voltage swings, and two voltages (V) between which the exponent of the delay is that of the answer.
const VOLTAGE_SWINGS: f64 = 0.5;
const VOLTAGES_V: [f64; 2] = [21.0, 27.0];
/// Largest volume that an actuator sweeps, over that of the first chamber, and its travel (m).
const SWEPT: [f64; 2] = [0.03, 0.25];
const TRAVEL_M: [f64; 2] = [10e-3, 80e-3];
/// Periods of the swings (s) of an actuator and of a voltage.
const ACTUATOR_S: [[f64; 2]; 2] = [[3.0, 9.0], [0.8, 2.5]];
const VOLTAGE_S: [[f64; 2]; 2] = [[15.0, 40.0], [3.0, 9.0]];
/// Offset and drift of a sensor (Pa), its warm-up (s), and its lag (s).
const OFFSET_PA: [f64; 2] = [3e3, 15e3];
const DRIFT_PA: [f64; 2] = [5e3, 20e3];
const WARM_UP_S: [f64; 2] = [10.0, 40.0];
const LAG_S: [f64; 2] = [8e-3, 60e-3];

/// Effect that a rig may hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effect {
    Leak,
    Heat,
    SupplyLine,
    SensorOffset,
    SensorDrift,
    SensorLag,
    PullIn,
    Actuator,
}

impl Effect {
    /// Effects to draw from; every id of the library is as likely.
    const DRAWN: [Self; 14] = [
        Self::Leak,
        Self::Leak,
        Self::Heat,
        Self::Heat,
        Self::SupplyLine,
        Self::SupplyLine,
        Self::SensorLag,
        Self::SensorLag,
        Self::SensorOffset,
        Self::SensorDrift,
        Self::PullIn,
        Self::PullIn,
        Self::Actuator,
        Self::Actuator,
    ];

    /// Returns the id in the library.
    pub(super) fn id(self) -> &'static str {
        match self {
            Self::Leak => "chamber_leak",
            Self::Heat => "gas_temperature",
            Self::SupplyLine => "supply_line_droop",
            Self::SensorOffset | Self::SensorDrift => "sensor_offset",
            Self::SensorLag => "sensor_lag",
            Self::PullIn => "switching_delay",
            Self::Actuator => "actuator_volume",
        }
    }

    /// Returns whether a rig has the part on which the effect acts.
    fn acts_on(self, rig: &KindRig) -> bool {
        let is_on_off = matches!(rig.valves[0].drive, Drive::OnOff(_));
        self != Self::PullIn || is_on_off
    }

    /// Draws this effect of a rig.
    fn draw(self, rig: &mut KindRig, chance: &mut Chance) {
        let volume_m3 = rig.volume_m3();
        let chamber_m3 = rig.chamber_m3;
        let hidden = &mut rig.hidden;
        let between = |[low, high]: [f64; 2], chance: &mut Chance| chance.between(low, high);
        let signed = |range, chance: &mut Chance| {
            let sign = if chance.happens(0.5) { 1.0 } else { -1.0 };
            sign * between(range, chance)
        };
        match self {
            Self::Leak => {
                // Choked, 1 dm³/(s bar) empties 1 dm³ with a time constant of 1 s.
                hidden.leak = Some(Conductance {
                    dm3_per_s_bar: 1e3 * volume_m3 / logarithmic(LEAK_S, chance),
                    critical_ratio: between(LEAK_RATIO, chance),
                });
            }
            Self::Heat => {
                let first = AIR_J_PER_K_M3 * chamber_m3 / logarithmic(HEAT_S, chance);
                let second_m3 = volume_m3 - chamber_m3;
                let by_area = (second_m3 / chamber_m3).powf(2.0 / 3.0);
                hidden.heat_w_per_k = Some([first, first * by_area * between(SECOND_HEAT, chance)]);
            }
            Self::SupplyLine => {
                let valve = rig.valves[0].open.dm3_per_s_bar;
                hidden.supply_line = Some(SupplyLine {
                    restriction: Conductance {
                        dm3_per_s_bar: valve * between(LINE_OVER_VALVE, chance),
                        critical_ratio: between(LINE_RATIO, chance),
                    },
                    volume_m3: logarithmic(LINE_M3, chance),
                });
            }
            Self::SensorOffset => hidden.sensor.offset_pa = signed(OFFSET_PA, chance),
            Self::SensorDrift => {
                hidden.sensor.drift_pa = signed(DRIFT_PA, chance);
                hidden.sensor.warm_up_s = between(WARM_UP_S, chance);
            }
            Self::SensorLag => hidden.sensor.lag_s = logarithmic(LAG_S, chance),
            Self::PullIn => {
                hidden.pull_in = Some(PullIn {
                    current: between(PULL_IN, chance),
                    pressure_force: between(PRESSURE_FORCE, chance),
                });
                if chance.happens(VOLTAGE_SWINGS) {
                    rig.voltage = voltage(chance);
                }
            }
            Self::Actuator => {
                rig.actuator = actuator(chance);
                let most_m3 = chamber_m3 * between(SWEPT, chance);
                hidden.actuator_area_m2 = most_m3 / (2.0 * rig.actuator.mean);
                if chance.happens(0.5) {
                    // The chamber shrinks from its volume at position 0.
                    hidden.actuator_area_m2 *= -1.0;
                }
            }
        }
    }

    /// Returns the rig without this effect.
    pub(super) fn removed(self, rig: &KindRig) -> KindRig {
        let mut rig = rig.clone();
        let hidden = &mut rig.hidden;
        match self {
            Self::Leak => hidden.leak = None,
            Self::Heat => hidden.heat_w_per_k = None,
            Self::SupplyLine => hidden.supply_line = None,
            Self::SensorOffset => hidden.sensor.offset_pa = 0.0,
            Self::SensorDrift => hidden.sensor.drift_pa = 0.0,
            Self::SensorLag => hidden.sensor.lag_s = 0.0,
            Self::PullIn => hidden.pull_in = None,
            Self::Actuator => hidden.actuator_area_m2 = 0.0,
        }
        rig
    }

    /// Returns the true values of this effect of a rig, by the keys of the library.
    pub(super) fn values(self, rig: &KindRig) -> BTreeMap<String, f64> {
        let hidden = &rig.hidden;
        let sensor = &hidden.sensor;
        let values: Vec<(&str, f64)> = match self {
            Self::Leak => {
                let leak = hidden.leak.as_ref();
                let area = leak.map_or(0.0, Conductance::nozzle_area_m2);
                vec![("area_m2", area)]
            }
            Self::Heat => {
                let [first, _] = hidden.heat_w_per_k.unwrap_or_default();
                vec![("wall_heat_transfer_w_per_k", first)]
            }
            Self::SupplyLine => hidden.supply_line.map_or_else(Vec::new, |line| {
                vec![
                    ("restriction_area_m2", line.restriction.nozzle_area_m2()),
                    ("line_volume_m3", line.volume_m3),
                ]
            }),
            Self::SensorOffset => vec![("offset_bar", 1e-5 * sensor.offset_pa)],
            Self::SensorDrift => vec![
                ("drift_bar", 1e-5 * sensor.drift_pa),
                ("warm_up_s", sensor.warm_up_s),
            ],
            Self::SensorLag => vec![("time_constant_s", sensor.lag_s)],
            Self::PullIn => {
                let delay = |difference: f64, volt: f64| {
                    let pull_in = hidden.pull_in.as_ref();
                    pull_in.map_or(1.0, |pull_in| pull_in.delay(difference, volt))
                };
                let mut values = vec![("pressure_share", 1.0 - delay(0.0, NOMINAL_V))];
                if rig.voltage != Swing::constant(NOMINAL_V) {
                    let [low, high] = VOLTAGES_V.map(|volt| delay(1.0, volt).ln());
                    let apart = (VOLTAGES_V[1] / VOLTAGES_V[0]).ln();
                    values.push(("voltage_exponent", (low - high) / apart));
                }
                values
            }
            Self::Actuator => vec![("area_m2", hidden.actuator_area_m2)],
        };
        let named = values.into_iter();
        named.map(|(key, value)| (key.to_owned(), value)).collect()
    }
}

/// Draws the motion of an actuator between position 0 and its travel.
pub(super) fn actuator(chance: &mut Chance) -> Swing {
    let middle = 0.5 * chance.between(TRAVEL_M[0], TRAVEL_M[1]);
    Swing {
        mean: middle,
        amplitudes: [0.7 * middle, 0.3 * middle],
        periods_s: ACTUATOR_S.map(|[low, high]| chance.between(low, high)),
    }
}

/// Draws a supply voltage that swings between 20 and 28 V.
pub(super) fn voltage(chance: &mut Chance) -> Swing {
    Swing {
        mean: NOMINAL_V,
        amplitudes: [2.5, 1.5],
        periods_s: VOLTAGE_S.map(|[low, high]| chance.between(low, high)),
    }
}

/// Draws the hidden effects of a rig, `count` of them or a random number, no two with the same id.
pub(super) fn hide(rig: &mut KindRig, count: Option<usize>, chance: &mut Chance) -> Vec<Effect> {
    let share = chance.share();
    let drawn = usize::from(share >= NONE) + usize::from(share >= NONE + ONE);
    let possible = Effect::DRAWN.into_iter();
    let possible: Vec<Effect> = possible.filter(|effect| effect.acts_on(rig)).collect();
    let mut effects: Vec<Effect> = Vec::new();
    while effects.len() < count.unwrap_or(drawn) {
        let effect = chance.one_of(&possible);
        if effects.iter().all(|other| other.id() != effect.id()) {
            effect.draw(rig, chance);
            effects.push(effect);
        }
    }
    effects
}
