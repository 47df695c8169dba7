//! Display unit of a signal: the model's unit if the model has the signal, so that both share an axis.

use std::borrow::Cow;

use plant_sim::PlantParameters;
use plant_sim::replay::ROW_SIGNALS;
use recording::{Converter, Signal, Unit};

/// Returns the display unit of a signal, and the conversion from the unit of the log.
pub(crate) fn shown_unit(
    signal: &Signal,
    parameters: &PlantParameters,
) -> (Unit, Option<Converter>) {
    let ambient = parameters.gas.ambient_pressure_pa;
    modelled_unit(signal)
        .and_then(|unit| {
            let converter = signal.unit().converter_at_ambient(unit, ambient).ok()?;
            Some((unit, Some(converter)))
        })
        .unwrap_or((signal.unit(), None))
}

/// Returns all values of a signal in its display unit, NaN if missing.
pub(crate) fn shown_values<'a>(signal: &'a Signal, parameters: &PlantParameters) -> Cow<'a, [f64]> {
    let values = signal.values_or_nan();
    match shown_unit(signal, parameters).1 {
        Some(converter) => values.iter().map(|&value| converter.apply(value)).collect(),
        None => Cow::Borrowed(values),
    }
}

/// Returns the symbol of the unit of a signal's errors and limits, whatever unit the log has.
pub(crate) fn unit_of_errors(signal: &Signal) -> &'static str {
    unit_of_difference(modelled_unit(signal).unwrap_or(signal.unit()))
}

/// Returns the symbol of the unit of a difference: a difference of two pressures is neither gauge nor absolute.
pub(crate) fn unit_of_difference(unit: Unit) -> &'static str {
    let symbol = unit.symbol();
    match unit.pressure_reference() {
        Some(_) => symbol.split(' ').next().unwrap_or(symbol),
        None => symbol,
    }
}

fn modelled_unit(signal: &Signal) -> Option<Unit> {
    let (_, unit) = ROW_SIGNALS
        .iter()
        .find(|(name, _)| *name == signal.name())?;
    (unit.quantity() == signal.unit().quantity()).then_some(*unit)
}

#[cfg(test)]
mod tests {
    use recording::{Provenance, Recording, TimeBase};

    use super::*;

    fn unit_of_errors_in(name: &str, unit: Unit) -> &'static str {
        let mut log = Recording::new(Provenance::from_source("test"));
        let base = log.add_time_base(TimeBase::uniform(0.0, 0.01, 2).unwrap());
        log.add_signal(name, unit, base, vec![1.0, 2.0]).unwrap();
        unit_of_errors(&log.signals()[0])
    }

    /// Defect seen: limits were shown with the log's unit, and a limit of 5 kPa counted as 5 bar.
    #[test]
    fn limits_have_the_unit_of_the_errors_whatever_the_log_has() {
        assert_eq!(unit_of_errors_in("p_ch", Unit::KilopascalGauge), "bar");
        assert_eq!(unit_of_errors_in("i_fill", Unit::Ampere), "mA");
        // A signal that the model lacks is compared with another log, in its own unit.
        assert_eq!(unit_of_errors_in("p_inlet", Unit::KilopascalGauge), "kPa");
        assert_eq!(unit_of_errors_in("voltage", Unit::Volt), "V");
    }
}
