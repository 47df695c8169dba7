//! Coils and their drivers.

use super::Form;
use super::Kinship::{Matched, Variant};

pub(super) const FORMS: &[Form] = &[
    Form::library(
        "coil_heating",
        Matched,
        "winding as one body",
        (5.0, "K/W"),
        |p, d| {
            d.coil.winding_k_per_w = p.size;
            d.coil.winding_s = p.between(20.0, 120.0);
        },
    )
    .parameter("heat_capacity_j_per_k", |p| p.between(20.0, 120.0) / p.size),
    Form::library(
        "coil_heating",
        Variant,
        "winding and body",
        (3.0, "K/W"),
        |p, d| {
            d.coil.winding_k_per_w = 0.4 * p.size;
            d.coil.winding_s = p.between(3.0, 10.0);
            d.coil.body_k_per_w = 0.6 * p.size;
            d.coil.body_s = p.between(60.0, 200.0);
        },
    ),
    Form::library(
        "coil_ambient_temperature",
        Matched,
        "both coils in warm surroundings",
        (12.0, "K"),
        |p, d| d.coil.surroundings_k = [p.size; 2],
    )
    .parameter("difference_k", |p| p.size)
    .same(&["supply_resistance"]),
    Form::library(
        "coil_ambient_temperature",
        Variant,
        "surroundings warm up",
        (10.0, "K"),
        |p, d| {
            d.coil.surroundings_k = [0.5 * p.size; 2];
            d.coil.surroundings_in_the_end_k = p.size;
            d.coil.surroundings_s = p.between(10.0, 60.0);
        },
    )
    .same(&["coil_heating"]),
    Form::library(
        "iron_saturation",
        Matched,
        "inductance of the datasheet is that at rated current",
        (0.012, "of the inductance"),
        |p, d| {
            d.coil.saturation = p.size;
            d.coil.saturation_power = if p.shape < 0.5 { 2 } else { 4 };
        },
    ),
    Form::library(
        "iron_saturation",
        Variant,
        "inductance of the datasheet is that without current, sharp knee",
        (0.028, "of the current at rated flux"),
        |p, d| {
            d.coil.knee = p.size;
            d.coil.knee_power = if p.shape < 0.5 { 6 } else { 8 };
        },
    ),
    Form::library(
        "eddy_currents",
        Matched,
        "shorted turn",
        (1.0, "mS"),
        |p, d| d.coil.eddy_s = 1e-3 * p.size,
    )
    .parameter("loop_resistance_ohm", |p| 1e3 / p.size),
    Form::library(
        "eddy_currents",
        Variant,
        "shorted turn with stray inductance",
        (1.0, "mS"),
        |p, d| {
            d.coil.eddy_s = 1e-3 * p.size;
            d.coil.eddy_lag_s = p.between(3e-4, 1.5e-3);
        },
    ),
    Form::library(
        "flyback_clamp",
        Matched,
        "constant voltage",
        (0.42, "V"),
        |p, d| d.driver.clamp_v = p.size,
    )
    .parameter("extra_drop_v", |p| p.size),
    Form::library(
        "flyback_clamp",
        Variant,
        "resistor in the freewheeling path",
        (3.2, "ohm"),
        |p, d| d.driver.snubber_ohm = p.size,
    )
    .parameter("resistance_ohm", |p| p.size),
    Form::library(
        "supply_resistance",
        Matched,
        "wire that both coils share",
        (3.4, "ohm"),
        |p, d| d.driver.harness_ohm = p.size,
    )
    .parameter("resistance_ohm", |p| p.size),
    Form::library(
        "supply_resistance",
        Variant,
        "wire and polarisation of the battery",
        (2.0, "ohm"),
        |p, d| {
            d.driver.harness_ohm = 0.5 * p.size;
            d.driver.polarisation_ohm = 0.5 * p.size;
            d.driver.polarisation_s = p.between(0.05, 1.0);
        },
    ),
];
