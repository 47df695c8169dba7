//! Response of a plant to its valves, from its parameters alone: rates, volumes and delays.

use crate::additions::{Cavity, Tube};
use crate::parameters::{Part, PlantParameters};
use crate::plant::Plant;
use crate::valve::ValveFunction;

impl PlantParameters {
    /// Returns the rate of the open valve in the place `valve` (1/s): choked flow per upstream pressure, times R T over the volume that it fills
    /// or empties at half of the supply pressure. A line to a second chamber passes no more than its own choked flow.
    pub fn open_valve_rate_per_s(&self, valve: usize) -> f64 {
        let gas = &self.gas;
        let half = 0.5 * (gas.supply_pressure_pa() + gas.ambient_pressure_pa);
        let plant = self.plant();
        let valve = &plant.valves[valve];
        let flow = valve.largest_area() * valve.nozzle.choked_factor();
        let rate = |flow: f64, volume: f64| {
            flow * gas.gas_constant_j_per_kg_k * gas.temperature_k / volume
        };
        let through_valve = rate(flow, self.volume_m3(&plant, half));
        let through_line = plant.additions.cavity.as_ref().and_then(|cavity| {
            let flow = line_flow(cavity)?;
            Some(rate(flow, cavity.volume))
        });
        through_line.map_or(through_valve, |line| line.min(through_valve))
    }

    /// Returns the volume that a change of pressure fills at `pressure` (Pa abs), both chambers together (m³): a hose counts with its growth,
    /// d(p V)/dp.
    fn volume_m3(&self, plant: &Plant, pressure: f64) -> f64 {
        let additions = &plant.additions;
        let grown = additions.growth.map_or(0.0, |growth| {
            let grown = growth.volume(pressure);
            grown.size + grown.compliance * pressure
        });
        let second = additions
            .cavity
            .as_ref()
            .map_or(0.0, |cavity| cavity.volume);
        self.chamber.volume_m3 + grown + second
    }

    /// Returns the time (s) in which the pressures of two chambers approach each other; 0 without a second chamber. Choked flow moves their
    /// difference by 1 bar per bar of the higher one in V1 V2 / (V1 + V2) / (C p0) with p0 = 1 bar (ISO 6358).
    pub fn balance_s(&self) -> f64 {
        if !Part::SecondChamber.is_in(self) {
            return 0.0;
        }
        let second = &self.second_chamber;
        let volumes = [self.chamber.volume_m3, second.volume_m3];
        let in_series = volumes[0] * volumes[1] / (volumes[0] + volumes[1]);
        in_series / (1e-3 * second.conductance_dm3_per_s_bar)
    }

    /// Returns the longest time from a command to the end of the travel of the valve in the place `valve` (s): delay and ramp of an on/off
    /// valve, three time constants of a proportional one; 0 of others, whose travel depends on their coil.
    pub fn longest_switching_s(&self, valve: usize) -> f64 {
        match self.functions[valve] {
            ValveFunction::OnOff => {
                let valve = self.on_off(valve);
                let opening_s = valve.opening_delay_s + valve.opening_ramp_s;
                opening_s.max(valve.closing_delay_s + valve.closing_ramp_s)
            }
            ValveFunction::Proportional => 3.0 * self.proportional(valve).time_constant_s,
            _ => 0.0,
        }
    }
}

/// Returns the choked flow of the line to a second chamber per upstream pressure (kg/(s Pa)); none of another cavity.
fn line_flow(cavity: &Cavity) -> Option<f64> {
    match &cavity.tube {
        Tube::Line(line, nozzle) => Some(line.effective_area * nozzle.choked_factor()),
        Tube::Orifice(_) | Tube::Laminar(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{FILL, VENT};

    /// ISO 6358: a choked valve passes C ρ0 √(T0/T) p.
    fn on_off() -> PlantParameters {
        let mut plant = PlantParameters::nominal();
        plant.functions = [ValveFunction::OnOff; 2];
        plant.chamber.volume_m3 = 400e-6;
        for (valve, conductance) in [(&mut plant.on_off_fill, 0.5), (&mut plant.on_off_vent, 1.0)] {
            valve.conductance_dm3_per_s_bar = conductance;
            valve.critical_ratio = 0.3;
            (valve.opening_delay_s, valve.closing_delay_s) = (8e-3, 6e-3);
            (valve.opening_ramp_s, valve.closing_ramp_s) = (4e-3, 7e-3);
        }
        plant
    }

    #[test]
    fn a_valve_moves_the_pressure_at_the_rate_of_its_conductance() {
        let plant = on_off();
        let gas = &plant.gas;
        let density = 1.185 * (293.15 / gas.temperature_k).sqrt();
        let expected = 0.5e-8 * density * gas.gas_constant_j_per_kg_k * gas.temperature_k / 400e-6;
        let [fill, vent] = [FILL, VENT].map(|valve| plant.open_valve_rate_per_s(valve));
        assert!((fill / expected - 1.0).abs() < 1e-12, "{fill} {expected}");
        assert!((vent / fill - 2.0).abs() < 1e-12, "{vent} {fill}");
    }

    #[test]
    fn a_hose_and_a_second_chamber_are_slower_and_a_thin_line_limits_the_rate() {
        let stiff = on_off();
        let rate = |plant: &PlantParameters| plant.open_valve_rate_per_s(FILL);
        let mut hose = stiff.clone();
        hose.chamber.growth_m3_per_bar = 50e-6;
        // At half of 8.4 bar gauge: 400 + 50 · 4.2 + 50 · 5.2 cm³.
        let ratio = rate(&hose) / rate(&stiff);
        let half_bar = 0.5 * stiff.gas.supply_pressure_bar_gauge;
        let ambient_bar = 1e-5 * stiff.gas.ambient_pressure_pa;
        let expected = 400.0 / (400.0 + 50.0 * (2.0 * half_bar + ambient_bar));
        assert!((ratio - expected).abs() < 1e-9, "{ratio} {expected}");
        let mut two = stiff.clone();
        two.second_chamber.volume_m3 = 400e-6;
        two.second_chamber.conductance_dm3_per_s_bar = 2.0;
        two.second_chamber.critical_ratio = 0.3;
        assert!((rate(&two) / rate(&stiff) - 0.5).abs() < 1e-9);
        two.second_chamber.conductance_dm3_per_s_bar = 0.1;
        assert!((rate(&two) / rate(&stiff) - 0.1 / 0.5).abs() < 1e-9);
        assert_eq!(stiff.balance_s(), 0.0);
        assert!((two.balance_s() - 200e-6 / 0.1e-3).abs() < 1e-12);
    }

    #[test]
    fn a_switching_time_is_the_longer_of_both_ways() {
        assert!((on_off().longest_switching_s(FILL) - 13e-3).abs() < 1e-15);
        assert_eq!(PlantParameters::nominal().longest_switching_s(FILL), 0.0);
    }
}
