//! The control task: one sample of the ECU, by the sample timer or by request, between the board's inputs and its coils.

use controller::Duty;
use ecu::device::EcuDevice;
use ecu::{FaultSet, Inputs, Mode, Outputs, safe_outputs};
use embedded_storage::nor_flash::NorFlash;
use hil_protocol::{Actuators, Device, Identity, LogBytes, Refusal, Reply, Request, Sensors};

use crate::board::{Board, Pace};
use crate::event::Event;
use crate::retained::Farewell;

/// Turns of the main loop between two looks at the clock while a host sets the pace: a millisecond or some.
const TURNS_PER_LOOK: u32 = 4096;

/// A host that sets the pace and asks for no sample for so long \[µs\] has gone: the coils are switched off.
const SILENCE_MAX_US: u32 = 1_000_000;

/// The ECU on its board.
///
/// ```text
///                    Hello with lock step, simulated inputs allowed
///  by the sample  ────────────────────────────────────────────────►  by request of a host: simulated inputs,
///  timer, 10 ms   ◄────────────────────────────────────────────────  coils off after a second without one
///                    Hello without
/// ```
pub(crate) struct ControlTask<B, F, M> {
    pub(crate) board: B,
    ecu: EcuDevice<F, M>,
    pace: Pace,
    /// A host asked for a reset.
    pub(crate) ends: bool,
    /// Number of the next sample by the timer.
    sample: u32,
    /// When the last sample was taken.
    last_us: u32,
    /// Turns of the loop, while a host sets the pace.
    turns: u32,
    /// What was told last of the supervisor.
    told: (Mode, FaultSet),
}

impl<B: Board, F: NorFlash, M: AsRef<[u32]> + AsMut<[u32]>> ControlTask<B, F, M> {
    /// From now on the sample timer counts.
    pub(crate) fn new(mut board: B, ecu: EcuDevice<F, M>) -> Self {
        board.take_ticks();
        Self {
            last_us: board.now_us(),
            told: (ecu.ecu().mode(), ecu.ecu().faults()),
            board,
            ecu,
            pace: Pace::Timer,
            ends: false,
            sample: 0,
            turns: 0,
        }
    }

    /// A sample if its time has come; then what a host wants to measure of it, if it does.
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
        let now_us = self.board.now_us();
        let inputs = self.board.measure(now_us.wrapping_sub(self.last_us));
        self.last_us = now_us;
        let sample = self.sample;
        self.sample = sample.wrapping_add(1);
        let actuators = self.ecu.sample(sample, &inputs).actuators;
        self.drive(actuators);
        self.tell(sample);
        if ticks > 1 {
            let missed = ticks - 1;
            self.board.log(Event::TicksMissed { sample, missed });
        }
        // Only now: a task that hangs anywhere in a sample is reset.
        self.board.feed_watchdog(Pace::Timer);
        self.ecu.measured()
    }

    /// Now and then: the loop is alive, and is the host?
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

    /// A sample that a host asked for. Its values take the way of measured ones, through converter and driver.
    fn sample_by_request(&mut self, sensors: &Sensors) -> Reply {
        if self.pace == Pace::Timer {
            return Reply::Refused(Refusal::NotInLockStep);
        }
        self.last_us = self.board.now_us();
        self.board.simulate(sensors);
        let inputs = self.board.measure(sensors.elapsed_us);
        let measured = Request::Sample(as_sensors(sensors.sample, &inputs));
        let reply = self.ecu.answer(&measured);
        if let Reply::Sample { answer, .. } = &reply {
            self.drive(answer.actuators);
            self.tell(sensors.sample);
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

    /// Tells of the supervisor, if there is something to tell.
    fn tell(&mut self, sample: u32) {
        let (mode, faults) = (self.ecu.ecu().mode(), self.ecu.ecu().faults());
        if (mode, faults) != self.told {
            self.told = (mode, faults);
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
        self.pace = if lock_step && self.board.may_simulate() {
            Pace::Host
        } else {
            self.board.end_simulation();
            Pace::Timer
        };
        self.board.feed_watchdog(self.pace);
        self.board.drive(safe_outputs());
        self.board.take_ticks();
        self.last_us = self.board.now_us();
        self.board.log(Event::Session { pace: self.pace });
        self.ecu.open(lock_step)
    }

    fn answer(&mut self, request: &Request) -> Reply {
        match request {
            Request::Sample(sensors) => self.sample_by_request(sensors),
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
            Request::Restart { .. } => {
                self.board.drive(safe_outputs());
                self.ecu.answer(request)
            }
            _ => self.ecu.answer(request),
        }
    }
}

/// What was measured, as the link would carry it.
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
