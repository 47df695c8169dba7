//! Sparse regression of the smoothed derivative of the pressure on the terms of the library's effects (S. L. Brunton,
//! J. L. Proctor, J. N. Kutz, *PNAS* 113, 2016, 3932: sequentially thresholded least squares).

use super::log::Log;
use crate::least_squares::{rms, weights};

/// Samples on either side of a smoothing window with a fitted parabola (A. Savitzky and M. Golay 1964).
const HALF_WINDOW: usize = 5;
/// Rows between a command and the response of the pressure.
const DELAY_ROWS: usize = 2;
/// Share of the derivative below which a term is dropped.
const THRESHOLD: f64 = 0.05;
/// Supply pressure (bar abs) and critical ratio of the datasheet.
const SUPPLY: f64 = 9.41;
const AMBIENT: f64 = 1.013;
const CRITICAL: f64 = 0.528;
/// Duty cycles (%) at the corners of the piecewise linear opening of a valve.
const KNEES: [f64; 3] = [30.0, 45.0, 75.0];

/// Quantities of one sample that the terms use.
struct Sample {
    /// Smoothed pressure (bar abs), and its second derivative (bar/s²).
    pressure: f64,
    curvature: f64,
    derivative: f64,
    /// Flow functions of fully open valves.
    fill: f64,
    vent: f64,
    /// Opening of the valves, 0 to 1, and its rate (1/s).
    open: [f64; 2],
    opening: f64,
    /// Energised time of the fill valve so far (s).
    heat: f64,
}

/// Term of an effect.
type Term = (&'static str, fn(&Sample) -> f64);

/// Effects with a term in pressure and duty cycle. The others do not appear in the derivative.
const TERMS: [Term; 11] = [
    ("chamber_leak", |s| AMBIENT - s.pressure),
    ("supply_seat_leak", |s| s.fill),
    ("gas_temperature", |s| s.curvature),
    ("sensor_lag", |s| s.opening * s.fill),
    ("supply_line_droop", |s| s.open[0] * s.open[0] * s.fill),
    ("drain_back_pressure", |s| s.open[1]),
    ("critical_ratio", |s| {
        s.open[0] * (s.pressure / SUPPLY - CRITICAL).max(0.0)
    }),
    ("regulating_valve_volume", |s| s.pressure * s.derivative),
    ("coil_heating", |s| s.open[0] * s.fill * s.heat),
    ("flow_force", |s| s.open[0] * s.fill * (SUPPLY - s.pressure)),
    ("sensor_offset", |_| 1.0),
];

/// Returns the effects whose terms remain.
pub(super) fn names(log: &Log) -> Vec<String> {
    let Some(samples) = samples(log) else {
        return vec![];
    };
    let derivative: Vec<f64> = samples.iter().map(|(s, _)| s.derivative).collect();
    let base: Vec<Vec<f64>> = (0..2 * KNEES.len())
        .map(|n| samples.iter().map(|(_, base)| base[n]).collect())
        .collect();
    let terms: Vec<Vec<f64>> = TERMS
        .iter()
        .map(|(_, term)| samples.iter().map(|(s, _)| term(s)).collect())
        .collect();
    let bound = THRESHOLD * rms_of(&derivative);
    let mut left: Vec<usize> = (0..TERMS.len()).collect();
    loop {
        let columns: Vec<&Vec<f64>> = base.iter().chain(left.iter().map(|&n| &terms[n])).collect();
        let weights = least_squares(&columns, &derivative);
        let kept: Vec<usize> = left
            .iter()
            .zip(&weights[base.len()..])
            .filter(|&(&n, weight)| weight.abs() * rms_of(&terms[n]) >= bound)
            .map(|(&n, _)| n)
            .collect();
        if kept.len() == left.len() {
            return left.iter().map(|&n| TERMS[n].0.to_owned()).collect();
        }
        left = kept;
    }
}

/// Returns the samples with the terms of the plain model; `None` without pressure.
fn samples(log: &Log) -> Option<Vec<(Sample, [f64; 2 * KNEES.len()])>> {
    let pressure = log.column("p_ch_bar_gauge")?;
    let time = log.column("time_s")?;
    let duties = [log.column("duty_fill_pct")?, log.column("duty_vent_pct")?];
    let step = time.get(1)? - time[0];
    let pieces = |valve: usize, n: usize| -> [f64; KNEES.len()] {
        let window = n - HALF_WINDOW - DELAY_ROWS..=n + HALF_WINDOW - DELAY_ROWS;
        KNEES.map(|knee| {
            let open = |duty: &f64| (duty - knee).max(0.0) / (100.0 - knee);
            duties[valve][window.clone()].iter().map(open).sum::<f64>()
                / (2 * HALF_WINDOW + 1) as f64
        })
    };
    let mut heat = 0.0;
    let places = HALF_WINDOW + DELAY_ROWS..pressure.len().checked_sub(HALF_WINDOW)?;
    let samples = places.map(|n| {
        let [value, derivative, curvature] = parabola(&pressure[n - HALF_WINDOW..=n + HALF_WINDOW]);
        let absolute = value + AMBIENT;
        let (fill, vent) = (
            flow(absolute / SUPPLY),
            absolute / SUPPLY * flow(AMBIENT / absolute),
        );
        let [of_fill, of_vent] = [0, 1].map(|valve| pieces(valve, n));
        heat += step * duties[0][n] / 100.0;
        let before = duties[0][n - DELAY_ROWS - 1];
        let sample = Sample {
            pressure: absolute,
            curvature: curvature / (step * step),
            derivative: derivative / step,
            fill,
            vent,
            open: [of_fill[0], of_vent[0]],
            opening: (duties[0][n - DELAY_ROWS] - before) / 100.0 / step,
            heat,
        };
        let base = std::array::from_fn(|piece| {
            let place = piece % KNEES.len();
            if piece < KNEES.len() {
                of_fill[place] * sample.fill
            } else {
                -of_vent[place] * sample.vent
            }
        });
        (sample, base)
    });
    Some(samples.collect())
}

/// Returns value, slope and curvature in the middle of a window, per sample.
fn parabola(window: &[f64]) -> [f64; 3] {
    let m = HALF_WINDOW as f64;
    let places = (0..window.len()).map(|n| n as f64 - m);
    let count = window.len() as f64;
    let (mut s2, mut s4, mut y0, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (x, y) in places.zip(window) {
        s2 += x * x;
        s4 += x.powi(4);
        y0 += y;
        y1 += x * y;
        y2 += x * x * y;
    }
    let square = (y2 - s2 / count * y0) / (s4 - s2 * s2 / count);
    [(y0 - square * s2) / count, y1 / s2, 2.0 * square]
}

/// Returns the isentropic flow relative to choked flow, by the ratio of the pressures.
fn flow(ratio: f64) -> f64 {
    if ratio <= CRITICAL {
        return 1.0;
    }
    let beyond = ((ratio - CRITICAL) / (1.0 - CRITICAL)).min(1.0);
    (1.0 - beyond * beyond).sqrt()
}

/// Returns the weights of the columns, each scaled to its rms, with a ridge of a millionth; a column of zeros gets
/// weight 0.
fn least_squares(columns: &[&Vec<f64>], target: &[f64]) -> Vec<f64> {
    let scales: Vec<f64> = columns
        .iter()
        .map(|column| rms_of(column).max(1e-12))
        .collect();
    let scaled: Vec<Vec<f64>> = columns
        .iter()
        .zip(&scales)
        .map(|(column, scale)| column.iter().map(|value| value / scale).collect())
        .collect();
    let ridge = vec![1e-6 * target.len() as f64; columns.len()];
    let weights = weights(&scaled, target, &ridge);
    weights
        .iter()
        .zip(&scales)
        .map(|(weight, scale)| weight / scale)
        .collect()
}

fn rms_of(values: &[f64]) -> f64 {
    rms(values.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_again() {
        let window: Vec<f64> = (-5..=5)
            .map(|x| 3.0 + 2.0 * f64::from(x) + 0.5 * f64::from(x * x))
            .collect();
        let found = parabola(&window);
        for (found, expected) in found.iter().zip([3.0, 2.0, 1.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// For a chamber with a leak only, the leak and its look-alikes are named.
    #[test]
    fn a_leak_without_any_command_is_named() {
        let mut text = String::from("time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge\n");
        for n in 0..2000 {
            let time = f64::from(n) * 0.01;
            text += &format!("{time},0,0,{}\n", 6.0 * (-0.3 * time).exp());
        }
        assert!(names(&Log::parse(&text)).contains(&"chamber_leak".to_owned()));
    }
}
