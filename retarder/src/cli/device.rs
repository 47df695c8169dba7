//! Commands that talk to a device.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueHint};

use super::{JsonArg, OutArg};
use crate::dut::Dut;

#[derive(Debug, Args)]
pub(crate) struct DeviceArgs {
    /// in-process, qemu, qemu:uart, qemu:mailbox or serial:PORT
    #[arg(long, value_name = "DEVICE")]
    pub(crate) dut: Dut,
    /// ELF file of the image; without it the one that `cargo xtask image` has built
    #[arg(long, value_name = "ELF", value_hint = ValueHint::FilePath)]
    pub(crate) image: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder blackbox --dut serial:/dev/ttyACM0
  retarder blackbox --dut serial:COM3 --out last-seconds.csv --clear
  retarder blackbox --dut qemu --json

Reading disturbs nothing: the device goes on by its own timer.")]
pub(crate) struct BlackBoxArgs {
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
    /// Empty the box once it is read, so that it records the next fault
    #[arg(long)]
    pub(crate) clear: bool,
    #[command(flatten)]
    pub(crate) out: OutArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder calibrate signals
  retarder calibrate read --dut serial:/dev/ttyACM0
  retarder calibrate write --dut serial:/dev/ttyACM0 gain_pct_per_bar=30 boost=off --save
  retarder calibrate measure --dut serial:/dev/ttyACM0 p_ref u --samples 1000 --out run.csv")]
pub(crate) struct CalibrateArgs {
    #[command(subcommand)]
    pub(crate) command: CalibrateCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum CalibrateCommand {
    /// The signals that can be measured: name, unit
    #[command(after_help = "Example:\n  retarder calibrate signals")]
    Signals,
    /// The settings that are in effect
    Read(ReadArgs),
    /// Change settings: all of them with the same sample, or none
    Write(WriteArgs),
    /// Measure up to 16 signals in every sample, as CSV
    Measure(MeasureArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder calibrate read --dut qemu
  retarder calibrate read --dut serial:/dev/ttyACM0 gain_pct_per_bar integral_time_ms")]
pub(crate) struct ReadArgs {
    /// Names of settings; all without any
    #[arg(value_name = "SETTING")]
    pub(crate) settings: Vec<String>,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder calibrate write --dut serial:/dev/ttyACM0 gain_pct_per_bar=30
  retarder calibrate write --dut serial:/dev/ttyACM0 boost=off prediction=one_step --save
  retarder calibrate write --dut serial:/dev/ttyACM0 --defaults --save

The device checks all settings together; what it refuses changes nothing.")]
pub(crate) struct WriteArgs {
    /// Setting and its new value: a number, or the name of a choice
    #[arg(value_name = "SETTING=VALUE", required_unless_present_any = ["defaults", "save"])]
    pub(crate) assignments: Vec<String>,
    /// Begin with the settings that come with this version, not with those in effect
    #[arg(long)]
    pub(crate) defaults: bool,
    /// Keep the settings for the next start; the coils must be off
    #[arg(long)]
    pub(crate) save: bool,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder calibrate measure --dut serial:/dev/ttyACM0 p_ref p_ch_measured u mode
  retarder calibrate measure --dut qemu start_latency drive_latency --samples 500 --out t.csv")]
pub(crate) struct MeasureArgs {
    /// Names of signals, see `retarder calibrate signals`
    #[arg(value_name = "SIGNAL", required = true)]
    pub(crate) signals: Vec<String>,
    /// How many samples; 100 are a second
    #[arg(long, value_name = "COUNT", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) samples: u32,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
    #[command(flatten)]
    pub(crate) out: OutArg,
}
