//! What a measurement scatters by itself, estimated without the model.
//!
//! While nothing can change a signal, all that is left of it after taking out a slow trend is noise. The variance of
//! each quiet piece is taken after a straight line is removed; the median over the pieces ignores the few in which
//! something did move, such as gas that still cools. Noise below the resolution hides in it, so the floor is never
//! below that of the quantisation, step / sqrt(12).

use std::ops::Range;

use plant_sim::plant::{FILL, VENT};

use crate::commands::Commands;
use crate::metrics::present;
use crate::result::NoiseFloor;

/// A valve closes and a current dies within this time after the output is low [s].
const SETTLE_S: f64 = 0.05;
/// A pressure hold counts from this length on [s].
const SHORTEST_HOLD_S: f64 = 0.3;
/// A piece is at most this long [s], so that a straight line follows any drift in it ...
const LONGEST_PIECE_S: f64 = 0.5;
/// ... unless that would leave fewer samples than this.
const FEWEST_SAMPLES: usize = 10;

/// A noise floor with what its accuracy depends on.
#[derive(Debug, Clone)]
pub(crate) struct Floor {
    pub(crate) summary: NoiseFloor,
    /// Standard deviation; 0 where unknown.
    pub(crate) sigma: f64,
    /// Degrees of freedom behind `sigma`.
    pub(crate) freedom: f64,
}

/// Where a signal is quiet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quiet {
    /// While both valves are shut.
    Hold,
    /// While the coil of this valve is dead.
    DeadCoil(usize),
}

impl Quiet {
    /// Currents and armatures rest with their coil; everything else with the chamber.
    pub(crate) fn of_signal(name: &str) -> Self {
        match name {
            "i_fill" | "x_fill" => Self::DeadCoil(FILL),
            "i_vent" | "x_vent" => Self::DeadCoil(VENT),
            _ => Self::Hold,
        }
    }

    fn stretches(self, commands: &Commands) -> Vec<Range<usize>> {
        match self {
            Self::Hold => {
                let length_s = |hold: &Range<usize>| {
                    commands.times_s[hold.end - 1] - commands.times_s[hold.start]
                };
                let mut holds = commands.holds(SETTLE_S);
                holds.retain(|hold| length_s(hold) + SETTLE_S > SHORTEST_HOLD_S);
                holds
            }
            Self::DeadCoil(valve) => commands.dead_coil(valve, SETTLE_S),
        }
    }

    fn when(self) -> &'static str {
        match self {
            Self::Hold => "both valves shut",
            Self::DeadCoil(_) => "the coil dead",
        }
    }
}

/// The noise floor of `values`, sampled at the instants of `commands`.
pub(crate) fn noise_floor(values: &[f64], unit: &str, quiet: Quiet, commands: &Commands) -> Floor {
    let mut variances = Vec::new();
    let mut samples = 0;
    for piece in pieces(&quiet.stretches(commands), &commands.times_s) {
        if let Some((variance, count)) =
            detrended_variance(&commands.times_s[piece.clone()], &values[piece])
        {
            variances.push((variance, count));
            samples += count;
        }
    }
    let step = quantisation_step(values);
    let summary = |value, statement| NoiseFloor {
        value,
        quantisation_step: step,
        pieces: variances.len(),
        samples,
        statement,
    };
    let Some(scattered) = median_variance(&variances).map(f64::sqrt) else {
        let statement = format!("unknown: give 2 s with {}", quiet.when());
        return Floor {
            summary: summary(None, statement),
            sigma: 0.0,
            freedom: 0.0,
        };
    };
    let resolved = step.map_or(0.0, |step| step / 12_f64.sqrt());
    let sigma = scattered.max(resolved);
    if sigma == 0.0 {
        let statement = format!(
            "unknown: the log does not change at all with {}; log it finer",
            quiet.when()
        );
        return Floor {
            summary: summary(None, statement),
            sigma,
            freedom: 0.0,
        };
    }
    let source = if scattered >= resolved {
        "the scatter"
    } else {
        "the resolution"
    };
    let statement = format!(
        "{} {unit} rms from {source} of {samples} samples with {} ({} pieces, each without its trend)",
        significant(sigma),
        quiet.when(),
        variances.len()
    );
    let freedom = (samples - 2 * variances.len()) as f64;
    Floor {
        summary: summary(Some(sigma), statement),
        sigma,
        freedom,
    }
}

/// Three significant digits, for people.
fn significant(value: f64) -> String {
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

/// Cuts stretches into pieces of equal length.
fn pieces(stretches: &[Range<usize>], times_s: &[f64]) -> Vec<Range<usize>> {
    let mut pieces = Vec::new();
    for stretch in stretches {
        let duration_s = times_s[stretch.end - 1] - times_s[stretch.start];
        let by_time = (duration_s / LONGEST_PIECE_S).ceil().max(1.0) as usize;
        let count = by_time.min(stretch.len() / FEWEST_SAMPLES).max(1);
        let cut = |part: usize| stretch.start + part * stretch.len() / count;
        pieces.extend((0..count).map(|part| cut(part)..cut(part + 1)));
    }
    pieces
}

/// Variance about a straight line, with the number of samples; none for fewer than [`FEWEST_SAMPLES`].
fn detrended_variance(times_s: &[f64], values: &[f64]) -> Option<(f64, usize)> {
    let pairs = || {
        times_s
            .iter()
            .zip(values)
            .filter(|(_, value)| !value.is_nan())
    };
    let count = pairs().count();
    if count < FEWEST_SAMPLES {
        return None;
    }
    let n = count as f64;
    let (time, level) = pairs().fold((0.0, 0.0), |(t, y), (time, value)| {
        (t + time / n, y + value / n)
    });
    let (tt, ty, yy) = pairs().fold((0.0, 0.0, 0.0), |(tt, ty, yy), (t, y)| {
        let (t, y) = (t - time, y - level);
        (tt + t * t, ty + t * y, yy + y * y)
    });
    Some(((yy - ty * ty / tt).max(0.0) / (n - 2.0), count))
}

/// Median of the variances, each first divided by where the median of its chi-squared distribution lies
/// (Wilson and Hilferty); none without pieces.
fn median_variance(variances: &[(f64, usize)]) -> Option<f64> {
    let unbiased = |&(variance, count): &(f64, usize)| {
        let freedom = (count - 2) as f64;
        variance / (1.0 - 2.0 / (9.0 * freedom)).powi(3)
    };
    let mut sorted: Vec<f64> = variances.iter().map(unbiased).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        odd if odd % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

/// Distance of neighbouring values of the log: a low quantile of the distances that occur, since some levels are
/// never visited and printing rounds. None for fewer than two different values.
fn quantisation_step(values: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = present(values).collect();
    steps.sort_unstable_by(f64::total_cmp);
    // In place: an hour at 1 kHz has millions.
    for index in 1..steps.len() {
        steps[index - 1] = steps[index] - steps[index - 1];
    }
    steps.pop();
    steps.retain(|&step| step > 0.0);
    let low = steps.len() / 10;
    (low < steps.len()).then(|| *steps.select_nth_unstable_by(low, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{quantise, shut_for};
    use crate::noise::Noise;

    fn floor(values: &[f64]) -> Floor {
        noise_floor(values, "bar", Quiet::Hold, &shut_for(values.len(), 0.01))
    }

    fn noisy(seed: u64, sigma: f64, step: f64, course: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut noise = Noise::new(seed);
        (0..3000)
            .map(|row| quantise(course(row as f64 * 0.01) + sigma * noise.normal(), step))
            .collect()
    }

    #[test]
    fn white_noise_gives_its_deviation_within_the_statistical_error() {
        // The median of 60 variances of 48 degrees of freedom scatters by 1.25 / sqrt(2 * 60 * 48) = 1.6 %.
        for seed in 0..20 {
            let floor = floor(&noisy(seed, 4e-3, 0.0, |_| 3.0));
            assert!(
                (floor.sigma / 4e-3 - 1.0).abs() < 4.0 * 0.016,
                "{seed}: {}",
                floor.sigma
            );
        }
    }

    #[test]
    fn a_leaking_chamber_does_not_raise_the_floor() {
        let floor = floor(&noisy(1, 4e-3, 0.0, |t| 6.0 * (-t / 20.0).exp()));
        assert!((floor.sigma / 4e-3 - 1.0).abs() < 0.06, "{}", floor.sigma);
    }

    #[test]
    fn quantisation_adds_its_own_variance() {
        let step = 5.1e-3;
        let expected = f64::hypot(4e-3, step / 12_f64.sqrt());
        let floor = floor(&noisy(2, 4e-3, step, |_| 2.0));
        assert!(
            (floor.sigma / expected - 1.0).abs() < 0.06,
            "{}",
            floor.sigma
        );
        let found = floor.summary.quantisation_step.unwrap();
        assert!((found / step - 1.0).abs() < 1e-6, "{found}");
    }

    #[test]
    fn noise_hidden_in_the_resolution_leaves_the_floor_of_the_resolution() {
        let step = 0.05;
        let values: Vec<f64> = (0..3000)
            .map(|row| quantise(if row < 1500 { 2.0 } else { 2.05 }, step))
            .collect();
        let floor = floor(&values);
        assert!(
            (floor.sigma - step / 12_f64.sqrt()).abs() < 1e-9,
            "{}",
            floor.sigma
        );
        assert!(
            floor.summary.statement.contains("resolution"),
            "{}",
            floor.summary.statement
        );
    }

    #[test]
    fn a_few_disturbed_pieces_do_not_raise_the_floor() {
        let disturbed = |t: f64| if t < 3.0 { 0.1 * (40.0 * t).sin() } else { 0.0 };
        let floor = floor(&noisy(3, 4e-3, 0.0, disturbed));
        assert!((floor.sigma / 4e-3 - 1.0).abs() < 0.1, "{}", floor.sigma);
    }

    #[test]
    fn without_a_hold_the_floor_is_unknown_and_says_what_to_log() {
        let mut commands = shut_for(300, 0.01);
        commands.duty_pct[FILL] = vec![50.0; 300].into();
        let floor = noise_floor(
            &noisy(1, 1.0, 0.0, |_| 0.0)[..300],
            "bar",
            Quiet::Hold,
            &commands,
        );
        assert_eq!(floor.summary.value, None);
        assert_eq!(
            floor.summary.statement,
            "unknown: give 2 s with both valves shut"
        );
    }

    #[test]
    fn three_significant_digits_are_said() {
        assert_eq!(
            [4.367e-3, 0.7123, 12.34, 1234.0].map(significant),
            ["0.00437", "0.712", "12.3", "1234"]
        );
    }

    #[test]
    fn missing_samples_do_not_count() {
        let mut values = noisy(5, 4e-3, 0.0, |_| 1.0);
        values
            .iter_mut()
            .step_by(3)
            .for_each(|value| *value = f64::NAN);
        let floor = floor(&values);
        assert!((floor.sigma / 4e-3 - 1.0).abs() < 0.1, "{}", floor.sigma);
        assert!(floor.summary.samples <= 2000);
    }
}
