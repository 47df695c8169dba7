//! Repeatable random numbers: every number is a function of a seed, a stream and a counter, so that an additional draw
//! in one place changes nothing in another.

/// Source of the numbers of one stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Random {
    key: u64,
}

/// Use of the numbers; each use has its own stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Noise of the pressure sensor, one draw per sample.
    SensorNoise,
    /// Scatter from rig to rig, one draw per parameter.
    RigScatter,
    /// Seeds of the rigs of a batch, one draw per rig.
    RigSeed,
    /// Inputs of an ECU for a comparison with another one.
    Walk,
    /// Disturbances of frames on a bad wire.
    Wire,
    /// Supply voltage and coil temperature of a rig.
    OperatingConditions,
    /// Noise of the measured supply voltage, one draw per sample.
    VoltageNoise,
    /// Noise of the measured coil currents, two draws per sample.
    CurrentNoise,
    /// Candidates of a search over gains.
    GainSearch,
}

impl Random {
    /// Creates the numbers of `stream` under `seed`.
    pub fn new(seed: u64, stream: Stream) -> Self {
        Self {
            key: mix(mix(seed).wrapping_add(stream as u64)),
        }
    }

    /// Returns number `counter`, all 64 bits uniform.
    pub fn bits(&self, counter: u64) -> u64 {
        mix(self.key ^ mix(counter))
    }

    /// Returns number `counter`, uniform over -1 ..= 1 in steps of 2⁻⁵².
    pub fn symmetric(&self, counter: u64) -> f64 {
        let steps = (self.bits(counter) >> 11) as i64 - (1 << 52);
        steps as f64 / (1_u64 << 52) as f64
    }

    /// Returns number `counter`, normally distributed with standard deviation 1, approximated by the sum of twelve
    /// uniform numbers; at most ±6. A sum is the same on every machine, a logarithm need not be.
    pub fn normal(&self, counter: u64) -> f64 {
        // A uniform number over -1 ..= 1 has variance 1/3: twelve of them, halved, have variance 1.
        (0..12)
            .map(|part| self.symmetric(counter.wrapping_mul(12).wrapping_add(part)))
            .sum::<f64>()
            / 2.0
    }
}

/// Numbers of a stream in sequence, for draws without a fixed counter.
#[derive(Clone, Debug)]
pub struct Draws {
    random: Random,
    next: u64,
}

impl Draws {
    /// Creates the sequence from number 0 on.
    pub const fn new(random: Random) -> Self {
        Self { random, next: 0 }
    }

    /// Returns the next number, all 64 bits uniform.
    pub fn bits(&mut self) -> u64 {
        let bits = self.random.bits(self.next);
        self.next += 1;
        bits
    }

    /// Returns a number uniform over 0 .. `bound`; 0 if `bound` is 0.
    pub fn below(&mut self, bound: u32) -> u32 {
        // The high half of a product with 32 random bits.
        (((self.bits() >> 32) * u64::from(bound)) >> 32) as u32
    }

    /// Returns a number uniform over `from` ..= `to`.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        let share = (self.bits() >> 11) as f64 / ((1_u64 << 53) - 1) as f64;
        from + (to - from) * share
    }
}

/// Applies the finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection in which every input bit affects every
/// output bit.
fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(draw: impl Fn(u64) -> f64) -> (f64, f64, f64) {
        let count = 100_000;
        let values: Vec<f64> = (0..count).map(draw).collect();
        let mean = values.iter().sum::<f64>() / count as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count as f64;
        let largest = values.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        (mean, variance, largest)
    }

    #[test]
    fn draws_have_the_moments_of_their_distribution() {
        let random = Random::new(1, Stream::SensorNoise);
        let (mean, variance, largest) = moments(|n| random.normal(n));
        assert!(
            mean.abs() < 0.01 && (variance - 1.0).abs() < 0.02 && largest < 6.0,
            "{mean} {variance} {largest}"
        );
        let (mean, variance, largest) = moments(|n| random.symmetric(n));
        assert!(
            mean.abs() < 0.01 && (variance - 1.0 / 3.0).abs() < 0.01 && largest <= 1.0,
            "{mean} {variance}"
        );
    }

    #[test]
    fn draws_one_after_the_other_fill_their_range_evenly() {
        let mut draws = Draws::new(Random::new(1, Stream::Walk));
        let mut counts = [0_u32; 5];
        for _ in 0..50_000 {
            counts[draws.below(5) as usize] += 1;
        }
        assert!(
            counts.iter().all(|count| (9_500..10_500).contains(count)),
            "{counts:?}"
        );
        assert!((0..1000).all(|_| (2.0..=3.0).contains(&draws.between(2.0, 3.0))));
        assert_eq!(draws.below(0), 0);
    }

    #[test]
    fn neighbouring_draws_streams_and_seeds_are_uncorrelated() {
        let correlation = |a: Random, b: Random, shift: u64| {
            (0..50_000)
                .map(|n| a.normal(n) * b.normal(n + shift))
                .sum::<f64>()
                / 50_000.0
        };
        let random = Random::new(1, Stream::SensorNoise);
        for (other, shift) in [
            (random, 1),
            (Random::new(1, Stream::RigScatter), 0),
            (Random::new(2, Stream::SensorNoise), 0),
        ] {
            let found = correlation(random, other, shift);
            assert!(found.abs() < 0.02, "{found}");
        }
    }
}
