//! Commands that read a bench's files: cheap ones often, expensive ones rarely.

use super::originals::{Bench, Role, name_of};
use super::values::NUMBERS;
use crate::chance::Chance;

/// Command of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "called as on the command line")]
pub enum Name {
    Simulate,
    Compare,
    Control,
    Parameters,
    Settings,
    Thesis,
    Report,
    Refine,
    NextExperiment,
    Diagnose,
    Serve,
}

impl Name {
    /// All commands, the cheap ones first, each with its relative frequency.
    pub const ALL: [(Self, f64); 11] = [
        (Self::Simulate, 30.0),
        (Self::Compare, 34.0),
        (Self::Control, 14.0),
        (Self::Parameters, 9.0),
        (Self::Settings, 5.0),
        (Self::Thesis, 1.5),
        (Self::Report, 2.0),
        (Self::Refine, 1.5),
        (Self::NextExperiment, 1.5),
        (Self::Diagnose, 1.5),
        // Not drawn here: it is drawn together with its bench, the project folder.
        (Self::Serve, 0.0),
    ];

    /// Returns the command as typed.
    pub fn word(self) -> &'static str {
        match self {
            Self::Simulate => "simulate",
            Self::Compare => "compare",
            Self::Control => "control",
            Self::Parameters => "parameters",
            Self::Settings => "settings",
            Self::Thesis => "thesis",
            Self::Report => "report",
            Self::Refine => "refine",
            Self::NextExperiment => "next-experiment",
            Self::Diagnose => "diagnose",
            Self::Serve => "serve",
        }
    }

    /// Returns whether a run takes tenths of a second rather than milliseconds.
    pub fn is_dear(self) -> bool {
        matches!(
            self,
            Self::Thesis | Self::Report | Self::Refine | Self::NextExperiment | Self::Diagnose
        )
    }

    fn draw(chance: &mut Chance, effort: Effort) -> Self {
        let all = Self::ALL
            .iter()
            .filter(|(name, _)| effort == Effort::All || !name.is_dear());
        let sum: f64 = all.clone().map(|(_, weight)| weight).sum();
        let mut left = chance.between(0.0, sum);
        for (name, weight) in all {
            left -= weight;
            if left < 0.0 {
                return *name;
            }
        }
        Self::Compare
    }
}

/// Selection of commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effort {
    /// Commands that take milliseconds.
    Cheap,
    /// All commands.
    All,
}

/// Command line in the folder of a case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CommandLine {
    /// Command.
    pub name: Name,
    /// Command and its arguments.
    pub arguments: Vec<String>,
    /// File for the standard input.
    pub standard_input: Option<Role>,
    /// Roles of the files that it reads.
    pub reads: Vec<Role>,
}

const EFFECTS: [&str; 10] = [
    "chamber_leak",
    "supply_seat_leak",
    "dead_volume",
    "sensor_lag",
    "sensor_offset",
    "coil_heating",
    "critical_ratio",
    "gas_temperature",
    "static_friction",
    "series_restriction",
];

const SCENARIOS: [&str; 4] = ["figure-6.5", "fill-requirement", "vent-requirement", "hold"];

const PARAMETERS: [&str; 10] = [
    "chamber.volume_m3",
    "gas.supply_pressure_bar_gauge",
    "gas.temperature_k",
    "coil.resistance_20c_ohm",
    "ecu.sample_time_s",
    "ecu.pwm_frequency_hz",
    "flow.orifice_fill_m",
    "armature.stroke_m",
    "sensor.noise_bar",
    "gas.ambient_pressure_pa",
];

/// Draws a command that can read some of the bench's files.
pub fn draw(bench: &Bench, chance: &mut Chance, effort: Effort) -> CommandLine {
    let name = match bench.file(Role::Project) {
        Some(_) => Name::Serve,
        None => Name::draw(chance, effort.min(bench.effort)),
    };
    let needs_all = matches!(name, Name::Control | Name::Settings | Name::Thesis);
    let name = if needs_all && !bench.is_whole {
        Name::Compare
    } else {
        name
    };
    let mut line = CommandLine {
        name,
        arguments: vec![name.word().to_owned()],
        standard_input: None,
        reads: Vec::new(),
    };
    match name {
        Name::Serve => line.file(bench, Role::Project, "--project"),
        Name::Simulate => line.simulate(bench, chance),
        Name::Compare => line.compare(bench, chance),
        Name::Control => line.control(bench, chance),
        Name::Parameters => {
            line.plant(bench, chance, 1.0);
            line.flag(chance, 0.3, "--toml");
        }
        Name::Settings => {
            line.file(bench, Role::Controller, "--controller");
            line.flag(chance, 0.3, "--toml");
        }
        Name::Thesis => {
            line.plant(bench, chance, 1.0);
            line.flag(chance, 0.05, "--explain");
            line.json(chance);
        }
        Name::Report => line.report(bench, chance),
        Name::Refine => line.refine(bench, chance),
        Name::NextExperiment => line.next_experiment(bench, chance),
        Name::Diagnose => {
            line.logs(bench, chance);
            line.json(chance);
            line.html(chance);
        }
    }
    line
}

impl CommandLine {
    fn add(&mut self, words: &[&str]) {
        self.arguments
            .extend(words.iter().map(|&word| word.to_owned()));
    }

    fn flag(&mut self, chance: &mut Chance, probability: f64, flag: &str) {
        if chance.happens(probability) {
            self.add(&[flag]);
        }
    }

    fn file(&mut self, bench: &Bench, role: Role, option: &str) {
        if bench.file(role).is_some() {
            self.add(&[option, &name_of(role).to_string_lossy()]);
            self.reads.push(role);
        }
    }

    /// Adds the plant file, and sometimes a parameter.
    fn plant(&mut self, bench: &Bench, chance: &mut Chance, probability: f64) {
        if !bench.is_whole || chance.happens(probability) {
            self.file(bench, Role::Plant, "--plant");
        }
        if chance.happens(0.08) {
            let (name, value) = (chance.one_of(&PARAMETERS), chance.one_of(&NUMBERS));
            self.add(&["--set", &format!("{name}={value}")]);
        }
    }

    fn mapping(&mut self, bench: &Bench) {
        self.file(bench, Role::Mapping, "--mapping");
    }

    fn log(&mut self, bench: &Bench, chance: &mut Chance) {
        let Some(role) = bench.log().map(|log| log.role) else {
            return;
        };
        if chance.happens(0.04) {
            self.add(&["--log", "-"]);
            self.standard_input = Some(role);
            self.reads.push(role);
        } else {
            self.file(bench, role, "--log");
        }
        self.mapping(bench);
    }

    /// Adds a log, with the same plant and mapping as for a single log.
    fn logs(&mut self, bench: &Bench, chance: &mut Chance) {
        self.log(bench, chance);
        self.plant(bench, chance, 0.5);
    }

    fn json(&mut self, chance: &mut Chance) {
        match chance.whole(0, 3) {
            0 => self.add(&["--json"]),
            1 => self.add(&["--json", "out.json"]),
            _ => {}
        }
    }

    fn html(&mut self, chance: &mut Chance) {
        if chance.happens(0.2) {
            self.add(&["--html", "out.html"]);
        }
    }

    /// Adds a recording, as CSV or MF4.
    fn out(&mut self, chance: &mut Chance) {
        match chance.whole(0, 4) {
            0 => self.add(&["--out", "out.mf4"]),
            1 | 2 => self.add(&["--out", "out.csv"]),
            _ => {}
        }
    }

    fn simulate(&mut self, bench: &Bench, chance: &mut Chance) {
        self.logs(bench, chance);
        let before = self.arguments.len();
        self.out(chance);
        if self.arguments.len() > before {
            self.json(chance);
        }
    }

    fn compare(&mut self, bench: &Bench, chance: &mut Chance) {
        self.logs(bench, chance);
        self.json(chance);
        self.html(chance);
        if chance.happens(0.1) {
            self.add(&["--signal", chance.one_of(&["p_ch", "i_fill", "i_vent"])]);
        }
        if chance.happens(0.05) {
            self.add(&["--allow", chance.one_of(&NUMBERS)]);
        }
        if chance.happens(0.05) {
            self.add(&["--tolerance", &format!("p_ch={}", chance.one_of(&NUMBERS))]);
        }
    }

    fn control(&mut self, bench: &Bench, chance: &mut Chance) {
        self.plant(bench, chance, 0.5);
        if chance.happens(0.5) {
            self.file(bench, Role::Controller, "--controller");
        }
        if chance.happens(0.5) {
            self.file(bench, Role::Reference, "--reference");
        } else if chance.happens(0.5) {
            self.add(&["--scenario", chance.one_of(&SCENARIOS)]);
        }
        if chance.happens(0.1) {
            self.add(&["--rigs", "2"]);
        }
        self.out(chance);
        self.json(chance);
        self.html(chance);
    }

    fn report(&mut self, bench: &Bench, chance: &mut Chance) {
        self.logs(bench, chance);
        if chance.happens(0.5) {
            self.file(bench, Role::Controller, "--controller");
        }
        if chance.happens(0.8) {
            self.add(&["--without", "diagnosis"]);
        }
        self.flag(chance, 0.2, "--without=control");
        self.add(&["--out", "out.html"]);
    }

    fn refine(&mut self, bench: &Bench, chance: &mut Chance) {
        self.logs(bench, chance);
        self.add(&["--add", chance.one_of(&EFFECTS)]);
        self.add(&["--out", "out.toml"]);
        self.json(chance);
    }

    fn next_experiment(&mut self, bench: &Bench, chance: &mut Chance) {
        self.log(bench, chance);
        self.plant(bench, chance, 0.5);
        let first = chance.one_of(&EFFECTS);
        if chance.happens(0.5) {
            self.add(&["--for", first]);
        } else {
            self.add(&["--between", first, "--and", chance.one_of(&EFFECTS)]);
        }
        self.add(&["--duration", chance.one_of(&["1", "2"])]);
        self.add(&["--out", "out.csv"]);
    }
}
