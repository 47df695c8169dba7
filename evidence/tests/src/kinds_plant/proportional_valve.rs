//! Proportional valve: a spool that follows the command with a lag, and its characteristic.

/// Positions of the points of a characteristic, as shares of the way from the end of the dead zone to 100 %.
const QUARTERS: f64 = 4.0;

/// Characteristic of a proportional valve, and the lag of its spool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Characteristic {
    /// Position of the spool up to which the valve is closed (%): its dead zone.
    pub opens_at_pct: f64,
    /// Open shares of the conductance at 1/4, 1/2 and 3/4 of the way from there to 100 %, linear between.
    pub quarter_shares: [f64; 3],
    /// Time constant of the first-order lag of the spool (s); positive.
    pub time_constant_s: f64,
}

impl Characteristic {
    /// Returns the open share at a position of the spool (%).
    pub(super) fn open_share(&self, position_pct: f64) -> f64 {
        let way = (position_pct - self.opens_at_pct) / (100.0 - self.opens_at_pct);
        let quarters = QUARTERS * way.clamp(0.0, 1.0);
        let [first, half, third] = self.quarter_shares;
        let shares = [0.0, first, half, third, 1.0];
        let below = (quarters as usize).min(3);
        shares[below] + (shares[below + 1] - shares[below]) * (quarters - below as f64)
    }
}

/// Proportional valve that moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ProportionalValve {
    characteristic: Characteristic,
    command_pct: f64,
    /// Time of the last command (s), and the position of the spool then (%).
    since_s: f64,
    position_pct: f64,
}

impl ProportionalValve {
    pub(super) fn new(characteristic: Characteristic) -> Self {
        Self {
            characteristic,
            command_pct: 0.0,
            since_s: 0.0,
            position_pct: 0.0,
        }
    }

    pub(super) fn command(&mut self, time_s: f64, command_pct: f64) {
        if command_pct != self.command_pct {
            self.position_pct = self.position_pct(time_s);
            self.since_s = time_s;
            self.command_pct = command_pct;
        }
    }

    fn position_pct(&self, time_s: f64) -> f64 {
        let left = (-(time_s - self.since_s) / self.characteristic.time_constant_s).exp();
        self.command_pct + (self.position_pct - self.command_pct) * left
    }

    /// Returns the open share at a time (s), 0 to 1; valid until the next command.
    pub(super) fn open_share(&self, time_s: f64) -> f64 {
        self.characteristic.open_share(self.position_pct(time_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: Characteristic = Characteristic {
        opens_at_pct: 20.0,
        quarter_shares: [0.15, 0.4, 0.7],
        time_constant_s: 20e-3,
    };

    #[test]
    fn the_characteristic_has_a_dead_zone_and_meets_its_points() {
        for (position_pct, share) in [
            (0.0, 0.0),
            (20.0, 0.0),
            (30.0, 0.075),
            (40.0, 0.15),
            (60.0, 0.4),
            (70.0, 0.55),
            (100.0, 1.0),
        ] {
            let found = VALVE.open_share(position_pct);
            assert!((found - share).abs() < 1e-12, "{position_pct}: {found}");
        }
    }

    #[test]
    fn the_spool_follows_with_its_lag_before_the_characteristic() {
        let mut valve = ProportionalValve::new(VALVE);
        valve.command(0.1, 60.0);
        let reached_pct = 60.0 * (1.0 - (-1.0_f64).exp());
        let share = valve.open_share(0.12);
        assert!((share - VALVE.open_share(reached_pct)).abs() < 1e-12);
        valve.command(0.12, 0.0);
        let back_pct = reached_pct * (-0.5_f64).exp();
        assert!((valve.open_share(0.13) - VALVE.open_share(back_pct)).abs() < 1e-12);
    }
}
