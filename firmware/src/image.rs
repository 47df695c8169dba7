//! From reset on: the control task, and what the link asks for between two samples.

use ecu::{Ecu, EcuConfig, EcuSettings, Inputs, Outputs, ResetCause, safe_outputs};
use hil_protocol::{
    Answer, Device, DeviceSession, FRAME_MAX, Identity, ImageIdentity, LogBytes, Measured, Name,
    Refusal, Reply, Request, SettingsSource, VERSION,
};

use crate::board::{Board, Pace, Received};
use crate::event::Event;
use crate::retained::Farewell;

/// Whether the image goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Life {
    /// It does.
    GoesOn,
    /// A host asked for a reset, and the answer is out: the coils are off, reset the machine.
    Ends,
}

/// The whole image on its board.
pub struct Image<B: Board> {
    session: DeviceSession,
    control: Control<B>,
    buffer: [u8; FRAME_MAX],
}

/// Turns of the main loop between two times that the watchdog is fed while a host sets the pace: some milliseconds.
const TURNS_BETWEEN_FEEDS: u32 = 4096;

const BENCH: EcuConfig = match EcuConfig::new(&EcuSettings::bench()) {
    Ok(config) => config,
    Err(_) => panic!("the built-in settings are impossible"),
};

impl<B: Board> Image<B> {
    /// The first thing after a reset.
    pub fn start(mut board: B) -> Self {
        board.coils_off();
        let start = board.retained().start();
        let hardware = board.reset_cause();
        let cause = start.farewell.map_or(hardware, Farewell::cause);
        board.log(Event::Started {
            boot: start.boot,
            cause,
            farewell: start.farewell,
        });
        let source = SettingsSource::DefaultsNeverSaved;
        board.log(Event::Settings { source });
        let last_us = board.now_us();
        board.take_ticks();
        Self {
            session: DeviceSession::new(start.boot),
            control: Control {
                board,
                ecu: Ecu::new(BENCH, cause),
                cause,
                source,
                lock_step: false,
                ends: false,
                sample: 0,
                last_us,
                idle_turns: 0,
            },
            buffer: [0; FRAME_MAX],
        }
    }

    /// One turn of the main loop: a sample if its time has come, then at most one byte or frame of the link.
    pub fn turn(&mut self) -> Life {
        self.control.board.background();
        self.control.timer();
        let Some(received) = self.control.board.receive(&mut self.buffer) else {
            return Life::GoesOn;
        };
        let reply = match received {
            Received::Byte(byte) => self.session.receive_byte(byte, &mut self.control),
            Received::Frame(frame) => self.session.receive_frame(frame, &mut self.control),
        };
        if let Some(frame) = reply {
            self.control.board.send(frame);
        }
        if self.control.ends {
            self.control.board.coils_off();
            return Life::Ends;
        }
        Life::GoesOn
    }

    /// The board, for what only it can do.
    pub fn board(&mut self) -> &mut B {
        &mut self.control.board
    }
}

/// All that a request can reach.
struct Control<B: Board> {
    board: B,
    ecu: Ecu,
    cause: ResetCause,
    source: SettingsSource,
    lock_step: bool,
    ends: bool,
    sample: u32,
    last_us: u32,
    idle_turns: u32,
}

impl<B: Board> Control<B> {
    /// The control task by the machine's own time.
    fn timer(&mut self) {
        if self.lock_step {
            self.idle_turns = self.idle_turns.wrapping_add(1);
            if self.idle_turns.is_multiple_of(TURNS_BETWEEN_FEEDS) {
                self.board.feed_watchdog(Pace::Host);
            }
            return;
        }
        let ticks = self.board.take_ticks();
        if ticks == 0 {
            return;
        }
        let now_us = self.board.now_us();
        let elapsed_us = now_us.wrapping_sub(self.last_us);
        self.last_us = now_us;
        let inputs = self.board.measure(elapsed_us);
        self.sample(&inputs);
        if ticks > 1 {
            self.board.log(Event::TicksMissed {
                sample: self.sample,
                missed: ticks - 1,
            });
        }
        self.board.feed_watchdog(Pace::Timer);
    }

    fn sample(&mut self, inputs: &Inputs) -> Outputs {
        let (mode, faults) = (self.ecu.mode(), self.ecu.faults());
        let outputs = self.ecu.sample(inputs);
        self.board.drive(outputs);
        self.sample = self.sample.wrapping_add(1);
        if (mode, faults) != (self.ecu.mode(), self.ecu.faults()) {
            self.board.log(Event::Supervisor {
                sample: self.sample,
                mode: self.ecu.mode(),
                faults: self.ecu.faults(),
            });
        }
        outputs
    }
}

impl<B: Board> Device for Control<B> {
    fn open(&mut self, lock_step: bool) -> Identity {
        self.lock_step = lock_step && self.board.may_simulate();
        self.board.feed_watchdog(if self.lock_step {
            Pace::Host
        } else {
            Pace::Timer
        });
        self.board.log(Event::Session { lock_step });
        if !self.lock_step {
            self.board.end_simulation();
        }
        self.board.drive(safe_outputs());
        Identity {
            version: VERSION,
            boot: 0,
            image: ImageIdentity {
                board: Name::try_from(B::NAME).unwrap_or_default(),
                version: Name::try_from(env!("CARGO_PKG_VERSION")).unwrap_or_default(),
                build: 0,
                signals: 0,
                settings: 0,
            },
            reset_cause: self.cause,
            settings_source: self.source,
            settings_digest: 0,
        }
    }

    fn answer(&mut self, request: &Request) -> Reply {
        match request {
            Request::Sample(_) if !self.lock_step => Reply::Refused(Refusal::NotInLockStep),
            Request::Sample(sensors) => {
                self.board.simulate(sensors);
                let inputs = self.board.measure(sensors.elapsed_us);
                let outputs = self.sample(&inputs);
                Reply::Sample {
                    answer: Answer {
                        sample: sensors.sample,
                        actuators: outputs.into(),
                        telemetry: self.ecu.telemetry(),
                    },
                    measured: Measured::new(),
                }
            }
            Request::Log => {
                let mut bytes = LogBytes::new();
                let lost = self.board.take_log(&mut bytes);
                Reply::Log { bytes, lost }
            }
            Request::Reset => {
                self.board.retained().say(Farewell::Requested);
                self.ends = true;
                Reply::Done
            }
            _ => Reply::Refused(Refusal::Unsupported),
        }
    }
}
