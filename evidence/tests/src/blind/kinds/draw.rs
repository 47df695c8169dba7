//! Draws rigs of other kinds, runs them, and writes logs, plates and sealed answers.

use std::collections::BTreeMap;
use std::fs;

use super::super::draw::{DrawError, write_rig, write_rigs};
use super::super::format::Folders;
use super::format::{KIND_SCHEMA, KindAnswer};
use super::known::lines;
use super::logger::{csv, differences, run};
use super::plan::KindPlan;
use super::plate::{plate, true_plate};
use super::profile::commands;
use crate::chance::Chance;

/// Values that replace drawn ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wishes {
    /// Number of hidden effects, 0 to 5.
    pub effects: Option<usize>,
    /// Lengths of the id log and of the check log (s).
    pub lengths_s: Option<[f64; 2]>,
    /// Rows per second (Hz).
    pub rate_hz: Option<f64>,
}

/// Rigs of a seed. The kinds take turns; rig 1 is a pair of on/off valves.
#[derive(Debug, Clone)]
pub struct KindsDraw {
    seed: u64,
    rigs: usize,
    wishes: Wishes,
}

/// Drawn rig.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnKind {
    /// Answer.
    pub answer: KindAnswer,
    /// Plate, TOML.
    pub plate: String,
    /// Plate with the true values, TOML.
    pub true_plate: String,
    /// Id log and check log, CSV.
    pub logs: [String; 2],
}

impl KindsDraw {
    /// Plans the first `rigs` rigs of `seed`.
    pub fn new(seed: u64, rigs: usize, wishes: Wishes) -> Self {
        Self { seed, rigs, wishes }
    }

    /// Runs the rig with this number, from 1.
    pub fn rig(&self, number: usize) -> DrawnKind {
        let mut chance = Chance::of(self.seed, number as u64);
        let plan = KindPlan::draw(number, &self.wishes, &mut chance);
        let lines = lines(&plan.rig);
        let plate = plate(&plan, &lines, &mut chance);
        let KindPlan { rig, logger, .. } = &plan;
        let given = [0, 1].map(|log| commands(rig, logger, log, &mut chance));
        let rows = [0, 1].map(|log| run(rig, logger, log, &given[log]));
        let costs = plan.effects.iter().map(|effect| {
            let without = run(&effect.removed(rig), logger, 1, &given[1]);
            let costs = differences(logger, &rows[1], &without);
            (effect.id().to_owned(), costs)
        });
        let effects = plan.effects.iter();
        let effects = effects.map(|effect| (effect.id().to_owned(), effect.values(rig)));
        let mut truth: BTreeMap<String, f64> = lines
            .iter()
            .map(|line| (line.key.clone(), line.truth))
            .collect();
        let start_bar = 1e-5 * (rig.start_pa - rig.ambient_pa);
        truth.insert("start_pressure_bar_gauge".to_owned(), start_bar);
        DrawnKind {
            answer: KindAnswer {
                schema: KIND_SCHEMA.to_owned(),
                rig: format!("rig-{number:03}"),
                kind: plan.kind,
                truth,
                effects: effects.collect(),
                cost_if_left_out_noise_floors: costs.collect(),
                logger: logger.clone(),
            },
            plate,
            true_plate: true_plate(&lines),
            logs: rows.map(|rows| csv(rig, logger, &rows, &mut chance)),
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
        write_rigs(folders, threads, self.rigs, progress, |index| {
            let drawn = self.rig(index + 1);
            let path = folders.plate(&drawn.answer.rig);
            fs::write(&path, &drawn.plate).map_err(|error| DrawError::Write(path, error))?;
            write_rig(folders, &drawn.answer.rig, &drawn.logs, &drawn.answer)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: Wishes = Wishes {
        effects: Some(1),
        lengths_s: Some([12.0, 8.0]),
        rate_hz: None,
    };

    #[test]
    fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
        let written = |seed: u64, threads: usize| {
            let folder = tempfile::tempdir().unwrap();
            let folders = Folders::new(folder.path());
            let draw = KindsDraw::new(seed, 4, SHORT);
            draw.write(&folders, threads, |_| ()).unwrap();
            assert!(draw.write(&folders, threads, |_| ()).is_err());
            let mut files = BTreeMap::new();
            for part in [folders.logs(), folders.sealed()] {
                for entry in fs::read_dir(part).unwrap() {
                    let path = entry.unwrap().path();
                    let name = path.file_name().unwrap().to_owned();
                    files.insert(name, fs::read(path).unwrap());
                }
            }
            files
        };
        let first = written(1, 1);
        assert_eq!(first.len(), 16);
        assert_eq!(first, written(1, 2));
        let other = written(2, 2);
        assert!(first.iter().all(|(name, bytes)| other[name] != *bytes));
    }

    #[test]
    fn an_effect_that_is_left_out_costs_something_and_its_values_are_in_the_answer() {
        for number in 1..=8 {
            let answer = KindsDraw::new(1, 8, SHORT).rig(number).answer;
            let (effect, values) = answer.effects.first_key_value().unwrap();
            assert!(answer.cost(effect) > 0.0, "{answer:?}");
            assert!(values.values().all(|value| *value != 0.0), "{answer:?}");
        }
    }
}
