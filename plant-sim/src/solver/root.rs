//! Location of an event within a step.

/// The time in (0, `h`] at which `g` becomes positive, when it is not positive at `lo` and positive at
/// `h`; the returned time is on the positive side. Illinois' variant of the false position method.
pub(crate) fn first_positive(g: impl Fn(f64) -> f64, lo: f64, h: f64) -> f64 {
    let width = 1e-12 * h;
    let (mut below, mut g_below) = (lo, g(lo).min(0.0));
    let (mut above, mut g_above) = (h, g(h));
    let small = 1e-11 * g_above;
    let mut last_side = 0;
    for _ in 0..60 {
        if above - below <= width {
            break;
        }
        let middle = above - g_above * (above - below) / (g_above - g_below);
        let middle = if middle > below && middle < above {
            middle
        } else {
            0.5 * (below + above)
        };
        let value = g(middle);
        if value > 0.0 {
            (above, g_above) = (middle, value);
            if last_side == 1 {
                g_below *= 0.5;
            }
            last_side = 1;
            if value <= small {
                break;
            }
        } else {
            (below, g_below) = (middle, value);
            if last_side == -1 {
                g_above *= 0.5;
            }
            last_side = -1;
        }
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn root_is_located_and_on_the_positive_side() {
        for (g, root) in [
            (&(|t: f64| t * t - 0.25) as &dyn Fn(f64) -> f64, 0.5),
            (&|t: f64| (t - 0.9).powi(3), 0.9),
            (&|t: f64| 1e-9 * (t - 1e-4), 1e-4),
            (&|t: f64| t - 0.3, 0.3),
        ] {
            let time = first_positive(g, 0.0, 1.0);
            assert!(g(time) > 0.0 && (time - root).abs() < 3e-4, "{time} {root}");
        }
        let sharp = first_positive(|t| t.exp() - 1.3, 0.0, 1.0);
        assert!((sharp - 1.3_f64.ln()).abs() < 1e-11);
    }
}
