//! One step of the Rosenbrock method Rodas3 of order 3(2), for stiff problems: A. Sandu et al., Benchmarking stiff ODE
//! solvers for atmospheric chemistry problems II, Atmospheric Environment 31 (1997) 3459-3472. It is L-stable: a motion
//! much faster than the step reaches its final value within the step.

use super::dormand_prince::Step;

/// γ of the method.
const GAMMA: f64 = 0.5;

/// Steps dy/dt = f(y) from `y`, where `rate` = f(y), over `h`. `increments` are those of the differences of the
/// Jacobian; none is zero.
pub(crate) fn step<const N: usize>(
    f: impl Fn(&[f64; N]) -> [f64; N],
    y: &[f64; N],
    rate: &[f64; N],
    h: f64,
    increments: &[f64; N],
) -> Step<N> {
    let mut matrix = [[0.0; N]; N];
    for column in 0..N {
        let mut moved = *y;
        moved[column] += increments[column];
        let moved_rate = f(&moved);
        for row in 0..N {
            matrix[row][column] = (rate[row] - moved_rate[row]) / increments[column];
        }
        matrix[column][column] += 1.0 / (GAMMA * h);
    }
    let factors = Factors::of(matrix);

    let k1 = factors.solve(*rate);
    let k2 = factors.solve(sum([(1.0, rate), (4.0 / h, &k1)]));
    let third = f(&sum([(1.0, y), (2.0, &k1)]));
    let k3 = factors.solve(sum([(1.0, &third), (1.0 / h, &k1), (-1.0 / h, &k2)]));
    let fourth = f(&sum([(1.0, y), (2.0, &k1), (1.0, &k3)]));
    let k4 = factors.solve(sum([
        (1.0, &fourth),
        (1.0 / h, &k1),
        (-1.0 / h, &k2),
        (-8.0 / (3.0 * h), &k3),
    ]));
    let end = sum([(1.0, y), (2.0, &k1), (1.0, &k3), (1.0, &k4)]);
    let end_rate = f(&end);
    Step {
        end,
        end_rate,
        // The error is not finite if the rates at the end, where the next step begins, are not.
        error: sum([(1.0, &k4), (0.0, &end_rate)]),
    }
}

fn sum<const N: usize, const T: usize>(terms: [(f64, &[f64; N]); T]) -> [f64; N] {
    core::array::from_fn(|n| terms.iter().map(|(weight, term)| weight * term[n]).sum())
}

/// Matrix as the product of a lower and an upper triangle, with exchanged rows.
struct Factors<const N: usize> {
    triangles: [[f64; N]; N],
    /// Row that was exchanged with each row.
    pivots: [usize; N],
}

impl<const N: usize> Factors<N> {
    fn of(mut matrix: [[f64; N]; N]) -> Self {
        let mut pivots = [0; N];
        for column in 0..N {
            let size = |row: &usize| matrix[*row][column].abs();
            let pivot = (column..N)
                .max_by(|a, b| size(a).total_cmp(&size(b)))
                .unwrap_or(column);
            matrix.swap(column, pivot);
            pivots[column] = pivot;
            let (above, below) = matrix.split_at_mut(column + 1);
            let pivot_row = &above[column];
            for row in below {
                row[column] /= pivot_row[column];
                for n in column + 1..N {
                    row[n] -= row[column] * pivot_row[n];
                }
            }
        }
        Self {
            triangles: matrix,
            pivots,
        }
    }

    fn solve(&self, mut right: [f64; N]) -> [f64; N] {
        for row in 0..N {
            right.swap(row, self.pivots[row]);
        }
        for row in 0..N {
            for n in 0..row {
                right[row] -= self.triangles[row][n] * right[n];
            }
        }
        for row in (0..N).rev() {
            for n in row + 1..N {
                right[row] -= self.triangles[row][n] * right[n];
            }
            right[row] /= self.triangles[row][row];
        }
        right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The global error on a pendulum falls with the third power of the step.
    #[test]
    fn order_of_convergence_is_three() {
        let pendulum = |y: &[f64; 2]| [y[1], -y[0].sin()];
        let integrate = |n: u32| {
            let h = 4.0 / f64::from(n);
            let mut y = [1.0, 0.0];
            for _ in 0..n {
                y = step(pendulum, &y, &pendulum(&y), h, &[1e-7; 2]).end;
            }
            y[0]
        };
        let reference = integrate(3200);
        let (coarse, fine) = (integrate(50) - reference, integrate(100) - reference);
        let order = (coarse / fine).abs().log2();
        assert!((2.7..3.4).contains(&order), "{order}");
    }

    /// A motion a million times faster than the step comes to rest in it, together with a slow one that is followed.
    #[test]
    fn what_is_much_faster_than_the_step_ends_in_it() {
        let f = |y: &[f64; 2]| [1e9 * (y[1] - y[0]), -y[1]];
        let y = [5.0, 1.0];
        let end = step(f, &y, &f(&y), 1e-3, &[1e-7; 2]).end;
        assert!((end[1] - f64::exp(-1e-3)).abs() < 1e-10, "{end:?}");
        assert!((end[0] - end[1]).abs() < 1e-4, "{end:?}");
    }

    #[test]
    fn rows_are_exchanged_where_a_pivot_is_zero() {
        let factors = Factors::of([[0.0, 2.0, 1.0], [1.0, 1.0, 0.0], [3.0, 0.0, 1.0]]);
        let found = factors.solve([7.0, 3.0, 6.0]);
        for (found, expected) in found.into_iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
}
