//! A program under limits of time and memory, and what it took.

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
    /// Longest time on processors that is no finding: on an idle machine, the time that a person waits.
    pub processor_time: Duration,
    /// Time after which the program is killed.
    pub time: Duration,
    /// Largest resident memory that is no finding (bytes).
    pub peak_bytes: u64,
    /// Address space: an allocation beyond it fails (bytes). Linux only; elsewhere there is no limit.
    pub address_space_bytes: u64,
}

impl Default for Limits {
    /// Those of the promise: 10 s, 500 MB. Six times longer on the clock, for a machine that does other work beside it; and
    /// 4 GB of addresses, so that the machine outlives a finding.
    fn default() -> Self {
        Self {
            processor_time: Duration::from_secs(10),
            time: Duration::from_secs(60),
            peak_bytes: 500_000_000,
            address_space_bytes: 4_000_000_000,
        }
    }
}

/// How a program ended, and what it took.
#[derive(Debug, Clone, Copy)]
pub struct Ended {
    /// Exit status or signal.
    pub status: ExitStatus,
    /// Whether it was killed because its time was over.
    pub is_overdue: bool,
    /// Time from start to end.
    pub elapsed: Duration,
    /// Time on processors, user and system.
    pub processor_time: Duration,
    /// Largest resident memory (bytes).
    pub peak_bytes: u64,
}

/// Runs `command` to its end, and kills it when its time is over.
///
/// # Errors
/// If the program cannot be started, watched or limited.
pub fn run(command: &mut Command, limits: &Limits) -> io::Result<Ended> {
    run_and(command, limits, |_| ())
}

/// The same with somebody who talks to the program while it runs.
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
                // The child is not reaped before this thread has ended, so its number is still its own.
                let _ = kill_process(pid, Signal::KILL);
            }
            is_overdue
        });
        talk(&mut child);
        // Leaves the child unreaped: `wait4` reaps it below, together with what it took.
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

/// The program has begun already, but reads no file within the microseconds until it has its limit.
#[cfg(target_os = "linux")]
fn limit_addresses(pid: Pid, bytes: u64) -> io::Result<()> {
    use rustix::process::{Resource, Rlimit, prlimit};
    let limit = Rlimit {
        current: Some(bytes),
        maximum: Some(bytes),
    };
    match prlimit(Some(pid), Resource::As, limit) {
        // It has ended already.
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
    fn an_exit_status_and_a_signal_are_told_apart() {
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

    /// Ten million characters in one variable: the shell holds them.
    #[test]
    fn the_peak_of_the_memory_is_seen() {
        let limits = Limits::default();
        let peak = |script| run(&mut shell(script), &limits).unwrap().peak_bytes;
        let small = peak("true");
        let large = peak("x=$(head -c 10000000 /dev/zero | tr '\\0' x); true");
        assert!(large > small + 10_000_000, "{small} and {large} bytes");
    }
}
