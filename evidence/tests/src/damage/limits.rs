//! Program run under limits of time and memory, and its use of both.

use std::io;
use std::process::{Child, Command, ExitStatus};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process, waitid};
use wait4::Wait4 as _;

/// Limits of one run.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Longest processor time without a finding: on an idle machine, the time that a user waits.
    pub processor_time: Duration,
    /// Time after which the program is killed.
    pub time: Duration,
    /// Largest resident memory without a finding (bytes).
    pub peak_bytes: u64,
    /// Address space: an allocation beyond it fails (bytes). Linux only; other systems have no limit.
    pub address_space_bytes: u64,
}

impl Default for Limits {
    /// Returns the required limits: 10 s, 500 MB. Six times as much clock time, for a machine that also does other
    /// work, and 4 GB of addresses, so that a finding does not exhaust the machine.
    fn default() -> Self {
        Self {
            processor_time: Duration::from_secs(10),
            time: Duration::from_secs(60),
            peak_bytes: 500_000_000,
            address_space_bytes: 4_000_000_000,
        }
    }
}

/// End of a program, and its use of time and memory.
#[derive(Debug, Clone, Copy)]
pub struct Ended {
    /// Exit status or signal.
    pub status: ExitStatus,
    /// Whether it was killed at the time limit.
    pub is_overdue: bool,
    /// Time from start to end.
    pub elapsed: Duration,
    /// Processor time, user and system.
    pub processor_time: Duration,
    /// Largest resident memory (bytes).
    pub peak_bytes: u64,
}

/// Runs `command` to its end, and kills it at the time limit.
///
/// # Errors
/// Returns an error if the program cannot be started, watched or limited.
pub fn run(command: &mut Command, limits: &Limits) -> io::Result<Ended> {
    run_and(command, limits, |_| ())
}

/// Runs `command` in the same way while `talk` uses it.
pub(super) fn run_and(
    command: &mut Command,
    limits: &Limits,
    talk: impl FnOnce(&mut Child),
) -> io::Result<Ended> {
    let start = Instant::now();
    let mut child = command.spawn()?;
    let pid = Pid::from_child(&child);
    let limited = limit_addresses(pid, limits.address_space_bytes);
    let (over, is_over) = mpsc::channel::<()>();
    let (waited, is_overdue) = thread::scope(|scope| {
        let watchdog = scope.spawn(move || {
            let waited = is_over.recv_timeout(limits.time);
            let is_overdue = waited == Err(RecvTimeoutError::Timeout);
            if is_overdue {
                // The child is reaped only after this thread has ended, so its process id is still valid.
                let _ = kill_process(pid, Signal::KILL);
            }
            is_overdue
        });
        talk(&mut child);
        // Does not reap the child: `wait4` reaps it below, and returns its resource use.
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOWAIT;
        let waited = rustix::io::retry_on_intr(|| waitid(WaitId::Pid(pid), options));
        drop(over);
        let is_overdue = watchdog.join().expect("the watchdog does not panic");
        (waited, is_overdue)
    });
    let elapsed = start.elapsed();
    let used = child.wait4()?;
    limited?;
    waited?;
    Ok(Ended {
        status: used.status,
        is_overdue,
        elapsed,
        processor_time: used.rusage.utime + used.rusage.stime,
        peak_bytes: used.rusage.maxrss,
    })
}

/// The program has already begun, but it reads no file in the microseconds before the limit is set.
#[cfg(target_os = "linux")]
fn limit_addresses(pid: Pid, bytes: u64) -> io::Result<()> {
    use rustix::process::{Resource, Rlimit, prlimit};
    let limit = Rlimit {
        current: Some(bytes),
        maximum: Some(bytes),
    };
    match prlimit(Some(pid), Resource::As, limit) {
        // It has already ended.
        Ok(_) | Err(rustix::io::Errno::SRCH) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

#[cfg(not(target_os = "linux"))]
fn limit_addresses(_: Pid, _: u64) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::ExitStatusExt as _;

    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn an_exit_status_and_a_signal_are_distinguished() {
        let limits = Limits::default();
        let ended = run(&mut shell("exit 3"), &limits).unwrap();
        assert_eq!((ended.status.code(), ended.is_overdue), (Some(3), false));
        let ended = run(&mut shell("kill -ABRT $$"), &limits).unwrap();
        assert_eq!((ended.status.signal(), ended.is_overdue), (Some(6), false));
    }

    #[test]
    fn what_does_not_end_is_killed() {
        let limits = Limits {
            time: Duration::from_millis(20),
            ..Limits::default()
        };
        let mut endless = Command::new("sleep");
        let ended = run(endless.arg("600"), &limits).unwrap();
        assert!(ended.is_overdue && ended.status.code().is_none());
    }

    /// Ten million characters in one variable of the shell.
    #[test]
    fn the_peak_of_the_memory_is_seen() {
        let limits = Limits::default();
        let peak = |script| run(&mut shell(script), &limits).unwrap().peak_bytes;
        let small = peak("true");
        let large = peak("x=$(head -c 10000000 /dev/zero | tr '\\0' x); true");
        assert!(large > small + 10_000_000, "{small} and {large} bytes");
    }
}
