//! Proportional valve: its open share follows the command along a characteristic and with a lag (E67).

use crate::description::ProportionalValveParameters;

/// Shares at the ends and at the quarters of a straight characteristic.
const LINE: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Positioning of a proportional valve: the open share that it moves to.
///
/// The share approaches the one of the command exponentially. A free armature with viscous friction does so if each new command gives it the
/// velocity at which it comes to rest there.
#[derive(Debug, Clone, PartialEq)]
pub struct Positioning {
    opens_at_pct: f64,
    /// Open shares of the conductance at the quarters of the way from `opens_at_pct` to 100 %.
    shares: [f64; 5],
    time_constant_s: f64,
    command_pct: f64,
}

impl Positioning {
    /// Creates a valve that is closed.
    pub(crate) fn new(parameters: &ProportionalValveParameters) -> Self {
        let above_line_pct = [
            0.0,
            parameters.above_line_25_pct,
            parameters.above_line_50_pct,
            parameters.above_line_75_pct,
            0.0,
        ];
        Self {
            opens_at_pct: parameters.opens_at_pct,
            shares: std::array::from_fn(|n| (LINE[n] + above_line_pct[n] / 100.0).clamp(0.0, 1.0)),
            time_constant_s: parameters.time_constant_s,
            command_pct: 0.0,
        }
    }

    /// Takes over a command (%) while the share `share` of the valve is open; returns the velocity of the share (1/s) if the command is a new
    /// one.
    pub(crate) fn update(&mut self, command_pct: f64, share: f64) -> Option<f64> {
        if command_pct == self.command_pct {
            return None;
        }
        self.command_pct = command_pct;
        Some((self.share(command_pct) - share) / self.time_constant_s)
    }

    /// Returns the open share at rest under a command (%).
    fn share(&self, command_pct: f64) -> f64 {
        let way = (command_pct - self.opens_at_pct) / (100.0 - self.opens_at_pct);
        let quarters = 4.0 * way.clamp(0.0, 1.0);
        let quarter = (quarters as usize).min(3);
        let [from, to] = [self.shares[quarter], self.shares[quarter + 1]];
        from + (to - from) * (quarters - quarter as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{EffectSetting, by_id};
    use crate::valve::ValveFunction;
    use crate::{Command, PlantParameters, Simulator};

    fn plant() -> PlantParameters {
        let mut plant = PlantParameters::nominal();
        plant.functions = [ValveFunction::Proportional; 2];
        plant.ecu.command_delay_s = 3e-3;
        plant.chamber.volume_m3 = 400e-6;
        for valve in [&mut plant.proportional_fill, &mut plant.proportional_vent] {
            valve.conductance_dm3_per_s_bar = 0.5;
            valve.critical_ratio = 0.3;
            valve.time_constant_s = 15e-3;
            valve.opens_at_pct = 20.0;
            valve.above_line_25_pct = -10.0;
        }
        plant
    }

    /// Returns the pressure (Pa abs) after each command (%) of the fill valve has stood for 50 ms.
    fn filled(plant: &PlantParameters, commands_pct: &[f64]) -> f64 {
        let mut simulator = Simulator::new(plant);
        for (step, &duty_fill_pct) in commands_pct.iter().enumerate() {
            simulator.advance_to_ns(50_000_000 * step as u64);
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct: 0.0,
            });
        }
        simulator.advance_to_ns(50_000_000 * commands_pct.len() as u64);
        simulator.state().pressure
    }

    #[test]
    fn the_share_follows_the_characteristic() {
        let valve = Positioning::new(&plant().proportional_fill);
        for (command_pct, share) in [
            (0.0, 0.0),
            (20.0, 0.0),
            (30.0, 0.075),
            (40.0, 0.15),
            (60.0, 0.5),
            (90.0, 0.875),
            (100.0, 1.0),
        ] {
            let found = valve.share(command_pct);
            assert!((found - share).abs() < 1e-12, "{command_pct}: {found}");
        }
    }

    /// Choked, the chamber fills with the share of the conductance that is open: the integral of s (1 - exp(-t/T)) over the time t behind the
    /// delay is s (t - T (1 - exp(-t/T))).
    #[test]
    fn a_choked_valve_passes_the_share_of_its_conductance_that_the_lag_lets_open() {
        let plant = plant();
        let gas = &plant.gas;
        let density = 1.185 * (293.15 / gas.temperature_k).sqrt();
        let mass_flow = 0.5e-8 * density * gas.supply_pressure_pa();
        let rise =
            gas.gas_constant_j_per_kg_k * gas.temperature_k / plant.chamber.volume_m3 * mass_flow;
        let integral =
            |share: f64, time_s: f64| share * (time_s - 15e-3 * (1.0 - (-time_s / 15e-3).exp()));
        let pressure = filled(&plant, &[60.0]);
        let expected = gas.ambient_pressure_pa + rise * integral(0.5, 47e-3);
        assert!((pressure - expected).abs() < 20.0, "{pressure} {expected}");
        // The second command meets a valve that is on its way; the answer of a lag is the sum of those to both changes.
        let pressure = filled(&plant, &[60.0, 30.0]);
        let both = integral(0.5, 97e-3) + integral(0.075 - 0.5, 47e-3);
        let expected = gas.ambient_pressure_pa + rise * both;
        assert!((pressure - expected).abs() < 40.0, "{pressure} {expected}");
    }

    #[test]
    fn a_command_within_the_dead_band_opens_nothing() {
        let plant = plant();
        assert_eq!(filled(&plant, &[19.0, 20.0]), plant.gas.ambient_pressure_pa);
    }

    /// An effect takes the plant to the general equations, which give the same.
    #[test]
    fn other_equations_give_the_same() {
        let plain = plant();
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
        let slightly = plain.with_effect(leak.with("area_m2", 1e-12));
        let commands = [100.0, 40.0, 0.0, 70.0];
        let [own, other] = [&plain, &slightly].map(|plant| filled(plant, &commands));
        assert!((own - other).abs() < 30.0, "{own} {other}");
    }
}
