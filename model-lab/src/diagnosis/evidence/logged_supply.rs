//! Supply pressure of a plant whose logs contain it. It drives the model as a signal (E60). The value of the plant file is then used where
//! there is no log: a closed loop, a planned experiment, the size of a leak.

use plant_sim::PlantParameters;
use plant_sim::parameters::{Knowledge, Part};
use recording::{Quantity, Recording, Unit};

use crate::metrics::{mean, present};

/// Name of the supply pressure, as a signal and in a plant file.
const SIGNAL: &str = "p_sup";
const PARAMETER: &str = "gas.supply_pressure_bar_gauge";
/// Possible error of a pressure gauge (bar): 0.5 % of 10 bar.
const GAUGE_BAR: f64 = 0.05;
/// Largest difference of the logged supply pressures that counts as equal (bar).
const AGREES_BAR: f64 = 0.05;

/// Returns `plant` with the supply pressure that all of `logs` show, with the accuracy of a gauge. Unchanged where a log does not show it,
/// where they differ, and where the plant file states its accuracy.
pub(crate) fn with_logged_supply<'a>(
    plant: &PlantParameters,
    logs: impl IntoIterator<Item = &'a Recording>,
) -> PlantParameters {
    let mut plant = plant.clone();
    if plant.knowledge.contains_key(PARAMETER) || !Part::Chamber.is_in(&plant) {
        return plant;
    }
    let levels: Option<Vec<f64>> = logs.into_iter().map(|log| level_bar(&plant, log)).collect();
    let Some(mean_bar) = levels.as_deref().and_then(mean) else {
        return plant;
    };
    let agrees = |level: &f64| (level - mean_bar).abs() <= AGREES_BAR;
    if mean_bar > 0.0 && levels.iter().flatten().all(agrees) {
        plant.gas.supply_pressure_bar_gauge = mean_bar;
        let knowledge = Knowledge::Tolerance(GAUGE_BAR);
        plant.knowledge.insert(PARAMETER.to_owned(), knowledge);
    }
    plant
}

/// Returns the mean supply pressure of `log` (bar gauge); none if it was not logged.
fn level_bar(plant: &PlantParameters, log: &Recording) -> Option<f64> {
    let signal = log.require(SIGNAL, Quantity::Pressure).ok()?;
    let ambient = plant.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::BarGauge, ambient).ok()?;
    let values: Vec<f64> = present(&values).collect();
    mean(&values)
}

#[cfg(test)]
mod tests {
    use recording::{Provenance, TimeBase};

    use super::*;
    use crate::bench::{Bench, with_signals};
    use crate::diagnosis::diagnose;
    use crate::diagnosis::evidence::unknowns::{Unknown, Unknowns};
    use crate::diagnosis::fit::gather::gather;
    use crate::diagnosis::result::Verdict;
    use crate::metrics::rms;
    use crate::result::Horizon;

    fn log(supply_bar: f64) -> Recording {
        let mut log = Recording::new(Provenance::from_source("log"));
        let id = log.add_time_base(TimeBase::uniform(0.0, 0.01, 3).unwrap());
        let column = vec![supply_bar - 0.01, supply_bar, supply_bar + 0.01];
        log.add_signal(SIGNAL, Unit::BarGauge, id, column).unwrap();
        log
    }

    fn supply(plant: &PlantParameters, logs: &[Recording]) -> (f64, Option<Knowledge>) {
        let plant = with_logged_supply(plant, logs);
        let value = plant.gas.supply_pressure_bar_gauge;
        (value, plant.knowledge.get(PARAMETER).copied())
    }

    #[test]
    fn a_logged_supply_pressure_is_taken_as_a_gauge_knows_it() {
        let plant = PlantParameters::nominal();
        let (value, knowledge) = supply(&plant, &[log(8.1), log(8.12)]);
        assert!((value - 8.11).abs() < 1e-9, "{value}");
        assert_eq!(knowledge, Some(Knowledge::Tolerance(GAUGE_BAR)));
    }

    #[test]
    fn what_the_plant_file_states_and_what_logs_differ_in_stays() {
        let mut plant = PlantParameters::nominal();
        let there = plant.gas.supply_pressure_bar_gauge;
        assert_eq!(supply(&plant, &[log(8.1), log(8.3)]), (there, None));
        let exact = Knowledge::Exact;
        plant.knowledge.insert(PARAMETER.to_owned(), exact);
        assert_eq!(supply(&plant, &[log(8.1)]), (there, Some(exact)));
    }

    /// Returns the supply pressure of a compressor that is too small: it falls by a bar within ten seconds.
    fn sinking(time_s: f64) -> f64 {
        8.4 - 0.1 * time_s
    }

    fn without_supply(log: &Recording) -> Recording {
        with_signals(log, |name| name != SIGNAL)
    }

    fn sinking_supply() -> Recording {
        let bench = Bench {
            supply_bar: Some(sinking),
            ..Bench::default()
        };
        bench.measure()
    }

    /// Returns the rms of the pressure's errors over the noise, driven by the commands alone.
    fn error(log: &Recording) -> f64 {
        let plant = PlantParameters::nominal();
        let evidence = gather(&plant, [log]).unwrap();
        let residuals = evidence.residuals(&plant, Horizon::FreeRun).unwrap();
        let (_, _, range) = evidence.channels().next().unwrap();
        rms(&residuals[range]).unwrap()
    }

    #[test]
    fn a_supply_that_sinks_drives_the_model_where_it_was_logged() {
        let log = sinking_supply();
        let (with, without) = (error(&log), error(&without_supply(&log)));
        assert!(with < 1.2 && without > 10.0, "{with} {without}");
    }

    #[test]
    fn nothing_is_missing_from_a_model_that_a_sinking_supply_drives() {
        let nominal = PlantParameters::nominal();
        let diagnosis = diagnose(&nominal, &[sinking_supply()], &[], &|_| {
            core::ops::ControlFlow::Continue(())
        });
        assert_eq!(diagnosis.unwrap().verdict, Verdict::Adequate);
    }

    /// The level of the supply is free where no log has it, and the offset of its gauge where one has.
    #[test]
    fn a_fit_moves_the_gauge_and_not_the_supply_that_it_shows() {
        let logged = sinking_supply();
        let bare = without_supply(&logged);
        let fitted = |logs: &[&Recording]| {
            let nominal = PlantParameters::nominal();
            let evidence = gather(&nominal, logs.iter().copied()).unwrap();
            let unknowns = Unknowns::new(&nominal, &[], &evidence.logs);
            let names = unknowns.list().iter().filter_map(|unknown| match unknown {
                Unknown::Nuisance(nuisance) => Some(nuisance.spec.name()),
                Unknown::Log(_) | Unknown::Effect { .. } => None,
            });
            let names: Vec<String> = names.collect();
            [PARAMETER, "gas.supply_gauge_offset_bar"]
                .map(|name| names.iter().any(|one| one == name))
        };
        assert_eq!(fitted(&[&logged]), [false, true]);
        assert_eq!(fitted(&[&bare]), [true, false]);
        assert_eq!(fitted(&[&logged, &bare]), [true, true]);
    }
}
