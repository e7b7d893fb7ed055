//! Principal moments of an inertia tensor.

/// Eigenvalues of the symmetric matrix `m` (its upper triangle is read), in rising order, by cyclic Jacobi rotations.
///
/// Absolute error of a few rounding units of the largest entry. NaN or infinite entries give NaN.
pub(super) fn principal_moments(m: [[f64; 3]; 3]) -> [f64; 3] {
    let scale = m.iter().flatten().fold(0.0, |s: f64, x| s.max(x.abs()));
    if scale == 0.0 {
        return [0.0; 3];
    }
    // Scaled to unit size, so that squares neither overflow nor vanish.
    let mut a = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            a[i][j] = m[i.min(j)][i.max(j)] / scale;
        }
    }
    // Convergence is quadratic: three sweeps reach rounding, a dozen is beyond doubt.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = 1f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for k in 0..3 {
                (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
            }
            for k in 0..3 {
                (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
            }
            (a[p][q], a[q][p]) = (0.0, 0.0);
        }
    }
    let mut moments = [a[0][0] * scale, a[1][1] * scale, a[2][2] * scale];
    moments.sort_by(f64::total_cmp);
    moments
}

#[cfg(test)]
mod tests {
    use super::principal_moments;
    use crate::spatial::{Rotation, Symmetric3};

    #[test]
    fn eigenvalues_of_a_rotated_diagonal() {
        for (k, diagonal) in
            [[1.0, 2.0, 3.0], [1e-9, 1.0, 1.0], [-2.0, 0.0, 5.0], [1e200, 3e200, 2e200]].into_iter().enumerate()
        {
            let r = Rotation::from_rpy([0.3 + k as f64, -0.7, 2.1]);
            let s = Symmetric3 { xx: diagonal[0], yy: diagonal[1], zz: diagonal[2], ..Symmetric3::ZERO };
            let moments = principal_moments(s.rotated(&r).to_matrix());
            let mut expected = diagonal;
            expected.sort_by(f64::total_cmp);
            for i in 0..3 {
                assert!((moments[i] - expected[i]).abs() <= 4e-15 * expected[2].abs(), "{moments:?} {expected:?}");
            }
        }
    }
}
