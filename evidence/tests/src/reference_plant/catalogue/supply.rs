//! Lines upstream of the fill valve and downstream of the vent valve.

use super::Form;
use super::Kinship::{Matched, Variant};

/// Conversion of bar s/g into Pa s/kg.
const PA_S_PER_KG: f64 = 1e5 / 1e-3;

pub(super) const FORMS: &[Form] = &[
    Form::library(
        "supply_line_droop",
        Matched,
        "restriction, then the volume of the line",
        (0.36, "fill bore over restriction"),
        |p, d| {
            d.supply.line_m2 = p.fill_bore() / p.size;
            d.supply.line_m3 = p.between(2e-5, 2e-4);
        },
    )
    .parameter("restriction_area_m2", |p| p.fill_bore() / p.size),
    Form::library(
        "supply_line_droop",
        Variant,
        "regulator that gives way to the flow",
        (0.02, "bar at 1 g/s"),
        |p, d| {
            d.supply.regulator_pa_s_per_kg = p.size * PA_S_PER_KG;
            d.supply.regulator_s = p.between(5e-3, 0.1);
        },
    ),
    Form::library(
        "series_restriction",
        Matched,
        "orifice in the inlet, areas in a row",
        (0.5, "fill bore over orifice"),
        |p, d| d.supply.inlet_m2 = p.fill_bore() / p.size,
    )
    .parameter("fill_area_ratio", |p| p.size)
    .same(&["supply_line_droop"]),
    Form::library(
        "series_restriction",
        Variant,
        "orifice in the inlet and the port behind it",
        (0.42, "fill bore over orifice"),
        |p, d| {
            d.supply.inlet_m2 = p.fill_bore() / p.size;
            d.supply.inlet_m3 = p.between(3e-7, 1.5e-6);
        },
    )
    .same(&["supply_line_droop"]),
    Form::library(
        "drain_back_pressure",
        Matched,
        "constant",
        (8.2, "mbar"),
        |p, d| d.supply.drain_pa = 100.0 * p.size,
    )
    .parameter("pressure_bar", |p| 1e-3 * p.size),
    Form::library(
        "drain_back_pressure",
        Variant,
        "silencer",
        (0.063, "bar at 1 g/s"),
        |p, d| {
            d.supply.drain_pa_s_per_kg = p.size * PA_S_PER_KG;
            d.supply.drain_s = p.between(2e-3, 2e-2);
        },
    )
    .same(&["series_restriction"]),
    Form::library(
        "supply_seat_leak",
        Matched,
        "hole",
        (6.7e-4, "mm²"),
        |p, d| d.flow.seat_leak.hole_m2 = 1e-6 * p.size,
    )
    .parameter("area_m2", |p| 1e-6 * p.size),
    Form::library(
        "supply_seat_leak",
        Variant,
        "laminar gap",
        (1.7, "mg/s at 8.4 bar"),
        |p, d| {
            d.flow.seat_leak.gap_kg_per_s_pa2 =
                1e-6 * p.size / (9.41e5_f64.powi(2) - 1.01e5_f64.powi(2));
        },
    ),
];
