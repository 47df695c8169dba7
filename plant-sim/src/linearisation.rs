//! Linearised plant (appendix A): Δẋ = A Δx + B Δu about an operating point between the end stops.
//!
//! States and inputs are those of section 3.5, in SI units: i, x, v of the fill valve, chamber pressure, i, x, v of the
//! vent valve; the two coil voltages.
//!
//! # Errors in the printed formulas
//!
//! - The coil rows: with L = L_off - x (L_off - L_on)/(x_on - x_off), ∂f1/∂x1 is -R/L. The thesis prints
//!   -R/(x (L_off - L_on)/(x_on - x_off) - L_off) = +R/L, an unstable coil; likewise ∂f5/∂x5. The entries of B
//!   have the same wrong sign (printed -1/L).
//! - ∂f1/∂x2 and ∂f5/∂x6 have the wrong sign for the same reason, and ∂f5/∂x6 is printed with u1 for u2; they vanish at
//!   an equilibrium, where u = R i. The back-EMF of equation 3.4, dropped in 3.26 and 3.30, adds ∂f1/∂x3 = -i L'/L,
//!   which does not vanish.
//! - ∂f7/∂x4 is printed as -π/m (d/2)². Equation 3.32 has +(x4 - P_atm): the chamber pressure lifts the vent
//!   valve, so the sign is plus.
//! - ∂f4/∂x4 is printed for a choked fill and a subsonic vent valve. With both valves open and orifices of one size the
//!   balance is near 0.81 P_sup: the fill flow is subsonic and the vent flow choked. This module evaluates each flow in
//!   its actual regime.
//! - ∂f4/∂x2 and ∂f4/∂x6 are zero where the bore limits the flow (equation 3.21), which is the case at full stroke.
//! - C and D are printed as ∂f/∂x; they are ∂g/∂x and ∂g/∂u.

use crate::coil::Drive;
use crate::plant::{FILL, Plant, VENT};

/// Number of states.
pub const STATES: usize = 7;
/// Row and column of the chamber pressure.
pub const PRESSURE: usize = 3;

/// Linear model about one operating point.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Matrix A: ∂f/∂x.
    pub a: [[f64; STATES]; STATES],
    /// Matrix B: ∂f/∂u for the voltages of fill and vent coil (V).
    pub b: [[f64; 2]; STATES],
    /// Output row C: ∂g/∂x of the output y = chamber pressure.
    pub c: [f64; STATES],
}

/// Linearises the plant about `state` with both coils at the voltages `voltage` (V).
pub fn linearise(plant: &Plant, voltage: [f64; 2], state: &[f64; STATES]) -> Linearisation {
    let pressure = state[PRESSURE];
    let mut a = [[0.0; STATES]; STATES];
    let mut b = [[0.0; 2]; STATES];
    for (index, first) in [(FILL, 0), (VENT, 4)] {
        let valve = &plant.valves[index];
        let [i, x, v] = [state[first], state[first + 1], state[first + 2]];
        let (current, position, velocity) = (first, first + 1, first + 2);

        let coil = &valve.coil;
        let inductance = coil.inductance(x);
        let slope = coil.inductance_slope;
        a[current][current] = -(coil.resistance + slope * v) / inductance;
        a[current][position] =
            -coil.current_rate(Drive::Energised(voltage[index]), i, x, v) * slope / inductance;
        a[current][velocity] = -slope * i / inductance;
        b[current][index] = 1.0 / inductance;

        a[position][velocity] = 1.0;

        let armature = &valve.armature;
        let force = valve.magnet.force(i, x);
        let gap = valve.magnet.gap - x;
        // d(pressure drop)/d(chamber pressure): the chamber is downstream of the fill, upstream of the vent valve.
        let drop_slope = if index == FILL { -1.0 } else { 1.0 };
        a[velocity][current] = 2.0 * valve.magnet.force_constant * i / (gap * gap) / armature.mass;
        a[velocity][position] = (2.0 * force / gap - armature.spring_rate) / armature.mass;
        a[velocity][velocity] = -armature.viscous_friction / armature.mass;
        a[velocity][PRESSURE] = drop_slope * armature.pressure_area / armature.mass;

        let lift = valve.lift(x);
        let lift_slope = valve.lift(1.0) - valve.lift(0.0);
        let area_slope = valve.orifice.effective_area_slope(lift) * lift_slope;
        let inflow = if index == FILL { 1.0 } else { -1.0 };
        let per_mass = inflow * plant.chamber.pressure_per_mass;
        a[PRESSURE][position] = per_mass * area_slope * plant.mass_flow(index, 1.0, pressure);
        a[PRESSURE][PRESSURE] +=
            per_mass * valve.effective_area(x) * flow_slope(plant, index, pressure);
    }
    let mut c = [0.0; STATES];
    c[PRESSURE] = 1.0;
    Linearisation { a, b, c }
}

/// Returns d(mass flow per effective area)/d(chamber pressure) (s/m).
fn flow_slope(plant: &Plant, index: usize, pressure: f64) -> f64 {
    let nozzle = &plant.valves[index].nozzle;
    if index == FILL {
        nozzle.mass_flow_slopes(plant.supply_pressure, pressure)[1]
    } else {
        nozzle.mass_flow_slopes(pressure, plant.drain_pressure)[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::valve::ValveFunction;
    use crate::{Command, PlantParameters, Simulator};

    fn numeric_a(plant: &Plant, voltage: f64, state: &[f64; STATES]) -> [[f64; STATES]; STATES] {
        let drives = [Drive::Energised(voltage); 2];
        let mut a = [[0.0; STATES]; STATES];
        for column in 0..STATES {
            let h = 1e-5 * [0.1, 1e-4, 0.1, 1e5, 0.1, 1e-4, 0.1][column];
            let shifted = |sign: f64| {
                let mut state = *state;
                state[column] += sign * h;
                plant.rates(drives, &state)
            };
            let (up, down) = (shifted(1.0), shifted(-1.0));
            for row in 0..STATES {
                a[row][column] = (up[row] - down[row]) / (2.0 * h);
            }
        }
        a
    }

    /// Compares every entry with central differences, in and out of equilibrium, choked and subsonic, on both sides of
    /// the kink in the area.
    #[test]
    fn matrices_are_the_derivatives_of_the_right_hand_side() {
        let mut parameters = PlantParameters::nominal();
        for function in [ValveFunction::NormallyClosed, ValveFunction::NormallyOpen] {
            parameters.functions[VENT] = function;
            let plant = parameters.plant();
            for state in [
                [0.2, 0.2e-3, 0.0, 4e5, 0.2, 0.3e-3, 0.0],
                [0.25, 0.1e-3, 0.3, 8e5, 0.1, 0.4e-3, -0.2],
                [0.29, 0.49e-3, 0.0, 1.5e5, 0.29, 0.49e-3, 0.1],
                // Reversed flow through either valve.
                [0.29, 0.3e-3, 0.0, 10e5, 0.29, 0.3e-3, 0.0],
                [0.29, 0.3e-3, 0.0, 0.9e5, 0.29, 0.3e-3, 0.0],
            ] {
                let exact = linearise(&plant, [24.0; 2], &state);
                let numeric = numeric_a(&plant, 24.0, &state);
                let entries = |a: [[f64; STATES]; STATES]| a.into_iter().flatten().enumerate();
                for ((n, ours), (_, theirs)) in entries(exact.a).zip(entries(numeric)) {
                    let scale = theirs.abs().max(1e-6);
                    let (row, column) = (n / STATES, n % STATES);
                    assert!(
                        (ours - theirs).abs() < 2e-4 * scale,
                        "A({row},{column}) {ours} {theirs} at {state:?}"
                    );
                }
            }
        }
    }

    /// Both armatures hover between their stops under a constant voltage. A small voltage step moves the simulated
    /// plant as the linear model predicts.
    #[test]
    fn small_step_response_agrees_with_the_simulator() {
        let mut parameters = PlantParameters::nominal();
        parameters.ecu.supply_voltage_v = 15.0;
        parameters.ecu.command_delay_s = 0.0;
        let mut simulator = Simulator::new(&parameters);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 100.0,
        });
        simulator.advance_to_ns(2_000_000_000);
        let state_of = |simulator: &Simulator| {
            let state = simulator.state();
            let [fill, vent] = state.valves;
            [
                fill.current,
                fill.x,
                fill.v,
                state.pressure,
                vent.current,
                vent.x,
                vent.v,
            ]
        };
        let start = state_of(&simulator);
        let stroke = parameters.armature.stroke_m;
        assert!(
            start[1] > 0.0 && start[1] < stroke && start[5] > 0.0 && start[5] < stroke,
            "{start:?}"
        );

        let model = linearise(simulator.plant(), [15.0; 2], &start);
        let step_v = 0.02;
        simulator.set_supply_voltage(15.0 + step_v);
        let mut linear = [0.0; STATES];
        let h = 1e-6;
        for millisecond in 1..=20_u64 {
            for _ in 0..1000 {
                // Midpoint rule, fine enough to be exact here.
                let rate = |x: &[f64; STATES]| -> [f64; STATES] {
                    core::array::from_fn(|row| {
                        let state: f64 = (0..STATES).map(|k| model.a[row][k] * x[k]).sum();
                        state + (model.b[row][0] + model.b[row][1]) * step_v
                    })
                };
                let half = rate(&linear);
                let middle = core::array::from_fn(|k| linear[k] + 0.5 * h * half[k]);
                let slope = rate(&middle);
                linear = core::array::from_fn(|k| linear[k] + h * slope[k]);
            }
            simulator.advance_to_ns(2_000_000_000 + millisecond * 1_000_000);
            let now = state_of(&simulator);
            for (column, scale) in [(0, 2.4e-4), (1, 2e-6), (3, 500.0), (4, 2.4e-4), (5, 2e-6)] {
                let moved = now[column] - start[column];
                assert!(
                    (moved - linear[column]).abs() < 0.02 * scale,
                    "state {column} after {millisecond} ms: {moved} {}",
                    linear[column]
                );
            }
        }
        assert!(
            linear[1].abs() > 1e-6,
            "the step moved the armature: {linear:?}"
        );
    }
}
