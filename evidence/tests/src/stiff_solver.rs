//! The same equations with a general stiff solver: BDF of variable order with root finding, all seven states integrated
//! together, restarted at PWM edges and at every contact.
//!
//! Only the right-hand side is shared with the simulator; steps, error control, event location and the order of events
//! are the other solver's.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use diffsol::{
    DiffsolError, NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason,
};
use plant_sim::coil::Drive;
use plant_sim::ecu_output::EcuOutput;
use plant_sim::linearisation::{STATES, linearise};
use plant_sim::plant::{FILL, Plant, VENT};
use plant_sim::replay::ReplayInput;
use plant_sim::valve::Motion;
use plant_sim::{Command, PlantParameters};

type State = [f64; STATES];

/// Index of current, position and velocity of a valve in the state.
const FIRST: [usize; 2] = [0, 4];
/// Roots per valve: rest stop or release, full stroke, current decayed to zero.
const ROOTS: usize = 3;
/// First step after a restart (s).
const FIRST_STEP: f64 = 1e-5;
/// Distance of a stop outside the stroke (m), so that an armature at a stop is not on a root.
const STOP_MARGIN: f64 = 1e-12;

/// Discrete state of the equations.
#[derive(Clone, Copy, PartialEq)]
struct Mode {
    drives: [Drive; 2],
    motions: [Motion; 2],
}

/// Trajectory sampled at the instants of the inputs.
pub struct Trajectory {
    /// Chamber pressure (Pa abs) at each input.
    pub pressure: Vec<f64>,
    /// Accepted steps.
    pub steps: usize,
}

fn state_of(y: &[f64]) -> State {
    core::array::from_fn(|n| y[n])
}

fn rates(plant: &Plant, mode: Mode, state: &State) -> State {
    let mut rates = plant.rates(mode.drives, state);
    for index in [FILL, VENT] {
        if mode.motions[index] != Motion::Moving {
            rates[FIRST[index] + 1] = 0.0;
            rates[FIRST[index] + 2] = 0.0;
        }
    }
    rates
}

fn jacobian(plant: &Plant, mode: Mode, state: &State) -> [State; STATES] {
    let voltage = mode.drives.map(|drive| drive.voltage().unwrap_or(0.0));
    let mut a = linearise(plant, voltage, state).a;
    for index in [FILL, VENT] {
        let first = FIRST[index];
        if mode.drives[index] == Drive::Blocked {
            a[first] = [0.0; STATES];
        }
        if mode.motions[index] != Motion::Moving {
            a[first + 1] = [0.0; STATES];
            a[first + 2] = [0.0; STATES];
        }
    }
    a
}

fn roots(plant: &Plant, mode: Mode, state: &State, roots: &mut [f64]) {
    for index in [FILL, VENT] {
        let valve = &plant.valves[index];
        let [i, x] = [state[FIRST[index]], state[FIRST[index] + 1]];
        let drop = plant.pressure_drop(index, state[3]);
        let roots = &mut roots[ROOTS * index..];
        if mode.motions[index] == Motion::Moving {
            roots[0] = x + STOP_MARGIN;
            roots[1] = valve.armature.stroke + STOP_MARGIN - x;
        } else {
            roots[0] = -valve.breakaway_force(mode.motions[index], x, i, drop);
            roots[1] = 1.0;
        }
        roots[2] = match mode.drives[index] {
            Drive::Freewheeling(_) => i,
            _ => 1.0,
        };
    }
}

/// Applies the event of a root: new state and mode.
fn apply_root(plant: &Plant, mode: &mut Mode, state: &mut State, root: usize) {
    let (index, kind) = (root / ROOTS, root % ROOTS);
    let first = FIRST[index];
    match (kind, mode.motions[index]) {
        (2, _) => {
            state[first] = 0.0;
            mode.drives[index] = Drive::Blocked;
        }
        (0, Motion::Moving) => {
            (state[first + 1], state[first + 2]) = (0.0, 0.0);
            mode.motions[index] = Motion::AtRestStop;
        }
        (1, Motion::Moving) => {
            (state[first + 1], state[first + 2]) = (plant.valves[index].armature.stroke, 0.0);
            mode.motions[index] = Motion::AtFullStroke;
        }
        _ => mode.motions[index] = Motion::Moving,
    }
}

/// Releases an armature that a force already pulls off its stop.
fn release(plant: &Plant, mode: &mut Mode, state: &State) {
    for index in [FILL, VENT] {
        let drop = plant.pressure_drop(index, state[3]);
        let [i, x] = [state[FIRST[index]], state[FIRST[index] + 1]];
        if plant.valves[index].breakaway_force(mode.motions[index], x, i, drop) > 0.0 {
            mode.motions[index] = Motion::Moving;
        }
    }
}

/// Simulates `inputs` with local errors of `relative_tolerance` times the scale of each state.
///
/// # Errors
/// Returns the solver's errors.
pub fn simulate(
    parameters: &PlantParameters,
    inputs: &[ReplayInput],
    relative_tolerance: f64,
) -> Result<Trajectory, DiffsolError> {
    let plant = Rc::new(parameters.plant());
    let mode = Rc::new(Cell::new(Mode {
        drives: [Drive::Blocked; 2],
        motions: [Motion::AtRestStop; 2],
    }));
    // The solver requests the Jacobian column by column at one state and mode: linearise once.
    let cache: RefCell<Option<(State, Mode, [State; STATES])>> = RefCell::new(None);
    let scales: State = [0.3, 5e-4, 0.5, 1e6, 0.3, 5e-4, 0.5];
    let (plant_a, mode_a) = (plant.clone(), mode.clone());
    let (plant_b, mode_b) = (plant.clone(), mode.clone());
    let (plant_c, mode_c) = (plant.clone(), mode.clone());
    let ambient = plant.ambient_pressure;
    let mut problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(relative_tolerance)
        .atol(scales.map(|scale| scale * relative_tolerance))
        .rhs_implicit(
            move |x, _p, _t, y| y.copy_from_slice(&rates(&plant_a, mode_a.get(), &state_of(x))),
            move |x, _p, _t, v, y| {
                let state = state_of(x);
                let mut cache = cache.borrow_mut();
                let mode = mode_b.get();
                let a = match &*cache {
                    Some((at, under, a)) if (*at, *under) == (state, mode) => *a,
                    _ => {
                        let a = jacobian(&plant_b, mode, &state);
                        *cache = Some((state, mode, a));
                        a
                    }
                };
                for (row, y) in a.iter().zip(y) {
                    *y = row.iter().zip(v).map(|(a, v)| a * v).sum();
                }
            },
        )
        .init(
            move |_p, _t, y| {
                y.fill(0.0);
                y[3] = ambient;
            },
            STATES,
        )
        .root(
            move |x, _p, _t, y| roots(&plant_c, mode_c.get(), &state_of(x), y),
            2 * ROOTS,
        )
        .build()?;
    // The solver counts these over its whole life, here thousands of restarts.
    problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
    let mut solver = problem.bdf::<NalgebraLU<f64>>()?;

    let mut output = EcuOutput::new(
        parameters.ecu.pwm_period_ns(),
        parameters.ecu.command_delay_ns(),
    );
    let mut supply = parameters.ecu.supply_voltage_v;
    let mut state: State = [0.0; STATES];
    state[3] = ambient;
    let mut command = Command::default();
    let (mut now_ns, mut steps) = (0, 0);
    let mut pressure = Vec::with_capacity(inputs.len());
    for input in inputs {
        while now_ns < input.time_ns {
            let high = output.update(now_ns);
            let mut now_mode = mode.get();
            for index in [FILL, VENT] {
                now_mode.drives[index] = if high[index] {
                    Drive::Energised(supply)
                } else if state[FIRST[index]] > 0.0 {
                    Drive::Freewheeling(plant.diode_drop)
                } else {
                    Drive::Blocked
                };
            }
            let next_ns = output.next_edge_ns(now_ns).min(input.time_ns);
            let end = next_ns as f64 * 1e-9;
            // Restart, and again after every root.
            loop {
                release(&plant, &mut now_mode, &state);
                mode.set(now_mode);
                let restarted = solver.state_mut();
                let slope = rates(&plant, now_mode, &state);
                for n in 0..STATES {
                    restarted.y[n] = state[n];
                    restarted.dy[n] = slope[n];
                }
                *restarted.h = FIRST_STEP.min(end - *restarted.t);
                if *restarted.t >= end - 1e-12 {
                    *restarted.t = end;
                    break;
                }
                solver.set_stop_time(end)?;
                let stop = loop {
                    let stop = solver.step()?;
                    steps += 1;
                    if !matches!(stop, OdeSolverStopReason::InternalTimestep) {
                        break stop;
                    }
                };
                match stop {
                    OdeSolverStopReason::RootFound(time, root) => {
                        solver.state_mut_back(time)?;
                        state = core::array::from_fn(|n| solver.state().y[n]);
                        apply_root(&plant, &mut now_mode, &mut state, root);
                    }
                    _ => {
                        state = core::array::from_fn(|n| solver.state().y[n]);
                        break;
                    }
                }
            }
            now_ns = next_ns;
        }
        pressure.push(state[3]);
        if let Some(volt) = input.supply_voltage_v {
            supply = volt;
        }
        command = input.command.unwrap_or(command);
        output.command(now_ns, command);
    }
    Ok(Trajectory { pressure, steps })
}
