//! Process of the emulator.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::QemuError;
use super::memory::SIZE;

/// Name of the emulator.
const PROGRAM: &str = "qemu-system-arm";
/// Timeout for the version of the emulator.
const VERSION_DEADLINE: Duration = Duration::from_secs(10);
/// Time between two polls of a process.
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// Number of stored lines of the emulator's output.
const LINES_KEPT: usize = 12;

/// Clock of the emulated machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Clock of the host: the image runs as fast as possible, its timers follow the host's clock.
    Host,
    /// Counted instructions: each takes 32 ns, a little less than a cycle of the machine's 25 MHz. The load of the host
    /// then has no influence.
    Instructions,
}

/// Running emulator; its process is stopped when this value is dropped.
#[derive(Debug)]
pub struct Emulator {
    process: Child,
    version: String,
    printed: Printed,
}

impl Emulator {
    /// Starts `elf` with its memory in the file `memory` and its UART at the socket `uart`.
    pub(super) fn start(
        elf: &Path,
        memory: &Path,
        uart: &Path,
        clock: Clock,
    ) -> Result<Self, QemuError> {
        let version = version()?;
        let mut command = Command::new(PROGRAM);
        command.args(["-machine", "mps2-an386,memory-backend=memory"]);
        command.args(["-cpu", "cortex-m4", "-nographic", "-monitor", "none"]);
        command.arg("-object").arg(format!(
            "memory-backend-file,id=memory,size={SIZE},share=on,mem-path={}",
            escaped(memory)
        ));
        command
            .arg("-chardev")
            .arg(format!("socket,id=wire,path={}", escaped(uart)));
        command
            .args(["-serial", "chardev:wire", "-kernel"])
            .arg(elf);
        if clock == Clock::Instructions {
            command.args(["-icount", "shift=5,align=off,sleep=off"]);
        }
        command.stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut process = command.spawn().map_err(not_started)?;
        let printed = Printed::default();
        printed.follow(process.stdout.take());
        printed.follow(process.stderr.take());
        Ok(Self {
            process,
            version,
            printed,
        })
    }

    /// Returns the id of its process.
    pub fn process_id(&self) -> u32 {
        self.process.id()
    }

    /// Returns the version that the emulator reports.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Returns the last lines of its output.
    pub fn printed(&self) -> Vec<String> {
        self.printed.lines().iter().cloned().collect()
    }

    /// Returns its exit status, once it has ended.
    ///
    /// # Errors
    /// Returns an error if the process cannot be observed.
    pub fn ended(&mut self) -> io::Result<Option<ExitStatus>> {
        self.process.try_wait()
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // Both fail only if the process has already ended, which is the aim.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Returns the first line of the emulator's version output.
fn version() -> Result<String, QemuError> {
    let mut command = Command::new(PROGRAM);
    command.arg("--version").stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut process = command.spawn().map_err(not_started)?;
    let start = Instant::now();
    let failed = |error| QemuError::Io {
        what: "the emulator's version",
        error,
    };
    // The output fits into a pipe, so the process ends even if nothing reads it.
    while process.try_wait().map_err(failed)?.is_none() {
        if start.elapsed() > VERSION_DEADLINE {
            let _ = process.kill();
            let _ = process.wait();
            return Err(failed(io::ErrorKind::TimedOut.into()));
        }
        thread::sleep(LOOK_EVERY);
    }
    let mut text = String::new();
    if let Some(mut stdout) = process.stdout.take() {
        stdout.read_to_string(&mut text).map_err(failed)?;
    }
    Ok(text.lines().next().unwrap_or("QEMU").trim().to_owned())
}

fn not_started(error: io::Error) -> QemuError {
    match error.kind() {
        io::ErrorKind::NotFound => QemuError::NotInstalled { program: PROGRAM },
        _ => QemuError::Io {
            what: "the emulator cannot be started",
            error,
        },
    }
}

/// Returns a path in the form of the emulator's options, where a comma would end the value.
fn escaped(path: &Path) -> String {
    path.display().to_string().replace(',', ",,")
}

/// Last lines of a process's output, collected in a thread so that the process never waits for a reader.
#[derive(Clone, Debug, Default)]
struct Printed(Arc<Mutex<VecDeque<String>>>);

impl Printed {
    fn follow(&self, pipe: Option<impl Read + Send + 'static>) {
        let Some(pipe) = pipe else { return };
        let printed = self.clone();
        // The thread ends with the process, which closes the pipe.
        thread::spawn(move || {
            for line in BufReader::new(pipe).lines().map_while(Result::ok) {
                let mut lines = printed.lines();
                if lines.len() == LINES_KEPT {
                    lines.pop_front();
                }
                lines.push_back(line);
            }
        });
    }

    fn lines(&self) -> std::sync::MutexGuard<'_, VecDeque<String>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
