//! Coil of a valve (equations 3.2 to 3.6): resistance, an inductance that grows as the armature moves in, and the
//! motional back-EMF i dL/dt.

/// Drive of the coil; constant between two events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// The ECU output is high: the coil has the supply voltage (V) (equation 3.2).
    Energised(f64),
    /// The output is low and the current circulates through the freewheeling diode, whose drop (V) opposes it (equation
    /// 3.5).
    Freewheeling(f64),
    /// The output is low and the current has decayed to zero: the diode blocks.
    Blocked,
}

/// Coil parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Coil {
    /// Resistance (Ω).
    pub resistance: f64,
    /// Inductance with the armature at x = 0 (H), L_off of equation 3.6.
    pub inductance_at_rest: f64,
    /// dL/dx (H/m): (L_on - L_off) over the stroke, equation 3.6.
    pub inductance_slope: f64,
}

impl Coil {
    /// Returns the inductance at armature position `x` (m) (equation 3.6) (H).
    #[inline]
    pub fn inductance(&self, x: f64) -> f64 {
        self.inductance_at_rest + self.inductance_slope * x
    }

    /// Returns di/dt (A/s) with the back-EMF of equation 3.3; `v` is dx/dt (m/s).
    #[inline]
    pub fn current_rate(&self, drive: Drive, current: f64, x: f64, v: f64) -> f64 {
        let Some(voltage) = drive.voltage() else {
            return 0.0;
        };
        (voltage - (self.resistance + self.inductance_slope * v) * current) / self.inductance(x)
    }

    /// Returns the exact current with the armature at rest at `x`, starting from `current` (equation 4.2 and its
    /// freewheeling counterpart).
    #[inline]
    pub fn at_rest(&self, drive: Drive, current: f64, x: f64) -> RestingCurrent {
        match drive.voltage() {
            Some(voltage) => RestingCurrent {
                initial: current,
                steady: voltage / self.resistance,
                time_constant: self.inductance(x) / self.resistance,
            },
            None => RestingCurrent::DECAYED,
        }
    }
}

impl Drive {
    /// Returns the voltage around the loop without the resistive drop (V); `None` if the diode blocks.
    #[inline]
    pub fn voltage(self) -> Option<f64> {
        match self {
            Self::Energised(supply) => Some(supply),
            Self::Freewheeling(drop) => Some(-drop),
            Self::Blocked => None,
        }
    }
}

/// Exponential current with the armature at rest, valid from time 0 on. It ends at zero, where the diode blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestingCurrent {
    initial: f64,
    steady: f64,
    time_constant: f64,
}

impl RestingCurrent {
    pub(crate) const DECAYED: Self = Self {
        initial: 0.0,
        steady: 0.0,
        time_constant: 1.0,
    };

    /// Returns the current at `time` (s) (A).
    #[inline]
    pub fn at(&self, time: f64) -> f64 {
        if self.initial == self.steady {
            return self.steady;
        }
        let decay = (-time / self.time_constant).exp();
        (self.steady + (self.initial - self.steady) * decay).max(0.0)
    }

    /// Returns ∫ i dt from 0 to `time` (s), where the current is already `end` (A s).
    #[inline]
    pub fn charge(&self, time: f64, end: f64) -> f64 {
        let flowing = if end > 0.0 {
            time
        } else {
            time.min(self.zero_time())
        };
        self.steady * flowing + self.time_constant * (self.initial - end)
    }

    /// Returns the time at which a falling current has decayed to zero (s); infinite if it never does.
    fn zero_time(&self) -> f64 {
        if self.steady < 0.0 {
            self.time_constant * (1.0 - self.initial / self.steady).ln()
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coil() -> Coil {
        Coil {
            resistance: 82.2,
            inductance_at_rest: 0.44,
            inductance_slope: 80.0,
        }
    }

    #[test]
    fn charging_is_equation_4_2() {
        let current = coil().at_rest(Drive::Energised(24.0), 0.0, 0.0);
        for time in [0.0, 1e-3, 5e-3, 50e-3] {
            let expected = 24.0 / 82.2 * (1.0 - f64::exp(-82.2 / 0.44 * time));
            assert!((current.at(time) - expected).abs() < 1e-15);
        }
        assert!(
            (current.at(1.0) - 0.291_97).abs() < 1e-5,
            "292 mA, section 4.2.4"
        );
    }

    #[test]
    fn freewheeling_ends_when_the_diode_blocks() {
        let current = coil().at_rest(Drive::Freewheeling(0.8), 0.292, 0.5e-3);
        let end = coil().inductance(0.5e-3) / 82.2 * (1.0 + 0.292 * 82.2 / 0.8_f64).ln();
        assert!(current.at(end * 0.999) > 0.0);
        assert_eq!(current.at(end * 1.001), 0.0);
    }

    /// The charge follows from the flux balance R ∫i dt = ∫u dt - L Δi, independent of events in between.
    #[test]
    fn charge_agrees_with_quadrature_also_after_the_current_decayed() {
        for (drive, start) in [
            (Drive::Energised(24.0), 0.05),
            (Drive::Freewheeling(0.8), 0.2),
            (Drive::Blocked, 0.0),
        ] {
            let current = coil().at_rest(drive, start, 0.0);
            let n = 200_000;
            let span = 40e-3;
            let sum: f64 = (0..n)
                .map(|k| current.at((f64::from(k) + 0.5) / f64::from(n) * span))
                .sum::<f64>()
                * span
                / f64::from(n);
            let exact = current.charge(span, current.at(span));
            assert!((sum - exact).abs() < 1e-9, "{drive:?}: {sum} {exact}");
        }
    }

    /// Motional term: with the flux λ = L(x) i, dλ/dt = u - R i for any motion.
    #[test]
    fn flux_balance_holds_while_the_armature_moves() {
        let coil = coil();
        let (current, x, v) = (0.15, 0.2e-3, 0.4);
        let rate = coil.current_rate(Drive::Energised(24.0), current, x, v);
        let flux_rate = coil.inductance(x) * rate + coil.inductance_slope * v * current;
        assert!((flux_rate - (24.0 - 82.2 * current)).abs() < 1e-12);
    }
}
