//! Coil with effects: its state is the flux linkage, from which the current follows.
//!
//! ```text
//! dλ/dt = u - R i        i = (i_m(λ, x) + u/R_e) / (1 + R/R_e)
//! ```
//!
//! i_m is the magnetising current (λ/L without saturation), R_e the loop of the eddy currents. With a stray inductance
//! in that loop, the eddy current is a state: i = i_m + i_e. Energised coils share the resistance of the supply.

use crate::coil::Drive;
use crate::plant::Plant;

/// State and drive of a coil, from which its current follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct CoilState {
    pub(super) drive: Drive,
    /// Flux linkage (V s).
    pub(super) flux: f64,
    /// Magnetising current (A).
    pub(super) magnetising: f64,
    /// Eddy current (A), where it is a state.
    pub(super) eddy: f64,
    /// Voltage beside that of the drive (V).
    pub(super) additional_voltage: f64,
}

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

/// Returns both coils at an instant; `None` for a coil that is not integrated.
#[inline]
pub(super) fn coils_now(plant: &Plant, coils: [Option<CoilState>; 2]) -> [CoilNow; 2] {
    let additions = &plant.additions;
    let eddy_loop = &additions.eddy_loop;
    let at_once = eddy_loop.conductance_at_once();
    let divisor = |index, drive| 1.0 + loop_resistance(plant, index, drive) * at_once;

    // The total current of all energised coils gives the drop at the shared resistance.
    let mut drop = 0.0;
    if additions.supply_resistance > 0.0 {
        let (mut taken, mut conductance) = (0.0, 0.0);
        for (index, coil) in coils.iter().enumerate() {
            let Some(coil) = coil else { continue };
            if let Drive::Energised(voltage) = coil.drive {
                let divisor = divisor(index, coil.drive);
                let voltage = voltage + coil.additional_voltage;
                taken += (coil.magnetising + coil.eddy + voltage * at_once) / divisor;
                conductance += at_once / divisor;
            }
        }
        let shared = additions.supply_resistance;
        drop = shared * taken / (1.0 + shared * conductance);
    }

    let mut now = [CoilNow::default(); 2];
    for (index, coil) in coils.into_iter().enumerate() {
        let Some(coil) = coil else {
            continue;
        };
        let drive = coil.drive;
        now[index] = match drive.voltage() {
            Some(voltage) => {
                let shared = if matches!(drive, Drive::Energised(_)) {
                    drop
                } else {
                    0.0
                };
                let voltage = voltage + coil.additional_voltage - shared;
                let resistance = loop_resistance(plant, index, drive);
                let source = coil.magnetising + coil.eddy;
                let current = (source + voltage * at_once) / divisor(index, drive);
                CoilNow {
                    current,
                    flux_rate: voltage - resistance * current,
                }
            }
            // The eddy currents alone carry the flux.
            None if eddy_loop.is_there() && coil.flux != 0.0 => CoilNow {
                current: 0.0,
                flux_rate: eddy_loop.flux_rate_without_coil(coil.flux, coil.magnetising),
            },
            None => CoilNow::default(),
        };
    }
    now
}
