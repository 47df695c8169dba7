//! Exact chamber pressure over time while no armature moves.
//!
//! With constant areas the pressure follows one autonomous equation of first order, so it has a closed form or a
//! universal curve:
//!
//! - **closed or choked** through either valve or both: dp/dt = a - b p, a line or an exponential;
//! - **subsonic** through one valve: with the pressure ratio r over the valve and the effective area A,
//!   dr/dt = κ A h(r), where h is Ψ for the fill valve (r = p/P_sup) and r Ψ for the vent valve (r = P_drain/p).
//!   The solution r(κ A t) is one curve for all areas, volumes and pressures: tabulated once;
//! - **nearly equal** pressures, where the flow is linear in the pressure drop: an exponential in 1 - r (fill)
//!   or (1 - r)/r (vent).
//!
//! The solver integrates the rest: flow through both valves unless both flows are choked, and reverse flow.

use crate::orifice::{LAMINAR_RATIO, NozzleLaw};
use crate::plant::{FILL, Plant, VENT};

/// Law of the pressure over time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// dp/dt = `rise` - `decay_rate` p.
    Choked {
        initial: f64,
        rise: f64,
        decay_rate: f64,
    },
    /// On the curve of `valve` from `theta` on, `pace` dθ/dt.
    Subsonic { valve: usize, theta: f64, pace: f64 },
    /// Towards equal pressures over `valve`: z = 1 - r or (1 - r)/r decays at `decay_rate`.
    Laminar {
        valve: usize,
        z: f64,
        decay_rate: f64,
    },
}

/// Chamber pressure that is known over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestingPressure {
    kind: Kind,
    /// Time for which the formula is valid (s).
    valid_for: f64,
}

impl RestingPressure {
    /// Returns the pressure over time from `pressure` (Pa abs) on while the effective areas (m²) are constant; `None`
    /// if it has to be integrated.
    pub fn of(plant: &Plant, effective_areas: [f64; 2], pressure: f64) -> Option<Self> {
        let [fill, vent] = &plant.valves;
        let flows = |valve: usize, choked: bool| effective_areas[valve] == 0.0 || choked;
        let fill_choked = fill.nozzle.is_choked(plant.supply_pressure, pressure);
        let vent_choked = vent.nozzle.is_choked(pressure, plant.drain_pressure);
        if flows(FILL, fill_choked) && flows(VENT, vent_choked) {
            return Some(Self::choked(plant, effective_areas, pressure));
        }
        match effective_areas {
            [area, 0.0] => Self::through_one(plant, FILL, area, pressure / plant.supply_pressure),
            [0.0, area] => Self::through_one(plant, VENT, area, plant.drain_pressure / pressure),
            _ => None,
        }
    }

    fn choked(plant: &Plant, [fill_area, vent_area]: [f64; 2], pressure: f64) -> Self {
        let [fill, vent] = [FILL, VENT].map(|valve| &plant.valves[valve].nozzle);
        let factor = |nozzle: &NozzleLaw| plant.chamber.pressure_per_mass * nozzle.choked_factor();
        let rise = factor(fill) * fill_area * plant.supply_pressure;
        let decay_rate = factor(vent) * vent_area;
        let time_of = |level: f64| time_to_level(pressure, rise, decay_rate, level);
        // The fill flow stops being choked while the pressure rises, the vent flow while it falls.
        let mut valid_for = f64::INFINITY;
        if fill_area > 0.0 {
            valid_for = valid_for.min(time_of(fill.critical_ratio() * plant.supply_pressure));
        }
        if vent_area > 0.0 {
            valid_for = valid_for.min(time_of(plant.drain_pressure / vent.critical_ratio()));
        }
        Self {
            kind: Kind::Choked {
                initial: pressure,
                rise,
                decay_rate,
            },
            valid_for,
        }
    }

    /// Returns subsonic flow through one valve; `None` for reverse flow.
    fn through_one(plant: &Plant, valve: usize, area: f64, ratio: f64) -> Option<Self> {
        let pace = plant.chamber.pressure_per_mass * area;
        if ratio > 1.0 {
            None
        } else if ratio < LAMINAR_RATIO {
            let curve = plant.subsonic.of(valve);
            let theta = curve.theta_of(ratio);
            Some(Self {
                kind: Kind::Subsonic { valve, theta, pace },
                valid_for: (curve.end() - theta) / pace,
            })
        } else {
            let z = if valve == FILL {
                1.0 - ratio
            } else {
                1.0 / ratio - 1.0
            };
            Some(Self {
                kind: Kind::Laminar {
                    valve,
                    z,
                    decay_rate: pace * plant.valves[valve].nozzle.laminar_slope(),
                },
                valid_for: f64::INFINITY,
            })
        }
    }

    /// Returns the time for which the formula is valid (s).
    pub fn valid_for(&self) -> f64 {
        self.valid_for
    }

    /// Returns the pressure at `time` (s) (Pa abs).
    #[inline]
    pub fn at(&self, plant: &Plant, time: f64) -> f64 {
        let (valve, ratio) = match self.kind {
            Kind::Choked {
                initial,
                rise,
                decay_rate,
            } => {
                if decay_rate == 0.0 {
                    return initial + rise * time;
                }
                let steady = rise / decay_rate;
                return steady + (initial - steady) * (-decay_rate * time).exp();
            }
            Kind::Subsonic { valve, theta, pace } => {
                let curve = plant.subsonic.of(valve);
                (valve, curve.ratio_at(theta + pace * time))
            }
            Kind::Laminar {
                valve,
                z,
                decay_rate,
            } => {
                let z = z * (-decay_rate * time).exp();
                (
                    valve,
                    if valve == FILL {
                        1.0 - z
                    } else {
                        1.0 / (1.0 + z)
                    },
                )
            }
        };
        if valve == FILL {
            plant.supply_pressure * ratio
        } else {
            plant.drain_pressure / ratio
        }
    }
}

/// Returns the time in which the pressure goes from `pressure` to `level` by dp/dt = `rise` - `decay_rate` p; infinite
/// if it does not reach it.
fn time_to_level(pressure: f64, rise: f64, decay_rate: f64, level: f64) -> f64 {
    let (rate_now, rate_then) = (rise - decay_rate * pressure, rise - decay_rate * level);
    let ahead = (level - pressure) * rate_now;
    if ahead < 0.0 || rate_now == 0.0 || rate_now * rate_then <= 0.0 {
        f64::INFINITY
    } else if decay_rate == 0.0 {
        (level - pressure) / rise
    } else {
        (rate_now / rate_then).ln() / decay_rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlantParameters;
    use crate::solver::dormand_prince;

    /// Compares every formula with many small steps of the pressure's own equation, from choked through subsonic into
    /// the laminar zone, filling and venting, with an ideal and a real critical ratio.
    #[test]
    fn every_trace_solves_the_equation_of_the_pressure() {
        for critical_ratio in [0.528, 0.35] {
            let mut parameters = PlantParameters::nominal();
            parameters.flow.critical_ratio = critical_ratio;
            let plant = parameters.plant();
            let (supply, ambient) = (plant.supply_pressure, plant.drain_pressure);
            for (areas, start) in [
                ([2e-6, 0.0], 1.2e5),
                ([2e-6, 0.0], 0.6 * supply),
                ([0.5e-6, 0.0], 0.99 * supply),
                ([2e-6, 0.0], 0.999_95 * supply),
                ([0.0, 2e-6], 8e5),
                ([0.0, 2e-6], 1.6 * ambient),
                ([0.0, 1e-7], 1.01 * ambient),
                ([0.0, 2e-6], 1.000_05 * ambient),
                ([2e-6, 1e-6], 3.1e5),
            ] {
                let trace = RestingPressure::of(&plant, areas, start).unwrap();
                assert!(
                    (trace.at(&plant, 0.0) / start - 1.0).abs() < 1e-9,
                    "{start}"
                );
                let span = trace.valid_for().min(5e-3);
                let rate = |p: &[f64; 1]| [plant.pressure_rate(areas, p[0])];
                let mut pressure = [start];
                for _ in 0..2000 {
                    let slope = rate(&pressure);
                    pressure = dormand_prince::step(rate, &pressure, &slope, span / 2000.0)
                        .step
                        .end;
                }
                let error = trace.at(&plant, span) / pressure[0] - 1.0;
                assert!(
                    error.abs() < 2e-9,
                    "{critical_ratio} {areas:?} {start}: {error}"
                );
            }
        }
    }

    #[test]
    fn subsonic_flow_through_both_valves_and_backwards_has_no_formula() {
        let plant = PlantParameters::nominal().plant();
        assert_eq!(RestingPressure::of(&plant, [1e-6, 1e-6], 8e5), None);
        assert_eq!(
            RestingPressure::of(&plant, [1e-6, 0.0], 1.1 * plant.supply_pressure),
            None
        );
        assert_eq!(
            RestingPressure::of(&plant, [0.0, 1e-6], 0.9 * plant.drain_pressure),
            None
        );
    }
}
