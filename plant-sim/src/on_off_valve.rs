//! On/off valve without a coil: a command moves it after a delay, and it opens and closes along a ramp (E64).

use crate::description::OnOffValveParameters;
use crate::valve::Turn;

/// Switching of an on/off valve: what moves it, and when.
///
/// A command must stand for the opening delay until the valve begins to open, and a pause for the closing delay until it begins to close.
/// Shorter pulses and pauses change nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Switching {
    /// Opening and closing delay (ns).
    delays_ns: [u64; 2],
    /// Time of the whole way open and closed (s).
    ramps_s: [f64; 2],
    is_opening: bool,
    is_commanded: bool,
    /// Instant at which the valve turns to what is commanded, if it does not yet (ns).
    turns_ns: Option<u64>,
}

impl Switching {
    /// Creates a valve that is closed.
    pub(crate) fn new(parameters: &OnOffValveParameters) -> Self {
        Self {
            delays_ns: parameters.delays_ns(),
            ramps_s: [parameters.opening_ramp_s, parameters.closing_ramp_s],
            is_opening: false,
            is_commanded: false,
            turns_ns: None,
        }
    }

    /// Takes over the output at `now_ns`; returns the motion of a valve that turns now. `opening_factor` multiplies the opening delay.
    pub(crate) fn update(
        &mut self,
        now_ns: u64,
        is_commanded: bool,
        opening_factor: f64,
    ) -> Option<Turn> {
        if is_commanded != self.is_commanded {
            self.is_commanded = is_commanded;
            let [opening_ns, closing_ns] = self.delays_ns;
            let delay_ns = match is_commanded {
                true => (opening_ns as f64 * opening_factor).round() as u64,
                false => closing_ns,
            };
            let turns = is_commanded != self.is_opening;
            self.turns_ns = turns.then(|| now_ns.saturating_add(delay_ns));
        }
        self.turns_ns.take_if(|turns_ns| *turns_ns <= now_ns)?;
        self.is_opening = is_commanded;
        Some(Turn::Moves(match is_commanded {
            true => self.ramps_s[0].recip(),
            false => -self.ramps_s[1].recip(),
        }))
    }

    /// Returns the instant at which the valve turns next, if the output does not change before (ns).
    pub(crate) fn next_turn_ns(&self) -> Option<u64> {
        self.turns_ns
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::{EffectSetting, by_id};
    use crate::valve::ValveFunction;
    use crate::{Command, PlantParameters, Simulator};

    /// Returns a plant with two on/off valves, commanded once in 20 ms.
    fn plant() -> PlantParameters {
        let mut plant = PlantParameters::nominal();
        plant.functions = [ValveFunction::OnOff; 2];
        (plant.ecu.sample_time_s, plant.ecu.pwm_frequency_hz) = (0.02, 50.0);
        plant.ecu.command_delay_s = 0.0;
        plant.chamber.volume_m3 = 400e-6;
        for valve in [&mut plant.on_off_fill, &mut plant.on_off_vent] {
            valve.conductance_dm3_per_s_bar = 0.5;
            valve.critical_ratio = 0.3;
            (valve.opening_delay_s, valve.closing_delay_s) = (8e-3, 6e-3);
            (valve.opening_ramp_s, valve.closing_ramp_s) = (4e-3, 2e-3);
        }
        plant
    }

    /// Returns the pressure (Pa abs) at `end_ns` under duty cycles (%) of the fill valve, one for each period.
    fn filled(plant: &PlantParameters, duties_pct: &[f64], end_ns: u64) -> f64 {
        let mut simulator = Simulator::new(plant);
        for (period, &duty_fill_pct) in duties_pct.iter().enumerate() {
            simulator.advance_to_ns(20_000_000 * period as u64);
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct: 0.0,
            });
        }
        simulator.advance_to_ns(end_ns);
        simulator.state().pressure
    }

    /// ISO 6358: a choked valve passes C ρ0 √(T0/T) p. The ramp counts half, since the flow grows in proportion to the open share.
    #[test]
    fn a_choked_valve_passes_its_conductance_from_the_middle_of_its_ramp() {
        let plant = plant();
        let gas = &plant.gas;
        let density = 1.185 * (293.15 / gas.temperature_k).sqrt();
        let mass_flow = 0.5e-8 * density * gas.supply_pressure_pa();
        let rise =
            gas.gas_constant_j_per_kg_k * gas.temperature_k / plant.chamber.volume_m3 * mass_flow;
        let pressure = filled(&plant, &[100.0], 18_000_000);
        let expected = gas.ambient_pressure_pa + rise * (18e-3 - 8e-3 - 2e-3);
        assert!((pressure - expected).abs() < 5.0, "{pressure} {expected}");
    }

    /// A pulse of 12 ms: open from 8 ms on, closing from 18 ms on; in mean 4 ms / 2 later and 2 ms / 2 longer.
    #[test]
    fn a_pulse_lasts_from_its_opening_to_its_closing_delay() {
        let plant = plant();
        let pulse = filled(&plant, &[60.0, 0.0], 40_000_000) - plant.gas.ambient_pressure_pa;
        let open = filled(&plant, &[100.0], 18_000_000) - plant.gas.ambient_pressure_pa;
        // The open valve has passed 18 - 8 - 2 ms of full flow, the pulse 18 + 1 - 8 - 2 ms.
        assert!((pulse / open - 9.0 / 8.0).abs() < 1e-3, "{pulse} {open}");
    }

    #[test]
    fn a_pulse_or_a_pause_shorter_than_its_delay_changes_nothing() {
        let plant = plant();
        let ambient = plant.gas.ambient_pressure_pa;
        assert_eq!(filled(&plant, &[35.0, 39.0, 0.0], 60_000_000), ambient);
        let [paused, open] = [75.0, 100.0].map(|duty| filled(&plant, &[duty, 100.0], 38_000_000));
        assert_eq!(paused, open);
        let shut = filled(&plant, &[65.0, 100.0], 38_000_000);
        assert!(shut < open - 1e3, "{shut} {open}");
    }

    /// An effect takes the plant to the general equations, which give the same; an end stop does not throw a valve back.
    #[test]
    fn other_equations_give_the_same() {
        let plain = plant();
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
        let slightly = plain.with_effect(leak.with("area_m2", 1e-12));
        for duties in [&[100.0, 50.0, 0.0][..], &[60.0, 70.0, 45.0]] {
            let [own, other] = [&plain, &slightly].map(|plant| filled(plant, duties, 90_000_000));
            assert!((own - other).abs() < 20.0, "{own} {other}");
        }
    }
}
