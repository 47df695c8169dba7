use super::dimension::{duty_band, duty_band_labels, pressure_band};
use super::excess::Excess;
use super::features::Features;
use crate::result::{ErrorMap, Horizon, MapCell};

/// The error over duty cycle of the acting valve (rows) and pressure (columns).
pub(crate) fn error_map(features: &Features, excess: &Excess, horizon: Horizon) -> ErrorMap {
    let labels = duty_band_labels();
    let bands = labels.len();
    let venting = labels
        .iter()
        .skip(1)
        .rev()
        .map(|label| format!("vent {label}"));
    let filling = labels.iter().skip(1).map(|label| format!("fill {label}"));
    let duty_bands: Vec<String> = venting.chain(["0 %".to_owned()]).chain(filling).collect();
    let pressure_bands = features.pressure_band_labels();
    let row = |duty: f64| {
        if duty < 0.0 {
            bands - 1 - duty_band(-duty)
        } else {
            bands - 1 + duty_band(duty)
        }
    };
    let columns = pressure_bands.len();
    let cell_of: Vec<usize> = features
        .duty_pct
        .iter()
        .zip(&features.pressure_bar)
        .map(|(&duty, &pressure)| row(duty) * columns + pressure_band(pressure))
        .collect();
    let sums = excess.sums(&cell_of, duty_bands.len() * columns);
    let cells = sums
        .iter()
        .enumerate()
        .filter(|(_, sums)| sums.count > 0)
        .map(|(cell, sums)| MapCell {
            duty_band: cell / columns,
            pressure_band: cell % columns,
            samples: sums.count,
            error: excess.bin_error(sums),
        });
    ErrorMap {
        horizon,
        cells: cells.collect(),
        duty_bands,
        pressure_bands,
    }
}
