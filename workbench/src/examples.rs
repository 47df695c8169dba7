//! Bundled logs and plants: the practice rigs, and published measurements of other authors.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::project::PlantFile;

/// Example in the list of the page.
#[derive(Serialize)]
pub(crate) struct Example {
    id: &'static str,
    group: &'static str,
    title: &'static str,
    about: &'static str,
}

/// Files that an example opens.
pub(crate) struct Files {
    pub(crate) logs: Vec<Log>,
    /// Plant; `None` is the thesis model.
    pub(crate) plant: Option<PlantFile>,
    /// Tolerances of signals whose noise the log does not show.
    pub(crate) tolerances: BTreeMap<String, f64>,
}

pub(crate) struct Log {
    pub(crate) name: &'static str,
    pub(crate) bytes: &'static [u8],
    pub(crate) mapping: Option<&'static str>,
}

/// Row of the list.
struct Entry {
    listed: Example,
    logs: &'static [Row],
    plant: Option<(&'static str, &'static str)>,
    tolerances: &'static [(&'static str, f64)],
}

type Row = (&'static str, &'static [u8], Option<&'static str>);

macro_rules! data {
    ($path:literal) => {
        include_str!(concat!("../../data/", $path))
    };
}

macro_rules! practice {
    ($number:literal, $about:literal $(, $scope:literal)*) => {
        Entry {
            listed: Example {
                id: concat!("practice-", $number),
                group: "Practice rigs",
                title: concat!("Rig ", $number),
                about: $about,
            },
            logs: &[
                practice!(@log concat!("practice-", $number, "-id.csv"), None),
                practice!(@log concat!("practice-", $number, "-check.csv"), None),
                $(practice!(@log concat!("practice-", $number, "-scope-", $scope, ".csv"), Some(data!("synthetic/scope.toml"))),)*
            ],
            plant: None,
            tolerances: &[],
        }
    };
    (@log $name:expr, $mapping:expr) => {
        ($name, include_bytes!(concat!("../../data/synthetic/", $name)), $mapping)
    };
}

macro_rules! rigs {
    ($($number:literal $(+ $scope:literal)*),* $(,)?) => {
        &[$(practice!($number, "60 s of duty steps to find what is missing, 40 s of other commands to check it." $(, $scope)*)),*]
    };
}

const PRACTICE: &[Entry] = rigs![
    "00" + "40" + "75",
    "01",
    "02",
    "03" + "40" + "75",
    "04",
    "05",
    "06",
    "07",
    "08"
];

const REAL: &[Entry] = &[
    Entry {
        listed: Example {
            id: "leakdown-015",
            group: "Real measurements",
            title: "Leak-down of a printed actuator",
            about: "A closed chamber, printed in layers of 0.15 mm, loses its air; its mapping cuts the log. EvaZillen, CC0.",
        },
        logs: &[(
            "leakdown-ultimaker-015.csv",
            include_bytes!("../../data/real/leakdown-ultimaker-015.csv"),
            Some(data!("real/leakdown-ultimaker-015.toml")),
        )],
        plant: Some((
            "leakdown-chamber.toml",
            data!("plants/leakdown-chamber.toml"),
        )),
        tolerances: &[],
    },
    Entry {
        listed: Example {
            id: "leakdown-020",
            group: "Real measurements",
            title: "Leak-down of a second actuator",
            about: "The same test with layers of 0.20 mm. EvaZillen, CC0.",
        },
        logs: &[(
            "leakdown-ultimaker-020.csv",
            include_bytes!("../../data/real/leakdown-ultimaker-020.csv"),
            Some(data!("real/leakdown-ultimaker-020.toml")),
        )],
        plant: Some((
            "leakdown-chamber.toml",
            data!("plants/leakdown-chamber.toml"),
        )),
        tolerances: &[],
    },
    Entry {
        listed: Example {
            id: "leakdown-aluminium",
            group: "Real measurements",
            title: "Leak-down of an aluminium chamber",
            about: "The tight one of the three. EvaZillen, CC0.",
        },
        logs: &[(
            "leakdown-aluminium.csv",
            include_bytes!("../../data/real/leakdown-aluminium.csv"),
            None,
        )],
        plant: Some((
            "leakdown-chamber.toml",
            data!("plants/leakdown-chamber.toml"),
        )),
        tolerances: &[],
    },
    Entry {
        listed: Example {
            id: "blowdown",
            group: "Real measurements",
            title: "Blow-down of an air vessel",
            about: "16 l of air through an orifice: pressure and gas temperature. HydDown, MIT.",
        },
        logs: &[(
            "blowdown-air-790kPa.csv",
            include_bytes!("../../data/real/blowdown-air-790kPa.csv"),
            None,
        )],
        plant: Some((
            "air-vessel-790kPa.toml",
            data!("plants/air-vessel-790kPa.toml"),
        )),
        tolerances: &[("p_ch", 0.05), ("t_gas", 1.0)],
    },
    Entry {
        listed: Example {
            id: "inrush-switching",
            group: "Real measurements",
            title: "Inrush current of a valve that switches",
            about: "20 kHz of coil current, with the dip of the armature. ValveInsight, MIT.",
        },
        logs: &[(
            "inrush-burkert6724-switching.csv",
            include_bytes!("../../data/real/inrush-burkert6724-switching.csv"),
            Some(data!("real/inrush.toml")),
        )],
        plant: Some((
            "burkert-6724-valve.toml",
            data!("plants/burkert-6724-valve.toml"),
        )),
        tolerances: &[("i_fill", 0.7)],
    },
    Entry {
        listed: Example {
            id: "inrush-blocked",
            group: "Real measurements",
            title: "Inrush current of a blocked valve",
            about: "The same coil, its armature held. ValveInsight, MIT.",
        },
        logs: &[(
            "inrush-burkert6724-blocked.csv",
            include_bytes!("../../data/real/inrush-burkert6724-blocked.csv"),
            Some(data!("real/inrush.toml")),
        )],
        plant: Some((
            "burkert-6724-coil.toml",
            data!("plants/burkert-6724-coil.toml"),
        )),
        tolerances: &[("i_fill", 0.7)],
    },
];

fn entries() -> impl Iterator<Item = &'static Entry> {
    PRACTICE.iter().chain(REAL)
}

/// Returns all examples, in the order of the list.
pub(crate) fn all() -> Vec<&'static Example> {
    entries().map(|entry| &entry.listed).collect()
}

/// Returns the files of an example; `None` for an unknown id.
pub(crate) fn files(id: &str) -> Option<Files> {
    let entry = entries().find(|entry| entry.listed.id == id)?;
    let log = |&(name, bytes, mapping): &Row| Log {
        name,
        bytes,
        mapping,
    };
    Some(Files {
        logs: entry.logs.iter().map(log).collect(),
        plant: entry.plant.map(|(name, toml)| PlantFile {
            name: name.to_owned(),
            toml: toml.to_owned(),
        }),
        tolerances: entry
            .tolerances
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use model_lab::{CompareOptions, compare};
    use recording::csv::{Mapping, Options, read};

    use super::*;

    /// Every log of each example can be read and compared with its plant.
    #[test]
    fn every_example_can_be_compared() {
        for example in all() {
            let files = files(example.id).unwrap();
            let plant = files.plant.unwrap_or_else(PlantFile::nominal);
            let parameters = plant.parameters().unwrap();
            for log in &files.logs {
                let mapping = match log.mapping {
                    Some(text) => Mapping::parse(log.name, text).unwrap(),
                    None => Mapping::default(),
                };
                let options = Options {
                    mapping,
                    ..Options::default()
                };
                let recording = read(log.name, log.bytes, &options).unwrap();
                // One practice rig represents all: they are similar, and each takes a second.
                if example.group == "Practice rigs" && example.id != "practice-00" {
                    continue;
                }
                let options = CompareOptions {
                    tolerances: files.tolerances.clone(),
                    ..CompareOptions::default()
                };
                let compared = compare(&parameters, &recording, &options);
                assert!(compared.is_ok(), "{}: {:?}", log.name, compared.err());
            }
        }
    }
}
