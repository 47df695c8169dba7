//! Small valid inputs of every kind that the program reads, made from the bundled data.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use plant_sim::PlantParameters;
use plant_sim::effects::LIBRARY;
use recording::{csv, mf4};
use serde_json::json;
use thiserror::Error;

use super::commands::Effort;
use crate::bench_log::repository;
use crate::served::{Server, files_below};

/// Role of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Bench log, CSV.
    Log,
    /// Bench log, MF4.
    Mf4Log,
    /// Bench log, Parquet or MATLAB.
    TableLog,
    /// Mapping of the columns or channels of a log.
    Mapping,
    /// Plant file.
    Plant,
    /// Controller file.
    Controller,
    /// Reference profile of the closed loop.
    Reference,
    /// File of a project folder: the project as JSON, a log, or a marker.
    Project,
}

/// File that the program reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Role.
    pub role: Role,
    /// Path in the folder of a case.
    pub path: PathBuf,
    /// Content.
    pub bytes: Vec<u8>,
}

impl File {
    fn new(role: Role, bytes: impl Into<Vec<u8>>) -> Self {
        Self {
            role,
            path: name_of(role).into(),
            bytes: bytes.into(),
        }
    }
}

/// Files that belong together.
#[derive(Debug, Clone)]
pub struct Bench {
    /// Name in the table of a failure.
    pub name: &'static str,
    /// At most one file of each role, and one log.
    pub files: Vec<File>,
    /// Whether the plant has both valves and the chamber, as the closed loop needs.
    pub is_whole: bool,
    /// Commands for these files.
    pub effort: Effort,
}

impl Bench {
    /// Returns the file of a role.
    pub fn file(&self, role: Role) -> Option<&File> {
        self.files.iter().find(|file| file.role == role)
    }

    /// Returns the log, in any format.
    pub fn log(&self) -> Option<&File> {
        let roles = [Role::Log, Role::Mf4Log, Role::TableLog];
        roles.into_iter().find_map(|role| self.file(role))
    }
}

/// Reason why the originals cannot be made.
#[derive(Debug, Error)]
pub enum OriginalsError {
    /// A bundled file cannot be read.
    #[error("{}: {}", .0.display(), .1)]
    Read(PathBuf, #[source] io::Error),
    /// A log differs from its expected form.
    #[error("{0}: {1}")]
    Log(&'static str, String),
    /// The server that writes the project folder fails.
    #[error("the server of the project folder: {0}")]
    Server(#[source] io::Error),
}

/// Two logs of one rig; the first is shortened to an excerpt of a second and a half with fill and vent.
const PRACTICE: &str = "data/synthetic/practice-01-id.csv";

const FOREIGN_MAPPING: &str = r#"schema = 1
ignore = ["Bemerkung"]
missing = ["NaN", "---"]

[dialect]
delimiter = "semicolon"
decimal = ","
header = true
skip_lines = 0

[time]
column = "Zeit"
unit = "ms"

[signal.duty_fill]
column = 2
unit = "pct"

[signal.duty_vent]
column = "PWM2"
unit = "pct"

[signal.p_ch]
column = "Druck"
unit = "bar_gauge"
scale = 1.01
offset = -0.002
check_scale = false

[signal.i_fill]
column = "Strom"
unit = "mA"

[constant.u_bat]
value = 24
unit = "V"

[rows]
from_s = 0.1
until_s = 100
"#;

const CONSTANT_MAPPING: &str = r#"schema = 1

[constant.duty_fill]
value = 40
unit = "pct"

[constant.duty_vent]
value = 0
unit = "pct"
"#;

const RATES_MAPPING: &str = r#"schema = 1
ignore = ["counter", "state", "x_fill"]

[signal.p_sup]
column = "p_sup"
unit = "bar_abs"

[constant.duty_vent]
value = 0
unit = "pct"

[rows]
instants_of = "duty_fill"
"#;

const CONVERSIONS_MAPPING: &str = r#"schema = 1
ignore = ["formula", "nearest", "texts", "rational", "texts_and_numbers", "range_texts", "float_ranges"]

[signal.i_fill]
column = "interpolated"
unit = "mA"

[signal.p_ch]
column = "ranges"
unit = "bar_gauge"

[signal.u_bat]
column = "linear"
unit = "V"
offset = 24

[constant.duty_fill]
value = 40
unit = "pct"

[constant.duty_vent]
value = 0
unit = "pct"

[rows]
instants_of = "i_fill"
"#;

const PROFILE: &str =
    "time_s,p_ref_bar_gauge\n0,0\n0.5,3\n0.9,3.05\n1.5,1\n1.51,6.5\n2.25,0.2\n3,0.2\n";

/// Creates all benches.
///
/// # Errors
/// Returns an error if the bundled data differs from its expected form.
pub fn benches() -> Result<Vec<Bench>, OriginalsError> {
    let nominal = File::new(Role::Plant, read("data/nominal-plant.toml")?);
    let recommended = controller("recommended")?;
    let profile = File::new(Role::Reference, PROFILE);
    let practice = rows(PRACTICE, 180, 150)?;
    let whole = |name, log: File, mapping: Option<&str>| Bench {
        name,
        files: [log, nominal.clone(), recommended.clone(), profile.clone()]
            .into_iter()
            .chain(mapping.map(|text| File::new(Role::Mapping, text)))
            .collect(),
        is_whole: true,
        effort: Effort::All,
    };
    let part = |name, log: File, plant: &str, mapping: Option<String>| {
        let files = [log, File::new(Role::Plant, read(plant)?)];
        let mapping = mapping.map(|text| File::new(Role::Mapping, text));
        Ok::<_, OriginalsError>(Bench {
            name,
            files: files.into_iter().chain(mapping).collect(),
            is_whole: false,
            effort: Effort::All,
        })
    };
    let log = |text: String| File::new(Role::Log, text);
    let fixture = |name: &str| {
        let bytes = read(&format!("recording/tests/fixtures/mf4/{name}.mf4"))?;
        Ok::<_, OriginalsError>(File::new(Role::Mf4Log, bytes))
    };
    let table = |name: &str| {
        let bytes = read(&format!("recording/tests/fixtures/table/{name}"))?;
        Ok::<_, OriginalsError>(File::new(Role::TableLog, bytes))
    };
    let mut effects = whole("every effect", log(rows(PRACTICE, 380, 100)?), None);
    effects.files[1] = File::new(Role::Plant, with_every_effect());
    effects.files[2] = controller("thesis")?;
    // A fit of all effects takes too long.
    effects.effort = Effort::Cheap;
    let scope = rows("data/synthetic/practice-00-scope-40.csv", 0, 200)?;
    let inrush = rows("data/real/inrush-burkert6724-switching.csv", 0, 150)?;
    let leakdown = rows("data/real/leakdown-ultimaker-015.csv", 65, 120)?;
    let blowdown = text("data/real/blowdown-air-790kPa.csv")?;
    Ok(vec![
        whole("practice", log(practice.clone()), None),
        whole("practice with gaps", log(with_gaps(&practice)), None),
        whole(
            "practice, mapped",
            log(foreign(&practice)),
            Some(FOREIGN_MAPPING),
        ),
        whole("practice as MF4", as_mf4("practice", &practice)?, None),
        whole("Parquet", table("pyarrow-zstd-pages.parquet")?, None),
        whole(
            "Parquet with dates",
            table("pyarrow-timestamps.parquet")?,
            None,
        ),
        whole("MATLAB v7", table("scipy-v7.mat")?, None),
        whole("MATLAB v7.3", table("hdf5storage-v7.3.mat")?, None),
        effects,
        whole("scope", log(scope.clone()), None),
        whole("scope as MF4", as_mf4("scope", &scope)?, None),
        whole("two rates", fixture("rates")?, Some(RATES_MAPPING)),
        whole(
            "packed blocks",
            fixture("rates-packed")?,
            Some(RATES_MAPPING),
        ),
        whole(
            "transposed blocks",
            fixture("rates-transposed")?,
            Some(RATES_MAPPING),
        ),
        whole("lists of blocks", fixture("lists")?, Some(CONSTANT_MAPPING)),
        whole("unfinished", fixture("unfinished")?, Some(CONSTANT_MAPPING)),
        whole(
            "conversions",
            fixture("conversions")?,
            Some(CONVERSIONS_MAPPING),
        ),
        part(
            "inrush",
            log(inrush),
            "data/plants/fitted-inrush-switching.toml",
            Some(text("data/real/inrush.toml")?),
        )?,
        part(
            "leak-down",
            log(leakdown),
            "data/plants/fitted-leakdown-015.toml",
            Some(text("data/real/leakdown-ultimaker-015.toml")?),
        )?,
        part(
            "blow-down",
            log(blowdown),
            "data/plants/fitted-blowdown.toml",
            None,
        )?,
    ])
}

fn read(path: &str) -> Result<Vec<u8>, OriginalsError> {
    let path = repository().join(path);
    fs::read(&path).map_err(|error| OriginalsError::Read(path, error))
}

fn text(path: &str) -> Result<String, OriginalsError> {
    Ok(String::from_utf8_lossy(&read(path)?).into_owned())
}

fn controller(name: &str) -> Result<File, OriginalsError> {
    let bytes = read(&format!("hil-harness/controllers/{name}.toml"))?;
    Ok(File::new(Role::Controller, bytes))
}

/// Returns the header and some rows of a log.
fn rows(path: &str, from: usize, count: usize) -> Result<String, OriginalsError> {
    let text = text(path)?;
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let rows = lines.skip(from).take(count);
    let lines = std::iter::once(header).chain(rows);
    Ok(lines.map(|line| format!("{line}\n")).collect())
}

/// Adds a pause of 0.5 s, three lost rows, and empty cells.
fn with_gaps(log: &str) -> String {
    let thin = |(row, line): (usize, &str)| match row {
        30..70 | 90..93 => String::new(),
        110..120 => {
            let mut cells: Vec<_> = line.split(',').collect();
            cells[3] = "";
            cells.join(",") + "\n"
        }
        _ => format!("{line}\n"),
    };
    log.lines().enumerate().map(thin).collect()
}

/// Rewrites the log as another logger would: names, semicolons, decimal commas, milliseconds, remarks.
fn foreign(log: &str) -> String {
    let mut text = "Zeit;PWM1;PWM2;Druck;Strom;Bemerkung\n".to_owned();
    for (row, line) in log.lines().skip(1).enumerate() {
        let cells: Vec<_> = line.split(',').collect();
        let pressure = if row % 50 == 7 { "---" } else { cells[3] };
        let line = format!(
            "{};{};{};{pressure};{};",
            row * 10,
            cells[1],
            cells[2],
            cells[4]
        );
        text += &line.replace('.', ",");
        text += if row == 20 { "Ventil auf\n" } else { "\n" };
    }
    text
}

fn as_mf4(name: &'static str, log: &str) -> Result<File, OriginalsError> {
    let failed = |error: String| OriginalsError::Log(name, error);
    let log = csv::read(name, log.as_bytes(), &csv::Options::default());
    let log = log.map_err(|error| failed(error.to_string()))?;
    let written = mf4::write(Vec::new(), &log);
    let bytes = written.map_err(|error| failed(error.to_string()))?;
    Ok(File::new(Role::Mf4Log, bytes))
}

fn with_every_effect() -> String {
    let nominal = PlantParameters::nominal();
    let acting = LIBRARY
        .iter()
        .filter_map(|effect| nominal.forms_of(*effect).into_iter().next())
        .filter(|effect| effect.driven_by().is_none());
    acting
        .fold(nominal.clone(), |plant, effect| plant.with_effect(effect))
        .to_toml()
}

/// Creates a project folder as the program leaves it: two logs, one of them shifted, a comparison and a diagnosis.
///
/// # Errors
/// Returns an error if the server does not run, or the bundled data differs from its expected form.
pub fn project(retarder: &Path) -> Result<Bench, OriginalsError> {
    let logs = [rows(PRACTICE, 180, 60)?, rows(PRACTICE, 380, 60)?];
    let files = kept_files(retarder, &logs).map_err(OriginalsError::Server)?;
    Ok(Bench {
        name: "project",
        files,
        is_whole: true,
        effort: Effort::All,
    })
}

fn kept_files(retarder: &Path, logs: &[String]) -> io::Result<Vec<File>> {
    let folder = tempfile::tempdir()?;
    let server = Server::start(retarder, &folder.path().join(PROJECT))?;
    let client = server.client()?;
    let session = client.session(None)?;
    for (number, log) in logs.iter().enumerate() {
        client.upload(&session, &format!("{number}.csv"), log.as_bytes())?;
    }
    client.put(
        &format!("{session}/logs/2/offset"),
        &json!({"offset_s": 0.25}),
    )?;
    client.work(&session, "logs/1/compare", &json!({}))?;
    client.work(&session, "diagnose", &json!({"logs": [1], "check": []}))?;
    server.end()?;
    let read = |path: PathBuf| {
        Ok(File {
            role: Role::Project,
            bytes: fs::read(&path)?,
            path: path.strip_prefix(folder.path()).unwrap_or(&path).to_owned(),
        })
    };
    let mut paths = files_below(folder.path())?;
    // The server draws the names at random; the order of their roles is fixed.
    paths.sort_by_key(|path| {
        (
            path.extension().map(ToOwned::to_owned),
            path.metadata().map_or(0, |file| file.len()),
        )
    });
    paths.into_iter().map(read).collect()
}

/// Project folder in the folder of a case.
pub(super) const PROJECT: &str = "project";

/// Returns the path of a file in the folder of a case, by its role.
pub fn name_of(role: Role) -> &'static Path {
    Path::new(match role {
        Role::Log => "log.csv",
        Role::Mf4Log => "log.mf4",
        Role::TableLog => "log.columns",
        Role::Mapping => "mapping.toml",
        Role::Plant => "plant.toml",
        Role::Controller => "controller.toml",
        Role::Reference => "reference.csv",
        Role::Project => PROJECT,
    })
}
