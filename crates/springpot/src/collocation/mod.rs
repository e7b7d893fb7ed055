//! Nodes of a step, the matrices of collocation at them, and quadratures.
//!
//! With θ = (t − t_n)/h the nodes are 0 < c_1 < … < c_s ≤ 1. A function over the step is known by its values at the start and at the nodes.

mod gaps;
pub(crate) mod inner;
mod places;
pub(crate) mod radau;

pub(crate) use gaps::Gaps;
pub use places::Places;

use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// √6 rounded to double precision.
const SQRT6: f64 = 2.449_489_742_783_178;

/// Nodes of Radau IIA with three stages, (4 ∓ √6)/10 and 1 (Hairer & Wanner, Solving ODEs II, IV.5).
pub const RADAU_NODES: [f64; 3] = [(4.0 - SQRT6) / 10.0, (4.0 + SQRT6) / 10.0, 1.0];

/// Coefficients of θ^p, p = 0…4, of ω = θ(θ − c_1)(θ − c_2)(θ − 1), which vanishes where the cubic of the rates is exact.
pub(crate) const NODE_POLYNOMIAL: [f64; 5] = {
    let [c1, c2, _] = RADAU_NODES;
    [0.0, -c1 * c2, c1 * c2 + c1 + c2, -(1.0 + c1 + c2), 1.0]
};

/// Weights of Radau IIA: ∫₀¹ f ≈ Σ b_i f(c_i), exact for degree 4.
pub const RADAU_WEIGHTS: [f64; 3] = [(16.0 - SQRT6) / 36.0, (16.0 + SQRT6) / 36.0, 1.0 / 9.0];

/// The inverse of the Radau IIA matrix A.
pub(crate) const RADAU_INVERSE: [[f64; 3]; 3] = [
    [3.224_744_871_391_589, 1.167_840_084_690_405_5, -0.253_197_264_742_180_83],
    [-3.567_840_084_690_405_5, 0.775_255_128_608_411, 1.053_197_264_742_180_8],
    [5.531_972_647_421_808, -7.531_972_647_421_808, 5.0],
];

/// Number of nodes of a step with [`Nodes::Radau`].
pub const STAGES: usize = RADAU_NODES.len();

/// The largest number of nodes of a step.
pub const MAX_NODES: usize = inner::NODES.len();

/// Where a step is evaluated, 0 < c_1 < … < c_s ≤ 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Nodes {
    /// s = 1, at the end.
    One,
    /// s = 1, in the middle: x' is constant over the step, and the node stands for the mean over the step.
    Midpoint,
    /// s = 3, Radau IIA.
    Radau,
    /// s = 4, Radau IIA: where the strokes inside a series are found in steps with [`Nodes::Radau`].
    Inner,
}

impl Nodes {
    /// The nodes c_i.
    pub fn positions(self) -> &'static [f64] {
        match self {
            Self::One => &[1.0],
            Self::Midpoint => &[0.5],
            Self::Radau => &RADAU_NODES,
            Self::Inner => &inner::NODES,
        }
    }

    /// The inverse of the collocation matrix: with x' a polynomial through its values at the nodes, x'_i = Σ_j inverse_ij (x_j − x_0)/h.
    pub fn inverse(self) -> &'static [[f64; MAX_NODES]; MAX_NODES] {
        match self {
            Self::One => &[[1.0, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]],
            Self::Midpoint => &[[2.0, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]],
            Self::Radau => &radau::PADDED_INVERSE,
            Self::Inner => &inner::TABLEAU_OF_FOUR.inverse,
        }
    }

    /// The collocation matrix A: x_i − x_0 = h Σ_j A_ij x'_j; exact for x' of degree s − 1.
    pub fn matrix(self) -> &'static [[f64; MAX_NODES]; MAX_NODES] {
        match self {
            Self::One => &[[1.0, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]],
            Self::Midpoint => &[[0.5, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]],
            Self::Radau => &radau::PADDED,
            Self::Inner => &inner::TABLEAU_OF_FOUR.matrix,
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
    let mut weights = [0.0; MAX_NODES + 1];
    match nodes {
        Nodes::One => weights[..2].copy_from_slice(&[theta - 0.5 * theta * theta, 0.5 * theta * theta]),
        Nodes::Midpoint => weights[1] = theta,
        Nodes::Radau if theta == 1.0 => weights[1..4].copy_from_slice(&RADAU_WEIGHTS),
        Nodes::Radau => (0..4).for_each(|k| weights[k] = integral(&TABLEAU.rates, k, theta)),
        Nodes::Inner if theta == 1.0 => weights[1..].copy_from_slice(&inner::TABLEAU_OF_FOUR.matrix[MAX_NODES - 1]),
        Nodes::Inner => (0..5).for_each(|k| weights[k] = integral(&inner::TABLEAU_OF_FOUR.values, k, theta)),
    }
    weights
}

/// ∫₀^θ of the polynomial with the coefficients `lagrange`[p][k], p = 0, 1, …
fn integral<const N: usize>(lagrange: &[[f64; N]; N], k: usize, theta: f64) -> f64 {
    (0..N).rev().fold(0.0, |sum, p| sum * theta + lagrange[p][k] / (p + 1) as f64) * theta
}

/// The Lagrange polynomial of node `k` at θ.
fn value<const N: usize>(lagrange: &[[f64; N]; N], k: usize, theta: f64) -> f64 {
    (0..N).rev().fold(0.0, |sum, p| sum * theta + lagrange[p][k])
}

/// Its derivative.
fn slope<const N: usize>(lagrange: &[[f64; N]; N], k: usize, theta: f64) -> f64 {
    (1..N).rev().fold(0.0, |sum, p| sum * theta + p as f64 * lagrange[p][k])
}

/// Coefficients of θ^p, p = 0…3, of the Lagrange polynomial of point `k` of (0, c_1, c_2, 1).
pub fn lagrange_row(k: usize) -> [f64; 4] {
    std::array::from_fn(|p| TABLEAU.rates[p][k])
}

/// The cubic in θ through values at the start and at the Radau nodes of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cubic {
    /// Of θ^p, p = 0…3.
    pub(crate) coefficients: [f64; STAGES + 1],
    end: f64,
}

impl Cubic {
    pub(crate) fn through(values: &[f64]) -> Self {
        let coefficients = TABLEAU.rates.map(|row| row.iter().zip(values).map(|(weight, value)| weight * value).sum());
        Self { coefficients, end: values[STAGES] }
    }

    /// At θ; at 1 the value itself.
    pub(crate) fn at(&self, theta: f64) -> f64 {
        if theta == 1.0 { self.end } else { self.coefficients.iter().rev().fold(0.0, |sum, c| sum * theta + c) }
    }

    /// Its derivative by θ.
    pub(crate) fn slope(&self, theta: f64) -> f64 {
        (1..=STAGES).rev().fold(0.0, |sum, p| sum * theta + p as f64 * self.coefficients[p])
    }

    /// Whether it is positive on all of 0 ≤ θ ≤ 1 as the hull of its control points tells.
    pub(crate) fn is_clear(&self) -> bool {
        let [a, b, c, d] = self.coefficients;
        let hull = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d, self.end];
        hull.iter().all(|point| *point > 0.0)
    }
}

impl std::ops::Neg for Cubic {
    type Output = Self;

    fn neg(self) -> Self {
        Self { coefficients: self.coefficients.map(|c| -c), end: -self.end }
    }
}

/// Embedded error estimate of the quadrature at Radau nodes in units of h, from the values at 0 and at the nodes: γ_0 times the distance
/// of the value at 0 from the polynomial through the nodes (Hairer & Wanner, IV.8). Of the order s; 0 with one node.
pub fn quadrature_defect(nodes: Nodes, values: &[f64]) -> f64 {
    let (highest, product): (&[f64], f64) = match nodes {
        Nodes::One | Nodes::Midpoint => return 0.0,
        Nodes::Radau => (&TABLEAU.rates[3], RADAU_NODES.iter().product()),
        Nodes::Inner => (&inner::TABLEAU_OF_FOUR.values[4], inner::NODES.iter().product()),
    };
    let coefficient: f64 = highest.iter().zip(values).map(|(factor, value)| factor * value).sum();
    (radau::GAMMA * product * coefficient).abs()
}

/// The cubic with coefficients `u` at θ, its integral from 0, and the integral of that.
pub(crate) fn integrals(u: [f64; 4], theta: f64) -> [f64; 3] {
    let [u0, u1, u2, u3] = u;
    let value = u0 + theta * (u1 + theta * (u2 + theta * u3));
    let once = theta * (u0 + theta * (u1 / 2.0 + theta * (u2 / 3.0 + theta * u3 / 4.0)));
    let twice = theta * theta * (u0 / 2.0 + theta * (u1 / 6.0 + theta * (u2 / 12.0 + theta * u3 / 20.0)));
    [value, once, twice]
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
fn lagrange_coefficients<const N: usize>(nodes: [f64; N]) -> [[f64; N]; N] {
    let mut coefficients = [[0.0; N]; N];
    for k in 0..N {
        let mut polynomial = [0.0; N];
        polynomial[0] = 1.0;
        let mut denominator = 1.0;
        for (degree, j) in (0..N).filter(|&j| j != k).enumerate() {
            for p in (0..=degree).rev() {
                polynomial[p + 1] += polynomial[p];
                polynomial[p] *= -nodes[j];
            }
            denominator *= nodes[k] - nodes[j];
        }
        for p in 0..N {
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
