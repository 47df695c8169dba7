//! Options of the command line.

use std::path::PathBuf;

use hil_harness::campaign::{FaultClass, Injection};

/// Default number of runs of a campaign.
const RUNS: u64 = 2000;

/// Parsed options.
pub(crate) struct Options {
    pub(crate) work: Work,
    pub(crate) dut: Dut,
    /// ELF file of the image.
    pub(crate) image: Option<PathBuf>,
}

pub(crate) enum Work {
    Campaign {
        runs: u64,
        seed: u64,
        classes: Vec<FaultClass>,
    },
    Reproduce(Injection),
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dut {
    InProcess,
    Qemu,
}

impl Options {
    /// Parses the words after the program's name.
    pub(crate) fn from_arguments(
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Self, String> {
        let (mut runs, mut seed, mut classes, mut line) = (RUNS, 1, Vec::new(), None);
        let (mut dut, mut image) = (Dut::InProcess, None);
        while let Some(option) = arguments.next() {
            let value = arguments
                .next()
                .ok_or_else(|| format!("{option} needs a value"))?;
            let wrong = |wanted: &str| format!("{option} {value}: {wanted} is wanted");
            match option.as_str() {
                "--runs" => runs = value.parse().map_err(|_| wanted_number(&wrong))?,
                "--seed" => seed = value.parse().map_err(|_| wanted_number(&wrong))?,
                "--class" => classes.push(value.parse().map_err(|error| format!("{error}"))?),
                "--reproduce" => line = Some(value.parse().map_err(|error| format!("{error}"))?),
                "--image" => image = Some(PathBuf::from(value)),
                "--dut" if value == "in-process" => dut = Dut::InProcess,
                "--dut" if value == "qemu" => dut = Dut::Qemu,
                "--dut" => return Err(wrong("in-process or qemu")),
                _ => {
                    return Err(format!(
                        "there is no option {option}: --runs, --seed, --class, --reproduce, --dut, --image"
                    ));
                }
            }
        }
        if classes.is_empty() {
            classes = FaultClass::all().collect();
        }
        let work = match line {
            Some(injection) => Work::Reproduce(injection),
            None => Work::Campaign {
                runs,
                seed,
                classes,
            },
        };
        Ok(Self { work, dut, image })
    }
}

fn wanted_number(wrong: &dyn Fn(&str) -> String) -> String {
    wrong("a number from 0 on")
}
