//! End stops as stiff springs with dampers (K. L. Johnson, *Contact Mechanics*, 1985, chapter 11, simplified to a
//! linear spring): the damper rises over the first micrometre, and a stop never pulls.

/// Stiffness of a stop (N/m): spring and pressure press the armature a few micrometres into it.
const STIFFNESS: f64 = 1e6;
/// Depth over which the damper rises (m).
const ONSET: f64 = 1e-6;
/// Damping ratio of a stop with at most 1 % of the velocity after the impact. At 1.2 it would be 10 %, a bounce that a
/// refitted thesis model misses by 2.6 times the pressure noise.
const DEAD_DAMPING_RATIO: f64 = 5.0;

/// Stops of one armature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stops {
    stroke: f64,
    /// Dampers (N s/m): rest stop, full stroke.
    damper: [f64; 2],
}

impl Stops {
    /// Creates stops `stroke` (m) apart for a mass (kg), which keeps these shares of its velocity.
    pub(super) fn new(stroke: f64, mass: f64, restitution: [f64; 2]) -> Self {
        let critical = 2.0 * (STIFFNESS * mass).sqrt();
        Self {
            stroke,
            damper: restitution.map(|share| critical * damping_ratio(share)),
        }
    }

    /// Returns the depth to which a load (N) presses an armature on its spring (N/m) into the rest stop (m).
    pub(super) fn depth(load: f64, spring: f64) -> f64 {
        load / (STIFFNESS + spring)
    }

    /// Returns the force on the armature in the direction of its position (N).
    pub(super) fn force(&self, position: f64, velocity: f64) -> f64 {
        if position < 0.0 {
            push(-position, -velocity, self.damper[0])
        } else if position > self.stroke {
            -push(position - self.stroke, velocity, self.damper[1])
        } else {
            0.0
        }
    }
}

fn push(depth: f64, deepening: f64, damper: f64) -> f64 {
    (STIFFNESS * depth + damper * deepening * (depth / ONSET).min(1.0)).max(0.0)
}

/// Returns the damping ratio of a stop that never pulls and keeps this share of the velocity (found by bisection).
fn damping_ratio(restitution: f64) -> f64 {
    let (mut low, mut high) = (0.0, DEAD_DAMPING_RATIO);
    if restitution <= share_left(high) {
        return DEAD_DAMPING_RATIO;
    }
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if share_left(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Returns the share of the velocity at the end of the contact, when spring and damper together no longer push (T.
/// Schwager and T. Pöschel, *Granular Matter* 9, 2007, 465: this is before the linear oscillation returns).
fn share_left(damping_ratio: f64) -> f64 {
    let root = (damping_ratio * damping_ratio - 1.0).abs().sqrt();
    if root == 0.0 {
        // Limit of either branch below.
        return (-2.0_f64).exp();
    }
    if damping_ratio > 1.0 {
        // Two decays, with rates ω/r and ω r: the acceleration is zero after 4 ln r / (ω (r - 1/r)).
        let r = damping_ratio + root;
        return r.powf(-2.0 - 4.0 / (r * r - 1.0));
    }
    let ends_before = (2.0 * damping_ratio * root).atan2(1.0 - 2.0 * damping_ratio * damping_ratio);
    (-damping_ratio / root * (std::f64::consts::PI - ends_before)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASS: f64 = 5e-3;

    /// Returns the velocity after an armature hit a stop with `before`, in semi-implicit steps of 0.1 µs.
    fn velocity_after(stops: &Stops, mut position: f64, before: f64) -> f64 {
        let (mut velocity, step) = (before, 1e-7);
        position += velocity * step;
        while !(0.0..=stops.stroke).contains(&position) {
            velocity += step * stops.force(position, velocity) / MASS;
            position += step * velocity;
        }
        velocity
    }

    #[test]
    fn a_stop_leaves_the_share_of_the_velocity_that_was_asked_for() {
        for share in [0.0, 0.03, 0.1, 0.3, 0.5] {
            let stops = Stops::new(5e-4, MASS, [share; 2]);
            for (at, before) in [(0.0, -0.4), (5e-4, 0.4)] {
                let after = velocity_after(&stops, at, before);
                // A stop that never pulls ends the contact slightly earlier than the linear oscillation.
                assert!(
                    (-after / before - share).abs() < 0.06,
                    "{share}: {before} m/s became {after} m/s"
                );
            }
        }
    }

    #[test]
    fn a_stop_pushes_and_never_pulls() {
        let stops = Stops::new(5e-4, MASS, [0.0; 2]);
        assert!(stops.force(-1e-6, 0.0) > 0.0 && stops.force(5.01e-4, 0.0) < 0.0);
        assert_eq!(stops.force(-1e-6, 10.0), 0.0, "lifting off fast");
        assert_eq!(stops.force(2.5e-4, -1.0), 0.0, "between the stops");
    }
}
