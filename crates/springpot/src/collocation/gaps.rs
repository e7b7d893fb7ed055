//! What strokes at the nodes of a step tell beside the rates there.
//!
//! The cubic C of the rates at 0 and at the nodes θ_1, θ_2, 1 has not the integrals that the strokes tell. What is missing, g_j = (x_j − x_0)/h − ∫₀^{θ_j} C,
//! is that of ω Σ_k b_k θ^k, k = 0, 1, 2, with ω = θ(θ − θ_1)(θ − θ_2)(θ − 1), which changes no rate.

use super::{NODE_POLYNOMIAL, Places, RADAU_NODES, STAGES};
use std::sync::LazyLock;

/// How b follows from g.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gaps {
    /// Coefficients of θ^p of ω, p = 0…4.
    pub(crate) node_polynomial: [f64; 5],
    /// b_k = Σ_j inverse[k][j] g_j.
    pub(crate) inverse: [[f64; STAGES]; STAGES],
}

static AT_RADAU_NODES: LazyLock<Gaps> = LazyLock::new(|| Gaps::new(RADAU_NODES, NODE_POLYNOMIAL));

impl Gaps {
    /// Of the Radau nodes, or of those at `places`.
    pub(crate) fn at(places: Option<&Places>) -> Self {
        places.map_or_else(|| *AT_RADAU_NODES, |places| Self::new(*places.positions(), places.node_polynomial()))
    }

    fn new(positions: [f64; STAGES], node_polynomial: [f64; 5]) -> Self {
        let integral = |theta: f64, k: usize| -> f64 {
            let terms = node_polynomial.iter().enumerate().map(|(p, factor)| factor / (p + k + 1) as f64);
            terms.rev().fold(0.0, |sum, term| sum * theta + term) * theta.powi(k as i32 + 1)
        };
        let matrix = positions.map(|theta| [0, 1, 2].map(|k| integral(theta, k)));
        let cofactor = |i: usize, j: usize| {
            let [a, b, c, d] = [(1, 1), (2, 2), (1, 2), (2, 1)].map(|(p, q)| matrix[(i + p) % 3][(j + q) % 3]);
            a * b - c * d
        };
        let determinant: f64 = (0..STAGES).map(|k| matrix[0][k] * cofactor(0, k)).sum();
        let inverse = std::array::from_fn(|k| std::array::from_fn(|j| cofactor(j, k) / determinant));
        Self { node_polynomial, inverse }
    }
}
