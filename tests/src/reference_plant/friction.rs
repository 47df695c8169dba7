//! Friction of the armature in its tube, in two forms that both stay smooth where the velocity changes its sign, and
//! a seat that sticks the longer the armature has rested.

use super::departures::ArmatureDepartures;

/// Velocity at which friction has its full size (m/s).
const SMOOTHING: f64 = 2e-3;
/// Velocity at which the surplus of the static friction is gone (m/s): Stribeck (1902).
const STRIBECK: f64 = 1e-2;
/// Deflection at which bristles carry most of the friction (m): P. R. Dahl, *A solid friction model*, 1968.
const DEFLECTION: f64 = 5e-6;

/// Lift over which an adhering seat lets go (m), and the time in which it forgets (s).
const LETTING_GO: f64 = 2e-5;
const FORGETTING: f64 = 2e-3;

/// Friction that follows the velocity (N), against the motion.
pub(super) fn of_velocity(armature: &ArmatureDepartures, velocity: f64) -> f64 {
    if armature.coulomb_n == 0.0 {
        return 0.0;
    }
    let slow = velocity / STRIBECK;
    (armature.coulomb_n + armature.breakaway_n * (-slow * slow).exp())
        * (velocity / SMOOTHING).tanh()
}

/// Rate of the bristles' force (N/s).
pub(super) fn bristle_rate(armature: &ArmatureDepartures, force: f64, velocity: f64) -> f64 {
    if armature.bristle_n == 0.0 {
        return 0.0;
    }
    // The rate of decay |v| / DEFLECTION is within what the solver's step takes, whatever the friction.
    (armature.bristle_n - force * velocity.signum()) * velocity / DEFLECTION
}

/// Pull of the seat (N), `adhesion` being the share of it that has come.
pub(super) fn of_seat(armature: &ArmatureDepartures, adhesion: f64, position: f64) -> f64 {
    if armature.adhesion_n == 0.0 {
        return 0.0;
    }
    armature.adhesion_n * adhesion * (-position.max(0.0) / LETTING_GO).exp()
}

/// Rate of that share (1/s).
pub(super) fn adhesion_rate(armature: &ArmatureDepartures, adhesion: f64, position: f64) -> f64 {
    if armature.adhesion_n == 0.0 {
        0.0
    } else if position <= 0.0 {
        (1.0 - adhesion) / armature.adhesion_s
    } else {
        -adhesion / FORGETTING
    }
}
