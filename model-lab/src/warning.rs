//! Warnings: properties of a log that probably differ from their declaration, so that no model could fit it.

use plant_sim::PlantParameters;
use plant_sim::parameters::PA_PER_BAR;
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::{SUPPLY_PRESSURE, UnknownSignal, drives_supply, unknown_signals};
use plant_sim::valve::ValveFunction;
use recording::{PressureReference, Recording, Signal, Unit};

use crate::commands::Commands;
use crate::measured::{Measured, PRESSURE};
use crate::metrics::present;
use crate::result::{SignalComparison, Warning, WarningKind};

/// Returns the warnings about `log`, whose signals are `measured`.
pub(crate) fn warnings(
    parameters: &PlantParameters,
    log: &Recording,
    commands: &Commands,
    measured: &[Measured],
) -> Vec<Warning> {
    let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
    let of_pressure = pressure.into_iter().flat_map(|pressure| {
        [
            swapped_valves(commands, &pressure.values),
            absolute(parameters, log, &pressure.values),
            above_supply(parameters, log, &pressure.values),
        ]
    });
    let unknown = unknown_signals(parameters, log).into_iter();
    of_pressure
        .flatten()
        .chain(unknown.map(unknown_signal))
        .collect()
}

/// Smallest sum of changes beyond noise and drift (bar).
const CHANGE_BAR: f64 = 0.3;
/// Share of all change in the wrong direction from which on two valves count as swapped; with a leak or noise it is below a half.
const WRONG_SHARE: f64 = 0.9;

fn swapped_valves(commands: &Commands, pressure: &[f64]) -> Option<Warning> {
    let [fill, vent] = [[FILL, VENT], [VENT, FILL]].map(|[only, other]| {
        Change::while_only(commands, pressure, |row| {
            commands.opens(only, row) && !commands.opens(other, row)
        })
    });
    if !(fill.is_mostly(fill.fall) && vent.is_mostly(vent.rise)) {
        return None;
    }
    Some(Warning {
        kind: WarningKind::SwappedValves,
        statement: format!(
            "{PRESSURE} falls while only the fill valve is commanded ({:.1} of {:.1} bar of change) and rises while only the \
             vent valve is ({:.1} of {:.1} bar): are duty_fill and duty_vent, or the valves, swapped? Exchange the columns \
             in a mapping, or the plugs",
            fill.fall,
            fill.sum(),
            vent.rise,
            vent.sum()
        ),
    })
}

/// Sums of pressure changes over intervals of one command (bar).
#[derive(Default)]
struct Change {
    rise: f64,
    fall: f64,
}

impl Change {
    /// Returns the sums over the intervals in which a command is in force for which `is_meant` returns true.
    fn while_only(commands: &Commands, pressure: &[f64], is_meant: impl Fn(usize) -> bool) -> Self {
        let mut change = Self::default();
        // Pressure at the beginning of an interval and at its last sample so far.
        let mut interval: Option<[f64; 2]> = None;
        let mut close = |interval: &mut Option<[f64; 2]>| {
            if let Some([begin, end]) = interval.take() {
                change.rise += (end - begin).max(0.0);
                change.fall += (begin - end).max(0.0);
            }
        };
        for (&time_s, &value) in commands.times_s.iter().zip(pressure) {
            let is_in_force = commands.row_in_force(time_s).is_some_and(&is_meant);
            if !is_in_force {
                close(&mut interval);
            } else if !value.is_nan() {
                interval = Some([interval.map_or(value, |[begin, _]| begin), value]);
            }
        }
        close(&mut interval);
        change
    }

    fn sum(&self) -> f64 {
        self.rise + self.fall
    }

    fn is_mostly(&self, part: f64) -> bool {
        part >= CHANGE_BAR && part >= WRONG_SHARE * self.sum()
    }
}

/// Pressures that a rig at rest can show (bar abs): the atmosphere at any weather and altitude of the place.
const ATMOSPHERE_BAR: std::ops::RangeInclusive<f64> = 0.9..=1.06;

fn is_gauge(log: &Recording) -> bool {
    let unit = log.signal(PRESSURE).map(Signal::unit);
    let reference = unit.and_then(Unit::pressure_reference);
    reference == Some(PressureReference::Gauge)
}

fn absolute(parameters: &PlantParameters, log: &Recording, pressure: &[f64]) -> Option<Warning> {
    let first = present(pressure).next()?;
    let least = present(pressure).fold(f64::INFINITY, f64::min);
    // An absolute pressure of a rig that is not evacuated never falls much below the atmosphere.
    if !is_gauge(log) || !ATMOSPHERE_BAR.contains(&first) || least < *ATMOSPHERE_BAR.start() {
        return None;
    }
    let ambient = parameters.gas.ambient_pressure_pa / PA_PER_BAR;
    Some(Warning {
        kind: WarningKind::AbsolutePressure,
        statement: format!(
            "{PRESSURE} begins at {first:.3} bar gauge and never falls below {least:.3}, as an absolute pressure does about the \
             atmosphere of {ambient:.3} bar: is the sensor absolute? Then declare its unit so, as in {PRESSURE}_bar_abs"
        ),
    })
}

/// Factor to the supply pressure that exceeds any sensor error.
const ABOVE_SUPPLY: f64 = 1.5;
/// Share of samples above which they are no glitch of a logger.
const NO_GLITCH: f64 = 0.1;
/// Sizes of pressure units that are confused with one another (bar), largest first.
const UNITS_BAR: [(&str, f64); 3] = [("psi", 0.068_947_57), ("kPa", 0.01), ("mbar", 0.001)];

/// Returns the highest supply pressure (bar gauge) of `log`: the logged one where it drives the model, otherwise that of the plant.
fn supply_bar(parameters: &PlantParameters, log: &Recording) -> f64 {
    let is_logged = drives_supply(parameters, log).unwrap_or(false);
    let logged = log.signal(SUPPLY_PRESSURE).filter(|_| is_logged);
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = logged.and_then(|one| one.values_at_ambient(Unit::BarGauge, ambient).ok());
    match values {
        Some(values) => present(&values).fold(0.0, f64::max),
        None => parameters.gas.supply_pressure_bar_gauge,
    }
}

/// Returns the highest pressure (bar gauge) that a sensor of the plant can show; none without a supply.
fn highest_bar(parameters: &PlantParameters, log: &Recording) -> Option<f64> {
    let supply = supply_bar(parameters, log);
    let has_supply = parameters.functions[FILL] != ValveFunction::Absent;
    (has_supply && supply > 0.0).then_some(ABOVE_SUPPLY * supply)
}

/// Returns the message that `pressure` (bar gauge) is impossible for the plant, for longer than a glitch, so that no fit can succeed.
pub(crate) fn out_of_reach(
    parameters: &PlantParameters,
    log: &Recording,
    pressure: &[f64],
) -> Option<String> {
    let highest = highest_bar(parameters, log)?;
    let above = present(pressure).filter(|&value| value > highest).count();
    if above as f64 <= NO_GLITCH * present(pressure).count() as f64 {
        return None;
    }
    above_supply(parameters, log, pressure).map(|warning| warning.statement)
}

fn above_supply(
    parameters: &PlantParameters,
    log: &Recording,
    pressure: &[f64],
) -> Option<Warning> {
    let supply = supply_bar(parameters, log);
    let largest = present(pressure).fold(0.0, f64::max);
    if largest <= highest_bar(parameters, log)? {
        return None;
    }
    let unit = UNITS_BAR
        .iter()
        .find(|(_, size_bar)| largest * size_bar <= ABOVE_SUPPLY * supply);
    let declared = log
        .signal(PRESSURE)
        .map_or("", |signal| signal.unit().symbol());
    let perhaps = match unit {
        Some((unit, size_bar)) if declared.starts_with("bar") => format!(
            "are the numbers in {unit}, which makes {:.2} bar of them? Then declare that unit; else",
            largest * size_bar
        ),
        _ => "is the unit right? If so,".to_owned(),
    };
    Some(Warning {
        kind: WarningKind::PressureAboveSupply,
        statement: format!(
            "{PRESSURE} reaches {largest:.1} bar gauge, and the supply of the plant has {supply:.1} bar: {perhaps} set \
             gas.supply_pressure_bar_gauge"
        ),
    })
}

fn unknown_signal(unknown: UnknownSignal) -> Warning {
    let UnknownSignal { name, nearest } = unknown;
    Warning {
        kind: WarningKind::UnknownSignal,
        statement: format!(
            "{name} is no signal of the model and is not used; is it {}? Then rename the column, or map it, as in \
             signal.{} = {{ column = ..., unit = ... }}",
            nearest.join(" or "),
            nearest[0]
        ),
    }
}

/// Error over the variation of the measurement from which on a current is far off: no plant file that fits any rig leaves as large an
/// error.
const FAR_OFF: f64 = 0.3;
/// Smallest lag that counts as the cause (s), ...
const LAG_MIN_S: f64 = 0.5e-3;
/// ... and the number of samples of the ECU from which on it no longer does.
const LAG_MAX_SAMPLES: f64 = 2.0;
/// Share of the mismatch of the changes that a lag must remove to count as the cause; the removed part must also be this share of the
/// error, since changes of another size correlate as well.
const ACCOUNTS_FOR: f64 = 0.5;
/// Returns the warning that rows and commands do not line up in time, for a current with such an error.
pub(crate) fn misaligned(
    parameters: &PlantParameters,
    signal: &SignalComparison,
) -> Option<Warning> {
    let is_current = signal.unit == Unit::Milliampere.symbol();
    let off = 1.0 - signal.free_run.fit_pct? / 100.0;
    if !is_current || off < FAR_OFF || signal.holds == Some(true) {
        return None;
    }
    let offset = signal.time_offset.as_ref()?;
    let lags_s = LAG_MIN_S..LAG_MAX_SAMPLES * parameters.ecu.sample_time_s;
    let is_lag = lags_s.contains(&(1e-3 * offset.lag_ms.abs()));
    let explained = offset.correlation_shifted.powi(2) - offset.correlation_unshifted.powi(2);
    let is_all = offset.mismatch_explained >= ACCOUNTS_FOR
        && explained >= ACCOUNTS_FOR * off.min(1.0).powi(2);
    if !is_lag || !is_all {
        return None;
    }
    let statement = format!(
        "{} is off by {:.0} % of its own variation, and a shift by {:.1} ms accounts for {:.0} % of the mismatch of its changes: rows \
         and commands do not line up in time. Let retarder refine find the clock of the logger and ecu.command_delay_s, or log \
         commands and currents with one clock",
        signal.name,
        100.0 * off,
        offset.lag_ms.abs(),
        100.0 * offset.mismatch_explained
    );
    Some(Warning {
        kind: WarningKind::Misaligned,
        statement,
    })
}

#[cfg(test)]
mod tests {
    use recording::{Provenance, TimeBase};

    use super::*;
    use crate::bench::Bench;
    use crate::{CompareOptions, compare};

    /// Returns the kinds of the warnings about a log.
    fn kinds(log: &Recording) -> Vec<WarningKind> {
        let plant = PlantParameters::nominal();
        let comparison = compare(&plant, log, &CompareOptions::default()).unwrap();
        let warnings = comparison.warnings.iter();
        warnings.map(|warning| warning.kind).collect()
    }

    /// Returns the log with each signal changed by `change`: its name, and its values.
    fn changed(log: &Recording, change: impl Fn(&str, f64) -> (&'static str, f64)) -> Recording {
        let mut other = Recording::new(Provenance::from_source("changed"));
        let (_, base) = log.time_bases().next().unwrap();
        let id = other.add_time_base(TimeBase::new(base.times_s().to_vec()).unwrap());
        for signal in log.signals() {
            let values = signal.values_or_nan().iter();
            let name = change(signal.name(), 0.0).0;
            let values = values.map(|value| change(signal.name(), *value).1);
            other
                .add_signal(name, signal.unit(), id, values.collect())
                .unwrap();
        }
        other
    }

    fn named(name: &str) -> &'static str {
        let all = plant_sim::replay::ROW_SIGNALS.into_iter();
        let mut found = all.map(|(known, _)| known).filter(|known| *known == name);
        found.next().unwrap()
    }

    #[test]
    fn a_sound_log_is_not_doubted_even_with_a_leak() {
        assert_eq!(kinds(&Bench::default().measure()), []);
        let leaking = Bench {
            leak_per_s: 2.0,
            ..Bench::default()
        };
        assert_eq!(kinds(&leaking.measure()), []);
    }

    #[test]
    fn swapped_commands_are_seen_by_the_signs() {
        let log = Bench::default().measure();
        let swapped = changed(&log, |name, value| match name {
            "duty_fill" => ("duty_vent", value),
            "duty_vent" => ("duty_fill", value),
            other => (named(other), value),
        });
        assert_eq!(kinds(&swapped), [WarningKind::SwappedValves]);
    }

    /// A delay that is wrong by most of a PWM period was reported as the regime of the error.
    #[test]
    fn a_current_that_is_late_is_reported_as_late_and_not_placed() {
        let pulses = [
            (0.03, 80.0, 0.0),
            (0.07, 0.0, 0.0),
            (0.03, 0.0, 80.0),
            (0.07, 0.0, 0.0),
        ];
        let mut phases = vec![(1.0, 0.0, 0.0)];
        phases.extend(pulses.into_iter().cycle().take(80));
        let bench = Bench {
            phases,
            ..Bench::default()
        };
        let of = |log: &Recording, plant: &PlantParameters| {
            compare(plant, log, &CompareOptions::default()).unwrap()
        };
        let mut late = bench.plant.clone();
        late.ecu.command_delay_s += 7e-3;
        let comparison = of(&bench.measure(), &late);
        let kinds: Vec<_> = comparison.warnings.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [WarningKind::Misaligned; 2]);
        let statement = &comparison.warnings[0].statement;
        assert!(statement.contains("a shift by 7."), "{statement}");
        for signal in comparison.signals.iter().filter(|one| one.name != "p_ch") {
            assert_eq!(signal.finding.regime, None, "{:?}", signal.finding);
        }
        // Another resistance of a coil is physics.
        let mut hot = bench.plant.clone();
        hot.coil.resistance_20c_ohm *= 1.8;
        assert_eq!(of(&bench.measure(), &hot).warnings, []);
    }

    #[test]
    fn an_absolute_sensor_declared_as_gauge_is_asked_for() {
        let log = Bench::default().measure();
        let absolute = changed(&log, |name, value| match name {
            "p_ch" => ("p_ch", value + 1.01325),
            other => (named(other), value),
        });
        assert_eq!(kinds(&absolute), [WarningKind::AbsolutePressure]);
        // A pressure that begins there and is vented to the atmosphere is gauge.
        let charged = Bench {
            initial_bar: 1.0,
            ..Bench::default()
        };
        assert_eq!(kinds(&charged.measure()), []);
    }

    #[test]
    fn a_pressure_above_the_supply_asks_for_the_unit() {
        let log = Bench::default().measure();
        let psi = changed(&log, |name, value| match name {
            "p_ch" => ("p_ch", value * 14.504),
            other => (named(other), value),
        });
        let plant = PlantParameters::nominal();
        let comparison = compare(&plant, &psi, &CompareOptions::default()).unwrap();
        let [warning] = &comparison.warnings[..] else {
            panic!("{:?}", comparison.warnings);
        };
        assert_eq!(warning.kind, WarningKind::PressureAboveSupply);
        assert!(
            warning.statement.contains("in psi, which makes"),
            "{warning:?}"
        );
    }

    #[test]
    fn a_log_out_of_reach_is_not_fitted_but_one_with_a_glitch_is() {
        let log = Bench::default().measure();
        let plant = PlantParameters::nominal();
        let refused =
            |log: &Recording| crate::diagnosis::remaining(&plant, core::slice::from_ref(log)).err();
        let psi = changed(&log, |name, value| match name {
            "p_ch" => ("p_ch", value * 14.504),
            other => (named(other), value),
        });
        let error = refused(&psi).expect("it is refused").to_string();
        assert!(
            error.starts_with("changed: p_ch reaches") && error.contains("in psi, which makes"),
            "{error}"
        );
        let count = core::cell::Cell::new(0);
        let glitch = changed(&log, |name, value| match name {
            "p_ch" => {
                count.set(count.get() + 1);
                let is_glitch = count.get() == 100;
                ("p_ch", if is_glitch { 140.0 } else { value })
            }
            other => (named(other), value),
        });
        assert_eq!(refused(&glitch), None);
    }
}
