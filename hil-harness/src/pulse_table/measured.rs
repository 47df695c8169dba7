//! Opening of a valve by pulses, measured on the model.

use plant_sim::experiment::ValveId;
use plant_sim::plant::{FILL, VENT};
use plant_sim::{Command, PlantParameters, Simulator};

/// Chamber pressures of the table (bar gauge).
pub(super) const PRESSURES_BAR: [f64; 5] = [0.0, 2.0, 4.0, 6.0, 8.0];
/// Slowness factors of the table: nominal over actual supply voltage.
pub(super) const SLOWNESS: [f64; 5] = [0.5, 0.75, 1.0, 1.25, 1.5];
/// Number of open times of the table.
pub(super) const OPEN_TIMES: usize = 21;
/// Number of open times in steps of 0.512 ms; the following steps are twice as long.
const FINE: usize = 8;
/// Longest run of the table (ms): more than two periods.
const RUN_MAX_MS: f64 = 30.0;
/// Step of the on-times at which a valve is measured (ms).
const STEP_MS: f64 = 0.1;
/// Open time that counts as the first (ms): 2 mbar at 67 bar/s.
const FIRST_OPEN_MS: f64 = 0.03;
/// Grid on which the opening is read (ns).
const GRID_NS: u64 = 50_000;

/// Returns the open time with this index (ms).
pub(super) fn open_time_ms(index: usize) -> f64 {
    if index <= FINE {
        0.512 * index as f64
    } else {
        0.512 * FINE as f64 + 1.024 * (index - FINE) as f64
    }
}

/// Times of one valve (ms), each by slowness and pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct ValveTimes {
    /// On-time of a run that gives each open time.
    pub on_ms: [[[f64; 5]; 5]; OPEN_TIMES],
    /// Open time of a run of one full period.
    pub one_period_ms: [[f64; 5]; 5],
    /// Open time of a run of two full periods.
    pub two_periods_ms: [[f64; 5]; 5],
    /// Time from the first edge until an open valve would have begun to pass its full flow.
    pub opening_ms: [[f64; 5]; 5],
}

impl ValveTimes {
    /// Measures the valve on `plant`.
    pub fn of(plant: &PlantParameters, valve: ValveId) -> Self {
        let mut times = Self {
            on_ms: [[[0.0; 5]; 5]; OPEN_TIMES],
            one_period_ms: [[0.0; 5]; 5],
            two_periods_ms: [[0.0; 5]; 5],
            opening_ms: [[0.0; 5]; 5],
        };
        for (row, slowness) in SLOWNESS.into_iter().enumerate() {
            for (column, pressure_bar) in PRESSURES_BAR.into_iter().enumerate() {
                let bench = Bench {
                    plant,
                    valve,
                    slowness,
                    pressure_bar,
                };
                let curve = bench.curve();
                for (index, on_ms) in times.on_ms.iter_mut().enumerate() {
                    on_ms[row][column] = inverse(&curve, open_time_ms(index).max(FIRST_OPEN_MS));
                }
                let period_ms = plant.ecu.sample_time_s * 1e3;
                times.one_period_ms[row][column] = bench.open_ms(period_ms);
                times.two_periods_ms[row][column] = bench.open_ms(2.0 * period_ms);
                times.opening_ms[row][column] = bench.opening_ms();
            }
        }
        times
    }
}

/// Valve at one supply voltage and chamber pressure.
struct Bench<'a> {
    plant: &'a PlantParameters,
    valve: ValveId,
    slowness: f64,
    pressure_bar: f64,
}

impl Bench<'_> {
    /// Returns on-times and the open times that they give (ms), until no longer run is of use.
    fn curve(&self) -> Vec<[f64; 2]> {
        let last = open_time_ms(OPEN_TIMES - 1);
        let mut curve = vec![[0.0, 0.0]];
        let steps = (RUN_MAX_MS / STEP_MS).round() as usize;
        for on_ms in (1..=steps).map(|step| step as f64 * STEP_MS) {
            let open_ms = self.open_ms(on_ms);
            curve.push([on_ms, open_ms]);
            if open_ms > last {
                break;
            }
        }
        curve
    }

    /// Returns the open time after a run of `on_ms`.
    fn open_ms(&self, on_ms: f64) -> f64 {
        self.opened(on_ms, on_ms + 40.0)
    }

    /// Returns the delay of the flow of a valve that stays open.
    fn opening_ms(&self) -> f64 {
        let run_ms = 40.0;
        run_ms - self.opened(run_ms, run_ms)
    }

    /// Returns the integral of the opening, as a share of the bore, until `end_ms` of a run of `on_ms` (ms).
    fn opened(&self, on_ms: f64, end_ms: f64) -> f64 {
        let (mut plant, valve) = (self.plant.clone(), self.valve);
        plant.ecu.command_delay_s = 0.0;
        plant.ecu.supply_voltage_v /= self.slowness;
        let period_ms = plant.ecu.sample_time_s * 1e3;
        let (index, orifice_m) = match valve {
            ValveId::Fill => (FILL, plant.flow.orifice_fill_m),
            ValveId::Vent => (VENT, plant.flow.orifice_vent_m),
        };
        let mut simulator = Simulator::new(&plant);
        let pressure_pa = plant.gas.ambient_pressure_pa + self.pressure_bar * 1e5;
        simulator.set_chamber_pressure(pressure_pa);
        let (mut sum, mut left_ms) = (0.0, on_ms);
        let period_ns = plant.ecu.sample_time_ns();
        while (simulator.time_ns() as f64) < end_ms * 1e6 {
            if simulator.time_ns().is_multiple_of(period_ns) {
                let duty = (100.0 * left_ms / period_ms).clamp(0.0, 100.0);
                simulator.command(match valve {
                    ValveId::Fill => Command {
                        duty_fill_pct: duty,
                        duty_vent_pct: 0.0,
                    },
                    ValveId::Vent => Command {
                        duty_fill_pct: 0.0,
                        duty_vent_pct: duty,
                    },
                });
                left_ms -= period_ms;
            }
            simulator.advance_to_ns(simulator.time_ns() + GRID_NS);
            // Curtain until it is as large as the bore (equations 3.20 and 3.21).
            let share = simulator.state().valves[index].x / (0.25 * orifice_m);
            sum += share.min(1.0) * GRID_NS as f64 * 1e-6;
        }
        sum
    }
}

/// Returns the shortest on-time of the curve that gives this open time (ms).
fn inverse(curve: &[[f64; 2]], open_ms: f64) -> f64 {
    let crossing = curve
        .windows(2)
        .find(|pair| pair[0][1] < open_ms && pair[1][1] >= open_ms);
    match crossing {
        Some(pair) => {
            let [[on_0, open_0], [on_1, open_1]] = [pair[0], pair[1]];
            on_0 + (on_1 - on_0) * (open_ms - open_0) / (open_1 - open_0)
        }
        None => RUN_MAX_MS,
    }
}

/// Difference between the table and the model at pressures, voltages and open times between those of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableError {
    /// Root mean square of the open time's error (ms).
    pub rms_ms: f64,
    /// Largest magnitude of the open time's error (ms).
    pub max_ms: f64,
}

/// Returns the error of the open times: each on-time of the table that is interpolated halfway between its points, given
/// to the model. Pulses of more than one period and a slowness above 1.25 are left out.
pub fn table_error(plant: &PlantParameters, valve: ValveId, times: &ValveTimes) -> TableError {
    let (mut sum, mut count, mut max_ms) = (0.0, 0, 0.0_f64);
    for (row, slowness) in SLOWNESS.windows(2).enumerate().take(3) {
        for (column, pressures) in PRESSURES_BAR.windows(2).enumerate() {
            let bench = Bench {
                plant,
                valve,
                slowness: 0.5 * (slowness[0] + slowness[1]),
                pressure_bar: 0.5 * (pressures[0] + pressures[1]),
            };
            for index in 0..OPEN_TIMES - 1 {
                let expected_ms = 0.5 * (open_time_ms(index) + open_time_ms(index + 1));
                let corners = [index, index + 1].map(|index| {
                    let [low, high] = [row, row + 1].map(|row| times.on_ms[index][row]);
                    low[column] + low[column + 1] + high[column] + high[column + 1]
                });
                let on_ms = corners.iter().sum::<f64>() / 8.0;
                if on_ms > plant.ecu.sample_time_s * 1e3 {
                    continue;
                }
                let error_ms = bench.open_ms(on_ms) - expected_ms;
                sum += error_ms * error_ms;
                count += 1;
                max_ms = max_ms.max(error_ms.abs());
            }
        }
    }
    TableError {
        rms_ms: (sum / f64::from(count.max(1))).sqrt(),
        max_ms,
    }
}
