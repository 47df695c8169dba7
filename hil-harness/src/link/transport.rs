//! Transport of the bytes of frames.

use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

use hil_protocol::FRAME_MAX;

/// Transport of bytes in both directions, each operation with a deadline.
pub trait Transport {
    /// Returns the name of the transport, for the record of a run.
    fn name(&self) -> String;

    /// Sends a whole frame.
    ///
    /// # Errors
    /// Returns an error if it could not be sent before the deadline, or the other side is gone.
    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError>;

    /// Waits for bytes and returns their number in `buffer`; 0 if none came before the deadline.
    ///
    /// # Errors
    /// Returns an error if the other side is gone.
    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError>;

    /// Returns the last lines that the other side printed outside the wire, for an error.
    fn last_words(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Reason why bytes do not get through.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// The operating system reported an error.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The other side does not accept the sent bytes.
    #[error("the device does not take what is sent")]
    NotTaken,
    /// The other side has closed.
    #[error("the device has closed the connection")]
    Closed,
    /// The emulator has ended.
    #[error("the emulator ended with {status}")]
    Ended {
        /// Exit status of the emulator.
        status: String,
    },
    /// A mailbox refused a frame.
    #[error(transparent)]
    Mailbox(#[from] hil_protocol::mailbox::MailboxError),
}

/// Stream of bytes with a time limit for reads and writes.
pub trait TimedStream: Read + Write {
    /// Sets the time limit of the next reads and writes.
    ///
    /// # Errors
    /// Returns the error of the operating system.
    fn set_time_limit(&mut self, limit: Duration) -> io::Result<()>;
}

/// Frames over a stream of bytes.
#[derive(Debug)]
pub struct Stream<S> {
    name: String,
    stream: S,
}

impl<S: TimedStream> Stream<S> {
    /// Creates frames over `stream`, with the name `name`.
    pub fn new(name: impl Into<String>, stream: S) -> Self {
        Self {
            name: name.into(),
            stream,
        }
    }
}

/// Shortest time limit that operating systems distinguish from none.
const LEAST: Duration = Duration::from_millis(1);

fn left(deadline: Instant) -> Duration {
    deadline
        .saturating_duration_since(Instant::now())
        .max(LEAST)
}

fn is_time_out(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock
    )
}

impl<S: TimedStream> Transport for Stream<S> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError> {
        self.stream.set_time_limit(left(deadline))?;
        self.stream
            .write_all(frame)
            .map_err(|error| match is_time_out(&error) {
                true => TransportError::NotTaken,
                false => error.into(),
            })
    }

    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError> {
        loop {
            self.stream.set_time_limit(left(deadline))?;
            match self.stream.read(buffer) {
                Ok(0) => return Err(TransportError::Closed),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if is_time_out(&error) => return Ok(0),
                Err(error) => return Err(error.into()),
            }
        }
    }
}
