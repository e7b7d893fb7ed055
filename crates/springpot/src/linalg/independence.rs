//! Independence of columns, and small positive definite systems.

use super::{dot, norm};

/// A column of which this share or less lies outside the span of the others depends on them.
const DEPENDENT: f64 = 1e-7;

/// Whether no column is a linear combination of the others, to rounding: Gram and Schmidt.
pub(crate) fn are_independent(columns: impl IntoIterator<Item = Vec<f64>>) -> bool {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let size = norm(&column);
        for other in &basis {
            let along = dot(&column, other);
            column.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
        }
        let rest = norm(&column);
        if !rest.is_finite() || rest <= DEPENDENT * size {
            return false;
        }
        basis.push(column.iter().map(|a| a / rest).collect());
    }
    true
}

/// x with A x = b, A positive definite, by Cholesky; `None` where A is singular.
pub(crate) fn cholesky_solve<const N: usize>(a: [[f64; N]; N], b: [f64; N]) -> Option<[f64; N]> {
    let mut l = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let rest = a[i][j] - dot(&l[i][..j], &l[j][..j]);
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
        if l[i][i].is_nan() || l[i][i] <= 0.0 {
            return None;
        }
    }
    let mut x = b;
    for i in 0..N {
        x[i] = (x[i] - dot(&l[i][..i], &x[..i])) / l[i][i];
    }
    for i in (0..N).rev() {
        x[i] = (x[i] - (i + 1..N).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_that_depend() {
        assert!(are_independent([vec![1.0, 0.0, 1.0], vec![1.0, 1e-6, 1.0]]));
        assert!(!are_independent([vec![1.0, 2.0, 3.0], vec![0.0, 1.0, 0.0], vec![2.0, 7.0, 6.0]]));
        assert!(!are_independent([vec![0.0, 0.0]]));
    }
}
