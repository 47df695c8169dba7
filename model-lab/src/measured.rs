//! Measured signals of the comparison in the unit of the model, with their noise and the start of the simulation.

use std::ops::Range;
use std::sync::Arc;

use plant_sim::PlantParameters;
use plant_sim::parameters::PA_PER_BAR;
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::{SUPPLY_PRESSURE, drives_supply, signals, unknown_signals};
use recording::{
    Bounds, OwnSamples, PressureReference, Quantity, Recording, Signal, TimeBase, Unit,
    median_step_s,
};

use crate::commands::{Commands, DUTIES, shared};
use crate::error::CompareError;
use crate::gaps::Gap;
use crate::metrics::{mean, present};
use crate::noise_floor::{Floor, Quiet, noise_floor};
use crate::repeats::{Repeat, take_out_repeats};
use crate::result::{NotCompared, Start, StartFrom, error_unit};
use crate::spikes::{Spike, Swing, Usual, take_out_spikes};

/// Measured signal that corrects the predictor.
pub(crate) const PRESSURE: &str = "p_ch";
/// Signals of a log that a fit uses; armature positions exist only in the model.
pub(crate) const FITTED_SIGNALS: [&str; 3] = [PRESSURE, "i_fill", "i_vent"];
/// Gas temperature, which a fit uses where the plant has a variable one.
pub(crate) const GAS_TEMPERATURE: &str = "t_gas";

/// Returns whether a fit of a plant like `parameters` uses the signal `name`.
pub(crate) fn is_fitted_signal(parameters: &PlantParameters, name: &str) -> bool {
    let has_temperature = || {
        let effect = parameters.effect("gas_temperature");
        effect.is_some_and(|effect| !effect.is_off())
    };
    FITTED_SIGNALS.contains(&name) || (name == GAS_TEMPERATURE && has_temperature())
}

/// Returns whether the signal `name` is a coil current.
pub(crate) fn is_current(name: &str) -> bool {
    name.starts_with("i_")
}
/// Inputs of the model, which are no results of it.
const INPUTS: [&str; 3] = [DUTIES[FILL], DUTIES[VENT], "u_bat"];
/// Largest difference of a first pressure from ambient (bar) that counts as a start at rest ...
const REST_BAR: f64 = 0.05;
/// ... and the same in noise standard deviations.
const REST_SIGMAS: f64 = 5.0;
/// Time over which the initial pressure is averaged, at most (s).
const START_S: f64 = 1.0;
/// Scatter about a line, in noise standard deviations, above which values count as curved; fewer than twice `FEWEST_OF_LINE` values are not
/// tested.
const CURVED_SIGMAS: f64 = 1.5;
const FEWEST_OF_LINE: usize = 4;

/// Signal of the log in the unit of the model.
pub(crate) struct Measured {
    pub(crate) name: &'static str,
    /// Unit of the values.
    pub(crate) unit: Unit,
    /// Whether an absolute pressure was logged, from which `ambient` was subtracted.
    pub(crate) is_absolute: bool,
    /// Unit of the errors.
    pub(crate) error_unit: Unit,
    /// Values, NaN where missing, and where only other signals were sampled.
    pub(crate) values: Arc<Vec<f64>>,
    /// Median time from sample to sample (s).
    pub(crate) interval_s: f64,
    /// Its time base in the log and the rows of the comparison at these instants, if it has another rate than other signals.
    pub(crate) own: Option<(TimeBase, Vec<usize>)>,
    pub(crate) floor: Floor,
    /// Ambient pressure of the plant (Pa abs).
    pub(crate) ambient: f64,
    /// Number of samples below vacuum at the ambient pressure of the plant: they count as missing.
    pub(crate) below_vacuum: usize,
    /// Samples that repeat or stand out alone: they count as missing.
    pub(crate) repeats: Vec<Repeat>,
    pub(crate) spikes: Vec<Spike>,
    /// Rows at which the model restarts after a gap; of the chamber pressure only.
    pub(crate) restarts: Vec<Restart>,
}

/// Row at which the model restarts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Restart {
    /// Last row that counts in no error.
    pub(crate) row: usize,
    /// Measured chamber pressure there (Pa abs).
    pub(crate) pressure: f64,
    /// Variance of that pressure over that of the noise.
    pub(crate) variance: f64,
    /// Standard deviation of the noise (bar).
    pub(crate) noise_bar: f64,
}

impl Restart {
    /// Returns the restart at `row` from a list in order of rows.
    pub(crate) fn at(restarts: &[Self], row: usize) -> Option<&Self> {
        let place = restarts.binary_search_by_key(&row, |restart| restart.row);
        place.ok().map(|place| &restarts[place])
    }

    /// Returns the last restart in `rows` from a list in order of rows.
    pub(crate) fn last_in<'a>(restarts: &'a [Self], rows: &Range<usize>) -> Option<&'a Self> {
        let next = restarts.partition_point(|restart| restart.row < rows.end);
        let last = restarts[..next].last()?;
        rows.contains(&last.row).then_some(last)
    }
}

impl Measured {
    /// Returns the coil that the signal belongs to; none for a pressure.
    pub(crate) fn coil(&self) -> Option<usize> {
        match self.name {
            "i_fill" | "x_fill" => Some(FILL),
            "i_vent" | "x_vent" => Some(VENT),
            _ => None,
        }
    }
}

/// Log in the two forms in which its signals are used.
#[derive(Clone, Copy)]
pub(crate) struct LogAsRead<'a> {
    /// All signals on one time base.
    pub(crate) log: &'a Recording,
    /// Log as it was read.
    pub(crate) original: &'a Recording,
}

/// Returns every signal of the log that the model has, and those which have the name but cannot be compared.
pub(crate) fn measured_signals(
    parameters: &PlantParameters,
    read: LogAsRead<'_>,
    commands: &Commands,
) -> Result<(Vec<Measured>, Vec<NotCompared>), CompareError> {
    let LogAsRead { log, original } = read;
    let at_the_earliest = commands.at_the_earliest();
    let modelled: Vec<(&'static str, Unit)> = signals(parameters)
        .filter(|(name, _)| !INPUTS.contains(name))
        .collect();
    let mut measured = Vec::new();
    let mut not_compared = Vec::new();
    for &(name, unit) in &modelled {
        if !log.mentions(name) {
            continue;
        }
        let mut refuse = |reason: &str| {
            not_compared.push(NotCompared {
                name: name.to_owned(),
                reason: reason.to_owned(),
            })
        };
        if let Some(reason) = log.reason_left_out(name) {
            refuse(reason);
            continue;
        }
        let signal = log.require(name, unit.quantity())?;
        if signal.missing_count() == signal.len() {
            refuse("every sample is missing");
            continue;
        }
        let ambient = parameters.gas.ambient_pressure_pa;
        let mut values = signal.values_at_ambient(unit, ambient)?;
        let below_vacuum = match unit {
            Unit::BarGauge => take_out_vacuum(&mut values, ambient),
            _ => 0,
        };
        let shown = (name == PRESSURE && !commands.gaps.is_empty()).then(|| values.clone());
        commands.gaps.blank(&mut values);
        if present(&values).next().is_none() {
            refuse("every sample is missing, below vacuum or in a gap");
            continue;
        }
        let error_unit = error_unit(unit);
        let quiet = Quiet::of_signal(name);
        let floor = |values: &[f64]| noise_floor(values, error_unit.symbol(), quiet, commands);
        let as_logged = floor(&values);
        let interval_s = interval_s(&commands.times_s, &values);
        let swing = (name == PRESSURE).then(|| Swing::of(parameters, &at_the_earliest));
        let usual = Usual::of(
            &as_logged,
            interval_s,
            quiet.segments(&at_the_earliest),
            swing,
        );
        let spikes = take_out_spikes(&commands.times_s, &mut values, &usual);
        let repeats = take_out_repeats(&mut values, &as_logged);
        let floor = match repeats.is_empty() && spikes.is_empty() {
            true => as_logged,
            false => floor(&values),
        };
        let restarts = shown.map_or_else(Vec::new, |shown| {
            restarts(&shown, commands, floor.sigma, ambient)
        });
        measured.push(Measured {
            name,
            unit,
            is_absolute: signal.unit().pressure_reference() == Some(PressureReference::Absolute),
            error_unit,
            interval_s,
            own: own_base(name, read),
            values: shared(original.signal(name).map(Signal::shared_values), values),
            floor,
            ambient,
            below_vacuum,
            repeats,
            spikes,
            restarts,
        });
    }
    if measured.is_empty() {
        if let Some(first) = not_compared.into_iter().next() {
            return Err(CompareError::NotComparable {
                log: log.provenance().source.clone(),
                name: first.name,
                reason: first.reason,
            });
        }
        return Err(CompareError::NothingToCompare {
            log: log.provenance().source.clone(),
            logged: log
                .signals()
                .iter()
                .map(|signal| signal.name().to_owned())
                .collect(),
            modelled: modelled
                .into_iter()
                .map(|(name, _)| name.to_owned())
                .collect(),
            meant: unknown_signals(parameters, log),
        });
    }
    if let Err(reason) = drives_supply(parameters, log) {
        not_compared.push(NotCompared {
            name: SUPPLY_PRESSURE.to_owned(),
            reason: format!("it does not drive the model: {reason}"),
        });
    }
    Ok((measured, not_compared))
}

/// Returns the time base of the signal `name` in the log as it was read, and the rows of its instants in the united log; none if these are
/// all rows.
fn own_base(name: &str, read: LogAsRead<'_>) -> Option<(TimeBase, Vec<usize>)> {
    let (all, own) = (
        read.log.time_base_of(name)?,
        read.original.time_base_of(name)?,
    );
    (own != all).then(|| (own.clone(), own.rows_in(all)))
}

/// Returns the median time from sample to sample (s) of a signal at the instants `times_s`; infinite for a single sample.
fn interval_s(times_s: &[f64], values: &[f64]) -> f64 {
    let own = OwnSamples::of(times_s, values);
    let step_s = median_step_s(own.as_ref().map_or(times_s, |own| &own.times_s));
    step_s.unwrap_or(f64::INFINITY)
}

/// Returns the least chamber pressure (Pa abs) at which a model can start.
fn least_pressure() -> f64 {
    Bounds::of(Quantity::Pressure).least * PA_PER_BAR
}

/// Marks pressures (bar gauge) as missing that are below vacuum where the ambient pressure is `ambient` (Pa abs), and returns their number.
fn take_out_vacuum(values: &mut [f64], ambient: f64) -> usize {
    let is_below = |value: &&mut f64| **value * PA_PER_BAR + ambient < least_pressure();
    let below = values.iter_mut().filter(is_below);
    below.map(|value| *value = f64::NAN).count()
}

/// Returns the rows at which the model restarts after each gap, from the measured pressures (bar gauge), also within gaps: every row from
/// the first one with a command to the last one that counts in no error, so that a slow sensor follows the actual pressure.
fn restarts(shown: &[f64], commands: &Commands, sigma: f64, ambient: f64) -> Vec<Restart> {
    let holds = commands.holds(0.0);
    let restart = |gap: &Gap| {
        let row = gap.rows.end.checked_sub(1)?;
        // Until something moves, every sample shows the pressure of the last row of the gap.
        let next = holds.partition_point(|hold| hold.start < gap.rows.end);
        let hold = holds.get(next).filter(|hold| hold.start == gap.rows.end);
        let soon_s = commands.times_s[row] + START_S;
        let soon = commands.times_s.partition_point(|&time_s| time_s <= soon_s);
        let end = hold.map_or(row + 1, |hold| hold.end.min(soon).max(row + 1));
        let rows = row..end;
        let still = Still {
            times_s: &commands.times_s[rows.clone()],
            values: &shown[rows.clone()],
        };
        let level_bar = level_above_vacuum(still, sigma, ambient);
        let pressure = |level_bar: f64| level_bar * PA_PER_BAR + ambient;
        // None where a pressure of a lower rate has no sample there: then its last sample before counts.
        let last = level_bar.map(|level_bar| Restart {
            row,
            pressure: pressure(level_bar),
            variance: 1.0 / present(&shown[rows]).count() as f64,
            noise_bar: sigma,
        });
        let behind = commands
            .times_s
            .partition_point(|&time_s| time_s < gap.end_s);
        let shown_bar = shown.iter().enumerate().take(row).skip(behind);
        let rows = shown_bar.map(move |(row, &shown_bar)| Restart {
            row,
            pressure: pressure(shown_bar),
            variance: 1.0,
            noise_bar: sigma,
        });
        let sound = rows.filter(|restart| restart.pressure >= least_pressure());
        Some(sound.chain(last))
    };
    commands.gaps.iter().filter_map(restart).flatten().collect()
}

/// Samples while nothing moves.
#[derive(Clone, Copy)]
struct Still<'a> {
    times_s: &'a [f64],
    /// Values; NaN if missing.
    values: &'a [f64],
}

/// Returns the same as [`first_level`], but rejects a line that leads below vacuum.
fn level_above_vacuum(still: Still<'_>, sigma: f64, ambient: f64) -> Option<f64> {
    let is_above = |level: &f64| *level * PA_PER_BAR + ambient >= least_pressure();
    let level = first_level(still, sigma).filter(is_above);
    level.or_else(|| present(still.values).next())
}

/// Returns the value at the first instant: the mean of the values, or the line through them where they drift by more than `sigma`. Of
/// values on a curve, as those of gas that cools, only as many are used as lie on a line.
fn first_level(still: Still<'_>, sigma: f64) -> Option<f64> {
    let line = Line::through(still)?;
    let Still { times_s, values } = still;
    let half = values.len() / 2;
    if sigma > 0.0 && half >= FEWEST_OF_LINE && line.scatter > CURVED_SIGMAS * sigma {
        let first_half = Still {
            times_s: &times_s[..half],
            values: &values[..half],
        };
        return first_level(first_half, sigma);
    }
    let drifts = sigma > 0.0 && line.slope.abs() * line.spread_s > REST_SIGMAS * sigma;
    Some(match drifts {
        true => line.mean + line.slope * (times_s[0] - line.mean_s),
        false => line.mean,
    })
}

/// Straight line through values.
struct Line {
    mean_s: f64,
    mean: f64,
    /// Slope per second (1/s).
    slope: f64,
    /// Root of the sum of the squared times about their mean (s).
    spread_s: f64,
    /// Standard deviation of the values about the line.
    scatter: f64,
}

impl Line {
    /// Returns the least-squares line; none through no values. NaN is missing.
    fn through(Still { times_s, values }: Still<'_>) -> Option<Self> {
        let mean = mean(values)?;
        let shown = || {
            let pairs = times_s.iter().zip(values);
            pairs.filter(|(_, value)| !value.is_nan())
        };
        let n = shown().count() as f64;
        let mean_s = shown().map(|(time_s, _)| time_s).sum::<f64>() / n;
        let (tt, ty, yy) = shown().fold((0.0, 0.0, 0.0), |(tt, ty, yy), (time_s, value)| {
            let (t, y) = (time_s - mean_s, value - mean);
            (tt + t * t, ty + t * y, yy + y * y)
        });
        let slope = if tt > 0.0 { ty / tt } else { 0.0 };
        let square = (yy - slope * ty).max(0.0);
        Some(Self {
            mean_s,
            mean,
            slope,
            spread_s: tt.sqrt(),
            scatter: (square / (n - 2.0).max(1.0)).sqrt(),
        })
    }
}

/// Returns the start of the model: at rest, or at the measured pressure (Pa abs) if that is away from ambient.
pub(crate) fn start(
    parameters: &PlantParameters,
    pressure: Option<&Measured>,
    commands: &Commands,
) -> (Start, Option<f64>) {
    let at_rest = |statement: String| {
        (
            Start {
                from: StartFrom::Rest,
                pressure_bar_gauge: 0.0,
                statement,
            },
            None,
        )
    };
    let Some(pressure) = pressure else {
        return at_rest("from rest: the log has no chamber pressure".to_owned());
    };
    // Until something moves, every sample shows the initial pressure; their mean has less noise than the first.
    let soon = commands
        .times_s
        .partition_point(|&time_s| time_s <= START_S);
    let rows = commands.rows_before_first_action().clamp(1, soon);
    let still = Still {
        times_s: &commands.times_s[..rows],
        values: &pressure.values[..rows],
    };
    let ambient = parameters.gas.ambient_pressure_pa;
    let level = level_above_vacuum(still, pressure.floor.sigma, ambient);
    let Some(initial_bar) = level.or_else(|| present(&pressure.values).next()) else {
        return at_rest("from rest: every sample of the chamber pressure is missing".to_owned());
    };
    let close_bar = REST_BAR.max(REST_SIGMAS * pressure.floor.sigma);
    if initial_bar.abs() <= close_bar {
        return at_rest(format!(
            "from rest: the first measured pressure, {initial_bar:.3} bar gauge, is within {close_bar:.3} bar of ambient"
        ));
    }
    let start = Start {
        from: StartFrom::Measurement,
        pressure_bar_gauge: initial_bar,
        statement: format!(
            "from the measured pressure, {initial_bar:.3} bar gauge, which is away from ambient"
        ),
    };
    (start, Some(initial_bar * PA_PER_BAR + ambient))
}

#[cfg(test)]
mod tests {
    use super::{Still, first_level};

    /// Gas after a fast filling loses half a bar while it cools. A line through a second of it began a quarter of a bar too low.
    #[test]
    fn the_first_level_of_cooling_gas_is_that_of_the_first_rows() {
        let times_s: Vec<f64> = (0..100).map(|row| f64::from(row) * 0.01).collect();
        let noise = |row: usize| 1e-3 * [1.0, -1.0, 0.5, -0.5][row % 4];
        let level = |values: &[f64]| {
            let times_s = &times_s[..];
            first_level(Still { times_s, values }, 1e-3).unwrap()
        };
        let cooling = |(row, time_s): (usize, &f64)| 8.0 + 0.5 * (-time_s / 0.3).exp() + noise(row);
        let cooling: Vec<f64> = times_s.iter().enumerate().map(cooling).collect();
        assert!((level(&cooling) - 8.5).abs() < 0.01, "{}", level(&cooling));
        let sinking = |(row, time_s): (usize, &f64)| 8.0 - 0.2 * time_s + noise(row);
        let sinking: Vec<f64> = times_s.iter().enumerate().map(sinking).collect();
        assert!((level(&sinking) - 8.0).abs() < 1e-3, "{}", level(&sinking));
        let still: Vec<f64> = (0..100).map(|row| 8.0 + noise(row)).collect();
        assert!((level(&still) - 8.0).abs() < 1e-9, "{}", level(&still));
    }
}
