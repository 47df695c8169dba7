//! Trial: the plant with some effects, fitted and validated.

use std::sync::OnceLock;

use plant_sim::effects::{Effect, EffectSetting};
use plant_sim::{PlantParameters, Tolerance};

use super::logger_time::fitted_conditions;
use super::start::{self, Start, most_promising};
use super::{Descent, Difference, Fit, Fitter};
use crate::conditions::Conditions;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::evidence::log::Residuals;
use crate::diagnosis::evidence::unknowns::{AT_BOUND, Unknown, Unknowns};
use crate::diagnosis::result::OutsideValue;
use crate::diagnosis::verdict::{ADDS_UP_FLOORS, ADDS_UP_SHARE, WIDENINGS};
use crate::measured::PRESSURE;
use crate::result::Horizon;
use crate::whiteness::autocorrelation_time_samples;

/// Effect on top of a fitted plant, evaluated at a few sizes.
pub(crate) struct Prospect {
    pub(crate) setting: EffectSetting,
    unknowns: Unknowns,
    starts: start::Prospect,
}

impl Prospect {
    /// Returns the expected decrease of the cost with the effect beyond that without it; none if no size of it can be simulated.
    pub(crate) fn gain(&self) -> Option<f64> {
        self.starts.gain
    }
}

/// Effect on top of a fitted plant, at the starts of its fit.
pub(crate) struct Sketch {
    effects: Vec<EffectSetting>,
    unknowns: Unknowns,
    /// Jacobian of the plant without the effect.
    known: Vec<Residuals>,
    /// Starts, the most promising first.
    starts: Vec<Start>,
    /// Cost of the plant without the effect.
    before: f64,
}

/// Fit that was begun.
#[derive(Debug, Clone)]
pub(crate) struct Opened {
    effects: Vec<EffectSetting>,
    unknowns: Unknowns,
    pub(crate) fit: Fit,
}

/// Largest number of descents of a last fit that has not converged.
const POLISHES: usize = 3;

/// Plant, library and logs that every trial shares.
pub(crate) struct Bench<'a> {
    pub(crate) plant: &'a PlantParameters,
    /// Effects that are tried.
    pub(crate) library: &'a [&'static dyn Effect],
    pub(crate) fitting: &'a Evidence,
    pub(crate) checking: &'a Evidence,
}

/// Fitted plant.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// Effects in the order added.
    pub(crate) effects: Vec<EffectSetting>,
    pub(crate) unknowns: Unknowns,
    pub(crate) fit: Fit,
    /// Errors on training and validation data.
    pub(crate) fitted: Errors,
    pub(crate) checked: Errors,
    /// Conditions of the validation logs, log after log.
    pub(crate) checked_conditions: Vec<Conditions>,
    /// Autocorrelation time of the error (samples); at least 1.
    pub(crate) correlation_samples: f64,
    /// Half widths of the intervals of the fit, computed on first use.
    pub(crate) widths: OnceLock<Option<Widths>>,
}

/// Half widths of the 95 % intervals of the coordinates of a fit, from a Jacobian that keeps undetermined directions undetermined.
#[derive(Debug, Clone)]
pub(crate) struct Widths {
    /// Half widths from the remaining error of the model.
    pub(crate) of_what_is_left: Vec<f64>,
    /// Half widths from the noise alone.
    pub(crate) of_noise: Vec<f64>,
}

impl Bench<'_> {
    /// Returns the plant as given, with only the loggers' clocks fitted.
    pub(crate) fn as_given(&self) -> Option<Trial> {
        let effects = self.plant.effects.clone();
        let unknowns = Unknowns::new(self.plant, &effects, &self.fitting.logs);
        let fit = Fitter::new(self.fitting, &unknowns).at(unknowns.start())?;
        self.judge(effects, unknowns, fit)
    }

    /// Returns the plant as given, with its nuisance parameters and those of its effects fitted.
    pub(crate) fn plain(&self) -> Option<Trial> {
        self.plain_from(self.plant)
    }

    /// Returns the same as `plain`, with a fit that begins at the nuisance parameters of `there`.
    pub(crate) fn plain_from(&self, there: &PlantParameters) -> Option<Trial> {
        self.fitted_from(self.plant.effects.clone(), there)
    }

    /// Returns the forms of `effect` that act on the plant, and of which the logs show what drives them.
    pub(crate) fn forms_of(&self, effect: &'static dyn Effect) -> Vec<EffectSetting> {
        let is_driven = |signal: &str| {
            let logs = self.fitting.logs.iter();
            let mut values = logs.flat_map(|log| log.driving_values(signal));
            let first = values.next();
            values.any(|value| Some(value) != first)
        };
        let mut forms = self.plant.forms_of(effect);
        forms.retain(|form| form.driven_by().is_none_or(is_driven));
        forms
    }

    /// Returns the plant with `effects`, with a fit that begins at the parameters of `there` and the present clocks.
    pub(crate) fn fitted_from(
        &self,
        effects: Vec<EffectSetting>,
        there: &PlantParameters,
    ) -> Option<Trial> {
        let unknowns = Unknowns::new(self.plant, &effects, &self.fitting.logs);
        let fitter = Fitter::new(self.fitting, &unknowns);
        let start = fitter.at(unknowns.at(there))?;
        let fit = fitter.descend(start, Descent::Whole)?;
        let mut trial = self.judge(effects, unknowns, fit)?;
        trial.refresh(self)?;
        Some(trial)
    }

    /// Continues the fit of `plain` with wider ranges of the ordinary parameters that reached their ends; none where no parameter did.
    pub(crate) fn widened(&self, plain: &Trial) -> Option<Trial> {
        let mut wide: Option<Trial> = None;
        for _ in 0..WIDENINGS {
            let from = wide.as_ref().unwrap_or(plain);
            let Some(unknowns) = from.unknowns.widened(&from.fit.z) else {
                break;
            };
            let fit =
                Fitter::new(self.fitting, &unknowns).descend(from.fit.clone(), Descent::Whole)?;
            let mut trial = self.judge(from.effects.clone(), unknowns, fit)?;
            trial.refresh(self)?;
            wide = Some(trial);
        }
        wide
    }

    /// Returns `setting` on top of `base` in its typical shape.
    pub(crate) fn prospect(&self, base: &Trial, setting: EffectSetting) -> Prospect {
        let unknowns = base.unknowns.clone().with_effect(&setting);
        let starts = start::prospect(&Fitter::for_search(self.fitting, &unknowns), &base.fit);
        Prospect {
            setting,
            unknowns,
            starts,
        }
    }

    /// Returns the most promising of several sizes and shapes of an effect on top of `base`.
    pub(crate) fn sketch(&self, base: &Trial, prospect: Prospect) -> Sketch {
        let Prospect {
            setting,
            unknowns,
            starts,
        } = prospect;
        let fitter = Fitter::for_search(self.fitting, &unknowns);
        let starts = most_promising(&fitter, &base.fit, starts);
        let mut effects = base.effects.clone();
        effects.push(setting);
        Sketch {
            effects,
            unknowns,
            known: base.fit.jacobian.clone(),
            starts,
            before: base.fit.cost,
        }
    }

    /// Begins the fit of `setting` on top of `base`; none where it cannot be simulated.
    pub(crate) fn begin(&self, base: &Trial, setting: EffectSetting) -> Option<Opened> {
        self.open(self.sketch(base, self.prospect(base, setting)))
    }

    /// Makes a few steps of the fit of a sketch, from the start with the least cost; none where it cannot be simulated.
    pub(crate) fn open(&self, sketch: Sketch) -> Option<Opened> {
        let Sketch {
            effects,
            unknowns,
            known,
            starts,
            before,
        } = sketch;
        let fitter = Fitter::for_search(self.fitting, &unknowns);
        let reached = starts
            .into_iter()
            .flat_map(|start| [fitter.at(start.moved), Some(start.fit)]);
        let mut start = reached.flatten().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        start.jacobian = known;
        let begun = Descent::Begun {
            renews_below: before,
        };
        let fit = fitter.descend(start, begun)?;
        Some(Opened {
            effects,
            unknowns,
            fit,
        })
    }

    /// Completes a begun fit with the accuracy that a search needs, and validates it.
    pub(crate) fn finish(&self, opened: Opened) -> Option<Trial> {
        let fitter = Fitter::for_search(self.fitting, &opened.unknowns);
        let fit = fitter.descend(opened.fit, Descent::Whole)?;
        self.judge(opened.effects, opened.unknowns, fit)
    }

    /// Follows a fit that was begun to its end.
    pub(crate) fn follow(&self, begun: Trial) -> Option<Trial> {
        self.finish(Opened {
            effects: begun.effects,
            unknowns: begun.unknowns,
            fit: begun.fit,
        })
    }

    /// Refits the plant of `trial` without the effect `id`, with a new Jacobian.
    pub(crate) fn without(&self, trial: &Trial, id: &str) -> Option<Trial> {
        let Opened {
            effects,
            unknowns,
            fit,
        } = self.left_out(trial, id)?;
        let fit = Fitter::new(self.fitting, &unknowns).descend(fit, Descent::Whole)?;
        let mut without = self.judge(effects, unknowns, fit)?;
        without.refresh(self)?;
        Some(without)
    }

    /// Returns the plant of `trial` without the effect `id`, its other parameters unchanged, with a new Jacobian.
    pub(crate) fn unfitted_without(&self, trial: &Trial, id: &str) -> Option<Trial> {
        let Opened {
            effects,
            unknowns,
            mut fit,
        } = self.left_out(trial, id)?;
        let fitter = Fitter::new(self.fitting, &unknowns);
        fitter.differentiate(&mut fit, 0, Difference::Forward)?;
        self.judge(effects, unknowns, fit)
    }

    fn left_out(&self, trial: &Trial, id: &str) -> Option<Opened> {
        let mut effects = trial.effects.clone();
        effects.retain(|effect| effect.id() != id);
        let (unknowns, kept) = trial.unknowns.without_effect(id);
        let z = kept.into_iter().map(|n| trial.fit.z[n]).collect();
        let fit = Fitter::new(self.fitting, &unknowns).at(z)?;
        Some(Opened {
            effects,
            unknowns,
            fit,
        })
    }

    /// Validates a fit that was begun on top of `base` without completing it, under the conditions of the logs that were fitted with
    /// `base`.
    pub(crate) fn leave(&self, base: &Trial, opened: Opened) -> Option<Trial> {
        let Opened {
            effects,
            unknowns,
            fit,
        } = opened;
        let conditions = if self.checking.is_rest_of_fitted {
            self.checked_conditions(&unknowns, &fit.z)
        } else {
            base.checked_conditions.clone()
        };
        self.judge_under(conditions, effects, unknowns, fit)
    }

    pub(crate) fn judge(
        &self,
        effects: Vec<EffectSetting>,
        unknowns: Unknowns,
        fit: Fit,
    ) -> Option<Trial> {
        let conditions = self.checked_conditions(&unknowns, &fit.z);
        self.judge_under(conditions, effects, unknowns, fit)
    }

    /// Validates a fit on the logs under these `conditions`.
    fn judge_under(
        &self,
        conditions: Vec<Conditions>,
        effects: Vec<EffectSetting>,
        unknowns: Unknowns,
        fit: Fit,
    ) -> Option<Trial> {
        let plant = unknowns.plant(&fit.z);
        let horizon = self.fitting.horizon;
        let residuals =
            self.checking
                .residuals_on(&plant, &conditions, horizon, Tolerance::default())?;
        Some(Trial {
            correlation_samples: correlation_samples(self.fitting, &fit.residuals),
            fitted: Errors::new(self.fitting, &fit.residuals, horizon),
            checked: Errors::new(self.checking, &residuals, horizon),
            checked_conditions: conditions,
            effects,
            unknowns,
            fit,
            widths: OnceLock::new(),
        })
    }

    /// Validates an unchanged trial on the logs in their present state.
    pub(crate) fn judged_anew(&self, trial: &Trial) -> Option<Trial> {
        let Trial {
            effects,
            unknowns,
            fit,
            ..
        } = trial.clone();
        self.judge(effects, unknowns, fit)
    }

    /// Evaluates the plant of `trial` on the logs in their present state, without a fit.
    pub(crate) fn at_the_place_of(&self, trial: &Trial) -> Option<Trial> {
        let fit = Fitter::new(self.fitting, &trial.unknowns).at(trial.fit.z.clone())?;
        let mut there = self.judge(trial.effects.clone(), trial.unknowns.clone(), fit)?;
        there.refresh(self)?;
        Some(there)
    }

    /// Returns the errors of `trial` in free run on the validation data; none where it cannot be simulated.
    pub(crate) fn free_run(&self, trial: &Trial) -> Option<Errors> {
        let (conditions, horizon) = (&trial.checked_conditions, Horizon::FreeRun);
        let residuals = self.checking.residuals_on(
            &trial.plant(),
            conditions,
            horizon,
            Tolerance::default(),
        )?;
        Some(Errors::new(self.checking, &residuals, horizon))
    }

    /// Returns whether the errors of `trial` add up in free run to more than those of a correct model, as with a small leak or a valve that moves
    /// slightly too little air with each pulse.
    pub(crate) fn adds_up(&self, trial: &Trial) -> bool {
        let share_bar = ADDS_UP_SHARE * trial.plant().gas.supply_pressure_bar_gauge;
        self.free_run(trial).is_some_and(|errors| {
            let rms_bar = errors.rms().get(PRESSURE).copied().unwrap_or(0.0);
            errors.most_floors() > ADDS_UP_FLOORS && rms_bar > share_bar
        })
    }

    /// Returns the conditions of the validation logs: the fitted ones, where they are blocks of the same logs, or those that suit the
    /// fitted plant best.
    fn checked_conditions(&self, unknowns: &Unknowns, z: &[f64]) -> Vec<Conditions> {
        if self.checking.is_rest_of_fitted {
            let mut conditions = self.fitting.conditions();
            unknowns.conditions(z, &mut conditions);
            conditions
        } else {
            fitted_conditions(&unknowns.plant(z), self.checking, unknowns.delay_slack_s())
        }
    }
}

impl Trial {
    /// Returns the fitted plant.
    pub(crate) fn plant(&self) -> PlantParameters {
        self.unknowns.plant(&self.fit.z)
    }

    /// Returns the effect that was added last.
    pub(crate) fn added(&self) -> &'static str {
        self.effects.last().expect("one was added").id()
    }

    /// Returns the drifts of the clocks (ppm) that were fitted to the logs in `fitting`.
    pub(crate) fn fitted_drifts_ppm(&self, fitting: &Evidence) -> Vec<f64> {
        let mut conditions = fitting.conditions();
        self.unknowns.conditions(&self.fit.z, &mut conditions);
        let clocks = conditions.iter().filter_map(|log| log.clock);
        clocks.map(|clock| clock.drift_ppm).collect()
    }

    /// Returns the ordinary parameters outside the ranges of the plant file, which are their ranges in `within`.
    pub(crate) fn outside(&self, within: &Self) -> Vec<OutsideValue> {
        let list = within.unknowns.list().iter().zip(&self.fit.z);
        list.filter_map(|(unknown, &z)| {
            let Unknown::Nuisance(nuisance) = unknown else {
                return None;
            };
            let (least, most) = unknown.bounds();
            let is_outside = z < least - AT_BOUND || z > most + AT_BOUND;
            is_outside.then(|| OutsideValue {
                name: nuisance.spec.name(),
                unit: nuisance.spec.unit.to_owned(),
                value: unknown.value(z),
                least: unknown.value(least),
                most: unknown.value(most),
            })
        })
        .collect()
    }

    /// Whether all of them lie within these ranges.
    pub(crate) fn is_inside(&self, within: &Self) -> bool {
        self.outside(within).is_empty()
    }

    /// Continues the fit with a new Jacobian, which is then recomputed at the fit: intervals need it.
    pub(crate) fn polish(&mut self, bench: &Bench) -> Option<()> {
        for _ in 0..POLISHES {
            *self = self.clone().continued(bench)?;
            self.sharpen(bench)?;
            if self.is_converged(bench) {
                break;
            }
        }
        Some(())
    }

    /// Returns the trial after a further descent with a new Jacobian.
    pub(crate) fn continued(mut self, bench: &Bench) -> Option<Self> {
        self.refresh(bench)?;
        let fitter = Fitter::new(bench.fitting, &self.unknowns);
        let fit = fitter.descend(self.fit, Descent::Whole)?;
        bench.judge(self.effects, self.unknowns, fit)
    }

    /// Returns whether its fit, with an accurate Jacobian, has converged, or leaves nothing material.
    pub(crate) fn is_converged(&self, bench: &Bench) -> bool {
        let fitter = || Fitter::accurate(bench.fitting, &self.unknowns);
        !self.fitted.is_material() || fitter().is_converged(&self.fit)
    }

    /// Recomputes the Jacobian at the fit accurately enough that undetermined directions stay undetermined.
    pub(crate) fn sharpen(&mut self, bench: &Bench) -> Option<()> {
        let fitter = Fitter::accurate(bench.fitting, &self.unknowns);
        let mut accurate = fitter.at(self.fit.z.clone())?;
        fitter.differentiate(&mut accurate, 0, Difference::Fine)?;
        self.fit = accurate;
        Some(())
    }

    /// Recomputes the Jacobian at the fit.
    pub(crate) fn refresh(&mut self, bench: &Bench) -> Option<()> {
        let fitter = Fitter::new(bench.fitting, &self.unknowns);
        fitter.differentiate(&mut self.fit, 0, Difference::Central)?;
        Some(())
    }

    /// Returns the difference of Schwarz's criterion to `base`, with the number of independent samples that follows from the
    /// autocorrelation of the error.
    pub(crate) fn evidence_over(&self, base: &Self) -> f64 {
        self.evidence_with_memory(base, self.correlation_samples)
    }

    /// Returns the same as `evidence_over`, for an autocorrelation time of `memory` samples.
    fn evidence_with_memory(&self, base: &Self, memory: f64) -> f64 {
        let unknowns = [base.unknowns.len(), self.unknowns.len()];
        let gained = (base.fit.cost - self.fit.cost) / memory;
        schwarz_difference(gained, unknowns, self.fitted.count() / memory)
    }

    /// Returns whether a strength reached the end of its range: a distorted law in the place of another one.
    fn is_distorted(&self) -> bool {
        let coordinates = self.unknowns.list().iter().zip(self.fit.z.iter());
        coordinates
            .filter(|(unknown, _)| unknown.is_strength())
            .any(|(unknown, &z)| unknown.is_at_strong_end(z))
    }

    /// Returns whether it is the better form of one effect than `other`. A distorted form is never named, so it must not exclude one that
    /// can be. Otherwise Schwarz's criterion decides, with the longer autocorrelation time of the two errors for both: the better a form
    /// fits, the more correlated is the error that other effects leave, and this must not count against it.
    pub(crate) fn is_preferred_to(&self, other: &Self) -> bool {
        if self.is_distorted() != other.is_distorted() {
            return other.is_distorted();
        }
        let memory = self.correlation_samples.max(other.correlation_samples);
        self.evidence_with_memory(other, memory) > 0.0
    }

    /// Returns whether it leaves a material error of a current, on training or validation data.
    pub(crate) fn leaves_currents(&self) -> bool {
        self.fitted.is_current_material() || self.checked.is_current_material()
    }

    /// Returns the excess over the noise, mean of training and validation data.
    pub(crate) fn mean_excess(&self) -> f64 {
        0.5 * (self.fitted.total_excess() + self.checked.total_excess())
    }

    pub(crate) fn has(&self, id: &str) -> bool {
        self.effects.iter().any(|effect| effect.id() == id)
    }

    /// Returns the sum of squares over the noise, of training and validation data together.
    pub(crate) fn total_square(&self) -> f64 {
        self.fit.cost + self.checked.square()
    }
}

/// Returns the difference of Schwarz's criterion where the cost falls by `gained` between two numbers of unknowns. The second number may be
/// smaller: an effect may have more parameters alone than together with another one, in another form.
fn schwarz_difference(gained: f64, [from, to]: [usize; 2], independent_samples: f64) -> f64 {
    gained - (to as f64 - from as f64) * independent_samples.ln()
}

/// Returns the longest autocorrelation time of any signal (samples).
fn correlation_samples(evidence: &Evidence, residuals: &[f64]) -> f64 {
    evidence
        .channels()
        .filter_map(|(_, channel, range)| {
            let residuals = &residuals[range];
            if !channel.has_own_rate {
                return autocorrelation_time_samples(residuals);
            }
            let own = residuals.iter().zip(channel.values.iter());
            let own = own.filter(|(_, value)| !value.is_nan());
            let own: Vec<f64> = own.map(|(residual, _)| *residual).collect();
            autocorrelation_time_samples(&own)
        })
        .fold(1.0, f64::max)
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::by_id;

    use super::*;
    use crate::bench::Bench as Rig;
    use crate::diagnosis::fit::gather::gather;

    /// Defect seen: a winding with a body, distorted to the ends of their ranges, fitted better than the one body that warms, and kept it
    /// from being tried together with another effect.
    #[test]
    fn a_distorted_form_stands_in_no_other_ones_way() {
        let plant = PlantParameters::nominal();
        let phases = vec![(0.5, 0.0, 0.0), (0.1, 100.0, 0.0), (0.5, 0.0, 0.0)];
        let log = Rig {
            phases,
            ..Rig::default()
        }
        .measure();
        let evidence = gather(&plant, [&log]).unwrap();
        let bench = Bench {
            plant: &plant,
            library: &[],
            fitting: &evidence,
            checking: &evidence,
        };
        let effects = vec![EffectSetting::typical(by_id("chamber_leak").unwrap())];
        let unknowns = Unknowns::new(&plant, &effects, &evidence.logs);
        let of_size = |size: f64, cost: f64| {
            let z = unknowns.list().iter().map(|unknown| unknown.of_size(size));
            let mut fit = Fitter::new(&evidence, &unknowns).at(z.collect()).unwrap();
            fit.cost = cost;
            bench.judge(effects.clone(), unknowns.clone(), fit).unwrap()
        };
        let [good, poor] = [100.0, 200.0].map(|cost| of_size(1.0, cost));
        let [distorted, worse] = [10.0, 20.0].map(|cost| of_size(f64::INFINITY, cost));
        assert!(poor.is_preferred_to(&distorted) && !distorted.is_preferred_to(&poor));
        assert!(good.is_preferred_to(&poor) && !poor.is_preferred_to(&good));
        assert!(distorted.is_preferred_to(&worse) && !worse.is_preferred_to(&distorted));
    }

    /// Defect seen: the coordinates of a trial were taken relative to conditions that the logs were given later.
    #[test]
    fn an_effect_on_top_of_a_trial_keeps_the_conditions_of_the_trial() {
        let rig = Rig {
            initial_bar: 4.0,
            ..Rig::default()
        };
        let mut evidence = gather(&rig.plant, [&rig.measure()]).unwrap();
        fn bench<'a>(plant: &'a PlantParameters, evidence: &'a Evidence) -> Bench<'a> {
            Bench {
                plant,
                library: &[],
                fitting: evidence,
                checking: evidence,
            }
        }
        let plain = bench(&rig.plant, &evidence).plain().unwrap();
        let begun = evidence.conditions();
        let conditions = |unknowns: &Unknowns, z: &[f64]| {
            let mut conditions = begun.clone();
            unknowns.conditions(z, &mut conditions);
            conditions
        };
        let fitted = conditions(&plain.unknowns, &plain.fit.z);
        let mut later = fitted.clone();
        later[0].start_gas.cooling_s *= 5.0;
        evidence.replace_conditions(&later);
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
        let begun = bench(&rig.plant, &evidence);
        let prospect = begun.prospect(&plain, leak);
        assert_eq!(conditions(&prospect.unknowns, &plain.fit.z), fitted);
    }

    /// Defect seen: fewer unknowns underflowed to a number so large that no gain was sufficient.
    #[test]
    fn fewer_unknowns_speak_for_a_model_as_more_speak_against_it() {
        let price = 1000_f64.ln();
        assert_eq!(schwarz_difference(5.0, [12, 12], 1000.0), 5.0);
        assert_eq!(schwarz_difference(5.0, [12, 14], 1000.0), 5.0 - 2.0 * price);
        assert_eq!(schwarz_difference(5.0, [14, 12], 1000.0), 5.0 + 2.0 * price);
    }
}
