//! Sharp lines in the spectrum of the residual: an oscillation that does not depend on the commands.
//!
//! A [periodogram](Samples) for uneven samples is used, because a valve is open only now and then. It is taken of the cause, not of the
//! error: while the fill valve works, the necessary change of the supply pressure; while the vent valve works, that of the flow as a share;
//! while both are shut, the leak rate. A smooth law of the commands is subtracted first. The height of a line is compared with its
//! neighbours, so that a coloured background causes none. A line that the commands explain does not count, since a cycle of commands makes
//! every error periodic.

use core::f64::consts::LN_2;
use core::ops::Range;

use plant_sim::PlantParameters;

use super::alike::{Usual, usual, without_smooth_law};
use super::periodogram::{Samples, Wave};
use super::trace::{Regime, Trace};
use crate::diagnosis::evidence::log::{Channel, Log};
use crate::diagnosis::fit::vector::median;
use crate::diagnosis::result::SpectralLine;

/// Largest probability of a line in noise alone; it was fixed before any log was examined.
const CHANCE: f64 = 1e-4;
/// Largest number of lines of one signal.
const LINES: usize = 3;
/// Smallest number of periods of a line in the log.
const PERIODS: f64 = 3.0;
/// Resolution of the frequencies over that of the log's length.
const OVERSAMPLING: usize = 2;
/// Number of neighbours on either side whose median is the background, without the nearest ones, into which a line leaks.
const NEIGHBOURS: usize = 40;
const LEAKAGE: usize = 3;
const SIDE: usize = OVERSAMPLING * NEIGHBOURS;
/// Highest frequency over that of rows and of PWM periods; above it nothing is resolved.
const HIGHEST: f64 = 1.0 / 3.0;
/// Share of the largest sensitivity below which rows are left out, since they contain little information.
const LEAST_SENSITIVITY: f64 = 0.1;
/// Smallest share of the excess that a line must explain; a weaker one is part of something else.
const LEAST_SHARE: f64 = 0.25;
/// Largest probability, at this one frequency, of a line after the usual values are subtracted.
const UNUSUAL: f64 = 0.01;
/// Smallest number of rows of a spectrum.
const FEWEST: usize = 100;

/// Oscillating cause, row by row.
#[derive(Clone)]
pub(super) struct Swing<'a> {
    log: &'a Log,
    signal: &'static str,
    condition: &'static str,
    unit: &'static str,
    rows: Vec<usize>,
    samples: Samples,
    /// Largest amplitude that the cause can have.
    largest: f64,
    /// Weighted sum of squares of noise alone.
    noise: f64,
    highest_hz: f64,
}

/// Change of the predicted pressure due to a cause, row by row.
pub(super) struct Sensitivity {
    pub(super) regime: Regime,
    /// Unit of the cause.
    pub(super) unit: &'static str,
    /// Largest amplitude that the cause can have.
    pub(super) largest: f64,
    /// Change per unit of the cause (bar).
    pub(super) bar: Vec<f64>,
}

impl<'a> Swing<'a> {
    /// Returns the oscillating cause in `regime`.
    pub(super) fn of_pressure(
        trace: &Trace<'a>,
        sensitivity: &Sensitivity,
        plant: &PlantParameters,
    ) -> Option<Self> {
        let in_noise = |row: usize| sensitivity.bar[row] / trace.floors_bar[row];
        let is_there = |row: usize| {
            trace.regimes[row] == sensitivity.regime && trace.errors_bar[row].is_finite()
        };
        let rows: Vec<usize> = (0..trace.len()).filter(|&row| is_there(row)).collect();
        let most = rows
            .iter()
            .map(|&row| in_noise(row).abs())
            .fold(0.0, f64::max);
        let rows: Vec<usize> = rows
            .into_iter()
            .filter(|&row| in_noise(row).abs() > LEAST_SENSITIVITY * most)
            .collect();
        let values = rows.iter().map(|&row| {
            (
                row,
                trace.errors_bar[row] / sensitivity.bar[row],
                in_noise(row).powi(2),
            )
        });
        let (condition, unit) = (sensitivity.regime.name(), sensitivity.unit);
        let swing = Self::new((trace.channel, condition, unit), values, trace.log, plant)?;
        Some(Self {
            largest: sensitivity.largest,
            ..swing
        })
    }

    /// Returns the residual of a coil current, whatever the state of the valves.
    pub(super) fn of_current(
        log: &'a Log,
        channel: &Channel,
        errors: &[f64],
        plant: &PlantParameters,
    ) -> Option<Self> {
        let rows = errors
            .iter()
            .enumerate()
            .filter(|(_, error)| error.is_finite());
        let values = rows.map(|(row, &error)| (row, error, channel.sigma.powi(-2)));
        Self::new((channel, "always", "mA"), values, log, plant)
    }

    fn new(
        (channel, condition, unit): (&Channel, &'static str, &'static str),
        each: impl Iterator<Item = (usize, f64, f64)>,
        log: &'a Log,
        plant: &PlantParameters,
    ) -> Option<Self> {
        let (mut rows, mut times_s, mut values, mut weights) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (row, value, weight) in each {
            rows.push(row);
            times_s.push(log.commands.times_s[row]);
            values.push(value);
            weights.push(weight);
        }
        // Other variations of a cause add to its oscillation, so no row may have a large weight.
        let mut sizes: Vec<f64> = values.iter().copied().map(f64::abs).collect();
        let usual = median(&mut sizes)?.powi(2);
        let mut noise = 0.0;
        for weight in &mut weights {
            let variance = 1.0 / *weight;
            *weight = 1.0 / (variance + usual);
            noise += variance * *weight;
        }
        without_smooth_law(log, &rows, &mut values, &weights);
        let span_s = log.commands.times_s.last()? - log.commands.times_s.first()?;
        let rows_hz = (log.commands.len() - 1) as f64 / span_s;
        let highest_hz = HIGHEST * rows_hz.min(plant.ecu.pwm_frequency_hz);
        (values.len() >= FEWEST).then_some(Self {
            log,
            signal: channel.signal,
            condition,
            unit,
            rows,
            samples: Samples {
                times_s,
                values,
                weights,
            },
            largest: f64::INFINITY,
            noise,
            highest_hz,
        })
    }

    /// Returns the frequency of which the examined ones are multiples (Hz).
    fn step_hz(&self) -> f64 {
        let times_s = &self.samples.times_s;
        1.0 / (OVERSAMPLING as f64 * (times_s[times_s.len() - 1] - times_s[0]))
    }

    /// Returns the multiples that are examined.
    fn multiples(&self) -> Range<usize> {
        let first = (PERIODS * OVERSAMPLING as f64).ceil() as usize;
        first..((self.highest_hz / self.step_hz()).ceil() as usize).max(first)
    }

    /// Returns the number of independent frequencies that are examined.
    pub(super) fn trials(&self) -> f64 {
        self.multiples().len() as f64 / OVERSAMPLING as f64
    }

    /// Returns the lines, the strongest first, where `trials` independent frequencies are examined in total.
    pub(super) fn lines(mut self, trials: f64) -> Vec<SpectralLine> {
        let mut lines = Vec::new();
        let mut tried = 0;
        let square = |(value, weight): (&f64, &f64)| weight * value * value;
        let Samples {
            values, weights, ..
        } = &self.samples;
        let excess = values.iter().zip(weights).map(square).sum::<f64>() - self.noise;
        while tried < LINES
            && let Some((line, wave)) = self.strongest(trials)
        {
            let is_own = 2.0 * wave.power > LEAST_SHARE * excess
                && wave.amplitude() <= self.largest
                && !self.is_commanded(&wave);
            let Samples {
                times_s, values, ..
            } = &mut self.samples;
            for (time_s, value) in times_s.iter().zip(values) {
                *value -= wave.at(*time_s);
            }
            if is_own {
                lines.push(line);
            }
            tried += 1;
        }
        lines
    }

    /// Returns whether the commands explain the wave: without the usual values at similar instants it is not significant.
    fn is_commanded(&self, wave: &Wave) -> bool {
        let mut values = vec![0.0; self.log.commands.len()];
        for (&row, value) in self.rows.iter().zip(&self.samples.values) {
            values[row] = *value;
        }
        let usual = usual(self.log, &values, &self.rows, &self.rows);
        let without =
            |(value, usual): (&f64, Option<Usual>)| value - usual.map_or(0.0, |usual| usual.mean);
        let unusual = Samples {
            values: self.samples.values.iter().zip(usual).map(without).collect(),
            ..self.samples.clone()
        };
        let (all, step_hz) = (self.multiples(), self.step_hz());
        let nearest = (wave.frequency_hz / step_hz).ceil() as usize;
        // The tested frequencies, and their neighbours as the reference.
        let around = |multiples: usize| {
            let from = nearest.saturating_sub(1 + multiples).max(all.start);
            from..(nearest + 1 + multiples).clamp(from, all.end)
        };
        let seen = around(SIDE);
        let powers = unusual.powers(seen.clone(), step_hz);
        !around(0)
            .filter_map(|multiple| chance(&powers, multiple - seen.start))
            .any(|p_value| p_value < UNUSUAL)
    }

    fn strongest(&self, trials: f64) -> Option<(SpectralLine, Wave)> {
        let (multiples, step_hz) = (self.multiples(), self.step_hz());
        let powers = self.samples.powers(multiples.clone(), step_hz);
        // A strong line raises the background of its own neighbours; of the significant lines, the strongest is taken.
        let (n, p_value) = (0..powers.len())
            .filter_map(|n| Some((n, corrected(chance(&powers, n)?, trials))))
            .filter(|(_, p_value)| *p_value < CHANCE)
            .max_by(|a, b| powers[a.0].total_cmp(&powers[b.0]))?;
        // Between the frequencies that were examined.
        let multiple = (multiples.start + n) as f64;
        let finer =
            (-10..=10).map(|k| self.samples.wave((multiple + 0.1 * f64::from(k)) * step_hz));
        let wave = finer.max_by(|a, b| a.power.total_cmp(&b.power))?;
        let line = SpectralLine {
            signal: self.signal.to_owned(),
            condition: self.condition.to_owned(),
            frequency_hz: wave.frequency_hz,
            amplitude: wave.amplitude(),
            unit: self.unit.to_owned(),
            p_value: p_value.max(f64::MIN_POSITIVE),
        };
        Some((line, wave))
    }
}

/// Returns the probability of such a line in any of `trials` places.
fn corrected(p_value: f64, trials: f64) -> f64 {
    -f64::exp_m1(trials * f64::ln_1p(-p_value.min(1.0 - f64::EPSILON)))
}

/// Returns the probability of a power as high as that at `n` in noise of the neighbours' level, whose uncertainty is that of their median.
fn chance(powers: &[f64], n: usize) -> Option<f64> {
    let gap = OVERSAMPLING * LEAKAGE;
    let below = n.saturating_sub(SIDE)..n.saturating_sub(gap);
    let above = (n + gap + 1).min(powers.len())..(n + SIDE + 1).min(powers.len());
    let mut neighbours = [&powers[below], &powers[above]].concat();
    let independent = neighbours.len() as f64 / OVERSAMPLING as f64;
    // The median of an exponential distribution is ln 2 of its mean, and has half the efficiency of the mean.
    let level = median(&mut neighbours)? / LN_2;
    let known = 0.5 * independent;
    (independent >= NEIGHBOURS as f64 / 2.0 && level > 0.0)
        .then(|| (1.0 + powers[n] / (level * known)).powf(-known))
}
