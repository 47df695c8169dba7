//! Gates of the field benchmarks, of the estimation and of the names, fixed before any scored draw.

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

/// Share of the rigs without hidden effect that get a name, at most.
pub const FALSE_NAME_SHARE_MAX: f64 = 0.01;

/// A hidden effect is asked for if its removal cost is at least this (noise floors of the worst signal), ...
pub const ASKED_COST_MIN_FLOORS: f64 = 1.0;
/// ... and this share of those is named, at least.
pub const NAMED_SHARE_MIN: f64 = 0.90;

/// Share of the rigs with hidden effects that get a name which stands for none of them, at most.
pub const WRONG_NAME_SHARE_MAX: f64 = 0.02;

/// Free-run check error of the plant with the named effects, at most (noise floors of the worst signal; the reference plant leaves one).
/// [`FREE_RUN_SHARE_MIN`] is the share of the rigs.
pub const NAMED_FREE_RUN_MAX_FLOORS: f64 = 1.5;

/// A diagnosis with at most this number of hidden effects ...
pub const FEW_EFFECTS: usize = 2;
/// ... is meant to take this long, at most, ...
pub const FEW_EFFECTS_TIME_MAX: Duration = Duration::from_secs(30);
/// ... and one with more of them this long.
pub const MANY_EFFECTS_TIME_MAX: Duration = Duration::from_secs(120);
