//! Linear least squares by the normal equations.

/// Returns the weights of the columns whose sum is nearest to the target. `pull` regularises each weight towards zero,
/// in units of one squared residual per squared weight: a prior, or a ridge for columns that are nearly dependent.
///
/// # Panics
/// Panics if there are not as many pulls as columns.
pub fn weights<C: AsRef<[f64]>>(columns: &[C], target: &[f64], pull: &[f64]) -> Vec<f64> {
    assert_eq!(columns.len(), pull.len(), "one pull per column");
    let n = columns.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Positive definite: elimination needs no pivots.
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let column = columns[i].as_ref();
            let mut row: Vec<f64> = columns
                .iter()
                .map(|other| dot(column, other.as_ref()))
                .collect();
            row[i] += pull[i];
            row.push(dot(column, target));
            row
        })
        .collect();
    for pivot in 0..n {
        let (done, below) = rows.split_at_mut(pivot + 1);
        for row in below {
            let factor = row[pivot] / done[pivot][pivot];
            for (cell, above) in row[pivot..].iter_mut().zip(&done[pivot][pivot..]) {
                *cell -= factor * above;
            }
        }
    }
    let mut weights = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| rows[i][j] * weights[j]).sum();
        weights[i] = (rows[i][n] - known) / rows[i][i];
    }
    weights
}

/// Returns the root mean square.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    (sum / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_found_again() {
        let columns = [[1.0, 2.0, 3.0, 5.0], [100.0, -100.0, 0.0, 50.0]];
        let target: Vec<f64> = (0..4)
            .map(|n| 2.0 * columns[0][n] - 0.01 * columns[1][n])
            .collect();
        let found = weights(&columns, &target, &[0.0; 2]);
        assert!(
            (found[0] - 2.0).abs() < 1e-12 && (found[1] + 0.01).abs() < 1e-12,
            "{found:?}"
        );
    }

    /// One column of ones, n times 3: the pull adds to n.
    #[test]
    fn a_pull_draws_towards_zero() {
        assert_eq!(weights(&[[1.0; 4]], &[3.0; 4], &[2.0]), [2.0]);
    }
}
