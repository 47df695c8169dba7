//! Emulator and image as a process that ends, hangs or is killed.

use std::process::Command;
use std::time::Duration;

use hil_harness::link::{Framed, Link as _, LinkError, Pace, Patience, TransportError};
use hil_harness::qemu::{Clock, QemuLink, Wire};
use hil_harness::{DeviceUnderTest as _, Scenario, run};
use hil_protocol::Request;

use super::{image, short_scenario, started};

fn signal(signal: &str, process: u32) -> bool {
    let command = format!("kill -{signal} {process} 2>/dev/null");
    let status = Command::new("sh").args(["-c", &command]).status();
    status.is_ok_and(|status| status.success())
}

/// Stops the process and returns when each of its threads has stopped; `kill` does not wait for that.
fn stop(process: u32) {
    assert!(signal("STOP", process));
    // The state follows the name in brackets: "8088 (qemu-system-arm) T ...".
    let stopped = |thread: std::fs::DirEntry| {
        let stat = std::fs::read_to_string(thread.path().join("stat"));
        stat.is_ok_and(|stat| stat.rsplit(") ").next().is_some_and(|s| s.starts_with('T')))
    };
    let threads = || std::fs::read_dir(format!("/proc/{process}/task")).unwrap();
    while !threads().all(|thread| stopped(thread.unwrap())) {
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn the_emulator_ends_with_the_value_that_started_it() {
    let device = started(Wire::Mailbox);
    let process = device.link().transport().emulator().process_id();
    assert!(signal("0", process), "it runs");
    drop(device);
    assert!(!signal("0", process), "it still runs");
}

#[test]
fn an_emulator_that_was_killed_is_an_error_that_says_so() {
    let mut device = started(Wire::Mailbox);
    assert!(signal(
        "KILL",
        device.link().transport().emulator().process_id()
    ));
    let error = device.link_mut().ask(&Request::Counters).unwrap_err();
    let LinkError::Transport { error: ended, .. } = &error else {
        panic!("{error}");
    };
    assert!(matches!(ended, TransportError::Ended { .. }), "{error}");
}

#[test]
fn a_hang_is_an_error_with_the_last_lines_of_the_log() {
    for wire in [Wire::Mailbox, Wire::Uart] {
        let image = image();
        let link = QemuLink::start(&image, wire, Clock::Host).unwrap();
        let patience = Patience {
            reply: Duration::from_millis(300),
            tries: 10,
            start: Duration::from_secs(30),
        };
        let mut framed = Framed::open(link, Pace::LockStep, patience, image.into_log()).unwrap();
        let lines = framed.take_log().unwrap();
        let last = lines.last().expect("an image says that it started");
        // The machine stops, like one whose clock has failed.
        stop(framed.transport().emulator().process_id());
        let error = framed.ask(&Request::Counters).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("no reply to request Counters"), "{text}");
        assert!(text.contains(last.as_str()), "{text}");
    }
}

#[test]
fn the_log_is_decoded_and_has_the_start_and_a_change_of_mode() {
    let mut device = started(Wire::Mailbox);
    let log = run(&short_scenario(), &mut device).unwrap().log;
    let text = log.join("\n");
    for expected in ["Started", "Settings", "Session", "Running"] {
        assert!(text.contains(expected), "{expected}:\n{text}");
    }
}

#[test]
fn an_image_that_was_used_starts_from_power_on_again() {
    let mut used = started(Wire::Mailbox);
    let cut_off = Scenario {
        duration_samples: 37,
        ..Scenario::built_in("hold").unwrap()
    };
    run(&cut_off, &mut used).unwrap();
    let again = run(&short_scenario(), &mut used).unwrap();
    let fresh = run(&short_scenario(), &mut started(Wire::Mailbox)).unwrap();
    assert_eq!(again.exchanges, fresh.exchanges);
    assert!(used.take_log().unwrap().is_empty());
}
