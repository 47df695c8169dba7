//! Power spectral density of a time series, by Welch's method (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967):
//! averaged periodograms of Hann-windowed segments that overlap by half. No segment contains a gap.

use std::f64::consts::TAU;
use std::ops::Range;

use realfft::RealFftPlanner;
use serde::Serialize;

/// Samples of a segment: more exceed the pixels of a view; with fewer, neighbouring lines cannot be separated.
const SEGMENT: std::ops::RangeInclusive<usize> = 32..=4096;
/// Number of segments in the longest interval, so that their average is steady.
const LENGTHS_IN_PIECE: usize = 4;
/// Two samples are a gap if their distance is more than this many sample intervals, or less than one divided by it.
const STEP_SLACK: f64 = 1.5;

/// Power spectral density.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Spectrum {
    /// Frequencies (Hz), without 0: the mean of each segment is removed.
    frequency_hz: Vec<f64>,
    /// One-sided density (unit²/Hz); its integral over frequency is the variance.
    density: Vec<f64>,
    sample_rate_hz: f64,
    segments: usize,
    /// Frequency resolution (Hz).
    resolution_hz: f64,
}

impl Spectrum {
    /// Returns the spectrum of `values`, NaN if missing, sampled about every `step_s`; `None` if no interval without a
    /// gap is long enough.
    pub(crate) fn of(times_s: &[f64], values: &[f64], step_s: f64) -> Option<Self> {
        let pieces = pieces(times_s, values, step_s);
        let longest = pieces.iter().map(ExactSizeIterator::len).max()?;
        let length = (longest / LENGTHS_IN_PIECE).min(*SEGMENT.end());
        if length < *SEGMENT.start() {
            return None;
        }
        // A power of two is the fastest to transform.
        let length = 1 << length.ilog2();
        let sample_rate_hz = 1.0 / step_s;
        let mut sum = PowerSum::new(length);
        for piece in pieces {
            let piece = &values[piece];
            for begin in (0..=piece.len().saturating_sub(length)).step_by(length / 2) {
                if let Some(segment) = piece.get(begin..begin + length) {
                    sum.add(segment);
                }
            }
        }
        let resolution_hz = sample_rate_hz / length as f64;
        Some(Self {
            frequency_hz: (1..=length / 2)
                .map(|bin| bin as f64 * resolution_hz)
                .collect(),
            density: sum.density(sample_rate_hz),
            sample_rate_hz,
            segments: sum.segments,
            resolution_hz,
        })
    }

    /// Returns the density of white noise with this standard deviation, sampled like the series (unit²/Hz).
    pub(crate) fn of_white_noise(&self, standard_deviation: f64) -> f64 {
        2.0 * standard_deviation.powi(2) / self.sample_rate_hz
    }
}

/// Returns the intervals of evenly spaced samples without missing ones.
fn pieces(times_s: &[f64], values: &[f64], step_s: f64) -> Vec<Range<usize>> {
    let steps = step_s / STEP_SLACK..=step_s * STEP_SLACK;
    let goes_on = |index: usize| {
        index > 0
            && !values[index - 1].is_nan()
            && steps.contains(&(times_s[index] - times_s[index - 1]))
    };
    let mut pieces: Vec<Range<usize>> = Vec::new();
    for index in (0..values.len()).filter(|&index| !values[index].is_nan()) {
        match pieces.last_mut() {
            Some(last) if goes_on(index) => last.end = index + 1,
            _ => pieces.push(index..index + 1),
        }
    }
    pieces
}

/// Sum of periodograms of segments of one length.
struct PowerSum {
    transform: std::sync::Arc<dyn realfft::RealToComplex<f64>>,
    window: Vec<f64>,
    windowed: Vec<f64>,
    amplitudes: Vec<realfft::num_complex::Complex<f64>>,
    power: Vec<f64>,
    segments: usize,
}

impl PowerSum {
    fn new(length: usize) -> Self {
        let transform = RealFftPlanner::new().plan_fft_forward(length);
        let hann = |index: usize| 0.5 - 0.5 * (TAU * index as f64 / length as f64).cos();
        Self {
            window: (0..length).map(hann).collect(),
            windowed: transform.make_input_vec(),
            amplitudes: transform.make_output_vec(),
            power: vec![0.0; length / 2],
            transform,
            segments: 0,
        }
    }

    fn add(&mut self, segment: &[f64]) {
        let mean = segment.iter().sum::<f64>() / segment.len() as f64;
        for ((windowed, value), weight) in self.windowed.iter_mut().zip(segment).zip(&self.window) {
            *windowed = (value - mean) * weight;
        }
        let transformed = self
            .transform
            .process(&mut self.windowed, &mut self.amplitudes);
        // Both buffers come from the transform: their lengths are right.
        debug_assert!(transformed.is_ok());
        for (power, amplitude) in self.power.iter_mut().zip(&self.amplitudes[1..]) {
            *power += amplitude.norm_sqr();
        }
        self.segments += 1;
    }

    /// Returns the average, one-sided: every bin except half the sample rate stands for two frequencies.
    fn density(&self, sample_rate_hz: f64) -> Vec<f64> {
        let window_power: f64 = self.window.iter().map(|weight| weight * weight).sum();
        let scale = 1.0 / (sample_rate_hz * window_power * self.segments as f64);
        let last = self.power.len() - 1;
        let power = self.power.iter().enumerate();
        power
            .map(|(bin, power)| power * scale * if bin == last { 1.0 } else { 2.0 })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.01;

    fn times(count: usize) -> Vec<f64> {
        (0..count).map(|index| index as f64 * STEP_S).collect()
    }

    /// Returns numbers without a pattern, the same each time: SplitMix64, uniform within ±1.
    fn noise(count: usize) -> Vec<f64> {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut mixed = state;
            mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    fn integral(spectrum: &Spectrum) -> f64 {
        spectrum.density.iter().sum::<f64>() * spectrum.resolution_hz
    }

    /// Parseval: the variance is complete, and white noise lies on its level.
    #[test]
    fn the_integral_over_frequency_is_the_variance() {
        let values = noise(100_000);
        let spectrum = Spectrum::of(&times(values.len()), &values, STEP_S).unwrap();
        let variance = values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64;
        assert!((integral(&spectrum) / variance - 1.0).abs() < 0.01);
        let level = spectrum.of_white_noise(variance.sqrt());
        let low: f64 = spectrum.density[..200].iter().sum::<f64>() / 200.0;
        assert!((low / level - 1.0).abs() < 0.1, "{low} {level}");
    }

    #[test]
    fn a_sine_is_a_line_at_its_frequency_with_half_its_squared_amplitude() {
        let frequency_hz = 12.5;
        let times = times(20_000);
        let values: Vec<f64> = times
            .iter()
            .map(|time_s| 5.0 + 3.0 * (TAU * frequency_hz * time_s).sin())
            .collect();
        let spectrum = Spectrum::of(&times, &values, STEP_S).unwrap();
        let highest = (0..spectrum.density.len())
            .max_by(|&one, &other| spectrum.density[one].total_cmp(&spectrum.density[other]))
            .unwrap();
        let found_hz = spectrum.frequency_hz[highest];
        assert!((found_hz - frequency_hz).abs() <= spectrum.resolution_hz);
        assert!((integral(&spectrum) - 4.5).abs() < 0.01);
    }

    /// A jump across a gap would add to the spectrum.
    #[test]
    fn no_segment_lies_across_a_gap_or_a_missing_sample() {
        let mut times = times(4000);
        for time_s in &mut times[2000..] {
            *time_s += 7.0;
        }
        let mut values: Vec<f64> = noise(4000).iter().map(|value| 1e-3 * value).collect();
        for value in &mut values[2000..] {
            *value += 1000.0;
        }
        values[3000] = f64::NAN;
        assert_eq!(
            pieces(&times, &values, STEP_S),
            [0..2000, 2000..3000, 3001..4000]
        );
        let spectrum = Spectrum::of(&times, &values, STEP_S).unwrap();
        assert!(integral(&spectrum) < 1e-6, "{}", integral(&spectrum));
        // 2000 samples contain 6 segments of 256 with half overlap and a rest: 14, and 6 and 6 for the halves.
        assert_eq!(spectrum.segments, 14 + 6 + 6);
    }

    #[test]
    fn few_samples_have_no_spectrum_and_many_have_a_bounded_one() {
        let values = noise(127);
        assert_eq!(Spectrum::of(&times(127), &values, STEP_S), None);
        assert_eq!(Spectrum::of(&[], &[], STEP_S), None);
        let values = noise(1_000_000);
        let spectrum = Spectrum::of(&times(values.len()), &values, STEP_S).unwrap();
        assert_eq!(spectrum.density.len(), 2048);
        assert_eq!(spectrum.frequency_hz.len(), 2048);
    }
}
