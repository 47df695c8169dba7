//! Whole plant and its solution: Runge-Kutta of order 4 with fixed steps, restarted at every PWM edge.

use super::coil::{Coil, Source};
use super::contact::Stops;
use super::friction;
use super::gas::{GasPath, Pressures};
use super::pulses::Pulses;
use super::rig::Rig;
use super::sensor::{self, Reading};
use super::state::*;

/// Step while a coil or an armature is active (s).
const FINE_STEP: f64 = 1e-5;
/// Step while coils are without current and armatures seated (s): only gas flows, and the dampers of the stops are
/// stiff.
const COARSE_STEP: f64 = 1.5e-5;
/// Step of long holds (s): armatures are fixed, and the anti-alias filter is stiff.
const LONG_STEP: f64 = 1e-4;
/// Velocity below which an armature rests (m/s).
const RESTING: f64 = 1e-6;

/// Running rig.
#[derive(Debug, Clone)]
pub struct ReferencePlant {
    rig: Rig,
    coil: Coil,
    stops: Stops,
    gas: GasPath,
    pulses: Pulses,
    /// Area on which the pressure difference acts (m²).
    pressure_area: f64,
    preloads: [f64; 2],
    coarse_step: f64,
    /// Whether seated armatures without current are fixed in long steps, and whether they are now.
    has_long_steps: bool,
    is_fixed: bool,
    sample_ns: u64,
    now_ns: u64,
    /// Start of the interval of the mean currents (ns).
    means_since_ns: u64,
    state: State,
    /// Pressure after the play of the sensor (Pa gauge).
    played: f64,
}

impl ReferencePlant {
    /// Creates a rig at rest: coils without current, armatures seated, chamber vented, everything at 20 °C.
    pub fn new(rig: &Rig) -> Self {
        let sheet = &rig.datasheet;
        let armature = &sheet.armature;
        let gas = GasPath::new(rig);
        let mut state = [0.0; COUNT];
        gas.rest(&mut state);
        let rubs = rig.departures.armature.coulomb_n > 0.0;
        let mut plant = Self {
            coil: Coil::new(rig),
            stops: Stops::new(
                armature.stroke_m,
                armature.mass_kg,
                rig.departures.armature.restitution,
            ),
            gas,
            pulses: Pulses::new(rig),
            pressure_area: std::f64::consts::FRAC_PI_4 * armature.pressure_force_diameter_m.powi(2),
            preloads: [armature.preload_fill_n, armature.preload_vent_n],
            // Friction is the stiffest force at low velocities.
            coarse_step: if rubs { FINE_STEP } else { COARSE_STEP },
            has_long_steps: false,
            is_fixed: false,
            sample_ns: (sheet.ecu.sample_time_s * 1e9).round() as u64,
            now_ns: 0,
            means_since_ns: 0,
            state,
            played: 0.0,
            rig: rig.clone(),
        };
        plant.seat();
        plant
    }

    /// Puts the armatures at the positions where the springs hold them, a few micrometres deep in their seats.
    fn seat(&mut self) {
        let at = self.gas.pressures(0.0, &self.state);
        for valve in 0..2 {
            let load = self.preloads[valve] - self.pressure_force(&at, valve);
            let spring = self.rig.datasheet.armature.spring_n_per_m;
            self.state[POSITION + valve] = -Stops::depth(load, spring);
        }
    }

    /// Returns the present reading.
    pub fn reading(&mut self) -> Reading {
        let (sensor, time) = (self.rig.departures.sensor, self.time());
        let shown = sensor::shown(&sensor);
        let rate = self.rates(&self.state, time, [false; 2])[shown];
        let span_ns = match self.now_ns - self.means_since_ns {
            0 => self.sample_ns,
            span_ns => span_ns,
        };
        let span = span_ns as f64 * 1e-9;
        Reading {
            pressure: sensor::distorted(&sensor, self.played, time),
            pressure_rate: rate,
            currents: [0, 1].map(|valve| {
                self.state[CHARGE + valve] / span + sensor::interference(&sensor, time)
            }),
        }
    }

    /// Sets the duty cycles (%) of this sample, fill and vent, and runs to the next one.
    pub fn run(&mut self, duty_pct: [f64; 2]) {
        self.command(duty_pct);
        self.begin_means();
        self.run_until(self.now_ns + self.sample_ns);
    }

    /// Sets the duty cycles (%) of the next sample, fill and vent.
    pub fn command(&mut self, duty_pct: [f64; 2]) {
        self.pulses.command(duty_pct);
    }

    /// Begins the interval of the next reading's mean currents.
    pub fn begin_means(&mut self) {
        self.state[CHARGE..CHARGE + 2].fill(0.0);
        self.means_since_ns = self.now_ns;
    }

    /// Runs to an instant (ns). The commands of all samples before it have to be set.
    pub fn run_until(&mut self, end_ns: u64) {
        while self.now_ns < end_ns {
            let (high, known_until_ns) = self.pulses.at(self.now_ns);
            let next_ns = known_until_ns.min(end_ns);
            self.integrate(high, (next_ns - self.now_ns) as f64 * 1e-9);
            self.now_ns = next_ns;
        }
    }

    /// Solves holds in steps of 0.1 ms from now on, with the armatures fixed in their seats: for logs that are mostly
    /// holds.
    pub fn hold_in_long_steps(&mut self) {
        self.has_long_steps = true;
    }

    /// Makes the gas in the chamber warmer than the wall by `by_k` at the same pressure, as a fast fill does. It cools
    /// by the wall with the time constant `relaxation_s`.
    pub fn warm_gas(&mut self, by_k: f64, relaxation_s: f64) {
        self.gas.warm(by_k, relaxation_s, &mut self.state);
        self.play();
    }

    /// Returns mass (kg) and internal energy (J) of the gas in the chamber.
    pub fn gas_content(&self) -> (f64, f64) {
        (self.state[MASS], self.state[ENERGY])
    }

    /// Returns the true chamber pressure (Pa abs).
    pub fn chamber_pressure(&self) -> f64 {
        self.gas.pressures(self.time(), &self.state).chamber
    }

    /// Returns the temperature of the gas in the chamber (K).
    pub fn gas_temperature(&self) -> f64 {
        self.gas.pressures(self.time(), &self.state).temperature
    }

    /// Returns the armature positions (m), fill and vent.
    pub fn positions(&self) -> [f64; 2] {
        [self.state[POSITION], self.state[POSITION + 1]]
    }

    fn time(&self) -> f64 {
        self.now_ns as f64 * 1e-9
    }

    fn integrate(&mut self, high: [bool; 2], span: f64) {
        let begin = self.time();
        let mut done = 0.0;
        while span - done > 1e-12 {
            let rests = high == [false; 2] && self.rests();
            self.is_fixed = self.has_long_steps && rests;
            let step = if self.is_fixed {
                LONG_STEP
            } else if rests {
                self.coarse_step
            } else {
                FINE_STEP
            };
            let step = step.min(span - done);
            self.step(begin + done, step, high);
            done += step;
        }
    }

    /// Returns whether the coils are without current and the armatures seated.
    fn rests(&self) -> bool {
        (0..2).all(|valve| {
            self.state[FLUX + valve] == 0.0
                && self.state[POSITION + valve] <= 0.0
                && self.state[VELOCITY + valve].abs() < RESTING
        })
    }

    fn step(&mut self, time: f64, h: f64, high: [bool; 2]) {
        let half = 0.5 * h;
        let a = self.rates(&self.state, time, high);
        let b = self.rates(&along(&self.state, half, &a), time + half, high);
        let c = self.rates(&along(&self.state, half, &b), time + half, high);
        let d = self.rates(&along(&self.state, h, &c), time + h, high);
        let mean: State = std::array::from_fn(|n| (a[n] + 2.0 * (b[n] + c[n]) + d[n]) / 6.0);
        self.state = along(&self.state, h, &mean);
        for valve in 0..2 {
            // The diode blocked within the step.
            let flux = &mut self.state[FLUX + valve];
            *flux = flux.max(0.0);
        }
        self.play();
    }

    /// Moves the reading with the pressure.
    fn play(&mut self) {
        let sensor = &self.rig.departures.sensor;
        let gauge = self.state[sensor::shown(sensor)] - self.gas.ambient();
        self.played = sensor::played(sensor, self.played, gauge);
    }

    fn rates(&self, state: &State, time: f64, high: [bool; 2]) -> State {
        let mut rate = [0.0; COUNT];
        let at = self.gas.pressures(time, state);
        self.electric_rates(state, time, high, &mut rate);
        for valve in 0..2 {
            self.armature_rates(valve, state, &at, &mut rate);
        }
        if self.is_fixed {
            rate[POSITION..POSITION + 2].fill(0.0);
            rate[VELOCITY..VELOCITY + 2].fill(0.0);
        }
        let lifts = [0, 1].map(|valve| self.gas.lift(valve, state[POSITION + valve]));
        self.gas.rates(&at, lifts, state, &mut rate);
        let sensor = &self.rig.departures.sensor;
        let in_cavity = self.rig.departures.chamber.sensor_in_cavity;
        let seen = if in_cavity { at.cavity } else { at.chamber };
        sensor::rates(sensor, seen, state, &mut rate);
        rate
    }

    /// Returns the force of the pressure on an armature in the direction of its magnet (N). The pressure opens the
    /// seat, which the magnet of a normally open valve closes.
    fn pressure_force(&self, at: &Pressures, valve: usize) -> f64 {
        let lifts = self.pressure_area * pressure_drop(at, valve);
        if self.gas.is_normally_open(valve) {
            -lifts
        } else {
            lifts
        }
    }

    fn electric_rates(&self, state: &State, time: f64, high: [bool; 2], rate: &mut State) {
        let (ecu, driver) = (&self.rig.datasheet.ecu, &self.rig.departures.driver);
        let iron = &self.rig.departures.coil;
        let magnetising = [0, 1].map(|valve| {
            self.coil
                .magnetising(iron, state[FLUX + valve], state[POSITION + valve])
        });
        let drawn: f64 = (0..2)
            .filter(|&valve| high[valve])
            .map(|valve| magnetising[valve])
            .sum();
        let supplied = ecu.supply_voltage_v + wander(driver, time)
            - driver.harness_ohm * drawn
            - state[POLARISATION];
        if driver.polarisation_ohm > 0.0 {
            rate[POLARISATION] =
                (driver.polarisation_ohm * drawn - state[POLARISATION]) / driver.polarisation_s;
        }
        for valve in 0..2 {
            let source = if high[valve] {
                Source::On(supplied)
            } else {
                Source::Off(
                    ecu.free_wheel_diode_drop_v + driver.clamp_v,
                    driver.snubber_ohm,
                )
            };
            let resistance = self.coil.resistance(self.over_20c(valve, time, state));
            let rates = self.coil.rates(
                iron,
                [state[FLUX + valve], state[EDDY + valve]],
                magnetising[valve],
                resistance,
                source,
            );
            rate[FLUX + valve] = rates.flux;
            rate[EDDY + valve] = rates.eddy;
            rate[CHARGE + valve] = rates.current;
            self.heat_rates(valve, rates.current.powi(2) * resistance, state, rate);
        }
    }

    /// Returns the temperature of a winding above 20 °C (K).
    fn over_20c(&self, valve: usize, time: f64, state: &State) -> f64 {
        let coil = &self.rig.departures.coil;
        let mut surroundings = coil.surroundings_k[valve];
        if coil.surroundings_in_the_end_k != 0.0 {
            surroundings +=
                coil.surroundings_in_the_end_k * (1.0 - (-time / coil.surroundings_s).exp());
        }
        surroundings + state[WINDING + valve] + state[BODY + valve]
    }

    /// Computes the heat flow from the winding to the body and from the body to the surroundings; `heat` in W.
    fn heat_rates(&self, valve: usize, heat: f64, state: &State, rate: &mut State) {
        let coil = &self.rig.departures.coil;
        if coil.winding_k_per_w > 0.0 {
            rate[WINDING + valve] =
                (coil.winding_k_per_w * heat - state[WINDING + valve]) / coil.winding_s;
        }
        if coil.body_k_per_w > 0.0 {
            rate[BODY + valve] = (coil.body_k_per_w * heat - state[BODY + valve]) / coil.body_s;
        }
    }

    fn armature_rates(&self, valve: usize, state: &State, at: &Pressures, rate: &mut State) {
        let sheet = &self.rig.datasheet.armature;
        let departures = &self.rig.departures.armature;
        let (position, velocity) = (state[POSITION + valve], state[VELOCITY + valve]);
        let pressure = self.pressure_force(at, valve);
        let lift = self.gas.lift(valve, position);
        let force = self.coil.force(state[FLUX + valve], position)
            + pressure * (1.0 - pressure_force_loss(departures, lift))
            - self.preloads[valve]
            - sheet.spring_n_per_m * position
            - sheet.viscous_friction_ns_per_m * velocity
            - friction::of_velocity(departures, velocity)
            - state[BRISTLE + valve]
            - friction::of_seat(departures, state[ADHESION + valve], position)
            + self.stops.force(position, velocity);
        rate[POSITION + valve] = velocity;
        rate[VELOCITY + valve] = force / sheet.mass_kg;
        rate[BRISTLE + valve] =
            friction::bristle_rate(departures, state[BRISTLE + valve], velocity);
        rate[ADHESION + valve] =
            friction::adhesion_rate(departures, state[ADHESION + valve], position);
    }
}

/// Returns the present variation of the battery voltage (V): three tones without a common period.
fn wander(driver: &super::departures::DriverDepartures, time: f64) -> f64 {
    if driver.wander_v == 0.0 {
        return 0.0;
    }
    let tone = |ratio: f64| (std::f64::consts::TAU * driver.wander_hz * ratio * time).sin();
    driver.wander_v * (tone(1.0) + tone(1.618) + tone(2.618))
}

/// Returns the pressure that pushes an armature open (Pa).
fn pressure_drop(at: &Pressures, valve: usize) -> f64 {
    if valve == 0 {
        at.inlet - at.chamber
    } else {
        at.chamber - at.drain
    }
}

/// Returns the lost share of the pressure force at a lift (m).
fn pressure_force_loss(armature: &super::departures::ArmatureDepartures, lift: f64) -> f64 {
    if armature.pressure_force_loss == 0.0 || lift <= 0.0 {
        return 0.0;
    }
    let scale = armature.pressure_force_lift_m;
    armature.pressure_force_loss
        * if scale > 0.0 {
            lift / (lift + scale)
        } else {
            1.0 - (lift / scale).exp()
        }
}

/// Runs `rig` with `commands` (%), fill and vent, one pair per sample; returns the reading at each sample's instant.
pub fn replay(rig: &Rig, commands: &[[f64; 2]]) -> Vec<Reading> {
    let mut plant = ReferencePlant::new(rig);
    commands
        .iter()
        .map(|&duty_pct| {
            let reading = plant.reading();
            plant.run(duty_pct);
            reading
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_for(plant: &mut ReferencePlant, samples: usize, duty_pct: [f64; 2]) {
        for _ in 0..samples {
            plant.run(duty_pct);
        }
    }

    #[test]
    fn a_normally_open_vent_valve_is_shut_by_its_current() {
        let mut rig = Rig::nominal();
        rig.is_vent_normally_open = true;
        rig.datasheet.armature.preload_vent_n = 1.4;
        let mut plant = ReferencePlant::new(&rig);
        run_for(&mut plant, 10, [0.0, 100.0]);
        run_for(&mut plant, 40, [100.0, 100.0]);
        run_for(&mut plant, 10, [0.0, 100.0]);
        let filled = plant.chamber_pressure();
        run_for(&mut plant, 20, [0.0, 100.0]);
        let held = plant.chamber_pressure();
        assert!(filled > 5e5 && (held / filled - 1.0).abs() < 1e-6);
        run_for(&mut plant, 100, [0.0, 0.0]);
        assert!(plant.chamber_pressure() < 1.1e5);
    }

    #[test]
    fn warm_gas_cools_to_its_wall_and_the_pressure_with_it() {
        let rig = Rig::nominal();
        let wall = rig.datasheet.gas.temperature_k;
        let mut plant = ReferencePlant::new(&rig);
        run_for(&mut plant, 20, [100.0, 0.0]);
        run_for(&mut plant, 10, [0.0, 0.0]);
        let before = plant.chamber_pressure();
        plant.warm_gas(20.0, 0.1);
        let warm = plant.chamber_pressure();
        assert!((warm / before - 1.0).abs() < 1e-9, "{warm}");
        assert!((plant.gas_temperature() - wall - 20.0).abs() < 1e-6);
        run_for(&mut plant, 10, [0.0, 0.0]);
        let surplus = plant.gas_temperature() - wall;
        assert!(
            (surplus / (20.0 / 1.0_f64.exp()) - 1.0).abs() < 1e-3,
            "{surplus}"
        );
        run_for(&mut plant, 200, [0.0, 0.0]);
        let cold = plant.chamber_pressure();
        assert!(
            (cold / warm / (wall / (wall + 20.0)) - 1.0).abs() < 1e-6,
            "{cold}"
        );
    }

    #[test]
    fn long_steps_change_a_hold_by_less_than_any_sensor_shows() {
        let mut rig = Rig::nominal();
        rig.departures.chamber.thermal_s = 0.2;
        rig.departures.flow.chamber_leak.hole_m2 = 1e-8;
        let [short, long] = [false, true].map(|has_long_steps| {
            let mut plant = ReferencePlant::new(&rig);
            plant.has_long_steps = has_long_steps;
            run_for(&mut plant, 10, [100.0, 0.0]);
            run_for(&mut plant, 100, [0.0, 0.0]);
            let held = plant.reading().pressure;
            run_for(&mut plant, 20, [0.0, 100.0]);
            [held, plant.reading().pressure]
        });
        assert!(short[0] > 3e5 && short[1] < 0.5 * short[0], "{short:?}");
        for (short, long) in short.into_iter().zip(long) {
            assert!((short - long).abs() < 1.0, "{short} {long}");
        }
    }

    /// The mean of the two halves of a sample is the mean of the whole.
    #[test]
    fn means_are_over_the_interval_that_was_begun() {
        let mut whole = ReferencePlant::new(&Rig::nominal());
        run_for(&mut whole, 3, [60.0, 0.0]);
        let mut halves = whole.clone();
        whole.run([60.0, 0.0]);
        halves.command([60.0, 0.0]);
        let mut means = Vec::new();
        for end_ns in [35_000_000, 40_000_000] {
            halves.begin_means();
            halves.run_until(end_ns);
            means.push(halves.reading().currents[0]);
        }
        let mean = 0.5 * (means[0] + means[1]);
        assert!((mean / whole.reading().currents[0] - 1.0).abs() < 1e-6);
        assert!((means[0] / means[1] - 1.0).abs() > 0.01, "{means:?}");
    }
}
