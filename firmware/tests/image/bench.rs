//! Board without hardware, and a host at the other end of its link.

use std::collections::VecDeque;
use std::sync::atomic::AtomicU32;

use ecu::calibration::SettingValues;
use ecu::store::RamFlash;
use ecu::{Inputs, Outputs, safe_outputs};
use firmware::{
    BLACK_BOX_WORDS, Board, Event, Image, NextAction, Pace, RETAINED_WORDS, Received, Retained,
};
use hil_protocol::{
    FRAME_MAX, HostSession, Identity, LogBytes, Reply, Request, ResetCause, Sensors, SignalIds,
};

/// T_ECU (µs).
pub(crate) const PERIOD_US: u32 = 10_000;

/// Call of the board by the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Deed {
    CoilsOff,
    Measure,
    Drive(Outputs),
    Feed(Pace),
    Send,
}

/// Memory that survives a reset of the machine.
pub(crate) struct Memory {
    pub(crate) retained: [AtomicU32; RETAINED_WORDS],
    flash: RamFlash<16_384>,
    black_box: Box<[u32; BLACK_BOX_WORDS]>,
}

impl Memory {
    /// Creates the memory as after power-on.
    pub(crate) fn cold() -> Self {
        Self {
            retained: [const { AtomicU32::new(0x5a5a_5a5a) }; RETAINED_WORDS],
            flash: RamFlash::new(),
            black_box: Box::new([0x5a5a_5a5a; BLACK_BOX_WORDS]),
        }
    }

    /// Resets the machine; the hardware reports no cause.
    pub(crate) fn start(&mut self) -> Machine<'_> {
        let board = TestBoard {
            retained: &self.retained,
            clock_us: 0,
            tick_us: 0,
            ticks: 0,
            inputs: healthy(),
            simulated: None,
            jumper: true,
            is_sending: false,
            outputs: safe_outputs(),
            deeds: Vec::new(),
            events: Vec::new(),
            incoming: VecDeque::new(),
            sent: VecDeque::new(),
        };
        Machine {
            image: Image::start(board, &mut self.flash, &mut *self.black_box),
            host: HostSession::new(1),
            sessions: 0,
            unsolicited: Vec::new(),
        }
    }
}

/// Returns the inputs of a healthy rig at rest: reference 0 bar, pressure 0 bar, no current.
pub(crate) fn healthy() -> Inputs {
    Inputs::from(sensors(0))
}

/// Returns the same inputs as a host would send them.
pub(crate) fn sensors(sample: u32) -> Sensors {
    Sensors {
        sample,
        elapsed_us: PERIOD_US,
        reference: Some(0),
        pressure: Some(127),
        current_fill_ma: Some(0),
        current_vent_ma: Some(0),
        battery_mv: Some(24_000),
    }
}

pub(crate) struct TestBoard<'a> {
    retained: &'a [AtomicU32; RETAINED_WORDS],
    pub(crate) clock_us: u32,
    tick_us: u32,
    ticks: u32,
    pub(crate) inputs: Inputs,
    simulated: Option<Inputs>,
    pub(crate) jumper: bool,
    pub(crate) is_sending: bool,
    pub(crate) outputs: Outputs,
    pub(crate) deeds: Vec<Deed>,
    pub(crate) events: Vec<Event>,
    incoming: VecDeque<Vec<u8>>,
    sent: VecDeque<Vec<u8>>,
}

impl TestBoard<'_> {
    /// Advances the time to the next tick of the sample timer.
    pub(crate) fn tick(&mut self) {
        self.clock_us = self.tick_us.wrapping_add(PERIOD_US);
        self.tick_us = self.clock_us;
        self.ticks += 1;
    }

    /// Advances the time to this time after the last tick.
    pub(crate) fn wait_us(&mut self, since_tick_us: u32) {
        self.clock_us = self.tick_us.wrapping_add(since_tick_us);
    }

    pub(crate) fn count(&self, deed: Deed) -> usize {
        self.deeds.iter().filter(|&&done| done == deed).count()
    }
}

impl Board for TestBoard<'_> {
    const NAME: &'static str = "test";

    fn build(&self) -> u32 {
        4711
    }

    fn coils_off(&mut self) {
        self.deeds.push(Deed::CoilsOff);
        self.outputs = safe_outputs();
    }

    fn reset_cause(&mut self) -> ResetCause {
        ResetCause::Unknown
    }

    fn retained(&self) -> Retained<'_> {
        Retained::new(self.retained)
    }

    fn now_us(&self) -> u32 {
        self.clock_us
    }

    fn take_ticks(&mut self) -> u32 {
        std::mem::take(&mut self.ticks)
    }

    fn since_tick_us(&self) -> u32 {
        self.clock_us.wrapping_sub(self.tick_us)
    }

    fn feed_watchdog(&mut self, pace: Pace) {
        self.deeds.push(Deed::Feed(pace));
    }

    fn may_simulate(&mut self) -> bool {
        self.jumper
    }

    fn simulate(&mut self, sensors: &Sensors) {
        self.simulated = Some(Inputs::from(*sensors));
    }

    fn end_simulation(&mut self) {
        self.simulated = None;
    }

    fn measure(&mut self, elapsed_us: u32) -> Inputs {
        self.deeds.push(Deed::Measure);
        Inputs {
            elapsed_us,
            ..self.simulated.unwrap_or(self.inputs)
        }
    }

    fn drive(&mut self, outputs: Outputs) {
        self.deeds.push(Deed::Drive(outputs));
        self.outputs = outputs;
    }

    fn receive<'a>(&mut self, buffer: &'a mut [u8; FRAME_MAX]) -> Option<Received<'a>> {
        let frame = self.incoming.pop_front()?;
        buffer[..frame.len()].copy_from_slice(&frame);
        Some(Received::Frame(&buffer[..frame.len()]))
    }

    fn send(&mut self, frame: &[u8]) {
        self.deeds.push(Deed::Send);
        self.sent.push_back(frame.to_vec());
    }

    fn is_sending(&self) -> bool {
        self.is_sending
    }

    fn log(&mut self, event: Event) {
        self.events.push(event);
    }

    fn take_log(&mut self, bytes: &mut LogBytes) -> u32 {
        bytes.extend_from_slice(b"log").unwrap();
        7
    }
}

type TestImage<'a> = Image<TestBoard<'a>, &'a mut RamFlash<16_384>, &'a mut [u32; BLACK_BOX_WORDS]>;

/// Running image with a host at its link.
pub(crate) struct Machine<'a> {
    pub(crate) image: TestImage<'a>,
    host: HostSession,
    sessions: u32,
    /// Unsolicited messages.
    pub(crate) unsolicited: Vec<Reply>,
}

impl<'a> Machine<'a> {
    pub(crate) fn board(&mut self) -> &mut TestBoard<'a> {
        self.image.board()
    }

    /// Advances to the next tick and runs one turn of the main loop.
    pub(crate) fn tick(&mut self) {
        self.board().tick();
        assert_eq!(self.image.turn(), NextAction::Continue);
        self.hear();
    }

    /// Runs a number of samples by the timer.
    pub(crate) fn ticks(&mut self, count: u32) {
        (0..count).for_each(|_| self.tick());
    }

    /// Runs a number of samples by request, of a rig at rest, from this number on.
    pub(crate) fn samples(&mut self, from: u32, count: u32) {
        for sample in from..from + count {
            let reply = self.ask(&Request::Sample(sensors(sample)));
            assert!(matches!(reply, Reply::Sample { .. }), "{reply:?}");
        }
    }

    pub(crate) fn hello(&mut self, lock_step: bool) -> Identity {
        self.sessions += 1;
        let frame = self.host.open(self.sessions, lock_step).unwrap().to_vec();
        match self.exchange(frame) {
            Some(hil_protocol::Event::Opened(identity)) => identity,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn ask(&mut self, request: &Request) -> Reply {
        let frame = self.host.request(request).unwrap().to_vec();
        match self.exchange(frame) {
            Some(hil_protocol::Event::Reply(reply)) => reply,
            other => panic!("{request:?}: {other:?}"),
        }
    }

    /// Sends a request without waiting for the answer.
    pub(crate) fn say(&mut self, request: &Request) {
        let frame = self.host.request(request).unwrap().to_vec();
        self.board().incoming.push_back(frame);
    }

    pub(crate) fn done(&mut self, request: &Request) {
        assert_eq!(self.ask(request), Reply::Done, "{request:?}");
    }

    pub(crate) fn measure(&mut self, ids: &[u16]) -> Reply {
        self.ask(&Request::Measure {
            ids: SignalIds::from_slice(ids).unwrap(),
        })
    }

    pub(crate) fn write_all(&mut self, values: &SettingValues) {
        for (index, chunk) in values.as_array().chunks(16).enumerate() {
            self.done(&Request::Write {
                first: 16 * index as u16,
                values: chunk.iter().copied().collect(),
            });
        }
    }

    fn exchange(&mut self, frame: Vec<u8>) -> Option<hil_protocol::Event> {
        self.board().incoming.push_back(frame);
        let _ = self.image.turn();
        self.hear()
    }

    /// Returns the answer to the host; other messages are stored.
    fn hear(&mut self) -> Option<hil_protocol::Event> {
        let mut answer = None;
        while let Some(frame) = self.board().sent.pop_front() {
            match self.host.receive_frame(&frame).unwrap() {
                Some(hil_protocol::Event::Unsolicited(reply)) => self.unsolicited.push(reply),
                other => answer = other,
            }
        }
        answer
    }
}
