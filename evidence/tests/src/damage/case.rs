//! Case: files, some of them damaged, and the command that reads them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::bytes::{self, Mutation};
use super::commands::{self, CommandLine, Effort};
use super::originals::{Bench, File, Role, name_of};
use super::text;
use crate::chance::Chance;

/// Case drawn from a seed and its number alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Case {
    /// Number.
    pub number: u64,
    /// Bench of its files.
    pub bench: &'static str,
    /// Damage of its files.
    pub damages: Vec<(PathBuf, &'static str)>,
    /// Files, including the damaged ones.
    pub files: Vec<File>,
    /// Command that reads them.
    pub command: CommandLine,
}

/// Share of the cases without damage: these must also run.
const UNDAMAGED: f64 = 0.01;
/// Share of the cases with a project folder, each of which needs a server and takes a second.
const SERVED: f64 = 0.005;

impl Case {
    /// Draws the case of a seed and a number.
    pub fn draw(benches: &[Bench], seed: u64, number: u64, effort: Effort) -> Self {
        let mut chance = Chance::of(seed, number);
        let is_served = chance.happens(SERVED);
        let of_kind: Vec<_> = benches
            .iter()
            .filter(|bench| bench.file(Role::Project).is_some() == is_served)
            .collect();
        // Without a server, the numbers give other cases.
        let all: Vec<_> = benches.iter().collect();
        let bench = chance.one_of(if of_kind.is_empty() { &all } else { &of_kind });
        let command = commands::draw(bench, &mut chance, effort);
        let read = |file: &&File| command.reads.contains(&file.role);
        let mut files: Vec<File> = bench.files.iter().filter(read).cloned().collect();
        let mut damages = Vec::new();
        if !files.is_empty() && !chance.happens(UNDAMAGED) {
            loop {
                let at = chance.whole(0, files.len() - 1);
                damages.push((files[at].path.clone(), damage(&mut files[at], &mut chance)));
                if damages.len() == 8 || chance.happens(0.7) {
                    break;
                }
            }
        }
        Self {
            number,
            bench: bench.name,
            damages,
            files,
            command,
        }
    }

    /// Writes the files into a folder.
    ///
    /// # Errors
    /// Returns an error if one cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        for file in &self.files {
            let path = folder.join(&file.path);
            fs::create_dir_all(path.parent().unwrap_or(folder))?;
            fs::write(path, &file.bytes)?;
        }
        Ok(())
    }

    /// Returns the command line to type in the folder of the files.
    pub fn line(&self) -> String {
        let mut line = format!("retarder {}", self.command.arguments.join(" "));
        if let Some(role) = self.command.standard_input {
            line += &format!(" < {}", name_of(role).display());
        }
        line
    }

    /// Returns the damage in words.
    pub fn story(&self) -> String {
        let mut story = format!("bench: {}\n", self.bench);
        for (path, name) in &self.damages {
            story += &format!("{}: {name}\n", path.display());
        }
        story
    }
}

/// Damages a file with a kind of damage that fits its format.
fn damage(file: &mut File, chance: &mut Chance) -> &'static str {
    // Most damage leaves a readable file, so that the code after the reader is also tested.
    let fitting: &[(&[Mutation], usize)] = match file.role {
        Role::Log | Role::Reference => &[
            (&text::TABLE, 6),
            (&text::NUMBER, 3),
            (&text::ANY, 1),
            (&bytes::ANY, 1),
        ],
        Role::Project if file.path.extension().is_none() => &[(&bytes::ANY, 1)],
        Role::Mf4Log => &[(&bytes::MF4, 4), (&bytes::ANY, 1)],
        Role::TableLog => &[(&bytes::ANY, 1)],
        Role::Mapping | Role::Plant | Role::Controller | Role::Project => &[
            (&text::NUMBER, 6),
            (&text::KEYS, 2),
            (&text::ANY, 1),
            (&bytes::ANY, 1),
        ],
    };
    let mut left = chance.whole(
        0,
        fitting.iter().map(|(_, weight)| weight).sum::<usize>() - 1,
    );
    let (mut ways, _) = fitting[0];
    for (other, weight) in fitting {
        ways = other;
        if left < *weight {
            break;
        }
        left -= weight;
    }
    let (name, way) = chance.one_of(ways);
    way(&mut file.bytes, chance);
    name
}

#[cfg(test)]
mod tests {
    use super::super::originals::benches;
    use super::*;

    #[test]
    fn a_case_comes_again_from_its_seed_and_number() {
        let benches = benches().unwrap();
        let draw = |seed, number| Case::draw(&benches, seed, number, Effort::All);
        for number in 0..200 {
            assert_eq!(draw(1, number), draw(1, number));
        }
        assert_ne!(draw(1, 5), draw(2, 5));
    }

    #[test]
    fn every_command_role_and_way_is_drawn() {
        let benches = benches().unwrap();
        let mut commands = Vec::new();
        let mut damages = Vec::new();
        for number in 0..20_000 {
            let case = Case::draw(&benches, 1, number, Effort::All);
            commands.push(case.command.name);
            damages.extend(case.damages);
        }
        commands.sort();
        commands.dedup();
        assert_eq!(
            commands.len(),
            commands::Name::ALL.len() - 1,
            "all but the server"
        );
        let ways = |role: Role| {
            let mut names: Vec<_> = damages
                .iter()
                .filter(|(of, _)| *of == name_of(role))
                .map(|(_, name)| *name)
                .collect();
            names.sort_unstable();
            names.dedup();
            names.len()
        };
        assert_eq!(
            ways(Role::Log),
            text::TABLE.len() + text::NUMBER.len() + text::ANY.len() + bytes::ANY.len()
        );
        assert_eq!(ways(Role::Mf4Log), bytes::MF4.len() + bytes::ANY.len());
        assert_eq!(ways(Role::TableLog), bytes::ANY.len());
        for role in [Role::Mapping, Role::Plant, Role::Controller] {
            assert_eq!(
                ways(role),
                text::KEYS.len() + text::NUMBER.len() + text::ANY.len() + bytes::ANY.len(),
                "{role:?}"
            );
        }
    }
}
