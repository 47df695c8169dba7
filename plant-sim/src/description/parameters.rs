//! Parameters and effects of a plant. They are in one file because they depend on each other: a plant has effects, and
//! an effect reads the plant that has it.

use core::fmt::Debug;
use std::collections::BTreeMap;

use super::about::{About, Variant};
use super::knowledge::Knowledge;
use super::sections::PA_PER_BAR;
use super::sections::{
    ArmatureParameters, ChamberParameters, CoilParameters, EcuParameters, FlowParameters,
    GasParameters, MagnetParameters, OnOffValveParameters, ProportionalValveParameters,
    RegulatingValveParameters, SecondChamberParameters,
};
use super::spec::ParameterSpec;
use crate::plant::{FILL, Plant};
use crate::valve::ValveFunction;

/// Content of a plant file.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantParameters {
    /// `[ecu]`
    pub ecu: EcuParameters,
    /// `[coil]`, of both valves.
    pub coil: CoilParameters,
    /// `[magnet]`, of both valves.
    pub magnet: MagnetParameters,
    /// `[armature]`, of both valves except for the preloads.
    pub armature: ArmatureParameters,
    /// `[flow]`
    pub flow: FlowParameters,
    /// `[on_off_fill]`: fill valve, if it is an on/off valve.
    pub on_off_fill: OnOffValveParameters,
    /// `[on_off_vent]`: vent valve, if it is an on/off valve.
    pub on_off_vent: OnOffValveParameters,
    /// `[proportional_fill]`: fill valve, if it is a proportional valve.
    pub proportional_fill: ProportionalValveParameters,
    /// `[proportional_vent]`: vent valve, if it is a proportional valve.
    pub proportional_vent: ProportionalValveParameters,
    /// `[gas]`
    pub gas: GasParameters,
    /// `[chamber]`; a volume of 0 means no chamber.
    pub chamber: ChamberParameters,
    /// `[second_chamber]`, with the pressure sensor; a volume of 0 means that there is none.
    pub second_chamber: SecondChamberParameters,
    /// `[valves]`: function of the valve between supply and chamber (fill), and of the valve between chamber and drain
    /// (vent).
    pub functions: [ValveFunction; 2],
    /// `[regulating_valve]`: an output stage, if the file has one.
    pub regulating_valve: Option<RegulatingValveParameters>,
    /// `[effects.*]`: effects in addition to the thesis' model, each at most once.
    pub effects: Vec<EffectSetting>,
    /// User-defined effects that the plant may have, in addition to those of the library.
    pub own: OwnEffects,
    /// Source of each value, by `section.key`; the comment behind the value in the file.
    pub provenance: BTreeMap<String, String>,
    /// Knowledge of values, by `section.key`; a value without a statement has the usual tolerance of its part.
    pub knowledge: BTreeMap<String, Knowledge>,
}

/// Physical effect.
pub trait Effect: Debug + Sync {
    /// Returns the description of the effect, for people and for a diagnosis.
    fn about(&self) -> &'static About;

    /// Returns the table of a plant file that defines the effect; `None` for an effect in Rust.
    fn definition_toml(&self) -> Option<&str> {
        None
    }

    /// Adds the effect to a plant that was prepared from `parameters`. The method is called once per simulation, and
    /// not at all if `setting` is off.
    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant);
}

/// User-defined effects, by their ids; each at most once.
#[derive(Debug, Clone, Default)]
pub struct OwnEffects(Vec<&'static dyn Effect>);

impl OwnEffects {
    /// Adds an effect, which replaces the one of the same id.
    pub fn add(&mut self, effect: &'static dyn Effect) {
        let id = effect.about().id;
        self.0.retain(|one| one.about().id != id);
        self.0.push(effect);
    }

    /// Returns the effects, in the order of adding.
    pub fn iter(&self) -> impl Iterator<Item = &'static dyn Effect> + Clone + '_ {
        self.0.iter().copied()
    }

    /// Returns the effect with this id.
    pub fn by_id(&self, id: &str) -> Option<&'static dyn Effect> {
        self.iter().find(|effect| effect.about().id == id)
    }
}

impl PartialEq for OwnEffects {
    fn eq(&self, other: &Self) -> bool {
        let same = |(one, other): (&'static dyn Effect, &'static dyn Effect)| {
            core::ptr::eq(one.about(), other.about())
        };
        self.0.len() == other.0.len() && self.iter().zip(other.iter()).all(same)
    }
}

/// Setting of an effect: one `[effects.*]` table of a plant.
#[derive(Debug, Clone)]
pub struct EffectSetting {
    effect: &'static dyn Effect,
    variant: &'static Variant,
    values: Vec<f64>,
}

impl EffectSetting {
    /// Creates `effect` in its first variant, at its typical size.
    pub fn typical(effect: &'static dyn Effect) -> Self {
        Self::typical_variant(effect, &effect.about().variants[0])
    }

    /// Creates `effect` in one of its variants, at its typical size.
    pub fn typical_variant(effect: &'static dyn Effect, variant: &'static Variant) -> Self {
        let typical = |spec: &&ParameterSpec| spec.size.map_or(spec.range.0, |size| size.typical);
        Self {
            effect,
            variant,
            values: variant.parameters.iter().map(typical).collect(),
        }
    }

    /// Returns the effect.
    pub fn effect(&self) -> &'static dyn Effect {
        self.effect
    }

    /// Returns the id of the effect.
    pub fn id(&self) -> &'static str {
        self.effect.about().id
    }

    /// Returns the form of its law.
    pub fn variant(&self) -> &'static Variant {
        self.variant
    }

    /// Returns the parameters of the variant.
    pub fn parameters(&self) -> &'static [&'static ParameterSpec] {
        self.variant.parameters
    }

    /// Returns the signal of a log without which a parameter has no effect.
    pub fn driven_by(&self) -> Option<&'static str> {
        let mut sizes = self.parameters().iter().filter_map(|spec| spec.size);
        sizes.find_map(|size| size.driven_by)
    }

    /// Returns the values, in the order of [`Self::parameters`].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the values for changes; [`PlantParameters::check`] checks whether they are allowed.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Returns the value of a parameter; `None` if the variant has no such parameter.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.position(key).map(|index| self.values[index])
    }

    /// Returns the value of a parameter that the variant has.
    ///
    /// # Panics
    /// Panics if the variant has no such parameter, which is a mistake in the effect's own file.
    pub fn value(&self, key: &str) -> f64 {
        self.get(key).unwrap_or_else(|| {
            panic!(
                "{} as {} has no parameter {key}",
                self.id(),
                self.variant.name
            )
        })
    }

    /// Returns the setting with another value.
    ///
    /// # Panics
    /// Panics if the variant has no parameter `key`.
    #[must_use]
    pub fn with(mut self, key: &str, value: f64) -> Self {
        let index = self
            .position(key)
            .unwrap_or_else(|| panic!("{} has no parameter {key}", self.id()));
        self.values[index] = value;
        self
    }

    /// Returns whether every strength is at its off value, so that the plant is the plain one.
    pub fn is_off(&self) -> bool {
        let mut strengths = self
            .parameters()
            .iter()
            .zip(&self.values)
            .filter_map(|(spec, value)| Some((spec.size?.off?, *value)))
            .peekable();
        strengths.peek().is_some() && strengths.all(|(off, value)| off == value)
    }

    pub(crate) fn slot(&mut self, key: &str) -> Option<&mut f64> {
        let index = self.position(key)?;
        self.values.get_mut(index)
    }

    fn position(&self, key: &str) -> Option<usize> {
        self.parameters().iter().position(|spec| spec.key == key)
    }
}

impl PartialEq for EffectSetting {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id()
            && self.variant.name == other.variant.name
            && self.values == other.values
    }
}

/// Pressure (bar gauge) to which sizes refer in a plant without supply: the rated pressure of pneumatic components.
pub(crate) const REFERENCE_BAR_GAUGE: f64 = 6.3;
/// Supply voltage (V) of valves without a coil whose plant file states none: that of a truck.
pub(crate) const REFERENCE_V: f64 = 24.0;
/// Smallest gauge pressure (Pa) to which a size refers, because a supply that is shut off has none.
const LEAST_REFERENCE: f64 = PA_PER_BAR;

impl PlantParameters {
    /// Returns the pressure (Pa abs) to which the size of a leak and the conductance of natural convection refer: the
    /// supply pressure, at least 1 bar gauge. Without a fill valve to a supply it is 6.3 bar gauge, for any
    /// `gas.supply_pressure_bar_gauge`.
    pub fn reference_pressure_pa(&self) -> f64 {
        let gas = &self.gas;
        match self.functions[FILL].has_orifice() {
            true => gas
                .supply_pressure_pa()
                .max(gas.ambient_pressure_pa + LEAST_REFERENCE),
            false => gas.ambient_pressure_pa + REFERENCE_BAR_GAUGE * PA_PER_BAR,
        }
    }

    /// Returns the setting of the effect `id`; `None` if the plant does not have it.
    pub fn effect(&self, id: &str) -> Option<&EffectSetting> {
        self.effects.iter().find(|setting| setting.id() == id)
    }

    /// Returns the plant with an effect, which replaces the one of the same id.
    #[must_use]
    pub fn with_effect(&self, setting: EffectSetting) -> Self {
        let mut plant = self.without_effect(setting.id());
        plant.effects.push(setting);
        plant
    }

    /// Returns the plant without the effect `id`.
    #[must_use]
    pub fn without_effect(&self, id: &str) -> Self {
        let mut plant = self.clone();
        plant.effects.retain(|setting| setting.id() != id);
        let prefix = format!("effects.{id}.");
        plant
            .provenance
            .retain(|name, _| !name.starts_with(&prefix));
        plant.knowledge.retain(|name, _| !name.starts_with(&prefix));
        plant
    }

    /// Returns parameters to be filled from a file. The preset values are those of a plant without the part: air at the
    /// standard atmosphere, the voltage of a truck, and for the leaks of a chamber without supply the rated pressure of
    /// pneumatic components.
    pub(crate) fn blank() -> Self {
        Self {
            ecu: EcuParameters {
                supply_voltage_v: REFERENCE_V,
                ..EcuParameters::default()
            },
            coil: CoilParameters::default(),
            magnet: MagnetParameters::default(),
            armature: ArmatureParameters::default(),
            flow: FlowParameters {
                critical_ratio: 0.528,
                ..FlowParameters::default()
            },
            on_off_fill: OnOffValveParameters::default(),
            on_off_vent: OnOffValveParameters::default(),
            proportional_fill: ProportionalValveParameters::default(),
            proportional_vent: ProportionalValveParameters::default(),
            gas: GasParameters {
                gas_constant_j_per_kg_k: 287.05,
                heat_capacity_ratio: 1.4,
                temperature_k: 293.15,
                supply_pressure_bar_gauge: REFERENCE_BAR_GAUGE,
                ambient_pressure_pa: 101_325.0,
                thermometer_wall_share: 0.0,
                supply_gauge_offset_bar: 0.0,
            },
            chamber: ChamberParameters::default(),
            second_chamber: SecondChamberParameters::default(),
            functions: [ValveFunction::NormallyClosed; 2],
            regulating_valve: None,
            effects: Vec::new(),
            own: OwnEffects::default(),
            provenance: BTreeMap::new(),
            knowledge: BTreeMap::new(),
        }
    }
}
