//! Control task: one sample of the ECU, started by the sample timer or by request, between the board's inputs and its
//! coils.

use controller::Duty;
use ecu::device::EcuDevice;
use ecu::{FaultSet, Inputs, Mode, Outputs, safe_outputs};
use embedded_storage::nor_flash::NorFlash;
use hil_protocol::{
    Actuators, Device, Identity, LogBytes, Measured, Refusal, Reply, Request, Sensors, SignalIds,
    Values,
};

use crate::board::Board;
use crate::event::Event;
use crate::measurement::Measurement;
use crate::pace::Pace;
use crate::punctuality::{FIRST_SIGNAL, LAST_SIGNAL, PERIOD_US, Punctuality};
use crate::retained::ResetReason;

/// Duration at the end of each period (µs) in which no request is begun, so that none is in progress at the tick. The
/// longest request applies settings: 20 500 instructions, 0.8 ms on the slowest board.
const QUIET_US: u32 = 1_000;

/// Number of turns of the main loop between two reads of the clock while a host sets the pace: about a millisecond.
const TURNS_PER_LOOK: u32 = 4096;

/// Timeout of a host that sets the pace (µs): after this time without a request for a sample the coils are switched
/// off.
const SILENCE_MAX_US: u32 = 1_000_000;

/// ECU on its board.
///
/// ```text
///                    Hello with lock step, simulated inputs allowed
///  by the sample  ────────────────────────────────────────────────►  by request of a host: simulated inputs,
///  timer, 10 ms   ◄────────────────────────────────────────────────  coils off after a second without one
///                    Hello without
/// ```
/// At each change of the pace the ECU's logic restarts: measured values from before the change are not used after it. A
/// host that only observes, without lock step, has no influence.
pub(crate) struct ControlTask<B, F, M> {
    pub(crate) board: B,
    ecu: EcuDevice<F, M>,
    pace: Pace,
    /// Whether a host requested a reset.
    pub(crate) ends: bool,
    /// Number of the next sample by the timer.
    sample: u32,
    /// Time of the last sample (µs).
    last_us: u32,
    /// Number of turns of the loop while a host sets the pace.
    turns: u32,
    /// Last logged mode and faults; `None` since the logic started, so that the first sample logs them.
    logged: Option<(Mode, FaultSet)>,
    punctuality: Punctuality,
    measurement: Measurement,
}

impl<B: Board, F: NorFlash, M: AsRef<[u32]> + AsMut<[u32]>> ControlTask<B, F, M> {
    /// Creates the task. From now on the sample timer and the watchdog run.
    pub(crate) fn new(mut board: B, ecu: EcuDevice<F, M>) -> Self {
        board.take_ticks();
        board.feed_watchdog(Pace::Timer);
        Self {
            last_us: board.now_us(),
            logged: None,
            board,
            ecu,
            pace: Pace::Timer,
            ends: false,
            sample: 0,
            turns: 0,
            punctuality: Punctuality::new(),
            measurement: Measurement::new(),
        }
    }

    /// Returns whether the next tick is so near that a request begun now might still be in progress at the tick.
    pub(crate) fn is_quiet_time(&self) -> bool {
        self.pace == Pace::Timer && self.board.since_tick_us() >= PERIOD_US - QUIET_US
    }

    /// Runs a sample if it is due. Returns the signals of it that a host measures, if any.
    pub(crate) fn turn(&mut self) -> Option<Reply> {
        match self.pace {
            Pace::Timer => self.tick(),
            Pace::Host => {
                self.watch_the_host();
                None
            }
        }
    }

    fn tick(&mut self) -> Option<Reply> {
        let ticks = self.board.take_ticks();
        if ticks == 0 {
            return None;
        }
        let missed = ticks.saturating_sub(1);
        let now_us = self.board.now_us();
        self.punctuality
            .begin(now_us, self.board.since_tick_us(), missed);
        let inputs = self.board.measure(now_us.wrapping_sub(self.last_us));
        self.last_us = now_us;
        let sample = self.sample;
        self.sample = sample.wrapping_add(1);
        let actuators = self.ecu.sample(sample, &inputs).actuators;
        self.drive(actuators);
        self.punctuality.driven(self.board.since_tick_us());
        self.log_supervisor(sample);
        if missed > 0 {
            self.board.log(Event::TicksMissed { sample, missed });
        }
        // The watchdog is fed only here, so that a task that hangs anywhere in a sample is reset.
        self.board.feed_watchdog(Pace::Timer);
        self.measured(sample)
    }

    /// Returns the signals that a host measures of each sample by the timer.
    fn measured(&self, sample: u32) -> Option<Reply> {
        if self.measurement.is_empty() {
            return None;
        }
        let of_the_ecu = match self.ecu.measured() {
            Some(Reply::Measured { values, .. }) => values,
            _ => Measured::new(),
        };
        Some(Reply::Measured {
            sample,
            values: self.measurement.merged(&of_the_ecu, &self.punctuality),
        })
    }

    /// Feeds the watchdog periodically, and switches the coils off if the host is silent.
    fn watch_the_host(&mut self) {
        self.turns = self.turns.wrapping_add(1);
        if !self.turns.is_multiple_of(TURNS_PER_LOOK) {
            return;
        }
        self.board.feed_watchdog(Pace::Host);
        if self.board.now_us().wrapping_sub(self.last_us) > SILENCE_MAX_US {
            self.board.coils_off();
            self.last_us = self.board.now_us();
        }
    }

    /// Runs a sample on request of a host. Its values pass through converter and driver like measured ones.
    fn sample_by_request(&mut self, sensors: &Sensors) -> Reply {
        if self.pace == Pace::Timer {
            return Reply::Refused(Refusal::NotInLockStep);
        }
        self.last_us = self.board.now_us();
        self.board.simulate(sensors);
        let inputs = self.board.measure(sensors.elapsed_us);
        let measured = Request::Sample(as_sensors(sensors.sample, &inputs));
        match self.ecu.answer(&measured) {
            Reply::Sample { answer, measured } => {
                self.drive(answer.actuators);
                self.log_supervisor(sensors.sample);
                Reply::Sample {
                    answer,
                    measured: self.measurement.merged(&measured, &self.punctuality),
                }
            }
            other => other,
        }
    }

    /// Changes the source of the pace.
    fn change_pace(&mut self, pace: Pace) {
        if pace == self.pace {
            return;
        }
        self.pace = pace;
        self.board.drive(safe_outputs());
        if pace == Pace::Timer {
            self.board.end_simulation();
        }
        let cause = self.ecu.reset_cause();
        self.ecu.answer(&Request::Restart { cause });
        self.logged = None;
        self.board.take_ticks();
        self.last_us = self.board.now_us();
        self.board.feed_watchdog(pace);
    }

    /// Returns the value of a signal of the image.
    fn signal(&self, id: u16) -> Reply {
        let Some(value) = self.punctuality.signal(id) else {
            let last = LAST_SIGNAL;
            return Reply::Refused(Refusal::UnknownSignal { id, last });
        };
        Reply::Values {
            first: id,
            values: Values::from_array([value]),
        }
    }

    fn measure(&mut self, ids: &SignalIds) -> Reply {
        let measurement = match Measurement::of(ids, &self.punctuality) {
            Ok(measurement) => measurement,
            Err(refusal) => return Reply::Refused(refusal),
        };
        let ids = measurement.of_the_ecu();
        let reply = self.ecu.answer(&Request::Measure { ids });
        if reply == Reply::Done {
            self.measurement = measurement;
        }
        reply
    }

    fn drive(&mut self, actuators: Actuators) {
        let duty = |bits: u32| Duty::saturating_from_bits(bits.cast_signed());
        self.board.drive(Outputs {
            duty_fill: duty(actuators.duty_fill),
            duty_vent: duty(actuators.duty_vent),
        });
    }

    /// Logs mode and faults of the supervisor, if they changed.
    fn log_supervisor(&mut self, sample: u32) {
        let (mode, faults) = (self.ecu.ecu().mode(), self.ecu.ecu().faults());
        if self.logged != Some((mode, faults)) {
            self.logged = Some((mode, faults));
            self.board.log(Event::Supervisor {
                sample,
                mode,
                faults,
            });
        }
    }
}

impl<B: Board, F: NorFlash, M: AsRef<[u32]> + AsMut<[u32]>> Device for ControlTask<B, F, M> {
    fn open(&mut self, lock_step: bool) -> Identity {
        let pace = if lock_step && self.board.may_simulate() {
            Pace::Host
        } else {
            Pace::Timer
        };
        self.change_pace(pace);
        self.punctuality = Punctuality::new();
        self.measurement = Measurement::new();
        self.board.log(Event::Session { pace: self.pace });
        self.ecu.open(lock_step)
    }

    fn answer(&mut self, request: &Request) -> Reply {
        match request {
            Request::Sample(sensors) => self.sample_by_request(sensors),
            Request::Signal { id } if *id >= FIRST_SIGNAL => self.signal(*id),
            Request::Measure { ids } => self.measure(ids),
            Request::Log => {
                let mut bytes = LogBytes::new();
                let lost = self.board.take_log(&mut bytes);
                Reply::Log { bytes, lost }
            }
            Request::Reset => {
                self.board.retained().say(ResetReason::Requested);
                self.ends = true;
                Reply::Done
            }
            Request::Restart { .. } => {
                self.board.drive(safe_outputs());
                self.logged = None;
                self.ecu.answer(request)
            }
            _ => self.ecu.answer(request),
        }
    }
}

/// Returns measured inputs in the form of the link.
fn as_sensors(sample: u32, inputs: &Inputs) -> Sensors {
    Sensors {
        sample,
        elapsed_us: inputs.elapsed_us,
        reference: inputs.reference.map(|reference| reference.to_bits()),
        pressure: inputs.pressure.map(|code| code.bits()),
        current_fill_ma: inputs.current_fill_ma,
        current_vent_ma: inputs.current_vent_ma,
        battery_mv: inputs.battery_mv,
    }
}
