//! Excitation that determines parameters which the plant file leaves undetermined.
//!
//! The plant file states how well each value is known; a refined one contains the knowledge from the logs. Each excitation is simulated
//! with the unchanged plant, with the noise of the logs, and differentiated with respect to all free parameters. The curvature, with the
//! statements of the plant file, gives the interval that a fit to it would have.

use core::cmp::Ordering;

use nalgebra::DMatrix;
use plant_sim::PlantParameters;
use recording::Recording;

use super::assemble::phases;
use super::check_parts;
use super::determine_result::{
    DETERMINING_EXPERIMENT_SCHEMA, DeterminingExperiment, DeterminingTestSignal, ForeseenParameter,
};
use super::distance::{Noises, Unseen, made};
use super::result::Limits;
use super::test_signal::{self, Sequence};
use super::{NoneRanked, ranked};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::estimation::{DETERMINED, measure_weak_directions};
use crate::diagnosis::evidence::effect_unknown::EVEN_SD;
use crate::diagnosis::evidence::logged_supply::with_logged_supply;
use crate::diagnosis::evidence::unknowns::{Unknown, Unknowns};
use crate::diagnosis::fit::gather::gather;
use crate::diagnosis::fit::interval::{NORMAL_95, between_programs};
use crate::diagnosis::fit::trial::Bench;
use crate::diagnosis::fit::{Difference, Fitter};
use crate::diagnosis::knowledge::{named, state_first_file};
use crate::diagnosis::nuisance::first_file_spread;
use crate::diagnosis::search::{Watch, report};

/// Ratio of the intervals after and before an experiment at which a parameter counts as determined that is already well known but requested
/// by its name.
const HALVED: f64 = 0.5;

/// Ranks excitations within `limits` by how well they determine `what`: parameters `section.key`, the ordinary parameters of a table such
/// as `coil`, or `all` ordinary parameters. `plant` states how well each is known now; without a statement, as in a first plant file.
/// `logs` provide the available signals and their noise.
///
/// # Errors
/// [`DiagnoseError`]: the plant lacks a valve or the chamber, a log cannot be used, there is no such parameter or it counts as exact, no
/// excitation satisfies the limits or can be simulated, or `watch` stopped the search.
pub fn determining_experiment(
    plant: &PlantParameters,
    logs: &[Recording],
    what: &[&str],
    limits: Limits,
    watch: Watch,
) -> Result<DeterminingExperiment, DiagnoseError> {
    let first = logs.first().ok_or(DiagnoseError::NoLog)?;
    check_parts(plant)?;
    let mut plant = with_logged_supply(plant, logs);
    state_first_file(&mut plant);
    let plant = &plant;
    let evidence = gather(plant, logs)?;
    let bench = Bench {
        library: &[],
        plant,
        fitting: &evidence,
        checking: &evidence,
    };
    report(watch, "the plant as given", 0.0)?;
    let unknowns = Unknowns::new(plant, &plant.effects, &evidence.logs);
    let given = Fitter::new(&evidence, &unknowns).at(unknowns.start());
    let given = given.and_then(|fit| bench.judge(plant.effects.clone(), unknowns, fit));
    let given = given.ok_or_else(|| DiagnoseError::NotSimulated {
        log: first.provenance().source.clone(),
    })?;
    let is_adequate = !given.is_material();
    let (unknowns, _) = given.unknowns.without_logs();
    let asked = asked(plant, &unknowns, what)?;
    let is_named = |&n: &usize| what.contains(&&*unknowns.list()[n].name());
    let by_name = asked.iter().copied().filter(is_named).collect();
    let foresight = Foresight {
        plant,
        noises: Noises::of(&evidence),
        // The autocorrelation of the errors of a plant that does not fit says nothing about one that does.
        memory: if is_adequate {
            given.correlation_samples
        } else {
            1.0
        },
        unknowns,
        asked,
        by_name,
    };
    let sequences = test_signal::sequences(&[plant], &limits)?;
    let test_signals = sequences.len();
    report(watch, "test signals", 0.0)?;
    let foresee = |sequence: &Sequence| foresight.of(sequence);
    let found = ranked(sequences, watch, foresee, Foreseen::order);
    let found = found.map_err(|none| match none {
        NoneRanked::Stopped(error) => error,
        NoneRanked::NotSimulated { .. } | NoneRanked::NotShown => {
            DiagnoseError::NoTestSignalSimulated { test_signals }
        }
    })?;
    Ok(foresight.experiment(evidence.sources(), is_adequate, limits, &found))
}

/// Returns the indices in the list of `unknowns` of the parameters that `what` names.
fn asked(
    plant: &PlantParameters,
    unknowns: &Unknowns,
    what: &[&str],
) -> Result<Vec<usize>, DiagnoseError> {
    let place = |name: &str| {
        let mut list = unknowns.list().iter();
        list.position(|unknown| unknown.name() == name)
    };
    let mut places = Vec::new();
    for &what in what {
        let names = named(plant, what)?;
        let found: Vec<usize> = names.iter().filter_map(|name| place(name)).collect();
        if found.is_empty() {
            let name = names.into_iter().next().unwrap_or_default();
            let spec = plant.specs().find(|spec| spec.name() == name);
            return Err(DiagnoseError::Exact {
                value: plant.get(&name).unwrap_or_default(),
                unit: spec.map_or("", |spec| spec.unit),
                name,
            });
        }
        places.extend(found);
    }
    places.sort_unstable();
    places.dedup();
    Ok(places)
}

/// Expected result of an excitation.
#[derive(Debug, Clone, PartialEq)]
struct Foreseen {
    /// Half widths of the 95 % intervals of the requested parameters, in their coordinates.
    half_widths: Vec<f64>,
    /// Number of parameters that become determined.
    determined: usize,
    /// Geometric mean of the widths after the experiment over those now.
    width_after: f64,
}

impl Foreseen {
    /// Compares two results: more determined parameters first, then smaller widths.
    fn order(&self, other: &Self) -> Ordering {
        let by_count = other.determined.cmp(&self.determined);
        by_count.then(self.width_after.total_cmp(&other.width_after))
    }
}

/// Prediction of the intervals after fits to excitations.
struct Foresight<'a> {
    plant: &'a PlantParameters,
    noises: Noises,
    /// Autocorrelation time of the errors (samples).
    memory: f64,
    unknowns: Unknowns,
    /// Indices of the requested parameters in the list of unknowns.
    asked: Vec<usize>,
    /// Parameters that were requested by their names: they count as undetermined however well the plant file knows them.
    by_name: Vec<usize>,
}

impl Foresight<'_> {
    fn of(&self, sequence: &Sequence) -> Result<Foreseen, Unseen> {
        let log = made(self.plant, sequence, &self.noises).ok_or(Unseen::NotSimulated)?;
        let evidence = gather(self.plant, [&log]).map_err(|_| Unseen::NotSimulated)?;
        let fitter = Fitter::accurate(&evidence, &self.unknowns);
        let mut fit = fitter
            .at(self.unknowns.start())
            .ok_or(Unseen::NotSimulated)?;
        fitter
            .differentiate(&mut fit, 0, Difference::Fine)
            .ok_or(Unseen::NotSimulated)?;
        measure_weak_directions(&fitter, &mut fit);
        let (mut curvature, _) = fitter.normal(&fit);
        let list = self.unknowns.list();
        for a in 0..list.len() {
            for b in 0..list.len() {
                let known = if a == b {
                    list[a].prior_sd().powi(-2)
                } else {
                    0.0
                };
                curvature[(a, b)] = (curvature[(a, b)] - known) / self.memory + known;
            }
            if list[a].prior_sd().is_infinite() {
                curvature[(a, a)] += list[a].believed_sd().powi(-2);
            }
        }
        let covariance = curvature.try_inverse().ok_or(Unseen::NotSimulated)?;
        Ok(self.foreseen(&covariance))
    }

    fn foreseen(&self, covariance: &DMatrix<f64>) -> Foreseen {
        let widths: Vec<f64> = self
            .asked
            .iter()
            .map(|&n| {
                let of_noise = NORMAL_95 * covariance[(n, n)].max(0.0).sqrt();
                between_programs(&self.unknowns.list()[n], of_noise)
            })
            .collect();
        let open = self.asked.iter().zip(&widths);
        let open = open.filter(|&(&n, _)| !self.is_known(n));
        let (mut determined, mut logarithms, mut count) = (0, 0.0, 0);
        for (&n, &width) in open {
            determined += usize::from(self.would_determine(n, width));
            logarithms += (width / self.now(n)).min(1.0).ln();
            count += 1;
        }
        Foreseen {
            half_widths: widths,
            determined,
            width_after: (logarithms / f64::from(count.max(1))).exp(),
        }
    }

    /// Returns the half width according to the plant file, in the coordinate.
    fn now(&self, n: usize) -> f64 {
        let unknown = &self.unknowns.list()[n];
        let (least, most) = unknown.bounds();
        (0.5 * (most - least)).min(NORMAL_95 * unknown.believed_sd())
    }

    /// Returns whether the plant file determines the parameter, so that no excitation needs to.
    fn is_known(&self, n: usize) -> bool {
        !self.by_name.contains(&n) && self.is_determined(n, self.now(n))
    }

    /// Returns whether an experiment that leaves this half width determines the parameter.
    fn would_determine(&self, n: usize, half_width: f64) -> bool {
        let now = self.now(n);
        let is_gain = half_width <= HALVED * now || !self.is_determined(n, now);
        is_gain && self.is_determined(n, half_width)
    }

    /// Returns whether a half width is a small fraction of that of a first plant file.
    fn is_determined(&self, n: usize, half_width: f64) -> bool {
        let unknown = &self.unknowns.list()[n];
        let first_file = match unknown {
            Unknown::Nuisance(nuisance) => {
                let name = nuisance.spec.name();
                first_file_spread(&name, nuisance.datasheet)
                    .map(|spread| NORMAL_95 * EVEN_SD * spread / nuisance.tolerance)
            }
            Unknown::Effect(_) | Unknown::Log(_) => None,
        };
        half_width <= DETERMINED * first_file.unwrap_or_else(|| NORMAL_95 * unknown.believed_sd())
    }

    fn experiment(
        &self,
        logs: Vec<String>,
        is_adequate: bool,
        limits: Limits,
        ranked: &[(Sequence, Foreseen)],
    ) -> DeterminingExperiment {
        let (best, foreseen) = &ranked[0];
        let parameters = self.asked.iter().zip(&foreseen.half_widths);
        let parameters: Vec<_> = parameters
            .map(|(&n, &half_width)| self.parameter(n, half_width))
            .collect();
        DeterminingExperiment {
            schema: DETERMINING_EXPERIMENT_SCHEMA.to_owned(),
            logs,
            is_adequate,
            limits,
            sample_time_s: best.interval_s,
            sentence: sentence(best.name, &parameters),
            parameters,
            sequence: phases(best),
            ranking: ranked
                .iter()
                .map(|(sequence, foreseen)| self.test_signal(sequence, foreseen))
                .collect(),
        }
    }

    fn parameter(&self, n: usize, half_width: f64) -> ForeseenParameter {
        let unknown = &self.unknowns.list()[n];
        let (least, most) = unknown.bounds();
        let z = self.unknowns.start()[n];
        let around = |half: f64| {
            let ends = [z - half, z + half].map(|z| unknown.value(z.clamp(least, most)));
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        };
        let now = if unknown.prior_sd().is_finite() {
            [least, most].map(|z| unknown.value(z))
        } else {
            around(self.now(n))
        };
        let is_determined_now = self.is_known(n);
        let is_determined_after = is_determined_now || self.would_determine(n, half_width);
        ForeseenParameter {
            name: unknown.name(),
            unit: unknown.unit().to_owned(),
            value: unknown.value(z),
            now,
            after: around(half_width),
            is_determined_now,
            is_determined_after,
            determined_by: unknown.determined_by().filter(|_| !is_determined_after),
        }
    }

    fn test_signal(&self, sequence: &Sequence, foreseen: &Foreseen) -> DeterminingTestSignal {
        let determines = self.asked.iter().zip(&foreseen.half_widths);
        let determines =
            determines.filter(|&(&n, &width)| !self.is_known(n) && self.would_determine(n, width));
        DeterminingTestSignal {
            name: sequence.name.to_owned(),
            about: sequence.about.to_owned(),
            duration_s: sequence.duties.len() as f64 * sequence.interval_s,
            highest_bar: sequence.highest_bar,
            determines: determines
                .map(|(&n, _)| self.unknowns.list()[n].name())
                .collect(),
            width_after: foreseen.width_after,
        }
    }
}

fn sentence(best: &str, parameters: &[ForeseenParameter]) -> String {
    let names = |is_meant: &dyn Fn(&ForeseenParameter) -> bool| {
        let meant = parameters.iter().filter(|one| is_meant(one));
        meant.map(|one| &*one.name).collect::<Vec<_>>().join(", ")
    };
    let open = names(&|one| !one.is_determined_now);
    let gained = names(&|one| !one.is_determined_now && one.is_determined_after);
    let left = names(&|one| !one.is_determined_after);
    match (open.is_empty(), gained.is_empty(), left.is_empty()) {
        (true, ..) => "the plant file determines all of these parameters already".to_owned(),
        (_, false, true) => format!("\"{best}\" determines {gained}"),
        (_, false, false) => format!("\"{best}\" determines {gained}; it leaves {left} open"),
        (_, true, _) => format!("no test signal within the limits determines {left}"),
    }
}
