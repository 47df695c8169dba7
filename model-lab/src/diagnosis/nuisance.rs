//! Ordinary parameters: those that differ from rig to rig without missing physics.

use plant_sim::PlantParameters;
use plant_sim::parameters::ParameterSpec;

/// Ordinary parameter in the list of those that a fit moves.
#[derive(Debug)]
struct Ordinary {
    /// Name in a plant file.
    name: &'static str,
    /// Parameters that move in proportion to it, unless the plant file frees them individually.
    together_with: &'static [&'static str],
    /// Usual tolerance of the part; none if a datasheet value counts as exact.
    usual: Option<Spread>,
    /// Possible error of the value in a first plant file.
    first_file: Spread,
    /// Signals that show it.
    shown_by: Shown,
    /// Excitation or measurement that determines it, for people.
    determined_by: &'static str,
    /// Standard deviation between two correct programs of one plant.
    between_programs: Spread,
    /// Standard deviation between two correct programs where no current is logged; none where that makes no difference.
    without_current: Option<Spread>,
}

/// Distance from the central value of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spread {
    /// Share of the value.
    Relative(f64),
    /// In the unit of the parameter.
    Absolute(f64),
}

impl Spread {
    /// Returns the distance from `value`, in the unit of the parameter.
    fn around(self, value: f64) -> f64 {
        match self {
            Self::Relative(share) => share * value.abs(),
            Self::Absolute(half_width) => half_width,
        }
    }
}

/// Signals that must be logged for a parameter to matter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    Always,
    /// Chamber pressure.
    InPressure,
    /// Chamber pressure of a log without its own supply pressure.
    WithoutLoggedSupply,
    /// Chamber pressure of a log whose supply pressure drives the model.
    WithLoggedSupply,
}

/// Signals in the logs, as far as they decide which parameters matter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shows {
    /// Whether a log has a coil current.
    pub(crate) current: bool,
    /// Whether a log has the chamber pressure, ...
    pub(crate) pressure: bool,
    /// ... with a supply pressure that drives the model, ...
    pub(crate) with_supply: bool,
    /// ... or without.
    pub(crate) without_supply: bool,
}

impl Shows {
    /// All signals.
    pub(crate) const EVERYTHING: Self = Self {
        current: true,
        pressure: true,
        with_supply: true,
        without_supply: true,
    };

    fn show(self, shown: Shown) -> bool {
        match shown {
            Shown::Always => true,
            Shown::InPressure => self.pressure,
            Shown::WithoutLoggedSupply => self.without_supply,
            Shown::WithLoggedSupply => self.with_supply,
        }
    }
}

const fn relative(
    name: &'static str,
    usual: f64,
    shown_by: Shown,
    determined_by: &'static str,
) -> Ordinary {
    Ordinary {
        name,
        together_with: &[],
        usual: Some(Spread::Relative(usual)),
        first_file: Spread::Relative(0.4),
        shown_by,
        determined_by,
        between_programs: Spread::Relative(0.01),
        without_current: None,
    }
}

/// Returns the row of a delay of an on/off valve: data sheets give typical values.
const fn delay(name: &'static str, determined_by: &'static str) -> Ordinary {
    Ordinary {
        between_programs: Spread::Absolute(0.2e-3),
        ..relative(name, 0.25, Shown::InPressure, determined_by)
    }
}

/// Returns the row of a ramp of an on/off valve: data sheets do not give it.
const fn ramp(name: &'static str, determined_by: &'static str) -> Ordinary {
    Ordinary {
        between_programs: Spread::Absolute(0.2e-3),
        ..relative(name, 0.4, Shown::InPressure, determined_by)
    }
}

/// Returns the row of a command or of an open share (%) on the characteristic of a proportional valve.
const fn percentage(name: &'static str, usual: f64, determined_by: &'static str) -> Ordinary {
    Ordinary {
        usual: Some(Spread::Absolute(usual)),
        first_file: Spread::Absolute(3.0 * usual),
        between_programs: Spread::Absolute(0.2),
        ..relative(name, 0.0, Shown::InPressure, determined_by)
    }
}

/// Returns the row of the critical ratio of a valve or a line.
const fn critical_ratio(name: &'static str, determined_by: &'static str) -> Ordinary {
    Ordinary {
        usual: Some(Spread::Absolute(0.1)),
        first_file: Spread::Absolute(0.2),
        ..relative(name, 0.0, Shown::InPressure, determined_by)
    }
}

/// Spread of the coil's parameters where no current is logged. A coil with resistance and inductances larger by a factor, and a force
/// constant larger by its square, moves the armature alike except for the drop of the freewheeling diode: pressures show only these
/// parameters together.
const COIL_WITHOUT_CURRENT: Option<Spread> = Some(Spread::Relative(0.05));
const FORCE_WITHOUT_CURRENT: Option<Spread> = Some(Spread::Relative(0.1));

/// Spread between two correct programs of a parameter that only a plant file frees, such as the ambient pressure.
const BETWEEN_PROGRAMS: Spread = Spread::Relative(1e-3);

/// Usual tolerances of parts: machined orifices 10 %, wound springs 5 to 8 %, copper coils 5 %, a machined volume 4 %, magnetic circuits 8
/// %; the delay of an output stage, and a pressure regulator with its gauge.
static ORDINARY: [Ordinary; 45] = [
    relative(
        "flow.discharge_fill",
        0.10,
        Shown::InPressure,
        "fill the chamber from ambient pressure with the fill valve fully open; fix the volume",
    ),
    relative(
        "flow.discharge_vent",
        0.10,
        Shown::InPressure,
        "vent the full chamber with the vent valve fully open; fix the volume",
    ),
    relative(
        "chamber.volume_m3",
        0.04,
        Shown::InPressure,
        "measure the volume, or the flow of one valve, and fix it; pressures alone show their ratio",
    ),
    Ordinary {
        between_programs: Spread::Relative(1e-3),
        usual: Some(Spread::Absolute(0.2)),
        first_file: Spread::Absolute(0.8),
        ..relative(
            "gas.supply_pressure_bar_gauge",
            0.0,
            Shown::WithoutLoggedSupply,
            "fill until the pressure no longer rises",
        )
    },
    // A gauge of 10 bar and class 0.5. Without its offset, each filling would end at a wrong pressure, which effects imitate.
    Ordinary {
        between_programs: Spread::Absolute(4.5e-3),
        usual: Some(Spread::Absolute(0.05)),
        first_file: Spread::Absolute(0.05),
        ..relative(
            "gas.supply_gauge_offset_bar",
            0.0,
            Shown::WithLoggedSupply,
            "fill until the pressure no longer rises",
        )
    },
    Ordinary {
        usual: Some(Spread::Absolute(2e-3)),
        first_file: Spread::Absolute(8e-3),
        ..relative(
            "ecu.command_delay_s",
            0.0,
            Shown::Always,
            "log the coil currents, faster than the ECU samples",
        )
    },
    Ordinary {
        between_programs: Spread::Relative(1e-3),
        without_current: COIL_WITHOUT_CURRENT,
        first_file: Spread::Relative(0.2),
        ..relative(
            "coil.resistance_20c_ohm",
            0.05,
            Shown::Always,
            "log the coil currents with one coil at 100 % for a second",
        )
    },
    Ordinary {
        between_programs: Spread::Relative(3e-3),
        without_current: COIL_WITHOUT_CURRENT,
        together_with: &["coil.inductance_open_h"],
        ..relative(
            "coil.inductance_closed_h",
            0.08,
            Shown::Always,
            "log the coil currents while the duty cycle changes, with the valve shut",
        )
    },
    Ordinary {
        between_programs: Spread::Relative(3e-3),
        without_current: COIL_WITHOUT_CURRENT,
        usual: None,
        ..relative(
            "coil.inductance_open_h",
            0.0,
            Shown::Always,
            "log the coil currents while the duty cycle changes, with the valve open",
        )
    },
    relative(
        "armature.preload_fill_n",
        0.05,
        Shown::Always,
        "fill with duty cycles around the one at which the valve begins to open, at several pressures",
    ),
    relative(
        "armature.preload_vent_n",
        0.05,
        Shown::Always,
        "vent with duty cycles around the one at which the valve begins to open, at several pressures",
    ),
    Ordinary {
        between_programs: Spread::Relative(0.025),
        ..relative(
            "armature.spring_n_per_m",
            0.08,
            Shown::Always,
            "log duty cycles at which a valve stays open only just",
        )
    },
    Ordinary {
        between_programs: Spread::Relative(0.025),
        usual: None,
        ..relative(
            "armature.mass_kg",
            0.0,
            Shown::Always,
            "log the coil currents at 20 kHz while the valve opens, or weigh the armature and fix the value",
        )
    },
    Ordinary {
        without_current: FORCE_WITHOUT_CURRENT,
        usual: None,
        ..relative(
            "magnet.force_constant_n_m2_per_a2",
            0.0,
            Shown::Always,
            "log the coil currents at 20 kHz while the valve opens, at several pressures",
        )
    },
    relative(
        "on_off_fill.conductance_dm3_per_s_bar",
        0.15,
        Shown::InPressure,
        "fill the chamber with the fill valve fully open; fix the volume",
    ),
    critical_ratio(
        "on_off_fill.critical_ratio",
        "fill the chamber with the fill valve fully open, down to equal pressures",
    ),
    delay(
        "on_off_fill.opening_delay_s",
        "command single pulses of several lengths, some too short to open the valve",
    ),
    delay(
        "on_off_fill.closing_delay_s",
        "command single pulses of several lengths",
    ),
    ramp(
        "on_off_fill.opening_ramp_s",
        "log the pressure faster than the valve opens",
    ),
    ramp(
        "on_off_fill.closing_ramp_s",
        "log the pressure faster than the valve closes",
    ),
    relative(
        "on_off_vent.conductance_dm3_per_s_bar",
        0.15,
        Shown::InPressure,
        "vent the full chamber with the vent valve fully open; fix the volume",
    ),
    critical_ratio(
        "on_off_vent.critical_ratio",
        "vent the full chamber with the vent valve fully open, down to equal pressures",
    ),
    delay(
        "on_off_vent.opening_delay_s",
        "command single pulses of several lengths, some too short to open the valve",
    ),
    delay(
        "on_off_vent.closing_delay_s",
        "command single pulses of several lengths",
    ),
    ramp(
        "on_off_vent.opening_ramp_s",
        "log the pressure faster than the valve opens",
    ),
    ramp(
        "on_off_vent.closing_ramp_s",
        "log the pressure faster than the valve closes",
    ),
    relative(
        "proportional_fill.conductance_dm3_per_s_bar",
        0.15,
        Shown::InPressure,
        "fill the chamber with the valve fully open; fix the volume",
    ),
    critical_ratio(
        "proportional_fill.critical_ratio",
        "fill the chamber with the valve fully open, down to equal pressures",
    ),
    relative(
        "proportional_fill.time_constant_s",
        0.25,
        Shown::InPressure,
        "log the pressure faster than the valve follows steps of the command",
    ),
    percentage(
        "proportional_fill.opens_at_pct",
        3.0,
        "command steps around the one at which the valve begins to open",
    ),
    percentage(
        "proportional_fill.above_line_25_pct",
        5.0,
        "command steps to a quarter of the way",
    ),
    percentage(
        "proportional_fill.above_line_50_pct",
        5.0,
        "command steps to half the way",
    ),
    percentage(
        "proportional_fill.above_line_75_pct",
        5.0,
        "command steps to three quarters of the way",
    ),
    relative(
        "proportional_vent.conductance_dm3_per_s_bar",
        0.15,
        Shown::InPressure,
        "vent the full chamber with the valve fully open; fix the volume",
    ),
    critical_ratio(
        "proportional_vent.critical_ratio",
        "vent the full chamber with the valve fully open, down to equal pressures",
    ),
    relative(
        "proportional_vent.time_constant_s",
        0.25,
        Shown::InPressure,
        "log the pressure faster than the valve follows steps of the command",
    ),
    percentage(
        "proportional_vent.opens_at_pct",
        3.0,
        "command steps around the one at which the valve begins to open",
    ),
    percentage(
        "proportional_vent.above_line_25_pct",
        5.0,
        "command steps to a quarter of the way",
    ),
    percentage(
        "proportional_vent.above_line_50_pct",
        5.0,
        "command steps to half the way",
    ),
    percentage(
        "proportional_vent.above_line_75_pct",
        5.0,
        "command steps to three quarters of the way",
    ),
    relative(
        "chamber.growth_m3_per_bar",
        0.25,
        Shown::InPressure,
        "command the same pulses at low and at high pressure; fix the volume",
    ),
    relative(
        "chamber.growth_pressure_bar",
        0.25,
        Shown::InPressure,
        "command the same pulses at low and at high pressure; fix the volume",
    ),
    relative(
        "second_chamber.volume_m3",
        0.15,
        Shown::InPressure,
        "measure the volume, and fix it",
    ),
    relative(
        "second_chamber.conductance_dm3_per_s_bar",
        0.25,
        Shown::InPressure,
        "command single long pulses, and log the pressure until it rests",
    ),
    critical_ratio(
        "second_chamber.critical_ratio",
        "command single long pulses, and log the pressure until it rests",
    ),
];

/// Returns the names of the ordinary parameters.
pub(crate) fn ordinary_names() -> impl Iterator<Item = &'static str> {
    ORDINARY.iter().map(|ordinary| ordinary.name)
}

/// Returns whether `name` is that of an ordinary parameter.
pub(crate) fn is_ordinary(name: &str) -> bool {
    ordinary_names().any(|ordinary| ordinary == name)
}

/// Returns the usual tolerance of the part around the value of an ordinary parameter, in its unit; none for other parameters, and where a
/// datasheet value counts as exact.
pub(crate) fn usual_spread(name: &str, value: f64) -> Option<f64> {
    let ordinary = ORDINARY.iter().find(|ordinary| ordinary.name == name)?;
    Some(ordinary.usual?.around(value))
}

/// Returns the ordinary parameter in proportion to which `name` moves, if the plant file states nothing about `name`.
pub(crate) fn leader_of(name: &str) -> Option<&'static str> {
    let leader = ORDINARY
        .iter()
        .find(|ordinary| ordinary.together_with.contains(&name))?;
    Some(leader.name)
}

/// Returns the possible error of the value of an ordinary parameter in a first plant file, in its unit; none for other parameters, and for a
/// part that is not there: a growth of 0.
pub(crate) fn first_file_spread(name: &str, value: f64) -> Option<f64> {
    let ordinary = ORDINARY.iter().find(|ordinary| ordinary.name == name)?;
    Some(ordinary.first_file.around(value)).filter(|half| *half > 0.0)
}

/// Free parameter of a fit, with its range.
#[derive(Debug, Clone)]
pub(crate) struct Nuisance {
    pub(crate) spec: &'static ParameterSpec,
    together_with: Vec<&'static ParameterSpec>,
    /// Excitation or measurement that determines it, for people.
    pub(crate) determined_by: &'static str,
    /// Standard deviation of the value between two correct programs of one plant, in the unit of the parameter.
    pub(crate) between_programs: f64,
    /// Half width of the usual tolerance of the part, in the unit of the parameter; none if it has none.
    pub(crate) usual: Option<f64>,
    /// Value of the plant file.
    pub(crate) datasheet: f64,
    /// Unit of its coordinate, in the unit of the parameter.
    pub(crate) tolerance: f64,
    /// Least and largest coordinate, (value - datasheet) / tolerance, of a fit.
    pub(crate) bounds: (f64, f64),
    /// Coordinates at which the error of the model jumps, ascending.
    pub(crate) jumps: Vec<f64>,
}

/// Returns the parameters of `plant` that a fit moves, as far as logs show them.
pub(crate) fn nuisances(plant: &PlantParameters, shows: Shows) -> Vec<Nuisance> {
    let ordinary = |name: &str| ORDINARY.iter().find(|ordinary| ordinary.name == name);
    let listed = ORDINARY
        .iter()
        .filter_map(|ordinary| ParameterSpec::by_name(ordinary.name));
    let asked = plant.knowledge.keys();
    let asked = asked.filter(|name| ordinary(name).is_none());
    let asked = asked.filter_map(|name| ParameterSpec::by_name(name));
    // A statement about an effect limits its size, which is fitted anyway.
    let asked = asked.filter(|spec| spec.effect_id().is_none());
    listed
        .chain(asked)
        .filter_map(|spec| {
            let name = spec.name();
            let ordinary = ordinary(&name);
            if ordinary.is_some_and(|one| !shows.show(one.shown_by)) {
                return None;
            }
            let there = plant.get(&name)?;
            let knowledge = plant.knowledge.get(&name).copied();
            let (tolerance, bounds) = match knowledge {
                Some(knowledge) => {
                    let (least, most) = knowledge.bounds(spec, there);
                    let half = 0.5 * (most - least);
                    (half, ((least - there) / half, (most - there) / half))
                }
                None => {
                    let tolerance = ordinary?.usual?.around(there);
                    let (least, most) = spec.range;
                    let coordinate = |value: f64| (value - there) / tolerance;
                    (
                        tolerance,
                        (coordinate(least).max(-1.0), coordinate(most).min(1.0)),
                    )
                }
            };
            let together_with = ordinary.map_or(&[][..], |ordinary| ordinary.together_with);
            let together_with = together_with
                .iter()
                .filter(|name| !plant.knowledge.contains_key(**name))
                .filter_map(|name| ParameterSpec::by_name(name));
            (tolerance > 0.0).then(|| Nuisance {
                spec,
                together_with: together_with.collect(),
                determined_by: ordinary.map_or(
                    "excite the part that it describes, or measure it and fix the value",
                    |ordinary| ordinary.determined_by,
                ),
                between_programs: ordinary
                    .map_or(BETWEEN_PROGRAMS, |one| {
                        let without = one.without_current.filter(|_| !shows.current);
                        without.unwrap_or(one.between_programs)
                    })
                    .around(there),
                jumps: Vec::new(),
                usual: ordinary
                    .and_then(|one| one.usual)
                    .map(|usual| usual.around(there)),
                datasheet: there,
                tolerance,
                bounds,
            })
        })
        .collect()
}

impl Nuisance {
    pub(crate) fn coordinate_of(&self, value: f64) -> f64 {
        (value - self.datasheet) / self.tolerance
    }

    /// Sets it to `value`, and with it the parameters that move in proportion.
    pub(crate) fn set(&self, plant: &mut PlantParameters, datasheet: &PlantParameters, value: f64) {
        self.spec.put(plant, value);
        for other in &self.together_with {
            if let Some(there) = other.value(datasheet) {
                other.put(plant, there * (value / self.datasheet));
            }
        }
    }

    /// Returns the names of the parameters that move in proportion to it.
    pub(crate) fn together_with(&self) -> impl Iterator<Item = String> {
        self.together_with.iter().map(|spec| spec.name())
    }
}
