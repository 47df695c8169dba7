//! Mean of a coil current since its sample before, where other signals have rows in between.

/// Mean current of one coil since its last sampled row.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MeanCurrent {
    /// Instant of the last row (ns).
    last_ns: u64,
    /// Time (ns) and charge (A ns) of the rows since the last sampled one.
    since_ns: u64,
    charge: f64,
}

impl MeanCurrent {
    /// Returns the mean current (A) at the row at `time_ns`, since the last sampled row. `mean` is the mean since the
    /// last row. The current is `sampled` at this row or not.
    pub(super) fn at_row(&mut self, mean: f64, time_ns: u64, sampled: bool) -> f64 {
        let step_ns = time_ns.saturating_sub(self.last_ns);
        self.last_ns = time_ns;
        let of_sample = match self.since_ns {
            0 => mean,
            since_ns => (self.charge + mean * step_ns as f64) / (since_ns + step_ns) as f64,
        };
        if sampled {
            (self.since_ns, self.charge) = (0, 0.0);
        } else {
            self.since_ns += step_ns;
            self.charge += mean * step_ns as f64;
        }
        of_sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_a_sample_add_to_the_mean_of_the_next_one() {
        let mut current = MeanCurrent::default();
        assert_eq!(current.at_row(1.0, 10, true), 1.0);
        current.at_row(2.0, 20, false);
        current.at_row(4.0, 40, false);
        // (2 * 10 + 4 * 20 + 5 * 10) / 40
        assert_eq!(current.at_row(5.0, 50, true), 3.75);
        assert_eq!(current.at_row(7.0, 60, true), 7.0);
    }
}
