//! Link that loses, repeats, reorders, delays, flips, cuts and stalls frames, between sides that are reset in
//! mid-frame. An accepted answer is equal to that of a device without a link, bit for bit. Otherwise there is no
//! answer, and an error names the reason.

mod wire;

use hil_protocol::{
    DeviceSession, Event, HostError, HostSession, LinkCounters, Reply, Request, ResetCause,
};

use crate::messages::sensors;
use crate::stepper::Stepper;
use wire::{Amplitudes, Random, Wire};

/// Number of faulty exchanges per test; all tests of this file together have 10⁶.
const FAULTY_EXCHANGES: u32 = 125_000;

/// Number of samples of one run.
const SAMPLES: u32 = 200;

/// Maximum number of tries of a frame: enough for all but the worst links and longest stalls.
const TRIES: u32 = 20;

/// Deadline for an answer, in ticks; frames take up to 20.
const DEADLINE: u64 = 12;

struct Bench {
    random: Random,
    amplitudes: Amplitudes,
    now: u64,
    to_device: Wire,
    to_host: Wire,
    host: HostSession,
    device_session: DeviceSession,
    device: Stepper,
    boot: u32,
    nonce: u32,
    tally: Tally,
}

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    exchanges: u32,
    faulty: u32,
    complete: u32,
    ended: u32,
    unanswered: u32,
    resets: u32,
    host: LinkCounters,
    device: LinkCounters,
}

impl Bench {
    fn new(seed: u64) -> Self {
        Self {
            random: Random::new(seed),
            amplitudes: Amplitudes::default(),
            now: 0,
            to_device: Wire::default(),
            to_host: Wire::default(),
            host: HostSession::new(TRIES),
            device_session: DeviceSession::new(0),
            device: Stepper::new(),
            boot: 0,
            nonce: 0,
            tally: Tally::default(),
        }
    }

    /// Runs a new session: a defined start, then samples. The wire still contains frames of the runs before.
    fn run(&mut self) -> Result<(), HostError> {
        self.amplitudes = Amplitudes::random(&mut self.random);
        self.nonce += 1;
        self.tally.host = sum(self.tally.host, self.host.counters());
        self.host = HostSession::new(TRIES);
        let hello = self.host.open(self.nonce, true)?.to_vec();
        assert!(matches!(self.exchange(hello)?, Event::Opened(_)));
        let restart = Request::Restart {
            cause: ResetCause::PowerOn,
        };
        let restart = self.host.request(&restart)?.to_vec();
        assert_eq!(self.exchange(restart)?, Event::Reply(Reply::Done));
        let mut twin = Stepper::new();
        for sample in 0..SAMPLES {
            let request = Request::Sample(sensors(sample));
            let frame = self.host.request(&request)?.to_vec();
            let expected = Reply::Sample {
                answer: twin.step(&sensors(sample)),
                measured: Default::default(),
            };
            assert_eq!(self.exchange(frame)?, Event::Reply(expected));
        }
        Ok(())
    }

    fn exchange(&mut self, frame: Vec<u8>) -> Result<Event, HostError> {
        let faults = self.to_device.faults + self.to_host.faults + self.tally.resets;
        self.tally.exchanges += 1;
        let result = self.until_answered(frame);
        if self.to_device.faults + self.to_host.faults + self.tally.resets > faults {
            self.tally.faulty += 1;
        }
        result
    }

    fn until_answered(&mut self, mut frame: Vec<u8>) -> Result<Event, HostError> {
        loop {
            self.to_device
                .send(self.now, &frame, self.amplitudes, &mut self.random);
            let deadline = self.now + DEADLINE;
            while self.now < deadline {
                self.now += 1;
                while let Some(bytes) = self.to_device.due(self.now) {
                    self.device_receives(&bytes);
                }
                while let Some(bytes) = self.to_host.due(self.now) {
                    if let Some(event) = self.host_receives(&bytes)? {
                        return Ok(event);
                    }
                }
            }
            frame = self.host.again()?.to_vec();
        }
    }

    fn device_receives(&mut self, bytes: &[u8]) {
        let reset_at = self.random.chance(self.amplitudes.reset).then(|| {
            let length = bytes.len() as u64 + 1;
            self.random.below(length) as usize
        });
        for (index, &byte) in bytes.iter().enumerate() {
            if reset_at == Some(index) {
                self.reset_device();
            }
            if let Some(answer) = self.device_session.receive_byte(byte, &mut self.device) {
                let answer = answer.to_vec();
                self.to_host
                    .send(self.now, &answer, self.amplitudes, &mut self.random);
            }
        }
    }

    fn host_receives(&mut self, bytes: &[u8]) -> Result<Option<Event>, HostError> {
        for &byte in bytes {
            if let Some(event) = self.host.receive_byte(byte)? {
                return Ok(Some(event));
            }
        }
        Ok(None)
    }

    fn reset_device(&mut self) {
        self.tally.resets += 1;
        self.tally.device = sum(self.tally.device, self.device_session.counters());
        self.boot += 1;
        self.device_session = DeviceSession::new(self.boot);
        self.device = Stepper::new();
    }
}

fn sum(a: LinkCounters, b: LinkCounters) -> LinkCounters {
    LinkCounters {
        accepted: a.accepted + b.accepted,
        corrupt: a.corrupt + b.corrupt,
        unknown: a.unknown + b.unknown,
        echoed: a.echoed + b.echoed,
        duplicate: a.duplicate + b.duplicate,
        stale: a.stale + b.stale,
        foreign: a.foreign + b.foreign,
        skipped: a.skipped + b.skipped,
        repeated: a.repeated + b.repeated,
    }
}

fn check(seed: u64) {
    let mut bench = Bench::new(seed);
    while bench.tally.faulty < FAULTY_EXCHANGES {
        match bench.run() {
            Ok(()) => bench.tally.complete += 1,
            Err(HostError::Ended { .. }) => bench.tally.ended += 1,
            Err(HostError::Unanswered { tries, .. }) => {
                assert_eq!(tries, TRIES);
                bench.tally.unanswered += 1;
            }
            Err(error) => panic!("seed {seed}: {error}"),
        }
    }
    bench.reset_device();
    let tally = bench.tally;
    println!("seed {seed}: {tally:?}");
    // Check of the test itself: every kind of end and of damage occurred and was counted on the side that detects it.
    assert!(tally.complete > 100 && tally.ended > 100 && tally.unanswered > 10);
    for counters in [tally.host, tally.device] {
        assert!(counters.accepted > 100_000 && counters.corrupt > 10_000);
        assert!(counters.stale > 1_000 && counters.foreign > 100);
        // No undamaged frame is unknown, none is sent back, and a waiting host skips no request.
        let LinkCounters {
            unknown,
            echoed,
            skipped,
            ..
        } = counters;
        assert_eq!((unknown, echoed, skipped), (0, 0, 0));
    }
    assert!(tally.device.duplicate > 10_000 && tally.host.repeated > 10_000);
}

macro_rules! seeds {
    ($($name:ident: $seed:literal,)*) => {$(
        #[test]
        fn $name() {
            check($seed);
        }
    )*};
}

seeds! {
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_1: 1,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_2: 2,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_3: 3,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_4: 4,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_5: 5,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_6: 6,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_7: 7,
    no_silent_wrong_answer_in_125_000_faulty_exchanges_of_seed_8: 8,
}
