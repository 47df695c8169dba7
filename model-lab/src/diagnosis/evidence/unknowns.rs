//! Free parameters of a fit, in coordinates whose unit is one tolerance or one typical size.

use plant_sim::PlantParameters;
use plant_sim::effects::EffectSetting;
use plant_sim::parameters::Part;

use super::effect_unknown::{EVEN_SD, EffectUnknown};
use super::jumps::jumps;
use super::log::Log;
use super::log_unknown::LogUnknown;
use crate::commands::COMMAND_DELAY;
use crate::conditions::Conditions;
use crate::diagnosis::nuisance::{Nuisance, Shows, nuisances};

/// Step of finite differences: this number of tolerances, ...
const NUISANCE_STEP: f64 = 0.04;
/// ... or this change of an effect's coordinate. Both are far above the solver's error.
const EFFECT_STEP: f64 = 0.04;

/// Width of the range of a phase, in coordinates, above which the commands leave it open, and shares of the range at which fits begin.
const OPEN_PHASE: f64 = 3.0;
const OPEN_SHARES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// Distance from a bound, in coordinates, within which a parameter counts as at the bound.
pub(crate) const AT_BOUND: f64 = 1e-6;

/// Plant with the list of its free parameters.
#[derive(Debug, Clone)]
pub(crate) struct Unknowns {
    datasheet: PlantParameters,
    list: Vec<Unknown>,
}

/// One coordinate.
#[derive(Debug, Clone)]
pub(crate) enum Unknown {
    /// Nuisance parameter: (value - datasheet) / tolerance.
    Nuisance(Nuisance),
    /// Condition of one of the logs: (value - start) / unit.
    Log(LogUnknown),
    /// Parameter of an effect.
    Effect(EffectUnknown),
}

/// Returns the signals that `logs` show together.
fn shown_by(logs: &[Log]) -> Shows {
    let with_pressure = || logs.iter().filter(|log| log.pressure().is_some());
    Shows {
        current: logs.iter().any(Log::has_current),
        pressure: with_pressure().next().is_some(),
        with_supply: with_pressure().any(Log::drives_supply),
        without_supply: with_pressure().any(|log| !log.drives_supply()),
    }
}

impl Unknowns {
    /// Returns the nuisance parameters of `datasheet`, as far as `logs` can show them, then the conditions of the logs, and then the
    /// parameters of the effects in `fitted`, so that a further effect comes last. The values of effects that `datasheet` itself has are
    /// bounded by its statements; exact ones are fixed, and so is an effect that is off.
    pub(crate) fn new(datasheet: &PlantParameters, fitted: &[EffectSetting], logs: &[Log]) -> Self {
        let mut nuisances = nuisances(datasheet, shown_by(logs));
        for nuisance in &mut nuisances {
            let values = jumps(nuisance.spec, logs).into_iter();
            let coordinates = values.map(|value| nuisance.coordinate_of(value));
            nuisance.jumps = coordinates.collect();
        }
        let mut unknowns = Self {
            datasheet: datasheet.clone(),
            list: nuisances.into_iter().map(Unknown::Nuisance).collect(),
        }
        .with_conditions(logs);
        for setting in fitted {
            unknowns = unknowns.with_effect(setting);
        }
        unknowns
    }

    /// Appends the parameters of `setting`. All coordinates are unchanged.
    pub(crate) fn with_effect(mut self, setting: &EffectSetting) -> Self {
        // The statements of the plant about its own effects are retained.
        if self.datasheet.effect(setting.id()) != Some(setting) {
            self.datasheet = self.datasheet.with_effect(setting.clone());
        }
        if setting.is_off() {
            return self;
        }
        let stated = &self.datasheet.knowledge;
        let own = setting.parameters().iter().zip(setting.values());
        let own = own.filter_map(|(&spec, &value)| {
            EffectUnknown::new(spec, stated.get(&spec.name()).map(|&known| (value, known)))
        });
        self.list.extend(own.map(Unknown::Effect));
        self
    }

    /// Returns the unknowns without the effect `id`, and the indices of those that remain.
    pub(crate) fn without_effect(&self, id: &str) -> (Self, Vec<usize>) {
        let (mut kept, places) = self.only(|unknown| unknown.effect_id() != Some(id));
        kept.datasheet = kept.datasheet.without_effect(id);
        (kept, places)
    }

    /// Returns the unknowns with wider ranges of the ordinary parameters that reached the ends of theirs at `z`; none where no parameter
    /// did. Their coordinates and priors are unchanged.
    pub(crate) fn widened(&self, z: &[f64]) -> Option<Self> {
        let mut wide = self.clone();
        let mut is_wider = false;
        for (unknown, &z) in wide.list.iter_mut().zip(z) {
            let (lowest, highest) = unknown.range();
            let Unknown::Nuisance(Nuisance { bounds, .. }) = unknown else {
                continue;
            };
            let (least, most) = *bounds;
            if z - least < AT_BOUND {
                bounds.0 = (least - (most - least)).max(lowest);
            }
            if most - z < AT_BOUND {
                bounds.1 = (most + (most - least)).min(highest);
            }
            is_wider |= *bounds != (least, most);
        }
        is_wider.then_some(wide)
    }

    pub(crate) fn list(&self) -> &[Unknown] {
        &self.list
    }

    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns the coordinates of the datasheet and of the effects as given.
    pub(crate) fn start(&self) -> Vec<f64> {
        self.list
            .iter()
            .map(|unknown| unknown.coordinate(&self.datasheet))
            .collect()
    }

    /// Returns the coordinates of the nuisance parameters of `plant`, and those of the rest as given.
    pub(crate) fn at(&self, plant: &PlantParameters) -> Vec<f64> {
        let coordinate = |unknown: &Unknown| match unknown {
            Unknown::Nuisance(nuisance) => {
                let (least, most) = unknown.bounds();
                let value = nuisance.spec.value(plant);
                let z = value.map_or(0.0, |value| unknown.coordinate_of(value));
                z.clamp(least, most)
            }
            Unknown::Log(_) | Unknown::Effect(_) => unknown.coordinate(&self.datasheet),
        };
        self.list.iter().map(coordinate).collect()
    }

    /// Returns `z` with other clocks of each log whose commands leave its phase open, where the phase and the delays of on/off valves move the
    /// error alike: a descent stays where it began.
    pub(crate) fn other_clocks(&self, z: &[f64]) -> Vec<Vec<f64>> {
        if Part::DelayedOutput.is_in(&self.datasheet) {
            return Vec::new();
        }
        let open = self.list.windows(2).enumerate().filter(|(_, pair)| {
            let [Unknown::Log(first), Unknown::Log(last)] = pair else {
                return false;
            };
            first.is_end_of_clock_with(last)
                && pair.iter().all(|end| {
                    let (least, most) = end.range();
                    most - least > OPEN_PHASE
                })
        });
        open.flat_map(|(n, pair)| {
            OPEN_SHARES.map(|share| {
                let mut moved = z.to_vec();
                for (z, end) in moved[n..].iter_mut().zip(pair) {
                    let (least, most) = end.range();
                    *z = least + share * (most - least);
                }
                moved
            })
        })
        .collect()
    }

    /// Returns the unknowns without the conditions of the logs, and the indices of those that remain.
    pub(crate) fn without_logs(&self) -> (Self, Vec<usize>) {
        self.only(|unknown| !matches!(unknown, Unknown::Log(_)))
    }

    /// Returns the wanted unknowns, and their indices.
    fn only(&self, is_wanted: impl Fn(&Unknown) -> bool) -> (Self, Vec<usize>) {
        let is_kept = |&n: &usize| is_wanted(&self.list[n]);
        let kept: Vec<usize> = (0..self.len()).filter(is_kept).collect();
        let list = kept.iter().map(|&n| self.list[n].clone()).collect();
        let datasheet = self.datasheet.clone();
        (Self { datasheet, list }, kept)
    }

    /// Returns the conditions of the logs alone.
    pub(crate) fn of_logs(plant: &PlantParameters, logs: &[Log]) -> Self {
        let of_plant = Self {
            datasheet: plant.clone(),
            list: Vec::new(),
        };
        of_plant.with_conditions(logs)
    }

    /// Returns by how much the delay of the commands may be wrong (s), because the clocks of the fitted logs compensate for it.
    pub(crate) fn delay_slack_s(&self) -> f64 {
        if !self.list.iter().any(Unknown::is_delay) {
            return 0.0;
        }
        let of_log = |unknown: &Unknown| match unknown {
            Unknown::Log(condition) => condition.phase_reach_s(),
            Unknown::Nuisance(_) | Unknown::Effect(_) => None,
        };
        let reaches_s = self.list.iter().filter_map(of_log);
        reaches_s.reduce(f64::min).unwrap_or(0.0)
    }

    /// Lets the clocks of the logs also compensate for a delay of the commands that is wrong by up to `slack_s`.
    pub(crate) fn with_looser_clocks(mut self, slack_s: f64) -> Self {
        for unknown in &mut self.list {
            if let Unknown::Log(condition) = unknown {
                condition.loosen_phase(slack_s);
            }
        }
        self
    }

    /// Adds the conditions of `logs` to the unknowns.
    fn with_conditions(mut self, logs: &[Log]) -> Self {
        let of_logs = logs.iter().enumerate();
        let fitted = of_logs.flat_map(|(index, log)| LogUnknown::of(index, log));
        self.list.extend(fitted.map(Unknown::Log));
        self
    }

    /// Sets `conditions` to those at the coordinates `z`; conditions that are not fitted are unchanged.
    pub(crate) fn conditions(&self, z: &[f64], conditions: &mut [Conditions]) {
        for (unknown, &z) in self.list.iter().zip(z) {
            let Unknown::Log(fitted) = unknown else {
                continue;
            };
            fitted.put(conditions, unknown.value(z));
        }
    }

    /// Returns the plant at the coordinates `z`.
    pub(crate) fn plant(&self, z: &[f64]) -> PlantParameters {
        let mut plant = self.datasheet.clone();
        for (unknown, &z) in self.list.iter().zip(z) {
            unknown.put(&mut plant, &self.datasheet, z);
        }
        plant
    }
}

impl Unknown {
    /// Returns whether it is the delay of the commands.
    pub(crate) fn is_delay(&self) -> bool {
        matches!(self, Self::Nuisance(nuisance) if nuisance.spec.name() == COMMAND_DELAY)
    }

    /// Returns whether the currents determine it by themselves, however wrong the rest of the plant is.
    pub(crate) fn is_shown_by_currents(&self) -> bool {
        match self {
            Self::Nuisance(nuisance) => nuisance.spec.section == "coil" || self.is_delay(),
            Self::Log(fitted) => fitted.is_of_clock(),
            Self::Effect(_) => false,
        }
    }

    /// Returns the effect to which the parameter belongs.
    pub(crate) fn effect_id(&self) -> Option<&'static str> {
        match self {
            Self::Effect(effect) => effect.spec.effect_id(),
            Self::Nuisance(_) | Self::Log(_) => None,
        }
    }

    /// Returns its name in the plant file; of a condition of a log, a description.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Nuisance(nuisance) => nuisance.spec.name(),
            Self::Effect(effect) => effect.spec.name(),
            Self::Log(condition) => condition.name().to_owned(),
        }
    }

    /// Returns the unit of its value in a plant file; empty for a pure number and for a condition of a log.
    pub(crate) fn unit(&self) -> &'static str {
        match self {
            Self::Nuisance(nuisance) => nuisance.spec.unit,
            Self::Effect(effect) => effect.spec.unit,
            Self::Log(_) => "",
        }
    }

    /// Returns the standard deviation of its coordinate between two correct programs of one plant.
    pub(crate) fn between_programs(&self) -> f64 {
        match self {
            Self::Nuisance(nuisance) => nuisance.between_programs / nuisance.tolerance,
            Self::Log(_) | Self::Effect(_) => 0.0,
        }
    }

    /// Returns the excitation or measurement that determines it, as text; none for a condition of a log.
    pub(crate) fn determined_by(&self) -> Option<String> {
        match self {
            Self::Nuisance(nuisance) => Some(nuisance.determined_by.to_owned()),
            Self::Effect(effect) => effect.determined_by(),
            Self::Log(_) => None,
        }
    }

    /// Returns whether it is the strength of an effect.
    pub(crate) fn is_strength(&self) -> bool {
        matches!(self, Self::Effect(effect) if effect.is_strength())
    }

    /// Returns whether its coordinate is a logarithm.
    pub(crate) fn is_logarithmic(&self) -> bool {
        matches!(self, Self::Effect(effect) if effect.is_log())
    }

    /// Returns whether a strength at `z` is at the strong end of its range.
    pub(crate) fn is_at_strong_end(&self, z: f64) -> bool {
        matches!(self, Self::Effect(effect) if effect.is_at_strong_end(z))
    }

    /// Returns the coordinate at `size` times the typical strength: the larger, the stronger the effect. Any other parameter stays typical.
    pub(crate) fn of_size(&self, size: f64) -> f64 {
        match self {
            Self::Effect(effect) => effect.of_size(size),
            Self::Nuisance(_) | Self::Log(_) => 0.0,
        }
    }

    /// Returns whether its value may have either sign.
    pub(crate) fn is_signed(&self) -> bool {
        matches!(self, Self::Effect(effect) if effect.is_signed())
    }

    pub(crate) fn value(&self, z: f64) -> f64 {
        match self {
            Self::Nuisance(nuisance) => nuisance.datasheet + z * nuisance.tolerance,
            Self::Log(fitted) => fitted.start + z * fitted.unit,
            Self::Effect(effect) => effect.value(z),
        }
    }

    pub(crate) fn coordinate_of(&self, value: f64) -> f64 {
        match self {
            Self::Nuisance(nuisance) => nuisance.coordinate_of(value),
            Self::Log(fitted) => (value - fitted.start) / fitted.unit,
            Self::Effect(effect) => effect.coordinate_of(value),
        }
    }

    fn coordinate(&self, plant: &PlantParameters) -> f64 {
        match self {
            Self::Nuisance(Nuisance { bounds, .. }) => 0.0_f64.clamp(bounds.0, bounds.1),
            Self::Log(_) => 0.0,
            Self::Effect(EffectUnknown { spec, .. }) => spec
                .value(plant)
                .map_or(0.0, |value| self.coordinate_of(value)),
        }
    }

    fn put(&self, plant: &mut PlantParameters, datasheet: &PlantParameters, z: f64) {
        match self {
            Self::Nuisance(nuisance) => nuisance.set(plant, datasheet, self.value(z)),
            Self::Log(_) => {}
            Self::Effect(EffectUnknown { spec, .. }) => {
                let (least, most) = spec.range;
                spec.put(plant, self.value(z).clamp(least, most));
            }
        }
    }

    /// Returns the least and largest coordinate of a fit: a nuisance parameter ends at its tolerance.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        match self {
            Self::Nuisance(Nuisance { bounds, .. }) => *bounds,
            Self::Log(_) => self.range(),
            Self::Effect(effect) => effect.bounds(),
        }
    }

    /// Returns the least and largest coordinate that a plant may have: a difference may exceed a tolerance.
    pub(crate) fn range(&self) -> (f64, f64) {
        match self {
            Self::Nuisance(Nuisance { spec, .. }) | Self::Effect(EffectUnknown { spec, .. }) => (
                self.coordinate_of(spec.range.0),
                self.coordinate_of(spec.range.1),
            ),
            Self::Log(fitted) => (
                self.coordinate_of(fitted.range.0),
                self.coordinate_of(fitted.range.1),
            ),
        }
    }

    /// Returns the coordinates at which the error of the model jumps, ascending.
    pub(crate) fn jumps(&self) -> &[f64] {
        match self {
            Self::Nuisance(nuisance) => &nuisance.jumps,
            Self::Log(_) | Self::Effect(_) => &[],
        }
    }

    /// Returns the least and largest coordinate around `z` between which the error of the model has no jump.
    pub(crate) fn smooth_range(&self, z: f64) -> (f64, f64) {
        let (least, most) = self.range();
        let jumps = self.jumps();
        let above = jumps.partition_point(|&jump| jump <= z);
        let below = above.checked_sub(1).map(|n| jumps[n]);
        let above = jumps.get(above).copied();
        (
            below.map_or(least, |below| below.max(least)),
            above.map_or(most, |above| above.min(most)),
        )
    }

    /// Returns points in the `count` smooth ranges on either side of the one around `z`, within the bounds: near `z`, or in the middle of a
    /// narrow range.
    pub(crate) fn behind_jumps(&self, z: f64, count: usize) -> Vec<f64> {
        let (least, most) = self.bounds();
        let jumps = self.jumps();
        let here = jumps.partition_point(|&jump| jump <= z);
        let ranges = here.saturating_sub(count)..=(here + count).min(jumps.len());
        ranges
            .filter(|&range| range != here)
            .map(|range| {
                let low = range.checked_sub(1).map_or(least, |n| jumps[n].max(least));
                let high = jumps.get(range).map_or(most, |&jump| jump.min(most));
                (low, high)
            })
            .filter(|(low, high)| low < high)
            .map(|(low, high)| {
                let inside = (0.5 * (high - low)).min(NUISANCE_STEP);
                if low > z { low + inside } else { high - inside }
            })
            .collect()
    }

    /// Returns the standard deviation of the prior; infinite for a strength.
    pub(crate) fn prior_sd(&self) -> f64 {
        match self {
            Self::Nuisance(_) => EVEN_SD,
            Self::Log(fitted) => fitted.known.1 / fitted.unit,
            Self::Effect(effect) => effect.prior_sd(),
        }
    }

    /// Returns the standard deviation of the prior; for a strength, which has none, one unit of its coordinate.
    pub(crate) fn believed_sd(&self) -> f64 {
        let sd = self.prior_sd();
        if sd.is_finite() { sd } else { 1.0 }
    }

    /// Returns the mean of the prior.
    pub(crate) fn prior_mean(&self) -> f64 {
        match self {
            Self::Nuisance(_) => 0.0,
            Self::Log(fitted) => self.coordinate_of(fitted.known.0),
            Self::Effect(effect) => effect.prior_mean(),
        }
    }

    /// Returns the step of a two-sided difference, which is insensitive to curvature, but sensitive to the solver's error.
    pub(crate) fn wide_step(&self) -> f64 {
        match self {
            Self::Nuisance(_) => 5.0 * NUISANCE_STEP,
            Self::Log(_) | Self::Effect(_) => EFFECT_STEP,
        }
    }

    pub(crate) fn step(&self) -> f64 {
        match self {
            Self::Nuisance(_) => NUISANCE_STEP,
            Self::Log(_) | Self::Effect(_) => EFFECT_STEP,
        }
    }
}
