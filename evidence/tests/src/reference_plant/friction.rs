//! Friction of the armature in its tube, in two forms that are smooth when the velocity changes its sign, and adhesion
//! of the seat that grows with the time at rest.

use super::departures::ArmatureDepartures;

/// Velocity at which friction reaches its full value (m/s).
const SMOOTHING: f64 = 2e-3;
/// Velocity at which the excess of the static friction has disappeared (m/s): Stribeck (1902).
const STRIBECK: f64 = 1e-2;
/// Deflection at which bristles carry most of the friction (m): P. R. Dahl, *A solid friction model*, 1968.
const DEFLECTION: f64 = 5e-6;

/// Lift over which an adhering seat releases (m), and time constant of the loss of adhesion (s).
const LETTING_GO: f64 = 2e-5;
const FORGETTING: f64 = 2e-3;

/// Returns the friction that follows the velocity (N), against the motion.
pub(super) fn of_velocity(armature: &ArmatureDepartures, velocity: f64) -> f64 {
    if armature.coulomb_n == 0.0 {
        return 0.0;
    }
    let slow = velocity / STRIBECK;
    (armature.coulomb_n + armature.breakaway_n * (-slow * slow).exp())
        * (velocity / SMOOTHING).tanh()
}

/// Returns the rate of the bristles' force (N/s).
pub(super) fn bristle_rate(armature: &ArmatureDepartures, force: f64, velocity: f64) -> f64 {
    if armature.bristle_n == 0.0 {
        return 0.0;
    }
    // The rate of decay |v| / DEFLECTION is within the limits of the solver's step for any friction.
    (armature.bristle_n - force * velocity.signum()) * velocity / DEFLECTION
}

/// Returns the adhesion force of the seat (N); `adhesion` is the share that has built up.
pub(super) fn of_seat(armature: &ArmatureDepartures, adhesion: f64, position: f64) -> f64 {
    if armature.adhesion_n == 0.0 {
        return 0.0;
    }
    armature.adhesion_n * adhesion * (-position.max(0.0) / LETTING_GO).exp()
}

/// Returns the rate of that share (1/s).
pub(super) fn adhesion_rate(armature: &ArmatureDepartures, adhesion: f64, position: f64) -> f64 {
    if armature.adhesion_n == 0.0 {
        0.0
    } else if position <= 0.0 {
        (1.0 - adhesion) / armature.adhesion_s
    } else {
        -adhesion / FORGETTING
    }
}
