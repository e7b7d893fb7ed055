//! Samples without most of their noise.

/// Samples to each side that a cubic goes through.
const HALF: usize = 4;

/// The value at each time of the cubic that is nearest to the samples about it (A. Savitzky, M. J. E. Golay, Anal. Chem. 36 (1964) 1627–1639); samples
/// need not be equally far apart.
pub(super) fn smoothed(at: &[f64], values: &[f64]) -> Vec<f64> {
    let count = at.len();
    if count < 2 * HALF + 1 {
        return values.to_vec();
    }
    (0..count)
        .map(|k| {
            let first = k.saturating_sub(HALF).min(count - 2 * HALF - 1);
            let own = first..first + 2 * HALF + 1;
            let wide = at[own.end - 1] - at[own.start];
            // Polynomials that are orthogonal over these samples, one after the other: their values there, and at k.
            let x: Vec<f64> = own.clone().map(|i| (at[i] - at[k]) / wide).collect();
            let mut known: Vec<Vec<f64>> = Vec::new();
            let mut value = 0.0;
            for degree in 0..4 {
                let mut next: Vec<f64> = x.iter().map(|x| x.powi(degree)).collect();
                for _ in 0..2 {
                    for other in &known {
                        let share: f64 = other.iter().zip(&next).map(|(a, b)| a * b).sum();
                        next.iter_mut().zip(other).for_each(|(next, other)| *next -= share * other);
                    }
                }
                let size = next.iter().map(|x| x * x).sum::<f64>().sqrt();
                next.iter_mut().for_each(|x| *x /= size);
                let share: f64 = next.iter().zip(&values[own.clone()]).map(|(a, b)| a * b).sum();
                value += share * next[k - first];
                known.push(next);
            }
            value
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_stay_and_noise_falls() {
        let at: Vec<f64> = (0..40).map(|k| f64::from(k) + 0.2 * f64::from(k % 3)).collect();
        let cubic: Vec<f64> = at.iter().map(|t| 1.0 - 0.3 * t + 0.02 * t * t - 1e-3 * t.powi(3)).collect();
        let same = smoothed(&at, &cubic);
        assert!(same.iter().zip(&cubic).all(|(a, b)| (a - b).abs() < 1e-11));
        let noise: Vec<f64> = (0..40).map(|k| [1.0, -1.0][k % 2]).collect();
        assert!(smoothed(&at, &noise)[5..35].iter().all(|x| x.abs() < 0.5));
        assert_eq!(smoothed(&at[..5], &cubic[..5]), cubic[..5]);
    }
}
