//! Draws field rigs, runs them in the reference plant, and writes logs, plant files and sealed answers.

use std::fs;

use super::super::draw::plan::Dose;
use super::super::draw::{DrawError, departures, hidden, only, write_rig, write_rigs};
use super::super::format::Folders;
use super::format::{FIELD_SCHEMA, FieldAnswer};
use super::logger::record;
use super::ordinary::{first_file, parameters};
pub use super::plan::Effects;
use super::plan::FieldPlan;
use super::removal::costs;
use crate::chance::Chance;

/// Field rigs of a seed.
#[derive(Debug, Clone)]
pub struct FieldDraw {
    seed: u64,
    /// Noise and converter steps of the loggers relative to those that are drawn.
    sensor_share: f64,
    /// Effects by the number of the rig, from 1.
    doses: Vec<(usize, Vec<Dose>)>,
}

/// Drawn field rig.
#[derive(Debug, Clone)]
pub struct FieldRig {
    /// Answer.
    pub answer: FieldAnswer,
    /// Plant file that a user would have.
    pub plant: String,
    /// Id log and check log of the rig, as CSV.
    pub logs: [String; 2],
}

/// Returns the random numbers of the rig with this number.
fn chance_of(seed: u64, number: usize) -> Chance {
    Chance::of(seed, number as u64)
}

impl FieldDraw {
    /// Plans the first `rigs` rigs of `seed`, each with a number of hidden effects.
    pub fn new(seed: u64, rigs: usize, effects: Effects) -> Self {
        let mut chance = Chance::new(seed);
        let doses = (1..=rigs).map(|number| {
            let plan = FieldPlan::draw(number, &mut chance_of(seed, number));
            (number, effects.draw(plan.begins_warm(), &mut chance))
        });
        Self {
            seed,
            sensor_share: 1.0,
            doses: doses.collect(),
        }
    }

    /// Gives the same loggers better sensors: this share of the noise and of the converter steps.
    #[must_use]
    pub fn with_sensor_share(mut self, share: f64) -> Self {
        self.sensor_share = share;
        self
    }

    /// Keeps the rigs with one of `numbers`, as they are in the whole draw.
    ///
    /// # Errors
    /// Returns an error if no rig has one of the numbers.
    pub fn only(mut self, numbers: &[usize]) -> Result<Self, DrawError> {
        only(&mut self.doses, numbers)?;
        Ok(self)
    }

    /// Returns the number of rigs.
    pub fn count(&self) -> usize {
        self.doses.len()
    }

    /// Runs one of these rigs.
    pub fn rig(&self, index: usize) -> FieldRig {
        let (number, doses) = &self.doses[index];
        let mut chance = chance_of(self.seed, *number);
        let FieldPlan {
            plain,
            mut logger,
            logs,
        } = FieldPlan::draw(*number, &mut chance);
        logger.sensor_share = self.sensor_share;
        let rig = plain.with(departures(doses, &plain));
        let recorded = logs.each_ref();
        let [id, check] = recorded.map(|plan| record(&rig, &logger, plan, &mut chance));
        let cost_if_left_out = costs(&plain, doses, &logger, &logs[1], &check.run);
        FieldRig {
            answer: FieldAnswer {
                schema: FIELD_SCHEMA.to_owned(),
                rig: format!("rig-{number:03}"),
                hidden: doses.iter().map(|dose| hidden(dose, &plain)).collect(),
                cost_if_left_out,
                is_vent_normally_open: plain.is_vent_normally_open,
                parameters: parameters(&plain),
                logger,
                logs: [id.answer, check.answer],
            },
            plant: first_file(plain.is_vent_normally_open),
            logs: [id.text, check.text],
        }
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
            let FieldRig {
                answer,
                plant,
                logs,
            } = self.rig(index);
            let path = folders.plant(&answer.rig);
            fs::write(&path, plant).map_err(|error| DrawError::Write(path, error))?;
            write_rig(folders, &answer.rig, &logs, &answer)
        })
    }
}
