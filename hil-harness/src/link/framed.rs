//! Frames over a transport: the wire protocol as a host speaks it.

use std::collections::VecDeque;
use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::time::{Duration, Instant};

use hil_protocol::{
    Event, FRAME_MAX, HostError, HostSession, Identity, LinkCounters, Reply, Request,
};

use super::Link;
use super::error::{LastWords, LinkError, name};
use super::transport::{Transport, TransportError};
use crate::image_log::ImageLog;

/// How long is waited for a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// For each reply, before the request is sent again.
    pub reply: Duration,
    /// How often a request is sent in all.
    pub tries: u32,
    /// For the first reply of all, while the device still starts.
    pub start: Duration,
}

/// Between two attempts to open a session with a device that still starts.
const OPEN_EVERY: Duration = Duration::from_millis(100);
/// Lines of the log that an error shows.
const LAST_LINES: usize = 12;

/// A device at the other end of a wire, in lock step.
#[derive(Debug)]
pub struct Framed<T> {
    transport: T,
    session: HostSession,
    patience: Patience,
    device: Identity,
    log: ImageLog,
    /// The last lines of the log, for an error.
    last_lines: VecDeque<String>,
    inbox: Inbox,
}

/// Bytes that have come and are not looked at yet.
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

    /// The next event of `session`; none by the deadline.
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

/// Why a conversation broke off.
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
    /// Opens a session in lock step. `log` decodes what the device's image logs.
    ///
    /// # Errors
    /// The device does not answer, or speaks another version.
    pub fn open(mut transport: T, patience: Patience, log: ImageLog) -> Result<Self, LinkError> {
        let mut session = HostSession::new(patience.tries);
        let mut inbox = Inbox::empty();
        let start = Instant::now();
        let mut tries = 0;
        let mut attempt = || -> Result<Option<Identity>, Broken> {
            let deadline = Instant::now() + OPEN_EVERY;
            transport.send(session.open(nonce(), true)?, deadline)?;
            Ok(match inbox.event(&mut session, &mut transport, deadline)? {
                Some(Event::Opened(device)) => Some(device),
                _ => None,
            })
        };
        let device = loop {
            tries += 1;
            match attempt() {
                Ok(Some(device)) => break device,
                // A device that still starts takes nothing yet.
                Ok(None) | Err(Broken::Transport(TransportError::NotTaken))
                    if start.elapsed() < patience.start => {}
                Ok(None) | Err(Broken::Transport(TransportError::NotTaken)) => {
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
        })
    }

    /// What the device said of itself when the session was opened.
    pub fn device(&self) -> &Identity {
        &self.device
    }

    /// What carries the frames.
    pub const fn transport(&self) -> &T {
        &self.transport
    }

    /// What carries the frames, to disturb it.
    pub const fn transport_mut(&mut self) -> &mut T {
        &mut self.transport
    }

    /// What this side of the link has counted.
    pub fn counters(&self) -> LinkCounters {
        self.session.counters()
    }

    fn carry(&mut self, request: &Request) -> Result<Reply, Broken> {
        let deadline = Instant::now() + self.patience.reply;
        self.transport
            .send(self.session.request(request)?, deadline)?;
        let mut deadline = deadline;
        loop {
            match self
                .inbox
                .event(&mut self.session, &mut self.transport, deadline)?
            {
                Some(Event::Reply(reply)) => return Ok(reply),
                // In lock step nothing comes unasked; what is left of an earlier life is dropped.
                Some(Event::Opened(_) | Event::Unasked(_)) => {}
                None => {
                    deadline = Instant::now() + self.patience.reply;
                    self.transport.send(self.session.again()?, deadline)?;
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

const OPENING: &str = "the opening of a session";

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
            match self.ask(&Request::Log)? {
                Reply::Log { bytes, lost } => {
                    let is_empty = bytes.is_empty();
                    lines.extend(self.log.decode(&bytes, lost));
                    if is_empty {
                        break;
                    }
                }
                other => return Err(LinkError::unexpected(&Request::Log, &other)),
            }
        }
        self.last_lines.extend(lines.iter().cloned());
        let surplus = self.last_lines.len().saturating_sub(LAST_LINES);
        self.last_lines.drain(..surplus);
        Ok(lines)
    }
}

/// A number that differs from session to session.
fn nonce() -> u32 {
    // The standard library's hash keys are the random numbers that need no dependency.
    RandomState::new().build_hasher().finish() as u32
}
