//! The three nodes of a step elsewhere than where Radau IIA has them: on a clock that does not run evenly.

use super::radau::GAMMA;
use super::{MAX_NODES, STAGES, integral, lagrange_coefficients, slope, value};

/// Nodes 0 < θ_1 < θ_2 < θ_3 = 1 of a step with three, and what [`super::Nodes`] has of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Places {
    positions: [f64; STAGES],
    /// The polynomial through the values at 0 and at the nodes: coefficient of θ^p is Σ_k values[p][k] f_k.
    pub(crate) values: [[f64; STAGES + 1]; STAGES + 1],
    /// That through the values at the nodes alone.
    rates: [[f64; STAGES]; STAGES],
}

impl Places {
    /// Nodes at these places, of which the last is 1.
    pub fn new(positions: [f64; STAGES]) -> Self {
        let [a, b, c] = positions;
        Self { positions, values: lagrange_coefficients([0.0, a, b, c]), rates: lagrange_coefficients(positions) }
    }

    /// The nodes θ_i.
    pub fn positions(&self) -> &[f64; STAGES] {
        &self.positions
    }

    /// As [`super::Nodes::inverse`].
    pub fn inverse(&self) -> [[f64; MAX_NODES]; MAX_NODES] {
        let mut inverse = [[0.0; MAX_NODES]; MAX_NODES];
        for (row, theta) in inverse.iter_mut().zip(self.positions) {
            (0..STAGES).for_each(|j| row[j] = slope(&self.values, j + 1, theta));
        }
        inverse
    }

    /// As [`super::Nodes::matrix`].
    pub fn matrix(&self) -> [[f64; MAX_NODES]; MAX_NODES] {
        let mut matrix = [[0.0; MAX_NODES]; MAX_NODES];
        for (row, theta) in matrix.iter_mut().zip(self.positions) {
            (0..STAGES).for_each(|j| row[j] = integral(&self.rates, j, theta));
        }
        matrix
    }

    /// Weights of ∫₀^θ f dθ on the values of f at 0 and at the nodes; at the end those of the collocation, without that at 0.
    pub fn quadrature(&self, theta: f64) -> [f64; MAX_NODES + 1] {
        let mut weights = [0.0; MAX_NODES + 1];
        if theta == 1.0 {
            (0..STAGES).for_each(|j| weights[j + 1] = integral(&self.rates, j, 1.0));
        } else {
            (0..=STAGES).for_each(|k| weights[k] = integral(&self.values, k, theta));
        }
        weights
    }

    /// As [`super::quadrature_defect`].
    pub fn quadrature_defect(&self, values: &[f64]) -> f64 {
        let coefficient: f64 = self.values[STAGES].iter().zip(values).map(|(factor, value)| factor * value).sum();
        (GAMMA * self.positions.iter().product::<f64>() * coefficient).abs()
    }

    /// The polynomial of degree 3 through the values at 0 and at the nodes, at θ.
    pub fn interpolate(&self, values: &[f64], theta: f64) -> f64 {
        values.iter().enumerate().take(STAGES + 1).map(|(k, f)| value(&self.values, k, theta) * f).sum()
    }

    /// Coefficients of θ^p, p = 0…4, of θ(θ − θ_1)(θ − θ_2)(θ − 1).
    pub(crate) fn node_polynomial(&self) -> [f64; 5] {
        let [a, b, c] = self.positions;
        [0.0, -a * b * c, a * b + a * c + b * c, -(a + b + c), 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Nodes, RADAU_NODES, quadrature, quadrature_defect};
    use super::*;

    #[test]
    fn at_radau_nodes_they_are_those() {
        let places = Places::new(RADAU_NODES);
        let near = |a: &[[f64; MAX_NODES]; MAX_NODES], b: &[[f64; MAX_NODES]; MAX_NODES]| {
            a.as_flattened().iter().zip(b.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-13)
        };
        assert!(near(&places.inverse(), Nodes::Radau.inverse()) && near(&places.matrix(), Nodes::Radau.matrix()));
        for theta in [0.2, 0.7, 1.0] {
            let pairs = places.quadrature(theta).into_iter().zip(quadrature(Nodes::Radau, theta));
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-14));
        }
        let values = [0.3, -1.0, 2.0, 0.7];
        assert!((places.quadrature_defect(&values) - quadrature_defect(Nodes::Radau, &values)).abs() < 1e-14);
    }

    #[test]
    fn polynomials_are_met_whole() {
        let places = Places::new([0.3, 0.55, 1.0]);
        let points = [0.0, 0.3, 0.55, 1.0];
        for p in 0..4 {
            let f = points.map(|t: f64| t.powi(p));
            assert!((places.interpolate(&f, 0.42) - 0.42f64.powi(p)).abs() < 1e-14);
            let sum: f64 = places.quadrature(0.42).iter().zip(f).map(|(w, f)| w * f).sum();
            assert!((sum - 0.42f64.powi(p + 1) / f64::from(p + 1)).abs() < 1e-14);
            for (row, theta) in places.inverse().iter().zip([0.3, 0.55, 1.0]) {
                let slope: f64 = (0..3).map(|j| row[j] * (f[j + 1] - f[0])).sum();
                let exact = if p == 0 { 0.0 } else { f64::from(p) * f64::powi(theta, p - 1) };
                assert!((slope - exact).abs() < 1e-13);
            }
        }
        let end = places.node_polynomial().iter().enumerate().map(|(p, c)| c * 0.55f64.powi(p as i32)).sum::<f64>();
        assert!(end.abs() < 1e-15);
    }
}
