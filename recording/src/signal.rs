use std::sync::Arc;

use crate::{ConversionError, Quantity, TimeBaseId, Unit};

/// Samples of one quantity over one time base of its [`Recording`](crate::Recording), in the unit in which they were
/// logged. A missing sample stays missing: nothing is filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    pub(crate) name: String,
    pub(crate) unit: Unit,
    pub(crate) time_base: TimeBaseId,
    /// Samples: finite, or NaN where missing.
    pub(crate) samples: Arc<Vec<f64>>,
}

impl Signal {
    /// Returns the base name without the unit, such as `p_ch`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the unit of the samples.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the physical quantity of the signal.
    pub fn quantity(&self) -> Quantity {
        quantity_of(&self.name, self.unit)
    }

    /// Returns the time base of the samples.
    pub fn time_base(&self) -> TimeBaseId {
        self.time_base
    }

    /// Returns the number of samples, including missing ones; it equals that of the time base.
    #[expect(
        clippy::len_without_is_empty,
        reason = "as the time base, a signal is never empty"
    )]
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Returns sample `index` in the logged unit; `None` if it is missing or does not exist.
    pub fn get(&self, index: usize) -> Option<f64> {
        self.samples
            .get(index)
            .copied()
            .filter(|sample| !sample.is_nan())
    }

    /// Iterates over the samples in the logged unit, `None` where missing.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        self.samples
            .iter()
            .map(|&sample| Some(sample).filter(|sample| !sample.is_nan()))
    }

    /// Returns the samples in the logged unit, NaN where missing.
    pub fn values_or_nan(&self) -> &[f64] {
        &self.samples
    }

    /// Returns the samples in the logged unit, NaN where missing, as a shared owner: they are not copied.
    pub fn shared_values(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.samples)
    }

    /// Returns the number of missing samples.
    pub fn missing_count(&self) -> usize {
        self.samples.iter().filter(|sample| sample.is_nan()).count()
    }

    /// Returns the samples in `unit`, NaN where missing. See [`Unit::converter`].
    ///
    /// # Errors
    /// Returns an error for another quantity, or for gauge against absolute; for that see
    /// [`Signal::values_at_ambient`].
    pub fn values_in(&self, unit: Unit) -> Result<Vec<f64>, ConversionError> {
        let converter = self.unit.converter(unit)?;
        Ok(self
            .samples
            .iter()
            .map(|&sample| converter.apply(sample))
            .collect())
    }

    /// Returns the samples in `unit`, NaN where missing, with `ambient_pressure_pa` (Pa absolute) between gauge and
    /// absolute.
    ///
    /// # Errors
    /// Returns the errors of [`Unit::converter_at_ambient`].
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

/// Returns the quantity of a signal: a ratio with a name like `duty_fill` is a duty cycle; all others follow from the
/// unit.
pub(crate) fn quantity_of(name: &str, unit: Unit) -> Quantity {
    match unit.quantity() {
        Quantity::Ratio if name == "duty" || name.starts_with("duty_") => Quantity::DutyCycle,
        quantity => quantity,
    }
}
