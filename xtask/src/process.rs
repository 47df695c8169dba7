//! Other programs: started, watched, and stopped at a deadline. None runs longer than the step that started it.

use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::failure::Failure;

/// Interval between checks of a running program.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// Runs a program with the terminal's input and output, and waits until it ends with success.
pub(crate) fn run(command: &mut Command, deadline: Duration) -> Result<(), Failure> {
    let line = line(command);
    eprintln!("$ {line}");
    let mut running = Running::start(command, &line)?;
    let ended = running.wait(deadline);
    verdict(ended, line, deadline, "").map(|_| ())
}

/// Runs a program, waits until it ends with success, and returns its standard output.
pub(crate) fn capture(command: &mut Command, deadline: Duration) -> Result<String, Failure> {
    let line = line(command);
    command.stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut running = Running::start(command, &line)?;
    let stdout = drain(running.0.stdout.take());
    let stderr = drain(running.0.stderr.take());
    let ended = running.wait(deadline);
    // Stops the program if it still runs, so that its pipes close and the readers end.
    drop(running);
    let watched = |source| Failure::Watch {
        line: line.clone(),
        source,
    };
    let stdout = text(stdout).map_err(watched)?;
    let stderr = text(stderr).map_err(watched)?;
    // On failure the reason is usually on the standard error; otherwise the end of the standard output is used.
    let reason = if stderr.trim().is_empty() {
        &stdout
    } else {
        &stderr
    };
    verdict(ended, line, deadline, reason)?;
    Ok(stdout)
}

/// Formats the command as a command line.
fn line(command: &Command) -> String {
    let mut line = command.get_program().to_string_lossy().into_owned();
    for argument in command.get_args() {
        line.push(' ');
        line.push_str(&argument.to_string_lossy());
    }
    line
}

fn verdict(
    ended: io::Result<Option<ExitStatus>>,
    line: String,
    deadline: Duration,
    said: &str,
) -> Result<(), Failure> {
    let said = said.to_owned();
    match ended {
        Ok(Some(status)) if status.success() => Ok(()),
        Ok(Some(status)) => Err(Failure::Ended { line, status, said }),
        Ok(None) => Err(Failure::Deadline {
            line,
            deadline,
            said,
        }),
        Err(source) => Err(Failure::Watch { line, source }),
    }
}

type Reader = JoinHandle<io::Result<Vec<u8>>>;

/// Reads a pipe in parallel, so that a program never blocks on a full pipe.
fn drain(pipe: Option<impl Read + Send + 'static>) -> Reader {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            pipe.read_to_end(&mut bytes)?;
        }
        Ok(bytes)
    })
}

fn text(reader: Reader) -> io::Result<String> {
    let bytes = reader
        .join()
        .map_err(|_| io::Error::other("the reading thread panicked"))??;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Started program, stopped on drop.
struct Running(Child);

impl Running {
    fn start(command: &mut Command, line: &str) -> Result<Self, Failure> {
        match command.spawn() {
            Ok(child) => Ok(Self(child)),
            Err(source) => Err(Failure::NotStarted {
                line: line.to_owned(),
                source,
            }),
        }
    }

    /// Returns the exit status, or `None` if the program still runs at its deadline.
    fn wait(&mut self, deadline: Duration) -> io::Result<Option<ExitStatus>> {
        let start = Instant::now();
        loop {
            let ended = self.0.try_wait()?;
            if ended.is_some() || start.elapsed() >= deadline {
                return Ok(ended);
            }
            thread::sleep(LOOK_EVERY);
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Both fail only if the program has already ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOON: Duration = Duration::from_secs(20);

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn standard_error_is_kept_out_of_what_a_program_says() {
        let said = capture(&mut shell("echo out; echo err >&2"), SOON).unwrap();
        assert_eq!(said, "out\n");
    }

    #[test]
    fn a_program_that_says_more_than_a_pipe_holds_is_read_to_its_end() {
        let said = capture(&mut shell("yes 0123456789 | head -n 100000"), SOON).unwrap();
        assert_eq!(said.len(), 1_100_000);
    }

    #[test]
    fn a_failed_program_is_named_with_its_status_and_its_last_words() {
        let failure = capture(&mut shell("echo why >&2; exit 3"), SOON).unwrap_err();
        let message = failure.to_string();
        assert!(
            message.contains("exit 3` ended with exit status: 3"),
            "{message}"
        );
        assert!(message.ends_with("| why"), "{message}");
    }

    #[test]
    fn a_program_that_never_ends_is_stopped_at_its_deadline() {
        let start = Instant::now();
        let mut endless = Command::new("sleep");
        endless.arg("600");
        let failure = capture(&mut endless, Duration::from_millis(50)).unwrap_err();
        assert!(matches!(failure, Failure::Deadline { .. }), "{failure}");
        assert!(start.elapsed() < SOON);
    }

    #[test]
    fn a_program_that_is_not_there_is_a_failure_and_no_panic() {
        let failure = capture(&mut Command::new("no-such-program-here"), SOON).unwrap_err();
        assert!(matches!(failure, Failure::NotStarted { .. }), "{failure}");
    }
}
