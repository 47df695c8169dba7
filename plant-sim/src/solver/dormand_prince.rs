//! One step of the embedded Runge-Kutta pair of order 5(4) by Dormand and Prince, J. Comp. Appl. Math.
//! 6 (1980) 19-26, table 2.

/// Result of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<const N: usize> {
    /// State at the end, of order five.
    pub(crate) end: [f64; N],
    /// Derivative at the end; the first stage of the next step.
    pub(crate) end_rate: [f64; N],
    /// Difference between the two orders.
    pub(crate) error: [f64; N],
}

/// Step, and its last stage before the end: state and derivative. The two states are of the same time, so the
/// difference of their derivatives shows how stiff the problem is (Hairer and Wanner II, section IV.2).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Staged<const N: usize> {
    pub(crate) step: Step<N>,
    pub(crate) last_stage: [[f64; N]; 2],
}

/// Returns y + h Σ a_j k_j.
#[inline(always)]
fn stage<const N: usize, const S: usize>(
    y: &[f64; N],
    h: f64,
    weights: [f64; S],
    rates: [&[f64; N]; S],
) -> [f64; N] {
    // The outer loop is over the stages and the inner one over the states: two states share an instruction.
    let mut sum = *y;
    for (weight, rate) in weights.into_iter().zip(rates) {
        let weight = h * weight;
        for n in 0..N {
            sum[n] += weight * rate[n];
        }
    }
    sum
}

/// Steps dy/dt = f(y) from `y`, where `k1` = f(y), over `h`.
#[inline(always)]
pub(crate) fn step<const N: usize>(
    f: impl Fn(&[f64; N]) -> [f64; N],
    y: &[f64; N],
    k1: &[f64; N],
    h: f64,
) -> Staged<N> {
    let k2 = f(&stage(y, h, [1.0 / 5.0], [k1]));
    let k3 = f(&stage(y, h, [3.0 / 40.0, 9.0 / 40.0], [k1, &k2]));
    let k4 = f(&stage(
        y,
        h,
        [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        [k1, &k2, &k3],
    ));
    let k5 = f(&stage(
        y,
        h,
        [
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        [k1, &k2, &k3, &k4],
    ));
    let sixth = stage(
        y,
        h,
        [
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
        [k1, &k2, &k3, &k4, &k5],
    );
    let k6 = f(&sixth);
    let end = stage(
        y,
        h,
        [
            35.0 / 384.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
        [k1, &k3, &k4, &k5, &k6],
    );
    let end_rate = f(&end);
    let error = stage(
        &[0.0; N],
        h,
        [
            71.0 / 57600.0,
            -71.0 / 16695.0,
            71.0 / 1920.0,
            -17253.0 / 339_200.0,
            22.0 / 525.0,
            -1.0 / 40.0,
        ],
        [k1, &k3, &k4, &k5, &k6, &end_rate],
    );
    Staged {
        step: Step {
            end,
            end_rate,
            error,
        },
        last_stage: [sixth, k6],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The global error on a pendulum falls with the fifth power of the step.
    #[test]
    fn order_of_convergence_is_five() {
        let pendulum = |y: &[f64; 2]| [y[1], -y[0].sin()];
        let integrate = |n: u32| {
            let h = 4.0 / f64::from(n);
            let mut y = [1.0, 0.0];
            for _ in 0..n {
                y = step(pendulum, &y, &pendulum(&y), h).step.end;
            }
            y[0]
        };
        let reference = integrate(6400);
        let (coarse, fine) = (integrate(50) - reference, integrate(100) - reference);
        let order = (coarse / fine).abs().log2();
        assert!((4.8..5.6).contains(&order), "{order}");
    }

    /// For a linear decay, the difference of the last two derivatives divided by that of the states is its rate.
    #[test]
    fn the_last_stage_shows_the_stiffness() {
        let decay = |y: &[f64; 1]| [-40.0 * y[0]];
        let Staged { step, last_stage } = step(decay, &[1.0], &[-40.0], 0.05);
        let [y, rate] = last_stage.map(|stage| stage[0]);
        let found = (step.end_rate[0] - rate) / (step.end[0] - y);
        assert!((found + 40.0).abs() < 1e-9, "{found}");
    }

    #[test]
    fn error_estimate_bounds_the_true_error_of_a_small_step() {
        let decay = |y: &[f64; 1]| [-y[0]];
        let step = step(decay, &[1.0], &[-1.0], 0.3).step;
        let truth = (step.end[0] - f64::exp(-0.3)).abs();
        assert!(truth < step.error[0].abs(), "{truth} {:?}", step.error);
    }
}
