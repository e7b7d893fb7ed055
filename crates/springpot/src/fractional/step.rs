//! The polynomial that stands for x' over one step of size h.
//!
//! With θ = (t − t_n)/h, x'(θ) = Σ_p u_p θ^p, p = 0…3, or 0…6 where x and x' are known. Against this polynomial the kernel is exact:
//! 1/Γ(1−alpha) ∫ (t−s)^−alpha x'(s) ds from t_n to t_n + θh = h^{1−alpha} Σ_p u_p p!/Γ(p+2−alpha) θ^{p+1−alpha}.

use super::gamma::gamma;
use crate::collocation::inner;
use crate::collocation::{Gaps, Nodes, Places, RADAU_NODES, STAGES, TABLEAU};
use serde::{Deserialize, Serialize};

/// Which data of the step determine the polynomial of x'.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// x' at 0 and at the nodes (in the middle alone with [`Nodes::Midpoint`]); order 5 − alpha along a given motion with Radau
    /// nodes.
    Rates,
    /// x at 0 and at the nodes; order 4 − alpha with Radau nodes, 2 − alpha (the L1 scheme) with one.
    Strokes,
    /// x and x' at 0 and at the three nodes of a step: the polynomial of degree 7 that has both; order 8 − alpha along a given motion.
    Hermite,
}

/// Number of coefficients of a polynomial of rates or of strokes.
pub(crate) const CUBIC: usize = 4;

/// Number of coefficients of a polynomial that has both.
pub(crate) const SEXTIC: usize = 7;

impl Form {
    /// How many coefficients its polynomials have.
    pub(crate) fn coefficients(self) -> usize {
        match self {
            Self::Rates | Self::Strokes => CUBIC,
            Self::Hermite => SEXTIC,
        }
    }
}

/// x' over one step as a polynomial of θ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RatePolynomial {
    /// Step size, s.
    pub h: f64,
    /// Coefficients u_p of θ^p; those above θ³ are 0 but with [`Form::Hermite`].
    pub u: [f64; SEXTIC],
}

impl RatePolynomial {
    /// Through x' at 0 and at the nodes (s + 1 values): the cubic for Radau, the straight line for one
    /// node at the end, the constant for one in the middle; the cubic through the nodes alone where there are four.
    pub fn through_rates(h: f64, nodes: Nodes, rate: &[f64]) -> Self {
        Self::cubic(
            h,
            match nodes {
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
            },
        )
    }

    /// With these coefficients of θ^p, p = 0…3.
    pub fn cubic(h: f64, [a, b, c, d]: [f64; CUBIC]) -> Self {
        Self { h, u: [a, b, c, d, 0.0, 0.0, 0.0] }
    }

    /// Of a step without length.
    pub(crate) const NONE: Self = Self { h: 0.0, u: [0.0; SEXTIC] };

    /// Through x' at 0 and at the three nodes of a step, with the integrals that x there tells (4 values each): of degree 6 ([`Form::Hermite`]).
    pub fn through_strokes_and_rates(h: f64, places: Option<&Places>, known: [&[f64]; 2]) -> Self {
        Self::through_both(h, (places, &Gaps::at(places)), known)
    }

    /// The same, where the gaps of such nodes are known.
    pub(super) fn through_both(
        h: f64,
        (places, Gaps { node_polynomial, inverse }): (Option<&Places>, &Gaps),
        [stroke, rate]: [&[f64]; 2],
    ) -> Self {
        let mut polynomial = match places {
            None => Self::through_rates(h, Nodes::Radau, rate),
            Some(places) => Self::through_rates_at(h, places, rate),
        };
        let gaps = polynomial.gaps(places, stroke).map(|gap| gap / h);
        for (k, row) in inverse.iter().enumerate() {
            let factor: f64 = row.iter().zip(gaps).map(|(weight, gap)| weight * gap).sum();
            polynomial.u[k..].iter_mut().zip(node_polynomial).for_each(|(u, node)| *u += factor * node);
        }
        polynomial
    }

    /// How far x at the three nodes is from x at 0 and its own integral until there.
    pub(crate) fn gaps(&self, places: Option<&Places>, stroke: &[f64]) -> [f64; STAGES] {
        let positions = places.map_or(RADAU_NODES, |places| *places.positions());
        std::array::from_fn(|j| (stroke[j + 1] - stroke[0]) - self.travel_until(positions[j]))
    }

    /// Its coefficients, without zeros above θ³.
    pub(crate) fn coefficients(&self) -> &[f64] {
        let (cubic, higher) = self.u.split_at(CUBIC);
        if higher.iter().all(|u| *u == 0.0) { cubic } else { &self.u }
    }

    /// From x at 0 and at the nodes (s + 1 values): the derivative of the interpolating polynomial.
    pub fn through_strokes(h: f64, nodes: Nodes, stroke: &[f64]) -> Self {
        let mut u = [0.0; CUBIC];
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
        Self::cubic(h, u)
    }

    /// As [`Self::through_rates`] of a step with three nodes at `places`.
    pub fn through_rates_at(h: f64, places: &Places, rate: &[f64]) -> Self {
        Self::cubic(h, places.values.map(|row| row.iter().zip(rate).map(|(weight, rate)| weight * rate).sum()))
    }

    /// As [`Self::through_strokes`] of a step with three nodes at `places`.
    pub fn through_strokes_at(h: f64, places: &Places, stroke: &[f64]) -> Self {
        let mut u = [0.0; CUBIC];
        for p in 0..3 {
            let coefficient: f64 = (1..4).map(|j| places.values[p + 1][j] * (stroke[j] - stroke[0])).sum();
            u[p] = (p + 1) as f64 * coefficient / h;
        }
        Self::cubic(h, u)
    }

    /// The derivative of the cubic Hermite polynomial of (x, x') at both ends; order 4 − alpha.
    pub fn hermite(h: f64, stroke: [f64; 2], rate: [f64; 2]) -> Self {
        let slope = (stroke[1] - stroke[0]) / h;
        let [v0, v1] = rate;
        Self::cubic(h, [v0, 6.0 * slope - 4.0 * v0 - 2.0 * v1, 3.0 * (v0 + v1) - 6.0 * slope, 0.0])
    }

    /// x' at θ.
    pub fn rate(&self, theta: f64) -> f64 {
        self.u.iter().rev().fold(0.0, |sum, u| sum * theta + u)
    }

    /// ∫ x' over the whole step.
    pub fn travel(&self) -> f64 {
        let [u0, u1, u2, u3, u4, u5, u6] = self.u;
        self.h * (u0 + u1 / 2.0 + u2 / 3.0 + u3 / 4.0 + u4 / 5.0 + u5 / 6.0 + u6 / 7.0)
    }

    /// ∫ x' from the start of the step to θ.
    pub fn travel_until(&self, theta: f64) -> f64 {
        let [u0, u1, u2, u3, u4, u5, u6] = self.u;
        let higher = theta * (u4 / 5.0 + theta * (u5 / 6.0 + theta * u6 / 7.0));
        self.h * theta * (u0 + theta * (u1 / 2.0 + theta * (u2 / 3.0 + theta * (u3 / 4.0 + higher))))
    }

    /// x'' at θ; 0 for a step without length.
    pub fn bend(&self, theta: f64) -> f64 {
        if self.h == 0.0 {
            return 0.0;
        }
        let [_, u1, u2, u3, u4, u5, u6] = self.u;
        let higher = theta * theta * (4.0 * u4 + theta * (5.0 * u5 + theta * 6.0 * u6));
        (u1 + theta * (2.0 * u2 + (theta * 3.0 * u3 + higher))) / self.h
    }

    /// The third derivative of x at θ; 0 for a step without length.
    pub(crate) fn turn(&self, theta: f64) -> f64 {
        if self.h == 0.0 {
            return 0.0;
        }
        let [_, _, u2, u3, u4, u5, u6] = self.u;
        let higher = theta * theta * (12.0 * u4 + theta * (20.0 * u5 + theta * 30.0 * u6));
        (2.0 * u2 + (theta * 6.0 * u3 + higher)) / (self.h * self.h)
    }

    /// The coefficients of x''.
    pub(crate) fn bent(&self) -> [f64; SEXTIC] {
        std::array::from_fn(|p| self.u.get(p + 1).map_or(0.0, |u| (p + 1) as f64 * u / self.h))
    }
}

/// p!/Γ(p+2−alpha), p = 0…6: the exact kernel against θ^p.
pub fn local_factors(alpha: f64) -> [f64; SEXTIC] {
    let mut factors = [0.0; SEXTIC];
    factors[0] = 1.0 / gamma(2.0 - alpha);
    for p in 1..SEXTIC {
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
        for p in 0..CUBIC {
            let exact = [2.0, -2.0 * h, 12.0 * h * h, 0.0][p];
            assert!((s.u[p] - exact).abs() < 1e-13 && (m.u[p] - exact).abs() < 1e-13);
        }
    }

    #[test]
    fn strokes_and_rates_reproduce_degree_seven() {
        let (h, x) =
            (0.4, |t: f64| [1.0, -2.0, 0.5, 3.0, -1.5, 2.0, 0.7, -1.1].iter().rev().fold(0.0, |sum, c| sum * t + c));
        let rate =
            |t: f64| [-2.0, 2.0 * 0.5, 9.0, -6.0, 10.0, 4.2, -7.7].iter().rev().fold(0.0, |sum: f64, c| sum * t + c);
        for places in [None, Some(Places::new([0.22, 0.7, 1.0]))] {
            let nodes = places.as_ref().map_or(RADAU_NODES, |places| *places.positions());
            let at = |of: &dyn Fn(f64) -> f64| [0.0].iter().chain(&nodes).map(|c| of(c * h)).collect::<Vec<_>>();
            let known = [&at(&x)[..], &at(&rate)];
            let p = RatePolynomial::through_strokes_and_rates(h, places.as_ref(), known);
            for theta in [0.0, 0.1, 0.37, 0.8, 1.0] {
                let t = theta * h;
                assert!((p.rate(theta) - rate(t)).abs() < 1e-11, "{theta}: {} {}", p.rate(theta), rate(t));
                assert!((p.travel_until(theta) - (x(t) - x(0.0))).abs() < 1e-12);
            }
            assert!((p.travel() - p.travel_until(1.0)).abs() < 1e-15);
        }
    }
}
