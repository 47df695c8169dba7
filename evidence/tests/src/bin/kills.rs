//! Kills the built program at random moments, and checks whether data was lost.

#[cfg(unix)]
mod program {
    use std::path::PathBuf;
    use std::process::ExitCode;

    use clap::Parser;
    use retarder_tests::kills::{Kills, Loss, diagnose, serve};

    /// Kill `retarder diagnose --json --html` and `retarder serve` by `kill -9`, and check whether data was lost.
    ///
    /// Exit status: 0 nothing was lost, 1 something was.
    #[derive(Parser)]
    struct Options {
        /// Path of the command `retarder`.
        #[arg(long)]
        retarder: PathBuf,
        /// Number of kills of each of the two.
        #[arg(long, default_value_t = 50)]
        kills: u64,
        /// Seed of the random moments.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    }

    type Target = fn(&std::path::Path, u64, u64) -> Result<Kills, Loss>;

    pub(crate) fn main() -> ExitCode {
        let options = Options::parse();
        let retarder = std::path::absolute(&options.retarder).unwrap_or(options.retarder);
        let targets: [(&str, Target); 2] = [("diagnose", diagnose::kill), ("serve", serve::kill)];
        let mut code = ExitCode::SUCCESS;
        for (name, kill) in targets {
            match kill(&retarder, options.seed, options.kills) {
                Ok(kills) => println!(
                    "{name}: seed {}: {} kills at work, {} after the end; {} with a temporary file until the next run, {} with the new state; nothing lost",
                    options.seed,
                    kills.at_work,
                    kills.too_late,
                    kills.with_leavings,
                    kills.with_news
                ),
                Err(loss) => {
                    println!("{name}, seed {}: {loss}", options.seed);
                    code = ExitCode::FAILURE;
                }
            }
        }
        code
    }
}

#[cfg(unix)]
fn main() -> std::process::ExitCode {
    program::main()
}

#[cfg(not(unix))]
fn main() {
    eprintln!("error: signals are Unix's; run this on Linux or macOS");
    std::process::exit(2);
}
