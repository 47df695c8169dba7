//! Commands for development: `cargo xtask --help` lists them, `docs/building.md` explains them.
//!
//! One file per group of commands ([`host`], [`arm`], [`publish`], [`blind`], [`hostile`]). Below them: the tools of a
//! machine and their installation ([`toolchain`], [`qemu`], [`packages`]), steps and their results ([`process`],
//! [`report`]), and the calls of the tests ([`tests`]).

mod arm;
mod axe;
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

/// Build, image, test and CI commands.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Run every test, host and ARM, and install what is missing; the CI runs this.
    #[command(visible_alias = "ci")]
    Test {
        /// Run only this part.
        #[arg(long)]
        only: Option<Part>,
        /// Check format and lints, and run the unit tests that take seconds: what to run while working.
        #[arg(long, conflicts_with = "only")]
        fast: bool,
        /// Run every regression rig of the diagnosis, not the part of them that the commit selects: before a release and
        /// after a change of the diagnosis. Takes 15 minutes more.
        #[arg(long)]
        every_rig: bool,
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Build the image for the ECU and print its path.
    Image {
        /// Board to build for.
        #[arg(long, default_value = "mps2-an386")]
        board: qemu::Board,
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Measure the cost of a control sample, also of comparable controllers; fails if a budget is exceeded.
    Budgets {
        /// Also write the findings as JSON to this file.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Find lines and branches of the controller that its tests never run; fails if there are any.
    Coverage,
    /// Run mutation tests: each change of controller or supervisor must fail a test. Takes an hour or more.
    Mutants {
        /// Test only this crate.
        #[arg(long)]
        only: Option<mutants::Subject>,
        /// Test only this part of the mutants, such as 0/8.
        #[arg(long)]
        shard: Option<mutants::Shard>,
    },
    /// Run the blind benchmark of the diagnosis: draw rigs, diagnose them, score. Resumes an interrupted run.
    Blind {
        /// Folder of the draw; existing files are kept.
        #[arg(long, value_name = "FOLDER")]
        draw: PathBuf,
        /// Seed of the rigs.
        #[arg(long)]
        seed: u64,
        /// Share of the full set.
        #[arg(long, default_value_t = 1.0)]
        share: f64,
    },
    /// Run the field benchmarks: draw field rigs, refine their plant files, score; with --effects also diagnose them
    /// and score the named effects. Resumes an interrupted run.
    Field {
        /// Folder of the draw; existing files are kept.
        #[arg(long, value_name = "FOLDER")]
        draw: PathBuf,
        /// Seed of the rigs.
        #[arg(long)]
        seed: u64,
        /// Number of rigs.
        #[arg(long, default_value_t = 100)]
        rigs: usize,
        /// Number of hidden effects of each rig, or a range as in 0..4.
        #[arg(long, value_name = "NUMBER")]
        effects: Option<String>,
    },
    /// Run the command on damaged files, with limits of time and memory. Takes half an hour; Ctrl-C ends it with the
    /// table so far.
    Damage {
        /// Number of damaged files.
        #[arg(long, default_value_t = 100_000)]
        cases: u64,
        /// Seed of the damage.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Number of parallel runs.
        #[arg(long, default_value_t = 2)]
        jobs: usize,
        /// Folder for the files and the command line of each finding.
        #[arg(long, value_name = "FOLDER", default_value = "target/damage")]
        failures: PathBuf,
    },
    /// Kill the command and the server at random moments: no data may be lost. Takes some minutes.
    Kills {
        /// Number of kills of each of the two.
        #[arg(long, default_value_t = 50)]
        kills: u64,
        /// Seed of the random moments.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Install the requirements of the other commands, and run nothing.
    Setup {
        #[command(flatten)]
        arm: ArmOptions,
    },
    /// Format every file.
    Fmt,
    /// Check formatting, clippy and rustdoc.
    Lint,
    /// Run `cargo publish --dry-run` on all library crates together.
    PublishCheck {
        /// Allow changes that are not committed.
        #[arg(long)]
        allow_dirty: bool,
    },
}

#[derive(Args)]
struct ArmOptions {
    /// Source of the ARM target.
    #[arg(long, default_value = "auto")]
    toolchain: Choice,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Check formatting, clippy and rustdoc.
    Lint,
    /// Run tests and examples on this machine, and measure the coverage of the controller.
    Host,
    /// Run some mutants of controller and supervisor, selected by the commit.
    Mutants,
    /// Build the image, run it in QEMU, compare its bits with the host's, and run it in the loop with the plant.
    Arm,
    /// Count and prove the cost of a sample and of the image.
    Budgets,
}

fn main() -> ExitCode {
    let mut report = Report::default();
    match Cli::parse().verb {
        Verb::Test { fast: true, .. } => host::fast(&mut report),
        Verb::Test {
            only,
            every_rig,
            arm,
            ..
        } => {
            let wanted = |part| only.is_none_or(|one| one == part);
            if wanted(Part::Lint) {
                host::lint(&mut report);
            }
            if wanted(Part::Host) {
                host::test(&mut report, every_rig);
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
