//! Flux linkage of a coil, and its current.
//!
//! Faraday: dλ/dt = u - R i. Magnetic circuit: i = λ/L(x), with 1/L (the reluctance over N²) linear in the position.
//! Saturated iron needs more current, and so do eddy currents, which oppose the change of the flux.

use super::departures::CoilDepartures;
use super::rig::Rig;

/// Coil of one valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coil {
    /// Resistance at 20 °C (ohm) and its temperature coefficient (1/K).
    resistance: f64,
    coefficient: f64,
    /// 1/L at the rest stop (1/H) and its slope over the position (1/(H m)).
    reluctance: f64,
    reluctance_slope: f64,
    /// F = (c0 + c1 x) λ².
    force: f64,
    force_slope: f64,
    /// Flux linkage at rated current at the rest stop (Vs).
    rated_flux: f64,
}

/// Source of a coil's voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    /// Energised with this voltage (V).
    On(f64),
    /// Freewheeling against this voltage (V) and this resistance (ohm).
    Off(f64, f64),
}

/// Coil at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CoilRates {
    /// Current through the winding (A).
    pub(super) current: f64,
    /// Voltage that changes the flux (V).
    pub(super) flux: f64,
    /// Rate of the eddy currents (A/s).
    pub(super) eddy: f64,
}

impl Coil {
    pub(super) fn new(rig: &Rig) -> Self {
        let sheet = &rig.datasheet;
        let (closed, open) = (sheet.coil.inductance_closed_h, sheet.coil.inductance_open_h);
        let stroke = sheet.armature.stroke_m;
        // The law of the datasheet, c i²/(g - x)², is exact at both stops; between them it is linear here.
        let force = |inductance: f64, gap: f64| {
            sheet.magnet.force_constant_n_m2_per_a2 / (inductance * gap).powi(2)
        };
        let at_rest = force(closed, sheet.magnet.gap_closed_m);
        let at_full = force(open, sheet.magnet.gap_closed_m - stroke);
        Self {
            resistance: sheet.coil.resistance_20c_ohm,
            coefficient: sheet.coil.resistance_temperature_coefficient_per_k,
            reluctance: 1.0 / closed,
            reluctance_slope: (1.0 / open - 1.0 / closed) / stroke,
            force: at_rest,
            force_slope: (at_full - at_rest) / stroke,
            rated_flux: closed * sheet.ecu.supply_voltage_v / sheet.coil.resistance_20c_ohm,
        }
    }

    /// Returns the force of the magnet (N).
    pub(super) fn force(&self, flux: f64, position: f64) -> f64 {
        (self.force + self.force_slope * position) * flux * flux
    }

    /// Returns the resistance (ohm) at a temperature above 20 °C (K).
    pub(super) fn resistance(&self, over_20c: f64) -> f64 {
        self.resistance * (1.0 + self.coefficient * over_20c)
    }

    /// Returns the current that the flux needs without eddy currents (A).
    pub(super) fn magnetising(&self, iron: &CoilDepartures, flux: f64, position: f64) -> f64 {
        let linear = flux * (self.reluctance + self.reluctance_slope * position);
        if iron.saturation == 0.0 && iron.knee == 0.0 {
            return linear;
        }
        let share = flux / self.rated_flux;
        linear
            * (1.0 + iron.saturation * share.powi(iron.saturation_power))
            * (1.0 + iron.knee * share.powi(iron.knee_power))
            / (1.0 + iron.saturation)
    }

    /// Returns current and rates. `magnetising` is the current that the flux needs, `resistance` that of the warm
    /// winding.
    pub(super) fn rates(
        &self,
        iron: &CoilDepartures,
        [flux, eddy]: [f64; 2],
        magnetising: f64,
        resistance: f64,
        source: Source,
    ) -> CoilRates {
        // With an eddy conductance G: i = i_m + G dλ/dt without lag, or i = i_m + e with e following G dλ/dt.
        let (voltage, series) = match source {
            Source::On(voltage) => (voltage, 0.0),
            Source::Off(voltage, series) => (-voltage, series),
        };
        let total = resistance + series;
        let at_once = if iron.eddy_lag_s == 0.0 {
            iron.eddy_s
        } else {
            0.0
        };
        let current = (magnetising + eddy + at_once * voltage) / (1.0 + at_once * total);
        if current <= 0.0 && matches!(source, Source::Off(..)) {
            return Self::blocked(iron, flux, magnetising);
        }
        let rate = voltage - total * current;
        CoilRates {
            current,
            flux: rate,
            eddy: if iron.eddy_lag_s == 0.0 {
                0.0
            } else {
                (iron.eddy_s * rate - eddy) / iron.eddy_lag_s
            },
        }
    }

    /// Returns the rates while the diode blocks: the remaining flux decays with the eddy currents alone, which then
    /// carry all current.
    fn blocked(iron: &CoilDepartures, flux: f64, magnetising: f64) -> CoilRates {
        if iron.eddy_s == 0.0 || flux <= 0.0 {
            return CoilRates {
                current: 0.0,
                flux: 0.0,
                eddy: 0.0,
            };
        }
        let reluctance = magnetising / flux;
        let rate = -magnetising / (iron.eddy_s + iron.eddy_lag_s * reluctance);
        CoilRates {
            current: 0.0,
            flux: rate,
            eddy: if iron.eddy_lag_s == 0.0 {
                0.0
            } else {
                -reluctance * rate
            },
        }
    }
}
