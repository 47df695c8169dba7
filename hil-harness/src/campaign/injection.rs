//! Injection: one fault, and everything else that determines a run.

use core::fmt;
use core::str::FromStr;

use super::bounds::RETRIES;
use super::chance::{Chance, chance};
use super::class::{ClassError, FaultClass};
use super::fault::Survival;
use super::fault::ecu::EcuFault;

/// One fault in one run. Its text is a line that reads back as the same value:
///
/// ```
/// use hil_harness::campaign::Injection;
///
/// let line = "sensor/stuck onset=312 duration=80 times=1 severity=0.40 rig=17 seed=0x1234";
/// let injection: Injection = line.parse()?;
/// assert_eq!(injection.to_string(), line);
/// # Ok::<(), hil_harness::campaign::InjectionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Injection {
    /// Class of the fault.
    pub class: FaultClass,
    /// First sample of the fault, counted from power-on.
    pub onset: u32,
    /// Duration of each occurrence (samples).
    pub duration: u32,
    /// Number of occurrences, a second apart.
    pub times: u32,
    /// Severity (%), 0 ..= 100; each class defines its meaning.
    pub severity_pct: u8,
    /// Number of the rig: odd ones have the orifices of prototype 2.
    pub rig: u32,
    /// Seed of all random numbers: reference, noise, and those of the fault.
    pub seed: u64,
}

/// Time from the end of a fault to its next occurrence (samples): 1 s.
const PAUSE: u32 = 100;
/// Range of the first onset (samples), in which the loop runs.
const ONSET: [u32; 2] = [40, 340];
/// Latest early onset (samples), while the ECU still waits for the reference at zero.
const ONSET_EARLY: u64 = 9;
/// Longest duration: to the end of every reaction.
const DURATION_MAX: u32 = 1000;
/// Number of rigs to draw from.
const RIGS: u64 = 1000;
/// Number of occurrences of a repeated fault: one more than the limit that locks the ECU.
const TIMES: u32 = 5;

impl Injection {
    /// Draws number `index` of the campaign with this seed, among `classes`.
    ///
    /// # Panics
    /// Panics if there is no class.
    pub fn drawn(classes: &[FaultClass], seed: u64, index: u64) -> Self {
        assert!(!classes.is_empty(), "a campaign needs a fault class");
        let random = chance(chance(seed, Chance::Campaign).bits(index), Chance::Campaign);
        let below = |counter: u64, end: u64| random.bits(counter) % end;
        let [first, last] = ONSET;
        // Uniform over the logarithm: durations of 1 to 10 are as frequent as those of 100 to 1000.
        let exponent = below(2, 1000) as f64 / 1000.0;
        let duration = f64::from(DURATION_MAX).powf(exponent).round() as u32;
        let returns = duration < PAUSE && below(3, 6) == 0;
        let class = classes[below(0, classes.len() as u64) as usize];
        // The damage of the supervisor sets it to running: it must not be running yet.
        let onset = match class {
            FaultClass::Ecu(EcuFault::SupervisorDamaged) => below(1, ONSET_EARLY) as u32,
            _ => first + below(1, u64::from(last - first)) as u32,
        };
        Self {
            class,
            onset,
            duration,
            times: if returns { TIMES } else { 1 },
            severity_pct: below(4, 101) as u8,
            rig: below(5, RIGS) as u32,
            seed: random.bits(6) >> 32,
        }
    }

    /// Returns the severity, 0 ..= 1.
    pub fn severity(&self) -> f64 {
        f64::from(self.severity_pct) / 100.0
    }

    /// Returns the first sample after the last fault.
    pub fn end(&self) -> u32 {
        let periods = self.times.saturating_sub(1);
        self.onset + periods * (self.duration + PAUSE) + self.duration
    }

    /// Returns the age of the fault in this sample (samples), from 0; `None` while it is absent.
    pub fn age(&self, sample: u32) -> Option<u32> {
        let since = sample.checked_sub(self.onset)?;
        let period = self.duration + PAUSE;
        let age = since % period;
        (since / period < self.times && age < self.duration).then_some(age)
    }
}

/// Returns the expected behaviour of the loop; a fault that is confirmed too often locks the ECU.
pub(super) fn survival(injection: &Injection) -> Survival {
    match injection.class.survival(injection.duration) {
        Survival::Held if injection.times > RETRIES => Survival::NotClaimed,
        survival => survival,
    }
}

impl fmt::Display for Injection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            class,
            onset,
            duration,
            times,
            rig,
            seed,
            ..
        } = self;
        let severity = self.severity();
        write!(
            f,
            "{class} onset={onset} duration={duration} times={times} severity={severity:.2} rig={rig} seed={seed:#x}"
        )
    }
}

/// Error: a line is no injection.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InjectionError {
    /// The first word is no class.
    #[error(transparent)]
    Class(#[from] ClassError),
    /// A part is missing.
    #[error(
        "`{key}=` is missing; a line reads `sensor/stuck onset=312 duration=80 times=1 severity=0.40 rig=17 seed=0x1234`"
    )]
    Missing {
        /// Missing key.
        key: &'static str,
    },
    /// A value is no number, or out of range.
    #[error("{key}={found} is not {expected}")]
    Value {
        /// Key of the value.
        key: &'static str,
        /// Text that was read.
        found: String,
        /// Allowed value.
        expected: &'static str,
    },
}

/// Longest run that a line can request (samples): an hour.
const SAMPLES_MAX: u32 = 360_000;

impl FromStr for Injection {
    type Err = InjectionError;

    fn from_str(line: &str) -> Result<Self, InjectionError> {
        let mut words = line.split_whitespace();
        let class = words.next().unwrap_or_default().parse()?;
        let parts: Vec<(&str, &str)> = words.filter_map(|word| word.split_once('=')).collect();
        let part = |key: &'static str| {
            let found = parts.iter().find(|(name, _)| *name == key);
            found
                .map(|(_, value)| *value)
                .ok_or(InjectionError::Missing { key })
        };
        let number = |key, expected, min: u32, max: u32| {
            let found = part(key)?;
            let value = found
                .parse()
                .ok()
                .filter(|value| (min..=max).contains(value));
            value.ok_or_else(|| InjectionError::Value {
                key,
                found: found.to_owned(),
                expected,
            })
        };
        let severity = part("severity")?;
        let severity_pct = severity
            .parse()
            .ok()
            .filter(|share: &f64| (0.0..=1.0).contains(share))
            .map(|share| (100.0 * share).round() as u8)
            .ok_or_else(|| InjectionError::Value {
                key: "severity",
                found: severity.to_owned(),
                expected: "a number from 0 to 1",
            })?;
        let seed = part("seed")?;
        let seed_bits = match seed.strip_prefix("0x") {
            Some(digits) => u64::from_str_radix(digits, 16),
            None => seed.parse(),
        };
        Ok(Self {
            class,
            onset: number("onset", "a sample from 0 to 360000", 0, SAMPLES_MAX)?,
            duration: number("duration", "1 to 360000 samples", 1, SAMPLES_MAX)?,
            times: number("times", "a number from 1 to 100", 1, 100)?,
            severity_pct,
            rig: number("rig", "a number of 32 bits", 0, u32::MAX)?,
            seed: seed_bits.map_err(|_| InjectionError::Value {
                key: "seed",
                found: seed.to_owned(),
                expected: "a number of 64 bits, such as 0x1234",
            })?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_drawn_line_reads_back_as_the_same_injection() {
        let classes: Vec<FaultClass> = FaultClass::all().collect();
        for index in 0..2000 {
            let injection = Injection::drawn(&classes, 7, index);
            assert_eq!(injection.to_string().parse(), Ok(injection));
        }
    }

    #[test]
    fn every_class_is_drawn_and_reads_back() {
        let classes: Vec<FaultClass> = FaultClass::all().collect();
        let drawn =
            |class| (0..2000).any(|index| Injection::drawn(&classes, 7, index).class == class);
        for &class in &classes {
            assert_eq!(class.to_string().parse(), Ok(class));
            assert!(drawn(class), "{class}");
        }
    }

    #[test]
    fn a_fault_comes_as_often_and_as_long_as_its_line_says() {
        let line = "sensor/stuck onset=50 duration=7 times=3 severity=0.00 rig=0 seed=0x0";
        let injection: Injection = line.parse().unwrap();
        let ages: Vec<(u32, u32)> = (0..1000)
            .filter_map(|sample| Some((sample, injection.age(sample)?)))
            .collect();
        let expected: Vec<(u32, u32)> = [50, 157, 264]
            .into_iter()
            .flat_map(|onset| (0..7).map(move |age| (onset + age, age)))
            .collect();
        assert_eq!(ages, expected);
        assert_eq!(injection.end(), 271);
    }

    #[test]
    fn what_is_no_line_is_refused_with_the_part_that_is_wrong() {
        let sound = "sensor/stuck onset=50 duration=7 times=3 severity=0.5 rig=0 seed=0x0";
        for (from, to, said) in [
            (
                "sensor/stuck",
                "sensor/bored",
                "no fault class \"sensor/bored\"",
            ),
            ("onset=50 ", "", "`onset=` is missing"),
            (
                "duration=7",
                "duration=0",
                "duration=0 is not 1 to 360000 samples",
            ),
            (
                "severity=0.5",
                "severity=NaN",
                "severity=NaN is not a number from 0 to 1",
            ),
            (
                "seed=0x0",
                "seed=0xfz",
                "seed=0xfz is not a number of 64 bits",
            ),
        ] {
            let error = sound.replace(from, to).parse::<Injection>().unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
    }
}
