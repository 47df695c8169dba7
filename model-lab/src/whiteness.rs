//! Tests of a residual for whiteness and for correlation with an input.

use std::ops::Range;

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use crate::metrics::{mean, present};
use crate::result::{InputCorrelation, LjungBox};

/// Number of lags of the Ljung-Box sum: 0.2 s at 100 Hz.
const LJUNG_BOX_LAGS: usize = 20;
/// Number of samples before the residual up to which inputs are searched.
const INPUT_LAGS: usize = 50;
/// Longest lag of the sum of autocorrelations: a longer memory is not noise.
const LONGEST_LAG: usize = 500;
/// Number of autocorrelation times at which the sum of autocorrelations ends (Sokal's window).
const WINDOW: f64 = 5.0;

/// Sequence without its mean; missing samples count as zero, so that they add to no product.
pub(crate) struct Centred<'a> {
    values: &'a [f64],
    mean: f64,
    count: usize,
    variance: f64,
}

impl<'a> Centred<'a> {
    /// Returns the centred sequence; none if it does not vary.
    pub(crate) fn new(values: &'a [f64]) -> Option<Self> {
        let mean = mean(values)?;
        let count = present(values).count();
        let variance = present(values)
            .map(|value| (value - mean).powi(2))
            .sum::<f64>()
            / count as f64;
        (variance > 0.0).then_some(Self {
            values,
            mean,
            count,
            variance,
        })
    }

    /// Writes the values from `first` on without their mean, as many as exist, and returns their number.
    fn fill(&self, first: usize, block: &mut [f64]) -> usize {
        let values = self.values.get(first..).unwrap_or_default();
        for (centred, &value) in block.iter_mut().zip(values) {
            *centred = if value.is_nan() {
                0.0
            } else {
                value - self.mean
            };
        }
        values.len().min(block.len())
    }

    /// Returns the autocorrelation coefficients at `lags`.
    fn autocorrelations(&self, lags: Range<usize>) -> impl Iterator<Item = f64> + '_ {
        self.correlations(self, lags)
    }

    /// Returns the correlations of this sequence with `earlier` delayed by each of `lags` samples.
    fn correlations(&self, earlier: &Centred<'_>, lags: Range<usize>) -> impl Iterator<Item = f64> {
        let scale =
            (self.variance * earlier.variance).sqrt() * self.count.min(earlier.count) as f64;
        let count = lags.len();
        lags.step_by(LANES)
            .flat_map(|first| sums_of_products(self, earlier, first))
            .take(count)
            .map(move |sum| sum / scale)
    }

    fn longest_lag(&self) -> usize {
        (self.count / 4).min(LONGEST_LAG)
    }

    /// Returns the autocorrelations at the lags from 1 to the longest.
    fn memory(&self) -> Vec<f64> {
        self.autocorrelations(1..self.longest_lag() + 1).collect()
    }
}

/// Number of lags that are summed at one time: the additions of one lag depend on each other, those of several do not.
const LANES: usize = 16;

/// Number of samples that are centred at one time: they fit into the nearest cache and take little memory.
const BLOCK: usize = 1024;

/// Returns the sums of `late` times `early` at the lags from `first` on, each added up in the order of the samples; 0 beyond the end.
fn sums_of_products(late: &Centred, early: &Centred, first: usize) -> [f64; LANES] {
    // The neutral element of floating-point addition, as in `Iterator::sum`.
    let mut sums = [-0.0; LANES];
    let (mut late_block, mut early_block) = ([0.0; BLOCK + LANES - 1], [0.0; BLOCK]);
    for begin in (0..early.values.len()).step_by(BLOCK) {
        let late_count = late.fill(first + begin, &mut late_block);
        let early_count = early.fill(begin, &mut early_block);
        let (late_block, early_block) = (&late_block[..late_count], &early_block[..early_count]);
        let whole = late_block.windows(LANES).len().min(early_block.len());
        for (late, &early) in late_block.windows(LANES).zip(early_block) {
            for (sum, &late) in sums.iter_mut().zip(late) {
                *sum += late * early;
            }
        }
        // The last samples have a partner at some of the lags only.
        for (lane, sum) in sums.iter_mut().enumerate() {
            let late_block = late_block.get(lane..).unwrap_or_default();
            for (late, early) in late_block.iter().zip(early_block).skip(whole) {
                *sum += late * early;
            }
        }
        if late_count < late_block.len() {
            break;
        }
    }
    for (lane, sum) in sums.iter_mut().enumerate() {
        if first + lane >= late.values.len() {
            *sum = 0.0;
        }
    }
    sums
}

/// Whiteness tests of a residual.
pub(crate) struct Whiteness<'a> {
    /// Centred residual with its autocorrelations; none for a residual that does not vary.
    residual: Option<(Centred<'a>, Vec<f64>)>,
}

impl<'a> Whiteness<'a> {
    pub(crate) fn of(residual: &'a [f64]) -> Self {
        Self {
            residual: Centred::new(residual).map(|residual| {
                let memory = residual.memory();
                (residual, memory)
            }),
        }
    }

    /// Returns the Ljung-Box test over 20 lags; none for fewer than 80 samples or a constant.
    pub(crate) fn ljung_box(&self) -> Option<LjungBox> {
        let (residual, memory) = self.residual.as_ref()?;
        if residual.longest_lag() < LJUNG_BOX_LAGS {
            return None;
        }
        let n = residual.count as f64;
        let sum: f64 = (1..)
            .zip(&memory[..LJUNG_BOX_LAGS])
            .map(|(lag, rho)| rho.powi(2) / (n - f64::from(lag)))
            .sum();
        let q = n * (n + 2.0) * sum;
        let distribution = ChiSquared::new(LJUNG_BOX_LAGS as f64).ok()?;
        Some(LjungBox {
            lags: LJUNG_BOX_LAGS,
            q,
            p_value: distribution.sf(q),
        })
    }

    /// Returns the integrated autocorrelation time 1 + 2 Σ ρ (samples); none for a constant.
    pub(crate) fn autocorrelation_time_samples(&self) -> Option<f64> {
        let (_, memory) = self.residual.as_ref()?;
        let summed = memory.len().saturating_sub(1);
        Some(summed_within_window(memory[..summed].iter().copied()))
    }

    /// Returns the largest correlation with each of `inputs` at the same instant or earlier; none for a constant input or a constant
    /// residual.
    ///
    /// Later inputs are left out: under closed-loop control the residual causes them.
    pub(crate) fn input_correlations(&self, inputs: &[Input]) -> Vec<InputCorrelation> {
        let Some((residual, memory)) = &self.residual else {
            return Vec::new();
        };
        let lags = INPUT_LAGS.min(residual.longest_lag());
        let correlation = |input: &Input| {
            let (values, memory_of_input) = input.varying.as_ref()?;
            let (lag_samples, rho) = residual.correlations(values, 0..lags + 1).enumerate().fold(
                (0, 0.0_f64),
                |best, now| {
                    if now.1.abs() > best.1.abs() {
                        now
                    } else {
                        best
                    }
                },
            );
            Some(InputCorrelation {
                input: input.name.to_owned(),
                rho,
                lag_samples,
                bound_99: chance_bound(
                    WithMemory {
                        sequence: residual,
                        memory,
                    },
                    WithMemory {
                        sequence: values,
                        memory: memory_of_input,
                    },
                    lags,
                )?,
            })
        };
        inputs.iter().filter_map(correlation).collect()
    }
}

/// Input with the statistics that each residual needs.
pub(crate) struct Input<'a> {
    name: &'a str,
    /// Centred input with its autocorrelations; none for one that is constant.
    varying: Option<(Centred<'a>, Vec<f64>)>,
}

impl<'a> Input<'a> {
    pub(crate) fn new(name: &'a str, values: &'a [f64]) -> Self {
        Self {
            name,
            varying: Centred::new(values).map(|values| {
                let memory = values.memory();
                (values, memory)
            }),
        }
    }
}

/// Returns the integrated autocorrelation time 1 + 2 Σ ρ (samples); none for a constant. It sums no more lags than necessary.
pub(crate) fn autocorrelation_time_samples(residual: &[f64]) -> Option<f64> {
    let residual = Centred::new(residual)?;
    Some(summed_within_window(
        residual.autocorrelations(1..residual.longest_lag()),
    ))
}

fn summed_within_window(autocorrelations: impl Iterator<Item = f64>) -> f64 {
    let mut time = 1.0;
    for (lag, rho) in (1..).zip(autocorrelations) {
        time += 2.0 * rho;
        if f64::from(lag) >= WINDOW * time {
            break;
        }
    }
    time
}

/// Sequence with its autocorrelations, from lag 1.
#[derive(Clone, Copy)]
struct WithMemory<'a> {
    sequence: &'a Centred<'a>,
    memory: &'a [f64],
}

/// Returns the magnitude that a chance correlation rarely exceeds (Bartlett): two independent sequences correlate with variance Σ ρ_a ρ_b /
/// n, more than 1 / n where both are autocorrelated. The significance level is divided among the lags that are searched.
fn chance_bound(a: WithMemory<'_>, b: WithMemory<'_>, lags: usize) -> Option<f64> {
    let longest = a.sequence.longest_lag().min(b.sequence.longest_lag());
    let memory: f64 = (1..=longest)
        .zip(a.memory)
        .zip(b.memory)
        .map(|((lag, rho_a), rho_b)| {
            // A triangular window keeps the scatter of far lags out of the sum.
            let weight = 1.0 - lag as f64 / (longest + 1) as f64;
            2.0 * weight * rho_a * rho_b
        })
        .sum();
    let deviation =
        ((1.0 + memory).max(1.0) / a.sequence.count.min(b.sequence.count) as f64).sqrt();
    let tail = 0.01 / (2.0 * (lags + 1) as f64);
    Some((Normal::new(0.0, deviation).ok()?.inverse_cdf(1.0 - tail)).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    fn input_correlation(name: &str, input: &[f64], residual: &[f64]) -> Option<InputCorrelation> {
        Whiteness::of(residual)
            .input_correlations(&[Input::new(name, input)])
            .pop()
    }

    fn ljung_box(residual: &[f64]) -> Option<LjungBox> {
        Whiteness::of(residual).ljung_box()
    }

    /// Goal: the sums of an hour at 1 kHz once took nearly all of three minutes, one lag after the other. Several lags at one time give the
    /// same bits.
    #[test]
    fn lags_that_are_summed_together_are_those_summed_alone() {
        for count in [3, 8, 9, 16, 17, 200, 1023, 1024, 1040, 3000] {
            let mut sequences = [white(6, count), white(7, count)];
            sequences[0][1] = f64::NAN;
            let [late, early] = sequences
                .each_ref()
                .map(|values| Centred::new(values).unwrap());
            let centred = |sequence: &Centred| {
                let mut values = vec![0.0; count];
                assert_eq!(sequence.fill(0, &mut values), count);
                values
            };
            let values = [centred(&late), centred(&early)];
            for first in [0, 1, 5, 190, 199, 300, 1000, 1023, 1024, 2999] {
                let together = sums_of_products(&late, &early, first);
                let [late, early] = &values;
                for (lane, together) in together.into_iter().enumerate() {
                    let lag = first + lane;
                    let alone = match late.get(lag..) {
                        Some(late) if !late.is_empty() => {
                            late.iter().zip(early).map(|(a, b)| a * b).sum::<f64>()
                        }
                        _ => 0.0,
                    };
                    assert_eq!(together.to_bits(), alone.to_bits(), "{count} {lag}");
                }
            }
        }
    }

    fn white(seed: u64, count: usize) -> Vec<f64> {
        let mut noise = Noise::new(seed);
        (0..count).map(|_| noise.normal()).collect()
    }

    fn with_memory(seed: u64, count: usize, memory: f64) -> Vec<f64> {
        let mut state = 0.0;
        let next = |noise: f64| {
            state = memory * state + noise;
            state
        };
        white(seed, count).into_iter().map(next).collect()
    }

    #[test]
    fn white_noise_is_rejected_at_the_rate_of_the_level() {
        let rejected = (0..400)
            .filter(|&seed| ljung_box(&white(seed, 1000)).unwrap().p_value < 0.05)
            .count();
        // 20 expected, standard deviation 4.4.
        assert!((7..=33).contains(&rejected), "{rejected} of 400");
    }

    #[test]
    fn a_slight_memory_is_not_white() {
        assert!(ljung_box(&with_memory(1, 6000, 0.1)).unwrap().p_value < 1e-6);
    }

    #[test]
    fn autocorrelation_time_is_that_of_a_first_order_process() {
        for memory in [0.0, 0.5, 0.9] {
            let expected = (1.0 + memory) / (1.0 - memory);
            let time = autocorrelation_time_samples(&with_memory(2, 100_000, memory)).unwrap();
            assert!(
                (time / expected - 1.0).abs() < 0.1,
                "{memory}: {time}, expected {expected}"
            );
        }
    }

    #[test]
    fn an_input_that_drives_the_residual_is_found_with_its_lag() {
        let input = white(3, 3000);
        let noise = white(4, 3000);
        let residual: Vec<f64> = (0..3000)
            .map(|n| noise[n] + if n >= 7 { 0.5 * input[n - 7] } else { 0.0 })
            .collect();
        let found = input_correlation("duty_fill", &input, &residual).unwrap();
        assert_eq!(found.lag_samples, 7);
        assert!(
            (found.rho - 0.5 / 1.25_f64.sqrt()).abs() < 0.05,
            "{found:?}"
        );
        assert!(found.rho > 3.0 * found.bound_99, "{found:?}");
    }

    #[test]
    fn independent_sequences_rarely_exceed_the_bound_even_with_memory() {
        for memory in [0.0, 0.8] {
            let exceeded = (0..200)
                .filter(|&seed| {
                    let (a, b) = (
                        with_memory(seed, 1000, memory),
                        with_memory(seed + 1000, 1000, memory),
                    );
                    let found = input_correlation("", &a, &b).unwrap();
                    found.rho.abs() > found.bound_99
                })
                .count();
            assert!(exceeded <= 8, "memory {memory}: {exceeded} of 200");
        }
    }

    #[test]
    fn constants_and_short_sequences_give_no_verdict() {
        assert_eq!(ljung_box(&[1.0; 500]), None);
        assert_eq!(ljung_box(&white(1, 60)), None);
        assert_eq!(input_correlation("", &[0.0; 500], &white(1, 500)), None);
        assert_eq!(autocorrelation_time_samples(&[f64::NAN; 4]), None);
    }

    #[test]
    fn missing_samples_do_not_make_white_noise_coloured() {
        let mut values = white(5, 4000);
        values
            .iter_mut()
            .step_by(7)
            .for_each(|value| *value = f64::NAN);
        assert!(ljung_box(&values).unwrap().p_value > 1e-3);
    }
}
