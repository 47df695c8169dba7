//! Regulating valve behind the chamber (section 3.4, equation 3.25): a plunger between air and oil, with a spring,
//! static and dynamic friction and two stops. It is an output stage: its displacement is small compared with the
//! chamber, so it does not act back (section 3.4).
//!
//! Within a step the chamber pressure is linear in time. The plunger is then an oscillator under a ramp, solved exactly
//! from one change of direction, stop or stick to the next.

use crate::parameters::{PA_PER_BAR, RegulatingValveParameters};
use crate::solver::root::first_positive;

/// State of the plunger.
#[derive(Debug, Clone)]
pub struct RegulatingValve {
    parameters: RegulatingValveParameters,
    /// Position (m), 0 at the air-side stop.
    x: f64,
    /// Velocity (m/s).
    v: f64,
}

/// Motion in one direction: x(t) = offset + ramp t + a cos ωt + b sin ωt.
struct Slide {
    omega: f64,
    offset: f64,
    ramp: f64,
    a: f64,
    b: f64,
}

impl Slide {
    fn position(&self, t: f64) -> f64 {
        let (sin, cos) = (self.omega * t).sin_cos();
        self.offset + self.ramp * t + self.a * cos + self.b * sin
    }

    fn velocity(&self, t: f64) -> f64 {
        let (sin, cos) = (self.omega * t).sin_cos();
        self.ramp + self.omega * (self.b * cos - self.a * sin)
    }

    /// Returns the first time after 0 at which the velocity is zero; infinite if there is none.
    fn reversal(&self) -> f64 {
        // ramp + c cos(ωt + φ) = 0 with c cos φ = ω b and c sin φ = ω a.
        let amplitude = self.omega * self.a.hypot(self.b);
        if amplitude <= self.ramp.abs() {
            return f64::INFINITY;
        }
        let phase = self.a.atan2(self.b);
        let angle = (-self.ramp / amplitude).acos();
        let full_turn = core::f64::consts::TAU;
        let after_start = |angle: f64| {
            let turned = (angle - phase).rem_euclid(full_turn);
            // A slide often begins with zero velocity: that instant does not count.
            if turned < 1e-9 {
                turned + full_turn
            } else {
                turned
            }
        };
        after_start(angle).min(after_start(-angle)) / self.omega
    }
}

impl RegulatingValve {
    /// Creates a plunger at rest at its air-side stop.
    pub fn new(parameters: RegulatingValveParameters) -> Self {
        Self {
            parameters,
            x: 0.0,
            v: 0.0,
        }
    }

    /// Returns the position of the plunger (m).
    pub fn position(&self) -> f64 {
        self.x
    }

    /// Returns the velocity of the plunger (m/s).
    pub fn velocity(&self) -> f64 {
        self.v
    }

    /// Returns the force on the plunger without friction (N) at chamber gauge pressure `pressure` (Pa).
    fn force(&self, pressure: f64, x: f64) -> f64 {
        let p = &self.parameters;
        pressure * p.air_area_m2
            - p.oil_pressure_bar_gauge * PA_PER_BAR * p.oil_area_m2
            - p.preload_n
            - p.spring_n_per_m * x
    }

    /// Advances by `duration` (s) while the chamber's gauge pressure goes from `start` to `end` (Pa).
    pub fn advance(&mut self, duration: f64, start: f64, end: f64) {
        let pressure_rate = (end - start) / duration;
        let force_rate = pressure_rate * self.parameters.air_area_m2;
        let mut t = 0.0;
        while t < duration {
            let force = self.force(start + pressure_rate * t, self.x);
            let remaining = duration - t;
            t += if self.v == 0.0 && self.is_held(force) {
                self.time_to_break_free(force, force_rate).min(remaining)
            } else {
                self.slide(force, force_rate, remaining)
            };
        }
    }

    /// Returns whether friction or a stop keeps the resting plunger in place against `force`.
    fn is_held(&self, force: f64) -> bool {
        let p = &self.parameters;
        force.abs() <= p.static_friction_n
            || (force < 0.0 && self.x <= 0.0)
            || (force > 0.0 && self.x >= p.stroke_m)
    }

    fn time_to_break_free(&self, force: f64, force_rate: f64) -> f64 {
        let p = &self.parameters;
        let direction = force_rate.signum();
        let against_stop =
            (direction < 0.0 && self.x <= 0.0) || (direction > 0.0 && self.x >= p.stroke_m);
        if force_rate == 0.0 || against_stop {
            return f64::INFINITY;
        }
        // A nanosecond beyond the limit, so that the plunger is free there.
        (direction * p.static_friction_n - force) / force_rate + 1e-9
    }

    /// Slides in one direction until it reverses, meets a stop, or `limit` (s) is over.
    fn slide(&mut self, force: f64, force_rate: f64, limit: f64) -> f64 {
        let p = &self.parameters;
        let direction = if self.v == 0.0 {
            force.signum()
        } else {
            self.v.signum()
        };
        let stiffness = p.spring_n_per_m;
        let omega = (stiffness / p.plunger_mass_kg).sqrt();
        let ramp = force_rate / stiffness;
        let offset = self.x + (force - direction * p.dynamic_friction_n) / stiffness;
        let slide = Slide {
            omega,
            offset,
            ramp,
            a: self.x - offset,
            b: (self.v - ramp) / omega,
        };
        let reversal = slide.reversal();
        let taken = reversal.min(limit);
        let stop = if direction > 0.0 { p.stroke_m } else { 0.0 };
        let beyond = |t: f64| direction * (slide.position(t) - stop);
        if beyond(taken) > 0.0 {
            let arrival = first_positive(beyond, 0.0, taken);
            (self.x, self.v) = (stop, 0.0);
            return arrival;
        }
        self.x = slide.position(taken);
        self.v = if taken == reversal {
            0.0
        } else {
            slide.velocity(taken)
        };
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters() -> RegulatingValveParameters {
        RegulatingValveParameters {
            plunger_mass_kg: 0.15,
            air_area_m2: 1.4e-3,
            oil_area_m2: 0.0,
            oil_pressure_bar_gauge: 0.0,
            spring_n_per_m: 42e3,
            preload_n: 200.0,
            static_friction_n: 12.0,
            dynamic_friction_n: 8.0,
            stroke_m: 15e-3,
        }
    }

    /// Pressure steps of one pascal, compared with a fine fixed-step simulation of equation 3.25.
    #[test]
    fn exact_solution_agrees_with_a_fine_simulation() {
        let mut valve = RegulatingValve::new(parameters());
        let p = parameters();
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let pressure = |t: f64| 3e5 * (1.0 - (-t / 0.05).exp()) + 0.5e5 * (40.0 * t).sin().max(0.0);
        let sub = 20_000;
        for sample in 0..60 {
            let (t0, t1) = (f64::from(sample) * 0.01, f64::from(sample + 1) * 0.01);
            let (p0, p1) = (pressure(t0), pressure(t1));
            valve.advance(0.01, p0, p1);
            let h = 0.01 / f64::from(sub);
            for k in 0..sub {
                let at = p0 + (p1 - p0) * (f64::from(k) + 0.5) / f64::from(sub);
                let force = at * p.air_area_m2 - p.preload_n - p.spring_n_per_m * x;
                if v == 0.0 && (force.abs() <= p.static_friction_n || (force < 0.0 && x <= 0.0)) {
                    continue;
                }
                let direction = if v == 0.0 { force.signum() } else { v.signum() };
                let new_v = v + h * (force - direction * p.dynamic_friction_n) / p.plunger_mass_kg;
                v = if new_v * direction <= 0.0 { 0.0 } else { new_v };
                x += h * v;
                if x <= 0.0 || x >= p.stroke_m {
                    (x, v) = (x.clamp(0.0, p.stroke_m), 0.0);
                }
            }
            assert!(
                (valve.position() - x).abs() < 2e-6,
                "{sample}: {} {x}",
                valve.position()
            );
        }
        assert!(x > 1e-3, "the plunger moved: {x}");
    }

    #[test]
    fn static_friction_holds_within_its_band() {
        let mut valve = RegulatingValve::new(parameters());
        let hold = (200.0 + 11.9) / 1.4e-3;
        valve.advance(1.0, 0.0, hold);
        assert_eq!(valve.position(), 0.0);
        valve.advance(1.0, hold, (200.0 + 14.0) / 1.4e-3);
        assert!(valve.position() > 0.0);
    }

    #[test]
    fn the_stroke_ends_at_the_stop() {
        let mut valve = RegulatingValve::new(parameters());
        valve.advance(0.5, 0.0, 8.4e5);
        assert_eq!((valve.position(), valve.velocity()), (15e-3, 0.0));
        valve.advance(0.5, 8.4e5, 0.0);
        assert_eq!((valve.position(), valve.velocity()), (0.0, 0.0));
    }
}
