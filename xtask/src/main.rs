//! The verbs of the workshop: `cargo xtask --help` lists them, `docs/building.md` explains them.
//!
//! One file per group of verbs ([`host`], [`arm`], [`publish`], [`blind`], [`hostile`]); below them what a machine has and lacks ([`toolchain`],
//! [`qemu`], [`packages`]), and how a step runs, ends and is told ([`process`], [`report`]) and the tests are called ([`tests`]).

mod arm;
mod blind;
mod budgets;
mod coverage;
mod digests;
mod failure;
mod host;
mod hostile;
mod mutants;
mod packages;
mod process;
mod publish;
mod qemu;
mod report;
mod tests;
mod toolchain;
mod workspace;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};

use report::Report;
use toolchain::Choice;

/// Build, image, test and CI verbs.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Every test, host and ARM; installs what is missing. What the CI runs.
    #[command(visible_alias = "ci")]
    Test {
        /// Run one part only.
        #[arg(long)]
        only: Option<Part>,
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Build the image for the ECU and say where it lies.
    Image {
        /// The machine to build for.
        #[arg(long, default_value = "mps2-an386")]
        board: qemu::Board,
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// What a control sample costs, beside its peers; fails if a budget is exceeded.
    Budgets {
        /// Where to write the findings as JSON, besides.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Lines and branches of the controller that its tests never run; fails if there are any.
    Coverage,
    /// Break controller and supervisor place by place: the tests must see it. Takes an hour or more.
    Mutants {
        /// One crate only.
        #[arg(long)]
        only: Option<mutants::Subject>,
        /// One part of the mutants, such as 0/8.
        #[arg(long)]
        shard: Option<mutants::Shard>,
    },
    /// The blind benchmark of the diagnosis: draw rigs, diagnose them, score. Goes on where it was stopped.
    Blind {
        /// Folder of the draw; what is there already is kept.
        #[arg(long, value_name = "FOLDER")]
        draw: PathBuf,
        /// Seed of the rigs.
        #[arg(long)]
        seed: u64,
        /// Share of the full set.
        #[arg(long, default_value_t = 1.0)]
        share: f64,
    },
    /// The field benchmarks: draw field rigs, refine their plant files, score; with --effects diagnose them, and score the names. Goes on where it was stopped.
    Field {
        /// Folder of the draw; what is there already is kept.
        #[arg(long, value_name = "FOLDER")]
        draw: PathBuf,
        /// Seed of the rigs.
        #[arg(long)]
        seed: u64,
        /// Number of rigs.
        #[arg(long, default_value_t = 100)]
        rigs: usize,
        /// Hidden effects of each rig: a number, or two as in 0..4.
        #[arg(long, value_name = "NUMBER")]
        effects: Option<String>,
    },
    /// Let the command read damaged files under limits of time and memory. Takes half an hour; Ctrl-C ends it with the table so far.
    Damage {
        /// Number of damaged files.
        #[arg(long, default_value_t = 100_000)]
        cases: u64,
        /// Seed of the damages.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Runs at a time.
        #[arg(long, default_value_t = 2)]
        jobs: usize,
        /// Folder for the files and the command line of each finding.
        #[arg(long, value_name = "FOLDER", default_value = "target/damage")]
        failures: PathBuf,
    },
    /// Kill the command and the server at random moments: nothing may be lost. Takes some minutes.
    Kills {
        /// Kills of each of the two.
        #[arg(long, default_value_t = 50)]
        kills: u64,
        /// Seed of the moments.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Install what the other verbs need, and run nothing.
    Setup {
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Format every file.
    Fmt,
    /// Format check, clippy, rustdoc.
    Lint,
    /// `cargo publish --dry-run` of all library crates together.
    PublishCheck {
        /// Also with changes that are not committed.
        #[arg(long)]
        allow_dirty: bool,
    },
}

#[derive(Args)]
struct ArmOptions {
    /// Where the ARM target comes from.
    #[arg(long, default_value = "auto")]
    toolchain: Choice,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Format check, clippy, rustdoc.
    Lint,
    /// Tests and examples on this machine, and what of the controller they reach.
    Host,
    /// Some mutants of controller and supervisor, drawn by the commit.
    Mutants,
    /// The image: built, run in QEMU, its bits compared with the host's, in the loop with the plant.
    Arm,
    /// What a sample and the image cost, counted and proved.
    Budgets,
}

fn main() -> ExitCode {
    let mut report = Report::default();
    match Cli::parse().verb {
        Verb::Test { only, arm } => {
            let wanted = |part| only.is_none_or(|one| one == part);
            if wanted(Part::Lint) {
                host::lint(&mut report);
            }
            if wanted(Part::Host) {
                host::test(&mut report);
                coverage::check(&mut report);
            }
            if wanted(Part::Mutants) {
                mutants::check_a_part(&mut report);
            }
            if wanted(Part::Arm) {
                arm::test(&mut report, arm.toolchain);
            }
            if wanted(Part::Budgets) {
                budgets::run(&mut report, arm.toolchain, None);
            }
        }
        Verb::Image { board, arm } => arm::image(&mut report, board, arm.toolchain),
        Verb::Budgets { json, arm } => {
            budgets::run(&mut report, arm.toolchain, json.as_deref());
        }
        Verb::Coverage => coverage::check(&mut report),
        Verb::Mutants { only, shard } => mutants::check(&mut report, only, shard),
        Verb::Blind { draw, seed, share } => blind::run(&mut report, &draw, seed, share),
        Verb::Field {
            draw,
            seed,
            rigs,
            effects,
        } => blind::field(&mut report, &draw, seed, rigs, effects.as_deref()),
        Verb::Damage {
            cases,
            seed,
            jobs,
            failures,
        } => hostile::damage(&mut report, cases, seed, jobs, &failures),
        Verb::Kills { kills, seed } => hostile::kills(&mut report, kills, seed),
        Verb::Setup { arm } => {
            host::setup(&mut report);
            arm::setup(&mut report, arm.toolchain);
            budgets::setup(&mut report);
        }
        Verb::Fmt => host::format(&mut report),
        Verb::Lint => host::lint(&mut report),
        Verb::PublishCheck { allow_dirty } => publish::check(&mut report, allow_dirty),
    }
    print!("\n{report}");
    if report.all_passed() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
