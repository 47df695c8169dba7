//! Timing of the duty cycles: in lock step in the same sample, by the timer on time under any load of the link.

use ecu::EcuSettings;
use ecu::calibration::{SETTING_COUNT, SettingValues};
use hil_harness::Actuators;
use hil_harness::DeviceUnderTest as _;
use hil_harness::ecu_under_test;
use hil_harness::link::{Framed, Link as _, Pace};
use hil_harness::qemu::{self, Clock, QemuLink, Wire};
use hil_harness::sensor_walk::SensorWalk;
use hil_harness::signals;
use hil_harness::wire::FULL_DUTY;
use hil_protocol::{Reply, Request, SignalIds};

use super::{image, started};

#[test]
fn the_duty_cycles_of_a_sample_are_at_the_outputs_when_its_answer_comes() {
    let mut device = started(Wire::Mailbox);
    let settings = EcuSettings::bench();
    device.start(&settings).unwrap();
    let mut walk = SensorWalk::new(11, settings.vent_valve);
    let mut driven = Actuators::OFF;
    let mut energised = 0;
    for _ in 0..2000 {
        driven = device.exchange(&walk.next(driven)).unwrap().actuators;
        let at_pins = device.link().transport().compare_values();
        for (duty, compare) in [driven.duty_fill, driven.duty_vent]
            .into_iter()
            .zip(at_pins)
        {
            let wanted = f64::from(duty) / f64::from(FULL_DUTY) * 65_535.0;
            assert!(
                (wanted - f64::from(compare)).abs() <= 1.0,
                "{wanted} and {compare}"
            );
            energised += u32::from(compare > 0);
        }
    }
    assert!(energised > 200, "{energised}");
}

fn signal(link: &mut Framed<QemuLink>, name: &str) -> i32 {
    let (id, _) = signals::named(name).expect("a signal of the image");
    match link.ask(&Request::Signal { id }).unwrap() {
        Reply::Values { values, .. } => values[0],
        other => panic!("{other:?}"),
    }
}

/// Maximum load by a calibration tool: sixteen signals of every sample, and one request after the other.
#[test]
fn by_the_timer_no_sample_is_missed_or_late_under_full_calibration_traffic() {
    const SAMPLES: u32 = 500;
    let mut link = qemu::open(image(), Wire::Uart, Clock::Instructions, Pace::Timer)
        .unwrap_or_else(|error| panic!("{error}"));
    let ids = SignalIds::from_iter(0..16);
    ecu_under_test::carry_out(&mut link, &Request::Measure { ids }).unwrap();
    let settings = SettingValues::of(&EcuSettings::bench());
    let (first, _) = link.measured().unwrap();
    let (mut last, mut requests) = (first, 0);
    while last - first < SAMPLES {
        match requests % 6 {
            0 => ecu_under_test::set(&mut link, &settings).unwrap(),
            1 => drop(link.ask(&Request::BlackBox { page: 0 }).unwrap()),
            2 => drop(link.ask(&Request::Settings { first: 0 }).unwrap()),
            3 => drop(link.take_log().unwrap()),
            4 => drop(link.ask(&Request::Counters).unwrap()),
            _ => drop(link.ask(&Request::Signal { id: 0 }).unwrap()),
        }
        requests += 1;
        while let Some((sample, values)) = link.take_measured() {
            assert_eq!(sample, last + 1, "a sample was not measured");
            assert_eq!(values.len(), 16);
            last = sample;
        }
    }
    let [start_us, drive_us, interval_us, missed] = [
        "start_latency_max",
        "drive_latency_max",
        "interval_error_max",
        "ticks_missed",
    ]
    .map(|name| signal(&mut link, name));
    println!(
        "{SAMPLES} samples, {requests} requests of up to {SETTING_COUNT} settings: tick to \
             sample at most {start_us} us, to duty cycles {drive_us} us, jitter {interval_us} us, {missed} missed"
    );
    assert!(requests > 100, "{requests} requests are no traffic");
    assert_eq!(missed, 0);
    // Duty cycles of a sample are output long before the next one, and jitter is a small part of the period.
    assert!(drive_us < 2_000, "{drive_us} us");
    assert!(interval_us < 1_000, "{interval_us} us");
}

/// Compares the host's table of the image's signals with the image.
#[test]
fn every_signal_that_the_host_knows_is_one_of_the_image_and_there_are_no_more() {
    let mut device = started(Wire::Mailbox);
    let mut last = 0;
    for (id, signal) in signals::all() {
        let reply = device.link_mut().ask(&Request::Signal { id });
        assert!(
            matches!(reply, Ok(Reply::Values { .. })),
            "{signal:?}: {reply:?}"
        );
        last = id;
    }
    let beyond = Request::Signal { id: last + 1 };
    assert!(device.link_mut().ask(&beyond).is_err());
}
