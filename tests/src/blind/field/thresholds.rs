//! Gates of the field benchmark, fixed before any scored draw.

use std::time::Duration;

/// Check error of a refined plant, at most (noise floors of the worst signal), ...
pub const CHECK_ERROR_MAX_FLOORS: f64 = 1.1;
/// ... reached within this time, ...
pub const TIME_MAX: Duration = Duration::from_secs(90);
/// ... on this share of the rigs at least.
pub const CHECK_ERROR_SHARE_MIN: f64 = 0.95;

/// Free-run check error of a refined plant over that of the true parameters, at most, ...
pub const FREE_RUN_MAX_OVER_TRUTH: f64 = 1.2;
/// ... on this share of the rigs at least.
pub const FREE_RUN_SHARE_MIN: f64 = 0.95;

/// Share of the determined parameters whose 95 % interval contains the true value, at least.
pub const COVERAGE_MIN: f64 = 0.93;

/// A determined parameter is far off if it is further from the true value than this many half widths of its interval, ...
pub const FAR_OFF_HALF_WIDTHS: f64 = 2.0;
/// ... on this share of the determined parameters at most.
pub const FAR_OFF_SHARE_MAX: f64 = 0.03;
