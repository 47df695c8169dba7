//! Plan of the field rigs of a draw.

use std::str::FromStr;

use super::super::draw::plan::{Dose, SINGLE_SIZES, dose};
use super::super::draw::profiles;
use super::super::format::Profile;
use super::format::LoggerAnswer;
use super::ordinary;
use crate::chance::Chance;
use crate::reference_plant::Rig;
use crate::reference_plant::catalogue::{Form, Kinship};

/// Number of rigs of which one has a normally open vent valve.
const NORMALLY_OPEN_ONE_OF: usize = 3;
/// Range of the rows per second, uniform on a logarithmic scale.
pub(super) const RATES_HZ: [f64; 2] = [20.0, 5000.0];
/// Largest error of a clock (ppm).
pub(super) const CLOCK_ERROR_PPM: f64 = 200.0;
/// Share of the loggers with an uneven time base, and range of its unevenness.
const UNEVEN: f64 = 0.3;
const UNEVENNESS: [f64; 2] = [0.02, 0.2];
/// Number of gaps of a log, and their lengths (s).
pub(super) const GAPS_MAX: usize = 3;
pub(super) const GAP_S: [f64; 2] = [0.3, 1.5];
/// Distance of a gap from both ends of the log and from the next one (s).
const CLEAR_OF_GAPS_S: f64 = 2.0;
/// Bits of the converter.
pub(super) const BITS: [usize; 2] = [8, 12];
/// Noise of the pressure on the practice rigs (bar), and the range of a rig's noise relative to it.
const PRACTICE_NOISE_BAR: f64 = 4e-3;
const NOISES: [f64; 2] = [0.1, 10.0];
/// Share of the rigs with logged currents; the same share has a logged supply pressure.
const LOGGED: f64 = 0.5;
/// Share of the logs that begin with warm gas.
const WARM: f64 = 0.25;
/// ECU samples of the fill before such a log, and of the shut time from the last command to the first row.
const FILL_SAMPLES: [usize; 2] = [4, 20];
const SHUT_SAMPLES: [usize; 2] = [8, 14];
/// Temperature of the gas above that of the wall at the first row (K), and time constant of its cooling (s).
const SURPLUS_K: [f64; 2] = [5.0, 30.0];
const RELAXATION_S: [f64; 2] = [0.2, 1.0];
/// Length of the hold at the start of such a log, in time constants: until gas and wall have the same temperature.
const HOLD_IN_RELAXATIONS: f64 = 8.0;

/// Share of the hidden effects outside the library, and share of other laws than the textbook's among the rest.
const BEYOND: f64 = 0.12;
const OTHER_LAW: f64 = 0.375;
/// Effect that models the gas temperature itself: with it, the initial warmth would be lost within milliseconds.
const WARMS: &str = "gas_temperature";

/// Length of the id log and of the check log (s).
pub(super) const LENGTHS_S: [f64; 2] = [60.0, 40.0];

/// Smallest and largest number of hidden effects of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effects {
    least: usize,
    most: usize,
}

impl FromStr for Effects {
    type Err = String;

    /// Reads a number, or a range as in `0..4`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (least, most) = text.split_once("..").unwrap_or((text, text));
        match (least.parse(), most.parse()) {
            (Ok(least), Ok(most)) if least <= most && most <= 6 => Ok(Self { least, most }),
            _ => Err(format!(
                "`{text}` is no number of effects; write one, or two as in 0..4, at most 6"
            )),
        }
    }
}

impl Effects {
    /// Draws the effects of a rig, no two of which are physically the same.
    pub(super) fn draw(self, begins_warm: bool, chance: &mut Chance) -> Vec<Dose> {
        let count = chance.whole(self.least, self.most);
        let mut doses: Vec<Dose> = Vec::new();
        while doses.len() < count {
            let kinship = kinship(chance);
            let is_wanted = |form: &Form| {
                let mut drawn = doses.iter().map(|dose| dose.form);
                !(begins_warm && form.effect == WARMS) && drawn.all(|other| !is_same(form, other))
            };
            doses.push(dose(kinship, SINGLE_SIZES, is_wanted, chance));
        }
        doses
    }
}

fn kinship(chance: &mut Chance) -> Kinship {
    if chance.happens(BEYOND) {
        Kinship::Beyond
    } else if chance.happens(OTHER_LAW) {
        Kinship::Variant
    } else {
        Kinship::Matched
    }
}

/// Returns whether two laws are of one effect, or physically the same, so that no log distinguishes them.
fn is_same(a: &Form, b: &Form) -> bool {
    a.effect == b.effect || a.same.contains(&b.effect) || b.same.contains(&a.effect)
}

/// Field rig to run.
#[derive(Debug, Clone)]
pub(super) struct FieldPlan {
    pub(super) plain: Rig,
    pub(super) logger: LoggerAnswer,
    pub(super) logs: [LogPlan; 2],
}

/// Log to record.
#[derive(Debug, Clone)]
pub(super) struct LogPlan {
    pub(super) profile: Profile,
    pub(super) length_s: f64,
    /// Number of ECU samples with one command, so that at least one row shows each command.
    pub(super) command_grid: usize,
    pub(super) phase_s: f64,
    pub(super) gaps: Vec<[f64; 2]>,
    pub(super) warm: Option<Warm>,
}

impl LogPlan {
    /// Returns whether a row at this time is logged, and not in a gap.
    pub(super) fn is_logged(&self, logged_s: f64) -> bool {
        let mut gaps = self.gaps.iter();
        !gaps.any(|gap| (gap[0]..gap[1]).contains(&logged_s))
    }
}

/// Fast fill before the log, and the hold at its start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Warm {
    pub(super) fill_samples: usize,
    pub(super) shut_samples: usize,
    pub(super) hold_samples: usize,
    pub(super) surplus_k: f64,
    pub(super) relaxation_s: f64,
}

impl FieldPlan {
    /// Draws the rig with this number.
    pub(super) fn draw(number: usize, chance: &mut Chance) -> Self {
        let plain = ordinary::rig(number.is_multiple_of(NORMALLY_OPEN_ONE_OF), chance);
        let logger = logger(chance);
        let profiles = profiles(None, chance);
        let logs = [0, 1].map(|n| {
            let [sample_s, length_s] = [plain.datasheet.ecu.sample_time_s, LENGTHS_S[n]];
            LogPlan {
                profile: profiles[n],
                length_s,
                command_grid: command_grid(&logger, sample_s),
                phase_s: chance.between(0.0, sample_s),
                gaps: gaps(length_s, chance),
                warm: chance.happens(WARM).then(|| warm(sample_s, chance)),
            }
        });
        Self {
            plain,
            logger,
            logs,
        }
    }

    /// Returns whether one of the logs begins with warm gas.
    pub(super) fn begins_warm(&self) -> bool {
        self.logs.iter().any(|log| log.warm.is_some())
    }
}

/// Draws a number uniformly on a logarithmic scale.
pub(in crate::blind) fn logarithmic([low, high]: [f64; 2], chance: &mut Chance) -> f64 {
    low * (high / low).powf(chance.share())
}

fn logger(chance: &mut Chance) -> LoggerAnswer {
    LoggerAnswer {
        rate_hz: logarithmic(RATES_HZ, chance),
        clock_error_ppm: chance.between(-CLOCK_ERROR_PPM, CLOCK_ERROR_PPM),
        unevenness: if chance.happens(UNEVEN) {
            chance.between(UNEVENNESS[0], UNEVENNESS[1])
        } else {
            0.0
        },
        bits: chance.whole(BITS[0], BITS[1]),
        noise_bar: PRACTICE_NOISE_BAR * logarithmic(NOISES, chance),
        sensor_share: 1.0,
        currents: chance.happens(LOGGED),
        supply_pressure: chance.happens(LOGGED),
    }
}

/// Returns the largest number of samples between two rows: a command of this length is in the log.
fn command_grid(logger: &LoggerAnswer, sample_s: f64) -> usize {
    let apart_s = (1.0 + 2.0 * logger.unevenness) / logger.rate_hz;
    ((apart_s / sample_s).ceil() as usize).max(1)
}

/// Draws the gaps of a log of this length (s): begin and end of each (s).
pub(in crate::blind) fn gaps(length_s: f64, chance: &mut Chance) -> Vec<[f64; 2]> {
    let count = chance.whole(0, GAPS_MAX);
    let mut gaps: Vec<[f64; 2]> = Vec::new();
    while gaps.len() < count {
        let gap_s = chance.between(GAP_S[0], GAP_S[1]);
        let begin = chance.between(CLEAR_OF_GAPS_S, length_s - gap_s - CLEAR_OF_GAPS_S);
        let end = begin + gap_s;
        if gaps
            .iter()
            .all(|gap| end + CLEAR_OF_GAPS_S < gap[0] || gap[1] + CLEAR_OF_GAPS_S < begin)
        {
            gaps.push([begin, end]);
        }
    }
    gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
    gaps
}

fn warm(sample_s: f64, chance: &mut Chance) -> Warm {
    let relaxation_s = logarithmic(RELAXATION_S, chance);
    Warm {
        fill_samples: chance.whole(FILL_SAMPLES[0], FILL_SAMPLES[1]),
        shut_samples: chance.whole(SHUT_SAMPLES[0], SHUT_SAMPLES[1]),
        hold_samples: (HOLD_IN_RELAXATIONS * relaxation_s / sample_s).ceil() as usize,
        surplus_k: chance.between(SURPLUS_K[0], SURPLUS_K[1]),
        relaxation_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference_plant::catalogue::forms;
    use crate::reference_plant::{Datasheet, Departures};

    #[test]
    fn plans_are_within_their_ranges_and_reach_their_ends() {
        let plans: Vec<FieldPlan> = (1..=400)
            .map(|n| FieldPlan::draw(n, &mut Chance::of(9, n as u64)))
            .collect();
        let share = |is: &dyn Fn(&FieldPlan) -> bool| {
            plans.iter().filter(|plan| is(plan)).count() as f64 / plans.len() as f64
        };
        assert!((share(&|plan| plan.plain.is_vent_normally_open) - 1.0 / 3.0).abs() < 0.01);
        assert!((share(&|plan| plan.logs[0].warm.is_some()) - WARM).abs() < 0.08);
        assert!((share(&|plan| plan.logger.rate_hz < 316.0) - 0.5).abs() < 0.1);
        for plan in &plans {
            let logger = &plan.logger;
            assert!((RATES_HZ[0]..RATES_HZ[1]).contains(&logger.rate_hz));
            assert!(logger.clock_error_ppm.abs() <= CLOCK_ERROR_PPM);
            assert!((BITS[0]..=BITS[1]).contains(&logger.bits));
            assert!((0.4e-3..40e-3).contains(&logger.noise_bar));
            for log in &plan.logs {
                assert!((0.0..10e-3).contains(&log.phase_s) && log.gaps.len() <= GAPS_MAX);
                let stands_s = log.command_grid as f64 * 10e-3;
                assert!(stands_s >= (1.0 + 2.0 * logger.unevenness) / logger.rate_hz);
                for gap in &log.gaps {
                    assert!((GAP_S[0] - 1e-9..GAP_S[1] + 1e-9).contains(&(gap[1] - gap[0])));
                    assert!(gap[0] > 1.0 && gap[1] < log.length_s - 1.0);
                }
            }
        }
    }

    #[test]
    fn effects_are_as_many_as_asked_for_and_no_two_are_the_same_thing() {
        let mut chance = Chance::new(1);
        let effects: Effects = "0..4".parse().unwrap();
        let mut counts = [0; 5];
        for n in 0..200 {
            let begins_warm = n % 2 == 0;
            let doses = effects.draw(begins_warm, &mut chance);
            counts[doses.len()] += 1;
            for (n, dose) in doses.iter().enumerate() {
                let mut others = doses[..n].iter();
                assert!(others.all(|other| !is_same(dose.form, other.form)));
                assert!(!(begins_warm && dose.form.effect == WARMS));
            }
        }
        assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
        assert!(Effects::default().draw(false, &mut chance).is_empty());
        assert!("4..1".parse::<Effects>().is_err() && "many".parse::<Effects>().is_err());
    }

    #[test]
    fn effects_come_from_the_whole_library_and_from_beyond_and_sizes_from_all_of_their_range() {
        let mut chance = Chance::new(2);
        let four: Effects = "4".parse().unwrap();
        let draws = (0..500).flat_map(|_| four.draw(false, &mut chance));
        let doses: Vec<Dose> = draws.collect();
        let share = |is: &dyn Fn(&Dose) -> bool| {
            doses.iter().filter(|dose| is(dose)).count() as f64 / doses.len() as f64
        };
        let beyond = share(&|dose| dose.form.kinship == Kinship::Beyond);
        assert!((beyond - BEYOND).abs() < 0.03, "{beyond}");
        let variant = share(&|dose| dose.form.kinship == Kinship::Variant);
        assert!((variant - (1.0 - BEYOND) * OTHER_LAW).abs() < 0.04);
        let [low, high] = SINGLE_SIZES;
        let small = share(&|dose| dose.size_over_typical < (low * high).sqrt());
        assert!((small - 0.5).abs() < 0.04, "{small}");
        for form in forms() {
            let is_drawn =
                |dose: &Dose| dose.form.law == form.law && dose.form.effect == form.effect;
            assert!(doses.iter().any(is_drawn), "{} ({})", form.effect, form.law);
        }
    }

    /// Two laws must not write one field, because only the second would act.
    #[test]
    fn no_effect_overwrites_another() {
        let sheet = Datasheet::bundled();
        let both = |first: &Form, second: &Form| {
            let mut departures = Departures::default();
            for form in [first, second] {
                form.apply(form.typical, 0.3, &sheet, &mut departures);
            }
            departures
        };
        for a in forms() {
            for b in forms().filter(|b| !is_same(a, b)) {
                let names = format!("{} ({}) and {} ({})", a.effect, a.law, b.effect, b.law);
                assert_eq!(both(a, b), both(b, a), "{names}");
            }
        }
    }
}
