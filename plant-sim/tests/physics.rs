//! Comparison of the simulator with analytic limits and balances.

use plant_sim::plant::{FILL, Plant, PlantState, VENT};
use plant_sim::valve::{Motion, ValveFunction};
use plant_sim::{Command, PlantParameters, Simulator, Tolerance};

const MS: u64 = 1_000_000;

fn command(duty_fill_pct: f64, duty_vent_pct: f64) -> Command {
    Command {
        duty_fill_pct,
        duty_vent_pct,
    }
}

/// Returns the areas of the orifices at a state (m²).
fn areas(plant: &Plant, state: &PlantState) -> [f64; 2] {
    [FILL, VENT].map(|index| plant.valves[index].effective_area(state.valves[index].x))
}

/// Runs through `schedule` of (instant, command) and calls `watch` with the state at every `grid_ns`.
fn run(
    parameters: &PlantParameters,
    schedule: &[(u64, Command)],
    end_ns: u64,
    grid_ns: u64,
    mut watch: impl FnMut(u64, &Simulator),
) -> Simulator {
    let mut simulator = Simulator::with_tolerance(parameters, Tolerance::scaled(0.01));
    let mut schedule = schedule.iter().peekable();
    for now in (0..=end_ns).step_by(grid_ns as usize) {
        simulator.advance_to_ns(now);
        watch(now, &simulator);
        while schedule
            .next_if(|(at, _)| *at <= now)
            .map(|(_, c)| simulator.command(*c))
            .is_some()
        {}
    }
    simulator
}

/// Equation 3.24 with choked flow: the pressure rises linearly at R T / V times the choked mass flow.
#[test]
fn choked_filling_is_linear() {
    let nominal = PlantParameters::nominal();
    let mut points = Vec::new();
    let schedule = [(0, command(100.0, 0.0))];
    run(&nominal, &schedule, 100 * MS, MS, |now, simulator| {
        let state = simulator.state();
        let choked = state.pressure < 0.5 * nominal.gas.supply_pressure_pa();
        if state.valves[FILL].motion == Motion::AtFullStroke && choked {
            points.push((now as f64 * 1e-9, state.pressure));
        }
    });
    let gas = &nominal.gas;
    let (k, rt) = (
        gas.heat_capacity_ratio,
        gas.gas_constant_j_per_kg_k * gas.temperature_k,
    );
    let choked = (k * (2.0 / (k + 1.0)).powf((k + 1.0) / (k - 1.0)) / rt).sqrt();
    let bore = std::f64::consts::PI * (nominal.flow.orifice_fill_m / 2.0).powi(2);
    let expected = rt / nominal.chamber.volume_m3
        * nominal.flow.discharge_fill
        * bore
        * gas.supply_pressure_pa()
        * choked;
    assert!(points.len() > 20);
    for pair in points.windows(2) {
        let slope = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
        assert!((slope / expected - 1.0).abs() < 1e-9, "{slope} {expected}");
    }
}

/// Choked venting is exponential: dp/dt = -p/τ.
#[test]
fn choked_venting_is_exponential() {
    let nominal = PlantParameters::nominal();
    let mut simulator = Simulator::new(&nominal);
    simulator.set_chamber_pressure(9e5);
    simulator.command(command(0.0, 100.0));
    simulator.advance_to_ns(60 * MS);
    let start = simulator.state().pressure;
    assert_eq!(simulator.state().valves[VENT].motion, Motion::AtFullStroke);
    simulator.advance_to_ns(110 * MS);
    let end = simulator.state().pressure;
    assert!(
        end > 2.0 * nominal.gas.ambient_pressure_pa,
        "still choked: {end}"
    );
    let plant = simulator.plant();
    let area = areas(plant, simulator.state())[VENT];
    let rate = plant.chamber.pressure_per_mass * plant.mass_flow(VENT, area, end) / end;
    assert!(
        (end / start - (-rate * 0.05).exp()).abs() < 1e-6,
        "{start} {end}"
    );
}

#[test]
fn a_closed_chamber_holds_its_pressure_exactly() {
    let mut simulator = Simulator::new(&PlantParameters::nominal());
    simulator.set_chamber_pressure(5.123e5);
    simulator.advance_to_ns(3_600_000 * MS);
    assert_eq!(simulator.state().pressure, 5.123e5);
}

#[test]
fn filling_ends_at_the_supply_and_venting_at_the_ambient_pressure() {
    let nominal = PlantParameters::nominal();
    let schedule = [(0, command(100.0, 0.0)), (3000 * MS, command(0.0, 100.0))];
    let mut highest = 0.0_f64;
    let end = run(&nominal, &schedule, 6000 * MS, 10 * MS, |_, simulator| {
        highest = highest.max(simulator.state().pressure);
    });
    assert!(
        (highest - nominal.gas.supply_pressure_pa()).abs() < 1.0,
        "{highest}"
    );
    assert!((end.state().pressure - nominal.gas.ambient_pressure_pa).abs() < 1.0);
}

/// The mass in the chamber equals the flows summed by quadrature on a fine grid, through pulses of both valves.
#[test]
fn mass_is_conserved() {
    let nominal = PlantParameters::nominal();
    let schedule = [
        (0, command(60.0, 0.0)),
        (150 * MS, command(45.0, 40.0)),
        (300 * MS, command(0.0, 55.0)),
    ];
    let mut mass_in = 0.0;
    let mut last: Option<f64> = None;
    let grid_ns = 2_000;
    let end = run(&nominal, &schedule, 450 * MS, grid_ns, |_, simulator| {
        let plant = simulator.plant();
        let state = simulator.state();
        let areas = areas(plant, state);
        let net = plant.mass_flow(FILL, areas[FILL], state.pressure)
            - plant.mass_flow(VENT, areas[VENT], state.pressure);
        if let Some(last) = last {
            mass_in += 0.5 * (last + net) * grid_ns as f64 * 1e-9;
        }
        last = Some(net);
    });
    let plant = end.plant();
    let gained =
        (end.state().pressure - nominal.gas.ambient_pressure_pa) / plant.chamber.pressure_per_mass;
    assert!(gained > 1e-5, "the chamber was filled: {gained} kg");
    assert!(
        (gained - mass_in).abs() < 2e-6 * gained,
        "{gained} {mass_in}"
    );
}

/// Equation 3.4 times i: the energy from the source becomes heat, field energy and motional work i² L'v/2.
#[test]
fn coil_energy_is_balanced() {
    let nominal = PlantParameters::nominal();
    let (mut delivered, mut spent, mut last) = (0.0, 0.0, None);
    let grid_ns = 1_000;
    let schedule = [(0, command(70.0, 0.0))];
    let end = run(&nominal, &schedule, 95 * MS, grid_ns, |_, simulator| {
        let valve = &simulator.plant().valves[FILL];
        let state = &simulator.state().valves[FILL];
        let i = state.current;
        let power_in = state.drive.voltage().unwrap_or(0.0) * i;
        let heat = valve.coil.resistance * i * i;
        let motional = 0.5 * i * i * valve.coil.inductance_slope * state.v;
        let h = grid_ns as f64 * 1e-9;
        if let Some((last_in, last_out)) = last {
            delivered += 0.5 * h * (last_in + power_in);
            spent += 0.5 * h * (last_out + heat + motional);
        }
        last = Some((power_in, heat + motional));
    });
    let valve = &end.plant().valves[FILL];
    let state = &end.state().valves[FILL];
    let field = 0.5 * valve.coil.inductance(state.x) * state.current.powi(2);
    assert!(
        (delivered - spent - field).abs() < 1e-4 * delivered,
        "{delivered} J in, {spent} J out, {field} J stored"
    );
}

/// The mean current of a sample equals the quadrature of the current.
#[test]
fn mean_current_is_the_mean_of_the_current() {
    let nominal = PlantParameters::nominal();
    // Tight, so that both trajectories are equal.
    let tight = Tolerance::scaled(1e-3);
    let mut fine = Simulator::with_tolerance(&nominal, tight);
    let mut coarse = Simulator::with_tolerance(&nominal, tight);
    for simulator in [&mut fine, &mut coarse] {
        simulator.command(command(65.0, 0.0));
    }
    for sample in 1..=20_u64 {
        let mut sum = 0.0;
        for k in 0..10_000_u64 {
            fine.advance_to_ns((sample - 1) * 10 * MS + k * 1_000 + 500);
            sum += fine.state().valves[FILL].current;
        }
        coarse.advance_to_ns(sample * 10 * MS);
        let mean = coarse.sample().mean_current[FILL];
        assert!(
            (mean - sum / 1e4).abs() < 2e-6,
            "{sample}: {mean} {}",
            sum / 1e4
        );
    }
}

#[test]
fn a_normally_open_vent_valve_empties_the_chamber_and_closes_under_current() {
    let mut parameters = PlantParameters::nominal();
    parameters.functions[VENT] = ValveFunction::NormallyOpen;
    let mut simulator = Simulator::with_tolerance(&parameters, Tolerance::scaled(0.01));
    simulator.set_chamber_pressure(4e5);
    simulator.command(command(0.0, 100.0));
    simulator.advance_to_ns(100 * MS);
    let held = simulator.state().pressure;
    assert_eq!(simulator.state().valves[VENT].motion, Motion::AtFullStroke);
    simulator.advance_to_ns(1000 * MS);
    assert_eq!(simulator.state().pressure, held, "closed under current");
    simulator.command(command(0.0, 0.0));
    simulator.advance_to_ns(3000 * MS);
    let end = simulator.state().pressure;
    assert!(
        (end - parameters.gas.ambient_pressure_pa).abs() < 1.0,
        "open without: {end}"
    );
}

#[test]
fn a_lower_supply_empties_the_chamber_backwards_through_the_open_fill_valve() {
    let nominal = PlantParameters::nominal();
    let mut simulator = Simulator::with_tolerance(&nominal, Tolerance::scaled(0.01));
    simulator.command(command(100.0, 0.0));
    simulator.advance_to_ns(2000 * MS);
    simulator.set_chamber_pressure(nominal.gas.supply_pressure_pa() + 1e5);
    simulator.advance_to_ns(4000 * MS);
    let error = simulator.state().pressure - nominal.gas.supply_pressure_pa();
    assert!(error.abs() < 1.0, "{error}");
}

#[test]
fn samples_in_between_do_not_change_the_trajectory_beyond_the_tolerance() {
    let nominal = PlantParameters::nominal();
    let end = |grid_ns: u64| {
        let mut simulator = Simulator::new(&nominal);
        simulator.command(command(60.0, 0.0));
        for now in (0..=300 * MS).step_by(grid_ns as usize) {
            simulator.advance_to_ns(now);
            simulator.sample();
        }
        simulator.state().pressure
    };
    let (coarse, fine) = (end(10 * MS), end(MS / 10));
    assert!((coarse - fine).abs() < 50.0, "{coarse} {fine}");
}
