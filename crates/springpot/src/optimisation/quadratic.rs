//! Convex quadratic problems: min over d of ½ dᵀB d + gᵀd where C d ≤ b, each row at a price.

/// A row of C, its b, and the largest price that is paid for keeping it: above it the row is broken.
#[derive(Debug, Clone)]
pub struct Row {
    /// Its coefficients.
    pub of: Vec<f64>,
    /// Its limit.
    pub limit: f64,
    /// The largest multiplier; infinite where the row must hold.
    pub price: f64,
}

/// Sweeps over the multipliers at most.
const MAX_SWEEPS: usize = 20_000;

/// Changes of multipliers below this share of their size end it.
const SMALL: f64 = 1e-14;

/// d and the multipliers of the rows, where B, of n rows, is positive definite; `None` where it is not.
///
/// The dual, min ½ λᵀG λ + hᵀλ with G = C B⁻¹Cᵀ and h = C B⁻¹g + b over 0 ≤ λ ≤ price, is gone through row by row (C. Hildreth, Naval Res. Logist. Quart. 4
/// (1957) 79–85).
pub fn solve(b: &[f64], g: &[f64], rows: &[Row]) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, count) = (g.len(), rows.len());
    let factor = cholesky(b, n)?;
    let solved: Vec<Vec<f64>> = rows.iter().map(|row| back(&factor, n, &row.of)).collect();
    let newton = back(&factor, n, g);
    let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
    let matrix: Vec<f64> = rows.iter().flat_map(|row| solved.iter().map(move |column| dot(&row.of, column))).collect();
    let start: Vec<f64> = rows.iter().map(|row| dot(&row.of, &newton) + row.limit).collect();
    let mut multipliers = vec![0.0; count];
    for _ in 0..MAX_SWEEPS {
        let mut changed = 0.0f64;
        let largest = multipliers.iter().fold(1e-300f64, |largest, one| largest.max(*one));
        for (k, row) in rows.iter().enumerate() {
            let own = matrix[k * count + k];
            if own <= 0.0 {
                continue;
            }
            let slope = start[k] + dot(&matrix[k * count..(k + 1) * count], &multipliers);
            let next = (multipliers[k] - slope / own).clamp(0.0, row.price);
            changed = changed.max((next - multipliers[k]).abs());
            multipliers[k] = next;
        }
        if changed <= SMALL * largest {
            break;
        }
    }
    let mut d: Vec<f64> = newton.iter().map(|x| -x).collect();
    for (column, multiplier) in solved.iter().zip(&multipliers) {
        d.iter_mut().zip(column).for_each(|(d, x)| *d -= multiplier * x);
    }
    Some((d, multipliers))
}

/// L of B = L Lᵀ, row by row; `None` where B is not positive definite.
fn cholesky(b: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
            let rest = b[i * n + j] - sum;
            l[i * n + j] = if i == j { (rest > 0.0).then(|| rest.sqrt())? } else { rest / l[j * n + j] };
        }
    }
    Some(l)
}

/// B⁻¹x.
fn back(l: &[f64], n: usize, x: &[f64]) -> Vec<f64> {
    let mut y = x.to_vec();
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| l[i * n + k] * y[k]).sum();
        y[i] = (y[i] - sum) / l[i * n + i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| l[k * n + i] * y[k]).sum();
        y[i] = (y[i] - sum) / l[i * n + i];
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn solutions_meet_the_conditions_of_karush_kuhn_and_tucker() {
        let mut random = Random::of(3);
        for n in 1..6 {
            let mut next = || 2.0 * random.share() - 1.0;
            let a: Vec<f64> = (0..n * n).map(|_| next()).collect();
            let b: Vec<f64> = (0..n * n)
                .map(|k| {
                    let (i, j) = (k / n, k % n);
                    (0..n).map(|m| a[i * n + m] * a[j * n + m]).sum::<f64>() + if i == j { 0.1 } else { 0.0 }
                })
                .collect();
            let g: Vec<f64> = (0..n).map(|_| 3.0 * next()).collect();
            let row = |of: Vec<f64>, limit: f64, price: f64| Row { of, limit, price };
            let mut rows: Vec<Row> = (0..2 * n)
                .map(|k| {
                    row((0..n).map(|j| if j == k / 2 { [1.0, -1.0][k % 2] } else { 0.0 }).collect(), 0.3, f64::INFINITY)
                })
                .collect();
            rows.extend((0..n).map(|_| row((0..n).map(|_| next()).collect(), 0.1 * next(), 5.0)));
            let (d, multipliers) = solve(&b, &g, &rows).unwrap();
            for i in 0..n {
                let pull: f64 = (0..n).map(|j| b[i * n + j] * d[j]).sum::<f64>() + g[i];
                let push: f64 = rows.iter().zip(&multipliers).map(|(row, m)| row.of[i] * m).sum();
                assert!((pull + push).abs() < 1e-10, "{n}");
            }
            for (row, multiplier) in rows.iter().zip(&multipliers) {
                let slack = row.limit - row.of.iter().zip(&d).map(|(c, d)| c * d).sum::<f64>();
                assert!((0.0..=row.price).contains(multiplier));
                assert!(slack > -1e-9 || *multiplier == row.price, "broken without its price: {slack}");
                assert!(
                    slack.abs() < 1e-9 || *multiplier == 0.0 || slack < 0.0,
                    "a price for nothing: {slack} {multiplier}"
                );
            }
        }
        assert!(solve(&[-1.0], &[1.0], &[]).is_none());
    }
}
