//! Tasks with every file read and every value checked.

use std::io::{Write as _, stderr, stdin};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread;

use clap::CommandFactory as _;
use hil_harness::gain_search::Search;
use model_lab::CompareOptions;
use model_lab::diagnosis::asking_plant_file;
use model_lab::diagnosis::next_experiment::Limits;
use plant_sim::PlantParameters;
use plant_sim::parameters::{NOMINAL_PLANT_TOML, Part};
use recording::{LogFormat, OpenLog, Recording};

use crate::cli::{
    BlackBoxArgs, CalibrateCommand, Cli, Command, CompareArgs, ControlArgs, DiagnoseArgs,
    InspectArgs, LogsArgs, MergeRigsArgs, NextExperimentArgs, ParametersArgs, PlantArgs,
    RefineArgs, ReportArgs, SchemaName, SimulateArgs, TabArgs,
};
use crate::datasheet_dialogue;
use crate::failure::Failure;
use crate::files::{DEMO_REPORT, Files};
use crate::input::{self, NamedController, NamedPlant, NamedRequirement, NamedScenario};
use crate::options::{Options, command_of_rig};
use crate::print::{self, Live, Terminal};
use crate::run::diagnose::Asked;
use crate::run::{self, Outcome, schema};
use crate::targets::{Existing, Targets, is_standard_output};

/// Task and the destinations of its results.
pub(crate) struct Task {
    work: Work,
    targets: Targets,
}

enum Work {
    Demo,
    Inspect(InspectArgs),
    Simulate(run::simulate::Task),
    Compare {
        plant: NamedPlant,
        log: Recording,
        options: CompareOptions,
        focus: Option<String>,
    },
    Diagnose(run::diagnose::Task),
    Refine(run::diagnose::Task, Vec<Asked>),
    Control {
        scenario: Box<NamedScenario>,
        rigs: u32,
    },
    MonteCarlo(Box<run::monte_carlo::Task>),
    MergeRigs(run::monte_carlo::MergeTask),
    NextExperiment(Box<run::next_experiment::Task>),
    Report(Box<run::session::Task>),
    OnDevice(Box<run::device::Task>),
    BlackBox(BlackBoxArgs),
    Calibrate(CalibrateCommand),
    Thesis(NamedPlant),
    ExplainThesis(NamedPlant),
    Parameters(NamedPlant),
    Settings(NamedController),
    Tune(Box<run::tune::Task>),
    Serve(workbench::Options),
    Tab(TabArgs),
    Text(String),
}

impl Task {
    /// Checks that the results can be written and destroy nothing; reads and checks all inputs of the arguments.
    pub(crate) fn resolve(arguments: Cli, files: &Files) -> Result<Self, Failure> {
        for note in files.check()? {
            print_to_stderr(&print::note(&note, &Terminal::standard_error()));
        }
        let mut targets = Targets {
            existing: arguments.existing(),
            ..Targets::default()
        };
        let work = match arguments.command {
            None => {
                targets.html = Some(DEMO_REPORT.into());
                Work::Demo
            }
            Some(Command::Inspect(mut args)) => {
                targets.mapping.clone_from(&args.out);
                targets.json = args.json.json.take();
                Work::Inspect(args)
            }
            Some(Command::Simulate(args)) => simulate(args, &mut targets)?,
            Some(Command::Compare(args)) => compare(args, &mut targets)?,
            Some(Command::Diagnose(args)) => diagnose(args, &mut targets)?,
            Some(Command::Refine(args)) => refine(args, &mut targets)?,
            Some(Command::NextExperiment(args)) => next_experiment(args, &mut targets)?,
            Some(Command::Control(args)) => control(args, &mut targets)?,
            Some(Command::MergeRigs(args)) => merge_rigs(args, &mut targets)?,
            Some(Command::Report(args)) => report(args, &mut targets)?,
            Some(Command::BlackBox(mut args)) => {
                targets.recording = as_csv(args.out.out.take())?;
                targets.json = args.json.json.take();
                Work::BlackBox(args)
            }
            Some(Command::Calibrate(args)) => {
                let mut command = args.command;
                if let CalibrateCommand::Measure(args) = &mut command {
                    targets.recording = as_csv(args.out.out.take())?;
                }
                Work::Calibrate(command)
            }
            Some(Command::Thesis(args)) => {
                (targets.json, targets.html) = (args.json.json, args.html.html);
                let plant = NamedPlant::from_args(&args.plant, NamedPlant::nominal())?;
                let plant = plant.for_thesis()?;
                if args.explain {
                    Work::ExplainThesis(plant)
                } else {
                    Work::Thesis(plant)
                }
            }
            Some(Command::Parameters(ParametersArgs {
                from_datasheet: Some(path),
                ask,
                ..
            })) => {
                if ask {
                    datasheet_dialogue::complete(&path, &mut stdin().lock(), &mut stderr())?;
                }
                let plant = NamedPlant::read(&path, |text, name| {
                    let plant = PlantParameters::from_datasheet(text, name)?;
                    for (line, key) in plant.unused_in_datasheet(text) {
                        let note = format!(
                            "{name}:{line}: `{key}` is not used: no part of this plant has such a value"
                        );
                        print_to_stderr(&print::note(&note, &Terminal::standard_error()));
                    }
                    Ok(plant)
                })?;
                Work::Text(plant.parameters.to_toml())
            }
            Some(Command::Parameters(args)) => {
                let is_untouched = args.plant.plant.is_none() && args.plant.set.is_empty();
                let plant = NamedPlant::from_args(&args.plant, NamedPlant::nominal())?;
                if args.toml.toml {
                    let text = match is_untouched {
                        true => NOMINAL_PLANT_TOML.to_owned(),
                        false => plant.parameters.to_toml(),
                    };
                    Work::Text(asking_plant_file(&text, &plant.parameters))
                } else {
                    Work::Parameters(plant)
                }
            }
            Some(Command::Settings(args)) if args.requirements => {
                Work::Text(hil_harness::requirement_file::THESIS_TOML.to_owned())
            }
            Some(Command::Settings(args)) => {
                let controller = NamedController::from_args(&args.controller)?;
                if args.toml.toml {
                    Work::Text(controller.text)
                } else {
                    Work::Settings(controller)
                }
            }
            Some(Command::Tune(args)) => {
                let plant = NamedPlant::from_args(&args.plant, NamedPlant::nominal())?;
                let plant = plant.for_control()?;
                targets.html = args.html;
                targets.controller = args.out;
                Work::Tune(Box::new(run::tune::Task {
                    plant,
                    controller: NamedController::from_args(&args.controller)?,
                    requirements: NamedRequirement::from_args(&args.requirements)?,
                    gains: match (args.search, args.gains) {
                        (Some(candidates), _) => run::tune::Gains::Searched(Search {
                            candidates,
                            rigs: args.rigs,
                            seed: args.seed,
                            choose: args.choose,
                        }),
                        (None, Some(method)) => run::tune::Gains::Started(method),
                        (None, None) => run::tune::Gains::Kept,
                    },
                }))
            }
            Some(Command::Serve(args)) => Work::Serve(workbench::Options {
                project: args.project,
                port: args.port,
                worker: workbench::Worker {
                    program: std::env::current_exe().map_err(Failure::OwnProgram)?,
                    arguments: vec!["tab".to_owned()],
                    memory_bytes: args.memory << 20,
                },
            }),
            Some(Command::Tab(args)) => Work::Tab(args),
            Some(Command::Schema { result }) => Work::Text(schema_text(result)),
            Some(Command::Completions { shell }) => Work::Text(completions(shell)),
        };
        Ok(Self { work, targets })
    }

    /// Runs the task.
    pub(crate) fn run(mut self) -> Result<(Outcome, Targets), Failure> {
        let outcome = match self.work {
            Work::Inspect(args) => {
                let inspected = run::inspect::run(args)?;
                // A log that needs no mapping leaves no file.
                self.targets.mapping = self
                    .targets
                    .mapping
                    .filter(|_| inspected.mapping().is_some());
                Outcome::Inspection(inspected)
            }
            Work::Demo => Outcome::Demo(Box::new(run::demo::run()?)),
            Work::Simulate(task) => Outcome::Simulation(run::simulate::run(task)?),
            Work::Compare {
                plant,
                log,
                options,
                focus,
            } => {
                let compared = run::compare::run(plant, log, &options, focus.as_deref())?;
                Outcome::Comparison(Box::new(compared))
            }
            Work::Diagnose(task) => Outcome::Diagnosis(Box::new(run::diagnose::run(task)?)),
            Work::Refine(task, add) if add.is_empty() => {
                Outcome::Estimation(Box::new(run::diagnose::estimate(task)?))
            }
            Work::Refine(task, add) => {
                Outcome::Refinement(Box::new(run::diagnose::refine(task, &add)?))
            }
            Work::Control { scenario, rigs } => {
                // No file is being written yet: Ctrl-C may end the process.
                let never = AtomicBool::new(false);
                Outcome::Control(Box::new(run::control::run(*scenario, rigs, &never)?))
            }
            Work::MonteCarlo(task) => Outcome::RigTable(Box::new(run::monte_carlo::run(*task)?)),
            Work::MergeRigs(task) => Outcome::RigTable(Box::new(run::monte_carlo::merged(task)?)),
            Work::NextExperiment(task) if task.effects.is_empty() => {
                let determining = run::next_experiment::determine(*task)?;
                Outcome::DeterminingExperiment(Box::new(determining))
            }
            Work::NextExperiment(task) => {
                Outcome::NextExperiment(Box::new(run::next_experiment::run(*task)?))
            }
            Work::Report(task) => Outcome::Report(Box::new(run::session::run(*task)?)),
            Work::OnDevice(task) => {
                let mut live = Live::new(&task.scenario.scenario, task.pace);
                let controlled = run::device::run(*task, &mut |moment| live.see(moment))?;
                Outcome::Control(Box::new(controlled))
            }
            Work::BlackBox(args) => Outcome::BlackBox(run::black_box::run(&args)?),
            Work::Calibrate(command) => match command {
                CalibrateCommand::Signals => Outcome::DeviceSignals,
                CalibrateCommand::Read(args) => {
                    Outcome::DeviceSettings(run::calibrate::read(&args)?)
                }
                CalibrateCommand::Write(args) => {
                    Outcome::DeviceSettings(run::calibrate::write(&args)?)
                }
                CalibrateCommand::Measure(args) => {
                    Outcome::Measurement(run::measurement::run(&args, &mut print::measuring)?)
                }
            },
            Work::Thesis(plant) => Outcome::Thesis(run::thesis::run(plant)),
            Work::ExplainThesis(plant) => Outcome::ThesisExplanation(run::thesis::explain(plant)),
            Work::Parameters(plant) => Outcome::Parameters(plant),
            Work::Settings(controller) => Outcome::Settings(controller),
            Work::Tune(task) => Outcome::Tuned(Box::new(run::tune::run(*task)?)),
            Work::Serve(options) => Outcome::Text(run::serve::run(&options, &mut |address| {
                print::serving(address)
            })?),
            Work::Tab(args) => {
                workbench::work(&args.project, args.memory_bytes)?;
                Outcome::Text(String::new())
            }
            Work::Text(text) => Outcome::Text(text),
        };
        Ok((outcome, self.targets))
    }
}

fn simulate(args: SimulateArgs, targets: &mut Targets) -> Result<Work, Failure> {
    let out = args.out.out.filter(|path| !is_standard_output(path));
    if out.is_none() && args.json.json.as_deref().is_some_and(is_standard_output) {
        return Err(Failure::TwoOnStandardOutput {
            option: "--out".to_owned(),
        });
    }
    targets.json = args.json.json;
    let options = input::log_options(&args.log)?;
    let plant = NamedPlant::from_args(&args.plant, NamedPlant::nominal())?;
    let log = input::open_source(&args.log, &options)?;
    if let OpenLog::Recording(recording) = &log.log {
        print_notes(recording);
    }
    Ok(Work::Simulate(run::simulate::Task {
        plant,
        log,
        options: options.csv(),
        start: args.start,
        out,
        existing: targets.existing,
    }))
}

fn compare(args: CompareArgs, targets: &mut Targets) -> Result<Work, Failure> {
    (targets.json, targets.html) = (args.json.json, args.html.html);
    let plant = NamedPlant::from_args(&args.plant, NamedPlant::nominal())?;
    let log = input::log(&args.log)?;
    print_notes(&log);
    Ok(Work::Compare {
        plant,
        log,
        options: CompareOptions {
            allowed_noise_multiples: args.allow,
            tolerances: args
                .tolerance
                .into_iter()
                .map(|tolerance| (tolerance.name, tolerance.value))
                .collect(),
            ..CompareOptions::default()
        },
        focus: args.signal,
    })
}

fn diagnose(args: DiagnoseArgs, targets: &mut Targets) -> Result<Work, Failure> {
    (targets.json, targets.html) = (args.json.json, args.html.html);
    targets.plant = args.missing_flow;
    Ok(Work::Diagnose(to_explain(&args.logs, &args.plant)?))
}

fn refine(args: RefineArgs, targets: &mut Targets) -> Result<Work, Failure> {
    let mut asked: Vec<Asked> = Vec::new();
    for text in args.add {
        let (id, variant) = match text.split_once(':') {
            Some((id, variant)) => (id.to_owned(), Some(variant.to_owned())),
            None => (text, None),
        };
        if asked.iter().any(|(there, _)| *there == id) {
            return Err(Failure::AddedTwice { id });
        }
        asked.push((id, variant));
    }
    let task = to_explain(&args.logs, &args.plant)?;
    for (id, _) in &asked {
        let candidate = task.plant.parameters.candidate(id);
        let part = candidate.map_or(Part::Any, Part::of_effect);
        if !part.is_in(&task.plant.parameters) {
            return Err(Failure::EffectOnNothing {
                plant: task.plant.name,
                part,
                id: id.clone(),
            });
        }
    }
    (targets.json, targets.plant) = (args.json.json, Some(args.out));
    Ok(Work::Refine(task, asked))
}

fn to_explain(logs: &LogsArgs, plant: &PlantArgs) -> Result<run::diagnose::Task, Failure> {
    let plant_as_given = NamedPlant::from_args(plant, NamedPlant::nominal())?;
    let task = run::diagnose::Task {
        plant: plant_as_given.knowing(&logs.knowledge)?,
        logs: input::logs(&logs.logs(), logs)?,
        check: input::logs(&logs.check, logs)?,
        options: Options::of(logs, plant),
    };
    task.logs.iter().chain(&task.check).for_each(print_notes);
    Ok(task)
}

fn next_experiment(args: NextExperimentArgs, targets: &mut Targets) -> Result<Work, Failure> {
    (targets.json, targets.recording) = (args.json.json, args.out);
    let plant = NamedPlant::from_args(&args.plant, NamedPlant::nominal())?;
    let plant = plant.knowing(&args.knowledge)?;
    let log = input::log(&args.log)?;
    print_notes(&log);
    let usual_max_bar = Limits::usual_max_bar(&plant.parameters);
    let limits = Limits {
        duration_s: args.duration,
        max_bar: args.max_bar.unwrap_or(usual_max_bar),
        max_duty_pct: args.max_duty,
    };
    let effects = args
        .for_effect
        .into_iter()
        .chain(args.between)
        .chain(args.and)
        .collect();
    Ok(Work::NextExperiment(Box::new(run::next_experiment::Task {
        plant,
        log,
        effects,
        determine: args.determine,
        limits,
    })))
}

fn control(args: ControlArgs, targets: &mut Targets) -> Result<Work, Failure> {
    let scenario = Box::new(NamedScenario::from_args(&args)?);
    print_to_stderr(&print::scenario_warnings(
        &scenario.scenario,
        &Terminal::standard_error(),
    ));
    if let Some(out) = &args.rigs_out {
        let task = monte_carlo(&args, *scenario, out, targets.existing)?;
        targets.json = args.json.json;
        return Ok(Work::MonteCarlo(Box::new(task)));
    }
    if args.rigs > RIGS_IN_MEMORY_MAX {
        return Err(Failure::TooManyRigs {
            count: args.rigs,
            max: RIGS_IN_MEMORY_MAX,
        });
    }
    (targets.json, targets.html) = (args.json.json, args.html.html);
    targets.recording = args.out.out;
    Ok(match args.dut {
        None => Work::Control {
            scenario,
            rigs: args.rigs,
        },
        Some(dut) => Work::OnDevice(Box::new(run::device::Task {
            scenario: *scenario,
            dut,
            image: args.image,
            pace: args.pace,
        })),
    })
}

/// Largest number of rigs whose verdicts are kept in memory.
const RIGS_IN_MEMORY_MAX: u32 = 100_000;

fn monte_carlo(
    args: &ControlArgs,
    scenario: NamedScenario,
    out: &Path,
    existing: Existing,
) -> Result<run::monte_carlo::Task, Failure> {
    if args.rigs == 0 {
        return Err(Failure::NoRigs);
    }
    let jobs = args.jobs.and_then(|jobs| NonZero::new(jobs.into()));
    let cores = || thread::available_parallelism().unwrap_or(NonZero::<usize>::MIN);
    Ok(run::monte_carlo::Task {
        command: command_of_rig(args),
        scenario,
        rigs: args.rigs,
        shard: args.shard,
        jobs: jobs.unwrap_or_else(cores),
        out: as_parquet(out.to_path_buf())?,
        existing,
    })
}

fn merge_rigs(args: MergeRigsArgs, targets: &mut Targets) -> Result<Work, Failure> {
    targets.json = args.json.json;
    Ok(Work::MergeRigs(run::monte_carlo::MergeTask {
        shards: args.shards,
        out: as_parquet(args.out)?,
        existing: targets.existing,
    }))
}

fn report(args: ReportArgs, targets: &mut Targets) -> Result<Work, Failure> {
    let subject = to_explain(&args.logs, &args.plant)?;
    targets.html = Some(args.out);
    Ok(Work::Report(Box::new(run::session::Task {
        subject,
        controller: NamedController::from_args(&args.controller)?,
        scenario: input::built_in_scenario(&args.scenario),
        rigs: args.rigs,
        conditions: args.conditions.conditions(),
        requirements: NamedRequirement::from_args(&args.requirements)?,
        without: args.without,
    })))
}

/// Prints the notes on the log before the work begins.
fn print_notes(log: &Recording) {
    print_to_stderr(&print::log_notes(log, &Terminal::standard_error()));
}

fn print_to_stderr(text: &str) {
    // A closed standard error is not a failure.
    let _ = anstream::stderr().write_all(text.as_bytes());
}

/// Returns the path of a file that is written as CSV only.
fn as_csv(path: Option<PathBuf>) -> Result<Option<PathBuf>, Failure> {
    match path {
        Some(path) if LogFormat::of_name(&path) != LogFormat::Csv => Err(Failure::OnlyCsv { path }),
        path => Ok(path),
    }
}

/// Returns the path of a table of rigs.
fn as_parquet(path: PathBuf) -> Result<PathBuf, Failure> {
    match LogFormat::of_name(&path) {
        LogFormat::Parquet => Ok(path),
        _ => Err(Failure::OnlyParquet { path }),
    }
}

fn schema_text(result: SchemaName) -> String {
    let mut text = format!("{:#}", schema::of(result).to_value());
    text.push('\n');
    text
}

fn completions(shell: clap_complete::Shell) -> String {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "retarder", &mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}
