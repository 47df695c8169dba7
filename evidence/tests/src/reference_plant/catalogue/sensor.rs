//! Pressure sensor.

use super::Form;
use super::Kinship::{Matched, Variant};

pub(super) const FORMS: &[Form] = &[
    Form::library("sensor_lag", Matched, "one lag", (0.66, "ms"), |p, d| {
        d.sensor.lag_s = 1e-3 * p.size;
    })
    .parameter("time_constant_s", |p| 1e-3 * p.size)
    .same(&["dead_volume"]),
    Form::library("sensor_lag", Variant, "two lags", (0.64, "ms"), |p, d| {
        d.sensor.lag_s = 0.5e-3 * p.size;
        d.sensor.second_lag_s = 0.5e-3 * p.size;
    })
    .same(&["dead_volume"]),
    Form::library(
        "sensor_hysteresis",
        Matched,
        "play",
        (15.0, "mbar"),
        |p, d| d.sensor.play_pa = 100.0 * p.size,
    )
    .parameter("hysteresis_bar", |p| 1e-3 * p.size),
    Form::library(
        "sensor_offset",
        Matched,
        "constant",
        (7.4, "mbar"),
        |p, d| {
            d.sensor.offset_pa = 100.0 * p.size;
        },
    )
    .parameter("offset_bar", |p| 1e-3 * p.size),
    Form::library(
        "sensor_offset",
        Variant,
        "comes while the sensor warms up",
        (5.8, "mbar"),
        |p, d| {
            d.sensor.offset_pa = 60.0 * p.size;
            d.sensor.warm_offset_pa = 100.0 * p.size;
            d.sensor.warm_s = p.between(2.0, 15.0);
        },
    ),
];
