//! One step of size h: its nodes, and the polynomial that stands for x' over it.
//!
//! With θ = (t − t_n)/h, x'(θ) = Σ_p u_p θ^p, p = 0…3. Against this polynomial the kernel is exact:
//! 1/Γ(1−alpha) ∫ (t−s)^−alpha x'(s) ds from t_n to t_n + θh = h^{1−alpha} Σ_p u_p p!/Γ(p+2−alpha) θ^{p+1−alpha}.

use super::gamma::gamma;
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// √6 rounded to double precision.
const SQRT6: f64 = 2.449_489_742_783_178;

/// Nodes of Radau IIA with three stages, (4 ∓ √6)/10 and 1 (Hairer & Wanner, Solving ODEs II, IV.5).
pub const RADAU_NODES: [f64; 3] = [(4.0 - SQRT6) / 10.0, (4.0 + SQRT6) / 10.0, 1.0];

/// Weights of Radau IIA: ∫₀¹ f ≈ Σ b_i f(c_i), exact for degree 4.
pub const RADAU_WEIGHTS: [f64; 3] = [(16.0 - SQRT6) / 36.0, (16.0 + SQRT6) / 36.0, 1.0 / 9.0];

/// The Radau IIA matrix A.
const RADAU_MATRIX: [[f64; 3]; 3] = [
    [(88.0 - 7.0 * SQRT6) / 360.0, (296.0 - 169.0 * SQRT6) / 1800.0, (-2.0 + 3.0 * SQRT6) / 225.0],
    [(296.0 + 169.0 * SQRT6) / 1800.0, (88.0 + 7.0 * SQRT6) / 360.0, (-2.0 - 3.0 * SQRT6) / 225.0],
    RADAU_WEIGHTS,
];

/// The inverse of the Radau IIA matrix A.
pub(super) const RADAU_INVERSE: [[f64; 3]; 3] = [
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
            Self::Radau => RADAU_MATRIX,
        }
    }

    /// Number of nodes s.
    pub fn count(self) -> usize {
        self.positions().len()
    }
}

/// Which data of the step determine the polynomial of x'.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// x' at 0 and at the nodes (in the middle alone with [`Nodes::Midpoint`]); order 5 − alpha along a given motion with Radau
    /// nodes.
    Rates,
    /// x at 0 and at the nodes; order 4 − alpha with Radau nodes, 2 − alpha (the L1 scheme) with one.
    Strokes,
}

/// x' over one step as a polynomial of θ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RatePolynomial {
    /// Step size, s.
    pub h: f64,
    /// Coefficients u_p of θ^p.
    pub u: [f64; 4],
}

impl RatePolynomial {
    /// Through x' at 0 and at the nodes (s + 1 values): the cubic for Radau, the straight line for one
    /// node at the end, the constant for one in the middle.
    pub fn through_rates(h: f64, nodes: Nodes, rate: &[f64]) -> Self {
        let u = match nodes {
            Nodes::One => [rate[0], rate[1] - rate[0], 0.0, 0.0],
            Nodes::Midpoint => [rate[1], 0.0, 0.0, 0.0],
            Nodes::Radau => {
                let inverse = &TABLEAU.rates;
                std::array::from_fn(|p| (0..4).map(|k| inverse[p][k] * rate[k]).sum())
            }
        };
        Self { h, u }
    }

    /// From x at 0 and at the nodes (s + 1 values): the derivative of the interpolating polynomial.
    pub fn through_strokes(h: f64, nodes: Nodes, stroke: &[f64]) -> Self {
        let mut u = [0.0; 4];
        match nodes {
            Nodes::One => u[0] = (stroke[1] - stroke[0]) / h,
            Nodes::Midpoint => u[0] = 2.0 * (stroke[1] - stroke[0]) / h,
            Nodes::Radau => {
                for p in 0..3 {
                    let coefficient: f64 = (0..3).map(|j| TABLEAU.strokes[p][j] * (stroke[j + 1] - stroke[0])).sum();
                    u[p] = (p + 1) as f64 * coefficient / h;
                }
            }
        }
        Self { h, u }
    }

    /// The derivative of the cubic Hermite polynomial of (x, x') at both ends; order 4 − alpha.
    pub fn hermite(h: f64, stroke: [f64; 2], rate: [f64; 2]) -> Self {
        let slope = (stroke[1] - stroke[0]) / h;
        let [v0, v1] = rate;
        Self { h, u: [v0, 6.0 * slope - 4.0 * v0 - 2.0 * v1, 3.0 * (v0 + v1) - 6.0 * slope, 0.0] }
    }

    /// x' at θ.
    pub fn rate(&self, theta: f64) -> f64 {
        self.u.iter().rev().fold(0.0, |sum, u| sum * theta + u)
    }

    /// ∫ x' over the whole step.
    pub fn travel(&self) -> f64 {
        let [u0, u1, u2, u3] = self.u;
        self.h * (u0 + u1 / 2.0 + u2 / 3.0 + u3 / 4.0)
    }

    /// ∫ x' from the start of the step to θ.
    pub fn travel_until(&self, theta: f64) -> f64 {
        let [u0, u1, u2, u3] = self.u;
        self.h * theta * (u0 + theta * (u1 / 2.0 + theta * (u2 / 3.0 + theta * u3 / 4.0)))
    }

    /// x'' at θ; 0 for a step without length.
    pub fn bend(&self, theta: f64) -> f64 {
        let [_, u1, u2, u3] = self.u;
        if self.h == 0.0 { 0.0 } else { (u1 + theta * (2.0 * u2 + theta * 3.0 * u3)) / self.h }
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
    /// 1/real eigenvalue of A⁻¹ of Radau IIA(5).
    const GAMMA_0: f64 = 0.274_888_829_595_676_8;
    let cubic: f64 = (0..4).map(|k| TABLEAU.rates[3][k] * values[k]).sum();
    (GAMMA_0 * RADAU_NODES[0] * RADAU_NODES[1] * cubic).abs()
}

/// Coefficients of θ^p, p = 0…4, of θ(θ − c_1)(θ − c_2)(θ − 1), which vanishes where the cubic of the rates is exact.
pub(super) const NODE_POLYNOMIAL: [f64; 5] = {
    let [c1, c2, _] = RADAU_NODES;
    [0.0, -c1 * c2, c1 * c2 + c1 + c2, -(1.0 + c1 + c2), 1.0]
};

/// p!/Γ(p+2−alpha), p = 0…4: the exact kernel against θ^p.
pub fn local_factors(alpha: f64) -> [f64; 5] {
    let mut factors = [1.0 / gamma(2.0 - alpha), 0.0, 0.0, 0.0, 0.0];
    for p in 1..5 {
        factors[p] = factors[p - 1] * p as f64 / (p as f64 + 1.0 - alpha);
    }
    factors
}

/// Inverse Vandermonde matrices of the Radau nodes.
pub(super) struct Tableau {
    /// Of (0, c_1, c_2, 1): u_p = Σ_k rates[p][k] x'_k.
    pub(super) rates: [[f64; 4]; 4],
    /// Of [c_j^p], p = 1…3: coefficient of θ^{p+1} in x is Σ_j strokes[p][j] (x_j − x_0).
    pub(super) strokes: [[f64; 3]; 3],
}

pub(super) static TABLEAU: LazyLock<Tableau> = LazyLock::new(|| {
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
    fn polynomials_reproduce_their_data() {
        let rate = [0.3, -1.2, 0.7, 2.0];
        let p = RatePolynomial::through_rates(0.1, Nodes::Radau, &rate);
        let at = |theta: f64| p.u.iter().rev().fold(0.0, |sum, u| sum * theta + u);
        for (c, r) in [0.0].iter().chain(&RADAU_NODES).zip(rate) {
            assert!((at(*c) - r).abs() < 1e-14);
        }
        // x = 1 + 2t − t² + 4t³ is reproduced by strokes and by Hermite.
        let x = |t: f64| 1.0 + 2.0 * t - t * t + 4.0 * t.powi(3);
        let v = |t: f64| 2.0 - 2.0 * t + 12.0 * t * t;
        let h = 0.5;
        let strokes: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| x(c * h)).collect();
        let s = RatePolynomial::through_strokes(h, Nodes::Radau, &strokes);
        let m = RatePolynomial::hermite(h, [x(0.0), x(h)], [v(0.0), v(h)]);
        for p in 0..4 {
            let exact = [2.0, -2.0 * h, 12.0 * h * h, 0.0][p];
            assert!((s.u[p] - exact).abs() < 1e-13 && (m.u[p] - exact).abs() < 1e-13);
        }
    }

    #[test]
    fn radau_weights_are_exact_to_degree_four() {
        for p in 0..5 {
            let sum: f64 = (0..3).map(|i| RADAU_WEIGHTS[i] * RADAU_NODES[i].powi(p)).sum();
            assert!((sum - 1.0 / (p + 1) as f64).abs() < 1e-15);
        }
    }
}
