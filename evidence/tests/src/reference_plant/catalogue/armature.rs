//! Forces on the armature.

use super::Form;
use super::Kinship::{Matched, Variant};

pub(super) const FORMS: &[Form] = &[
    Form::library(
        "static_friction",
        Matched,
        "sliding friction with a surplus at low velocity",
        (0.08, "N"),
        |p, d| {
            d.armature.coulomb_n = p.size;
            d.armature.breakaway_n = p.size * p.between(0.2, 0.8);
        },
    )
    .parameter("friction_n", |p| p.size * (1.0 + p.between(0.2, 0.8))),
    Form::library(
        "static_friction",
        Variant,
        "bristles",
        (0.066, "N"),
        |p, d| d.armature.bristle_n = p.size,
    ),
    Form::library(
        "end_stop_bounce",
        Matched,
        "both stops",
        (0.11, "of the velocity"),
        |p, d| d.armature.restitution = [p.size.min(0.9); 2],
    )
    .parameter("restitution", |p| p.size.min(0.9)),
    Form::library(
        "end_stop_bounce",
        Variant,
        "soft seat, springy upper stop",
        (0.13, "of the velocity"),
        |p, d| {
            let restitution = p.size.min(0.9);
            d.armature.restitution = [0.3 * restitution, restitution];
        },
    ),
    Form::library(
        "flow_force",
        Matched,
        "pressure force falls as lift/(lift + scale)",
        (0.046, "of the pressure force"),
        |p, d| {
            d.armature.pressure_force_loss = p.size.min(1.2);
            d.armature.pressure_force_lift_m = p.between(4e-5, 2e-4);
        },
    ),
    Form::library(
        "flow_force",
        Variant,
        "pressure force falls exponentially",
        (0.041, "of the pressure force"),
        |p, d| {
            d.armature.pressure_force_loss = p.size.min(1.2);
            d.armature.pressure_force_lift_m = -p.between(5e-5, 3e-4);
        },
    ),
];
