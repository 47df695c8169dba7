//! Device at the end of its link, used by a host.

use ecu::black_box::words;
use ecu::calibration::{SETTING_COUNT, SETTINGS_DIGEST, SIGNALS_DIGEST, SettingId, SettingValues};
use ecu::controller::Field;
use ecu::device::EcuDevice;
use ecu::store::{RamFlash, SettingsStore};
use ecu::{Ecu, EcuField, Inputs};
use hil_protocol::{
    Answer, DeviceSession, Event, HostSession, Identity, ImageIdentity, Refusal, Reply, Request,
    ResetCause, SettingsSource, SignalIds, Values, name,
};

use crate::support::{defaults, healthy, with_gain};

const FLASH: usize = SettingsStore::<RamFlash<0>>::BYTES;

type Device = EcuDevice<RamFlash<FLASH>, [u32; words(64)]>;

struct Bench {
    device: Device,
    device_session: DeviceSession,
    host: HostSession,
    identity: Identity,
}

fn device(flash: RamFlash<FLASH>, cause: ResetCause) -> Device {
    let image = ImageIdentity {
        board: name("process"),
        version: name("0"),
        build: 0,
        signals: 0,
        settings: 0,
    };
    EcuDevice::start(image, &defaults(), flash, [0; words(64)], cause)
}

impl Bench {
    fn new() -> Self {
        Self::with(device(RamFlash::new(), ResetCause::PowerOn), true)
    }

    fn with(mut device: Device, lock_step: bool) -> Self {
        let mut device_session = DeviceSession::new(1);
        let mut host = HostSession::new(1);
        let hello = host.open(1, lock_step).unwrap().to_vec();
        let answer = device_session.receive_frame(&hello, &mut device).unwrap();
        let Ok(Some(Event::Opened(identity))) = host.receive_frame(answer) else {
            panic!("no session");
        };
        Self {
            device,
            device_session,
            host,
            identity,
        }
    }

    /// Connects another host.
    fn reopened(self) -> Self {
        Self::with(self.device, true)
    }

    fn ask(&mut self, request: Request) -> Reply {
        let frame = self.host.request(&request).unwrap().to_vec();
        let answer = self
            .device_session
            .receive_frame(&frame, &mut self.device)
            .unwrap();
        match self.host.receive_frame(answer) {
            Ok(Some(Event::Reply(reply))) => reply,
            other => panic!("{request:?}: {other:?}"),
        }
    }

    fn sample(&mut self, sample: u32) -> Answer {
        match self.ask(Request::Sample(healthy(sample))) {
            Reply::Sample { answer, .. } => answer,
            other => panic!("sample {sample}: {other:?}"),
        }
    }

    fn write(&mut self, values: &SettingValues) -> Reply {
        self.ask(Request::Write {
            first: 0,
            values: Values::from_slice(values.as_array()).unwrap(),
        })
    }

    fn settings(&mut self) -> SettingValues {
        let Reply::Values { first: 0, values } = self.ask(Request::Settings { first: 0 }) else {
            panic!("no settings");
        };
        SettingValues::from_array(values.as_slice().try_into().unwrap())
    }
}

/// Returns an ECU without link, store and black box.
fn twin() -> Ecu {
    Ecu::new(defaults().config(), ResetCause::PowerOn)
}

fn step(twin: &mut Ecu, sample: u32) -> Answer {
    Answer {
        sample,
        actuators: twin.sample(&Inputs::from(healthy(sample))).into(),
        telemetry: twin.telemetry(),
    }
}

#[test]
fn the_identity_names_the_image_its_tables_and_its_settings() {
    let bench = Bench::new();
    let Identity {
        image,
        reset_cause,
        settings_source,
        settings_digest,
        ..
    } = bench.identity;
    assert_eq!(
        (image.board, image.signals, image.settings),
        (name("process"), SIGNALS_DIGEST, SETTINGS_DIGEST)
    );
    assert_eq!(reset_cause, ResetCause::PowerOn);
    assert_eq!(settings_source, SettingsSource::DefaultsNeverSaved);
    assert_eq!(
        settings_digest,
        SettingValues::of(defaults().settings()).digest()
    );
}

/// All operations of a calibration tool, before every sample: the control task is not affected.
#[test]
fn full_calibration_traffic_changes_no_bit_of_the_control_task() {
    let mut bench = Bench::new();
    let mut twin = twin();
    let mut wrong = with_gain(20);
    wrong.set(SettingId::Controller(Field::Gain), -1);
    for sample in 0..300 {
        let ids = SignalIds::from_slice(&[1, 2, 3, (sample % 20) as u16]).unwrap();
        assert_eq!(bench.ask(Request::Measure { ids }), Reply::Done);
        bench.settings();
        assert_eq!(bench.write(&wrong), Reply::Done);
        let digest = wrong.digest();
        assert!(matches!(
            bench.ask(Request::Apply { digest }),
            Reply::Refused(Refusal::OutOfRange { .. })
        ));
        assert_eq!(bench.ask(Request::Discard), Reply::Done);
        bench.ask(Request::BlackBox {
            page: (sample % 4) as u16,
        });
        bench.ask(Request::Signal { id: 5 });
        bench.ask(Request::Counters);
        assert_eq!(bench.sample(sample), step(&mut twin, sample));
    }
}

#[test]
fn a_change_takes_effect_whole_with_the_sample_after_it_was_applied() {
    let mut bench = Bench::new();
    let mut twin = twin();
    let mut new = with_gain(50);
    new.set(SettingId::Controller(Field::Tolerance), 1 << 14);
    for sample in 0..200 {
        if sample == 60 {
            assert_eq!(bench.write(&new), Reply::Done);
        }
        if sample == 100 {
            let digest = new.digest();
            assert_eq!(bench.ask(Request::Apply { digest }), Reply::Done);
            twin.retune(new.checked().unwrap().config());
        }
        assert_eq!(
            bench.sample(sample),
            step(&mut twin, sample),
            "sample {sample}"
        );
    }
    assert_eq!(bench.settings(), new);
    let bench = bench.reopened();
    assert_eq!(bench.identity.settings_source, SettingsSource::Link);
}

/// Every kind of incomplete change by a host is refused.
#[test]
fn a_torn_change_changes_nothing_and_says_so() {
    let built_in = SettingValues::of(defaults().settings());
    let mut new = built_in;
    for id in [
        SettingId::Controller(Field::Gain),
        SettingId::Controller(Field::Tolerance),
        SettingId::Ecu(EcuField::CoilCurrentMax),
    ] {
        new.set(id, new.get(id) + 1);
    }
    for written in 0..SETTING_COUNT {
        let mut bench = Bench::new();
        let values = Values::from_slice(&new.as_array()[..written]).unwrap();
        bench.ask(Request::Write { first: 0, values });
        let digest = new.digest();
        let Reply::Refused(Refusal::Torn { expected, found }) =
            bench.ask(Request::Apply { digest })
        else {
            panic!("{written} of {SETTING_COUNT} settings were applied");
        };
        assert_eq!(expected, digest);
        assert_ne!(found, digest);
        assert_eq!(bench.settings(), built_in);
    }
}

#[test]
fn what_another_host_has_left_half_written_is_gone() {
    let mut bench = Bench::new();
    bench.write(&with_gain(50));
    let mut bench = bench.reopened();
    let digest = SettingValues::of(defaults().settings()).digest();
    assert_eq!(bench.ask(Request::Apply { digest }), Reply::Done);
    assert_eq!(bench.settings(), SettingValues::of(defaults().settings()));
}

#[test]
fn an_impossible_change_changes_nothing_and_names_field_value_and_bound() {
    let mut bench = Bench::new();
    let mut twin = twin();
    let mut wrong = with_gain(50);
    wrong.set(SettingId::Controller(Field::Tolerance), 11 << 16);
    bench.write(&wrong);
    let digest = wrong.digest();
    assert_eq!(
        bench.ask(Request::Apply { digest }),
        Reply::Refused(Refusal::OutOfRange {
            id: SettingId::Controller(Field::Tolerance).number(),
            value: 11 << 16,
            min: 0,
            max: 10 << 16,
            bound_by: None
        })
    );
    for sample in 0..100 {
        assert_eq!(bench.sample(sample), step(&mut twin, sample));
    }
    assert_eq!(bench.settings(), SettingValues::of(defaults().settings()));
}

#[test]
fn settings_are_saved_at_rest_and_the_next_start_has_them() {
    let mut bench = Bench::new();
    let new = with_gain(50);
    bench.write(&new);
    let digest = new.digest();
    bench.ask(Request::Apply { digest });
    assert_eq!(bench.ask(Request::Save), Reply::Done);
    let flash = bench.device.into_flash();
    let mut bench = Bench::with(device(flash, ResetCause::PowerOn), true);
    let source = SettingsSource::Stored {
        copy: 0,
        sequence: 0,
        other_damaged: false,
    };
    assert_eq!(bench.identity.settings_source, source);
    assert_eq!(bench.settings(), new);
    // Back to the built-in settings.
    assert_eq!(bench.ask(Request::Defaults), Reply::Done);
    let digest = SettingValues::of(defaults().settings()).digest();
    assert_eq!(bench.ask(Request::Apply { digest }), Reply::Done);
    assert_eq!(bench.settings(), SettingValues::of(defaults().settings()));
}

#[test]
fn settings_are_not_saved_while_a_valve_is_in_use() {
    let mut bench = Bench::new();
    for sample in 0..20 {
        bench.sample(sample);
        assert_eq!(bench.ask(Request::Save), Reply::Done, "sample {sample}");
    }
    // From here the reference is 3 bar.
    for sample in 21..100 {
        bench.sample(sample);
        assert_eq!(
            bench.ask(Request::Save),
            Reply::Refused(Refusal::ValvesInUse)
        );
    }
}

#[test]
fn measured_signals_come_with_each_sample() {
    let mut bench = Bench::new();
    let ids = SignalIds::from_slice(&[0, 2, 10, 17]).unwrap();
    bench.ask(Request::Measure { ids });
    for sample in 0..100 {
        let Reply::Sample { answer, measured } = bench.ask(Request::Sample(healthy(sample))) else {
            panic!("no answer");
        };
        let expected = [
            sample.cast_signed(),
            healthy(sample).reference.unwrap(),
            answer.telemetry.control_signal,
            i32::from(answer.telemetry.mode),
        ];
        assert_eq!(measured, expected);
        for (id, value) in [0, 2, 10, 17].into_iter().zip(measured) {
            let values = Values::from_slice(&[value]).unwrap();
            assert_eq!(
                bench.ask(Request::Signal { id }),
                Reply::Values { first: id, values }
            );
        }
    }
}

#[test]
fn a_signal_that_does_not_exist_is_refused_and_the_others_go_on() {
    let mut bench = Bench::new();
    let ids = SignalIds::from_slice(&[0]).unwrap();
    bench.ask(Request::Measure { ids });
    let refused = Reply::Refused(Refusal::UnknownSignal { id: 99, last: 19 });
    let ids = SignalIds::from_slice(&[1, 99]).unwrap();
    assert_eq!(bench.ask(Request::Measure { ids }), refused);
    assert_eq!(bench.ask(Request::Signal { id: 99 }), refused);
    let Reply::Sample { measured, .. } = bench.ask(Request::Sample(healthy(4))) else {
        panic!("no answer");
    };
    assert_eq!(measured, [4]);
}

#[test]
fn in_free_run_measured_signals_are_sent_unasked() {
    let mut bench = Bench::with(device(RamFlash::new(), ResetCause::PowerOn), false);
    assert_eq!(bench.device.measured(), None);
    let ids = SignalIds::from_slice(&[0, 2]).unwrap();
    bench.ask(Request::Measure { ids });
    let sensors = healthy(30);
    bench.device.sample(30, &Inputs::from(sensors));
    let Some(Reply::Measured { sample, values }) = bench.device.measured() else {
        panic!("nothing to send");
    };
    assert_eq!((sample, values.as_slice()), (30, [30, 3 << 16].as_slice()));
}

#[test]
fn the_black_box_is_read_over_the_link_and_outlives_a_reset() {
    let mut bench = Bench::new();
    let mut answers = Vec::new();
    for sample in 0..40 {
        answers.push(bench.sample(sample));
    }
    assert_eq!(
        bench.ask(Request::Restart {
            cause: ResetCause::Watchdog
        }),
        Reply::Done
    );
    let mut records = Vec::new();
    for page in 0..3 {
        let Reply::BlackBox(page) = bench.ask(Request::BlackBox { page }) else {
            panic!("no page {page}");
        };
        assert_eq!((page.pages, page.torn), (3, 0));
        records.extend(page.records);
    }
    assert_eq!(records.len(), 40);
    for (record, answer) in records.iter().zip(&answers) {
        let sensors = healthy(answer.sample);
        assert_eq!(record.number, answer.sample);
        assert_eq!(
            (record.reference, record.pressure),
            (sensors.reference, sensors.pressure)
        );
        assert_eq!(record.duty_fill, answer.actuators.duty_fill);
        assert_eq!(record.control_signal, answer.telemetry.control_signal);
    }
    assert_eq!(bench.ask(Request::ClearBlackBox), Reply::Done);
    let Reply::BlackBox(page) = bench.ask(Request::BlackBox { page: 0 }) else {
        panic!("no page");
    };
    assert!(page.records.is_empty());
}

#[test]
fn a_restart_is_a_start_with_the_settings_in_effect() {
    let mut bench = Bench::new();
    let new = with_gain(50);
    bench.write(&new);
    let digest = new.digest();
    bench.ask(Request::Apply { digest });
    for sample in 0..77 {
        bench.sample(sample);
    }
    let cause = ResetCause::PowerOn;
    bench.ask(Request::Restart { cause });
    let mut twin = Ecu::new(new.checked().unwrap().config(), cause);
    for sample in 0..77 {
        assert_eq!(bench.sample(sample), step(&mut twin, sample));
    }
}

#[test]
fn what_only_the_machine_can_do_is_refused_here() {
    let mut bench = Bench::new();
    for request in [Request::Log, Request::Reset] {
        assert_eq!(bench.ask(request), Reply::Refused(Refusal::Unsupported));
    }
}
