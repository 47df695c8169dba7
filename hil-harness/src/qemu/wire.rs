//! The two wires to an emulated device.

use std::io;
use std::os::unix::net::{UnixListener, UnixStream};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use hil_protocol::{FRAME_MAX, mailbox};

use super::QemuError;
use super::emulator::{Clock, Emulator};
use super::mailbox::MailboxLink;
use super::memory::{Folder, SharedMemory};
use crate::image::Image;
use crate::link::{Stream, TimedStream, Transport, TransportError};

/// Wire of the frames to and from the emulated device. The device answers on both; the bits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// Memory mapped by both sides: fast.
    Mailbox,
    /// Emulated UART, byte by byte: the real wire.
    Uart,
}

/// Emulated device at the end of a wire.
#[derive(Debug)]
pub struct QemuLink {
    wire: EitherWire,
    memory: Arc<SharedMemory>,
    emulator: Emulator,
    image: String,
    /// Names of the emulator's files, until the image answers: then all of them are open.
    names: Option<Folder>,
}

#[derive(Debug)]
enum EitherWire {
    Mailbox(MailboxLink),
    Uart(Stream<UnixStream>),
}

/// Address of the compare values of the two PWM outputs, of 65 535: the duty cycles of the coils, independent of the
/// image's report.
const COMPARE_ADDRESS: usize = mailbox::ADDRESS + 0x1000 + 4 * 32;
/// Timeout for the connection of the emulator's UART.
const CONNECT_DEADLINE: Duration = Duration::from_secs(30);
/// Time between two polls of the emulator's state and connection.
const LOOK_EVERY: Duration = Duration::from_millis(20);

impl QemuLink {
    /// Starts the emulator with this image. [`Framed::open`](crate::link::Framed::open) opens a session over it.
    ///
    /// # Errors
    /// Returns an error if QEMU is missing or fails.
    pub fn start(image: &Image, wire: Wire, clock: Clock) -> Result<Self, QemuError> {
        let folder = Folder::create()?;
        let memory = Arc::new(SharedMemory::create(&folder.path("memory"))?);
        let failed = |error| QemuError::Io {
            what: "the socket of the emulated UART",
            error,
        };
        let socket = folder.path("uart");
        let listener = UnixListener::bind(&socket).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let mut emulator = Emulator::start(image.path(), &folder.path("memory"), &socket, clock)?;
        let uart = accept(&listener, &mut emulator)?;
        uart.set_nonblocking(false).map_err(failed)?;
        Ok(Self {
            wire: match wire {
                Wire::Mailbox => EitherWire::Mailbox(MailboxLink::new(Arc::clone(&memory))),
                Wire::Uart => EitherWire::Uart(Stream::new("UART", uart)),
            },
            memory,
            emulator,
            image: image.name(),
            names: Some(folder),
        })
    }

    /// Returns the compare values of the PWM outputs of fill and vent valve, of 65 535, independent of the image's
    /// report.
    pub fn compare_values(&self) -> [u32; 2] {
        [0, 4].map(|offset| {
            let word = self.memory.word_at(COMPARE_ADDRESS + offset);
            word.map_or(0, |word| word.load(Ordering::Acquire))
        })
    }

    /// Returns the machine's memory: the image's variables, its stack, its settings and its black box.
    pub fn memory(&self) -> &SharedMemory {
        &self.memory
    }

    /// Returns the emulator's process.
    pub const fn emulator(&self) -> &Emulator {
        &self.emulator
    }

    fn either(&mut self) -> &mut dyn Transport {
        match &mut self.wire {
            EitherWire::Mailbox(wire) => wire,
            EitherWire::Uart(wire) => wire,
        }
    }

    fn still_runs(&mut self) -> Result<(), TransportError> {
        match self.emulator.ended()? {
            None => Ok(()),
            Some(status) => Err(TransportError::Ended {
                status: status.to_string(),
            }),
        }
    }
}

fn accept(listener: &UnixListener, emulator: &mut Emulator) -> Result<UnixStream, QemuError> {
    let start = Instant::now();
    loop {
        match listener.accept() {
            Ok((stream, _)) => return Ok(stream),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => {
                return Err(QemuError::Io {
                    what: "the socket of the emulated UART",
                    error,
                });
            }
        }
        let has_ended = !matches!(emulator.ended(), Ok(None));
        if has_ended || start.elapsed() > CONNECT_DEADLINE {
            return Err(QemuError::NotConnected {
                waited_ms: start.elapsed().as_millis(),
                printed: emulator.printed().join("\n"),
            });
        }
        thread::sleep(LOOK_EVERY);
    }
}

impl Transport for QemuLink {
    fn name(&self) -> String {
        let wire = match &self.wire {
            EitherWire::Mailbox(wire) => wire.name(),
            EitherWire::Uart(wire) => wire.name(),
        };
        format!("{} in {}, {wire}", self.image, self.emulator.version())
    }

    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError> {
        let sent = self.either().send(frame, deadline);
        if sent.is_err() {
            self.still_runs()?;
        }
        sent
    }

    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError> {
        loop {
            let look = deadline.min(Instant::now() + LOOK_EVERY);
            match self.either().receive(buffer, look) {
                Ok(0) => self.still_runs()?,
                Ok(count) => {
                    // A process that is killed from here on leaves no files behind.
                    self.names = None;
                    return Ok(count);
                }
                Err(error) => {
                    self.still_runs()?;
                    return Err(error);
                }
            }
            if Instant::now() >= deadline {
                return Ok(0);
            }
        }
    }

    fn last_words(&self) -> Vec<String> {
        self.emulator.printed()
    }
}

impl TimedStream for UnixStream {
    fn set_time_limit(&mut self, limit: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(limit))?;
        self.set_write_timeout(Some(limit))
    }
}
