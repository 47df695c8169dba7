//! Location of an event within a step.

/// Returns the time in (`lo`, `h`] at which `g` passes zero upwards, if it is not positive at `lo` and positive at `h`.
/// It uses Illinois' variant of the false position method, until the interval is 1e-12 of `h` or the value 1e-11 of
/// that at `h`.
pub(crate) fn first_positive(g: impl Fn(f64) -> f64, lo: f64, h: f64) -> f64 {
    let (mut below, mut g_below) = (lo, g(lo).min(0.0));
    let (mut above, mut g_above) = (h, g(h));
    let narrow = 1e-12 * h;
    let small = 1e-11 * g_above;
    // The end moved by the last iteration: an end that is fixed twice counts half.
    let mut moved_above = None;
    for _ in 0..60 {
        let secant = above - g_above * (above - below) / (g_above - g_below);
        let middle = if secant > below && secant < above {
            secant
        } else {
            0.5 * (below + above)
        };
        let value = g(middle);
        if value.abs() <= small || above - below <= narrow {
            return middle;
        }
        if value > 0.0 {
            (above, g_above) = (middle, value);
            if moved_above == Some(true) {
                g_below *= 0.5;
            }
        } else {
            (below, g_below) = (middle, value);
            if moved_above == Some(false) {
                g_above *= 0.5;
            }
        }
        moved_above = Some(value > 0.0);
    }
    above
}

/// Largest number of steps of [`increasing_root`].
const NEWTON_STEPS: usize = 60;
/// Largest last Newton step, as a share of the distance from the nearer end; the remaining error is about its square.
const LAST_STEP: f64 = 1e-5;

/// Returns the root between `low` and `high` of a function that increases from a negative to a positive value there.
/// `g` gives value and slope. Newton's method from `start`, with bisection where it leaves the bracket.
#[inline]
pub(crate) fn increasing_root(
    g: impl Fn(f64) -> [f64; 2],
    [low, high]: [f64; 2],
    start: f64,
) -> f64 {
    let (mut below, mut above) = (low, high);
    let mut x = start;
    for _ in 0..NEWTON_STEPS {
        let [value, slope] = g(x);
        if value > 0.0 {
            above = x;
        } else {
            below = x;
        }
        let next = x - value / slope;
        let close = LAST_STEP * (x - low).min(high - x) + f64::EPSILON * high;
        if (next - x).abs() <= close {
            return next;
        }
        x = if next > below && next < above {
            next
        } else {
            0.5 * (below + above)
        };
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn roots_are_located_in_few_evaluations() {
        for (g, root) in [
            (&(|t: f64| t * t - 0.25) as &dyn Fn(f64) -> f64, 0.5),
            (&|t: f64| t.exp() - 1.3, 1.3_f64.ln()),
            (&|t: f64| 1e-9 * (t - 1e-4), 1e-4),
            (&|t: f64| t - 0.5, 0.5),
            (&|t: f64| 1.0 - (-(t - 0.2) / 0.05).exp(), 0.2),
        ] {
            let evaluations = Cell::new(0);
            let counted = |t: f64| {
                evaluations.set(evaluations.get() + 1);
                g(t)
            };
            let time = first_positive(counted, 0.0, 1.0);
            assert!((time - root).abs() < 1e-10, "{time} {root}");
            assert!(evaluations.get() < 30, "{} for {root}", evaluations.get());
        }
    }

    /// A root of third order is flat: the value is small long before the time is accurate.
    #[test]
    fn a_flat_root_is_found_to_the_precision_of_its_value() {
        let time = first_positive(|t| (t - 0.9_f64).powi(3), 0.0, 1.0);
        assert!((time - 0.9).abs() < 1e-3, "{time}");
    }

    #[test]
    fn a_root_is_found_where_the_slope_misleads() {
        let cube = |x: f64| [(x - 0.3).powi(3), 3.0 * (x - 0.3).powi(2)];
        let kink = |x: f64| match x < 0.7 {
            true => [1e-3 * (x - 0.7), 1e-3],
            false => [50.0 * (x - 0.7), 50.0],
        };
        let flat = |x: f64| [x.tanh() - 1e-6, 1.0 - x.tanh().powi(2)];
        assert!((increasing_root(cube, [0.0, 1.0], 0.9) - 0.3).abs() < 1e-5);
        assert!((increasing_root(kink, [0.0, 1.0], 0.99) - 0.7).abs() < 1e-12);
        assert!((increasing_root(flat, [0.0, 30.0], 25.0) - 1e-6).abs() < 1e-15);
    }
}
