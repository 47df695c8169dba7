//! Start of the image and its main loop.

use ecu::calibration::CheckedSettings;
use ecu::device::EcuDevice;
use ecu::{EcuSettings, safe_outputs};
use embedded_storage::nor_flash::NorFlash;
use hil_protocol::{DeviceSession, FRAME_MAX, ImageIdentity, ResetCause, name};

use crate::board::{Board, Received};
use crate::control_task::ControlTask;
use crate::event::Event;

/// Action after a turn of the main loop: continue or reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum NextAction {
    /// The main loop continues.
    Continue,
    /// A host requested a reset, and the answer is sent: the coils are off, reset the machine.
    Reset,
}

/// Number of records of the black box: the last 5.12 s.
const BLACK_BOX_RECORDS: usize = 512;

/// Number of RAM words of the black box; a warm reset must not change them.
pub const BLACK_BOX_WORDS: usize = ecu::black_box::words(BLACK_BOX_RECORDS);

/// Settings of an ECU in which none were ever saved.
const DEFAULTS: CheckedSettings = match CheckedSettings::new(&EcuSettings::bench()) {
    Ok(settings) => settings,
    Err(_) => panic!("the built-in settings are impossible"),
};

/// Complete image on its board, with the settings' flash memory `F` and the black box's words `M`.
pub struct Image<B, F, M> {
    session: DeviceSession,
    task: ControlTask<B, F, M>,
    buffer: [u8; FRAME_MAX],
}

impl<B: Board, F: NorFlash, M: AsRef<[u32]> + AsMut<[u32]>> Image<B, F, M> {
    /// Starts the image after a reset: coils off, cause of the reset, settings; from then on the sample timer counts.
    pub fn start(mut board: B, flash: F, memory: M) -> Self {
        board.coils_off();
        let start = board.retained().start();
        let cause = match (start.reset_reason, board.reset_cause()) {
            (Some(reset_reason), _) => reset_reason.cause(),
            // Only a loss of supply destroys the words.
            (None, ResetCause::Unknown) if !start.warm => ResetCause::PowerOn,
            (None, of_board) => of_board,
        };
        board.log(Event::Started {
            boot: start.boot,
            cause,
            reset_reason: start.reset_reason,
        });
        let identity = ImageIdentity {
            board: name(B::NAME),
            version: name(env!("CARGO_PKG_VERSION")),
            build: board.build(),
            signals: 0,
            settings: 0,
        };
        let ecu = EcuDevice::start(identity, &DEFAULTS, flash, memory, cause);
        board.log(Event::Settings {
            source: ecu.settings_source(),
        });
        board.drive(safe_outputs());
        Self {
            session: DeviceSession::new(start.boot),
            task: ControlTask::new(board, ecu),
            buffer: [0; FRAME_MAX],
        }
    }

    /// Runs one turn of the main loop: a sample if it is due, then at most one byte or frame of the link.
    pub fn turn(&mut self) -> NextAction {
        if self.task.ends {
            return self.last_turn();
        }
        // Evaluated before the tick is checked: a tick after the evaluation is at least a whole quiet time away.
        let is_quiet_time = self.task.is_quiet_time();
        self.task.board.background();
        if let Some(reply) = self.task.turn()
            && let Some(frame) = self.session.unsolicited(&reply, &mut self.buffer)
        {
            self.task.board.send(frame);
        }
        if is_quiet_time {
            return NextAction::Continue;
        }
        let Some(received) = self.task.board.receive(&mut self.buffer) else {
            return NextAction::Continue;
        };
        let answer = match received {
            Received::Byte(byte) => self.session.receive_byte(byte, &mut self.task),
            Received::Frame(frame) => self.session.receive_frame(frame, &mut self.task),
        };
        if let Some(frame) = answer {
            self.task.board.send(frame);
        }
        NextAction::Continue
    }

    /// Ends the run after the answer is sent. If it cannot be sent, the watchdog ends the wait.
    fn last_turn(&mut self) -> NextAction {
        self.task.board.background();
        self.task.board.coils_off();
        if self.task.board.is_sending() {
            NextAction::Continue
        } else {
            NextAction::Reset
        }
    }

    /// Returns the board.
    pub fn board(&mut self) -> &mut B {
        &mut self.task.board
    }
}
