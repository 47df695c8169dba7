//! Commands that talk to a device.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueHint};

use super::{JsonArg, OutArg};
use crate::dut::Dut;

#[derive(Debug, Args)]
pub(crate) struct DeviceArgs {
    /// Device: in-process, qemu, qemu:uart, qemu:mailbox or serial:PORT
    #[arg(long, value_name = "DEVICE")]
    pub(crate) dut: Dut,
    /// ELF file of the image; without this option the file that `cargo xtask image` built
    #[arg(long, value_name = "ELF", value_hint = ValueHint::FilePath)]
    pub(crate) image: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder blackbox --dut serial:/dev/ttyACM0
  retarder blackbox --dut serial:COM3 --out last-seconds.csv --clear
  retarder blackbox --dut qemu --json

Reading does not disturb the device: it continues with its own timer.")]
pub(crate) struct BlackBoxArgs {
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
    /// Clear the box after it is read, so that it records the next fault
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
    /// List the signals that can be measured: name, unit
    #[command(after_help = "Example:\n  retarder calibrate signals")]
    Signals,
    /// Read the settings in effect
    Read(ReadArgs),
    /// Change settings: all in the same sample, or none
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
    /// Names of settings; without names all settings
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

The device checks all settings together. If it refuses one, none is changed.")]
pub(crate) struct WriteArgs {
    /// Setting and its new value: a number or the name of a choice
    #[arg(value_name = "SETTING=VALUE", required_unless_present_any = ["defaults", "save"])]
    pub(crate) assignments: Vec<String>,
    /// Start from the default settings of this version, not from those in effect
    #[arg(long)]
    pub(crate) defaults: bool,
    /// Save the settings for the next start; the coils must be off
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
    /// Names of signals (see `retarder calibrate signals`)
    #[arg(value_name = "SIGNAL", required = true)]
    pub(crate) signals: Vec<String>,
    /// Number of samples; 100 take one second
    #[arg(long, value_name = "COUNT", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) samples: u32,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
    #[command(flatten)]
    pub(crate) out: OutArg,
}
