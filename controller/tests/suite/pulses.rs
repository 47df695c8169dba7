//! Model-based pulses on a chamber whose valves have the tables of the nominal plant, or other ones.

use controller::{
    CoilSlowness, Config, ConfigError, Duty, Field, Input, Output, Pressure, PulseConfig,
    PulseState, Pulses, Settings, pulse_step,
};
use proptest::prelude::*;

use crate::support::{any_pressure, config, lit};

/// Returns the pulses of these settings.
fn pulses(settings: &Settings) -> PulseConfig {
    *config(settings).pulses().expect("the settings have pulses")
}

fn changed(change: impl FnOnce(&mut Pulses)) -> Settings {
    let mut settings = Settings::pulses();
    change(settings.pulses.as_mut().expect("the settings have pulses"));
    settings
}

/// Chamber with choked flow, and valves that open and shut after the same time: an on-time is an open time, later.
struct Chamber {
    /// Pressure (bar gauge).
    bar: f64,
    /// Rate of both valves (1/s).
    rate_per_s: f64,
    /// Time from an edge to the flow, and the part of a run's beginning without flow (samples).
    opening: f64,
    leak_bar_per_sample: f64,
    /// Flow of the next samples, in open samples: fill positive.
    under_way: [f64; 4],
    was_driven: [bool; 2],
    lifts: [u32; 2],
}

impl Chamber {
    fn at(bar: f64) -> Self {
        Self {
            bar,
            rate_per_s: 7.2,
            opening: 0.4,
            leak_bar_per_sample: 0.0,
            under_way: [0.0; 4],
            was_driven: [false; 2],
            lifts: [0; 2],
        }
    }

    /// Runs a sample with these duty cycles.
    fn drive(&mut self, output: Output) {
        let [fill, vent] = [output.duty_fill, output.duty_vent];
        assert!(fill.is_off() || vent.is_off(), "both valves are driven");
        for (valve, (duty, sign)) in [(fill, 1.0), (vent, -1.0)].into_iter().enumerate() {
            let share: f64 = duty.percent().to_num::<f64>() / 100.0;
            let begins = !duty.is_off() && !self.was_driven[valve];
            self.lifts[valve] += u32::from(begins);
            let open = if begins {
                (share - self.opening).max(0.0)
            } else {
                share
            };
            self.under_way[1] += sign * open * 0.1;
            self.under_way[2] += sign * open * 0.9;
            self.was_driven[valve] = !duty.is_off();
        }
        let flow = self.under_way[0] * self.rate_per_s * 0.01;
        let upstream = if flow > 0.0 { 9.4 } else { self.bar + 1.013 };
        self.bar += flow * upstream - self.leak_bar_per_sample;
        self.under_way.rotate_left(1);
        self.under_way[3] = 0.0;
    }

    fn input(&self, reference: f64) -> Input {
        let bits = |bar: f64| Pressure::from_bits((bar * 65_536.0).round() as i32);
        Input {
            reference: bits(reference),
            pressure: bits(self.bar),
        }
    }

    /// Runs samples at a reference.
    fn run(&mut self, config: &PulseConfig, state: &mut PulseState, reference: f64, samples: u32) {
        for _ in 0..samples {
            let output = pulse_step(config, state, self.input(reference), CoilSlowness::NOMINAL);
            self.drive(output);
        }
    }
}

fn output(config: &PulseConfig, state: &mut PulseState, reference: &str, pressure: &str) -> Output {
    let input = crate::support::input(reference, pressure);
    pulse_step(config, state, input, CoilSlowness::NOMINAL)
}

#[test]
fn inside_the_deadband_no_valve_is_driven_and_beyond_it_the_one_towards_the_reference() {
    let config = pulses(&Settings::pulses());
    for (pressure, fill, vent) in [
        ("3", false, false),
        ("2.931", false, false),
        ("3.069", false, false),
        ("2.92", true, false),
        ("3.08", false, true),
    ] {
        let found = output(&config, &mut PulseState::at_rest(), "3", pressure);
        assert_eq!(!found.duty_fill.is_off(), fill, "{pressure}");
        assert_eq!(!found.duty_vent.is_off(), vent, "{pressure}");
        assert!(found.duty_fill < Duty::FULL && found.duty_vent < Duty::FULL);
    }
    let far = output(&config, &mut PulseState::at_rest(), "5", "2");
    assert_eq!(far.duty_fill, Duty::FULL);
}

/// A pulse is the on-time of the table: 0.2 bar at 2 bar are 2.98 ms of 1.9 mm, which 6.95 ms give.
#[test]
fn the_first_pulse_is_the_on_time_of_the_table_for_the_open_time_of_the_flow() {
    let config = pulses(&Settings::pulses());
    let found = output(&config, &mut PulseState::at_rest(), "2.2", "2").duty_fill;
    let percent: f64 = found.percent().to_num();
    assert!((60.0..70.0).contains(&percent), "{percent}");
}

/// The pressure does not move: the pulse that was given is waited for, and no second one is added.
#[test]
fn a_pulse_under_way_is_not_given_again() {
    let config = pulses(&Settings::pulses());
    let mut state = PulseState::at_rest();
    assert!(!output(&config, &mut state, "3.2", "3").duty_fill.is_off());
    for sample in 0..3 {
        assert_eq!(
            output(&config, &mut state, "3.2", "3"),
            Output::OFF,
            "{sample}"
        );
    }
    let later = (0..5).any(|_| output(&config, &mut state, "3.2", "3") != Output::OFF);
    assert!(later, "a pulse without effect is given again");
}

#[test]
fn a_large_step_is_one_run_of_full_pulses_and_one_last_pulse() {
    let config = pulses(&Settings::pulses());
    for (from, to, valve) in [(1.5, 5.5, 0), (5.5, 1.5, 1)] {
        let (mut state, mut chamber) = (PulseState::at_rest(), Chamber::at(from));
        chamber.run(&config, &mut state, to, 30);
        assert!((chamber.bar - to).abs() < 0.3, "{} bar", chamber.bar);
        assert_eq!(chamber.lifts[valve], 1, "{:?}", chamber.lifts);
        chamber.run(&config, &mut state, to, 60);
        assert!((chamber.bar - to).abs() < 0.1, "{} bar", chamber.bar);
    }
}

/// Goal: what is learnt on a valve with 15 % less flow and another opening delay is used. Method: the same steps with and
/// without adaptation.
#[test]
fn adaptation_makes_the_landing_better_and_its_bound_of_zero_switches_it_off() {
    let lifts = |settings: &Settings| {
        let config = pulses(settings);
        let (mut state, mut chamber) = (PulseState::at_rest(), Chamber::at(2.0));
        chamber.rate_per_s *= 0.85;
        chamber.opening = 0.5;
        for _ in 0..20 {
            for reference in [2.0, 2.4, 4.0, 2.4] {
                chamber.run(&config, &mut state, reference, 60);
            }
        }
        chamber.lifts.iter().sum::<u32>()
    };
    let adapted = lifts(&Settings::pulses());
    let fixed = lifts(&changed(|pulses| {
        pulses.offset_max_ms = lit("0");
        pulses.gain_max_pct = lit("0");
        pulses.lag_max_ms = lit("0");
    }));
    assert!(adapted < fixed, "{adapted} of {fixed} lifts");
}

/// A leak of 0.5 bar/s: with its feed-forward, the pressure is on both sides of the reference.
#[test]
fn a_lasting_leak_is_fed_forward_and_its_bound_of_zero_switches_it_off() {
    let mean = |settings: &Settings| {
        let config = pulses(settings);
        let (mut state, mut chamber) = (PulseState::at_rest(), Chamber::at(3.0));
        chamber.leak_bar_per_sample = 0.005;
        chamber.run(&config, &mut state, 3.0, 1_000);
        let mut sum = 0.0;
        for _ in 0..500 {
            chamber.run(&config, &mut state, 3.0, 1);
            sum += chamber.bar - 3.0;
        }
        sum / 500.0
    };
    let with = mean(&Settings::pulses());
    let without = mean(&changed(|pulses| pulses.leak_max_bar_per_s = lit("0")));
    assert!(with > without + 0.02, "{with} and {without} bar");
    assert!(with.abs() < 0.03, "{with} bar");
}

/// The reference is above the supply pressure: no flow reaches it, and the valve is not energised without end.
#[test]
fn a_reference_beyond_the_supply_pressure_is_not_pulsed_at_for_ever() {
    let config = pulses(&Settings::pulses());
    let mut state = PulseState::at_rest();
    let driven = (0..100)
        .filter(|_| output(&config, &mut state, "10", "8.6") != Output::OFF)
        .count();
    assert_eq!(driven, 0);
}

/// A valve that stays shut: the run is long, its end is waited for, and nothing is learnt from it.
#[test]
fn an_endless_run_ends_when_the_reference_returns() {
    let config = pulses(&Settings::pulses());
    let mut state = PulseState::at_rest();
    for _ in 0..500 {
        assert_eq!(output(&config, &mut state, "6", "2").duty_fill, Duty::FULL);
    }
    let mut off = 0;
    for _ in 0..30 {
        off += u32::from(output(&config, &mut state, "2", "2") == Output::OFF);
    }
    assert_eq!(off, 30);
    let again = output(&config, &mut state, "2.2", "2");
    let fresh = output(&config, &mut PulseState::at_rest(), "2.2", "2");
    assert_eq!(again, fresh);
}

#[test]
fn an_interrupted_run_gives_no_pulse_and_teaches_nothing() {
    let config = pulses(&Settings::pulses());
    let mut state = PulseState::at_rest();
    assert_eq!(output(&config, &mut state, "6", "2").duty_fill, Duty::FULL);
    state.interrupt();
    for _ in 0..20 {
        assert_eq!(output(&config, &mut state, "2", "2"), Output::OFF);
    }
    let found = output(&config, &mut state, "2.2", "2");
    assert_eq!(
        found,
        output(&config, &mut PulseState::at_rest(), "2.2", "2")
    );
}

/// After a takeover no pulse counts as under way, and what was learnt about the valves stays.
#[test]
fn a_takeover_forgets_the_pulses_under_way_and_keeps_what_was_learnt() {
    let config = pulses(&Settings::pulses());
    let mut state = PulseState::at_rest();
    let first = output(&config, &mut state, "2.2", "2");
    assert_eq!(output(&config, &mut state, "2.2", "2"), Output::OFF);
    let mut taken_over = state.taking_over();
    assert_eq!(output(&config, &mut taken_over, "2.2", "2"), first);
    // Twice without effect: the valve seems to open late, and its pulse gets longer.
    for _ in 0..20 {
        output(&config, &mut state, "2.2", "2");
    }
    let learnt = output(&config, &mut state.taking_over(), "2.2", "2");
    assert!(learnt.duty_fill > first.duty_fill, "{learnt:?} {first:?}");
}

/// Same pressure, other orifice: the smaller one needs the longer pulse.
#[test]
fn the_nearest_orifice_of_the_tables_is_used() {
    let duty = |orifice: &str| {
        let config = pulses(&changed(|pulses| pulses.orifice_mm = lit(orifice)));
        output(&config, &mut PulseState::at_rest(), "2.25", "2").duty_fill
    };
    assert_eq!(duty("1.9"), duty("1.61"));
    assert_eq!(duty("1.3"), duty("1.59"));
    assert_ne!(duty("1.3"), duty("1.9"));
}

/// A later pulse shows less of its flow at the same sample, so the run lasts longer.
#[test]
fn the_command_delay_counts() {
    let first_end = |delay: &str| {
        let config = pulses(&changed(|pulses| pulses.command_delay_ms = lit(delay)));
        let (mut state, mut chamber) = (PulseState::at_rest(), Chamber::at(1.5));
        (0..30)
            .find(|_| {
                let output = pulse_step(
                    &config,
                    &mut state,
                    chamber.input(5.5),
                    CoilSlowness::NOMINAL,
                );
                chamber.drive(output);
                output == Output::OFF
            })
            .expect("the run ends")
    };
    assert!(
        first_end("5") > first_end("25"),
        "{} {}",
        first_end("5"),
        first_end("25")
    );
}

#[test]
fn pulses_with_another_sample_time_than_their_tables_are_refused() {
    for time in ["9.999", "10.001"] {
        let settings = Settings {
            sample_time_ms: lit(time),
            ..Settings::pulses()
        };
        assert!(matches!(
            Config::new(&settings),
            Err(ConfigError::OutOfRange { field: Field::SampleTime, min, max, .. })
                if min == lit("10") && max == lit("10")
        ));
    }
}

/// Every number of the pulses is accepted at its bounds and refused one unit beyond.
#[test]
fn each_number_of_the_pulses_is_held_to_its_range() {
    for field in Field::ALL.into_iter().skip(Field::PulseOrifice as usize) {
        let [min, max] = field.range();
        for (bits, is_allowed) in [
            (min.to_bits(), true),
            (max.to_bits(), true),
            (min.to_bits() - 1, false),
            (max.to_bits() + 1, false),
        ] {
            let mut settings = Settings::pulses();
            assert!(field.set(&mut settings, bits));
            let found = Config::new(&settings);
            assert_eq!(found.is_ok(), is_allowed, "{field} {bits}");
            if let Err(error) = found {
                assert!(error.to_string().starts_with(field.name()), "{error}");
            }
        }
    }
}

proptest! {
    /// Any inputs, any coils: no panic, never both valves, duty cycles within 0 to 100 %.
    #[test]
    fn any_inputs_drive_one_valve_at_most(
        inputs in proptest::collection::vec((any_pressure(), any_pressure()), 1..200),
    ) {
        let config = pulses(&Settings::pulses());
        let mut state = PulseState::at_rest();
        for (reference, pressure) in inputs {
            let found = pulse_step(&config, &mut state, Input { reference, pressure }, CoilSlowness::NOMINAL);
            prop_assert!(found.duty_fill.is_off() || found.duty_vent.is_off());
        }
    }
}
