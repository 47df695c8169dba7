//! Command profiles of the logs.

use super::super::format::Profile;
use super::closed_loop::ClosedLoop;
use crate::chance::Chance;

/// Source of the duty cycles (%) of each sample, fill and vent.
#[derive(Debug, Clone)]
pub(in crate::blind) enum Commands {
    Listed(Vec<[f64; 2]>),
    Controlled(Box<ClosedLoop>),
}

impl Commands {
    /// Creates commands for `samples` ECU samples, each held for a multiple of `grid` of them.
    pub(in crate::blind) fn new(
        profile: Profile,
        samples: usize,
        grid: usize,
        chance: &mut Chance,
    ) -> Self {
        let mut list = List {
            commands: Vec::with_capacity(samples),
            grid,
        };
        match profile {
            Profile::ClosedLoop => {
                return Self::Controlled(Box::new(ClosedLoop::new(samples, grid, chance)));
            }
            Profile::Bench => list.bench(samples, chance),
            Profile::Pulses => list.pulses(samples, chance),
            Profile::Chance => list.chance(samples, true, chance),
            Profile::Restless => list.chance(samples, false, chance),
        }
        list.commands.truncate(samples);
        Self::Listed(list.commands)
    }

    /// Returns the command of sample `n`, in which the ECU reads this pressure (bar gauge).
    pub(in crate::blind) fn at(&mut self, n: usize, pressure: f64) -> [f64; 2] {
        match self {
            Self::Listed(list) => list[n],
            Self::Controlled(controller) => controller.command(n, pressure),
        }
    }
}

struct List {
    commands: Vec<[f64; 2]>,
    grid: usize,
}

impl List {
    /// Adds `samples` of one command, rounded up to the grid; duty cycles rounded to 0.1 %.
    fn hold(&mut self, samples: usize, duty: [f64; 2]) {
        let samples = samples.div_ceil(self.grid) * self.grid;
        let duty = duty.map(|duty| (10.0 * duty).round() / 10.0);
        self.commands.extend(std::iter::repeat_n(duty, samples));
    }

    /// Adds a command of one valve alone.
    fn valve(&mut self, valve: usize, samples: usize, duty: f64) {
        let mut both = [0.0; 2];
        both[valve] = duty;
        self.hold(samples, both);
    }

    fn off(&mut self, samples: usize) {
        self.hold(samples, [0.0; 2]);
    }

    fn bench(&mut self, samples: usize, chance: &mut Chance) {
        self.off(chance.whole(50, 120));
        let mut duties =
            [100.0, 85.0, 65.0, 52.0, 42.0].map(|d: f64| d + chance.between(-4.0, 0.0));
        chance.shuffle(&mut duties);
        for duty in duties {
            self.fill_hold_vent(duty, chance);
        }
        let mut test_signals: [fn(&mut Self, &mut Chance); 6] = [
            Self::long_hold,
            |list, chance| list.stairs(1, chance),
            |list, chance| list.stairs(0, chance),
            Self::both_valves,
            Self::heating,
            Self::rest,
        ];
        chance.shuffle(&mut test_signals);
        for test_signal in test_signals {
            test_signal(self, chance);
        }
        self.chance(samples, true, chance);
    }

    fn fill_hold_vent(&mut self, duty: f64, chance: &mut Chance) {
        self.valve(0, chance.whole(20, 45), duty);
        self.off(chance.whole(50, 100));
        self.valve(1, chance.whole(25, 50), duty);
        self.off(chance.whole(25, 50));
        self.valve(1, chance.whole(60, 100), 100.0);
        self.off(15);
    }

    fn long_hold(&mut self, chance: &mut Chance) {
        self.valve(0, chance.whole(60, 120), 100.0);
        self.off(chance.whole(200, 450));
    }

    /// Adds short intervals at increasing duty cycles: down from full, or up from empty.
    fn stairs(&mut self, valve: usize, chance: &mut Chance) {
        self.valve(1 - valve, 90, 100.0);
        let steps = chance.whole(4, 6);
        for step in 0..steps {
            let duty = 30.0 + 55.0 * step as f64 / (steps - 1) as f64;
            self.valve(valve, chance.whole(6, 14), duty);
            self.off(chance.whole(20, 40));
        }
        self.off(chance.whole(50, 200));
    }

    fn both_valves(&mut self, chance: &mut Chance) {
        for duty in [chance.between(75.0, 100.0), chance.between(50.0, 70.0)] {
            self.hold(chance.whole(60, 120), [duty; 2]);
        }
        self.valve(1, 60, 100.0);
    }

    fn heating(&mut self, chance: &mut Chance) {
        let valve = chance.whole(0, 1);
        self.valve(valve, chance.whole(400, 900), 100.0);
        self.valve(valve, 80, 60.0);
        self.valve(1 - valve, 80, 60.0);
    }

    fn rest(&mut self, chance: &mut Chance) {
        self.valve(1, 100, 100.0);
        self.off(chance.whole(100, 200));
    }

    fn chance(&mut self, samples: usize, holds: bool, chance: &mut Chance) {
        while self.commands.len() < samples {
            let length = chance.whole(4, 39);
            let [one, other] = [0; 2].map(|_| chance.between(20.0, 100.0));
            match chance.share() {
                kind if kind < 0.42 => self.valve(0, length, one),
                kind if kind < 0.80 => self.valve(1, length, one),
                kind if kind < 0.88 || !holds => self.hold(length, [one, other]),
                _ => self.off(2 * length),
            }
        }
    }

    fn pulses(&mut self, samples: usize, chance: &mut Chance) {
        self.off(chance.whole(20, 60));
        while self.commands.len() < samples {
            let valve = chance.whole(0, 1);
            let duty = chance.between(30.0, 100.0);
            let pause = chance.whole(1, 12);
            for _ in 0..chance.whole(3, 15) {
                self.valve(valve, 1, duty);
                self.off(pause);
            }
            self.off(chance.whole(5, 80));
            if chance.happens(0.3) {
                self.valve(chance.whole(0, 1), chance.whole(20, 60), 100.0);
                self.off(chance.whole(5, 60));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(profile: Profile, grid: usize) -> Vec<[f64; 2]> {
        let mut commands = Commands::new(profile, 2000, grid, &mut Chance::new(3));
        (0..2000).map(|n| commands.at(n, 3.0)).collect()
    }

    const ALL: [Profile; 5] = [
        Profile::Bench,
        Profile::Chance,
        Profile::Restless,
        Profile::Pulses,
        Profile::ClosedLoop,
    ];

    #[test]
    fn every_profile_moves_both_valves_within_the_range_of_the_duty_cycle() {
        for profile in ALL {
            let commands = list(profile, 1);
            assert!(
                commands
                    .iter()
                    .flatten()
                    .all(|duty| (0.0..=100.0).contains(duty))
            );
            for valve in 0..2 {
                assert!(
                    commands.iter().any(|duty| duty[valve] > 40.0),
                    "{profile:?} leaves valve {valve} alone"
                );
            }
        }
    }

    #[test]
    fn a_restless_profile_never_switches_both_valves_off() {
        assert!(!list(Profile::Restless, 1).contains(&[0.0; 2]));
        assert!(list(Profile::Chance, 1).contains(&[0.0; 2]));
    }

    #[test]
    fn commands_change_on_the_grid_only() {
        for profile in ALL {
            for held in list(profile, 5).chunks(5) {
                assert!(held.iter().all(|duty| *duty == held[0]), "{profile:?}");
            }
        }
    }
}
