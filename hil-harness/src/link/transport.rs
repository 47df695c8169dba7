//! What carries the bytes of frames.

use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

use hil_protocol::FRAME_MAX;

/// Carries bytes both ways, each operation with a deadline.
pub trait Transport {
    /// What it is, for the record of a run.
    fn name(&self) -> String;

    /// Sends a whole frame.
    ///
    /// # Errors
    /// It could not be sent by the deadline, or the other side is gone.
    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError>;

    /// Waits for bytes and returns how many are now in `buffer`; 0 if none came by the deadline.
    ///
    /// # Errors
    /// The other side is gone.
    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError>;

    /// The last lines that the other side printed beside the wire, for an error.
    fn last_words(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Why bytes do not get through.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// The operating system says so.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The other side does not take what is sent.
    #[error("the device does not take what is sent")]
    NotTaken,
    /// The other side has closed.
    #[error("the device has closed the connection")]
    Closed,
    /// The emulator has ended.
    #[error("the emulator ended with {status}")]
    Ended {
        /// Its exit status.
        status: String,
    },
    /// A mailbox refused a frame.
    #[error(transparent)]
    Mailbox(#[from] hil_protocol::mailbox::MailboxError),
}

/// A stream of bytes whose reads and writes can be given a time limit.
pub trait TimedStream: Read + Write {
    /// Bounds the next reads and writes.
    ///
    /// # Errors
    /// The operating system says so.
    fn set_time_limit(&mut self, limit: Duration) -> io::Result<()>;
}

/// Frames over a stream of bytes.
#[derive(Debug)]
pub struct Stream<S> {
    name: String,
    stream: S,
}

impl<S: TimedStream> Stream<S> {
    /// Frames over `stream`, which is called `name`.
    pub fn new(name: impl Into<String>, stream: S) -> Self {
        Self {
            name: name.into(),
            stream,
        }
    }
}

/// The shortest limit that operating systems tell from none.
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
