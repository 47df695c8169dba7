//! Periodogram for uneven samples: a sine, a cosine and a constant fitted together at each frequency (M. Zechmeister, M. Kürster 2009).

use core::f64::consts::TAU;
use core::ops::Range;

use rayon::prelude::*;

/// Number of frequencies through which the phases are rotated before they are recomputed, so that rounding errors do not accumulate.
const TURNS: usize = 64;

/// Samples at arbitrary times.
#[derive(Clone)]
pub(super) struct Samples {
    pub(super) times_s: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// One over the variance of each value.
    pub(super) weights: Vec<f64>,
}

/// Wave of one frequency that fits best together with a constant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    pub(super) frequency_hz: f64,
    cosine: f64,
    sine: f64,
    /// Half of the decrease of the sum of squares; in white noise exponentially distributed with mean 1.
    pub(super) power: f64,
}

impl Samples {
    pub(super) fn wave(&self, frequency_hz: f64) -> Wave {
        let mut sums = Sums::default();
        for ((time_s, value), weight) in self.times_s.iter().zip(&self.values).zip(&self.weights) {
            sums.add(*weight, *value, (TAU * frequency_hz * time_s).sin_cos());
        }
        sums.wave(frequency_hz)
    }

    /// Returns the powers of the waves at these multiples of a frequency. From one to the next, each phase rotates by the same angle.
    pub(super) fn powers(&self, multiples: Range<usize>, step_hz: f64) -> Vec<f64> {
        let angles = self.times_s.iter().map(|time_s| TAU * step_hz * time_s);
        let turns: Vec<_> = angles.clone().map(f64::sin_cos).collect();
        let first: Vec<_> = multiples.clone().step_by(TURNS).collect();
        let powers = first.into_par_iter().flat_map_iter(|first| {
            let mut phases: Vec<_> = angles
                .clone()
                .map(|angle| (first as f64 * angle).sin_cos())
                .collect();
            let to = multiples.end.min(first + TURNS);
            let powers: Vec<f64> = (first..to)
                .map(|multiple| {
                    let mut sums = Sums::default();
                    let each = self.values.iter().zip(&self.weights).zip(&turns);
                    for (phase, ((value, weight), turn)) in phases.iter_mut().zip(each) {
                        sums.add(*weight, *value, *phase);
                        *phase = turned(*phase, *turn);
                    }
                    sums.wave(multiple as f64 * step_hz).power
                })
                .collect();
            powers
        });
        powers.collect()
    }
}

/// Returns sine and cosine of the sum of two angles.
fn turned((sine, cosine): (f64, f64), (of_turn, beside): (f64, f64)) -> (f64, f64) {
    (
        sine * beside + cosine * of_turn,
        cosine * beside - sine * of_turn,
    )
}

/// Weighted sums of 1, cosine c, sine s, value y and their products.
#[derive(Default)]
struct Sums {
    w: f64,
    c: f64,
    s: f64,
    y: f64,
    cc: f64,
    cs: f64,
    ss: f64,
    yc: f64,
    ys: f64,
}

impl Sums {
    fn add(&mut self, weight: f64, value: f64, (sine, cosine): (f64, f64)) {
        let (of_c, of_s) = (weight * cosine, weight * sine);
        self.w += weight;
        self.c += of_c;
        self.s += of_s;
        self.y += weight * value;
        self.cc += of_c * cosine;
        self.cs += of_c * sine;
        self.ss += of_s * sine;
        self.yc += of_c * value;
        self.ys += of_s * value;
    }

    fn wave(&self, frequency_hz: f64) -> Wave {
        let &Self { w, c, s, y, .. } = self;
        let (cc, cs, ss) = (
            self.cc - c * c / w,
            self.cs - c * s / w,
            self.ss - s * s / w,
        );
        let (yc, ys) = (self.yc - y * c / w, self.ys - y * s / w);
        let determinant = cc * ss - cs * cs;
        // A wave that the samples cannot distinguish from a constant does not count.
        if determinant <= 1e-9 * cc * ss {
            return Wave {
                frequency_hz,
                cosine: 0.0,
                sine: 0.0,
                power: 0.0,
            };
        }
        let cosine = (yc * ss - ys * cs) / determinant;
        let sine = (ys * cc - yc * cs) / determinant;
        Wave {
            frequency_hz,
            cosine,
            sine,
            power: 0.5 * (cosine * yc + sine * ys),
        }
    }
}

impl Wave {
    pub(super) fn amplitude(&self) -> f64 {
        f64::hypot(self.cosine, self.sine)
    }

    pub(super) fn at(&self, time_s: f64) -> f64 {
        let (sine, cosine) = (TAU * self.frequency_hz * time_s).sin_cos();
        self.cosine * cosine + self.sine * sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a constant and a wave of 1.3 Hz at uneven times.
    fn wavy() -> Samples {
        let times_s: Vec<f64> = (0..2000)
            .map(|row| 0.01 * f64::from(row) + 0.003 * f64::from(row % 7))
            .filter(|time_s| time_s % 1.0 < 0.6)
            .collect();
        let wave = |time_s: &f64| 2.0 + 0.3 * (TAU * 1.3 * time_s - 0.7).cos();
        Samples {
            values: times_s.iter().map(wave).collect(),
            weights: times_s.iter().map(|time_s| 1.0 + time_s.fract()).collect(),
            times_s,
        }
    }

    #[test]
    fn a_wave_beside_a_constant_is_found_whole() {
        let samples = wavy();
        let wave = samples.wave(1.3);
        assert!((wave.amplitude() - 0.3).abs() < 1e-12, "{wave:?}");
        let rest = samples.times_s.iter().zip(&samples.values);
        for (time_s, value) in rest {
            assert!((value - wave.at(*time_s) - 2.0).abs() < 1e-12);
        }
    }

    /// A power is the same whether its phases are rotated from one frequency to the next or recomputed.
    #[test]
    fn powers_of_many_frequencies_are_those_of_each() {
        let samples = wavy();
        let step_hz = 0.025;
        let powers = samples.powers(3..900, step_hz);
        assert_eq!(powers.len(), 897);
        let largest = powers.iter().copied().fold(0.0, f64::max);
        for (index, power) in powers.iter().enumerate() {
            let alone = samples.wave((index + 3) as f64 * step_hz).power;
            assert!(
                (power - alone).abs() < 1e-10 * largest,
                "{index}: {power}, {alone}"
            );
        }
        assert_eq!(powers[52 - 3], largest);
    }
}
