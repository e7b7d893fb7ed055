//! Gauss rules of discrete measures.

/// Gauss rules of 1 to `largest` points of a discrete positive measure, nodes descending: Lanczos with full
/// reorthogonalisation, then the eigenvalues of the leading blocks of the Jacobi matrix (Golub & Welsch 1969).
pub(super) fn gauss_rules(points: &[f64], masses: &[f64], largest: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
    let total: f64 = masses.iter().sum();
    let mut basis: Vec<Vec<f64>> = vec![masses.iter().map(|m| (m / total).sqrt()).collect()];
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    for j in 0..largest {
        let mut next: Vec<f64> = basis[j].iter().zip(points).map(|(v, y)| v * y).collect();
        diagonal.push(dot(&next, &basis[j]));
        for _ in 0..2 {
            for v in &basis {
                let overlap = dot(&next, v);
                next.iter_mut().zip(v).for_each(|(n, v)| *n -= overlap * v);
            }
        }
        let norm = dot(&next, &next).sqrt();
        beside.push(norm);
        basis.push(next.iter().map(|n| n / norm).collect());
    }
    let rule = |size: usize| {
        let mut jacobi = vec![vec![0.0; size]; size];
        for j in 0..size {
            jacobi[j][j] = diagonal[j];
            if j > 0 {
                jacobi[j][j - 1] = beside[j - 1];
                jacobi[j - 1][j] = beside[j - 1];
            }
        }
        let (values, first) = symmetric_eigen(jacobi);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        (
            order.iter().map(|&i| values[i].max(0.0)).collect(),
            order.iter().map(|&i| total * first[i] * first[i]).collect(),
        )
    };
    (1..=largest).map(rule).collect()
}

/// The rule of `size` points alone.
pub(super) fn gauss_rule(points: &[f64], masses: &[f64], size: usize) -> (Vec<f64>, Vec<f64>) {
    gauss_rules(points, masses, size).pop().expect("at least one point")
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Eigenvalues of a small positive definite matrix and the first components of its eigenvectors, by cyclic Jacobi rotations.
///
/// Elements below rounding next to their own diagonal count as 0, so that small eigenvalues keep their digits (Demmel &
/// Veselić, SIAM J. Matrix Anal. Appl. 13 (1992) 1204).
fn symmetric_eigen(mut a: Vec<Vec<f64>>) -> (Vec<f64>, Vec<f64>) {
    let n = a.len();
    let mut first: Vec<f64> = (0..n).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
    for _ in 0..60 {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q].abs() <= 1e-17 * (a[p][p] * a[q][q]).abs().sqrt() {
                    continue;
                }
                turned = true;
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for k in 0..n {
                    (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
                }
                for k in 0..n {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
                (first[p], first[q]) = (c * first[p] - s * first[q], s * first[p] + c * first[q]);
            }
        }
        if !turned {
            break;
        }
    }
    ((0..n).map(|i| a[i][i]).collect(), first)
}
