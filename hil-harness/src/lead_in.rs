//! What happens before time 0.
//!
//! After a reset an ECU fills nothing until it has seen the reference at zero. A run therefore begins as a drive does: the ECU
//! starts beside a chamber at ambient pressure and is told zero; if the scenario starts from another pressure, the loop then
//! fills the chamber to it by itself. Only then comes time 0, with the chamber at exactly the scenario's start.
//! Nothing before time 0 is recorded or judged, so a check means what it meant without a lead-in.

/// What is asked of the loop before time 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadIn {
    start_bar: f64,
    fill_samples: u32,
}

/// The reference is zero for this long \[samples\]: twice what the ECU wants to see.
const ZERO_SAMPLES: u32 = 20;
/// The loop has this long to reach the start \[s\]: four times T_req.
const FILL_S: f64 = 2.0;

impl LeadIn {
    /// Of a scenario that starts from `start_bar` [bar gauge], with an ECU that samples every `sample_time_s` \[s\].
    pub(crate) fn to(start_bar: f64, sample_time_s: f64) -> Self {
        Self {
            start_bar,
            fill_samples: (FILL_S / sample_time_s).ceil() as u32,
        }
    }

    /// How long it takes \[samples\].
    pub fn samples(self) -> u32 {
        if self.start_bar > 0.0 {
            ZERO_SAMPLES + self.fill_samples
        } else {
            ZERO_SAMPLES
        }
    }

    /// The reference at one of its samples [bar gauge].
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
