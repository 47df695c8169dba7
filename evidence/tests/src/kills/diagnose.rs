//! Kills of `retarder diagnose --json --html` while it replaces the files of an earlier run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use super::{Kills, Loss, is_temporary};
use crate::bench_log::repository;
use crate::chance::Chance;
use crate::damage::limits::{self, Limits};
use crate::served::files_below;

const LOG: &str = "bench.csv";
const JSON: &str = "diagnosis.json";
const HTML: &str = "diagnosis.html";
/// Content of the earlier files.
const OLD: &str = "the result of last week\n";
/// Output of the run after the kill.
const NEXT: &str = "next.json";

const DIAGNOSE: [&str; 7] = ["diagnose", "--log", LOG, "--json", JSON, "--html", HTML];

/// Rows of the log: a diagnosis takes a second.
const ROWS: usize = 150;

/// Kills a diagnosis `kills` times while it works, each in a folder of its own. Kills that come too late are repeated,
/// at most three times as many.
///
/// # Errors
/// Returns the first loss.
pub fn kill(retarder: &Path, seed: u64, kills: u64) -> Result<Kills, Loss> {
    let at = |kill| move |source| Loss::Run { kill, source };
    let undisturbed = Scene::new(retarder).map_err(at(0))?;
    let ended = undisturbed
        .diagnose(Limits::default().time)
        .map_err(at(0))?;
    let duration = ended.elapsed;
    let whole = undisturbed.outputs().map_err(at(0))?;
    if whole.iter().any(|text| text == OLD || text.len() < 1000) {
        let source = io::Error::other(format!(
            "an undisturbed diagnosis ended with {}",
            ended.status
        ));
        return Err(Loss::Run { kill: 0, source });
    }
    let mut counted = Kills::default();
    for kill in 0..4 * kills {
        if counted.at_work == kills {
            break;
        }
        let mut chance = Chance::of(seed, kill);
        let scene = Scene::new(retarder).map_err(at(kill))?;
        // Half of the moments anywhere, half while the files are written, which takes milliseconds.
        let was_at_work = if chance.happens(0.5) {
            let moment = duration.mul_f64(chance.between(0.0, 1.0));
            let ended = scene.diagnose(moment).map_err(at(kill))?;
            ended.is_overdue && ended.status.code().is_none()
        } else {
            let pause = Duration::from_micros(chance.whole(0, 8000) as u64);
            scene.diagnose_until_writing(pause).map_err(at(kill))?
        };
        if was_at_work {
            counted.at_work += 1;
        } else {
            counted.too_late += 1;
        }
        let outputs = scene.outputs().map_err(at(kill))?;
        for ((name, text), whole) in [JSON, HTML].into_iter().zip(&outputs).zip(&whole) {
            if text != OLD && without_figures(text) != without_figures(whole) {
                return Err(Loss::Torn {
                    kill,
                    path: name.into(),
                });
            }
        }
        let is_new = outputs.iter().any(|text| text != OLD);
        counted.with_news += u64::from(is_new && was_at_work);
        scene.check_input(kill)?;
        let leavings = scene.temporaries().map_err(at(kill))?;
        counted.with_leavings += u64::from(!leavings.is_empty());
        scene.next_run().map_err(at(kill))?;
        if let Some(path) = scene.temporaries().map_err(at(kill))?.pop() {
            return Err(Loss::Left { kill, path });
        }
    }
    Ok(counted)
}

/// Removes the time of the diagnosis and its path on the disk from a result; the rest is the same each time.
fn without_figures(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_ascii_digit() && *c != '.')
        .collect()
}

/// Folder with a log and the results of an earlier run.
struct Scene {
    retarder: PathBuf,
    folder: tempfile::TempDir,
    log: String,
}

impl Scene {
    fn new(retarder: &Path) -> io::Result<Self> {
        let log = fs::read_to_string(repository().join("data/synthetic/practice-01-id.csv"))?;
        let rows = std::iter::once(0).chain(180..180 + ROWS);
        let lines: Vec<_> = log.lines().collect();
        let log: String = rows.map(|row| format!("{}\n", lines[row])).collect();
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join(LOG), &log)?;
        for name in [JSON, HTML] {
            fs::write(folder.path().join(name), OLD)?;
        }
        Ok(Self {
            retarder: retarder.to_owned(),
            folder,
            log,
        })
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.retarder);
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command
    }

    /// Diagnoses, and kills the command after `time`.
    fn diagnose(&self, time: Duration) -> io::Result<limits::Ended> {
        let limits = Limits {
            time,
            ..Limits::default()
        };
        limits::run(&mut self.command(&DIAGNOSE), &limits)
    }

    /// Diagnoses, and kills the command some time after a temporary file appears; returns whether it was still running.
    fn diagnose_until_writing(&self, pause: Duration) -> io::Result<bool> {
        let mut running = self.command(&DIAGNOSE).spawn()?;
        while running.try_wait()?.is_none() {
            if !self.temporaries()?.is_empty() {
                thread::sleep(pause);
                running.kill()?;
                break;
            }
        }
        let status = running.wait()?;
        Ok(status.code().is_none())
    }

    /// Runs a quick command that writes into the folder.
    fn next_run(&self) -> io::Result<()> {
        let arguments = ["compare", "--log", LOG, "--json", NEXT];
        let status = self.command(&arguments).status()?;
        match status.code() {
            Some(0..=2) if self.folder.path().join(NEXT).exists() => Ok(()),
            _ => Err(io::Error::other(format!(
                "the next run ended with {status}"
            ))),
        }
    }

    fn outputs(&self) -> io::Result<[String; 2]> {
        let read = |name| fs::read_to_string(self.folder.path().join(name));
        Ok([read(JSON)?, read(HTML)?])
    }

    fn check_input(&self, kill: u64) -> Result<(), Loss> {
        let path = self.folder.path().join(LOG);
        match fs::read_to_string(&path) {
            Ok(text) if text == self.log => Ok(()),
            _ => Err(Loss::Input { kill, path }),
        }
    }

    fn temporaries(&self) -> io::Result<Vec<PathBuf>> {
        let known = [LOG, JSON, HTML, NEXT];
        let mut files = files_below(self.folder.path())?;
        files.retain(|path| is_temporary(path) || !known.iter().any(|name| path.ends_with(name)));
        Ok(files)
    }
}
