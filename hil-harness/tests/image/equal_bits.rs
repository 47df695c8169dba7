//! Comparison of output and state of the image with the ECU in process, at every sample.

use std::time::Duration;

use ecu::{EcuSettings, Fault, FaultSet, Mode};
use hil_harness::ecu_under_test::EcuUnderTest;
use hil_harness::link::{Disturbed, Framed, Link as _, Pace, Patience};
use hil_harness::qemu::{Clock, QemuLink, Wire};
use hil_harness::random::{Draws, Random, Stream};
use hil_harness::scenario::BUILT_IN;
use hil_harness::sensor_walk::SensorWalk;
use hil_harness::{
    Actuators, Compared, DeviceUnderTest, InProcess, controller_file, run, run_in_process,
};
use hil_protocol::{Reply, Request};

use super::settings::{combinations, drawn};
use super::{ImageUnderTest, beside_in_process, image, short_scenario, started};

type Pair = Compared<InProcess, ImageUnderTest>;

#[test]
fn over_every_scenario_with_every_shipped_controller() {
    let mut pair = beside_in_process(Wire::Mailbox);
    for built_in in BUILT_IN {
        for controller in [
            controller_file::recommended(),
            controller_file::thesis(),
            controller_file::pulses_1_9_mm(),
        ] {
            let scenario = built_in.scenario().controlled_by(controller);
            let run = run(&scenario, &mut pair).unwrap_or_else(|error| panic!("{error}"));
            assert!(
                run.device.contains("QEMU emulator version"),
                "{}",
                run.device
            );
        }
    }
    println!(
        "{} samples over all scenarios: the same bits",
        pair.samples()
    );
}

/// Runs a walk from switching on, with these settings.
fn walk(pair: &mut Pair, settings: &EcuSettings, seed: u64, samples: u32, seen: &mut Seen) {
    pair.start(settings)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut walk = SensorWalk::new(seed, settings.vent_valve);
    let mut driven = Actuators::OFF;
    for _ in 0..samples {
        let answer = pair
            .exchange(&walk.next(driven))
            .unwrap_or_else(|error| panic!("seed {seed}, {settings:?}: {error}"));
        driven = answer.actuators;
        seen.modes[usize::from(answer.telemetry.mode)] += 1;
        seen.faults = seen
            .faults
            .union(FaultSet::from_bits(answer.telemetry.faults));
    }
}

#[derive(Debug)]
struct Seen {
    modes: [u64; Mode::ALL.len()],
    faults: FaultSet,
}

impl Seen {
    const NOTHING: Self = Self {
        modes: [0; Mode::ALL.len()],
        faults: FaultSet::NONE,
    };
}

#[test]
fn over_a_random_walk_of_a_million_samples_with_random_settings() {
    let mut pair = beside_in_process(Wire::Mailbox);
    let mut draws = Draws::new(Random::new(2026, Stream::RigSeed));
    let mut seen = Seen::NOTHING;
    while pair.samples() < 1_000_000 {
        let settings = drawn(&mut draws);
        let samples = 500 + draws.below(4000);
        walk(&mut pair, &settings, draws.bits(), samples, &mut seen);
    }
    println!(
        "{} samples of random walk: the same bits; {seen:?}",
        pair.samples()
    );
    assert!(seen.modes.iter().all(|count| *count > 1000), "{seen:?}");
    let missed: Vec<Fault> = Fault::ALL
        .into_iter()
        .filter(|fault| !seen.faults.contains(*fault))
        .collect();
    assert_eq!(missed, [Fault::MemoryDamaged], "no sensor can do that");
}

#[test]
fn with_every_combination_of_the_controllers_choices() {
    let mut pair = beside_in_process(Wire::Mailbox);
    let mut seen = Seen::NOTHING;
    let all = combinations();
    for (seed, settings) in all.iter().enumerate() {
        walk(&mut pair, settings, seed as u64, 64, &mut seen);
    }
    println!(
        "{} combinations, {} samples: the same bits; {seen:?}",
        all.len(),
        pair.samples()
    );
    assert!(all.len() >= 1000);
    assert!(seen.modes[Mode::Running as usize] > 10_000, "{seen:?}");
}

/// The real wire is about four times as fast as real time, so this test is short.
#[test]
fn over_the_uart_byte_by_byte() {
    let mut pair = beside_in_process(Wire::Uart);
    let run = run(&short_scenario(), &mut pair).unwrap_or_else(|error| panic!("{error}"));
    assert!(run.device.contains("UART"), "{}", run.device);
}

/// Both wires carry the same frames; only the session's number differs between two sessions.
#[test]
fn over_mailbox_and_uart_alike() {
    let [mailbox, uart] =
        [Wire::Mailbox, Wire::Uart].map(|wire| run(&short_scenario(), &mut started(wire)).unwrap());
    assert_eq!(mailbox.exchanges, uart.exchanges);
}

#[test]
fn over_a_bad_wire() {
    let image = image();
    let link = QemuLink::start(&image, Wire::Mailbox, Clock::Host).unwrap();
    let patience = Patience {
        reply: Duration::from_millis(20),
        tries: 50,
        start: Duration::from_secs(30),
    };
    let wire = Disturbed::new(link, 3, 30);
    let framed = Framed::open(wire, Pace::LockStep, patience, image.into_log());
    let mut device = EcuUnderTest::at(framed.unwrap_or_else(|error| panic!("{error}")));
    let run = run(&short_scenario(), &mut device).unwrap();
    assert_eq!(
        run.exchanges,
        run_in_process(&short_scenario()).unwrap().exchanges
    );
    let [to_device, _] = device.link().transport().disturbances();
    let Ok(Reply::Counters(seen)) = device.link_mut().ask(&Request::Counters) else {
        panic!("counters");
    };
    assert!(
        seen.corrupt >= to_device.damaged / 2 && to_device.damaged > 0,
        "{seen:?}"
    );
    assert!(
        seen.duplicate >= to_device.repeated && to_device.repeated > 0,
        "{seen:?}"
    );
    assert!(seen.stale > 0, "{seen:?}");
}

/// The black boxes are equal as well: an accident is analysed from their records.
#[test]
fn in_the_black_box_after_a_fault() {
    let mut devices = (InProcess::new(), started(Wire::Mailbox));
    let settings = EcuSettings::bench();
    let mut walk = SensorWalk::new(5, settings.vent_valve);
    devices.0.start(&settings).unwrap();
    devices.1.start(&settings).unwrap();
    let mut driven = Actuators::OFF;
    for _ in 0..3000 {
        let sensors = walk.next(driven);
        driven = devices.0.exchange(&sensors).unwrap().actuators;
        devices.1.exchange(&sensors).unwrap();
    }
    let mut page = 0;
    loop {
        let request = Request::BlackBox { page };
        let expected = devices.0.link_mut().ask(&request).unwrap();
        let found = devices.1.link_mut().ask(&request).unwrap();
        assert_eq!(found, expected);
        let Reply::BlackBox(found) = found else {
            panic!("{found:?}");
        };
        page += 1;
        if page == found.pages {
            break;
        }
    }
    assert!(page > 10, "{page} pages");
}
