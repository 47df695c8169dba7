//! Frames over a transport: the host's side of the wire protocol.

use std::collections::VecDeque;
use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::time::{Duration, Instant};

use hil_protocol::{
    Event, FRAME_MAX, HostError, HostSession, Identity, LinkCounters, Measured, Refusal, Reply,
    Request,
};

use super::Link;
use super::error::{LastWords, LinkError, name};
use super::transport::{Transport, TransportError};
use crate::image_log::ImageLog;

/// Timeouts for a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Timeout of each reply, before the request is sent again.
    pub reply: Duration,
    /// Maximum number of times that a request is sent.
    pub tries: u32,
    /// Timeout of the first reply, while the device still starts.
    pub start: Duration,
}

/// Source of the pace of the device's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// This side: one sample for each request.
    LockStep,
    /// The device's own timer; the session only observes.
    Timer,
}

/// Time between two attempts to open a session with a device that still starts.
const OPEN_EVERY: Duration = Duration::from_millis(100);
/// Number of log lines that an error shows.
const LAST_LINES: usize = 12;

/// Device at the other end of a wire.
#[derive(Debug)]
pub struct Framed<T> {
    transport: T,
    session: HostSession,
    patience: Patience,
    device: Identity,
    log: ImageLog,
    /// Last lines of the log, for an error.
    last_lines: VecDeque<String>,
    inbox: Inbox,
    /// Unsolicited measurements not taken yet: number of the sample and its signals.
    measured: VecDeque<(u32, Measured)>,
}

/// Received bytes that are not processed yet.
#[derive(Debug)]
struct Inbox {
    bytes: [u8; FRAME_MAX],
    next: usize,
    end: usize,
}

impl Inbox {
    const fn empty() -> Self {
        Self {
            bytes: [0; FRAME_MAX],
            next: 0,
            end: 0,
        }
    }

    /// Returns the next event of `session`; `None` if there is none before the deadline.
    fn event(
        &mut self,
        session: &mut HostSession,
        transport: &mut impl Transport,
        deadline: Instant,
    ) -> Result<Option<Event>, Broken> {
        loop {
            while self.next < self.end {
                let byte = self.bytes[self.next];
                self.next += 1;
                if let Some(event) = session.receive_byte(byte)? {
                    return Ok(Some(event));
                }
            }
            (self.next, self.end) = (0, transport.receive(&mut self.bytes, deadline)?);
            if self.end == 0 && Instant::now() >= deadline {
                return Ok(None);
            }
        }
    }
}

/// Reason why a conversation ended.
#[derive(Debug)]
enum Broken {
    Transport(TransportError),
    Session(HostError),
}

impl From<TransportError> for Broken {
    fn from(error: TransportError) -> Self {
        Self::Transport(error)
    }
}

impl From<HostError> for Broken {
    fn from(error: HostError) -> Self {
        Self::Session(error)
    }
}

impl<T: Transport> Framed<T> {
    /// Opens a session. `log` decodes the log of the device's image.
    ///
    /// # Errors
    /// Returns an error if the device does not answer, or has another protocol version.
    pub fn open(
        mut transport: T,
        pace: Pace,
        patience: Patience,
        log: ImageLog,
    ) -> Result<Self, LinkError> {
        let mut session = HostSession::new(patience.tries);
        let mut inbox = Inbox::empty();
        let start = Instant::now();
        let mut tries = 0;
        let mut attempt = || -> Result<Option<Identity>, Broken> {
            let deadline = Instant::now() + OPEN_EVERY;
            let frame = session.open(nonce(), pace == Pace::LockStep)?;
            send(&mut transport, frame, deadline)?;
            Ok(match inbox.event(&mut session, &mut transport, deadline)? {
                Some(Event::Opened(device)) => Some(device),
                _ => None,
            })
        };
        let device = loop {
            tries += 1;
            match attempt() {
                Ok(Some(device)) => break device,
                Ok(None) if start.elapsed() < patience.start => {}
                Ok(None) => {
                    return Err(LinkError::Silent {
                        request: OPENING.to_owned(),
                        waited_ms: start.elapsed().as_millis(),
                        tries,
                        said: LastWords(transport.last_words()),
                    });
                }
                Err(broken) => {
                    return Err(
                        broken.into_error(OPENING.to_owned(), LastWords(transport.last_words()))
                    );
                }
            }
        };
        Ok(Self {
            transport,
            session,
            patience,
            device,
            log,
            last_lines: VecDeque::new(),
            inbox,
            measured: VecDeque::new(),
        })
    }

    /// Returns the signals of the next sample by the device's timer, as [`Request::Measure`] chose them, with its
    /// number.
    ///
    /// # Errors
    /// Returns an error if none came in time.
    pub fn measured(&mut self) -> Result<(u32, Measured), LinkError> {
        let start = Instant::now();
        while self.measured.is_empty() {
            let deadline = start + self.patience.reply;
            match self
                .inbox
                .event(&mut self.session, &mut self.transport, deadline)
            {
                Ok(Some(event)) => self.keep(event),
                Ok(None) => break,
                Err(broken) => return Err(broken.into_error(MEASURING.to_owned(), self.said())),
            }
        }
        self.measured.pop_front().ok_or_else(|| LinkError::Silent {
            request: MEASURING.to_owned(),
            waited_ms: start.elapsed().as_millis(),
            tries: 1,
            said: self.said(),
        })
    }

    /// Returns measurements as [`Framed::measured`], if some came while a reply was awaited; otherwise `None`.
    pub fn take_measured(&mut self) -> Option<(u32, Measured)> {
        self.measured.pop_front()
    }

    /// Stores an unsolicited measurement; a reply of an earlier session is dropped.
    fn keep(&mut self, event: Event) {
        if let Event::Unsolicited(Reply::Measured { sample, values }) = event {
            self.measured.push_back((sample, values));
        }
    }

    /// Returns the identity of the device when the session was opened.
    pub fn device(&self) -> &Identity {
        &self.device
    }

    /// Returns the transport of the frames.
    pub const fn transport(&self) -> &T {
        &self.transport
    }

    /// Returns the transport of the frames, to disturb it.
    pub const fn transport_mut(&mut self) -> &mut T {
        &mut self.transport
    }

    /// Returns the counters of this side of the link.
    pub fn counters(&self) -> LinkCounters {
        self.session.counters()
    }

    fn carry(&mut self, request: &Request) -> Result<Reply, Broken> {
        let deadline = Instant::now() + self.patience.reply;
        send(
            &mut self.transport,
            self.session.request(request)?,
            deadline,
        )?;
        let mut deadline = deadline;
        loop {
            match self
                .inbox
                .event(&mut self.session, &mut self.transport, deadline)?
            {
                Some(Event::Reply(reply)) => return Ok(reply),
                Some(other) => self.keep(other),
                None => {
                    deadline = Instant::now() + self.patience.reply;
                    send(&mut self.transport, self.session.again()?, deadline)?;
                }
            }
        }
    }

    fn said(&self) -> LastWords {
        let mut lines: Vec<String> = self.last_lines.iter().cloned().collect();
        lines.extend(self.transport.last_words());
        LastWords(lines)
    }
}

/// Sends a frame. A device that does not accept it counts as silent, like one that does not answer: it starts, or it
/// hangs.
fn send(
    transport: &mut impl Transport,
    frame: &[u8],
    deadline: Instant,
) -> Result<(), TransportError> {
    match transport.send(frame, deadline) {
        Err(TransportError::NotTaken) => Ok(()),
        other => other,
    }
}

const OPENING: &str = "the opening of a session";
const MEASURING: &str = "the measurement of a sample";

impl Broken {
    fn into_error(self, request: String, said: LastWords) -> LinkError {
        match self {
            Self::Transport(error) => LinkError::Transport {
                request,
                error,
                said,
            },
            Self::Session(error) => LinkError::Session {
                request,
                error,
                said,
            },
        }
    }
}

impl<T: Transport> Link for Framed<T> {
    fn identity(&self) -> String {
        let image = &self.device.image;
        format!(
            "firmware {} (build {:08x}) on {}, {}",
            image.version,
            image.build,
            image.board,
            self.transport.name()
        )
    }

    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        let start = Instant::now();
        match self.carry(request) {
            Ok(Reply::Refused(refusal)) => Err(LinkError::refused(request, refusal)),
            Ok(reply) => Ok(reply),
            Err(Broken::Session(HostError::Unanswered { tries, .. })) => Err(LinkError::Silent {
                request: name(request),
                waited_ms: start.elapsed().as_millis(),
                tries,
                said: self.said(),
            }),
            Err(broken) => Err(broken.into_error(name(request), self.said())),
        }
    }

    fn take_log(&mut self) -> Result<Vec<String>, LinkError> {
        let mut lines = Vec::new();
        loop {
            match self.ask(&Request::Log) {
                // Some devices have no log.
                Err(LinkError::Refused {
                    refusal: Refusal::Unsupported,
                    ..
                }) => break,
                Err(error) => return Err(error),
                Ok(Reply::Log { bytes, lost }) => {
                    let is_empty = bytes.is_empty();
                    lines.extend(self.log.decode(&bytes, lost));
                    if is_empty {
                        break;
                    }
                }
                Ok(other) => return Err(LinkError::unexpected(&Request::Log, &other)),
            }
        }
        self.last_lines.extend(lines.iter().cloned());
        let surplus = self.last_lines.len().saturating_sub(LAST_LINES);
        self.last_lines.drain(..surplus);
        Ok(lines)
    }
}

/// Returns a number that differs from session to session.
fn nonce() -> u32 {
    // The hash keys of the standard library are random numbers without a further dependency.
    RandomState::new().build_hasher().finish() as u32
}
