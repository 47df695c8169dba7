//! Frames of every kind of message, with the shortest and the longest possible ones.

use hil_protocol::frame::{Direction, Header, encode};
use hil_protocol::heapless::Vec as List;
use hil_protocol::{
    Actuators, Answer, BlackBoxPage, BlackBoxRecord, BlackBoxStatus, FRAME_MAX, Identity,
    ImageIdentity, LinkCounters, Refusal, Reply, Request, ResetCause, Sensors, SettingsSource,
    Telemetry, VERSION, name,
};

pub(crate) fn sensors(sample: u32) -> Sensors {
    Sensors {
        sample,
        elapsed_us: 10_000,
        reference: Some(3 << 16),
        pressure: Some(1234),
        current_fill_ma: None,
        current_vent_ma: Some(310),
        battery_mv: Some(24_000),
    }
}

fn longest_answer() -> Answer {
    Answer {
        sample: u32::MAX,
        actuators: Actuators {
            duty_fill: u32::MAX,
            duty_vent: u32::MAX,
        },
        telemetry: Telemetry {
            control_signal: i32::MIN,
            controller_state: [i32::MIN; 6],
            mode: u8::MAX,
            faults: u32::MAX,
            ecu_digest: u32::MAX,
        },
    }
}

fn full<T: Clone, const N: usize>(value: T) -> List<T, N> {
    let mut list = List::new();
    while list.push(value.clone()).is_ok() {}
    list
}

pub(crate) fn requests() -> Vec<Request> {
    vec![
        Request::Hello {
            version: VERSION,
            lock_step: true,
        },
        Request::Sample(sensors(7)),
        Request::Signal { id: 3 },
        Request::Measure { ids: List::new() },
        Request::Measure {
            ids: full(u16::MAX),
        },
        Request::Settings { first: 0 },
        Request::Write {
            first: 2,
            values: List::from_slice(&[655_360, -1]).unwrap(),
        },
        Request::Write {
            first: u16::MAX,
            values: full(i32::MIN),
        },
        Request::Apply {
            digest: 0xDEAD_BEEF,
        },
        Request::Discard,
        Request::Defaults,
        Request::Save,
        Request::BlackBox { page: 300 },
        Request::ClearBlackBox,
        Request::Log,
        Request::Counters,
        Request::Restart {
            cause: ResetCause::Watchdog,
        },
        Request::Reset,
    ]
}

pub(crate) fn replies() -> Vec<Reply> {
    let long_name = name("an-emulated-board-of-some-length");
    let record = BlackBoxRecord {
        number: u32::MAX,
        reference: Some(i32::MIN),
        pressure: Some(u16::MAX),
        duty_fill: u32::MAX,
        duty_vent: u32::MAX,
        control_signal: i32::MIN,
        mode: u8::MAX,
        faults: u32::MAX,
    };
    let counters = LinkCounters {
        accepted: u32::MAX,
        corrupt: u32::MAX,
        unknown: u32::MAX,
        echoed: u32::MAX,
        duplicate: u32::MAX,
        stale: u32::MAX,
        foreign: u32::MAX,
        skipped: u32::MAX,
        repeated: u32::MAX,
    };
    let mut all = vec![
        Reply::Identity(Identity {
            version: VERSION,
            boot: u32::MAX,
            image: ImageIdentity {
                board: long_name.clone(),
                version: long_name,
                build: u32::MAX,
                signals: u32::MAX,
                settings: u32::MAX,
            },
            reset_cause: ResetCause::Brownout,
            settings_source: SettingsSource::Stored {
                copy: 1,
                sequence: u32::MAX,
                other_damaged: true,
            },
            settings_digest: u32::MAX,
        }),
        Reply::Sample {
            answer: longest_answer(),
            measured: List::new(),
        },
        Reply::Sample {
            answer: longest_answer(),
            measured: full(i32::MIN),
        },
        Reply::Values {
            first: 0,
            values: full(i32::MIN),
        },
        Reply::Done,
        Reply::BlackBox(BlackBoxPage {
            status: BlackBoxStatus::Frozen {
                number: u32::MAX,
                faults: u32::MAX,
            },
            page: u16::MAX,
            pages: u16::MAX,
            torn: u16::MAX,
            records: full(record),
        }),
        Reply::Log {
            bytes: full(0xA5),
            lost: u32::MAX,
        },
        Reply::Counters(LinkCounters::ZERO),
        Reply::Counters(counters),
        Reply::Measured {
            sample: u32::MAX,
            values: full(i32::MIN),
        },
    ];
    all.extend(refusals().map(Reply::Refused));
    all
}

pub(crate) fn refusals() -> impl Iterator<Item = Refusal> {
    [
        Refusal::Version { device: u16::MAX },
        Refusal::NoSession,
        Refusal::Skipped {
            expected: u32::MAX,
            found: u32::MAX,
        },
        Refusal::UnknownMessage,
        Refusal::NotInLockStep,
        Refusal::UnknownSignal {
            id: u16::MAX,
            last: u16::MAX,
        },
        Refusal::UnknownSetting {
            id: u16::MAX,
            last: u16::MAX,
        },
        Refusal::Torn {
            expected: u32::MAX,
            found: u32::MAX,
        },
        Refusal::OutOfRange {
            id: u16::MAX,
            value: i32::MIN,
            min: i32::MIN,
            max: i32::MIN,
            bound_by: Some(u16::MAX),
        },
        Refusal::Product {
            id: u16::MAX,
            value: i64::MIN,
            min: i64::MIN,
            max: i64::MIN,
        },
        Refusal::ValvesInUse,
        Refusal::Storage,
        Refusal::UnknownPage {
            page: u16::MAX,
            pages: u16::MAX,
        },
        Refusal::Unsupported,
    ]
    .into_iter()
}

/// Returns every kind of frame, including the delimiter.
pub(crate) fn frames() -> Vec<Vec<u8>> {
    let to_device = Header {
        direction: Direction::ToDevice,
        session: 0x0102_0304,
        sequence: 1_000_000,
    };
    let to_host = Header {
        direction: Direction::ToHost,
        ..to_device
    };
    let mut buffer = [0; FRAME_MAX];
    let mut all = Vec::new();
    for request in requests() {
        all.push(encode(to_device, &request, &mut buffer).unwrap().to_vec());
    }
    for reply in replies() {
        all.push(encode(to_host, &reply, &mut buffer).unwrap().to_vec());
    }
    all
}

/// Checks that no kind is missing: the first byte of a message is the number of its variant, and each number occurs.
#[test]
fn every_kind_of_message_is_among_them() {
    use std::collections::BTreeSet;

    let first_bytes = |messages: Vec<Vec<u8>>| -> BTreeSet<u8> {
        messages.iter().map(|bytes| bytes[0]).collect()
    };
    let bytes = |message: &dyn Fn(&mut [u8; FRAME_MAX]) -> Vec<u8>| message(&mut [0; FRAME_MAX]);
    let requests = requests()
        .iter()
        .map(|request| bytes(&|buffer| postcard::to_slice(request, buffer).unwrap().to_vec()))
        .collect();
    let replies = replies()
        .iter()
        .map(|reply| bytes(&|buffer| postcard::to_slice(reply, buffer).unwrap().to_vec()))
        .collect();
    let refusals = refusals()
        .map(|refusal| bytes(&|buffer| postcard::to_slice(&refusal, buffer).unwrap().to_vec()))
        .collect();
    // The next number belongs to no variant.
    assert_eq!(first_bytes(requests), (0..16).collect());
    assert!(postcard::from_bytes::<Request>(&[16; 64]).is_err());
    assert_eq!(first_bytes(replies), (0..9).collect());
    assert!(postcard::from_bytes::<Reply>(&[9; 64]).is_err());
    assert_eq!(first_bytes(refusals), (0..14).collect());
    assert!(postcard::from_bytes::<Refusal>(&[14; 64]).is_err());
}
