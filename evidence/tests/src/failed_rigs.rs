//! Rigs like those on which the diagnosis once failed: the reference plant and the logs that a user records of it.

use plant_sim::PlantParameters;
use plant_sim::plant::VENT;
use plant_sim::valve::ValveFunction;
use recording::{Provenance, Recording, TimeBase, Unit};

use crate::chance::Chance;
use crate::reference_plant::{Departures, Reading, ReferencePlant, Rig, SCATTERED, Scatter};

/// Noise of the current measurement (rms) and step of its converter (mA).
const CURRENT_MA: [f64; 2] = [0.7, 0.5];
/// Step of the pressure's converter relative to the noise.
const STEP: f64 = 0.5;
/// Grid of the commands (s): one period of slow PWM.
const GRID_S: f64 = 0.05;

/// Interval of a test signal: length (s) and duty cycles (%), fill and vent; a duty cycle of 0 shuts a valve, whatever
/// its function.
pub type Interval = (f64, f64, f64);

/// Test signal of one log.
#[derive(Debug, Clone, Default)]
pub struct TestSignal {
    /// Commands before the first row.
    pub before: Vec<Interval>,
    /// Commands of the log.
    pub logged: Vec<Interval>,
}

/// Rig with its logger, and the plant file of its user.
#[derive(Debug, Clone)]
pub struct FailedRig {
    /// Plant file.
    pub file: PlantParameters,
    /// Reference plant.
    pub rig: Rig,
    /// Test signals of the log to fit and of the log to check.
    pub signals: [TestSignal; 2],
    /// Noise of the pressure (bar).
    pub noise_bar: f64,
    /// ECU samples per row.
    pub samples_per_row: usize,
    /// Whether the currents are logged.
    pub has_currents: bool,
    /// Seed of the noise.
    pub seed: u64,
}

impl FailedRig {
    /// Creates a rig whose ordinary values differ from those of `file` by up to half of the usual tolerance.
    ///
    /// # Panics
    /// Panics if the file lacks a value that the reference plant needs.
    pub fn of(file: PlantParameters, seed: u64) -> Self {
        let mut chance = Chance::new(seed);
        let datasheet = toml::from_str(&file.to_toml())
            .expect("a plant file with both valves has every key of the reference plant");
        let plain = Rig {
            datasheet,
            departures: Departures::default(),
            is_vent_normally_open: file.functions[VENT] == ValveFunction::NormallyOpen,
        };
        let scatter = Scatter([0.0; SCATTERED.len()].map(|_| chance.between(-0.5, 0.5)));
        Self {
            rig: plain.scattered(&scatter),
            file,
            signals: Default::default(),
            noise_bar: 0.7e-3,
            samples_per_row: 1,
            has_currents: false,
            seed,
        }
    }

    /// Records the log to fit and the log to check.
    pub fn logs(&self) -> [Recording; 2] {
        [0, 1].map(|n| self.record(n))
    }

    fn record(&self, n: usize) -> Recording {
        let (name, signal) = (["fit", "check"][n], &self.signals[n]);
        let mut chance = Chance::of(self.seed, n as u64);
        let mut plant = ReferencePlant::new(&self.rig);
        plant.hold_in_long_steps();
        let before = self.commands(&signal.before);
        for &duty in &before {
            plant.run(duty);
        }
        let commands = self.commands(&signal.logged);
        let sample_ns = (1e9 * self.rig.datasheet.ecu.sample_time_s).round() as u64;
        let mut rows = Vec::new();
        plant.begin_means();
        for (n, &duty) in commands.iter().enumerate() {
            if n.is_multiple_of(self.samples_per_row) {
                rows.push(self.row(duty, plant.reading(), &mut chance));
                plant.begin_means();
            }
            plant.command(duty);
            plant.run_until((before.len() + n + 1) as u64 * sample_ns);
        }
        let row_s = self.rig.datasheet.ecu.sample_time_s * self.samples_per_row as f64;
        let mut log = Recording::new(Provenance::from_source(name));
        let base = TimeBase::uniform(0.0, row_s, rows.len()).expect("a log has rows");
        let base = log.add_time_base(base);
        for (column, (name, unit)) in Self::COLUMNS.into_iter().enumerate() {
            if self.is_logged(name) {
                let values = rows.iter().map(|row| row[column]).collect();
                log.add_signal(name, unit, base, values)
                    .expect("names and values of the columns are possible");
            }
        }
        log
    }

    const COLUMNS: [(&str, Unit); 5] = [
        ("duty_fill", Unit::Percent),
        ("duty_vent", Unit::Percent),
        ("p_ch", Unit::BarGauge),
        ("i_fill", Unit::Milliampere),
        ("i_vent", Unit::Milliampere),
    ];

    fn is_logged(&self, name: &str) -> bool {
        match name {
            "p_ch" => true,
            "duty_fill" | "duty_vent" => self.file.functions[VENT].has_coil(),
            _ => self.has_currents,
        }
    }

    fn row(&self, [fill, vent]: [f64; 2], reading: Reading, chance: &mut Chance) -> [f64; 5] {
        let pressure = read(
            reading.pressure * 1e-5,
            [self.noise_bar, STEP * self.noise_bar],
            chance,
        );
        let currents = reading
            .currents
            .map(|current| read(1e3 * current, CURRENT_MA, chance));
        [fill, vent, pressure, currents[0], currents[1]]
    }

    /// Returns the commands of `signal`, one pair per sample.
    fn commands(&self, signal: &[Interval]) -> Vec<[f64; 2]> {
        let sample_s = self.rig.datasheet.ecu.sample_time_s;
        let of_interval = |&(length_s, fill, vent): &Interval| {
            // A normally open valve is shut by its command.
            let vent = if self.rig.is_vent_normally_open {
                100.0 - vent
            } else {
                vent
            };
            std::iter::repeat_n([fill, vent], (length_s / sample_s).round() as usize)
        };
        signal.iter().flat_map(of_interval).collect()
    }
}

/// Returns the converter's reading of `value` with noise.
fn read(value: f64, [noise, step]: [f64; 2], chance: &mut Chance) -> f64 {
    ((value + noise * chance.normal()) / step).round() * step
}

/// Returns fills, holds and vents of at least `length_s` altogether, with random duty cycles. Fills and vents last
/// `longer` times as long as those of a chamber of 75 cm³.
pub fn steps(length_s: f64, longer: f64, chance: &mut Chance) -> Vec<Interval> {
    let mut signal = vec![(0.5, 0.0, 0.0)];
    let on_grid = |length_s: f64| (length_s / GRID_S).ceil() * GRID_S;
    while signal.iter().map(|interval| interval.0).sum::<f64>() < length_s {
        let duty =
            |chance: &mut Chance| (10.0 * chance.between(40.0, 115.0).min(100.0)).round() / 10.0;
        signal.extend([
            (
                on_grid(longer * chance.between(0.05, 0.25)),
                duty(chance),
                0.0,
            ),
            (on_grid(chance.between(0.3, 1.0)), 0.0, 0.0),
            (
                on_grid(longer * chance.between(0.05, 0.3)),
                0.0,
                duty(chance),
            ),
            (on_grid(chance.between(0.3, 0.6)), 0.0, 0.0),
        ]);
    }
    signal
}
