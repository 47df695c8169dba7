//! Eddy currents in the iron: one loop around the whole flux, referred to the coil (E45).

/// Loop of the eddy currents; the default has none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EddyLoop {
    /// Conductance (1/Ω); 0 without eddy currents.
    pub conductance: f64,
    /// Stray inductance per resistance of the loop (s): without one, the eddy current follows the voltage at once.
    pub time_constant: f64,
}

impl EddyLoop {
    /// Returns whether there are eddy currents.
    pub(crate) fn is_there(&self) -> bool {
        self.conductance > 0.0
    }

    /// Returns whether the eddy current is a state of its own.
    pub(crate) fn is_state(&self) -> bool {
        self.is_there() && self.time_constant > 0.0
    }

    /// Returns the part of the conductance (1/Ω) that follows the voltage at once.
    #[inline]
    pub(crate) fn conductance_at_once(&self) -> f64 {
        if self.time_constant > 0.0 {
            0.0
        } else {
            self.conductance
        }
    }

    /// Returns the rate (A/s) of an eddy current under the voltage `flux_rate` around the flux (V).
    #[inline]
    pub(crate) fn rate(&self, flux_rate: f64, eddy_current: f64) -> f64 {
        (self.conductance * flux_rate - eddy_current) / self.time_constant
    }

    /// Returns dλ/dt (V) of a coil whose diode blocks: the eddy current carries the whole `magnetising` current (A) of
    /// the flux linkage `flux` (V s).
    #[inline]
    pub(crate) fn flux_rate_without_coil(&self, flux: f64, magnetising: f64) -> f64 {
        -magnetising / (self.conductance + self.time_constant * magnetising / flux)
    }
}
