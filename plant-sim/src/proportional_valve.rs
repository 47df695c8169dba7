//! Proportional valve: a characteristic gives the open share over the command, and the spool or the opening follows with a lag (E67).

use crate::description::{LagOf, ProportionalValveParameters};
use crate::valve::Turn;

/// Difference of the open share from its end below which the valve counts as at rest.
const AT_REST: f64 = 1e-5;
/// Shares at the ends and at the quarters of a straight characteristic.
const LINE: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Positioning of a proportional valve: the way of its spool, and the open share.
///
/// Ways are shares of the way from `opens_at_pct` to 100 %; within the dead zone they are negative. The characteristic consists of pieces:
/// piece 0 is the dead zone, and the others end at the quarters. Within a piece, the share approaches that of the end of the way,
/// continued along the piece, exponentially. A free armature with viscous friction does so if it begins with the right velocity. If the
/// opening lags, the share approaches that of the end of the way itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Positioning {
    opens_at_pct: f64,
    /// Open shares of the conductance at the ends of the pieces.
    shares: [f64; 5],
    time_constant_s: f64,
    lag_of: LagOf,
    command_pct: f64,
    /// Time of the last command (ns), and the way of the spool then.
    since_ns: u64,
    since_way: f64,
    piece: usize,
    /// Time at which the motion changes next, if it does under this command (ns), ...
    turns_ns: Option<u64>,
    /// ... because the spool enters the next piece.
    enters_piece: bool,
}

impl Positioning {
    /// Creates a valve that rests without a command.
    pub(crate) fn new(parameters: &ProportionalValveParameters) -> Self {
        let above_line_pct = [
            0.0,
            parameters.above_line_25_pct,
            parameters.above_line_50_pct,
            parameters.above_line_75_pct,
            0.0,
        ];
        let mut rests = Self {
            opens_at_pct: parameters.opens_at_pct,
            shares: std::array::from_fn(|n| (LINE[n] + above_line_pct[n] / 100.0).clamp(0.0, 1.0)),
            time_constant_s: parameters.time_constant_s,
            lag_of: parameters.lag_of.unwrap_or_default(),
            command_pct: 0.0,
            since_ns: 0,
            since_way: 0.0,
            piece: 0,
            turns_ns: None,
            enters_piece: false,
        };
        rests.since_way = rests.end();
        rests
    }

    /// Takes over a command (%) while the share `share` of the valve is open; returns the motion if it changes now.
    pub(crate) fn update(&mut self, now_ns: u64, command_pct: f64, share: f64) -> Option<Turn> {
        let is_new = command_pct != self.command_pct;
        if is_new {
            (self.since_way, self.since_ns) = (self.way(now_ns), now_ns);
            self.command_pct = command_pct;
            if self.lag_of == LagOf::Opening {
                self.since_way = self.end();
                self.piece = LINE.partition_point(|&knot| knot < self.since_way);
            }
        } else {
            self.turns_ns.take_if(|turns_ns| *turns_ns <= now_ns)?;
            if self.enters_piece {
                self.piece = self.next_piece();
            }
        }
        let end_share = self.share_in(self.piece, self.end());
        let way_left = (end_share - share).abs();
        let next_piece_s = self.next_piece_s();
        self.enters_piece = next_piece_s.is_some();
        let rest_s = || {
            let from_now_s = self.time_constant_s * (way_left / AT_REST).ln();
            (now_ns - self.since_ns) as f64 * 1e-9 + from_now_s
        };
        let rests = way_left <= AT_REST && (self.piece == 0 || !self.enters_piece);
        let turns_s = next_piece_s.or_else(|| (!rests).then(rest_s));
        self.turns_ns = turns_s.map(|after_s| {
            let turns_ns = self.since_ns + (1e9 * after_s).ceil() as u64;
            turns_ns.max(now_ns + 1)
        });
        Some(match rests {
            true => Turn::RestsAt(end_share),
            false => Turn::Moves((end_share - share) / self.time_constant_s),
        })
    }

    /// Returns the time at which the motion changes next, if the command does not change before (ns).
    pub(crate) fn next_turn_ns(&self) -> Option<u64> {
        self.turns_ns
    }

    /// Returns the way of the spool at rest under the command.
    fn end(&self) -> f64 {
        (self.command_pct - self.opens_at_pct) / (100.0 - self.opens_at_pct)
    }

    fn way(&self, now_ns: u64) -> f64 {
        let time_s = (now_ns - self.since_ns) as f64 * 1e-9;
        self.end() + (self.since_way - self.end()) * (-time_s / self.time_constant_s).exp()
    }

    fn is_rising(&self) -> bool {
        self.end() > self.since_way
    }

    fn next_piece(&self) -> usize {
        match self.is_rising() {
            true => self.piece + 1,
            false => self.piece - 1,
        }
    }

    /// Returns the time from the last command to the end of the present piece (s); none if the spool comes to rest before.
    fn next_piece_s(&self) -> Option<f64> {
        let end = self.end();
        let knot = if self.is_rising() {
            *LINE.get(self.piece)?
        } else {
            LINE[self.piece.checked_sub(1)?]
        };
        let is_beyond = (end - knot) * (end - self.since_way) > 0.0;
        is_beyond.then(|| {
            let time_s = self.time_constant_s * ((self.since_way - end) / (knot - end)).ln();
            time_s.max(0.0)
        })
    }

    /// Returns the open share at a way of the spool, along one piece of the characteristic.
    fn share_in(&self, piece: usize, way: f64) -> f64 {
        let Some(below) = piece.checked_sub(1) else {
            return 0.0;
        };
        let [from, to] = [self.shares[below], self.shares[piece]];
        from + (to - from) * (way - LINE[below]) / (LINE[piece] - LINE[below])
    }
}

#[cfg(test)]
mod tests {
    use crate::description::LagOf;
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

    /// Returns the open share (1) at rest under a command (%): flow over command, as in a data sheet.
    fn at_rest(command_pct: f64) -> f64 {
        let [below, at_40_pct] = [(command_pct - 20.0) / 20.0 * 0.15, 0.15];
        let above = at_40_pct + (command_pct - 40.0) / 20.0 * 0.35;
        let upper = 0.5 + (command_pct - 60.0) / 40.0 * 0.5;
        match command_pct {
            ..20.0 => 0.0,
            20.0..40.0 => below,
            40.0..60.0 => above,
            _ => upper,
        }
    }

    #[test]
    fn the_share_comes_to_rest_on_the_characteristic() {
        for command_pct in [0.0, 20.0, 30.0, 40.0, 60.0, 90.0, 100.0] {
            let mut simulator = Simulator::new(&plant());
            simulator.command(Command {
                duty_fill_pct: command_pct,
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(400_000_000);
            let share = simulator.state().valves[0].x / simulator.plant().valves[0].armature.stroke;
            let expected = at_rest(command_pct);
            assert!((share - expected).abs() < 1e-6, "{command_pct}: {share}");
        }
    }

    /// Returns the pressure (Pa abs) that a choked valve fills in, open by a share whose integral over time this is (s).
    fn choked(plant: &PlantParameters, integral_s: f64) -> f64 {
        let gas = &plant.gas;
        let density = 1.185 * (293.15 / gas.temperature_k).sqrt();
        let mass_flow = 0.5e-8 * density * gas.supply_pressure_pa();
        let rise = gas.gas_constant_j_per_kg_k * gas.temperature_k / plant.chamber.volume_m3;
        gas.ambient_pressure_pa + rise * mass_flow * integral_s
    }

    /// The integral of s (1 - exp(-t/T)) over the time t behind the delay is s (t - T (1 - exp(-t/T))). The answer of a lag to two changes is
    /// the sum of those to each.
    #[test]
    fn an_opening_that_lags_moves_to_the_share_of_the_command() {
        let plant = plant().with_lag_of(Some(LagOf::Opening));
        let integral =
            |share: f64, time_s: f64| share * (time_s - 15e-3 * (1.0 - (-time_s / 15e-3).exp()));
        let both = integral(0.5, 97e-3) + integral(0.075 - 0.5, 47e-3);
        for (commands_pct, integral_s) in [
            (&[60.0][..], integral(0.5, 47e-3)),
            (&[60.0, 30.0], both),
            (&[60.0, 20.0], integral(0.5, 97e-3) - integral(0.5, 47e-3)),
        ] {
            let (pressure, expected) = (filled(&plant, commands_pct), choked(&plant, integral_s));
            assert!((pressure - expected).abs() < 40.0, "{pressure} {expected}");
        }
    }

    /// Choked, the chamber fills with the integral of the open share. The spool passes the dead zone and both knees, turns within a piece, and
    /// comes back into the dead zone.
    #[test]
    fn a_choked_valve_passes_the_share_at_which_its_spool_is() {
        let plant = plant();
        let commands_pct = [60.0, 30.0, 100.0, 0.0];
        let (step_s, mut spool_pct, mut integral_s) = (1e-6, 0.0, 0.0);
        for n in 0..197_000 {
            let command_pct = commands_pct[n / 50_000];
            let next_pct = command_pct + (spool_pct - command_pct) * (-step_s / 15e-3_f64).exp();
            integral_s += at_rest(0.5 * (spool_pct + next_pct)) * step_s;
            spool_pct = next_pct;
        }
        let (pressure, expected) = (filled(&plant, &commands_pct), choked(&plant, integral_s));
        assert!((pressure - expected).abs() < 20.0, "{pressure} {expected}");
    }

    #[test]
    fn a_command_within_the_dead_band_opens_nothing() {
        let plant = plant();
        assert_eq!(filled(&plant, &[19.0, 20.0]), plant.gas.ambient_pressure_pa);
    }

    #[test]
    fn the_part_that_lags_is_kept_in_the_plant_file() {
        for (lag_of, lines) in [
            (None, 0),
            (Some(LagOf::Spool), 2),
            (Some(LagOf::Opening), 2),
        ] {
            let plant = plant().with_lag_of(lag_of);
            let text = plant.to_toml();
            assert_eq!(text.matches("lag_of").count(), lines, "{text}");
            let read = PlantParameters::from_toml(&text, "plant").unwrap();
            assert_eq!(read.proportional_fill, plant.proportional_fill);
            assert_eq!(read.proportional_vent, plant.proportional_vent);
        }
        let text = plant().with_lag_of(Some(LagOf::Opening)).to_toml();
        let error = PlantParameters::from_toml(&text.replace("\"opening\"", "\"coil\""), "plant");
        let said = error.unwrap_err().to_string();
        assert!(
            said.contains("proportional_vent.lag_of") && said.contains("spool, opening"),
            "{said}"
        );
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
