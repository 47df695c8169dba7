//! Runs the built program on damaged files, and counts the findings.

#[cfg(unix)]
mod program {
    use std::io::{IsTerminal as _, Write as _};
    use std::path::PathBuf;
    use std::process::ExitCode;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Instant;

    use clap::Parser;
    use retarder_tests::damage::campaign::{Campaign, Failure};
    use retarder_tests::damage::commands::Effort;
    use retarder_tests::damage::limits::Limits;
    use retarder_tests::damage::table::Table;

    /// Run `retarder` on damaged files, with limits of time and memory. Ctrl-C ends it with the table so far.
    ///
    /// Exit status: 0 no finding, 1 at least one finding, 2 could not run.
    #[derive(Parser)]
    struct Options {
        /// Path of the command `retarder`.
        #[arg(long)]
        retarder: PathBuf,
        /// Number of cases.
        #[arg(long, default_value_t = 1000)]
        cases: u64,
        /// Number of the first case; with `--cases 1`, that case alone.
        #[arg(long, default_value_t = 0)]
        from: u64,
        /// Seed of all cases.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Number of parallel runs.
        #[arg(long, default_value_t = 2)]
        jobs: usize,
        /// Folder for the cases with a finding.
        #[arg(long, default_value = "target/damage")]
        failures: PathBuf,
        /// Also keep the cases without a finding.
        #[arg(long)]
        keep: bool,
    }

    static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

    pub(crate) fn main() -> ExitCode {
        let options = Options::parse();
        let handler = ctrlc::set_handler(|| IS_INTERRUPTED.store(true, Ordering::Relaxed));
        if let Err(error) = handler {
            eprintln!("Ctrl-C will end it without a table: {error}");
        }
        let retarder = std::path::absolute(&options.retarder).unwrap_or(options.retarder);
        let campaign = Campaign {
            retarder,
            seed: options.seed,
            cases: options.from..options.from + options.cases,
            jobs: options.jobs,
            limits: Limits::default(),
            effort: Effort::All,
            failures: options.failures,
            keeps_all: options.keep,
        };
        let start = Instant::now();
        let is_terminal = std::io::stderr().is_terminal();
        let step = if is_terminal { 50 } else { 5000 };
        let report = |table: &Table, failure: Option<&Failure>| {
            let mut out = std::io::stderr().lock();
            if let Some(failure) = failure {
                let (finding, case) = (failure.finding, &failure.case);
                let _ = writeln!(
                    out,
                    "{finding}: --seed {} --from {} --cases 1: {} in {}",
                    campaign.seed,
                    case.number,
                    case.line(),
                    failure.folder.display()
                );
            }
            let (cases, all) = (table.cases(), options.cases);
            if cases.is_multiple_of(step) {
                let left = start.elapsed().as_secs_f64() / cases as f64 * (all - cases) as f64;
                let findings = table.findings();
                let _ = write!(
                    out,
                    "{cases} of {all} cases, {findings} findings, {left:.0} s left   "
                );
                let _ = out.write_all(if is_terminal { b"\r" } else { b"\n" });
            }
        };
        match campaign.run(&IS_INTERRUPTED, report) {
            Ok(table) => {
                println!(
                    "{table}, {:.0} s, seed {}",
                    start.elapsed().as_secs_f64(),
                    campaign.seed
                );
                if table.findings() == 0 {
                    ExitCode::SUCCESS
                } else {
                    ExitCode::FAILURE
                }
            }
            Err(error) => {
                eprintln!("error: {error}");
                ExitCode::from(2)
            }
        }
    }
}

#[cfg(unix)]
fn main() -> std::process::ExitCode {
    program::main()
}

#[cfg(not(unix))]
fn main() {
    eprintln!("error: limits and signals are Unix's; run this on Linux or macOS");
    std::process::exit(2);
}
