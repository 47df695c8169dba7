//! Coil with effects: its state is the flux linkage, from which the current follows.
//!
//! ```text
//! dλ/dt = u - R i        i = (i_m(λ, x) + u/R_e) / (1 + R/R_e)
//! ```
//!
//! i_m is the magnetising current (λ/L without saturation), R_e the loop of the eddy currents. Energised coils share
//! the resistance of the supply.

use crate::coil::Drive;
use crate::plant::Plant;

/// Coil at an instant.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CoilNow {
    /// Current at the terminals (A).
    pub(super) current: f64,
    /// dλ/dt (V).
    pub(super) flux_rate: f64,
}

/// Returns the current (A) that causes the magnetic force: λ/L of the plain coil, because the force depends on the
/// flux.
#[inline]
pub(super) fn pulling_current(plant: &Plant, index: usize, flux: f64, x: f64) -> f64 {
    flux / plant.valves[index].coil.inductance(x)
}

/// Returns the magnetising current (A).
#[inline]
pub(super) fn magnetising_current(plant: &Plant, index: usize, flux: f64, x: f64) -> f64 {
    let inductance = plant.valves[index].coil.inductance(x);
    match &plant.additions.saturation {
        Some(saturation) => saturation.current(flux, inductance),
        None => flux / inductance,
    }
}

/// Returns the resistance of the current's loop (Ω), without the shared part.
#[inline]
pub(super) fn loop_resistance(plant: &Plant, index: usize, drive: Drive) -> f64 {
    let coil = plant.valves[index].coil.resistance;
    match drive {
        Drive::Freewheeling(_) => coil + plant.additions.freewheeling_resistance,
        Drive::Energised(_) => coil + plant.additions.switch_resistance,
        Drive::Blocked => coil,
    }
}

/// Returns both coils at an instant: `coils` gives drive, magnetising current and additional voltage of each; `None`
/// for a coil that is not integrated.
#[inline]
pub(super) fn coils_now(plant: &Plant, coils: [Option<(Drive, f64, f64)>; 2]) -> [CoilNow; 2] {
    let additions = &plant.additions;
    let eddy = additions.eddy_conductance;
    let divisor = |index, drive| 1.0 + loop_resistance(plant, index, drive) * eddy;

    // The total current of all energised coils gives the drop at the shared resistance.
    let mut drop = 0.0;
    if additions.supply_resistance > 0.0 {
        let (mut taken, mut conductance) = (0.0, 0.0);
        for (index, coil) in coils.iter().enumerate() {
            if let Some((drive @ Drive::Energised(voltage), magnetising, more)) = *coil {
                let divisor = divisor(index, drive);
                taken += (magnetising + (voltage + more) * eddy) / divisor;
                conductance += eddy / divisor;
            }
        }
        let shared = additions.supply_resistance;
        drop = shared * taken / (1.0 + shared * conductance);
    }

    let mut now = [CoilNow::default(); 2];
    for (index, coil) in coils.into_iter().enumerate() {
        let Some((drive, magnetising, more)) = coil else {
            continue;
        };
        now[index] = match drive.voltage() {
            Some(voltage) => {
                let shared = if matches!(drive, Drive::Energised(_)) {
                    drop
                } else {
                    0.0
                };
                let voltage = voltage + more - shared;
                let resistance = loop_resistance(plant, index, drive);
                let current = (magnetising + voltage * eddy) / divisor(index, drive);
                CoilNow {
                    current,
                    flux_rate: voltage - resistance * current,
                }
            }
            // The eddy currents alone carry the flux.
            None if eddy > 0.0 => CoilNow {
                current: 0.0,
                flux_rate: -magnetising / eddy,
            },
            None => CoilNow::default(),
        };
    }
    now
}
