//! Split of the logs into training and validation data.

use std::collections::BTreeMap;
use std::time::Instant;

use plant_sim::PlantParameters;
use plant_sim::effects::Effect;
use plant_sim::replay::CurrentSampling;
use recording::Recording;

use super::gather::gather;
use super::logger_time::{
    Delay, Search, choose_clocks_again, find_conditions, find_slow_clocks, fit_conditions,
    take_sampling,
};
use super::trial::{Bench, Trial};
use crate::conditions::{Conditions, LogConditions};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::result::{Cost, FoundClock, FoundStart};
use crate::diagnosis::verdict::CLEARLY_LESS;
use crate::result::{Horizon, LogDefects, NotCompared, Warning};

/// Number of blocks of a log, of which every third is held out.
const BLOCKS: usize = 12;
/// Places of the block that is held out of each three: the usual one, and another one where that shows more. The first block of a log is
/// fitted, since it shows the gas at the start.
const USUAL_PLACE: usize = 2;
const PLACES: [usize; 2] = [USUAL_PLACE, 1];
/// Shift of the end of a log (s) from which on the drift of another log is tried.
const OTHER_DRIFT_S: f64 = 0.3e-3;

/// Logs, split into training and validation data.
pub(crate) struct Split {
    pub(crate) fitting: Evidence,
    pub(crate) checking: Evidence,
    held_out: HeldOut,
}

/// Validation data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum HeldOut {
    /// Logs given for validation.
    CheckLogs,
    /// Every third block of the training logs, because there are no others.
    Blocks,
    /// The same, of blocks that show less of the error than those for training.
    OtherBlocks,
    /// Every third block of all logs, of blocks that show less of the error than those for training.
    BlocksOfAll,
}

impl Split {
    /// Uses `logs` for training, and `check` for validation, or without it, blocks of the logs.
    pub(crate) fn as_given(
        plant: &PlantParameters,
        logs: &[Recording],
        check: &[Recording],
    ) -> Result<Self, DiagnoseError> {
        refuse_repeated(logs, check)?;
        if check.is_empty() {
            let mut fitting = gather(plant, logs)?;
            let mut checking = gather(plant, logs)?;
            hold_out(&mut fitting, &mut checking, USUAL_PLACE);
            return Ok(Self {
                fitting,
                checking,
                held_out: HeldOut::Blocks,
            });
        }
        let mut fitting = gather(plant, logs.iter().chain(check))?;
        let checking = Evidence::of(fitting.logs.split_off(logs.len()));
        Ok(Self {
            fitting,
            checking,
            held_out: HeldOut::CheckLogs,
        })
    }

    /// Returns a split of the logs whose training data show an error of the fitted `plant`, if any part does; with that fit.
    ///
    /// A fit may have no material error on the training logs and one on the validation logs. It is then overfitted, or the training logs
    /// leave parameters or effects undetermined, and all logs are fitted together.
    pub(crate) fn that_shows(
        plant: &PlantParameters,
        logs: &[Recording],
        check: &[Recording],
    ) -> Result<(Self, Trial), DiagnoseError> {
        let mut given = Self::as_given(plant, logs, check)?;
        given.fit_conditions(plant);
        let mut plain = given.plain(plant)?;
        if given.find_checked_clocks(plant, &plain)? {
            let judged = given.bench(plant, &[]).judged_anew(&plain);
            plain = judged.ok_or_else(|| given.not_simulated())?;
        }
        if plain.fitted.is_material() || !plain.checked.is_material() {
            return Ok((given, plain));
        }
        let showing = given.into_blocks_that_show(&plain);
        let plain = showing.plain_from(plant, &plain.plant())?;
        Ok((showing, plain))
    }

    /// Returns the horizon of the errors that are fitted and judged.
    pub(crate) fn horizon(&self) -> Horizon {
        self.fitting.horizon
    }

    /// Sets the horizon of the errors that are fitted and judged.
    pub(crate) fn judge_in(&mut self, horizon: Horizon) {
        (self.fitting.horizon, self.checking.horizon) = (horizon, horizon);
    }

    /// Fits the conditions of all logs with an unchanged `plant`.
    fn fit_conditions(&mut self, plant: &PlantParameters) {
        fit_conditions(plant, &mut self.fitting);
        if self.checking.is_rest_of_fitted {
            let conditions = self.fitting.conditions();
            self.checking.set_conditions(&conditions, plant);
        } else {
            fit_conditions(plant, &mut self.checking);
        }
    }

    /// Sets the conditions of the logs to those fitted with `last`.
    pub(crate) fn take_conditions(&mut self, last: &Trial) {
        self.fitting.take_conditions(&last.unknowns, &last.fit.z);
        self.checking.replace_conditions(&last.checked_conditions);
    }

    /// Returns the conditions of the logs for training and of those for validation.
    pub(crate) fn conditions(&self) -> [Vec<Conditions>; 2] {
        [&self.fitting, &self.checking].map(Evidence::conditions)
    }

    /// Sets the conditions of the logs to those of [`Self::conditions`]; the assignment of the commands is unchanged.
    pub(crate) fn replace_conditions(&mut self, [fitting, checking]: &[Vec<Conditions>; 2]) {
        self.fitting.replace_conditions(fitting);
        self.checking.replace_conditions(checking);
    }

    /// Returns the logs for training and those for validation, with their conditions and the assignment of their commands.
    pub(crate) fn logs(&self) -> [Vec<Log>; 2] {
        [&self.fitting, &self.checking].map(|evidence| evidence.logs.clone())
    }

    /// Sets the logs to those of [`Self::logs`].
    pub(crate) fn restore(&mut self, [fitting, checking]: [Vec<Log>; 2]) {
        (self.fitting.logs, self.checking.logs) = (fitting, checking);
    }

    /// Returns a split of all logs into blocks, under the conditions that suit `plain`. Those blocks are held out that show least of its
    /// error.
    fn into_blocks_that_show(mut self, plain: &Trial) -> Self {
        self.take_conditions(plain);
        let (mut logs, held_out) = match self.held_out {
            HeldOut::CheckLogs => (
                [self.fitting.logs, self.checking.logs].concat(),
                HeldOut::BlocksOfAll,
            ),
            _ => (self.fitting.logs, HeldOut::OtherBlocks),
        };
        for log in &mut logs {
            log.counted.fill(true);
        }
        let whole = Evidence::of(logs.clone());
        let residuals = whole.residuals(&plain.plant(), whole.horizon);
        let splits = PLACES.into_iter().map(|place| {
            let mut fitting = Evidence::of(logs.clone());
            let mut checking = Evidence::of(logs.clone());
            hold_out(&mut fitting, &mut checking, place);
            let excess = residuals.as_ref().map_or(0.0, |residuals| {
                Errors::new(&checking, residuals, whole.horizon).total_excess()
            });
            (fitting, checking, excess)
        });
        let least = splits.min_by(|a, b| a.2.total_cmp(&b.2));
        let (fitting, checking, _) = least.expect("there are two");
        Self {
            fitting,
            checking,
            held_out,
        }
    }

    /// Returns a split of training and validation logs into blocks, under the conditions that suit `best`; none where no logs were given for
    /// validation.
    ///
    /// Training logs may leave a value open that the validation logs need: whether pulses of one length open a valve.
    pub(crate) fn of_all_logs(&self, best: &Trial) -> Option<Self> {
        (self.held_out == HeldOut::CheckLogs).then(|| {
            let same = Self {
                fitting: self.fitting.copied(),
                checking: self.checking.copied(),
                held_out: self.held_out,
            };
            let all = same.into_blocks_that_show(best);
            all.fitting.add_work_of(&self.fitting);
            all.checking.add_work_of(&self.checking);
            all
        })
    }

    /// Searches the clocks of the validation logs with `best`, a fitted plant, which determines them better than a plant that fits worse.
    /// Returns whether `best` then fits these logs better; otherwise they are unchanged.
    pub(crate) fn find_checked_clocks(
        &mut self,
        plant: &PlantParameters,
        best: &Trial,
    ) -> Result<bool, DiagnoseError> {
        let drifts_ppm = best.fitted_drifts_ppm(&self.fitting);
        // The delays of valves may account for the clock of the training logs, but then not for that of others.
        let is_asked = !drifts_ppm.is_empty() || best.checked.is_material();
        if !is_asked || self.checking.is_rest_of_fitted {
            return Ok(false);
        }
        let fitted = best.plant();
        let before = self.checking.logs.clone();
        find_conditions(&fitted, &mut self.checking, &drifts_ppm);
        if self.is_nearer(plant, best)? {
            return Ok(true);
        }
        self.checking.logs.clone_from(&before);
        // The fitted delay may be wrong by an amount that the clocks of the training logs compensate; the sample at which a command was
        // given resolves it.
        let there_s = fitted.ecu.command_delay_s;
        let reach_s = 0.5 * fitted.ecu.sample_time_s;
        let delays_s = (there_s - reach_s).max(0.0)..=there_s + reach_s;
        let found_s = find_slow_clocks(&fitted, &mut self.checking, delays_s, Search::Together);
        if let Some(found_s) = found_s {
            self.checking.shift_clocks(there_s - found_s);
            if self.is_nearer(plant, best)? {
                return Ok(true);
            }
        }
        self.checking.logs = before;
        Ok(false)
    }

    /// Searches the clocks of the training logs with the drifts of the validation logs, which may be of the same logger, and fits the plain
    /// plant again. Returns it where it then explains clearly more than `plain`; otherwise the logs are unchanged.
    pub(crate) fn find_fitted_clocks(
        &mut self,
        plant: &PlantParameters,
        plain: &Trial,
    ) -> Result<Option<Trial>, DiagnoseError> {
        let drift_ppm = |conditions: &Conditions| conditions.clock.map(|clock| clock.drift_ppm);
        let checked_ppm = plain.checked_conditions.iter().filter_map(drift_ppm);
        let fitted_ppm = plain.fitted_drifts_ppm(&self.fitting);
        let is_new = |drift_ppm: &f64| {
            let moves_end =
                |there: &f64| 1e-6 * (drift_ppm - there).abs() * self.fitting.duration_s();
            fitted_ppm
                .iter()
                .all(|there| moves_end(there) > OTHER_DRIFT_S)
        };
        let drifts_ppm: Vec<f64> = checked_ppm.filter(is_new).collect();
        let is_open = self.fitting.logs.iter().any(Log::is_clock_open);
        if drifts_ppm.is_empty() || !is_open || self.checking.is_rest_of_fitted {
            return Ok(None);
        }
        let before = self.fitting.logs.clone();
        find_conditions(&plain.plant(), &mut self.fitting, &drifts_ppm);
        let again = self.plain_from(plant, &plain.plant())?;
        if again.total_square() < CLEARLY_LESS * plain.total_square() {
            return Ok(Some(again));
        }
        self.fitting.logs = before;
        Ok(None)
    }

    /// Returns whether the fit of `best` is nearer to the validation logs, under their present conditions, than before.
    fn is_nearer(&self, plant: &PlantParameters, best: &Trial) -> Result<bool, DiagnoseError> {
        let judged = self.bench(plant, &[]).judged_anew(best);
        let judged = judged.ok_or_else(|| self.not_simulated())?;
        Ok(judged.checked.total_excess() < best.checked.total_excess())
    }

    /// Returns the data with which trials on these logs are compared.
    pub(crate) fn bench<'a>(
        &'a self,
        plant: &'a PlantParameters,
        library: &'a [&'static dyn Effect],
    ) -> Bench<'a> {
        Bench {
            plant,
            library,
            fitting: &self.fitting,
            checking: &self.checking,
        }
    }

    /// Returns the fitted plain plant.
    fn plain(&self, plant: &PlantParameters) -> Result<Trial, DiagnoseError> {
        let plain = self.bench(plant, &[]).plain();
        plain.ok_or_else(|| self.not_simulated())
    }

    /// Returns the fitted plain plant, whose fit begins at the nuisance parameters of `there`.
    pub(crate) fn plain_from(
        &self,
        plant: &PlantParameters,
        there: &PlantParameters,
    ) -> Result<Trial, DiagnoseError> {
        let plain = self.bench(plant, &[]).plain_from(there);
        plain.ok_or_else(|| self.not_simulated())
    }

    /// Sets the current sampling of all logs that leave it open to `sampling`, as [`take_sampling`]; returns whether one of the training
    /// logs does.
    pub(crate) fn take_sampling(
        &mut self,
        plant: &PlantParameters,
        sampling: CurrentSampling,
    ) -> bool {
        take_sampling(plant, &mut self.checking, sampling, Delay::Searched);
        take_sampling(plant, &mut self.fitting, sampling, Delay::Searched)
    }

    /// Returns the result of `attempt` on these logs with the other current sampling, means or instantaneous values; none, with unchanged
    /// logs, where no log leaves the sampling open or the attempt returns none. The attempt gets the plant as `fitted`, although it does
    /// not fit then: without an effect of a coil, the wrong choice comes nearest to the truth, and a fit with the right one leads away.
    pub(crate) fn with_other_sampling<T>(
        &mut self,
        plant: &PlantParameters,
        fitted: &Trial,
        attempt: impl FnOnce(&Self, Trial) -> Result<Option<T>, DiagnoseError>,
    ) -> Result<Option<T>, DiagnoseError> {
        if !self.fitting.take_other_sampling() {
            return Ok(None);
        }
        self.checking.take_other_sampling();
        let before = self.conditions();
        self.take_conditions(fitted);
        let there = self.bench(plant, &[]).at_the_place_of(fitted);
        let there = there.ok_or_else(|| self.not_simulated())?;
        let attempted = attempt(self, there)?;
        if attempted.is_none() {
            self.fitting.take_other_sampling();
            self.checking.take_other_sampling();
            self.replace_conditions(&before);
        }
        Ok(attempted)
    }

    /// Chooses again among the clocks that the commands of the logs admit, with `best`. Returns its plant if a training log has another clock
    /// then; otherwise the logs are unchanged.
    pub(crate) fn choose_clocks_by(&mut self, best: &Trial) -> Option<PlantParameters> {
        let (before, plant) = (self.logs(), best.plant());
        self.take_conditions(best);
        if !choose_clocks_again(&plant, &mut self.fitting) {
            self.restore(before);
            return None;
        }
        if !self.checking.is_rest_of_fitted {
            choose_clocks_again(&plant, &mut self.checking);
        }
        self.fit_conditions(&plant);
        Some(plant)
    }

    /// Finds the clocks of logs that leave open at which sample of the ECU a command was given, and assigns their commands, with `best`:
    /// the assignment by a wrong plant hides the missing effect. Returns the plant with the delay that goes with the clocks; none where
    /// there is no such log, or where no other clocks suit `best` better.
    pub(crate) fn assign_by(&mut self, best: &Trial) -> Option<PlantParameters> {
        let is_open = |log: &Log| log.is_slow() && log.is_clock_open();
        if !self.fitting.logs.iter().any(is_open) {
            return None;
        }
        let mut plant = best.plant();
        let before = self.conditions();
        self.take_conditions(best);
        let reach_s = 0.5 * plant.ecu.sample_time_s;
        let there_s = plant.ecu.command_delay_s;
        let delays_s = (there_s - reach_s).max(0.0)..=there_s + reach_s;
        let fitting = &mut self.fitting;
        let delay_s = find_slow_clocks(&plant, fitting, delays_s, Search::Together);
        let Some(delay_s) = delay_s else {
            self.replace_conditions(&before);
            return None;
        };
        if !self.checking.is_rest_of_fitted {
            let delays_s = delay_s..=delay_s;
            find_slow_clocks(&plant, &mut self.checking, delays_s, Search::Together);
        }
        plant.ecu.command_delay_s = delay_s;
        self.fit_conditions(&plant);
        Some(plant)
    }

    /// Returns the error that the plant cannot be simulated on these logs.
    pub(crate) fn not_simulated(&self) -> DiagnoseError {
        let log = self.fitting.sources().into_iter().next();
        DiagnoseError::NotSimulated {
            log: log.unwrap_or_default(),
        }
    }

    /// Returns the validation logs, without those that are partly used for training.
    pub(crate) fn check_logs(&self) -> &[Log] {
        if self.held_out == HeldOut::CheckLogs {
            &self.checking.logs
        } else {
            &[]
        }
    }

    /// Returns the sources of those logs.
    pub(crate) fn check_sources(&self) -> Vec<String> {
        self.check_logs()
            .iter()
            .map(|log| log.source.clone())
            .collect()
    }

    /// Returns the excluded signals of each log.
    pub(crate) fn not_compared(&self) -> BTreeMap<String, Vec<NotCompared>> {
        let mut all: BTreeMap<_, Vec<_>> = BTreeMap::new();
        let logs = self.fitting.logs.iter().chain(self.check_logs());
        for log in logs.filter(|log| !log.not_compared.is_empty()) {
            let of_source = all.entry(log.source.clone()).or_default();
            of_source.extend_from_slice(&log.not_compared);
        }
        all
    }

    /// Returns the gaps and missing cells of each log that has any.
    pub(crate) fn defects(&self) -> BTreeMap<String, LogDefects> {
        let logs = self.fitting.logs.iter().chain(self.check_logs());
        logs.filter(|log| !log.defects.is_empty())
            .map(|log| (log.source.clone(), log.defects.clone()))
            .collect()
    }

    /// Returns the warnings about each log.
    pub(crate) fn warnings(&self) -> BTreeMap<String, Vec<Warning>> {
        let logs = self.fitting.logs.iter().chain(self.check_logs());
        let doubted = logs.filter(|log| !log.warnings.is_empty());
        doubted
            .map(|log| (log.source.clone(), log.warnings.clone()))
            .collect()
    }

    /// Returns the found clocks of the loggers, log after log.
    pub(crate) fn clocks(&self) -> Vec<FoundClock> {
        let logs = self.fitting.logs.iter().chain(self.check_logs());
        logs.filter_map(Log::found_clock).collect()
    }

    /// Returns the source of each log and the conditions under which it was made, log after log.
    pub(crate) fn found_conditions(&self) -> Vec<(String, LogConditions)> {
        let logs = self.fitting.logs.iter().chain(self.check_logs());
        logs.map(|log| (log.source.clone(), log.found())).collect()
    }

    /// Returns the initial states of logs with a filled chamber, log after log.
    pub(crate) fn starts(&self) -> Vec<FoundStart> {
        let logs = self.fitting.logs.iter().chain(self.check_logs());
        logs.filter_map(Log::found_start).collect()
    }

    /// Returns the cost of all simulations since `begin`.
    pub(crate) fn cost(&self, begin: Instant) -> Cost {
        let fitted = &self.fitting;
        Cost {
            simulations: fitted.simulations() + self.checking.simulations(),
            log_s: fitted.duration_s(),
            elapsed_s: begin.elapsed().as_secs_f64(),
            per_simulation_ms: fitted.computing_s() / fitted.simulations().max(1) as f64 * 1e3,
        }
    }

    /// Returns the validation data in words, for people.
    pub(crate) fn held_out(&self) -> &'static str {
        match self.held_out {
            HeldOut::CheckLogs => "the logs given for checking, which were not fitted",
            HeldOut::Blocks => "every third of twelve blocks of each log, which was not fitted",
            HeldOut::OtherBlocks => {
                "every third of twelve blocks of each log, which was not fitted; these blocks show less of the error than the fitted ones"
            }
            HeldOut::BlocksOfAll => {
                "every third of twelve blocks of each log, check logs included, because a model fitted to one set of logs fails on the other; these blocks show less of the error than the fitted ones"
            }
        }
    }
}

/// Refuses a log that is given twice, under whatever name: fitted twice, it narrows every interval, and it cannot validate a fit to itself.
fn refuse_repeated(logs: &[Recording], check: &[Recording]) -> Result<(), DiagnoseError> {
    let all: Vec<&Recording> = logs.iter().chain(check).collect();
    let is_same = |one: &Recording, other: &Recording| {
        let input = |log: &Recording| log.provenance().input;
        // A mapping can make two logs of one file, by windows that do not overlap.
        input(one).is_some()
            && input(one) == input(other)
            && one
                .time_bases()
                .map(|(_, base)| base)
                .eq(other.time_bases().map(|(_, base)| base))
    };
    for (index, log) in all.iter().enumerate() {
        if let Some(other) = all[..index].iter().find(|other| is_same(log, other)) {
            return Err(DiagnoseError::LogTwice {
                log: log.provenance().source.clone(),
                other: other.provenance().source.clone(),
                is_check: index >= logs.len(),
            });
        }
    }
    Ok(())
}

/// Marks the samples of two copies of the same logs: each copy counts the blocks that the other does not. Of each three blocks, the one at
/// `place` is held out.
fn hold_out(fitting: &mut Evidence, checking: &mut Evidence, place: usize) {
    (fitting.is_rest_of_fitted, checking.is_rest_of_fitted) = (true, true);
    for (kept, out) in fitting.logs.iter_mut().zip(&mut checking.logs) {
        let rows = kept.counted.len();
        for row in 0..rows {
            let is_out = row * BLOCKS / rows.max(1) % 3 == place;
            kept.counted[row] = !is_out;
            out.counted[row] = is_out;
        }
    }
}
