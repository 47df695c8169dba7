//! Lifts of the valves, counted from the motion of their armatures.

use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Simulator};

/// Interval at which the independent counter looks at the armature (ns), a small part of the shortest counted bounce.
const WATCH_NS: u64 = 500;
const STROKE_M: f64 = 0.5e-3;

/// Flights of the fill valve's armature that reach a hundredth of the stroke. A flight ends on the seat, or where the
/// velocity turns near it from closing to opening, by a bounce.
#[derive(Default)]
struct Flights {
    highest_m: f64,
    velocity: f64,
    count: u64,
}

impl Flights {
    fn see(&mut self, height_m: f64, velocity: f64) {
        let has_bounced = height_m < 0.01 * STROKE_M && self.velocity < 0.0 && velocity > 0.0;
        if height_m == 0.0 || has_bounced {
            let highest_m = core::mem::take(&mut self.highest_m);
            self.count += u64::from(highest_m >= 0.01 * STROKE_M);
        }
        self.highest_m = self.highest_m.max(height_m);
        self.velocity = velocity;
    }
}

/// Returns the lifts of the fill valve that the simulator counts over `pulses` of 8 ms, and those of the watch.
fn lifts(plant: &PlantParameters, pulses: u64) -> [u64; 2] {
    let mut simulator = Simulator::new(plant);
    let mut flights = Flights::default();
    for pulse in 0..pulses {
        let begin_ns = pulse * 60_000_000;
        for (from_ns, duty_fill_pct) in [(begin_ns, 80.0), (begin_ns + 10_000_000, 0.0)] {
            simulator.command_at(
                from_ns,
                Command {
                    duty_fill_pct,
                    duty_vent_pct: 0.0,
                },
            );
            let to_ns = from_ns
                + if duty_fill_pct > 0.0 {
                    10_000_000
                } else {
                    50_000_000
                };
            while simulator.time_ns() < to_ns {
                simulator.advance_to_ns(simulator.time_ns() + WATCH_NS);
                let valve = simulator.state().valves[0];
                flights.see(valve.x, valve.v);
            }
        }
    }
    [simulator.lifts()[0], flights.count]
}

fn bouncing(restitution: f64) -> PlantParameters {
    let bounce = by_id("end_stop_bounce").unwrap();
    PlantParameters::nominal()
        .with_effect(EffectSetting::typical(bounce).with("restitution", restitution))
}

#[test]
fn a_pulse_that_opens_the_valve_is_one_lift() {
    assert_eq!(lifts(&PlantParameters::nominal(), 3), [3, 3]);
}

/// Defect seen: with a watch once a millisecond, 8.7 of 15.8 lifts per second were counted.
#[test]
fn each_bounce_off_the_seat_is_a_lift() {
    for restitution in [0.3, 0.5] {
        let [counted, seen] = lifts(&bouncing(restitution), 3);
        assert_eq!(counted, seen, "restitution {restitution}");
        assert!(
            counted > 3,
            "restitution {restitution}: {counted} lifts in 3 pulses"
        );
    }
}

/// The count does not depend on the instants at which the simulator is advanced to.
#[test]
fn bounces_between_two_samples_are_counted() {
    let mut simulator = Simulator::new(&bouncing(0.5));
    for sample in 0..18 {
        simulator.command(Command {
            duty_fill_pct: if sample % 6 == 0 { 80.0 } else { 0.0 },
            duty_vent_pct: 0.0,
        });
        simulator.advance_to_ns((sample + 1) * 10_000_000);
    }
    let [_, seen] = lifts(&bouncing(0.5), 3);
    assert_eq!(simulator.lifts(), [seen, 0]);
}

/// Its seat is at full stroke: it begins open, and each pulse closes and opens it.
#[test]
fn a_normally_open_valve_lifts_when_its_pulse_ends() {
    let mut plant = PlantParameters::nominal();
    plant.functions[0] = ValveFunction::NormallyOpen;
    let mut simulator = Simulator::new(&plant);
    for (to_ms, duty_fill_pct, expected) in [
        (20, 0.0, 0),
        (120, 100.0, 0),
        (220, 0.0, 1),
        (320, 100.0, 1),
    ] {
        simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct: 0.0,
        });
        simulator.advance_to_ns(to_ms * 1_000_000);
        assert_eq!(simulator.lifts()[0], expected, "after {to_ms} ms");
    }
}
