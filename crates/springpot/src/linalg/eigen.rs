//! Symmetric eigenvalue problems by cyclic Jacobi rotations.

/// Sweeps after which the rotations end: convergence is quadratic, a few are enough.
const MOST_SWEEPS: usize = 60;

/// Turns the symmetric matrix `a`, n × n, into VᵀaV with the eigenvalues on its diagonal, and `first`, the first row of V₀, into that
/// of V₀V.
///
/// Elements below rounding next to their own diagonal count as 0, so that small eigenvalues of a positive definite matrix keep their
/// digits (J. Demmel, K. Veselić, SIAM J. Matrix Anal. Appl. 13 (1992) 1204).
pub(super) fn diagonalise(a: &mut [f64], first: &mut [f64]) {
    let n = first.len();
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let beside = a[p * n + q];
                if beside.abs() <= 1e-17 * (a[p * n + p] * a[q * n + q]).abs().sqrt() {
                    continue;
                }
                turned = true;
                let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * beside);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                let turn = |x: f64, y: f64| (c * x - s * y, s * x + c * y);
                for k in 0..n {
                    (a[k * n + p], a[k * n + q]) = turn(a[k * n + p], a[k * n + q]);
                }
                for k in 0..n {
                    (a[p * n + k], a[q * n + k]) = turn(a[p * n + k], a[q * n + k]);
                }
                (first[p], first[q]) = turn(first[p], first[q]);
            }
        }
        if !turned {
            break;
        }
    }
}

/// Eigenvalues of the symmetric matrix `m` (its upper triangle is read), in rising order.
///
/// Absolute error of a few rounding units of the largest entry. NaN or infinite entries give NaN.
pub(crate) fn symmetric_eigenvalues<const N: usize>(m: [[f64; N]; N]) -> [f64; N] {
    let scale = m.as_flattened().iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    if scale == 0.0 {
        return [0.0; N];
    }
    // Scaled to unit size, so that squares neither overflow nor vanish.
    let mut a: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| m[i.min(j)][i.max(j)] / scale));
    diagonalise(a.as_flattened_mut(), &mut [0.0; N]);
    let mut values: [f64; N] = std::array::from_fn(|i| a[i][i] * scale);
    values.sort_by(f64::total_cmp);
    values
}

/// Eigenvalues of the symmetric matrix `m`, and the matrix whose columns are their vectors.
#[cfg(feature = "urdf")]
pub(crate) fn symmetric_eigenvectors(m: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut values = [0.0; 3];
    let rows = [0, 1, 2].map(|row| {
        let (mut a, mut own) = (m, [0.0; 3]);
        own[row] = 1.0;
        diagonalise(a.as_flattened_mut(), &mut own);
        values = [0, 1, 2].map(|k| a[k][k]);
        own
    });
    (values, rows)
}

#[cfg(test)]
mod tests {
    use super::symmetric_eigenvalues;

    #[test]
    fn eigenvalues_of_a_rotated_diagonal() {
        for (k, diagonal) in
            [[1.0, 2.0, 3.0], [1e-9, 1.0, 1.0], [-2.0, 0.0, 5.0], [1e200, 3e200, 2e200]].into_iter().enumerate()
        {
            // A product of two plane rotations.
            let ([s, c], [u, w]) = ((0.3 + k as f64).sin_cos().into(), 2.1f64.sin_cos().into());
            let r: [[f64; 3]; 3] = [[c, -s, 0.0], [w * s, w * c, -u], [u * s, u * c, w]];
            let m = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|l| r[i][l] * diagonal[l] * r[j][l]).sum::<f64>()));
            let values = symmetric_eigenvalues(m);
            let mut expected = diagonal;
            expected.sort_by(f64::total_cmp);
            for i in 0..3 {
                assert!((values[i] - expected[i]).abs() <= 4e-15 * expected[2].abs(), "{values:?} {expected:?}");
            }
        }
    }

    #[test]
    fn what_is_no_number_or_nothing() {
        assert_eq!(symmetric_eigenvalues([[0.0; 3]; 3]), [0.0; 3]);
        for bad in [f64::NAN, f64::INFINITY] {
            let values = symmetric_eigenvalues([[1.0, bad, 0.0], [bad, 1.0, 0.0], [0.0, 0.0, 1.0]]);
            assert!(values.iter().any(|value| value.is_nan()), "{values:?}");
        }
    }
}
