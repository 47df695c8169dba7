//! Signals used by the checkers, on one even grid of samples.

use recording::{ConversionError, MissingSignal, Quantity, Recording, Unit};

/// Signals of a closed loop, all of one length, without gaps.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    /// Instant of each sample (s).
    pub(super) times_s: Vec<f64>,
    /// Sample time (s).
    pub(super) sample_s: f64,
    /// Reference (bar gauge).
    pub(super) reference: Vec<f64>,
    /// Chamber pressure (bar gauge).
    pub(super) pressure: Vec<f64>,
    /// Duty cycles of fill and vent valve (%).
    pub(super) duty: [Vec<f64>; 2],
    /// Number of lifts of fill and vent valve until each sample, if logged.
    pub(super) actuations: Option<[Vec<f64>; 2]>,
}

/// Reason why a recording cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JudgeError {
    /// A signal is missing, or has another quantity.
    #[error(transparent)]
    Signal(#[from] MissingSignal),
    /// A pressure is not gauge.
    #[error(transparent)]
    Unit(#[from] ConversionError),
    /// A signal has gaps.
    #[error(
        "{missing} of {samples} samples of {name:?} are missing: judge a part of the log without gaps"
    )]
    MissingSamples {
        /// Name of the signal.
        name: &'static str,
        /// Number of missing samples.
        missing: usize,
        /// Number of all samples.
        samples: usize,
    },
    /// Two signals have different time bases.
    #[error("{name:?} is sampled at other instants than p_ref: resample it first")]
    OtherTimeBase {
        /// Name of the signal.
        name: &'static str,
    },
    /// The samples are not even, but they are the unit of the requirement.
    #[error("p_ref is not evenly sampled: the requirement counts samples, log every ECU period")]
    Uneven,
}

impl Trajectory {
    pub(super) fn of(recording: &Recording) -> Result<Self, JudgeError> {
        let grid = recording.require("p_ref", Quantity::Pressure)?.time_base();
        let base = recording.time_base_of("p_ref").ok_or(JudgeError::Uneven)?;
        let sampling = base.sampling();
        if sampling.uneven || !sampling.gaps.is_empty() {
            return Err(JudgeError::Uneven);
        }
        let signal = |name: &'static str, quantity, unit| {
            let signal = recording.require(name, quantity)?;
            if signal.time_base() != grid {
                return Err(JudgeError::OtherTimeBase { name });
            }
            match signal.missing_count() {
                0 => Ok(signal.values_in(unit)?),
                missing => Err(JudgeError::MissingSamples {
                    name,
                    missing,
                    samples: signal.len(),
                }),
            }
        };
        let pressure = |name| signal(name, Quantity::Pressure, Unit::BarGauge);
        let duty = |name| signal(name, Quantity::DutyCycle, Unit::Percent);
        let count = |name| signal(name, Quantity::Count, Unit::Count);
        let counted = recording.signal("actuations_fill").is_some();
        Ok(Self {
            times_s: base.times_s().to_vec(),
            sample_s: sampling.median_step_s.ok_or(JudgeError::Uneven)?,
            reference: pressure("p_ref")?,
            pressure: pressure("p_ch")?,
            duty: [duty("duty_fill")?, duty("duty_vent")?],
            actuations: if counted {
                Some([count("actuations_fill")?, count("actuations_vent")?])
            } else {
                None
            },
        })
    }

    pub(super) fn len(&self) -> usize {
        self.reference.len()
    }

    pub(super) fn time_s(&self, index: usize) -> f64 {
        self.times_s[index]
    }
}
