//! Right names that the same rigs keep with better sensors.

use std::fmt;

use serde::Serialize;

use super::super::super::score::share::Share;
use super::NamedRig;

/// Right names that rigs keep with better sensors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Kept {
    /// Noise and converter steps of the better sensors relative to those of the first draw.
    pub sensor_share: f64,
    /// Right names of the first draw, and those of them that the better sensors show as well.
    pub names: Share,
    /// Lost names: rig, effect, and the answer with the better sensors.
    pub lost: Vec<String>,
}

impl Kept {
    /// Compares the names of rigs `with_better_sensors` with those of the same rigs among `rigs`.
    pub fn of(rigs: &[NamedRig], with_better_sensors: &[NamedRig]) -> Self {
        let mut kept = Self {
            sensor_share: f64::NAN,
            names: Share::default(),
            lost: Vec::new(),
        };
        for better in with_better_sensors {
            let name = &better.answer.rig;
            let Some(rig) = rigs.iter().find(|rig| rig.answer.rig == *name) else {
                continue;
            };
            kept.sensor_share = better.answer.logger.sensor_share / rig.answer.logger.sensor_share;
            for named in rig.hidden().filter(|one| one.is_named) {
                let id = &named.hidden.effect;
                let is_kept = better
                    .hidden()
                    .any(|one| one.is_named && one.hidden.effect == *id);
                kept.names.of += 1;
                kept.names.count += usize::from(is_kept);
                if !is_kept {
                    kept.lost.push(better.lost(id));
                }
            }
        }
        kept
    }
}

impl NamedRig {
    /// Returns one line on an effect that is no longer named.
    fn lost(&self, effect: &str) -> String {
        let answer = self.finding.as_ref().map_or_else(
            || "no answer".to_owned(),
            |finding| format!("{} [{}]", finding.verdict, finding.effects.join(", ")),
        );
        format!("{}: {effect}, now {answer}", self.answer.rig)
    }
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = self.sensor_share;
        writeln!(
            f,
            "right names kept with {share:.3} of the noise: {}",
            self.names
        )?;
        self.lost
            .iter()
            .try_for_each(|lost| writeln!(f, "  {lost}"))
    }
}
