//! Gates of the field benchmarks of estimation and diagnosis, fixed before any scored draw.

use std::time::Duration;

/// Largest check error of a refined plant (noise floors of the worst signal).
pub const CHECK_ERROR_MAX_FLOORS: f64 = 1.1;
/// Time within which the check error has to be reached.
pub const TIME_MAX: Duration = Duration::from_secs(90);
/// Smallest share of the rigs that reach the check error in time.
pub const CHECK_ERROR_SHARE_MIN: f64 = 0.95;

/// Largest free-run check error of a refined plant relative to that of the true parameters.
pub const FREE_RUN_MAX_OVER_TRUTH: f64 = 1.2;
/// Smallest share of the rigs within this free-run error.
pub const FREE_RUN_SHARE_MIN: f64 = 0.95;

/// Smallest share of the determined parameters whose 95 % interval contains the true value.
pub const COVERAGE_MIN: f64 = 0.93;

/// Distance from the true value, in half widths of the interval, beyond which a determined parameter counts as far off.
pub const FAR_OFF_HALF_WIDTHS: f64 = 2.0;
/// Largest share of the determined parameters that are far off.
pub const FAR_OFF_SHARE_MAX: f64 = 0.03;

/// Largest share of the rigs without hidden effect that get a name.
pub const FALSE_NAME_SHARE_MAX: f64 = 0.01;

/// Minimum removal cost of a hidden effect that has to be named (noise floors of the worst signal).
pub const ASKED_COST_MIN_FLOORS: f64 = 1.0;
/// Smallest share of these effects that are named.
pub const NAMED_SHARE_MIN: f64 = 0.90;

/// Largest share of the rigs with hidden effects that get a name that stands for none of them.
pub const WRONG_NAME_SHARE_MAX: f64 = 0.02;

/// Largest free-run check error of the plant with the named effects (noise floors of the worst signal; the reference
/// plant has one). [`FREE_RUN_SHARE_MIN`] is the share of the rigs.
pub const NAMED_FREE_RUN_MAX_FLOORS: f64 = 1.5;

/// Largest number of hidden effects of a diagnosis with the short time limit.
pub const FEW_EFFECTS: usize = 2;
/// Time limit of a diagnosis with few hidden effects.
pub const FEW_EFFECTS_TIME_MAX: Duration = Duration::from_secs(30);
/// Time limit of a diagnosis with more hidden effects.
pub const MANY_EFFECTS_TIME_MAX: Duration = Duration::from_secs(120);
