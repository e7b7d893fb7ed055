//! Nodes of a step, the matrices of collocation at them, and quadratures.
//!
//! With θ = (t − t_n)/h the nodes are 0 < c_1 < … < c_s ≤ 1. A function over the step is known by its values at the start and at the nodes.

pub(crate) mod radau;

use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// √6 rounded to double precision.
const SQRT6: f64 = 2.449_489_742_783_178;

/// Nodes of Radau IIA with three stages, (4 ∓ √6)/10 and 1 (Hairer & Wanner, Solving ODEs II, IV.5).
pub const RADAU_NODES: [f64; 3] = [(4.0 - SQRT6) / 10.0, (4.0 + SQRT6) / 10.0, 1.0];

/// Weights of Radau IIA: ∫₀¹ f ≈ Σ b_i f(c_i), exact for degree 4.
pub const RADAU_WEIGHTS: [f64; 3] = [(16.0 - SQRT6) / 36.0, (16.0 + SQRT6) / 36.0, 1.0 / 9.0];

/// The inverse of the Radau IIA matrix A.
pub(crate) const RADAU_INVERSE: [[f64; 3]; 3] = [
    [3.224_744_871_391_589, 1.167_840_084_690_405_5, -0.253_197_264_742_180_83],
    [-3.567_840_084_690_405_5, 0.775_255_128_608_411, 1.053_197_264_742_180_8],
    [5.531_972_647_421_808, -7.531_972_647_421_808, 5.0],
];

/// The largest number of nodes of a step.
pub const MAX_NODES: usize = 3;

/// Where a step is evaluated, 0 < c_1 < … < c_s ≤ 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Nodes {
    /// s = 1, at the end.
    One,
    /// s = 1, in the middle: x' is constant over the step, and the node stands for the mean over the step.
    Midpoint,
    /// s = 3, Radau IIA.
    Radau,
}

impl Nodes {
    /// The nodes c_i.
    pub fn positions(self) -> &'static [f64] {
        match self {
            Self::One => &[1.0],
            Self::Midpoint => &[0.5],
            Self::Radau => &RADAU_NODES,
        }
    }

    /// The inverse of the collocation matrix: with x' a polynomial through its values at the nodes, x'_i = Σ_j inverse_ij (x_j − x_0)/h.
    pub fn inverse(self) -> [[f64; MAX_NODES]; MAX_NODES] {
        match self {
            Self::One => [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            Self::Midpoint => [[2.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            Self::Radau => RADAU_INVERSE,
        }
    }

    /// The collocation matrix A: x_i − x_0 = h Σ_j A_ij x'_j; exact for x' of degree 2 with three nodes, 0 with one.
    pub fn matrix(self) -> [[f64; MAX_NODES]; MAX_NODES] {
        match self {
            Self::One => [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            Self::Midpoint => [[0.5, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            Self::Radau => radau::A,
        }
    }

    /// Number of nodes s.
    pub fn count(self) -> usize {
        self.positions().len()
    }
}

/// Weights of ∫₀^θ f dθ on the values of f at 0 and at the nodes: the Radau weights at θ = 1, the
/// value in the middle alone for [`Nodes::Midpoint`].
pub fn quadrature(nodes: Nodes, theta: f64) -> [f64; MAX_NODES + 1] {
    match nodes {
        Nodes::One => [theta - 0.5 * theta * theta, 0.5 * theta * theta, 0.0, 0.0],
        Nodes::Midpoint => [0.0, theta, 0.0, 0.0],
        Nodes::Radau if theta == 1.0 => [0.0, RADAU_WEIGHTS[0], RADAU_WEIGHTS[1], RADAU_WEIGHTS[2]],
        Nodes::Radau => std::array::from_fn(|k| {
            (0..4).rev().fold(0.0, |sum, p| sum * theta + TABLEAU.rates[p][k] / (p + 1) as f64) * theta
        }),
    }
}

/// Coefficients of θ^p, p = 0…3, of the Lagrange polynomial of point `k` of (0, c_1, c_2, 1).
pub fn lagrange_row(k: usize) -> [f64; 4] {
    std::array::from_fn(|p| TABLEAU.rates[p][k])
}

/// Embedded error estimate of the Radau quadrature in units of h, from the values at 0 and at the nodes: γ_0 times the distance
/// of the value at 0 from the parabola through the nodes (Hairer & Wanner, IV.8). Order 3.
pub fn quadrature_defect(values: [f64; MAX_NODES + 1]) -> f64 {
    let cubic: f64 = (0..4).map(|k| TABLEAU.rates[3][k] * values[k]).sum();
    (radau::GAMMA * RADAU_NODES[0] * RADAU_NODES[1] * cubic).abs()
}

/// Inverse Vandermonde matrices of the Radau nodes.
pub(crate) struct Tableau {
    /// Of (0, c_1, c_2, 1): u_p = Σ_k rates[p][k] x'_k.
    pub(crate) rates: [[f64; 4]; 4],
    /// Of [c_j^p], p = 1…3: coefficient of θ^{p+1} in x is Σ_j strokes[p][j] (x_j − x_0).
    pub(crate) strokes: [[f64; 3]; 3],
}

pub(crate) static TABLEAU: LazyLock<Tableau> = LazyLock::new(|| {
    let [c1, c2, _] = RADAU_NODES;
    let rates = lagrange_coefficients([0.0, c1, c2, 1.0]);
    let strokes = std::array::from_fn(|p| std::array::from_fn(|j| rates[p + 1][j + 1]));
    Tableau { rates, strokes }
});

/// coefficients[p][k] of θ^p in the Lagrange polynomial of node k.
fn lagrange_coefficients(nodes: [f64; 4]) -> [[f64; 4]; 4] {
    let mut coefficients = [[0.0; 4]; 4];
    for k in 0..4 {
        let mut polynomial = [1.0, 0.0, 0.0, 0.0];
        let mut denominator = 1.0;
        for (degree, j) in (0..4).filter(|&j| j != k).enumerate() {
            for p in (0..=degree).rev() {
                polynomial[p + 1] += polynomial[p];
                polynomial[p] *= -nodes[j];
            }
            denominator *= nodes[k] - nodes[j];
        }
        for p in 0..4 {
            coefficients[p][k] = polynomial[p] / denominator;
        }
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radau_weights_are_exact_to_degree_four() {
        for p in 0..5 {
            let sum: f64 = (0..3).map(|i| RADAU_WEIGHTS[i] * RADAU_NODES[i].powi(p)).sum();
            assert!((sum - 1.0 / (p + 1) as f64).abs() < 1e-15);
        }
    }
}
