//! A plant's parameters and its effects. One file, for they are one thing: a plant has effects, and an effect reads the
//! plant that has it.

use core::fmt::Debug;
use std::collections::BTreeMap;

use super::about::{About, Variant};
use super::knowledge::Knowledge;
use super::sections::PA_PER_BAR;
use super::sections::{
    ArmatureParameters, ChamberParameters, CoilParameters, EcuParameters, FlowParameters,
    GasParameters, MagnetParameters, RegulatingValveParameters,
};
use super::spec::ParameterSpec;
use crate::plant::{FILL, Plant};
use crate::valve::ValveFunction;

/// Everything a plant file says.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantParameters {
    /// `[ecu]`
    pub ecu: EcuParameters,
    /// `[coil]`, of both valves.
    pub coil: CoilParameters,
    /// `[magnet]`, of both valves.
    pub magnet: MagnetParameters,
    /// `[armature]`, of both valves but for the preloads.
    pub armature: ArmatureParameters,
    /// `[flow]`
    pub flow: FlowParameters,
    /// `[gas]`
    pub gas: GasParameters,
    /// `[chamber]`; a volume of 0 is none.
    pub chamber: ChamberParameters,
    /// `[valves]`: what sits between supply and chamber (fill), and between chamber and drain (vent).
    pub functions: [ValveFunction; 2],
    /// `[regulating_valve]`: an output stage, where the file has one.
    pub regulating_valve: Option<RegulatingValveParameters>,
    /// `[effects.*]`: what this plant has beyond the thesis' model, each effect at most once.
    pub effects: Vec<EffectSetting>,
    /// Where each value comes from, by `section.key`; the comment behind the value in the file.
    pub provenance: BTreeMap<String, String>,
    /// How well values are known, by `section.key`; a value without a statement has the usual tolerance of its part.
    pub knowledge: BTreeMap<String, Knowledge>,
}

/// A physical effect.
pub trait Effect: Debug + Sync {
    /// What it is, for people and for a diagnosis.
    fn about(&self) -> &'static About;

    /// Puts the effect into a plant that was prepared from `parameters`. Called once per simulation, and not at all
    /// where `setting` is off.
    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant);
}

/// One `[effects.*]` table of a plant.
#[derive(Debug, Clone)]
pub struct EffectSetting {
    effect: &'static dyn Effect,
    variant: &'static Variant,
    values: Vec<f64>,
}

impl EffectSetting {
    /// `effect` in its first variant, at its typical size.
    pub fn typical(effect: &'static dyn Effect) -> Self {
        Self::typical_variant(effect, &effect.about().variants[0])
    }

    /// `effect` in one of its variants, at its typical size.
    pub fn typical_variant(effect: &'static dyn Effect, variant: &'static Variant) -> Self {
        let typical = |spec: &&ParameterSpec| spec.size.map_or(spec.range.0, |size| size.typical);
        Self {
            effect,
            variant,
            values: variant.parameters.iter().map(typical).collect(),
        }
    }

    /// The effect.
    pub fn effect(&self) -> &'static dyn Effect {
        self.effect
    }

    /// Its id.
    pub fn id(&self) -> &'static str {
        self.effect.about().id
    }

    /// The form of its law.
    pub fn variant(&self) -> &'static Variant {
        self.variant
    }

    /// The parameters of the variant.
    pub fn parameters(&self) -> &'static [&'static ParameterSpec] {
        self.variant.parameters
    }

    /// The values, in the order of [`Self::parameters`].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values, to change them; [`PlantParameters::check`] tells whether they are
    /// allowed.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The value of a parameter; none where the variant has no such parameter.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.position(key).map(|index| self.values[index])
    }

    /// The value of a parameter that the variant has.
    ///
    /// # Panics
    /// If it has none of this name: a mistake in the effect's own file.
    pub fn value(&self, key: &str) -> f64 {
        self.get(key).unwrap_or_else(|| {
            panic!(
                "{} as {} has no parameter {key}",
                self.id(),
                self.variant.name
            )
        })
    }

    /// The same setting with another value.
    ///
    /// # Panics
    /// If the variant has no parameter `key`.
    #[must_use]
    pub fn with(mut self, key: &str, value: f64) -> Self {
        let index = self
            .position(key)
            .unwrap_or_else(|| panic!("{} has no parameter {key}", self.id()));
        self.values[index] = value;
        self
    }

    /// Whether the plant is the plain one: every strength is at its off value.
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

/// Pressure (bar gauge) at which sizes refer where a plant has no supply: the one at which pneumatic components are rated.
pub(crate) const REFERENCE_BAR_GAUGE: f64 = 6.3;
/// Least gauge pressure (Pa) at which a size refers: a supply that is shut off has none.
const LEAST_REFERENCE: f64 = PA_PER_BAR;

impl PlantParameters {
    /// Pressure (Pa abs) at which the size of a leak and the conductance of natural convection refer: the supply pressure, at least
    /// 1 bar gauge; where no fill valve leads to a supply, 6.3 bar gauge, whatever `gas.supply_pressure_bar_gauge` is.
    pub fn reference_pressure_pa(&self) -> f64 {
        let gas = &self.gas;
        match self.functions[FILL].has_orifice() {
            true => gas
                .supply_pressure_pa()
                .max(gas.ambient_pressure_pa + LEAST_REFERENCE),
            false => gas.ambient_pressure_pa + REFERENCE_BAR_GAUGE * PA_PER_BAR,
        }
    }

    /// The effect `id` as this plant has it; none where it has not.
    pub fn effect(&self, id: &str) -> Option<&EffectSetting> {
        self.effects.iter().find(|setting| setting.id() == id)
    }

    /// The same plant with an effect, which replaces the one of the same id.
    #[must_use]
    pub fn with_effect(&self, setting: EffectSetting) -> Self {
        let mut plant = self.without_effect(setting.id());
        plant.effects.push(setting);
        plant
    }

    /// The same plant without the effect `id`.
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

    /// To be filled from a file. What stays is what a plant without the part has around it: air at the standard
    /// atmosphere, and for the leaks of a chamber without supply the pressure at which pneumatic components are rated.
    pub(crate) fn blank() -> Self {
        Self {
            ecu: EcuParameters::default(),
            coil: CoilParameters::default(),
            magnet: MagnetParameters::default(),
            armature: ArmatureParameters::default(),
            flow: FlowParameters {
                critical_ratio: 0.528,
                ..FlowParameters::default()
            },
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
            functions: [ValveFunction::NormallyClosed; 2],
            regulating_valve: None,
            effects: Vec::new(),
            provenance: BTreeMap::new(),
            knowledge: BTreeMap::new(),
        }
    }
}
