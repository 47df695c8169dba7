use std::sync::Arc;

use crate::{ConversionError, Quantity, TimeBaseId, Unit};

/// Samples of one quantity over one time base of its [`Recording`](crate::Recording), in the unit in which they were
/// logged. A missing sample stays missing: nothing is filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    pub(crate) name: String,
    pub(crate) unit: Unit,
    pub(crate) time_base: TimeBaseId,
    /// Finite, or NaN where missing.
    pub(crate) samples: Arc<Vec<f64>>,
}

impl Signal {
    /// Base name without the unit, such as `p_ch`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The unit of the samples.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// What the signal tells about the world.
    pub fn quantity(&self) -> Quantity {
        quantity_of(&self.name, self.unit)
    }

    /// The time base of the samples.
    pub fn time_base(&self) -> TimeBaseId {
        self.time_base
    }

    /// Number of samples, missing ones included; that of the time base.
    #[expect(
        clippy::len_without_is_empty,
        reason = "as the time base, a signal is never empty"
    )]
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Sample `index` in the logged unit; none if it is missing or there is no such sample.
    pub fn get(&self, index: usize) -> Option<f64> {
        self.samples
            .get(index)
            .copied()
            .filter(|sample| !sample.is_nan())
    }

    /// The samples in the logged unit, none where missing.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        self.samples
            .iter()
            .map(|&sample| Some(sample).filter(|sample| !sample.is_nan()))
    }

    /// The samples in the logged unit, NaN where missing.
    pub fn values_or_nan(&self) -> &[f64] {
        &self.samples
    }

    /// Returns the samples in the logged unit, NaN where missing, for whoever keeps them: they are not copied.
    pub fn shared_values(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.samples)
    }

    /// Number of missing samples.
    pub fn missing_count(&self) -> usize {
        self.samples.iter().filter(|sample| sample.is_nan()).count()
    }

    /// The samples in `unit`, NaN where missing. See [`Unit::converter`].
    ///
    /// # Errors
    /// Another quantity, or gauge against absolute: then see [`Signal::values_at_ambient`].
    pub fn values_in(&self, unit: Unit) -> Result<Vec<f64>, ConversionError> {
        let converter = self.unit.converter(unit)?;
        Ok(self
            .samples
            .iter()
            .map(|&sample| converter.apply(sample))
            .collect())
    }

    /// The samples in `unit`, NaN where missing, gauge and absolute related by `ambient_pressure_pa` in Pa absolute.
    ///
    /// # Errors
    /// Those of [`Unit::converter_at_ambient`].
    pub fn values_at_ambient(
        &self,
        unit: Unit,
        ambient_pressure_pa: f64,
    ) -> Result<Vec<f64>, ConversionError> {
        let converter = self.unit.converter_at_ambient(unit, ambient_pressure_pa)?;
        Ok(self
            .samples
            .iter()
            .map(|&sample| converter.apply(sample))
            .collect())
    }
}

/// A ratio is a duty cycle by its name, `duty_fill`; every other quantity follows from the unit.
pub(crate) fn quantity_of(name: &str, unit: Unit) -> Quantity {
    match unit.quantity() {
        Quantity::Ratio if name == "duty" || name.starts_with("duty_") => Quantity::DutyCycle,
        quantity => quantity,
    }
}
