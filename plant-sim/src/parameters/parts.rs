//! Parts that a plant may omit: a valve, its coil or its armature, the chamber with its gas.

use core::fmt;

use super::names::{CHAMBER, REGULATING_VALVE, SECOND_CHAMBER, VALVE_KEYS, VALVES};
use crate::description::{
    Effect, EffectSetting, EntryPoint, ParameterSpec, PlantParameters, Variant,
};
use crate::effects::by_id;
use crate::plant::{FILL, VENT};
use crate::valve::ValveFunction;

/// Part of a plant that a parameter describes, or an effect acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Valve that a duty cycle commands.
    Commanded,
    /// Commanded valve that air flows through, in one place.
    CommandedValve(usize),
    /// Coil of either valve.
    Coil,
    /// Valve that a supply voltage drives: one with a coil, or an on/off valve whose coil is not described.
    Driven,
    /// Movable armature of either valve.
    Armature,
    /// Armature of one valve.
    ArmatureOf(usize),
    /// Armature on which the pressure of a chamber acts.
    ArmatureUnderPressure,
    /// On/off valve in the place of either valve.
    Switching,
    /// On/off valve in the place of one valve.
    OnOffValve(usize),
    /// Proportional valve in the place of one valve.
    ProportionalValve(usize),
    /// Output stage that delays a command: that of a coil or of a proportional valve.
    DelayedOutput,
    /// Orifice of either valve that has a diameter.
    Orifice,
    /// Orifice of one valve that has a diameter.
    OrificeOf(usize),
    /// Path for air through either valve.
    Flow,
    /// Path for air through one valve.
    FlowThrough(usize),
    /// Chamber with its gas.
    Chamber,
    /// Second chamber behind a line.
    SecondChamber,
    /// Chamber without a second one.
    SingleChamber,
    /// Part that every plant has, or unknown part of a user-defined effect.
    Any,
}

impl Part {
    /// Returns whether `plant` has the part.
    pub fn is_in(self, plant: &PlantParameters) -> bool {
        let any = |has: fn(ValveFunction) -> bool| plant.functions.into_iter().any(has);
        let has_chamber = plant.chamber.volume_m3 > 0.0;
        let has_second = has_chamber && plant.second_chamber.volume_m3 > 0.0;
        let is = |function: ValveFunction, valve: usize| plant.functions[valve] == function;
        let has_diameter = |valve: usize| !plant.functions[valve].has_conductance();
        match self {
            Self::Commanded => any(ValveFunction::is_commanded),
            Self::CommandedValve(valve) => {
                let function = plant.functions[valve];
                function.is_commanded() && function.has_orifice()
            }
            Self::Switching => any(|function| function == ValveFunction::OnOff),
            Self::OnOffValve(valve) => is(ValveFunction::OnOff, valve),
            Self::ProportionalValve(valve) => is(ValveFunction::Proportional, valve),
            Self::DelayedOutput => {
                any(|function| function.has_coil() || function == ValveFunction::Proportional)
            }
            Self::Orifice => has_chamber && (has_diameter(FILL) || has_diameter(VENT)),
            Self::OrificeOf(valve) => {
                has_chamber && plant.functions[valve].has_orifice() && has_diameter(valve)
            }
            Self::Coil => any(ValveFunction::has_coil),
            Self::Driven => any(|function| function.has_coil() || function == ValveFunction::OnOff),
            Self::Armature => any(ValveFunction::has_armature),
            Self::ArmatureOf(valve) => plant.functions[valve].has_armature(),
            Self::ArmatureUnderPressure => has_chamber && any(ValveFunction::has_armature),
            Self::Flow => has_chamber && any(ValveFunction::has_orifice),
            Self::FlowThrough(valve) => has_chamber && plant.functions[valve].has_orifice(),
            Self::Chamber => has_chamber,
            Self::SecondChamber => has_second,
            Self::SingleChamber => has_chamber && !has_second,
            Self::Any => true,
        }
    }

    /// Returns the part on which an effect acts.
    pub fn of_effect(effect: &dyn Effect) -> Self {
        match effect.about().acts_on {
            EntryPoint::Coil | EntryPoint::ElectricSupply => Self::Coil,
            EntryPoint::Armature => Self::Armature,
            EntryPoint::Switching => Self::Switching,
            EntryPoint::AirSupply => Self::FlowThrough(FILL),
            EntryPoint::Drain => Self::FlowThrough(VENT),
            EntryPoint::Flow => Self::Flow,
            EntryPoint::Leak | EntryPoint::GasEnergy | EntryPoint::Volume | EntryPoint::Sensor => {
                Self::Chamber
            }
        }
    }

    /// Returns the part that a parameter describes.
    pub fn of_parameter(spec: &ParameterSpec) -> Self {
        if let Some(id) = spec.effect_id() {
            return by_id(id).map_or(Self::Any, Self::of_effect);
        }
        Self::of_key(spec.section, spec.key)
    }

    pub(super) fn of_key(section: &str, key: &str) -> Self {
        match (section, key) {
            ("coil", "inductance_open_h") => Self::Armature,
            ("ecu", "sample_time_s" | "pwm_frequency_hz") => Self::Commanded,
            ("ecu", "command_delay_s") => Self::DelayedOutput,
            ("ecu", "supply_voltage_v") => Self::Driven,
            ("ecu" | "coil", _) => Self::Coil,
            ("on_off_fill", _) => Self::OnOffValve(FILL),
            ("on_off_vent", _) => Self::OnOffValve(VENT),
            ("proportional_fill", _) => Self::ProportionalValve(FILL),
            ("proportional_vent", _) => Self::ProportionalValve(VENT),
            ("armature", "preload_fill_n") => Self::ArmatureOf(FILL),
            ("armature", "preload_vent_n") => Self::ArmatureOf(VENT),
            ("armature", "pressure_force_diameter_m") => Self::ArmatureUnderPressure,
            ("magnet" | "armature", _) => Self::Armature,
            ("flow", "orifice_fill_m" | "discharge_fill") => Self::OrificeOf(FILL),
            ("flow", "orifice_vent_m" | "discharge_vent") => Self::OrificeOf(VENT),
            ("flow" | "effects.critical_ratio", "critical_ratio" | "reduction") => Self::Orifice,
            ("gas", "supply_pressure_bar_gauge" | "supply_gauge_offset_bar") => {
                Self::FlowThrough(FILL)
            }
            (SECOND_CHAMBER, _) => Self::SecondChamber,
            ("effects.dead_volume", _) => Self::SingleChamber,
            ("flow" | "gas" | CHAMBER | REGULATING_VALVE, _) => Self::Chamber,
            ("effects.series_restriction", "fill_area_ratio") => Self::FlowThrough(FILL),
            ("effects.series_restriction", "vent_area_ratio") => Self::FlowThrough(VENT),
            _ => Self::Any,
        }
    }

    /// Returns the statement with which a plant file omits the part; `None` if that is impossible.
    pub(super) fn left_out_by(self) -> Option<String> {
        let words = |keys: &[&str], words: &str| {
            let keys: Vec<_> = keys
                .iter()
                .map(|key| format!("`{key} = {words}`"))
                .collect();
            format!("{} in [{VALVES}]", keys.join(" and "))
        };
        match self {
            Self::Coil | Self::Driven | Self::Commanded | Self::DelayedOutput => {
                Some(words(&VALVE_KEYS, "\"absent\""))
            }
            Self::Orifice => Some(words(&VALVE_KEYS, "\"on_off\"")),
            Self::Armature => Some(words(&VALVE_KEYS, "\"blocked\"")),
            Self::ArmatureOf(valve) => Some(words(&VALVE_KEYS[valve..=valve], "\"always_open\"")),
            Self::FlowThrough(valve) | Self::OrificeOf(valve) => {
                Some(words(&VALVE_KEYS[valve..=valve], "\"absent\""))
            }
            Self::Flow | Self::Chamber | Self::ArmatureUnderPressure => {
                Some(format!("no table [{CHAMBER}]"))
            }
            Self::SecondChamber | Self::SingleChamber => {
                Some(format!("no table [{SECOND_CHAMBER}]"))
            }
            Self::CommandedValve(_)
            | Self::Switching
            | Self::OnOffValve(_)
            | Self::ProportionalValve(_)
            | Self::Any => None,
        }
    }
}

impl PlantParameters {
    /// Returns the forms of `effect`, at typical sizes, in which every parameter describes a part of this plant; empty
    /// if the effect has nothing to act on.
    pub fn forms_of(&self, effect: &'static dyn Effect) -> Vec<EffectSetting> {
        let is_whole = |form: &&Variant| {
            let mut specs = form.parameters.iter();
            specs.all(|spec| Part::of_key(spec.section, spec.key).is_in(self))
        };
        let forms = effect.about().variants.iter().filter(is_whole);
        let typical = forms.map(|form| EffectSetting::typical_variant(effect, form));
        let acts = Part::of_effect(effect).is_in(self);
        typical.filter(|_| acts).collect()
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Commanded => f.write_str("valve that is commanded"),
            Self::CommandedValve(valve) => {
                write!(f, "{} valve that is commanded", VALVE_KEYS[*valve])
            }
            Self::Coil => f.write_str("coil"),
            Self::Driven => f.write_str("valve that a voltage drives"),
            Self::Armature => f.write_str("armature that moves"),
            Self::ArmatureOf(valve) => {
                write!(f, "armature of the {} valve", VALVE_KEYS[*valve])
            }
            Self::ArmatureUnderPressure => f.write_str("armature under a chamber's pressure"),
            Self::Switching => f.write_str("on/off valve"),
            Self::OnOffValve(valve) => write!(f, "on/off {} valve", VALVE_KEYS[*valve]),
            Self::ProportionalValve(valve) => {
                write!(f, "proportional {} valve", VALVE_KEYS[*valve])
            }
            Self::DelayedOutput => f.write_str("coil or proportional valve"),
            Self::Orifice => f.write_str("orifice with a diameter"),
            Self::Flow => f.write_str("valve or orifice that air flows through"),
            Self::FlowThrough(valve) | Self::OrificeOf(valve) => {
                write!(f, "{} valve that air flows through", VALVE_KEYS[*valve])
            }
            Self::Chamber => f.write_str("chamber"),
            Self::SecondChamber => f.write_str("second chamber"),
            Self::SingleChamber => f.write_str("chamber without a second one"),
            Self::Any => f.write_str("such part"),
        }
    }
}
