//! Surroundings measured with a log, which replace those of the plant file for this log.

use std::borrow::Cow;

use recording::{PressureReference, Quantity, Recording, Signal, Unit};

use super::error::ReplayError;
use crate::effects::{EffectSetting, by_id};
use crate::parameters::{ParameterSpec, Part, PlantParameters};

/// Name of the ambient pressure of a log, absolute; its mean is used.
pub const AMBIENT_PRESSURE: &str = "p_amb";
/// Name of the temperature of gas supply, chamber wall and surroundings; its mean is used.
pub const AMBIENT_TEMPERATURE: &str = "t_amb";
/// Name of the temperature of both coils at the beginning of the log; its first value is used.
pub const COIL_TEMPERATURE: &str = "t_coil";

/// Temperature (K) to which the resistance of a coil refers.
const COIL_REFERENCE_K: f64 = 293.15;

/// Surroundings of one log, as far as it contains them: as columns, or as constants of its mapping.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Surroundings {
    /// Ambient pressure (Pa abs).
    pub ambient_pressure_pa: Option<f64>,
    /// Temperature of the wall and of the supplied gas (K).
    pub temperature_k: Option<f64>,
    /// Temperature of the coils above 20 °C at the beginning of the log (K).
    pub coil_difference_k: Option<f64>,
}

impl Surroundings {
    /// Reads the surroundings that `log` contains and `plant` has parts for.
    ///
    /// # Errors
    /// Returns [`ReplayError::MissingSignal`] for a signal of another quantity, [`ReplayError::GaugeAmbient`] for an
    /// ambient pressure that is not absolute, and [`ReplayError::Surroundings`] for a value that no plant file may
    /// have, or for a coil temperature without the temperature coefficient of the resistance.
    pub fn of(plant: &PlantParameters, log: &Recording) -> Result<Self, ReplayError> {
        let has_chamber = Part::Chamber.is_in(plant);
        let ambient = value(log, (AMBIENT_PRESSURE, Quantity::Pressure), |signal| {
            if signal.unit().pressure_reference() == Some(PressureReference::Gauge) {
                let source_name = log.provenance().source.clone();
                return Err(ReplayError::GaugeAmbient { source_name });
            }
            mean(signal, Unit::PascalAbsolute)
        })?;
        let temperature = value(
            log,
            (AMBIENT_TEMPERATURE, Quantity::Temperature),
            |signal| mean(signal, Unit::Kelvin),
        )?;
        let coil = value(log, (COIL_TEMPERATURE, Quantity::Temperature), |signal| {
            let values = signal.values_in(Unit::Kelvin)?;
            Ok(values.into_iter().find(|value| value.is_finite()))
        })?;
        let coil = coil.filter(|_| Part::Coil.is_in(plant));
        let found = Self {
            ambient_pressure_pa: ambient.filter(|_| has_chamber),
            temperature_k: temperature.filter(|_| has_chamber),
            coil_difference_k: coil.map(|kelvin| kelvin - COIL_REFERENCE_K),
        };
        for (name, key, value) in [
            (
                AMBIENT_PRESSURE,
                "gas.ambient_pressure_pa",
                found.ambient_pressure_pa,
            ),
            (
                AMBIENT_TEMPERATURE,
                "gas.temperature_k",
                found.temperature_k,
            ),
            (
                COIL_TEMPERATURE,
                "effects.coil_ambient_temperature.difference_k",
                found.coil_difference_k,
            ),
        ] {
            check(log, name, key, value)?;
        }
        let coefficient = plant.coil.resistance_temperature_coefficient_per_k;
        if found.coil_difference_k.is_some() && coefficient == 0.0 {
            return Err(ReplayError::Surroundings {
                source_name: log.provenance().source.clone(),
                name: COIL_TEMPERATURE,
                problem: "needs coil.resistance_temperature_coefficient_per_k in the plant file, 0.0039 for copper".to_owned(),
            });
        }
        Ok(found)
    }

    /// Returns `plant` in these surroundings; borrowed if the log has none.
    pub fn around<'a>(&self, plant: &'a PlantParameters) -> Cow<'a, PlantParameters> {
        if *self == Self::default() {
            return Cow::Borrowed(plant);
        }
        let mut plant = plant.clone();
        if let Some(pressure) = self.ambient_pressure_pa {
            plant.gas.ambient_pressure_pa = pressure;
        }
        if let Some(kelvin) = self.temperature_k {
            plant.gas.temperature_k = kelvin;
        }
        if let Some(kelvin) = self.coil_difference_k
            && let Some(effect) = by_id("coil_ambient_temperature")
        {
            let there = plant.effect(effect.about().id).cloned();
            let setting = there.unwrap_or_else(|| EffectSetting::typical(effect));
            plant = plant.with_effect(setting.with("difference_k", kelvin));
        }
        Cow::Owned(plant)
    }
}

/// Returns the result of `read` for the signal, if the log has it.
fn value(
    log: &Recording,
    (name, quantity): (&'static str, Quantity),
    read: impl FnOnce(&Signal) -> Result<Option<f64>, ReplayError>,
) -> Result<Option<f64>, ReplayError> {
    if !log.mentions(name) {
        return Ok(None);
    }
    read(log.require(name, quantity)?)
}

fn mean(signal: &Signal, unit: Unit) -> Result<Option<f64>, ReplayError> {
    let values = signal.values_in(unit)?;
    let present = || values.iter().filter(|value| value.is_finite());
    let count = present().count();
    Ok((count > 0).then(|| present().sum::<f64>() / count as f64))
}

/// Checks that a value of a log is allowed in a plant file.
fn check(
    log: &Recording,
    name: &'static str,
    key: &str,
    value: Option<f64>,
) -> Result<(), ReplayError> {
    let (Some(value), Some(spec)) = (value, ParameterSpec::by_name(key)) else {
        return Ok(());
    };
    let (least, most) = spec.range;
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(ReplayError::Surroundings {
        source_name: log.provenance().source.clone(),
        name,
        problem: format!(
            "makes {key} = {value} {} (allowed {least} to {most}); correct the column, its unit or the constant of the mapping",
            spec.unit
        ),
    })
}
