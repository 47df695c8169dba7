//! Chamber: leaks, law of the flow, heat and volumes.

use super::Form;
use super::Kinship::{Matched, Variant};

pub(super) const FORMS: &[Form] = &[
    Form::library("chamber_leak", Matched, "hole", (3.2e-4, "mm²"), |p, d| {
        d.flow.chamber_leak.hole_m2 = 1e-6 * p.size;
    })
    .parameter("area_m2", |p| 1e-6 * p.size),
    Form::library(
        "chamber_leak",
        Variant,
        "laminar gap",
        (0.3, "mg/s at 5 bar"),
        |p, d| {
            d.flow.chamber_leak.gap_kg_per_s_pa2 =
                1e-6 * p.size / (6.01e5_f64.powi(2) - 1.01e5_f64.powi(2));
        },
    ),
    Form::library(
        "chamber_leak",
        Variant,
        "rough gap",
        (0.5, "mg/s at 5 bar"),
        |p, d| {
            let power = p.between(0.55, 0.9);
            d.flow.chamber_leak.rough_kg_per_s = 1e-6 * p.size / 5_f64.powf(power);
            d.flow.chamber_leak.rough_power = power;
        },
    ),
    Form::library(
        "critical_ratio",
        Matched,
        "ISO 6358",
        (0.029, "below that of the nozzle"),
        |p, d| d.flow.critical_ratio_drop = p.size.min(0.5),
    )
    .parameter("reduction", |p| p.size.min(0.5)),
    Form::library(
        "critical_ratio",
        Variant,
        "ISO 6358 with subsonic index",
        (0.023, "below that of the nozzle"),
        |p, d| {
            d.flow.critical_ratio_drop = p.size.min(0.5);
            d.flow.subsonic_index_rise = p.size.min(0.5) * p.between(0.2, 0.6);
        },
    ),
    Form::library(
        "gas_temperature",
        Matched,
        "constant heat transfer to a cold wall",
        (0.32, "ms"),
        |p, d| d.chamber.thermal_s = 1e-3 * p.size,
    )
    .parameter("wall_heat_transfer_w_per_k", |p| {
        p.ambient_heat_capacity() / (1e-3 * p.size)
    }),
    Form::library(
        "gas_temperature",
        Variant,
        "heat transfer grows with the density, wall warms",
        (0.4, "ms"),
        |p, d| {
            d.chamber.thermal_s = 1e-3 * p.size;
            d.chamber.thermal_density_power = 0.5;
            // The smaller the capacity, the more the wall warms; size 0 has no effect.
            d.chamber.wall_j_per_k = p.between(10.0, 50.0) / p.size;
            d.chamber.wall_s = 3.0;
        },
    ),
    Form::library(
        "regulating_valve_volume",
        Matched,
        "plunger on its spring",
        (1.3, "cm³"),
        |p, d| {
            d.chamber.plunger_m3 = 1e-6 * p.size;
            d.chamber.plunger_pa = [1e5, p.between(3e5, 6.5e5)];
            d.chamber.plunger_s = 5e-3;
        },
    ),
    Form::library(
        "regulating_valve_volume",
        Variant,
        "plunger with friction",
        (1.3, "cm³"),
        |p, d| {
            d.chamber.plunger_m3 = 1e-6 * p.size;
            d.chamber.plunger_pa = [1e5, p.between(3e5, 6.5e5)];
            d.chamber.plunger_s = 2e-2;
            d.chamber.plunger_hysteresis = 0.05;
        },
    ),
    Form::library(
        "regulating_valve_volume",
        Variant,
        "hose that follows the pressure slowly",
        (0.056, "% per bar"),
        |p, d| {
            d.chamber.hose_per_pa = 1e-2 * p.size / 1e5;
            d.chamber.hose_s = p.between(0.2, 2.0);
        },
    ),
    Form::library(
        "dead_volume",
        Matched,
        "laminar tube, sensor in the cavity",
        (0.16, "cm³"),
        |p, d| {
            d.chamber.cavity_m3 = 1e-6 * p.size;
            d.chamber.cavity_kg_per_s_pa = p.between(1e-9, 8e-9);
            d.chamber.sensor_in_cavity = true;
        },
    )
    .parameter("cavity_volume_m3", |p| 1e-6 * p.size)
    .same(&["sensor_lag"]),
    Form::library(
        "dead_volume",
        Variant,
        "throttled side chamber, sensor in the chamber",
        (1.5, "cm³"),
        |p, d| {
            d.chamber.cavity_m3 = 1e-6 * p.size;
            d.chamber.cavity_m2 = p.between(3e-8, 2e-7);
        },
    ),
];
