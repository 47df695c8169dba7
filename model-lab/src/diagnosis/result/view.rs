//! Queries of a diagnosis for its readers.

use plant_sim::PlantParameters;
use plant_sim::effects::EffectSetting;
use plant_sim::parameters::{LagOf, ParameterSpec};

use super::{Candidate, DetectionLimit, Diagnosis};
use crate::diagnosis::nuisance::{Nuisance, Shows, nuisances};
use crate::diagnosis::verdict::WORTH_SHOWING;

/// Number of candidates that are always contenders.
const FEWEST: usize = 3;

impl Diagnosis {
    /// Returns the plants of the first and the last error step: `plant` with its nuisance parameters refitted, and the same with the named
    /// effects. `plant` is the one that was diagnosed.
    pub fn plain_and_refined(&self, plant: &PlantParameters) -> [PlantParameters; 2] {
        let lag_of = self.lag_of.as_deref().and_then(LagOf::of_word);
        let [mut plain, mut refined] = [plant, plant].map(|plant| plant.with_lag_of(lag_of));
        let nuisances = nuisances(plant, Shows::EVERYTHING);
        for value in &self.nuisance {
            let of_value = |nuisance: &&Nuisance| nuisance.spec.name() == value.name;
            if let Some(nuisance) = nuisances.iter().find(of_value) {
                nuisance.set(&mut plain, plant, value.plain);
                nuisance.set(&mut refined, plant, value.fitted);
            }
        }
        // A search with estimates also fits values that are exact in the plant file, or that move together with another one there.
        for value in &self.nuisance {
            if let Some(spec) = ParameterSpec::by_name(&value.name) {
                spec.put(&mut plain, value.plain);
                spec.put(&mut refined, value.fitted);
            }
        }
        for candidate in self
            .candidates
            .iter()
            .filter(|one| self.effects.contains(&one.effect))
        {
            let Some(effect) = plant.candidate(&candidate.effect) else {
                continue;
            };
            let Some(variant) = effect.about().variant(&candidate.variant) else {
                continue;
            };
            refined = refined.with_effect(EffectSetting::typical_variant(effect, variant));
            for spec in variant.parameters {
                let fitted = candidate
                    .parameters
                    .iter()
                    .find(|fitted| fitted.key == spec.key);
                if let Some(fitted) = fitted {
                    spec.put(&mut refined, fitted.value);
                }
            }
        }
        [plain, refined]
    }

    /// Returns the candidates that explain something, including the named ones, and always the best ones.
    pub fn contenders(&self) -> impl Iterator<Item = &Candidate> {
        let candidates = self.candidates.iter().enumerate();
        let counts = |(index, candidate): &(usize, &Candidate)| {
            *index < FEWEST
                || candidate.explained_share >= WORTH_SHOWING
                || self.effects.contains(&candidate.effect)
        };
        candidates.filter(counts).map(|(_, candidate)| candidate)
    }
}

impl Candidate {
    /// Returns whether a smaller parameter of its detection limit means a stronger effect, as with the area of a restriction.
    pub fn is_stronger_below(&self) -> bool {
        let DetectionLimit::Size { key, value, .. } = &self.detection_limit else {
            return false;
        };
        let spec = ParameterSpec::by_name(&format!("effects.{}.{key}", self.effect));
        let off = spec.and_then(|spec| spec.size?.off);
        off.is_some_and(|off| off > *value)
    }
}
