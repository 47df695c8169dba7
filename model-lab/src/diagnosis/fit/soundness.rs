//! Test whether a fit found an effect, or only distorted a law until it fits.

use super::interval::{half_widths, half_widths_of_noise};
use super::trial::{Bench, Trial, Widths};
use crate::diagnosis::verdict::LOOSEST_STRENGTH;

/// Returns the half widths of the intervals; none where the plant near the fit cannot be simulated.
fn widths_of(trial: &Trial, bench: &Bench) -> Option<Widths> {
    let mut sharp = trial.clone();
    sharp.sharpen(bench)?;
    Some(Widths {
        of_what_is_left: half_widths(bench.fitting, &sharp),
        of_noise: half_widths_of_noise(bench.fitting, &sharp),
    })
}

impl Trial {
    /// Returns whether the logs determine the strength of each effect that it adds to `base`, and none reached the strong end of its range:
    /// such a law stands for another one.
    pub(crate) fn is_sound(&self, bench: &Bench, base: &Self) -> bool {
        self.is_known_within(|widths| &widths.of_what_is_left, bench, base)
    }

    /// Returns the same under the assumption that other effects explain the rest of the error. A large rest makes any interval wide,
    /// however large the explained part is.
    pub(crate) fn is_sound_but_for_the_rest(&self, bench: &Bench, base: &Self) -> bool {
        self.is_known_within(|widths| &widths.of_noise, bench, base)
    }

    fn is_known_within(&self, widths: fn(&Widths) -> &[f64], bench: &Bench, base: &Self) -> bool {
        let Some(known) = self.widths.get_or_init(|| widths_of(self, bench)) else {
            return false;
        };
        let widths = widths(known);
        let list = self.unknowns.list();
        let mut first = base.unknowns.len();
        self.effects[base.effects.len()..].iter().all(|effect| {
            let own = first..first + effect.parameters().len();
            first = own.end;
            let strengths: Vec<usize> = own.filter(|&n| list[n].is_strength()).collect();
            let known = |&n: &usize| {
                let width = widths[n];
                if list[n].is_logarithmic() {
                    width < LOOSEST_STRENGTH
                } else {
                    width < self.fit.z[n].abs()
                }
            };
            let too_strong = |&n: &usize| list[n].is_at_strong_end(self.fit.z[n]);
            strengths.iter().any(known) && !strengths.iter().any(too_strong)
        })
    }
}
