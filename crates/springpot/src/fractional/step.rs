//! The polynomial that stands for x' over one step of size h.
//!
//! With θ = (t − t_n)/h, x'(θ) = Σ_p u_p θ^p, p = 0…3. Against this polynomial the kernel is exact:
//! 1/Γ(1−alpha) ∫ (t−s)^−alpha x'(s) ds from t_n to t_n + θh = h^{1−alpha} Σ_p u_p p!/Γ(p+2−alpha) θ^{p+1−alpha}.

use super::gamma::gamma;
use crate::collocation::inner;
use crate::collocation::{Nodes, Places, RADAU_NODES, TABLEAU};
use serde::{Deserialize, Serialize};

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
    /// node at the end, the constant for one in the middle; the cubic through the nodes alone where there are four.
    pub fn through_rates(h: f64, nodes: Nodes, rate: &[f64]) -> Self {
        let u = match nodes {
            Nodes::One => [rate[0], rate[1] - rate[0], 0.0, 0.0],
            Nodes::Midpoint => [rate[1], 0.0, 0.0, 0.0],
            Nodes::Radau => {
                let inverse = &TABLEAU.rates;
                std::array::from_fn(|p| (0..4).map(|k| inverse[p][k] * rate[k]).sum())
            }
            Nodes::Inner => {
                let inverse = &inner::TABLEAU_OF_FOUR.rates;
                std::array::from_fn(|p| (0..4).map(|k| inverse[p][k] * rate[k + 1]).sum())
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
            Nodes::Inner => {
                let values = &inner::TABLEAU_OF_FOUR.values;
                for p in 0..4 {
                    let coefficient: f64 = (0..4).map(|j| values[p + 1][j + 1] * (stroke[j + 1] - stroke[0])).sum();
                    u[p] = (p + 1) as f64 * coefficient / h;
                }
            }
        }
        Self { h, u }
    }

    /// As [`Self::through_rates`] of a step with three nodes at `places`.
    pub fn through_rates_at(h: f64, places: &Places, rate: &[f64]) -> Self {
        Self { h, u: places.values.map(|row| row.iter().zip(rate).map(|(weight, rate)| weight * rate).sum()) }
    }

    /// As [`Self::through_strokes`] of a step with three nodes at `places`.
    pub fn through_strokes_at(h: f64, places: &Places, stroke: &[f64]) -> Self {
        let mut u = [0.0; 4];
        for p in 0..3 {
            let coefficient: f64 = (1..4).map(|j| places.values[p + 1][j] * (stroke[j] - stroke[0])).sum();
            u[p] = (p + 1) as f64 * coefficient / h;
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

    /// The third derivative of x at θ; 0 for a step without length.
    pub(crate) fn turn(&self, theta: f64) -> f64 {
        let [_, _, u2, u3] = self.u;
        if self.h == 0.0 { 0.0 } else { (2.0 * u2 + theta * 6.0 * u3) / (self.h * self.h) }
    }
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
}
