//! Closed loop: scenario, operating conditions, requirements.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};
use hil_harness::monte_carlo::Shard;
use hil_harness::scenario::BUILT_IN;
use hil_harness::voltage_profile::VOLTAGE_PROFILES;
use hil_harness::{OperatingConditions, Supply, VoltageProfile};

use super::{ControllerArg, HtmlArg, JsonArg, OutArg, PlantArgs};
use crate::dut::Dut;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder control
  retarder control --controller thesis --scenario fill-requirement
  retarder control --plant my-plant.toml --controller my-controller.toml --reference profile.csv
  retarder control --rigs 200                 robustness: 200 rigs of vehicles, scattered parameters and conditions
  retarder control --rigs 100000 --rigs-out rigs.parquet     a row of figures for each rig; continues after a kill
  retarder control --rigs 100000 --rigs-out 2of8.parquet --shard 2/8     a part of them; `merge-rigs` joins the parts
  retarder control --rig 4711                 one of these rigs alone, with plots
  retarder control --supply-voltage 28 --coil-temperature 90
  retarder control --supply-voltage cranking --requirements my-requirements.toml
  retarder control --out run.csv --json       the time series as CSV, the verdict as JSON
  retarder control --dut qemu                 the emulated firmware image as the controller
  retarder control --dut serial:/dev/ttyACM0  a board in lock step, with coils and sensor unplugged

A reference profile is a CSV file with the columns time_s and p_ref_bar_gauge. A value applies until the next.
Exit status: 0 every binding requirement is met, 1 at least one is not, 2 could not run.")]
pub(crate) struct ControlArgs {
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) controller: ControllerArg,
    /// Reference profile: CSV, MF4, Parquet or MATLAB
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "scenario")]
    pub(crate) reference: Option<PathBuf>,
    /// Built-in scenario: reference profile, start, and plant if none is given
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SCENARIO, value_parser = scenario_names())]
    pub(crate) scenario: String,
    /// Device under test: in-process, qemu, qemu:uart, qemu:mailbox or serial:PORT. Its log is shown, and its output is
    /// compared bit by bit with the ECU in process
    #[arg(long, value_name = "DEVICE", conflicts_with = "rigs")]
    pub(crate) dut: Option<Dut>,
    /// ELF file of the image; without this option the file that `cargo xtask image` built
    #[arg(long, value_name = "ELF", value_hint = ValueHint::FilePath, requires = "dut")]
    pub(crate) image: Option<PathBuf>,
    /// Speed of the live plot in a terminal, as a multiple of real time; 0: as fast as possible
    #[arg(long, value_name = "TIMES", default_value_t = 4, requires = "dut", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) pace: u32,
    /// Number of additional rigs, with parameters scattered about the plant; supply voltage and coil temperature are
    /// those of vehicles (18 to 32 V of 24 V, -40 to 120 degC) where they are not given
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=RIGS_MAX))]
    pub(crate) rigs: u32,
    /// Run this rig of the batch alone, by its number from 0; --seed and conditions are those of the batch
    #[arg(long, value_name = "NUMBER", conflicts_with = "rigs")]
    pub(crate) rig: Option<u32>,
    /// Run the rigs only, and write a row of figures for each to this Parquet file. Finished rigs are kept in FILE.part
    /// until the end: after a kill or Ctrl-C, the same command continues
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "rigs", conflicts_with_all = ["dut", "out", "html"])]
    pub(crate) rigs_out: Option<PathBuf>,
    /// Run part K of N equal parts of the rigs, such as 2/8; `retarder merge-rigs` joins the files of all parts
    #[arg(long, value_name = "K/N", default_value = "1/1", requires = "rigs_out")]
    pub(crate) shard: Shard,
    /// Number of threads for --rigs-out; without this option one for each core. The file does not depend on it
    #[arg(long, value_name = "COUNT", requires = "rigs_out", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Seed of sensor noise and of the scatter of the rigs
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) conditions: ConditionArgs,
    #[command(flatten)]
    pub(crate) requirements: RequirementsArg,
    #[command(flatten)]
    pub(crate) out: OutArg,
    #[command(flatten)]
    pub(crate) html: HtmlArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

/// Largest number of rigs of a batch.
const RIGS_MAX: i64 = 10_000_000;

/// Scenario of the thesis' figures: the staircase (thesis figure 6.5).
pub(crate) const DEFAULT_SCENARIO: &str = "figure-6.5";

pub(crate) fn scenario_names() -> impl TypedValueParser<Value = String> {
    PossibleValuesParser::new(
        BUILT_IN
            .iter()
            .map(|built_in| PossibleValue::new(built_in.name).help(built_in.about)),
    )
}

/// Operating conditions of the loop.
#[derive(Debug, Args)]
pub(crate) struct ConditionArgs {
    /// Supply voltage from time 0 on, in V, or a profile: ramp, cranking or load-dump; the settings of the ECU stay
    /// those of the plant's voltage
    #[arg(long, value_name = "VOLTS|PROFILE", value_parser = supply)]
    pub(crate) supply_voltage: Option<Supply>,
    /// Temperature of the coils, in degC; a plant file has their resistance at 20 degC
    #[arg(long, value_name = "CELSIUS", allow_negative_numbers = true)]
    pub(crate) coil_temperature: Option<f64>,
}

impl ConditionArgs {
    pub(crate) fn conditions(&self) -> OperatingConditions {
        OperatingConditions {
            supply: self.supply_voltage,
            coil_temperature_c: self.coil_temperature,
        }
    }
}

fn supply(text: &str) -> Result<Supply, String> {
    if let Some(profile) = VoltageProfile::built_in(text) {
        return Ok(Supply::Profile(profile));
    }
    let volt: Option<f64> = text.trim().parse().ok();
    let volt = volt.filter(|volt| volt.is_finite());
    volt.map(Supply::Constant).ok_or_else(|| {
        let names: Vec<&str> = VOLTAGE_PROFILES
            .iter()
            .map(|profile| profile.name)
            .collect();
        format!(
            "neither a voltage nor a profile; write volts, such as 28, or one of {}",
            names.join(", ")
        )
    })
}

/// Requirements on the loop.
#[derive(Debug, Args)]
pub(crate) struct RequirementsArg {
    /// Requirements file; without this option those of the thesis (`retarder settings --requirements` prints them)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) requirements: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_supply_is_a_voltage_or_a_profile() {
        assert_eq!(supply("28.5").unwrap(), Supply::Constant(28.5));
        let ramp = VoltageProfile::built_in("ramp").unwrap();
        assert_eq!(supply("ramp").unwrap(), Supply::Profile(ramp));
        for wrong in ["28 V", "inf", "crank", ""] {
            let error = supply(wrong).unwrap_err();
            assert!(error.ends_with("ramp, cranking, load-dump"), "{error}");
        }
    }
}
