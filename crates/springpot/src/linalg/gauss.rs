//! Gauss rules of discrete measures.

use super::eigen::diagonalise;
use super::{dot, norm};
use std::ops::RangeInclusive;

/// Gauss rules of so many points, ascending sizes, of the measure with these masses, not negative, at these points, nodes descending: each rule
/// (nodes, weights) of k points integrates polynomials of degree 2k − 1 exactly.
///
/// Lanczos with full reorthogonalisation, then the eigenvalues of the leading blocks of the Jacobi matrix (G. H. Golub, J. H. Welsch,
/// Math. Comp. 23 (1969) 221–230).
pub(crate) fn gauss_rules(points: &[f64], masses: &[f64], sizes: RangeInclusive<usize>) -> Vec<(Vec<f64>, Vec<f64>)> {
    let total: f64 = masses.iter().sum();
    let mut basis: Vec<Vec<f64>> = vec![masses.iter().map(|m| (m / total).sqrt()).collect()];
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    for j in 0..*sizes.end() {
        let mut next: Vec<f64> = basis[j].iter().zip(points).map(|(v, y)| v * y).collect();
        diagonal.push(dot(&next, &basis[j]));
        for _ in 0..2 {
            for v in &basis {
                let overlap = dot(&next, v);
                next.iter_mut().zip(v).for_each(|(n, v)| *n -= overlap * v);
            }
        }
        let size = norm(&next);
        beside.push(size);
        basis.push(next.iter().map(|n| n / size).collect());
    }
    let rule = |size: usize| {
        let (mut jacobi, mut first) = (vec![0.0; size * size], vec![0.0; size]);
        first[0] = 1.0;
        for j in 0..size {
            jacobi[j * size + j] = diagonal[j];
            if j > 0 {
                jacobi[j * size + j - 1] = beside[j - 1];
                jacobi[(j - 1) * size + j] = beside[j - 1];
            }
        }
        diagonalise(&mut jacobi, &mut first);
        let values: Vec<f64> = (0..size).map(|i| jacobi[i * size + i]).collect();
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        (
            order.iter().map(|&i| values[i].max(0.0)).collect(),
            order.iter().map(|&i| total * first[i] * first[i]).collect(),
        )
    };
    sizes.map(rule).collect()
}

/// The rule of `size` points alone.
pub(crate) fn gauss_rule(points: &[f64], masses: &[f64], size: usize) -> (Vec<f64>, Vec<f64>) {
    gauss_rules(points, masses, size..=size).pop().expect("at least one point")
}

#[cfg(test)]
mod tests {
    use super::{gauss_rule, gauss_rules};

    #[test]
    fn rules_integrate_polynomials_exactly() {
        let points: Vec<f64> = (0..30).map(|k| (-0.3 * f64::from(k)).exp()).collect();
        let masses: Vec<f64> = (0..30).map(|k| 1.0 + f64::from(k).sin()).collect();
        let moment = |points: &[f64], masses: &[f64], degree: i32| -> f64 {
            points.iter().zip(masses).map(|(point, mass)| mass * point.powi(degree)).sum()
        };
        for (k, (nodes, weights)) in gauss_rules(&points, &masses, 1..=6).into_iter().enumerate() {
            assert!(nodes.is_sorted_by(|a, b| a > b) && weights.iter().all(|weight| *weight > 0.0));
            for degree in 0..2 * (k as i32 + 1) {
                let (exact, rule) = (moment(&points, &masses, degree), moment(&nodes, &weights, degree));
                assert!((rule / exact - 1.0).abs() < 1e-13, "{k} {degree}: {rule} {exact}");
            }
            assert_eq!(gauss_rule(&points, &masses, k + 1), (nodes, weights));
        }
    }
}
