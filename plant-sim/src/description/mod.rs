//! Description of a plant: its parameters with their meaning, and its effects. Each effect depends on this module; the
//! library of all effects depends on the effects.

mod about;
mod knowledge;
mod parameters;
mod sections;
mod spec;

pub use about::{About, EntryPoint, Variant};
pub use knowledge::Knowledge;
pub(crate) use knowledge::middle;
pub(crate) use parameters::REFERENCE_V;
pub use parameters::{Effect, EffectSetting, OwnEffects, PlantParameters};
pub use sections::{
    ArmatureParameters, ChamberParameters, CoilParameters, EcuParameters, FlowParameters,
    GasParameters, LagOf, MagnetParameters, OnOffValveParameters, PA_PER_BAR,
    ProportionalValveParameters, RegulatingValveParameters, SecondChamberParameters, SensorPlace,
};
pub(crate) use spec::{EFFECTS, effect_parameters};
pub use spec::{ParameterSpec, Scale, Size};
