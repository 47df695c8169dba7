//! Plan of the rigs of a draw.

use super::super::format::{Class, Poor};
use crate::chance::Chance;
use crate::reference_plant::catalogue::{Form, Kinship, forms_of};

/// Pairs of effects that act in different places, so that neither effect can explain the other.
const PAIRS: [[&str; 2]; 20] = [
    ["chamber_leak", "coil_ambient_temperature"],
    ["chamber_leak", "drain_back_pressure"],
    ["chamber_leak", "eddy_currents"],
    ["chamber_leak", "series_restriction"],
    ["supply_seat_leak", "flyback_clamp"],
    ["supply_seat_leak", "drain_back_pressure"],
    ["supply_line_droop", "coil_heating"],
    ["supply_line_droop", "sensor_offset"],
    ["sensor_lag", "supply_resistance"],
    ["sensor_lag", "chamber_leak"],
    ["sensor_offset", "iron_saturation"],
    ["gas_temperature", "flyback_clamp"],
    ["gas_temperature", "coil_ambient_temperature"],
    ["critical_ratio", "eddy_currents"],
    ["regulating_valve_volume", "supply_resistance"],
    ["dead_volume", "coil_heating"],
    ["flow_force", "chamber_leak"],
    ["static_friction", "sensor_offset"],
    ["end_stop_bounce", "supply_seat_leak"],
    ["drain_back_pressure", "iron_saturation"],
];

/// Sizes relative to the typical one: from far below the noise to far above it.
pub(in crate::blind) const SINGLE_SIZES: [f64; 2] = [0.15, 10.0];
/// Sizes of effects in a pair, or in a poor log, relative to the typical size: each effect is clearly above the noise.
const STRONG_SIZES: [f64; 2] = [1.5, 6.0];

/// Number of rigs of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Rigs without effect.
    pub plain: usize,
    /// Rigs with one effect in the law of the textbook.
    pub matched: usize,
    /// Rigs with one effect in another law.
    pub variant: usize,
    /// Rigs with two effects.
    pub two: usize,
    /// Rigs with one effect outside any library.
    pub beyond: usize,
    /// Rigs with poor logs, every other one with an effect.
    pub poor: usize,
}

impl Counts {
    /// The full set.
    pub const FULL: Self = Self {
        plain: 60,
        matched: 105,
        variant: 60,
        two: 40,
        beyond: 40,
        poor: 36,
    };

    /// Returns a share of each, rounded up.
    pub fn share(self, share: f64) -> Self {
        let of = |count: usize| (count as f64 * share).ceil() as usize;
        Self {
            plain: of(self.plain),
            matched: of(self.matched),
            variant: of(self.variant),
            two: of(self.two),
            beyond: of(self.beyond),
            poor: of(self.poor),
        }
    }
}

/// Rig to draw.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) class: Class,
    pub(super) poor: Option<Poor>,
    pub(super) hidden: Vec<Dose>,
}

/// Law of an effect and its size.
#[derive(Debug, Clone, Copy)]
pub(in crate::blind) struct Dose {
    pub(in crate::blind) form: &'static Form,
    pub(in crate::blind) size_over_typical: f64,
    pub(in crate::blind) shape: f64,
}

impl Dose {
    /// Draws a dose; `stratum` is the position on the logarithmic scale of sizes, 0 to 1.
    fn new(form: &'static Form, sizes: [f64; 2], stratum: f64, chance: &mut Chance) -> Self {
        Self {
            form,
            size_over_typical: sizes[0] * (sizes[1] / sizes[0]).powf(stratum),
            shape: chance.share(),
        }
    }
}

/// Plans all rigs, in an order that gives no hint.
pub(super) fn plans(counts: Counts, chance: &mut Chance) -> Vec<Plan> {
    let mut plans = Vec::new();
    plans.extend((0..counts.plain).map(|_| plan(Class::Plain, None, vec![])));
    for (class, kinship, count) in [
        (Class::Matched, Kinship::Matched, counts.matched),
        (Class::Variant, Kinship::Variant, counts.variant),
        (Class::Beyond, Kinship::Beyond, counts.beyond),
    ] {
        let mut forms: Vec<_> = forms_of(kinship).collect();
        chance.shuffle(&mut forms);
        let rounds = count.div_ceil(forms.len());
        // Each form goes through the strata of sizes in its own order.
        let shifts: Vec<usize> = forms.iter().map(|_| chance.whole(0, rounds)).collect();
        plans.extend((0..count).map(|n| {
            let (round, place) = (n / forms.len(), n % forms.len());
            let stratum = ((round + shifts[place]) % rounds) as f64 + chance.share();
            let dose = Dose::new(forms[place], SINGLE_SIZES, stratum / rounds as f64, chance);
            plan(class, None, vec![dose])
        }));
    }
    let mut pairs = PAIRS;
    chance.shuffle(&mut pairs);
    for n in 0..counts.two {
        let doses =
            pairs[n % pairs.len()].map(|effect| strong(|form| form.effect == effect, chance));
        plans.push(plan(Class::Two, None, doses.to_vec()));
    }
    for n in 0..counts.poor {
        let poor = Poor::ALL[n % Poor::ALL.len()];
        plans.push(if (n / Poor::ALL.len()).is_multiple_of(2) {
            plan(Class::Plain, Some(poor), vec![])
        } else {
            plan(Class::Matched, Some(poor), vec![strong(|_| true, chance)])
        });
    }
    chance.shuffle(&mut plans);
    plans
}

fn plan(class: Class, poor: Option<Poor>, hidden: Vec<Dose>) -> Plan {
    Plan {
        class,
        poor,
        hidden,
    }
}

/// Draws a strong dose of one matched form that `wanted` accepts.
fn strong(wanted: impl Fn(&Form) -> bool, chance: &mut Chance) -> Dose {
    dose(Kinship::Matched, STRONG_SIZES, wanted, chance)
}

/// Draws a dose of one accepted form of a kinship, its size relative to the typical one between `sizes`, uniform on a
/// logarithmic scale.
pub(in crate::blind) fn dose(
    kinship: Kinship,
    sizes: [f64; 2],
    wanted: impl Fn(&Form) -> bool,
    chance: &mut Chance,
) -> Dose {
    let forms: Vec<_> = forms_of(kinship).filter(|form| wanted(form)).collect();
    let form = chance.one_of(&forms);
    let stratum = chance.share();
    Dose::new(form, sizes, stratum, chance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_full_set_has_every_form_and_every_pair() {
        let plans = plans(Counts::FULL, &mut Chance::new(1));
        assert_eq!(plans.len(), 341);
        let laws: BTreeSet<_> = plans
            .iter()
            .filter(|plan| plan.poor.is_none())
            .flat_map(|plan| {
                plan.hidden
                    .iter()
                    .map(|dose| (dose.form.effect, dose.form.law))
            })
            .collect();
        assert_eq!(
            laws.len(),
            crate::reference_plant::catalogue::forms().count()
        );
        let pairs: BTreeSet<_> = plans
            .iter()
            .filter(|plan| plan.class == Class::Two)
            .map(|plan| [plan.hidden[0].form.effect, plan.hidden[1].form.effect])
            .collect();
        assert_eq!(pairs.len(), PAIRS.len());
    }

    #[test]
    fn each_effect_is_drawn_once_in_each_stratum_of_sizes() {
        let plans = plans(Counts::FULL, &mut Chance::new(2));
        let mut strata: Vec<i32> = plans
            .iter()
            .filter(|plan| plan.class == Class::Matched && plan.poor.is_none())
            .filter(|plan| plan.hidden[0].form.effect == "chamber_leak")
            .map(|plan| {
                let size = plan.hidden[0].size_over_typical;
                let place =
                    (size / SINGLE_SIZES[0]).ln() / (SINGLE_SIZES[1] / SINGLE_SIZES[0]).ln();
                (5.0 * place) as i32
            })
            .collect();
        strata.sort_unstable();
        assert_eq!(strata, [0, 1, 2, 3, 4]);
    }
}
