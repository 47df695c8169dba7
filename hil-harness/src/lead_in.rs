//! Lead-in: the time before time 0.
//!
//! After a reset an ECU fills nothing until the reference was zero. Therefore a run begins like a drive: the ECU starts
//! with a chamber at ambient pressure and a reference of zero. If the scenario starts from another pressure, the loop
//! then fills the chamber to it. Time 0 follows, with the chamber at exactly the scenario's start pressure. Nothing
//! before time 0 is recorded or judged, so a check has the same meaning as without a lead-in.

/// References before time 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadIn {
    start_bar: f64,
    fill_samples: u32,
}

/// Duration of the reference of zero (samples): twice what the ECU requires.
const ZERO_SAMPLES: u32 = 20;
/// Time for the loop to reach the start pressure (s): four times T_req.
const FILL_S: f64 = 2.0;

impl LeadIn {
    /// Creates the lead-in of a scenario that starts from `start_bar` (bar gauge), with an ECU that samples every
    /// `sample_time_s` (s).
    pub(crate) fn to(start_bar: f64, sample_time_s: f64) -> Self {
        Self {
            start_bar,
            fill_samples: (FILL_S / sample_time_s).ceil() as u32,
        }
    }

    /// Returns its duration (samples).
    pub fn samples(self) -> u32 {
        if self.start_bar > 0.0 {
            ZERO_SAMPLES + self.fill_samples
        } else {
            ZERO_SAMPLES
        }
    }

    /// Returns the reference at one of its samples (bar gauge).
    pub fn reference_bar(self, sample: u32) -> f64 {
        if sample < ZERO_SAMPLES {
            0.0
        } else {
            self.start_bar
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_is_zero_first_and_then_the_start() {
        let lead_in = LeadIn::to(3.5, 0.01);
        let references: Vec<f64> = (0..lead_in.samples())
            .map(|sample| lead_in.reference_bar(sample))
            .collect();
        assert_eq!(references[..20], [0.0; 20]);
        assert_eq!(references[20..], [3.5; 200]);
        assert_eq!(LeadIn::to(3.5, 0.001).samples(), 2020);
        assert_eq!(LeadIn::to(0.0, 0.01).samples(), 20);
    }
}
