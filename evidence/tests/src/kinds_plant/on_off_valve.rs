//! On/off valve: delays that a command must outlast, then linear ramps.

/// Switching times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwitchingTimes {
    /// Time for which the command must stand before the valve begins to open (s).
    pub opening_delay_s: f64,
    /// Time for which the command must be away before the valve begins to close (s).
    pub closing_delay_s: f64,
    /// Time from closed to open (s); positive.
    pub opening_ramp_s: f64,
    /// Time from open to closed (s); positive.
    pub closing_ramp_s: f64,
}

/// On/off valve that moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OnOffValve {
    times: SwitchingTimes,
    is_commanded: bool,
    /// Time at which it begins to follow the command, if it does not yet (s).
    follows_s: Option<f64>,
    opens: bool,
    /// Time at which the present movement began (s), and the open share then.
    since_s: f64,
    share: f64,
}

impl OnOffValve {
    pub(super) fn new(times: SwitchingTimes) -> Self {
        Self {
            times,
            is_commanded: false,
            follows_s: None,
            opens: false,
            since_s: 0.0,
            share: 0.0,
        }
    }

    /// Switches the command at a time (s), with the opening delay times `opening`. A command that is back before its delay has passed
    /// moves nothing.
    pub(super) fn command(&mut self, time_s: f64, is_on: bool, opening: f64) {
        if is_on == self.is_commanded {
            return;
        }
        self.is_commanded = is_on;
        let delay_s = if is_on {
            opening * self.times.opening_delay_s
        } else {
            self.times.closing_delay_s
        };
        self.follows_s = (is_on != self.opens).then_some(time_s + delay_s);
    }

    fn rate(&self) -> f64 {
        if self.opens {
            1.0 / self.times.opening_ramp_s
        } else {
            -1.0 / self.times.closing_ramp_s
        }
    }

    /// Returns the open share at a time (s), 0 to 1; valid until the next event.
    pub(super) fn open_share(&self, time_s: f64) -> f64 {
        (self.share + self.rate() * (time_s - self.since_s)).clamp(0.0, 1.0)
    }

    /// Returns the next time (s) after `time_s` at which the law of the share changes.
    pub(super) fn next_event_s(&self, time_s: f64) -> f64 {
        let stop = f64::from(u8::from(self.opens));
        let ramp_end_s = self.since_s + (stop - self.share) / self.rate();
        let after = |event_s: f64| event_s > time_s;
        let ramp_end_s = Some(ramp_end_s).filter(|end_s| after(*end_s));
        let events = [self.follows_s, ramp_end_s].into_iter().flatten();
        events.fold(f64::INFINITY, f64::min)
    }

    /// Begins to follow the command if it has stood for its delay at `time_s`.
    pub(super) fn pass(&mut self, time_s: f64) {
        if self.follows_s.is_some_and(|follows_s| follows_s <= time_s) {
            self.share = self.open_share(time_s);
            self.since_s = time_s;
            self.opens = self.is_commanded;
            self.follows_s = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: SwitchingTimes = SwitchingTimes {
        opening_delay_s: 6e-3,
        closing_delay_s: 5e-3,
        opening_ramp_s: 3e-3,
        closing_ramp_s: 2e-3,
    };

    /// Returns the open share at `end_s` after commands at these times.
    fn share(commands: &[(f64, bool)], end_s: f64) -> f64 {
        let mut valve = OnOffValve::new(TIMES);
        let mut time_s = 0.0;
        let ends = commands.iter().skip(1).map(|(at, _)| *at).chain([end_s]);
        for (&(at_s, is_on), end_s) in commands.iter().zip(ends) {
            valve.command(at_s, is_on, 1.0);
            time_s = f64::max(time_s, at_s);
            while valve.next_event_s(time_s) <= end_s {
                time_s = valve.next_event_s(time_s);
                valve.pass(time_s);
            }
        }
        valve.open_share(end_s)
    }

    #[test]
    fn it_moves_on_its_ramps_behind_its_delays() {
        let pulse = [(0.0, true), (20e-3, false)];
        for (time_s, expected) in [
            (5.9e-3, 0.0),
            (7.5e-3, 0.5),
            (9.5e-3, 1.0),
            (24.9e-3, 1.0),
            (26e-3, 0.5),
            (27.1e-3, 0.0),
        ] {
            let commands = if time_s < 20e-3 { &pulse[..1] } else { &pulse };
            let found = share(commands, time_s);
            assert!((found - expected).abs() < 1e-9, "{time_s}: {found}");
        }
    }

    #[test]
    fn a_pulse_or_a_pause_shorter_than_its_delay_does_nothing() {
        assert_eq!(share(&[(0.0, true), (5.9e-3, false)], 30e-3), 0.0);
        let pause = [(0.0, true), (20e-3, false), (24.9e-3, true)];
        assert_eq!(share(&pause, 26e-3), 1.0);
        assert_eq!(share(&pause, 60e-3), 1.0);
    }

    #[test]
    fn a_movement_goes_on_until_the_next_command_has_stood_for_its_delay() {
        // It begins to open at 6 ms and is back at 12.5 ms.
        let pulse = [(0.0, true), (7.5e-3, false)];
        assert_eq!(share(&pulse, 12.4e-3), 1.0);
        assert!((share(&pulse, 13.5e-3) - 0.5).abs() < 1e-9);
    }
}
