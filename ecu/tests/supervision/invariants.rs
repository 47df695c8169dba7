//! Invariants under random faults, references and durations on the same rig.

use ecu::{Inputs, Mode, SensorCode};
use proptest::prelude::*;

use crate::bench::{Bench, code, pressure};

/// Event that lasts for a number of samples.
#[derive(Clone, Debug)]
enum Event {
    Ask(f64),
    Pressure(Option<u16>),
    Reference(Option<f64>),
    Current(u16, u16),
    Battery(u16),
    Elapsed(u32),
    FillStuck(Option<f64>),
    VentStuck(Option<f64>),
    Supply(f64),
    Release,
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (0.0..9.0_f64).prop_map(Event::Ask),
        3 => Just(Event::Ask(0.0)),
        2 => prop::option::of(0..4096_u16).prop_map(Event::Pressure),
        2 => prop::option::of(-2.0..12.0).prop_map(Event::Reference),
        1 => (any::<u16>(), any::<u16>()).prop_map(|(fill, vent)| Event::Current(fill, vent)),
        1 => any::<u16>().prop_map(Event::Battery),
        1 => (0..40_000_u32).prop_map(Event::Elapsed),
        1 => prop::option::of(0.0..1.0).prop_map(Event::FillStuck),
        1 => prop::option::of(0.0..1.0).prop_map(Event::VentStuck),
        1 => (0.0..9.0).prop_map(Event::Supply),
        1 => Just(Event::Release),
    ]
}

impl Event {
    fn happens_to(&self, bench: &mut Bench) {
        match *self {
            Self::Ask(bar) => bench.reference_bar = bar,
            Self::FillStuck(at) => bench.rig.fill_stuck_at = at,
            Self::VentStuck(at) => bench.rig.vent_stuck_at = at,
            Self::Supply(bar) => bench.rig.supply_bar = bar,
            Self::Release => {
                let _ = bench.ecu.release();
            }
            _ => {}
        }
    }

    fn shows(&self, inputs: &mut Inputs) {
        match *self {
            Self::Pressure(bits) => inputs.pressure = bits.and_then(SensorCode::from_bits),
            Self::Reference(bar) => inputs.reference = bar.map(pressure),
            Self::Current(fill, vent) => {
                inputs.current_fill_ma = Some(fill);
                inputs.current_vent_ma = Some(vent);
            }
            Self::Battery(millivolts) => inputs.battery_mv = Some(millivolts),
            Self::Elapsed(microseconds) => inputs.elapsed_us = microseconds,
            _ => {}
        }
    }
}

proptest! {
    #[test]
    fn no_output_is_ever_unsafe(events in prop::collection::vec((event(), 1..150_u32), 1..25)) {
        let mut bench = Bench::new();
        // Consecutive samples with the reference at zero, and whether there were ten since the chamber was last
        // emptied.
        let (mut zeros, mut was_at_zero) = (0, false);
        for (event, samples) in events {
            event.happens_to(&mut bench);
            for _ in 0..samples {
                let before = (bench.ecu.mode(), bench.duties());
                let mut seen = bench.inputs();
                event.shows(&mut seen);
                bench.step_with(|inputs| *inputs = seen);
                let (mode, [fill, vent]) = (bench.ecu.mode(), bench.duties());

                if let Some(reference) = seen.reference.filter(|reference| (pressure(-1.0)..=pressure(10.0)).contains(reference)) {
                    zeros = if reference <= pressure(0.05) { zeros + 1 } else { 0 };
                }
                was_at_zero |= zeros >= 10;
                prop_assert!(fill == 0.0 || vent == 0.0, "both valves: {fill}, {vent}");
                prop_assert!(fill == 0.0 || mode == Mode::Running, "filled in {mode:?}");
                prop_assert!(fill == 0.0 || was_at_zero, "filled before the reference was at zero");
                if matches!(mode, Mode::Safe | Mode::Locked) {
                    prop_assert!(bench.is_off(), "current in {mode:?}");
                    was_at_zero = false;
                }
                let is_sound = |&code: &SensorCode| (32..=code_max()).contains(&code.bits());
                if !seen.pressure.as_ref().is_some_and(is_sound) && mode != Mode::Venting {
                    prop_assert!(bench.is_off(), "a code is believed that cannot be");
                }
                if seen.reference.is_none() {
                    prop_assert!(fill <= before.1[0], "filled further without a reference");
                }
                match before.0 {
                    Mode::Locked => prop_assert_eq!(mode, Mode::Locked),
                    Mode::Safe => prop_assert!(matches!(mode, Mode::Safe | Mode::Locked | Mode::Waiting)),
                    Mode::Venting => prop_assert!(matches!(mode, Mode::Venting | Mode::Safe | Mode::Locked)),
                    _ => {}
                }
            }
        }
    }
}

fn code_max() -> u16 {
    code(10.2).bits()
}
