//! Conversion of arguments into values: the only module that reads and checks files.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use hil_harness::operating_conditions::coil_temperature_c;
use hil_harness::rigs::rig_in_operation;
use hil_harness::scenario::missing_part;
use hil_harness::{
    ConditionScatter, OperatingConditions, ReferenceProfile, Requirement, Scenario,
    controller_file, requirement_file,
};
use model_lab::diagnosis::{fix, free};
use plant_sim::parameters::Part;
use plant_sim::plant::{FILL, VENT};
use plant_sim::{ParameterError, PlantParameters};
use recording::csv::{self, Mapping};
use recording::{
    InputFile, LogOptions, OpenLog, Recording, open_log, open_log_file, read_log, read_log_file,
};
use sha2::{Digest as _, Sha256};

use crate::cli::{
    Assignment, ControlArgs, ControllerArg, Freed, ImportArgs, KnowledgeArgs, LogArgs, LogsArgs,
    PlantArgs, RequirementsArg,
};
use crate::exchanged;
use crate::failure::{Failure, SourceLines};
use report::Input;

/// Bench log of the demo, from the data folder.
const TOUR_LOG: &str = include_str!("../../data/synthetic/practice-01-id.csv");
/// Name of that log.
pub(crate) const TOUR_LOG_NAME: &str = "practice-01-id.csv";

/// Plant and its name.
#[derive(Debug, Clone)]
pub(crate) struct NamedPlant {
    pub(crate) name: String,
    pub(crate) parameters: PlantParameters,
    /// The file; `None` if the plant is built in.
    file: Option<InputFile>,
}

impl NamedPlant {
    /// Returns the thesis model.
    pub(crate) fn nominal() -> Self {
        Self {
            name: "nominal plant".to_owned(),
            parameters: PlantParameters::nominal(),
            file: None,
        }
    }

    /// Returns the plant of the arguments; without a file, `default` with their changes.
    pub(crate) fn from_args(args: &PlantArgs, default: Self) -> Result<Self, Failure> {
        let mut plant = match &args.plant {
            None => default,
            Some(path) => {
                exchanged::refuse_as_plant(path)?;
                Self::read(path, PlantParameters::from_toml)?
            }
        };
        for change in &args.set {
            plant
                .parameters
                .set(&change.name, change.value, "--set on the command line")
                .map_err(|error| Failure::Set { error })?;
            if plant.parameters.get(&change.name).is_none() {
                return Err(Failure::SetAbsent {
                    name: change.name.clone(),
                });
            }
            plant.name += &format!(", {} = {}", change.name, change.value);
        }
        Ok(plant)
    }

    /// Returns the plant that `parse` makes of a file, from its text and its name.
    pub(crate) fn read(
        path: &Path,
        parse: impl Fn(&str, &str) -> Result<PlantParameters, ParameterError>,
    ) -> Result<Self, Failure> {
        let text = read_text(path)?;
        let name = path.display().to_string();
        let parameters = parse(&text, &name).map_err(|error| {
            let lines = error.problems().iter().filter_map(|problem| problem.line());
            let source_lines = SourceLines::of(&text, lines);
            Failure::Plant {
                error,
                source_lines,
            }
        })?;
        Ok(Self {
            name,
            parameters,
            file: Some(identity(&text)),
        })
    }

    /// Applies the options that state how well the parameters are known.
    pub(crate) fn knowing(mut self, args: &KnowledgeArgs) -> Result<Self, Failure> {
        let refused = |error| Failure::Knowledge { error };
        for Freed { what, range } in &args.free {
            free(&mut self.parameters, what, *range).map_err(refused)?;
        }
        for what in &args.fix {
            fix(&mut self.parameters, what).map_err(refused)?;
        }
        Ok(self)
    }

    /// Returns the plant if it has the parts that a closed loop needs.
    pub(crate) fn for_control(self) -> Result<Self, Failure> {
        self.unless_lacking(missing_part)
    }

    /// Returns the plant if it has the parts of the thesis' bench: two valves with armatures, and the chamber.
    pub(crate) fn for_thesis(self) -> Result<Self, Failure> {
        let parts = [
            Part::ArmatureOf(FILL),
            Part::ArmatureOf(VENT),
            Part::Chamber,
        ];
        self.unless_lacking(|plant| parts.into_iter().find(|part| !part.is_in(plant)))
    }

    fn unless_lacking(
        self,
        missing: impl Fn(&PlantParameters) -> Option<Part>,
    ) -> Result<Self, Failure> {
        match missing(&self.parameters) {
            Some(part) => Err(Failure::PartLeftOut {
                plant: self.name,
                part,
            }),
            None => Ok(self),
        }
    }

    /// Returns the description of the plant for a report.
    pub(crate) fn input(&self) -> Input {
        named_input("plant", &self.name, self.file)
    }
}

fn named_input(role: &str, name: &str, file: Option<InputFile>) -> Input {
    Input {
        role: role.to_owned(),
        name: name.to_owned(),
        identity: file.map(|file| (file.size_bytes, file.sha256_hex())),
    }
}

fn identity(text: &str) -> InputFile {
    InputFile {
        size_bytes: text.len() as u64,
        sha256: Sha256::digest(text).into(),
    }
}

/// Returns the options for reading the log.
pub(crate) fn log_options(args: &LogArgs) -> Result<LogOptions, Failure> {
    imported_by(&args.import)
}

/// Returns the options for reading a log with these options of the command line.
pub(crate) fn imported_by(import: &ImportArgs) -> Result<LogOptions, Failure> {
    let reference = import.reference();
    Ok(LogOptions {
        mapping: match &import.mapping {
            Some(path) => Mapping::read_file_with_reference(path, reference)?,
            None => Mapping::default().with_reference(reference),
        },
        csv_limits: csv::Limits {
            bad_rows: import.skip_bad_rows,
            ..csv::Limits::default()
        },
        ..LogOptions::default()
    })
}

/// Reads the whole log.
pub(crate) fn log(args: &LogArgs) -> Result<Recording, Failure> {
    whole_log(args.log(), &log_options(args)?)
}

/// Reads several whole logs with the same mapping.
pub(crate) fn logs(paths: &[PathBuf], args: &LogsArgs) -> Result<Vec<Recording>, Failure> {
    let options = imported_by(&args.import)?;
    let mut logs = paths
        .iter()
        .map(|path| whole_log(path, &options))
        .collect::<Result<Vec<_>, _>>()?;
    for Assignment { name, value } in &args.need {
        if !(*value > 0.0 && value.is_finite()) {
            return Err(Failure::NeedOutOfRange {
                name: name.clone(),
                value: *value,
            });
        }
        if !logs.is_empty() && !logs.iter().any(|log| log.signal(name).is_some()) {
            let known = logs.iter().flat_map(|log| log.signals());
            return Err(Failure::NeedOfNoSignal {
                name: name.clone(),
                known: known.map(|signal| signal.name().to_owned()).collect(),
            });
        }
        for log in &mut logs {
            log.set_need(name, *value);
        }
    }
    Ok(logs)
}

fn whole_log(path: &Path, options: &LogOptions) -> Result<Recording, Failure> {
    if is_standard_input(path) {
        return Ok(read_log(STANDARD_INPUT, io::stdin().lock(), options)?);
    }
    exchanged::refuse_as_log(path)?;
    read_log_file(path, options).map_err(|error| Failure::of_log(path, error))
}

/// Log that is read row by row, or as a whole if its format requires that.
pub(crate) struct LogSource {
    pub(crate) name: String,
    pub(crate) log: OpenLog<'static>,
    /// Size (bytes), if known.
    pub(crate) size: Option<u64>,
}

/// Opens the log.
pub(crate) fn open_source(args: &LogArgs, options: &LogOptions) -> Result<LogSource, Failure> {
    let (name, size, log) = if is_standard_input(args.log()) {
        let log = open_log(STANDARD_INPUT, io::stdin().lock(), options)?;
        (STANDARD_INPUT.to_owned(), None, log)
    } else {
        let path = args.log();
        exchanged::refuse_as_log(path)?;
        let metadata = std::fs::metadata(path).map_err(|error| Failure::Read {
            path: path.to_path_buf(),
            error,
        })?;
        let name = path.file_name().unwrap_or(path.as_os_str());
        let size = metadata.is_file().then_some(metadata.len());
        let log = open_log_file(path, options).map_err(|error| Failure::of_log(path, error))?;
        (name.to_string_lossy().into_owned(), size, log)
    };
    Ok(LogSource { name, log, size })
}

/// Name of the standard input in messages.
pub(crate) const STANDARD_INPUT: &str = "standard input";

/// Returns a file with the content of the standard input, for a log that is read more than once.
pub(crate) fn kept_standard_input() -> io::Result<tempfile::NamedTempFile> {
    let mut file = tempfile::NamedTempFile::new()?;
    // The readers refuse one byte more than their budget, with a message.
    let most = csv::Limits::default().file_bytes.saturating_add(1);
    io::copy(&mut io::stdin().lock().take(most), &mut file)?;
    Ok(file)
}

pub(crate) fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads the log of the demo.
pub(crate) fn tour_log() -> Result<Recording, Failure> {
    Ok(csv::read(
        TOUR_LOG_NAME,
        TOUR_LOG.as_bytes(),
        &csv::Options::default(),
    )?)
}

/// Names and files of the bundled controllers.
const BUILT_IN_CONTROLLERS: [(&str, &str); 3] = [
    ("thesis", controller_file::THESIS_TOML),
    ("recommended", controller_file::RECOMMENDED_TOML),
    ("pulses", controller_file::PULSES_1_9_MM_TOML),
];

fn built_in_controller(argument: &Path) -> Option<(&'static str, &'static str)> {
    let mut built_in = BUILT_IN_CONTROLLERS.into_iter();
    built_in.find(|(name, _)| argument == Path::new(name))
}

/// Returns whether the argument names a bundled controller instead of a file.
pub(crate) fn is_built_in_controller(argument: &Path) -> bool {
    built_in_controller(argument).is_some()
}

/// Controller and its name.
#[derive(Debug, Clone)]
pub(crate) struct NamedController {
    pub(crate) name: String,
    pub(crate) settings: controller::Settings,
    /// Text of the file.
    pub(crate) text: String,
    /// The file; `None` if the controller is built in.
    file: Option<InputFile>,
}

impl NamedController {
    /// Returns the controller of the argument.
    pub(crate) fn from_args(args: &ControllerArg) -> Result<Self, Failure> {
        let (name, text, file) = match built_in_controller(&args.controller) {
            Some((name, text)) => (format!("{name} controller"), text.to_owned(), None),
            None => {
                let path = &args.controller;
                let text = read_text(path).map_err(|failure| match failure {
                    Failure::Read { error, .. } if error.kind() == io::ErrorKind::NotFound => {
                        Failure::NoController {
                            path: path.clone(),
                            bundled: BUILT_IN_CONTROLLERS.map(|(name, _)| name),
                        }
                    }
                    other => other,
                })?;
                let file = Some(identity(&text));
                (path.display().to_string(), text, file)
            }
        };
        let settings = controller_file::read(&text, &name).map_err(|error| {
            let lines = error.problems().iter().filter_map(|problem| problem.line());
            let source_lines = SourceLines::of(&text, lines);
            Failure::Controller {
                error,
                source_lines,
            }
        })?;
        Ok(Self {
            name,
            settings,
            text,
            file,
        })
    }

    /// Returns the description of the controller for a report.
    pub(crate) fn input(&self) -> Input {
        named_input("controller", &self.name, self.file)
    }
}

/// Requirement on the loop and its name.
#[derive(Debug, Clone)]
pub(crate) struct NamedRequirement {
    pub(crate) name: String,
    pub(crate) requirement: Requirement,
    /// The file; `None` for the thesis.
    file: Option<InputFile>,
}

impl NamedRequirement {
    /// Returns the requirements of the thesis.
    pub(crate) fn thesis() -> Self {
        Self {
            name: "the thesis".to_owned(),
            requirement: Requirement::THESIS,
            file: None,
        }
    }

    /// Returns the requirements of the argument.
    pub(crate) fn from_args(args: &RequirementsArg) -> Result<Self, Failure> {
        let Some(path) = &args.requirements else {
            return Ok(Self::thesis());
        };
        let text = read_text(path)?;
        let name = path.display().to_string();
        let requirement = requirement_file::read(&text, &name).map_err(|error| {
            let lines = error.problems().iter().map(|problem| problem.line());
            let source_lines = SourceLines::of(&text, lines);
            Failure::Requirements {
                error,
                source_lines,
            }
        })?;
        Ok(Self {
            name,
            requirement,
            file: Some(identity(&text)),
        })
    }

    /// Returns the description of the file for a report; `None` for the thesis.
    pub(crate) fn input(&self) -> Option<Input> {
        self.file?;
        Some(named_input("requirements", &self.name, self.file))
    }
}

/// Returns the scenario under operating conditions of the command line.
pub(crate) fn under(
    conditions: OperatingConditions,
    scenario: Scenario,
) -> Result<Scenario, Failure> {
    let applied = conditions.applied_to(scenario);
    applied.map_err(|error| Failure::Condition { error })
}

/// Scenario with the names of its plant and its controller.
#[derive(Debug, Clone)]
pub(crate) struct NamedScenario {
    pub(crate) scenario: Scenario,
    /// Operating conditions that were given; the others scatter from rig to rig.
    pub(crate) conditions: OperatingConditions,
    pub(crate) requirements: NamedRequirement,
    pub(crate) plant: String,
    pub(crate) controller: String,
    /// Descriptions of its files for a report.
    pub(crate) inputs: Vec<Input>,
}

impl NamedScenario {
    /// Returns the operating conditions and the requirements that were given, in sentences.
    pub(crate) fn conditions_text(&self) -> String {
        let supply = self.conditions.supply;
        let supply = supply.map(|supply| format!("Supply voltage from time 0 on: {supply}."));
        let coils = self.conditions.coil_temperature_c;
        let coils = coils.map(|celsius| format!("Coils at {celsius} °C."));
        let controller = &self.scenario.controller;
        let compensated = match controller.pulses {
            Some(_) => "Pulses",
            None => "Duty limits",
        };
        let compensation = controller.compensation.map(|compensation| {
            format!(
                "{compensated} follow the measured supply voltage and coil resistance (nominal {} V, {} ohm).",
                compensation.nominal_voltage_v, compensation.nominal_resistance_ohm
            )
        });
        let is_thesis = self.requirements.requirement == Requirement::THESIS;
        let requirements = format!("Requirements: {}.", self.requirements.name);
        let sentences: Vec<String> = supply
            .into_iter()
            .chain(coils)
            .chain(compensation)
            .chain((!is_thesis).then_some(requirements))
            .collect();
        sentences.join(" ")
    }

    /// Returns the scatter of the operating conditions that were not given.
    pub(crate) fn scatter(&self) -> ConditionScatter {
        let vehicle = ConditionScatter::vehicle(&self.scenario.plant);
        let OperatingConditions {
            supply,
            coil_temperature_c,
        } = self.conditions;
        ConditionScatter {
            supply_voltage_v: vehicle.supply_voltage_v.filter(|_| supply.is_none()),
            coil_temperature_c: vehicle
                .coil_temperature_c
                .filter(|_| coil_temperature_c.is_none()),
        }
    }

    /// Returns the scenario on one rig of the batch that `control --rigs` runs.
    pub(crate) fn on_rig(self, rig: u32) -> Result<Self, Failure> {
        let scenario = rig_in_operation(&self.scenario, rig, self.scatter())?;
        let conditions = OperatingConditions {
            supply: scenario.supply,
            coil_temperature_c: coil_temperature_c(&scenario.plant),
        };
        Ok(Self {
            plant: format!("rig {rig} of {}", self.plant),
            scenario,
            conditions,
            ..self
        })
    }

    /// Returns the built-in scenario `name` with the recommended controller.
    pub(crate) fn built_in(name: &str) -> Option<Self> {
        let scenario = Scenario::built_in(name)?;
        Some(Self {
            plant: built_in_plant(&scenario).name,
            controller: "recommended controller".to_owned(),
            conditions: OperatingConditions::default(),
            requirements: NamedRequirement::thesis(),
            inputs: Vec::new(),
            scenario,
        })
    }

    /// Returns the scenario of the arguments.
    pub(crate) fn from_args(args: &ControlArgs) -> Result<Self, Failure> {
        let controller = NamedController::from_args(&args.controller)?;
        let (scenario, profile) = match &args.reference {
            Some(path) => {
                let (profile, input) = reference(path)?;
                (Scenario::new(file_stem(path), profile), Some(input))
            }
            None => (built_in_scenario(&args.scenario), None),
        };
        let plant = NamedPlant::from_args(&args.plant, built_in_plant(&scenario))?.for_control()?;
        let requirements = NamedRequirement::from_args(&args.requirements)?;
        let mut inputs = vec![plant.input(), controller.input()];
        inputs.extend(requirements.input());
        inputs.extend(profile);
        let conditions = args.conditions.conditions();
        let scenario = scenario
            .on(plant.parameters)
            .controlled_by(controller.settings)
            .seeded(args.seed);
        let scenario = Self {
            scenario: under(conditions, scenario)?,
            conditions,
            requirements,
            plant: plant.name,
            controller: controller.name,
            inputs,
        };
        match args.rig {
            Some(rig) => scenario.on_rig(rig),
            None => Ok(scenario),
        }
    }
}

/// Returns the built-in scenario of an argument that was already checked.
pub(crate) fn built_in_scenario(name: &str) -> Scenario {
    Scenario::built_in(name)
        .unwrap_or_else(|| unreachable!("clap lets only the names of built-in scenarios pass"))
}

fn built_in_plant(scenario: &Scenario) -> NamedPlant {
    let parameters = scenario.plant.clone();
    NamedPlant {
        name: format!(
            "nominal plant, {:.1} mm orifices",
            1e3 * parameters.flow.orifice_fill_m
        ),
        parameters,
        file: None,
    }
}

fn reference(path: &Path) -> Result<(ReferenceProfile, Input), Failure> {
    let recording = read_log_file(path, &LogOptions::default())?;
    let profile =
        ReferenceProfile::from_recording(&recording).map_err(|error| Failure::Reference {
            path: path.to_path_buf(),
            error,
        })?;
    Ok((
        profile,
        Input::of_recording("reference", recording.provenance()),
    ))
}

fn file_stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Largest size of a plant or controller file (bytes).
const TEXT_MAX_BYTES: u64 = 1 << 20;

pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(TEXT_MAX_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| Failure::Read {
            path: path.to_path_buf(),
            error,
        })?;
    if bytes.len() as u64 > TEXT_MAX_BYTES {
        return Err(Failure::TooLarge {
            path: path.to_path_buf(),
            limit: TEXT_MAX_BYTES,
        });
    }
    String::from_utf8(bytes).map_err(|_| Failure::NotText {
        path: path.to_path_buf(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_of_the_demo_is_read() {
        let log = tour_log().unwrap();
        assert_eq!(log.time_bases().next().unwrap().1.len(), 6000);
    }
}
