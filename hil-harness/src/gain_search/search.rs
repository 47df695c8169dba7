//! Seeded search over gains.

use std::num::NonZero;
use std::thread;

use controller::{Config, Settings};

use super::gain::{GAINS, HORIZONS};
use super::profile::profile;
use super::quality::Quality;
use super::starting_point::{NoStartingPoint, StartingPoint};
use crate::operating_conditions::ConditionScatter;
use crate::random::{Draws, Random, Stream};
use crate::requirement::Requirement;
use crate::rigs::{RigError, RigVerdict, rig_verdict};
use crate::scenario::Scenario;

/// Extent of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Number of candidates, the starting points included.
    pub candidates: u32,
    /// Number of rigs that each candidate runs on.
    pub rigs: u32,
    /// Seed of rigs, noise and candidates.
    pub seed: u64,
    /// Number of a drawn candidate that is chosen whatever it costs; `None`: the one that costs least.
    pub choose: Option<u32>,
}

/// Gains and what they achieve.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Name.
    pub name: Name,
    /// Controller with these gains.
    pub settings: Settings,
    /// Result on the rigs of the search.
    pub quality: Quality,
}

/// Name of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// The controller that the search was given.
    Given,
    /// Gains of an experiment.
    Started(StartingPoint),
    /// Drawn by the search, with its number from 1.
    Drawn(u32),
}

impl core::fmt::Display for Name {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Given => f.write_str("given"),
            Self::Started(method) => f.write_str(method.name()),
            Self::Drawn(number) => write!(f, "search {number}"),
        }
    }
}

/// Result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// All candidates, in the order in which they ran.
    pub candidates: Vec<Candidate>,
    /// Index of the chosen candidate: of those with the least cost and the given one, the one with the least cost on the
    /// final rigs.
    pub chosen: usize,
    /// The given controller and the chosen one on rigs that decided nothing.
    pub on_other_rigs: [Quality; 2],
}

impl Found {
    /// Returns the chosen candidate.
    pub fn chosen(&self) -> &Candidate {
        &self.candidates[self.chosen]
    }

    /// Returns the candidates for a table: the given controller and the starting points, then some of the
    /// trade-off, and the chosen one.
    pub fn shown(&self) -> Vec<&Candidate> {
        let is_named = |candidate: &&Candidate| !matches!(candidate.name, Name::Drawn(_));
        let named = self.candidates.iter().filter(is_named);
        let mut front = self.trade_off();
        front.retain(|candidate| !is_named(candidate));
        let stride = front.len().div_ceil(SHOWN_MAX).max(1);
        let of_front = front.into_iter().step_by(stride);
        let mut shown: Vec<_> = named.chain(of_front).collect();
        if shown
            .iter()
            .all(|candidate| candidate.name != self.chosen().name)
        {
            shown.push(self.chosen());
        }
        shown
    }

    /// Returns the candidates that no other one dominates, the fastest first. Those with many late steps are left out: a
    /// loop that hardly moves does not overshoot.
    pub fn trade_off(&self) -> Vec<&Candidate> {
        let late = |candidate: &Candidate| candidate.quality.late_share;
        let least_late = self.candidates.iter().map(late).fold(1.0, f64::min);
        let is_dominated = |one: &Candidate| {
            let mut others = self.candidates.iter();
            others.any(|other| one.quality.is_dominated_by(&other.quality))
        };
        let mut front: Vec<_> = self
            .candidates
            .iter()
            .filter(|candidate| late(candidate) <= least_late + LATE_SHARE_MORE)
            .filter(|candidate| !is_dominated(candidate))
            .collect();
        front.sort_by(|one, other| {
            let key = |candidate: &Candidate| candidate.quality.settling_mean_samples;
            key(one).total_cmp(&key(other))
        });
        front
    }
}

/// Reason why a search has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A rig could not be run.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// An experiment for a starting point failed.
    #[error(transparent)]
    StartingPoint(#[from] NoStartingPoint),
    /// The controller has no gains.
    #[error(
        "model-based pulses have no gains: without the table [pulses], the PID controller acts"
    )]
    NoGains,
    /// There is no candidate of this number.
    #[error("there is no candidate {number}: the search draws candidates 1 to {drawn}")]
    NoCandidate {
        /// Number that was asked for.
        number: u32,
        /// Largest number.
        drawn: u32,
    },
}

/// Number of candidates of the trade-off in a table, beside the chosen one.
const SHOWN_MAX: usize = 8;
/// Share of late steps of a candidate of the trade-off beyond the least of all candidates.
const LATE_SHARE_MORE: f64 = 0.01;
/// Number of the best candidates that the search varies.
const PARENTS: usize = 4;
/// Candidates that are drawn from the whole range: one in this many.
const WHOLE_RANGE: u32 = 5;
/// Standard deviation of the logarithm of a gain, at the beginning and at the end of the search.
const SPREAD: [f64; 2] = [0.7, 0.1];
/// Largest number of draws for a candidate.
const DRAWS_MAX: u32 = 100;
/// Probability of another prediction horizon.
const OTHER_HORIZON: f64 = 0.15;
/// Number of the best candidates that run on the final rigs: the least of many costs on few rigs is partly luck.
const FINALISTS: usize = 6;
/// Final rigs, and rigs on which the result is checked, per rig of the search.
const MORE_RIGS: u32 = 3;
/// Differences between the seed of the search and those of these rigs.
const FINAL_RIGS: u64 = 0x6669_6e61_6c20_7269;
const OTHER_RIGS: u64 = 0x6f74_6865_7220_7269;

/// Searches gains for the controller of `scenario` on rigs that scatter about its plant. `step` is called after each
/// candidate. Equal arguments give equal results, with any number of cores.
///
/// # Errors
/// Returns an error if a rig cannot be run, or the controller has no gains.
pub fn search(
    scenario: &Scenario,
    requirement: &Requirement,
    search: Search,
    step: &mut dyn FnMut(),
) -> Result<Found, SearchError> {
    if scenario.controller.pulses.is_some() {
        return Err(SearchError::NoGains);
    }
    let sample_time_s = scenario.plant.ecu.sample_time_s;
    let passes = Scenario {
        controller: scenario.controller,
        seed: search.seed,
        ..Scenario::new("gain search", profile(requirement, sample_time_s))
            .on(scenario.plant.clone())
    };
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut add = |name, settings, candidates: &mut Vec<Candidate>| {
        let quality = quality(&passes, settings, requirement, search.rigs)?;
        step();
        candidates.push(Candidate {
            name,
            settings,
            quality,
        });
        Ok::<_, SearchError>(())
    };
    add(Name::Given, scenario.controller, &mut candidates)?;
    for method in StartingPoint::ALL {
        match method.gains(&passes, requirement) {
            Ok(settings) => add(Name::Started(method), settings, &mut candidates)?,
            // A slow plant does not oscillate within the experiment.
            Err(NoStartingPoint::NoAnswer { .. }) => {}
            Err(other) => return Err(other.into()),
        }
    }
    let mut draws = Draws::new(Random::new(search.seed, Stream::GainSearch));
    let started = candidates.len() as u32;
    let drawn = search.candidates.saturating_sub(started);
    let no_candidate = |number| SearchError::NoCandidate { number, drawn };
    if let Some(number) = search.choose
        && number > drawn
    {
        return Err(no_candidate(number));
    }
    for number in 0..drawn {
        let progress = f64::from(number) / f64::from(drawn);
        let spread = SPREAD[0] * (SPREAD[1] / SPREAD[0]).powf(progress);
        let settings = accepted(|| {
            if number % WHOLE_RANGE == 0 {
                anywhere(scenario.controller, &mut draws)
            } else {
                beside(parent(&candidates, &mut draws), spread, &mut draws)
            }
        });
        let Some(settings) = settings else { continue };
        add(Name::Drawn(number + 1), settings, &mut candidates)?;
    }
    let [final_rigs, other_rigs] =
        [FINAL_RIGS, OTHER_RIGS].map(|seed| passes.clone().seeded(search.seed ^ seed));
    let on = |rigs: &Scenario, index: usize| {
        let settings = candidates[index].settings;
        quality(rigs, settings, requirement, MORE_RIGS * search.rigs)
    };
    let chosen = match search.choose {
        Some(number) => {
            let mut names = candidates.iter().map(|candidate| candidate.name);
            let place = names.position(|name| name == Name::Drawn(number));
            place.ok_or(no_candidate(number))?
        }
        None => least_cost(&candidates, |index| on(&final_rigs, index))?,
    };
    Ok(Found {
        on_other_rigs: [on(&other_rigs, 0)?, on(&other_rigs, chosen)?],
        candidates,
        chosen,
    })
}

/// Returns the index of the finalist that costs least by `quality`: one of the best candidates, or the given controller.
fn least_cost(
    candidates: &[Candidate],
    quality: impl Fn(usize) -> Result<Quality, SearchError>,
) -> Result<usize, SearchError> {
    let mut finalists = ranked(candidates);
    finalists.truncate(FINALISTS);
    if !finalists.contains(&0) {
        finalists.push(0);
    }
    let costs = finalists
        .into_iter()
        .map(|index| Ok((index, quality(index)?.cost_samples)));
    let costs: Vec<(usize, f64)> = costs.collect::<Result<_, SearchError>>()?;
    let least = costs
        .iter()
        .min_by(|(_, one), (_, other)| one.total_cmp(other));
    Ok(least.map_or(0, |(index, _)| *index))
}

/// Draws until the controller accepts the gains, such as K T_s/T_i within its fixed point; `None` if it never does.
fn accepted(mut draw: impl FnMut() -> Settings) -> Option<Settings> {
    let mut drawn = (0..DRAWS_MAX).map(|_| draw());
    drawn.find(|settings| Config::new(settings).is_ok())
}

/// Returns the indices of the candidates, the one with the least cost first.
fn ranked(candidates: &[Candidate]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|&one, &other| {
        let cost = |index: usize| candidates[index].quality.cost_samples;
        cost(one).total_cmp(&cost(other))
    });
    order
}

/// Draws one of the best candidates.
fn parent(candidates: &[Candidate], draws: &mut Draws) -> Settings {
    let order = ranked(candidates);
    let count = order.len().min(PARENTS) as u32;
    candidates[order[draws.below(count) as usize]].settings
}

/// Draws gains from the whole range.
fn anywhere(mut settings: Settings, draws: &mut Draws) -> Settings {
    for gain in &GAINS {
        let [low, high] = gain.range.map(f64::ln);
        gain.set(&mut settings, draws.between(low, high).exp());
    }
    settings.prediction = HORIZONS[draws.below(HORIZONS.len() as u32) as usize];
    settings
}

/// Draws gains beside those of `settings`, with the standard deviation `spread` of their logarithm.
fn beside(mut settings: Settings, spread: f64, draws: &mut Draws) -> Settings {
    for gain in &GAINS {
        // The sum of three uniform numbers over -1 to 1 has the standard deviation 1.
        let normal: f64 = (0..3).map(|_| draws.between(-1.0, 1.0)).sum();
        if let Some(value) = gain.value(&settings) {
            // A gain of zero stays: it has no logarithm.
            if value > 0.0 {
                gain.set(&mut settings, value * (spread * normal).exp());
            }
        }
    }
    let other = HORIZONS[draws.below(HORIZONS.len() as u32) as usize];
    if draws.between(0.0, 1.0) < OTHER_HORIZON {
        settings.prediction = other;
    }
    settings
}

/// Runs a controller on the first `rigs` rigs of `scenario`, on all cores.
fn quality(
    scenario: &Scenario,
    settings: Settings,
    requirement: &Requirement,
    rigs: u32,
) -> Result<Quality, SearchError> {
    let scenario = Scenario {
        controller: settings,
        ..scenario.clone()
    };
    let conditions = ConditionScatter::vehicle(&scenario.plant);
    let verdict = |rig| rig_verdict(&scenario, requirement, rig, conditions);
    let cores = thread::available_parallelism().map_or(1, NonZero::get) as u32;
    let mut verdicts: Vec<RigVerdict> = thread::scope(|scope| {
        let workers: Vec<_> = (0..cores.min(rigs))
            .map(|first| {
                let own = (first..rigs).step_by(cores as usize);
                scope.spawn(move || own.map(verdict).collect::<Result<Vec<_>, _>>())
            })
            .collect();
        let results = workers.into_iter().map(|worker| match worker.join() {
            Ok(verdicts) => verdicts,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        results.collect::<Result<Vec<_>, RigError>>()
    })?
    .into_iter()
    .flatten()
    .collect();
    verdicts.sort_by_key(|rig| rig.rig);
    Ok(Quality::of(&verdicts, requirement))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: Search = Search {
        candidates: 8,
        rigs: 2,
        seed: 5,
        choose: None,
    };

    fn run(settings: Settings, extent: Search) -> Result<Found, SearchError> {
        let scenario = Scenario::built_in("hold").unwrap().controlled_by(settings);
        search(&scenario, &Requirement::THESIS, extent, &mut || ())
    }

    #[test]
    fn a_search_is_repeatable_and_chooses_among_the_least_costs() {
        let found = run(Settings::recommended(), SMALL).unwrap();
        assert_eq!(found, run(Settings::recommended(), SMALL).unwrap());
        assert_eq!(found.candidates.len(), 8);
        assert_eq!(found.candidates[0].name, Name::Given);
        let order = ranked(&found.candidates);
        assert!(found.chosen == 0 || order[..FINALISTS].contains(&found.chosen));
        assert!(found.on_other_rigs.iter().all(|quality| quality.rigs == 6));
        let front = found.trade_off();
        assert!(!front.is_empty() && front.len() <= 8);
    }

    /// Goal: a search mends poor gains. Method: a gain so small that most steps are late.
    #[test]
    fn poor_gains_are_mended() {
        let mut poor = Settings {
            boost: None,
            ..Settings::recommended()
        };
        GAINS[0].set(&mut poor, 2.0);
        let found = run(poor, SMALL).unwrap();
        let [given, best] = &found.on_other_rigs;
        assert!(given.late_share > 0.3, "{given:?}");
        assert!(best.late_share < 0.5 * given.late_share, "{best:?}");
        assert_eq!(found.chosen().settings.boost, None, "what is off stays off");
    }

    #[test]
    fn a_candidate_is_chosen_by_its_number() {
        let choose = |number| {
            let choose = Some(number);
            run(Settings::recommended(), Search { choose, ..SMALL })
        };
        assert_eq!(choose(2).unwrap().chosen().name, Name::Drawn(2));
        let refused = choose(6).unwrap_err().to_string();
        assert!(refused.contains("candidates 1 to 5"), "{refused}");
    }

    #[test]
    fn pulses_have_no_gains() {
        let refused = run(Settings::pulses(), SMALL);
        assert!(matches!(refused, Err(SearchError::NoGains)));
    }
}
