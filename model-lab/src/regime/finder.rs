//! Search for the smallest regime with the largest share of the excess, reported in one sentence.

use super::dimension::Dimension;
use super::excess::{Excess, Sums};
use super::features::{Features, States, VALVE_STATES};
use crate::result::{Finding, Horizon};

/// Distance of the tried thresholds of pressure (bar) ...
const CELL_BAR: f64 = 0.1;
/// ... or a larger one, so that there are at most this many cells: up to 50 bar have the distance above.
const CELLS_MAX: f64 = 500.0;
/// Excess share that each further condition must gain.
const CONDITION_COST: f64 = 0.02;
/// Least difference of the shares of excess and samples of a regime.
const LEAST_GAIN: f64 = 0.15;
/// Smallest number of samples of a regime.
const FEWEST_SAMPLES: usize = 10;
/// Share of the bias in the rms from which on the error has a sign.
const SIGNED: f64 = 0.4;

/// Box in the space of regimes.
#[derive(Debug, Clone, Copy)]
struct Regime {
    /// Index into [`VALVE_STATES`].
    valve_state: Option<usize>,
    /// Number of a combination in the list of phrases.
    phrase: Option<usize>,
    pressure: Pressure,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Pressure {
    Any,
    Below(usize),
    Above(usize),
}

/// Searches valve state × pressure threshold × one bin of any other dimension.
pub(crate) fn find(
    dimensions: &[Dimension],
    features: &Features,
    excess: &Excess,
    horizon: Horizon,
) -> Finding {
    let none = |sentence: &str| Finding {
        horizon,
        regime: None,
        excess_share: None,
        sample_share: None,
        bias: None,
        sentence: sentence.to_owned(),
    };
    if !excess.is_significant() {
        let ahead = match horizon {
            Horizon::FreeRun => "",
            Horizon::OneStepAhead => "one step ahead, ",
        };
        return none(&format!("{ahead}{}", excess.in_words()));
    }
    let combined: Vec<&Dimension> = dimensions
        .iter()
        .filter(|dimension| dimension.combines)
        .collect();
    let phrases: Vec<&str> = combined
        .iter()
        .flat_map(|dimension| &dimension.bins)
        .map(|bin| &bin.phrase[..])
        .collect();
    let cell_bar = features.states.cell_bar;
    let histograms = histograms(&combined, phrases.len(), features, excess);
    let all = histograms[0]
        .iter()
        .fold(Sums::default(), |sum, cell| sum.plus(cell));
    let mut best: Option<(f64, Regime, Sums)> = None;
    for (index, histogram) in histograms.iter().enumerate() {
        let (state, phrase) = (index % STATES, index / STATES);
        for (pressure, sums) in thresholds(histogram) {
            let regime = Regime {
                valve_state: state.checked_sub(1),
                phrase: phrase.checked_sub(1),
                pressure,
            };
            let Some(share) = excess.share(&sums).filter(|_| sums.count >= FEWEST_SAMPLES) else {
                continue;
            };
            let gain = share.min(1.0) - sums.count as f64 / all.count as f64;
            let score = gain - CONDITION_COST * regime.conditions().saturating_sub(1) as f64;
            if best.is_none_or(|(highest, ..)| score > highest) {
                best = Some((score, regime, sums));
            }
        }
    }
    let Some((_, regime, sums)) = best.filter(|(score, ..)| *score > LEAST_GAIN) else {
        return none(&format!(
            "the excess is spread over the whole log, {}",
            sign(&all)
        ));
    };
    let sample_share = sums.count as f64 / all.count as f64;
    let share = excess.share(&sums).unwrap_or_default();
    let words = regime.words(&phrases, cell_bar);
    Finding {
        horizon,
        sentence: format!(
            "{:.0} % of the excess is in {} % of the samples: {words}, {}",
            100.0 * share.min(1.0),
            percent(sample_share),
            sign(&sums)
        ),
        regime: Some(words),
        excess_share: Some(share),
        sample_share: Some(sample_share),
        bias: Some(sums.bias()),
    }
}

/// Number of choices for the valve state: any, or one of the four.
const STATES: usize = VALVE_STATES.len() + 1;

/// Returns the distance of two thresholds (bar) for this highest pressure (bar).
pub(crate) fn cell_bar(highest_bar: f64) -> f64 {
    CELL_BAR.max(highest_bar / CELLS_MAX)
}

/// Returns sums over cells of pressure for each combination of (any or one phrase) and (any or one valve state).
fn histograms(
    combined: &[&Dimension],
    phrases: usize,
    features: &Features,
    excess: &Excess,
) -> Vec<Vec<Sums>> {
    let States {
        pressure_cell,
        valve_state,
        ..
    } = features.states;
    let cells = 1 + usize::from(pressure_cell.iter().max().unwrap_or(0));
    let mut histograms = vec![vec![Sums::default(); cells]; (phrases + 1) * STATES];
    let mut placed: Vec<_> = combined
        .iter()
        .map(|dimension| (dimension.bin_of.iter(), dimension.bins.len()))
        .collect();
    let samples = excess
        .residual
        .iter()
        .zip(pressure_cell.iter().zip(valve_state.iter()));
    for (error, (cell, state)) in samples {
        if error.is_nan() {
            for (bins, _) in &mut placed {
                bins.next();
            }
            continue;
        }
        let (cell, state) = (usize::from(cell), 1 + usize::from(state));
        let mut first = 1;
        let mut add = |phrase: usize| {
            histograms[phrase * STATES][cell].add(error);
            histograms[phrase * STATES + state][cell].add(error);
        };
        add(0);
        for (bins, count) in &mut placed {
            if let Some(bin) = bins.next() {
                add(first + usize::from(bin));
            }
            first += *count;
        }
    }
    histograms
}

/// Returns the sums of the whole histogram, and of its parts below and above each threshold.
fn thresholds(histogram: &[Sums]) -> Vec<(Pressure, Sums)> {
    let all = histogram
        .iter()
        .fold(Sums::default(), |sum, cell| sum.plus(cell));
    let mut regimes = vec![(Pressure::Any, all)];
    let mut below = Sums::default();
    for (index, cell) in histogram.iter().enumerate().take(histogram.len() - 1) {
        below = below.plus(cell);
        regimes.push((Pressure::Below(index + 1), below));
        regimes.push((Pressure::Above(index + 1), all.minus(&below)));
    }
    regimes
}

impl Regime {
    fn conditions(&self) -> usize {
        usize::from(self.valve_state.is_some())
            + usize::from(self.phrase.is_some())
            + usize::from(self.pressure != Pressure::Any)
    }

    fn words(&self, phrases: &[&str], cell_bar: f64) -> String {
        let bar = |cell: usize| format!("{:.1} bar", cell as f64 * cell_bar);
        let pressure = match self.pressure {
            Pressure::Any => None,
            Pressure::Below(cell) => Some(format!("below {}", bar(cell))),
            Pressure::Above(cell) => Some(format!("above {}", bar(cell))),
        };
        let state = self.valve_state.map(|state| VALVE_STATES[state].to_owned());
        let place: Vec<String> = state.into_iter().chain(pressure).collect();
        let phrase = self.phrase.map(|phrase| phrases[phrase].to_owned());
        let parts = Some(place.join(" "))
            .filter(|place| !place.is_empty())
            .into_iter()
            .chain(phrase);
        parts.collect::<Vec<_>>().join(", ")
    }
}

fn sign(sums: &Sums) -> &'static str {
    let (bias, rms) = (sums.bias(), sums.rms());
    match () {
        () if bias > SIGNED * rms => "measured higher than modelled",
        () if bias < -SIGNED * rms => "measured lower than modelled",
        () => "with either sign",
    }
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 1.0 {
        format!("{percent:.1}")
    } else {
        format!("{percent:.0}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;
    use crate::result::Residual;

    const SHUT: u16 = 0;
    const FILLING: u16 = 1;
    const VENTING: u16 = 2;

    /// State at some samples, unsorted.
    struct Spread {
        valve_state: Vec<u16>,
        pressure_bar: Vec<f64>,
        duty_pct: Vec<f64>,
        since_switch_s: Vec<f64>,
        energised_s: Vec<f64>,
        times_s: Vec<f64>,
    }

    /// Returns 6000 samples: every third one shut, filling or venting, pressures spread over 0 to 8 bar, duty cycles over 0 to 100 %.
    fn spread() -> Spread {
        let count = 6000;
        let spread = |step: usize| (0..count).map(move |n| (n * step % 1000) as f64 / 1000.0);
        Spread {
            valve_state: (0..count).map(|n| (n % 3) as u16).collect(),
            pressure_bar: spread(7).map(|part| 8.0 * part).collect(),
            duty_pct: spread(13).map(|part| 100.0 * part).collect(),
            since_switch_s: spread(17).collect(),
            energised_s: (0..count).map(|n| n as f64 * 5e-3).collect(),
            times_s: (0..count).map(|n| n as f64 * 0.01).collect(),
        }
    }

    impl Spread {
        fn states(&self) -> States {
            let constant = |bin: u16| self.times_s.iter().map(|_| bin).collect();
            States::new(
                [
                    self.valve_state.iter().copied().collect(),
                    constant(0),
                    constant(2),
                ],
                &self.pressure_bar,
                &self.times_s,
            )
        }

        fn features<'a>(&self, states: &'a States) -> Features<'a> {
            Features::sorted(
                states,
                self.duty_pct.iter().copied(),
                self.since_switch_s.iter().copied().map(Some),
                self.energised_s.iter().copied(),
            )
        }
    }

    /// Returns the finding where `error` (of feature and index) is added to white noise.
    fn found(error: impl Fn(&Spread, usize) -> f64) -> Finding {
        let spread = spread();
        let mut noise = Noise::new(1);
        let residual: Vec<f64> = (0..6000)
            .map(|n| noise.normal() + error(&spread, n))
            .collect();
        let states = spread.states();
        let features = spread.features(&states);
        find(
            &features.dimensions(),
            &features,
            &Excess::new(Residual::new(&residual, &[0.0; 6000]), 1.0, 1000.0),
            Horizon::OneStepAhead,
        )
    }

    #[test]
    fn a_fault_below_a_pressure_is_named_with_valve_state_threshold_and_sign() {
        let finding = found(|features, n| {
            let acts = features.valve_state[n] == VENTING && features.pressure_bar[n] < 1.9;
            if acts { 4.0 } else { 0.0 }
        });
        assert_eq!(finding.regime.as_deref(), Some("venting below 1.9 bar"));
        assert!(
            finding
                .sentence
                .ends_with("venting below 1.9 bar, measured higher than modelled")
        );
        assert!(
            (finding.excess_share.unwrap() - 1.0).abs() < 0.1,
            "{finding:?}"
        );
        assert!(
            (finding.sample_share.unwrap() - 1.9 / 8.0 / 3.0).abs() < 0.005,
            "{finding:?}"
        );
    }

    #[test]
    fn a_fault_above_a_pressure_whatever_the_valves_do_is_no_valve_s_fault() {
        let finding = found(|features, n| {
            if features.pressure_bar[n] >= 6.0 {
                -3.0
            } else {
                0.0
            }
        });
        assert_eq!(finding.regime.as_deref(), Some("above 6.0 bar"));
        assert!(
            finding.sentence.ends_with("measured lower than modelled"),
            "{}",
            finding.sentence
        );
    }

    #[test]
    fn a_fault_of_one_duty_band_is_named_by_it() {
        let finding = found(|features, n| {
            let acts =
                features.valve_state[n] == FILLING && (30.0..50.0).contains(&features.duty_pct[n]);
            if acts {
                4.0 * if n % 2 == 0 { 1.0 } else { -1.0 }
            } else {
                0.0
            }
        });
        assert_eq!(finding.regime.as_deref(), Some("filling, duty 30 to 50 %"));
        assert!(
            finding.sentence.ends_with("with either sign"),
            "{}",
            finding.sentence
        );
    }

    #[test]
    fn a_fault_that_comes_with_heat_is_named_by_the_time_under_current() {
        let finding = found(|features, n| {
            let acts = features.valve_state[n] != SHUT && features.energised_s[n] >= 24.0;
            if acts { 4.0 } else { 0.0 }
        });
        let regime = finding.regime.unwrap();
        assert!(
            regime.contains("after 24 s and more under current"),
            "{regime}"
        );
    }

    #[test]
    fn a_fault_that_is_everywhere_is_placed_nowhere() {
        let finding = found(|_, _| 2.0);
        assert_eq!(finding.regime, None);
        assert_eq!(
            finding.sentence,
            "the excess is spread over the whole log, measured higher than modelled"
        );
    }

    /// A pressure of 4e9 bar, from a mapping with a wrong offset, requested 103 GB.
    #[test]
    fn cells_are_counted_by_no_value() {
        for highest in [8.0, 49.0, 1e3, 1e9, 1e300] {
            let mut spread = spread();
            spread.pressure_bar[7] = highest;
            let excess = Excess::new(Residual::new(&[1.0; 6000], &[0.0; 6000]), 0.0, 0.0);
            let states = spread.states();
            let found = histograms(&[], 0, &spread.features(&states), &excess);
            assert!(
                found[0].len() <= CELLS_MAX as usize + 2,
                "{highest}: {}",
                found[0].len()
            );
            assert!(states.pressure_band_labels().len() <= 1000);
            if highest < 50.0 {
                assert_eq!(states.cell_bar, CELL_BAR);
            }
        }
    }

    #[test]
    fn noise_alone_has_no_regime() {
        let finding = found(|_, _| 0.0);
        assert_eq!((finding.regime, finding.excess_share), (None, None));
    }
}
