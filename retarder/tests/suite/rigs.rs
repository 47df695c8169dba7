//! Rigs of several kinds, from a data sheet and a log to the missing effect, with the commands of `docs/your-rig.md`.

use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::{CurrentSampling, Replay, ReplayInput};
use plant_sim::{Command, PlantParameters, Tolerance};

use crate::runner::{Bench, assert_contains};

/// Kind of rig.
struct Kind {
    /// Data sheet, part after part.
    sheet: &'static [&'static str],
    /// Ordinary values in which the rig differs from it.
    truth: &'static [(&'static str, f64)],
    /// Header, interval and duration (ns) of the log.
    header: &'static str,
    interval_ns: u64,
    duration_ns: u64,
    /// Duty cycle, state or command (%) of each pulse.
    pulses_pct: [f64; 6],
    /// That which shuts the vent valve (%).
    vent_shut_pct: f64,
    /// Area of the leak (m²).
    leak_m2: f64,
}

const SHORT_NS: u64 = 24_000_000_000;

const GAS: &str = "
supply_pressure_bar_gauge = 7.1       # gauge, ±0.35
temperature_c = 22                    # ±2
command_delay_ms = 0                  # exact
";
const VALVES: &str = "
fill_C_dm3_per_s_bar = 0.6            # ±15 %
fill_b = 0.3                          # ±0.1
vent_C_dm3_per_s_bar = 0.8            # ±15 %
vent_b = 0.3                          # ±0.1
";
const SWITCHING: &str = "
command_frequency_hz = 50             # exact
fill_opening_delay_ms = 6             # ±25 %
fill_closing_delay_ms = 5             # ±25 %
fill_opening_ramp_ms = 3              # ±25 % and ±1
fill_closing_ramp_ms = 3              # ±25 % and ±1
vent_opening_delay_ms = 6             # ±25 %
vent_closing_delay_ms = 5             # ±25 %
vent_opening_ramp_ms = 3              # ±25 % and ±1
vent_closing_ramp_ms = 3              # ±25 % and ±1
";

/// Steps of the pressure that the controller has to make.
const PROFILE: &str = "time_s,p_ref_bar_gauge\n0,2\n2,4\n4,3\n6,3\n";

/// Leads a rig with a leak from its data sheet to the name of the effect, through `inspect`, on to the plant file with the effect, and to a
/// controller for it.
fn check(kind: &Kind) {
    let bench = Bench::new();
    let run = |line: &str| bench.run(&line.split(' ').collect::<Vec<_>>());
    let sheet = kind.sheet.concat();
    bench.file("my-rig.toml", &sheet);
    let plant = run("parameters --from-datasheet my-rig.toml").ended_with(0);
    bench.file("my-plant.toml", &plant);
    let sheet = PlantParameters::from_datasheet(&sheet, "my-rig.toml").unwrap();
    let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
    let mut rig = sheet.with_effect(leak.with("area_m2", kind.leak_m2));
    for &(name, value) in kind.truth {
        rig.set(name, value, "truth").unwrap();
    }
    for (seed, name) in [(1, "my-log.csv"), (2, "my-check.csv")] {
        bench.file(name, &log(&rig, kind, seed));
        let shown = run(&format!("inspect {name}")).ended_with(0);
        assert_contains(&shown, &["duty_fill", "duty_vent", "p_ch"]);
    }
    let logs = "--log my-log.csv --check my-check.csv";
    let said = run(&format!("diagnose --plant my-plant.toml {logs}")).ended_with(1);
    assert_contains(&said, &["Missing: chamber leak; with it "]);

    let refine = "refine --plant my-plant.toml --add chamber_leak --out my-refined.toml";
    let said = run(&format!("{refine} {logs}")).ended_with(0);
    assert_contains(&said, &["With chamber leak "]);

    let controller = run("tune --plant my-refined.toml").ended_with(0);
    bench.file("my-controller.toml", &controller);
    bench.file("my-profile.csv", PROFILE);
    let files = "--plant my-refined.toml --controller my-controller.toml";
    let said = run(&format!("control {files} --reference my-profile.csv")).ended_with(0);
    assert_contains(&said, &["Required by the thesis"]);
}

/// Returns a log: pulses of several sizes and holds, at pressures up to the supply.
fn log(rig: &PlantParameters, kind: &Kind, seed: u64) -> String {
    let clock = LoggerClock {
        phase_s: 3e-3,
        drift_ppm: 50.0,
    };
    let mut model = Replay::new(rig, CurrentSampling::MeanOfInterval, Tolerance::default());
    let sample_time_ns = rig.ecu.sample_time_ns();
    let mut text = format!("{}\n", kind.header);
    for row in 0..kind.duration_ns / kind.interval_ns {
        let log_ns = row * kind.interval_ns;
        let time_ns = clock.ecu_time_ns(log_ns);
        let sample = time_ns / sample_time_ns;
        let time_s = (sample * sample_time_ns) as f64 * 1e-9;
        let cycle = (time_s / 2.4) as usize;
        let pulse_pct = kind.pulses_pct[(cycle * (1 + seed as usize) + seed as usize) % 6];
        let [fill_pct, vent_pct] = match time_s % 2.4 {
            0.3..0.7 => [pulse_pct, 0.0],
            1.7..2.0 => [0.0, pulse_pct],
            _ => [0.0, 0.0],
        };
        let command = Command {
            duty_fill_pct: fill_pct,
            duty_vent_pct: (kind.vent_shut_pct - vent_pct).abs(),
        };
        let [_, _, p_ch, ..] = model.row(ReplayInput {
            issued_ns: sample * sample_time_ns,
            command: Some(command),
            ..ReplayInput::at(time_ns)
        });
        let noise = ((row * 7919 + seed * 131) % 1009) as f64 / 1009.0 - 0.5;
        let [fill, vent] = [command.duty_fill_pct, command.duty_vent_pct].map(|pct| {
            let is_state = kind.header.contains("state_fill");
            if is_state { pct / 100.0 } else { pct }
        });
        text += &format!(
            "{:.3},{fill},{vent},{:.4}\n",
            log_ns as f64 * 1e-9,
            p_ch + 0.016 * noise
        );
    }
    text
}

#[test]
fn a_pair_of_on_off_valves_is_led_to_its_leak() {
    check(&Kind {
        sheet: &[GAS, VALVES, SWITCHING, "chamber_volume_cm3 = 400  # ±15 %"],
        truth: &[
            ("chamber.volume_m3", 430e-6),
            ("on_off_fill.opening_delay_s", 6.8e-3),
            ("on_off_vent.conductance_dm3_per_s_bar", 0.87),
        ],
        header: "time_s,state_fill,state_vent,p_ch_bar_gauge",
        interval_ns: 10_000_000,
        duration_ns: SHORT_NS,
        pulses_pct: [100.0; 6],
        vent_shut_pct: 0.0,
        leak_m2: 4e-8,
    });
}

#[test]
fn a_hose_that_grows_is_led_to_its_leak() {
    check(&Kind {
        sheet: &[
            GAS,
            VALVES,
            SWITCHING,
            "chamber_volume_cm3 = 350       # ±15 %\n",
            "hose_growth_cm3_per_bar = 60   # ±25 %\n",
        ],
        truth: &[
            ("chamber.growth_m3_per_bar", 70e-6),
            ("on_off_fill.closing_delay_s", 4.4e-3),
        ],
        header: "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge",
        interval_ns: 10_000_000,
        duration_ns: SHORT_NS,
        pulses_pct: [31.0, 45.0, 60.0, 37.0, 77.0, 100.0],
        vent_shut_pct: 0.0,
        leak_m2: 4e-8,
    });
}

#[test]
fn two_chambers_are_led_to_their_leak() {
    check(&Kind {
        sheet: &[
            GAS,
            VALVES,
            SWITCHING,
            "chamber_volume_cm3 = 250       # ±15 %\n",
            "second_volume_cm3 = 200        # ±15 %\n",
            "line_C_dm3_per_s_bar = 0.3     # ±25 %\n",
            "line_b = 0.2                   # ±0.1\n",
        ],
        truth: &[
            ("second_chamber.volume_m3", 215e-6),
            ("second_chamber.conductance_dm3_per_s_bar", 0.34),
        ],
        header: "time_s,duty_fill_pct,duty_vent_pct,p_second_bar_gauge",
        interval_ns: 10_000_000,
        duration_ns: SHORT_NS,
        pulses_pct: [40.0, 45.0, 60.0, 53.0, 77.0, 100.0],
        vent_shut_pct: 0.0,
        leak_m2: 4e-8,
    });
}

#[test]
fn proportional_valves_are_led_to_their_leak() {
    check(&Kind {
        sheet: &[
            GAS,
            VALVES,
            "command_frequency_hz = 100     # exact\n",
            "chamber_volume_cm3 = 400       # ±15 %\n",
            "fill_opens_at_pct = 15         # ±3\n",
            "fill_time_constant_ms = 20     # ±25 %\n",
            "vent_opens_at_pct = 15         # ±3\n",
            "vent_time_constant_ms = 20     # ±25 %\n",
        ],
        truth: &[
            ("proportional_fill.time_constant_s", 23e-3),
            ("proportional_fill.above_line_50_pct", -4.0),
            ("proportional_vent.opens_at_pct", 13.5),
        ],
        header: "time_s,cmd_fill_pct,cmd_vent_pct,p_ch_bar_gauge",
        interval_ns: 5_000_000,
        duration_ns: SHORT_NS,
        pulses_pct: [25.0, 45.0, 60.0, 35.0, 80.0, 100.0],
        vent_shut_pct: 0.0,
        leak_m2: 4e-8,
    });
}

#[test]
fn a_vent_valve_that_a_current_shuts_is_led_to_its_leak() {
    check(&Kind {
        sheet: &[
            "supply_pressure_bar_gauge = 8.4       # regulator, ±0.3\n",
            "command_frequency_hz = 100            # set in the controller, exact\n",
            "command_delay_ms = 15                 # ±25 %\n",
            "supply_voltage_v = 24                 # multimeter, ±3 %\n",
            "chamber_volume_cm3 = 110              # tape measure, ±15 %\n",
            "orifice_fill_mm = 1.9                 # data sheet, ±2 %\n",
            "orifice_vent_mm = 1.9                 # data sheet, ±2 %\n",
            "coil_power_w = 7                      # data sheet, ±5 %\n",
            "fill_valve_opens_at_ma = 206          # tried without pressure, ±5 %\n",
            "vent_valve_shuts_at_ma = 133          # tried without pressure, ±5 %\n",
        ],
        truth: &[
            ("chamber.volume_m3", 118e-6),
            ("flow.discharge_vent", 0.66),
            ("ecu.command_delay_s", 16.5e-3),
        ],
        header: "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge",
        interval_ns: 5_000_000,
        duration_ns: SHORT_NS,
        pulses_pct: [31.0, 37.0, 45.0, 33.0, 53.0, 60.0],
        vent_shut_pct: 100.0,
        leak_m2: 1e-8,
    });
}

#[test]
fn a_value_that_no_part_has_is_noted() {
    let bench = Bench::new();
    let volume = "chamber_volume_cm3 = 250\nspring_n_per_mm = 3\n";
    bench.file("my-rig.toml", &[volume, GAS, VALVES, SWITCHING].concat());
    let ran = bench.run(&["parameters", "--from-datasheet", "my-rig.toml"]);
    let expected = "note: my-rig.toml:2: `spring_n_per_mm` is not used: no part of this plant has such a value\n";
    assert_contains(&ran.err, &[expected]);
    assert_contains(&ran.ended_with(0), &["[on_off_fill]"]);
}
