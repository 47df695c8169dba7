//! Runs of many cases in parallel.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use thiserror::Error;

use super::case::Case;
use super::commands::{Effort, Name};
use super::finding::{Finding, Said};
use super::limits::{self, Ended, Limits};
use super::originals::{Bench, OriginalsError, benches, name_of, project};
use super::served;
use super::table::Table;

/// Cases to run, with their limits.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// Path of the program.
    pub retarder: PathBuf,
    /// Seed of all cases.
    pub seed: u64,
    /// Numbers of the cases.
    pub cases: std::ops::Range<u64>,
    /// Number of parallel runs.
    pub jobs: usize,
    /// Limits of each run.
    pub limits: Limits,
    /// Commands to draw from.
    pub effort: Effort,
    /// Folder that gets a subfolder for each case with a finding.
    pub failures: PathBuf,
    /// Whether it also gets one for each case without a finding.
    pub keeps_all: bool,
}

/// Reason why a campaign cannot continue.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// The bundled data differs from its expected form.
    #[error(transparent)]
    Originals(#[from] OriginalsError),
    /// The program cannot run in a folder of its own.
    #[error("case {0}: {1}")]
    Run(u64, #[source] io::Error),
}

/// Case with a finding.
#[derive(Debug)]
pub struct Failure {
    /// Finding.
    pub finding: Finding,
    /// Case.
    pub case: Case,
    /// Folder with the files, the command line and the output of the run.
    pub folder: PathBuf,
}

impl Campaign {
    /// Runs the cases until the last or until `is_interrupted`, and counts them. `report` gets the counts after each
    /// case, and the failure if there was one.
    ///
    /// # Errors
    /// Returns an error if the program does not start or its files cannot be written.
    pub fn run(
        &self,
        is_interrupted: &AtomicBool,
        report: impl Fn(&Table, Option<&Failure>) + Sync,
    ) -> Result<Table, CampaignError> {
        let mut benches = benches()?;
        if self.effort == Effort::All {
            benches.push(project(&self.retarder)?);
        }
        let (next, table) = (
            AtomicU64::new(self.cases.start),
            Mutex::new(Table::default()),
        );
        let work = || -> Result<(), CampaignError> {
            let folder = tempfile::tempdir().map_err(|error| CampaignError::Run(0, error))?;
            while !is_interrupted.load(Ordering::Relaxed) {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= self.cases.end {
                    break;
                }
                let case = self.case(&benches, number);
                let failed = |error| CampaignError::Run(number, error);
                let (ended, said) = self.one(&case, folder.path()).map_err(failed)?;
                // Ctrl-C also reaches the program.
                if is_interrupted.load(Ordering::Relaxed) {
                    break;
                }
                let finding = Finding::of(&ended, &self.limits, &said);
                let name = case.command.name;
                if finding.is_none() && self.keeps_all {
                    self.keep(&case, "kept", &ended, &said).map_err(failed)?;
                }
                let failure = match finding {
                    None => None,
                    Some(finding) => {
                        let word = finding.to_string();
                        let folder = self.keep(&case, &word, &ended, &said).map_err(failed)?;
                        Some(Failure {
                            finding,
                            case,
                            folder,
                        })
                    }
                };
                let mut table = table.lock().expect("no thread panics while it counts");
                table.add(name, number, &ended, finding);
                report(&table, failure.as_ref());
            }
            Ok(())
        };
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..self.jobs.max(1)).map(|_| scope.spawn(work)).collect();
            workers
                .into_iter()
                .try_for_each(|worker| worker.join().expect("a worker does not panic"))
        })?;
        Ok(table.into_inner().expect("no thread panicked"))
    }

    /// Returns the case of a number.
    pub fn case(&self, benches: &[Bench], number: u64) -> Case {
        Case::draw(benches, self.seed, number, self.effort)
    }

    /// Runs a case in `folder`, which is emptied first.
    fn one(&self, case: &Case, folder: &Path) -> io::Result<(Ended, Said)> {
        empty(folder)?;
        case.write(folder)?;
        let (out, err) = (folder.join(STANDARD_OUTPUT), folder.join(STANDARD_ERROR));
        let mut command = Command::new(&self.retarder);
        command
            .args(&case.command.arguments)
            .current_dir(folder)
            .env("NO_COLOR", "1")
            .env("COLUMNS", "100")
            .stdin(match case.command.standard_input {
                Some(role) => Stdio::from(File::open(folder.join(name_of(role)))?),
                None => Stdio::null(),
            })
            .stdout(File::create(&out)?)
            .stderr(File::create(&err)?);
        let ended = if case.command.name == Name::Serve {
            let talk = |server: &mut Child| served::talk(server, case);
            limits::run_and(command.stdout(Stdio::piped()), &self.limits, talk)?
        } else {
            limits::run(&mut command, &self.limits)?
        };
        let mut said = Said {
            standard_output: fs::read(out)?,
            standard_error: fs::read(err)?,
            wrote: Vec::new(),
            has_disturbed_files: has_disturbed_files(case, folder)?,
        };
        for name in ["out.json", "out.csv"] {
            let path = folder.join(name);
            if path.exists() {
                said.wrote.push(fs::read(path)?);
            }
        }
        let is_json = case
            .command
            .arguments
            .last()
            .is_some_and(|last| last == "--json");
        if is_json {
            said.wrote.push(said.standard_output.clone());
        }
        Ok((ended, said))
    }

    /// Stores the files of a case with all that is needed to repeat it; returns the folder.
    fn keep(&self, case: &Case, word: &str, ended: &Ended, said: &Said) -> io::Result<PathBuf> {
        let (number, seed) = (case.number, self.seed);
        let folder = self.failures.join(format!("{word}-{seed}-{number}"));
        fs::create_dir_all(&folder)?;
        case.write(&folder)?;
        let text = format!(
            "{word}: case {number} of seed {seed}\n{}\n$ {}\n{}, {:.2} s, {:.2} s on processors, {:.1} MB\n\n{}",
            case.story(),
            case.line(),
            ended.status,
            ended.elapsed.as_secs_f64(),
            ended.processor_time.as_secs_f64(),
            ended.peak_bytes as f64 / 1e6,
            String::from_utf8_lossy(&said.standard_error[..said.standard_error.len().min(20_000)]),
        );
        fs::write(folder.join("finding.txt"), text)?;
        Ok(folder)
    }
}

const STANDARD_OUTPUT: &str = "standard-output";
const STANDARD_ERROR: &str = "standard-error";

/// Files that a command may leave.
const OUTPUTS: [&str; 5] = ["out.csv", "out.mf4", "out.json", "out.html", "out.toml"];

fn empty(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(entry.path())?;
        } else {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Returns whether an input changed, or an unexpected file exists.
fn has_disturbed_files(case: &Case, folder: &Path) -> io::Result<bool> {
    // The server works in its folder.
    if case.command.name == Name::Serve {
        return Ok(false);
    }
    for file in &case.files {
        if fs::read(folder.join(&file.path))? != file.bytes {
            return Ok(true);
        }
    }
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let is_input = case.files.iter().any(|file| file.path == Path::new(&name));
        let is_output = OUTPUTS.iter().any(|output| name == *output)
            || name == STANDARD_OUTPUT
            || name == STANDARD_ERROR;
        if !is_input && !is_output {
            return Ok(true);
        }
    }
    Ok(false)
}
