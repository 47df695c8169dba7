//! Starts and ends of the image, and the information that one run stores for the next.

use ecu::EcuSettings;
use ecu::calibration::SettingValues;
use firmware::{Event, NextAction, Pace, ResetReason, Retained};
use hil_protocol::{BlackBoxStatus, Reply, Request, ResetCause, SettingsSource};

use crate::bench::{Deed, Memory};

#[test]
fn the_first_thing_after_a_reset_is_to_switch_the_coils_off() {
    let mut memory = Memory::cold();
    assert_eq!(memory.start().board().deeds.first(), Some(&Deed::CoilsOff));
}

/// A loop that hangs before its first sample is detected as well.
#[test]
fn the_watchdog_is_started_before_the_first_sample() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    assert_eq!(machine.board().count(Deed::Feed(Pace::Timer)), 1);
    assert_eq!(machine.board().count(Deed::Measure), 0);
}

#[test]
fn a_cold_start_says_that_the_supply_came_and_that_nothing_was_saved() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    let started = Event::Started {
        boot: 0,
        cause: ResetCause::PowerOn,
        reset_reason: None,
    };
    assert_eq!(machine.board().events.first(), Some(&started));
    let identity = machine.hello(false);
    assert_eq!(identity.reset_cause, ResetCause::PowerOn);
    assert_eq!(identity.settings_source, SettingsSource::DefaultsNeverSaved);
    assert_eq!(identity.image.board, "test");
    assert_eq!(identity.image.build, 4711);
}

/// The handlers of panic, fault and watchdog store their reason and reset the machine.
#[test]
fn the_next_life_reports_why_the_last_one_ended() {
    for (reset_reason, cause) in [
        (ResetReason::Panic { line: 42 }, ResetCause::Panic),
        (ResetReason::Exception { pc: 0x1234 }, ResetCause::Exception),
        (ResetReason::Watchdog, ResetCause::Watchdog),
    ] {
        let mut memory = Memory::cold();
        memory.start().ticks(3);
        Retained::new(&memory.retained).say(reset_reason);
        let identity = memory.start().hello(false);
        assert_eq!((identity.reset_cause, identity.boot), (cause, 1));
        // The second run stored no reason.
        assert_eq!(memory.start().hello(false).reset_cause, ResetCause::Unknown);
    }
}

#[test]
fn a_reset_by_request_waits_until_its_answer_has_left_with_the_coils_off() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    machine.board().is_sending = true;
    machine.done(&Request::Reset);
    machine.board().deeds.clear();
    machine.board().tick();
    for _ in 0..3 {
        assert_eq!(machine.image.turn(), NextAction::Continue);
    }
    assert_eq!(machine.board().deeds, [Deed::CoilsOff; 3]);
    machine.board().is_sending = false;
    assert_eq!(machine.image.turn(), NextAction::Reset);
    let identity = memory.start().hello(false);
    assert_eq!(
        (identity.reset_cause, identity.boot),
        (ResetCause::Software, 1)
    );
}

#[test]
fn saved_settings_are_those_of_the_next_start() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(true);
    let mut settings = EcuSettings::bench();
    settings.supervision.battery_max_v -= settings.supervision.battery_max_v / 8;
    let values = SettingValues::of(&settings);
    machine.write_all(&values);
    machine.done(&Request::Apply {
        digest: values.digest(),
    });
    machine.done(&Request::Save);
    let identity = memory.start().hello(false);
    assert_eq!(identity.settings_digest, values.digest());
    assert!(matches!(
        identity.settings_source,
        SettingsSource::Stored { sequence: 0, .. }
    ));
}

#[test]
fn the_black_box_is_kept_over_a_warm_reset_and_lost_with_the_supply() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.ticks(20);
    machine.board().inputs.pressure = None;
    machine.ticks(10);
    Retained::new(&memory.retained).say(ResetReason::Watchdog);

    let mut machine = memory.start();
    machine.hello(false);
    let Reply::BlackBox(page) = machine.ask(&Request::BlackBox { page: 0 }) else {
        panic!("no page");
    };
    assert!(matches!(page.status, BlackBoxStatus::Frozen { .. }));
    assert!(
        page.records
            .iter()
            .take(16)
            .all(|record| record.pressure == Some(127))
    );

    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    let Reply::BlackBox(page) = machine.ask(&Request::BlackBox { page: 0 }) else {
        panic!("no page");
    };
    assert!(page.records.is_empty());
}
