//! Coils with effects: currents from fluxes, with their charge and heat.

use super::super::flux::{self, CoilNow, CoilState};
use super::super::smooth::Smooth;
use super::super::span::{Span, first_of};
use super::Extended;
use crate::coil::Drive;
use crate::plant::{FILL, PlantState, VENT};
use crate::valve::ValveState;

impl Extended {
    /// Returns whether flux and current of a coil are proportional.
    pub(super) fn is_linear(&self) -> bool {
        let additions = &self.plant.additions;
        additions.saturation.is_none() && !additions.eddy_loop.is_there()
    }

    /// Returns the current that causes the magnetic force of a valve (A).
    pub(super) fn pulling_current(&self, index: usize, valve: &ValveState) -> f64 {
        if self.is_linear() {
            valve.current
        } else {
            flux::pulling_current(&self.plant, index, self.flux[index], valve.x)
        }
    }

    /// Returns by how much the current that a freewheeling coil can carry exceeds zero (A): the eddy currents carry the
    /// rest of the `magnetising` current.
    pub(super) fn excess_of_freewheeling(
        &self,
        index: usize,
        magnetising: f64,
        extra: &[f64],
    ) -> f64 {
        let at_once = self.plant.additions.eddy_loop.conductance_at_once();
        magnetising + self.eddy_current(index, extra) - self.plant.diode_drop * at_once
    }

    /// Returns the eddy current of a coil (A), where it is a state; otherwise 0.
    fn eddy_current(&self, index: usize, extra: &[f64]) -> f64 {
        self.layout
            .eddy_currents
            .map_or(0.0, |first| extra[first + index])
    }

    /// Returns the live coils at a state, with their magnetising currents.
    #[inline]
    pub(super) fn coils<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        y: &[f64; N],
        more: [f64; 2],
    ) -> [CoilNow; 2] {
        if !self.has_coil_law {
            return self.plain_coils(smooth, y);
        }
        let mut coils = [None; 2];
        let extra = &y[first_of(M)..];
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            let (flux, drive) = (y[first], smooth.drives[slot]);
            coils[index] = Some(CoilState {
                drive,
                flux,
                magnetising: flux::magnetising_current(&self.plant, index, flux, y[first + 1]),
                eddy: self.eddy_current(index, extra),
                additional_voltage: more[index] - self.lost_voltage(drive, extra),
            });
        }
        flux::coils_now(&self.plant, coils)
    }

    /// Returns the live coils at a state, where no effect changes their law.
    #[inline]
    fn plain_coils<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        y: &[f64; N],
    ) -> [CoilNow; 2] {
        let mut coils = [CoilNow::default(); 2];
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            let drive = smooth.drives[slot];
            if let Some(voltage) = drive.voltage() {
                let current = y[first] / self.plant.valves[index].coil.inductance(y[first + 1]);
                let resistance = flux::loop_resistance(&self.plant, index, drive);
                coils[index] = CoilNow {
                    current,
                    flux_rate: voltage - resistance * current,
                };
            }
        }
        coils
    }

    /// Returns the reduction of a coil's voltage by the battery's polarisation (V).
    fn lost_voltage(&self, drive: Drive, extra: &[f64]) -> f64 {
        match (drive, self.layout.polarisation) {
            (Drive::Energised(_), Some(polarisation)) => extra[polarisation],
            _ => 0.0,
        }
    }

    /// Returns d(polarisation)/dt (V/s) under the currents of the energised coils.
    pub(super) fn polarisation_rate<const M: usize>(
        &self,
        smooth: &Smooth<M>,
        coils: &[CoilNow; 2],
        voltage: f64,
    ) -> Option<f64> {
        let polarisation = self.plant.additions.polarisation?;
        let taken: f64 = smooth
            .live
            .iter()
            .zip(smooth.drives)
            .filter(|(_, drive)| matches!(drive, Drive::Energised(_)))
            .map(|(&index, _)| coils[index].current)
            .sum();
        Some((polarisation.resistance * taken - voltage) / polarisation.time_constant)
    }

    /// Writes d(eddy current)/dt (A/s) of the live coils into the rates of the effects' states, where it is a state.
    pub(super) fn eddy_rates<const M: usize>(
        &self,
        smooth: &Smooth<M>,
        coils: &[CoilNow; 2],
        extra: &[f64],
        extra_rates: &mut [f64],
    ) {
        if let Some(first) = self.layout.eddy_currents {
            for index in smooth.live {
                extra_rates[first + index] = self
                    .plant
                    .additions
                    .eddy_loop
                    .rate(coils[index].flux_rate, extra[first + index]);
            }
        }
    }

    /// Updates the state after the outputs have switched: with eddy currents, the current at the terminals jumps.
    pub(in crate::simulator) fn switched(&mut self, state: &mut PlantState) {
        if !self.plant.additions.eddy_loop.is_there() {
            return;
        }
        let coils = [FILL, VENT].map(|index| {
            let valve = &state.valves[index];
            let flux = self.flux[index];
            let magnetising = flux::magnetising_current(&self.plant, index, flux, valve.x);
            // The diode blocks a current below zero: the eddy current has carried all of the magnetising current.
            if let Some(first) = self.layout.eddy_currents {
                let eddy = &mut self.extra[first + index];
                *eddy = eddy.max(-magnetising);
            }
            Some(CoilState {
                drive: valve.drive,
                flux,
                magnetising,
                eddy: self.eddy_current(index, &self.extra),
                additional_voltage: -self.lost_voltage(valve.drive, &self.extra),
            })
        });
        let now = flux::coils_now(&self.plant, coils);
        for (valve, coil) in state.valves.iter_mut().zip(now) {
            valve.current = coil.current.max(0.0);
        }
    }

    pub(super) fn commit_charge<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        taken: f64,
        end: &[f64; N],
        charge: &mut [f64; 2],
    ) {
        let additions = &self.plant.additions;
        let simpson = additions.heating.is_some()
            || additions.polarisation.is_some()
            || !additions.hooks.is_empty();
        if simpson {
            let middle = span.at(0.5 * taken);
            let states = [&span.start, &middle, end];
            let [start, middle, end] = states.map(|y| self.coils(smooth, y, [0.0; 2]));
            for (&index, drive) in smooth.live.iter().zip(smooth.drives) {
                let [start, middle, end] = [start, middle, end].map(|now| now[index].current);
                // If the iron saturates, a small error of the interpolated flux gives a large error of the current.
                let steady = drive.voltage().unwrap_or(0.0)
                    / flux::loop_resistance(&self.plant, index, drive);
                let most = start.abs().max(end.abs()).max(steady.abs());
                let middle = middle.clamp(-most, most);
                let mean = |power: i32| {
                    let [start, middle, end] =
                        [start, middle, end].map(|current| current.powi(power));
                    (start + 4.0 * middle + end) / 6.0 * taken
                };
                charge[index] += mean(1);
                self.heat[index] += self.plant.valves[index].coil.resistance * mean(2);
            }
            return;
        }
        // Flux balance: R ∫i dt = ∫u dt - Δλ, where all energised coils share a part of u.
        let balances: [_; M] = core::array::from_fn(|slot| {
            let (index, drive) = (smooth.live[slot], smooth.drives[slot]);
            let voltage = drive.voltage()?;
            let first = first_of(slot);
            let balance = voltage * taken - (end[first] - span.start[first]);
            let resistance = flux::loop_resistance(&self.plant, index, drive);
            Some((balance / resistance, resistance))
        });
        let shared = additions.supply_resistance;
        let energised = || {
            let drives = smooth.drives.iter().zip(balances);
            drives.filter_map(|(drive, balance)| {
                matches!(drive, Drive::Energised(_)).then_some(balance?)
            })
        };
        let conductance: f64 = energised().map(|(_, resistance)| resistance.recip()).sum();
        let together =
            energised().map(|(alone, _)| alone).sum::<f64>() / (1.0 + shared * conductance);
        for (slot, balance) in balances.into_iter().enumerate() {
            let Some((alone, resistance)) = balance else {
                continue;
            };
            let lost = match smooth.drives[slot] {
                Drive::Energised(_) => shared * together / resistance,
                _ => 0.0,
            };
            charge[smooth.live[slot]] += alone - lost;
        }
    }
}
