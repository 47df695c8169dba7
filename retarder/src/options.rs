//! Options of a command in the form of a command line, for the commands that a result proposes.

use std::path::Path;

use hil_harness::Supply;

use crate::cli::{
    Assignment, ControlArgs, DEFAULT_SCENARIO, Freed, ImportArgs, LogsArgs, PlantArgs,
};
use crate::shell::quoted;

/// Options that name plant and logs.
pub(crate) struct Options {
    plant: String,
    logs: String,
    mapping: String,
    first_log: String,
    all_as_logs: String,
    knowledge: String,
    needs: String,
}

impl Options {
    pub(crate) fn of(logs: &LogsArgs, plant: &PlantArgs) -> Self {
        let mapping = import(&logs.import);
        let given = logs.logs();
        let sets = plant.set.iter().map(|Assignment { name, value }| {
            let assignment = format!("{name}={value}");
            option("--set", &assignment)
        });
        let freed = logs.knowledge.free.iter().map(|Freed { what, range }| {
            let range = range.map(|(low, high)| format!("={low}..{high}"));
            option("--free", &format!("{what}{}", range.unwrap_or_default()))
        });
        let fixed = logs.knowledge.fix.iter();
        let fixed = fixed.map(|what| option("--fix", what));
        let needs = logs.need.iter().map(|Assignment { name, value }| {
            let assignment = format!("{name}={value}");
            option("--need", &assignment)
        });
        Self {
            plant: paths("--plant", plant.plant.as_slice()),
            logs: paths("--log", &given) + &paths("--check", &logs.check),
            first_log: paths("--log", &given[..given.len().min(1)]),
            all_as_logs: paths("--log", &given) + &paths("--log", &logs.check),
            mapping,
            knowledge: sets.chain(freed).chain(fixed).collect(),
            needs: needs.collect(),
        }
    }

    /// Returns all options as given.
    pub(crate) fn as_given(&self) -> String {
        let Self {
            plant,
            logs,
            mapping,
            knowledge,
            needs,
            ..
        } = self;
        format!("{plant}{logs}{mapping}{knowledge}{needs}")
    }

    /// Returns the same logs with the plant file `plant`, which contains the changes to the first one.
    pub(crate) fn with_plant(&self, plant: &Path) -> String {
        let plant = paths("--plant", &[plant]);
        format!("{plant}{}{}{}", self.logs, self.mapping, self.needs)
    }

    /// Returns the same options, and the plant file as the output.
    pub(crate) fn with_plant_anew(&self, plant: &Path) -> String {
        self.with_plant(plant) + &option("--out", &plant.to_string_lossy())
    }

    /// Returns the same options with every log to fit, and the plant file as the output.
    pub(crate) fn with_plant_anew_and_all_logs(&self, plant: &Path) -> String {
        let file = paths("--plant", &[plant]);
        let out = option("--out", &plant.to_string_lossy());
        format!(
            "{file}{}{}{}{out}",
            self.all_as_logs, self.mapping, self.needs
        )
    }

    /// Returns the options of the plant file `plant` and the first log alone.
    pub(crate) fn with_plant_and_one_log(&self, plant: &Path) -> String {
        let plant = paths("--plant", &[plant]);
        format!("{plant}{}{}", self.first_log, self.mapping)
    }
}

/// Returns the command that runs one rig of a batch, without the number of the rig.
pub(crate) fn command_of_rig(args: &ControlArgs) -> String {
    let sets = args.plant.set.iter().map(|Assignment { name, value }| {
        let assignment = format!("{name}={value}");
        option("--set", &assignment)
    });
    let scenario = Some(&*args.scenario).filter(|&scenario| scenario != DEFAULT_SCENARIO);
    let supply = args.conditions.supply_voltage.map(|supply| match supply {
        Supply::Constant(volt) => option("--supply-voltage", &volt.to_string()),
        Supply::Profile(profile) => option("--supply-voltage", profile.name),
    });
    let celsius = args.conditions.coil_temperature;
    let celsius = celsius.map(|celsius| option("--coil-temperature", &celsius.to_string()));
    let options = [
        paths("--plant", args.plant.plant.as_slice()),
        sets.collect(),
        paths("--controller", &[&args.controller.controller]),
        paths("--reference", args.reference.as_slice()),
        scenario.map_or_else(String::new, |scenario| option("--scenario", scenario)),
        option("--seed", &args.seed.to_string()),
        supply.unwrap_or_default(),
        celsius.unwrap_or_default(),
        paths("--requirements", args.requirements.requirements.as_slice()),
    ];
    format!("retarder control{}", options.concat())
}

/// Returns the options that state how a log is read.
fn import(import: &ImportArgs) -> String {
    let reference = import.pressure().into_iter();
    let reference = reference.map(|reference| option("--pressure", reference));
    let skip = Some(import.skip_bad_rows).filter(|&count| count > 0);
    let skip = skip.map(|count| option("--skip-bad-rows", &count.to_string()));
    let mapping = paths("--mapping", import.mapping.as_slice());
    mapping + &reference.chain(skip).collect::<String>()
}

fn paths<P: AsRef<Path>>(name: &str, paths: &[P]) -> String {
    let options = paths.iter();
    options
        .map(|path| option(name, &path.as_ref().to_string_lossy()))
        .collect()
}

fn option(name: &str, value: &str) -> String {
    format!(" {name} {}", quoted(value))
}
