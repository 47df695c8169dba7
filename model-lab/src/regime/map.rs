use super::dimension::duty_band_labels;
use super::excess::Excess;
use super::features::Features;
use crate::bins::Bins;
use crate::result::{ERROR_MAP, ErrorMap, Horizon, MapCell, Placement};

/// Returns the error over duty cycle of the acting valve (rows) and pressure (columns), and the cell of each sample.
pub(crate) fn error_map(
    features: &Features,
    excess: &Excess,
    horizon: Horizon,
) -> (ErrorMap, Placement) {
    let labels = duty_band_labels();
    let venting = labels
        .iter()
        .skip(1)
        .rev()
        .map(|label| format!("vent {label}"));
    let filling = labels.iter().skip(1).map(|label| format!("fill {label}"));
    let duty_bands: Vec<String> = venting.chain(["0 %".to_owned()]).chain(filling).collect();
    let pressure_bands = features.states.pressure_band_labels();
    let columns = pressure_bands.len();
    let cell_of: Bins = features
        .acting
        .iter()
        .zip(features.states.pressure_band.iter())
        .map(|(row, band)| row * columns as u16 + band)
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
    let labels = duty_bands.iter().flat_map(|duty| {
        let label = move |pressure| format!("{duty}, {pressure}");
        pressure_bands.iter().map(label)
    });
    let placement = Placement {
        signal: String::new(),
        dimension: ERROR_MAP.to_owned(),
        labels: labels.collect(),
        bin_of: cell_of,
    };
    let map = ErrorMap {
        horizon,
        cells: cells.collect(),
        duty_bands,
        pressure_bands,
    };
    (map, placement)
}

#[cfg(test)]
mod tests {
    use super::super::features::States;
    use super::*;
    use crate::result::Residual;

    #[test]
    fn venting_lies_above_shut_and_filling_below_each_further_out_with_its_duty() {
        let at = |bins: [u16; 5]| bins.into_iter().collect();
        let states = States::new(
            [at([0; 5]), at([0; 5]), at([2; 5])],
            &[0.5, 2.5, 2.5, 0.5, 7.9],
            &[0.0, 1.0, 2.0, 3.0, 4.0],
        );
        let features = Features::sorted(
            &states,
            [-95.0, -20.0, 0.0, 20.0, 95.0].into_iter(),
            std::iter::repeat_n(None, 5),
            std::iter::repeat_n(0.0, 5),
        );
        let residual = [1.0, 2.0, 3.0, f64::NAN, 5.0];
        let (map, placement) = error_map(
            &features,
            &Excess::new(Residual::new(&residual, &[0.0; 5]), 0.0, 0.0),
            Horizon::FreeRun,
        );
        let cell = |cell: &MapCell| {
            (
                &map.duty_bands[cell.duty_band][..],
                &map.pressure_bands[cell.pressure_band][..],
                cell.error.bias,
            )
        };
        assert_eq!(
            map.cells.iter().map(cell).collect::<Vec<_>>(),
            [
                ("vent 90 % and more", "0 to 1 bar", 1.0),
                ("vent below 30 %", "2 to 3 bar", 2.0),
                ("0 %", "2 to 3 bar", 3.0),
                ("fill 90 % and more", "7 to 8 bar", 5.0),
            ]
        );
        let bins: Vec<u16> = placement.bin_of.iter().collect();
        let label = |sample: usize| &placement.labels[usize::from(bins[sample])][..];
        assert_eq!(label(0), "vent 90 % and more, 0 to 1 bar");
        assert_eq!(label(3), "fill below 30 %, 0 to 1 bar");
    }
}
