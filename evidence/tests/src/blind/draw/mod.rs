//! Draws rigs, runs them in the reference plant, and writes logs and sealed answers.

mod closed_loop;
pub(super) mod log;
pub(super) mod plan;
pub(super) mod profile;

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;
use thiserror::Error;

use super::format::{Answer, Class, Folders, Hidden, Poor, Profile, SCHEMA};
use crate::chance::Chance;
use crate::reference_plant::catalogue::forms;
use crate::reference_plant::{
    Departures, Reading, ReferencePlant, Rig, SCATTERED, Scatter, replay,
};
use log::Logger;
pub use plan::Counts;
use plan::{Dose, Plan};
use profile::Commands;

/// Length of a good id log and of a good check log (samples).
const GOOD_LENGTHS: [usize; 2] = [6000, 4000];

/// Reason why a draw failed.
#[derive(Debug, Error)]
pub enum DrawError {
    /// The folder is not empty and may contain another draw.
    #[error("{} is there already; draw into a folder that is not", .0.display())]
    Occupied(PathBuf),
    /// No rig of the draw has this number.
    #[error("there is no rig {0}: this draw has rigs 1 to {1}")]
    NoSuchRig(usize, usize),
    /// A file or a folder could not be written.
    #[error("{} cannot be written: {}", .0.display(), .1)]
    Write(PathBuf, #[source] io::Error),
}

/// Drawn rig.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// Hidden effects.
    pub answer: Answer,
    /// Id log and check log of the rig, as CSV.
    pub logs: [String; 2],
}

/// Rigs of a seed.
#[derive(Debug, Clone)]
pub struct Draw {
    seed: u64,
    /// Plans by the number of the rig, from 1.
    plans: Vec<(usize, Plan)>,
}

/// Rig of a seed as it was drawn. It stays the same if the catalogue of effects, and thus the plan of the draw,
/// changes.
#[derive(Debug, Clone, Copy)]
pub struct KnownRig {
    /// Seed of its draw.
    pub seed: u64,
    /// Number in its draw, from 1.
    pub number: usize,
    /// Class.
    pub class: Class,
    /// Shortcoming of its logs.
    pub poor: Option<Poor>,
    /// Effect, law, size over the typical one, and shape of each hidden effect.
    pub hidden: &'static [(&'static str, &'static str, f64, f64)],
}

impl KnownRig {
    /// Runs the rig.
    ///
    /// # Panics
    /// Panics if the catalogue does not have one of the laws.
    pub fn run(&self) -> Drawn {
        let dose = |&(effect, law, size_over_typical, shape): &(&str, &str, f64, f64)| Dose {
            form: forms()
                .find(|form| (form.effect, form.law) == (effect, law))
                .unwrap_or_else(|| panic!("no {effect}: {law}")),
            size_over_typical,
            shape,
        };
        let plan = Plan {
            class: self.class,
            poor: self.poor,
            hidden: self.hidden.iter().map(dose).collect(),
        };
        rig(self.seed, self.number, &plan)
    }
}

impl Draw {
    /// Plans the rigs of `seed`, without running them.
    pub fn new(seed: u64, counts: Counts) -> Self {
        let plans = plan::plans(counts, &mut Chance::new(seed));
        Self {
            seed,
            plans: (1..).zip(plans).collect(),
        }
    }

    /// Keeps the rigs with one of `numbers`, as they are in the whole draw.
    ///
    /// # Errors
    /// Returns an error if no rig has one of the numbers.
    pub fn only(mut self, numbers: &[usize]) -> Result<Self, DrawError> {
        only(&mut self.plans, numbers)?;
        Ok(self)
    }

    /// Returns the number of rigs.
    pub fn count(&self) -> usize {
        self.plans.len()
    }

    /// Runs one of these rigs.
    pub fn rig(&self, index: usize) -> Drawn {
        let (number, plan) = &self.plans[index];
        rig(self.seed, *number, plan)
    }

    /// Runs all rigs on `threads` threads and writes them into `folders`; `progress` gets the number of finished rigs.
    ///
    /// # Errors
    /// Returns an error if the folder exists, or a file cannot be written.
    pub fn write(
        &self,
        folders: &Folders,
        threads: usize,
        progress: impl Fn(usize) + Sync,
    ) -> Result<(), DrawError> {
        write_rigs(folders, threads, self.count(), progress, |index| {
            self.rig(index).write(folders)
        })
    }
}

/// Writes `count` rigs into `folders` on `threads` threads; `progress` gets the number of finished rigs.
///
/// # Errors
/// Returns an error if the folder exists, or a file cannot be written.
pub(super) fn write_rigs(
    folders: &Folders,
    threads: usize,
    count: usize,
    progress: impl Fn(usize) + Sync,
    write: impl Fn(usize) -> Result<(), DrawError> + Sync,
) -> Result<(), DrawError> {
    if folders.logs().exists() || folders.sealed().exists() {
        return Err(DrawError::Occupied(folders.root().to_owned()));
    }
    for folder in [folders.logs(), folders.sealed()] {
        fs::create_dir_all(&folder).map_err(|error| DrawError::Write(folder, error))?;
    }
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || -> Result<(), DrawError> {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return Ok(());
            }
            write(index)?;
            progress(1 + done.fetch_add(1, Ordering::Relaxed));
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })
}

impl Drawn {
    /// Writes logs and answer into `folders`, which exist.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn write(&self, folders: &Folders) -> Result<(), DrawError> {
        write_rig(folders, &self.answer.rig, &self.logs, &self.answer)
    }
}

/// Writes the logs and the answer of one rig into `folders`, which exist.
///
/// # Errors
/// Returns an error if a file cannot be written.
pub(super) fn write_rig(
    folders: &Folders,
    rig: &str,
    [id, check]: &[String; 2],
    answer: &impl Serialize,
) -> Result<(), DrawError> {
    let answer = serde_json::to_string_pretty(answer).expect("an answer is plain data");
    for (path, text) in [
        (folders.id_log(rig), id),
        (folders.check_log(rig), check),
        (folders.answer(rig), &answer),
    ] {
        fs::write(&path, text).map_err(|error| DrawError::Write(path, error))?;
    }
    Ok(())
}

/// Keeps the plans with these numbers, which count from 1.
///
/// # Errors
/// Returns an error if no rig has one of the numbers.
pub(super) fn only<T>(plans: &mut Vec<(usize, T)>, numbers: &[usize]) -> Result<(), DrawError> {
    let count = plans.len();
    if let Some(&number) = numbers.iter().find(|number| !(1..=count).contains(number)) {
        return Err(DrawError::NoSuchRig(number, count));
    }
    plans.retain(|(number, _)| numbers.contains(number));
    Ok(())
}

fn rig(seed: u64, number: usize, plan: &Plan) -> Drawn {
    let chance = &mut Chance::of(seed, number as u64 - 1);
    let scatter = Scatter([0.0; SCATTERED.len()].map(|_: f64| chance.between(-1.0, 1.0)));
    let plain = Rig::nominal().scattered(&scatter);
    let rig = plain.with(departures(&plan.hidden, &plain));
    let logger = logger(plan.poor);
    let profiles = profiles(plan.poor, chance);
    let lengths = match plan.poor {
        Some(Poor::Short) => [0; 2].map(|_| chance.whole(1000, 2000)),
        _ => GOOD_LENGTHS,
    };
    let mut runs = [0, 1].map(|n| {
        let commands = Commands::new(profiles[n], lengths[n], logger.samples_per_row, chance);
        Run::new(&rig, commands, lengths[n], &logger, chance)
    });
    let logs = runs.each_mut().map(|run| run.csv(&logger, chance));
    let raw_excess = if plan.hidden.is_empty() {
        BTreeMap::new()
    } else {
        raw_excess(&runs[1], &replay(&plain, &runs[1].commands))
    };
    Drawn {
        answer: Answer {
            schema: SCHEMA.to_owned(),
            rig: format!("rig-{number:03}"),
            class: plan.class,
            poor: plan.poor,
            hidden: plan
                .hidden
                .iter()
                .map(|dose| hidden(dose, &plain))
                .collect(),
            raw_excess,
            profiles,
            scatter: scatter.0.to_vec(),
        },
        logs,
    }
}

/// Returns the departures that these effects cause on a plain rig.
pub(super) fn departures(doses: &[Dose], plain: &Rig) -> Departures {
    let mut departures = Departures::default();
    for dose in doses {
        let size = dose.size_over_typical * dose.form.typical;
        dose.form
            .apply(size, dose.shape, &plain.datasheet, &mut departures);
    }
    departures
}

/// Returns the entry of an answer for an effect on a plain rig.
pub(super) fn hidden(dose: &Dose, plain: &Rig) -> Hidden {
    let form = dose.form;
    let size = dose.size_over_typical * form.typical;
    Hidden {
        effect: form.effect.to_owned(),
        law: form.law.to_owned(),
        kinship: form.kinship,
        same: form.same.iter().map(|&id| id.to_owned()).collect(),
        size,
        unit: form.unit.to_owned(),
        size_over_typical: dose.size_over_typical,
        shape: dose.shape,
        parameter: form
            .library_parameter(size, dose.shape, &plain.datasheet)
            .map(|(name, value)| (name.to_owned(), value)),
    }
}

fn logger(poor: Option<Poor>) -> Logger {
    Logger {
        noise: if poor == Some(Poor::Noisy) { 3.0 } else { 1.0 },
        samples_per_row: if poor == Some(Poor::Slow) { 5 } else { 1 },
        pressure: poor != Some(Poor::CurrentsOnly),
        currents: poor != Some(Poor::PressureOnly),
    }
}

/// Draws the command profiles of the id log and the check log.
pub(super) fn profiles(poor: Option<Poor>, chance: &mut Chance) -> [Profile; 2] {
    use Profile::{Bench, Chance as ByChance, ClosedLoop, Pulses, Restless};
    match poor {
        Some(Poor::NoHold) => [Restless; 2],
        Some(Poor::Short) => [ByChance; 2],
        Some(_) => [Bench, ByChance],
        None => chance.one_of(&[
            [Bench, ByChance],
            [Bench, ClosedLoop],
            [ByChance, Pulses],
            [ClosedLoop, ClosedLoop],
            [Pulses, Bench],
        ]),
    }
}

/// Run of a rig with commands.
struct Run {
    commands: Vec<[f64; 2]>,
    readings: Vec<Reading>,
    /// Pressures that the ECU read (bar gauge).
    pressures: Vec<f64>,
}

impl Run {
    fn new(
        rig: &Rig,
        mut commands: Commands,
        samples: usize,
        logger: &Logger,
        chance: &mut Chance,
    ) -> Self {
        let mut plant = ReferencePlant::new(rig);
        let mut run = Self {
            commands: Vec::with_capacity(samples),
            readings: Vec::with_capacity(samples),
            pressures: Vec::with_capacity(samples),
        };
        for n in 0..samples {
            let reading = plant.reading();
            assert!(
                reading.pressure.is_finite(),
                "the reference plant's step is too long for this rig"
            );
            let pressure = logger.pressure(&reading, chance);
            let command = commands.at(n, pressure);
            plant.run(command);
            run.readings.push(reading);
            run.pressures.push(pressure);
            run.commands.push(command);
        }
        run
    }

    fn csv(&self, logger: &Logger, chance: &mut Chance) -> String {
        logger.csv(&self.commands, &self.readings, &self.pressures, chance)
    }
}

/// Returns the difference between a run and that of the plain rig, by signal: rms in units of the noise of a good log.
fn raw_excess(run: &Run, plain: &[Reading]) -> BTreeMap<String, f64> {
    let mut sums: BTreeMap<String, f64> = BTreeMap::new();
    for (with, without) in run.readings.iter().zip(plain) {
        for ((signal, with), (_, without)) in log::signals(with).iter().zip(log::signals(without)) {
            let error = (with - without) / log::noise_of(signal);
            *sums.entry((*signal).to_owned()).or_default() += error * error;
        }
    }
    for sum in sums.values_mut() {
        *sum = (*sum / plain.len() as f64).sqrt();
    }
    sums
}
