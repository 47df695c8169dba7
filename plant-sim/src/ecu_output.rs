//! Output stage of the ECU (section 3.2, equation 3.1): commands take effect after the command delay, and each PWM
//! period is high for the duty cycle that is valid when it begins.
//!
//! All instants are integer nanoseconds, so that edges never depend on rounding or on the order of events. At one
//! instant a command takes effect before a period begins. A command that arrives late changes the running period,
//! because the instants of a log are known to some microseconds only.

use std::collections::VecDeque;

/// Duty cycles commanded to the two valves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Duty cycle of the fill valve (%), 0 to 100.
    pub duty_fill_pct: f64,
    /// Duty cycle of the vent valve (%), 0 to 100.
    pub duty_vent_pct: f64,
}

impl Command {
    fn duty_pct(self) -> [f64; 2] {
        [self.duty_fill_pct, self.duty_vent_pct]
    }
}

/// The two PWM outputs, fill and vent, on a common time grid.
#[derive(Debug, Clone)]
pub struct EcuOutput {
    period_ns: u64,
    delay_ns: u64,
    /// Beginning of the running period, if one has begun.
    period_begin_ns: Option<u64>,
    next_period_ns: u64,
    /// Delayed commands, with the instant at which they take effect.
    pending: VecDeque<(u64, Command)>,
    in_force: Command,
    /// End of the high phase of the running period; in the past while the output is low.
    high_until_ns: [u64; 2],
}

impl EcuOutput {
    /// Creates outputs with PWM of `period_ns`; commands are delayed by `delay_ns`, periods begin at the delayed sample
    /// instants.
    pub fn new(period_ns: u64, delay_ns: u64) -> Self {
        Self {
            period_ns,
            delay_ns,
            period_begin_ns: None,
            next_period_ns: delay_ns,
            pending: VecDeque::new(),
            in_force: Command::default(),
            high_until_ns: [0; 2],
        }
    }

    /// Accepts a command given at `given_ns`; one that was in force when the running period began applies to it from now
    /// on. A duty cycle below 0 or NaN is 0 %, one above 100 is 100 %.
    pub fn command(&mut self, given_ns: u64, command: Command) {
        self.pending.push_back((given_ns + self.delay_ns, command));
        if let Some(begin_ns) = self.period_begin_ns {
            self.begin_period(begin_ns);
        }
    }

    /// Returns the next instant after `now_ns` at which an output may change.
    pub fn next_edge_ns(&self, now_ns: u64) -> u64 {
        self.high_until_ns
            .into_iter()
            .filter(|&edge| edge > now_ns)
            .fold(self.next_period_ns, u64::min)
    }

    /// Returns the duty cycles (%) in force, fill and vent.
    pub fn in_force_pct(&self) -> [f64; 2] {
        self.in_force.duty_pct()
    }

    /// Updates the outputs to `now_ns`, which is not beyond the next edge, and returns which are high (fill, vent) from
    /// now on.
    pub fn update(&mut self, now_ns: u64) -> [bool; 2] {
        if now_ns == self.next_period_ns {
            self.begin_period(now_ns);
            // A plant without valves has no PWM: its period never ends.
            self.next_period_ns = self.next_period_ns.saturating_add(self.period_ns);
        }
        self.high_until_ns.map(|edge| edge > now_ns)
    }

    /// Begins the period of `begin_ns` with the last command that had taken effect by then.
    fn begin_period(&mut self, begin_ns: u64) {
        self.period_begin_ns = Some(begin_ns);
        while let Some(&(effective_ns, command)) = self.pending.front()
            && effective_ns <= begin_ns
        {
            self.in_force = command;
            self.pending.pop_front();
        }
        self.high_until_ns = self.in_force.duty_pct().map(|duty_pct| {
            // Rounding to a nanosecond is negligible: a tick of any timer is much longer.
            let share = (duty_pct / 100.0).clamp(0.0, 1.0);
            begin_ns.saturating_add((share * self.period_ns as f64).round() as u64)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    /// Runs the outputs over `until_ns` and returns their edges (instant, fill, vent).
    fn edges(
        output: &mut EcuOutput,
        commands: &[(u64, f64, f64)],
        until_ns: u64,
    ) -> Vec<(u64, bool, bool)> {
        let mut edges = vec![(0, false, false)];
        let mut now = 0;
        let mut commands = commands.iter().peekable();
        while now < until_ns {
            while let Some(&&(at, duty_fill_pct, duty_vent_pct)) = commands.peek()
                && at <= now
            {
                output.command(
                    now,
                    Command {
                        duty_fill_pct,
                        duty_vent_pct,
                    },
                );
                commands.next();
            }
            let [fill, vent] = output.update(now);
            if edges.last().is_none_or(|&(_, f, v)| (f, v) != (fill, vent)) {
                edges.push((now, fill, vent));
            }
            let next_command = commands.peek().map_or(u64::MAX, |c| c.0);
            now = output.next_edge_ns(now).min(next_command);
        }
        edges
    }

    #[test]
    fn a_period_is_high_for_the_duty_cycle_after_the_delay() {
        let mut output = EcuOutput::new(10 * MS, 15 * MS);
        let edges = edges(
            &mut output,
            &[(0, 60.0, 0.0), (10 * MS, 0.0, 25.0), (20 * MS, 0.0, 0.0)],
            60 * MS,
        );
        assert_eq!(
            edges,
            [
                (0, false, false),
                (15 * MS, true, false),
                (21 * MS, false, false),
                (25 * MS, false, true),
                (27 * MS + MS / 2, false, false),
            ]
        );
    }

    #[test]
    fn without_a_pwm_period_nothing_is_ever_high() {
        let mut output = EcuOutput::new(u64::MAX, 3 * MS);
        assert_eq!(edges(&mut output, &[], 100 * MS), [(0, false, false)]);
        assert_eq!(output.next_edge_ns(3 * MS), u64::MAX);
    }

    #[test]
    fn full_duty_has_no_edge_and_zero_duty_no_pulse() {
        let mut output = EcuOutput::new(10 * MS, 0);
        let edges = edges(
            &mut output,
            &[(0, 100.0, 0.0), (30 * MS, 0.0, 100.0)],
            100 * MS,
        );
        assert_eq!(
            edges,
            [(0, false, false), (0, true, false), (30 * MS, false, true)]
        );
    }

    /// Defect seen: the clock of a log was wrong by 50 µs, and the last row before a sample of the ECU seemed to come after
    /// it. Without a command delay, the next command lost a whole period.
    #[test]
    fn a_command_that_is_accepted_late_changes_the_running_period() {
        let mut output = EcuOutput::new(10 * MS, 0);
        assert_eq!(output.update(0), [false, false]);
        let late = Command {
            duty_fill_pct: 40.0,
            duty_vent_pct: 0.0,
        };
        output.command(0, late);
        assert_eq!(output.update(MS), [true, false]);
        assert_eq!(output.next_edge_ns(MS), 4 * MS);
        let later = Command::default();
        output.command(1, later);
        assert_eq!(output.update(2 * MS), [true, false]);
        assert_eq!(output.update(4 * MS), [false, false]);
        assert_eq!(output.update(10 * MS), [false, false]);
    }

    #[test]
    fn a_command_between_periods_waits_for_the_next_period() {
        let mut output = EcuOutput::new(8 * MS, 3 * MS);
        let edges = edges(
            &mut output,
            &[(0, 50.0, 0.0), (10 * MS, 25.0, 0.0)],
            30 * MS,
        );
        assert_eq!(
            edges,
            [
                (0, false, false),
                (3 * MS, true, false),
                (7 * MS, false, false),
                (11 * MS, true, false),
                (15 * MS, false, false),
                (19 * MS, true, false),
                (21 * MS, false, false),
                (27 * MS, true, false),
                (29 * MS, false, false),
            ]
        );
    }
}
