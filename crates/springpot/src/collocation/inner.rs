//! Radau IIA with four stages, and the ways between its nodes and those of three stages (Hairer & Wanner, Solving ODEs II, IV.5).
//!
//! The strokes inside a series bend more than the stroke of the whole: with one node more than the step they are known one order better.

use super::{Places, RADAU_NODES, STAGES, TABLEAU, integral, lagrange_coefficients, slope, value};
use std::sync::LazyLock;

/// The roots of 35θ³ − 45θ² + 15θ − 1, and 1.
pub(crate) const NODES: [f64; 4] = [0.088_587_959_512_703_95, 0.409_466_864_440_734_7, 0.787_659_461_760_847, 1.0];

const COUNT: usize = NODES.len();

/// The Lagrange polynomials of 0 and three nodes.
type Lagrange = [[f64; STAGES + 1]; STAGES + 1];

/// The polynomial through the values at the nodes, at θ: their weights.
pub(crate) fn outer_row(theta: f64) -> [f64; COUNT] {
    std::array::from_fn(|j| value(&TABLEAU_OF_FOUR.rates, j, theta))
}

/// What a step with three stages knows, brought to a place in it: weights of x at 0 and at the three nodes, and of h·x'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weights {
    pub(crate) stroke: [f64; STAGES + 1],
    pub(crate) rate: [f64; STAGES + 1],
}

/// Matrices of the nodes.
pub(crate) struct Tableau {
    /// A: x_i − x_0 = h Σ_j A_ij x'_j.
    pub(crate) matrix: [[f64; COUNT]; COUNT],
    /// A⁻¹.
    pub(crate) inverse: [[f64; COUNT]; COUNT],
    /// The polynomial through the values at 0 and at the nodes: coefficient of θ^p is Σ_k values[p][k] f_k.
    pub(crate) values: [[f64; COUNT + 1]; COUNT + 1],
    /// That through the values at the nodes alone.
    pub(crate) rates: [[f64; COUNT]; COUNT],
    /// The latter at the nodes of three stages.
    pub(crate) outer: [[f64; COUNT]; STAGES],
    /// Rates, times h, at 0 and at the nodes of the cubic through x at 0 and at all nodes but the first: by x_j − x_0.
    pub(crate) embedded: [[f64; COUNT]; COUNT + 1],
    /// Strokes of three stages at these nodes: of the cubic through them; of that through the rates; of the polynomial of degree 7 through both.
    pub(crate) by_strokes: [Weights; COUNT],
    pub(crate) by_rates: [Weights; COUNT],
    pub(crate) by_both: [Weights; COUNT],
}

pub(crate) static TABLEAU_OF_FOUR: LazyLock<Tableau> = LazyLock::new(|| {
    let [c1, c2, c3, end] = NODES;
    let values = lagrange_coefficients([0.0, c1, c2, c3, end]);
    let rates = lagrange_coefficients(NODES);
    let [_, second, third, last] = lagrange_coefficients([0.0, c2, c3, end]).map(|row| [0.0, row[1], row[2], row[3]]);
    Tableau {
        matrix: NODES.map(|c| std::array::from_fn(|j| integral(&rates, j, c))),
        inverse: NODES.map(|c| std::array::from_fn(|j| slope(&values, j + 1, c))),
        values,
        rates,
        outer: RADAU_NODES.map(|c| std::array::from_fn(|j| value(&rates, j, c))),
        embedded: [0.0, c1, c2, c3, end]
            .map(|c| std::array::from_fn(|j| second[j] + c * (2.0 * third[j] + 3.0 * c * last[j]))),
        by_strokes: NODES.map(Weights::by_strokes),
        by_rates: NODES.map(Weights::by_rates),
        by_both: NODES.map(Weights::by_both),
    }
});

impl Weights {
    /// Of the cubic through the strokes.
    pub(crate) fn by_strokes(theta: f64) -> Self {
        Self::strokes_at(&TABLEAU.rates, theta)
    }

    /// Of the polynomial of degree 4 whose rates are the cubic through the rates.
    pub(crate) fn by_rates(theta: f64) -> Self {
        Self::rates_at(&TABLEAU.rates, theta)
    }

    /// Of the polynomial of degree 7 that has both.
    pub(crate) fn by_both(theta: f64) -> Self {
        Self::both_at(&TABLEAU.rates, &RADAU_NODES, theta)
    }

    /// As [`Self::by_strokes`] of a step with three nodes at `places`.
    pub(crate) fn by_strokes_at(places: &Places, theta: f64) -> Self {
        Self::strokes_at(&places.values, theta)
    }

    /// As [`Self::by_rates`] of a step with three nodes at `places`.
    pub(crate) fn by_rates_at(places: &Places, theta: f64) -> Self {
        Self::rates_at(&places.values, theta)
    }

    /// As [`Self::by_both`] of a step with three nodes at `places`.
    pub(crate) fn by_both_at(places: &Places, theta: f64) -> Self {
        Self::both_at(&places.values, places.positions(), theta)
    }

    fn strokes_at(lagrange: &Lagrange, theta: f64) -> Self {
        Self { stroke: std::array::from_fn(|k| value(lagrange, k, theta)), rate: [0.0; STAGES + 1] }
    }

    fn rates_at(lagrange: &Lagrange, theta: f64) -> Self {
        let rate = std::array::from_fn(|k| integral(lagrange, k, theta));
        Self { stroke: [1.0, 0.0, 0.0, 0.0], rate }
    }

    fn both_at(lagrange: &Lagrange, nodes: &[f64; STAGES], theta: f64) -> Self {
        let points = [0.0, nodes[0], nodes[1], nodes[2]];
        let of = |k: usize| {
            let (apart, square) = (theta - points[k], value(lagrange, k, theta).powi(2));
            [(1.0 - 2.0 * apart * slope(lagrange, k, points[k])) * square, apart * square]
        };
        Self { stroke: std::array::from_fn(|k| of(k)[0]), rate: std::array::from_fn(|k| of(k)[1]) }
    }

    /// x there, of x and h·x' at 0 and at the three nodes.
    pub(crate) fn apply(&self, stroke: impl Fn(usize) -> f64, rate: impl Fn(usize) -> f64) -> f64 {
        // The weights of the strokes add up to 1: no digits are lost where they hardly differ.
        let moved: f64 = (1..=STAGES).map(|k| self.stroke[k] * (stroke(k) - stroke(0))).sum();
        stroke(0) + moved + (0..=STAGES).map(|k| self.rate[k] * rate(k)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_brought_over_whole() {
        let tableau = &*TABLEAU_OF_FOUR;
        let points = [0.0, RADAU_NODES[0], RADAU_NODES[1], RADAU_NODES[2]];
        for p in 0..8 {
            let (x, v) = (|t: f64| t.powi(p), |t: f64| if p == 0 { 0.0 } else { f64::from(p) * t.powi(p - 1) });
            for (i, c) in NODES.into_iter().enumerate() {
                let whole = |weights: &Weights| weights.apply(|k| x(points[k]), |k| v(points[k]));
                let misses = [
                    (3, whole(&tableau.by_strokes[i]) - x(c)),
                    (4, whole(&tableau.by_rates[i]) - x(c)),
                    (7, whole(&tableau.by_both[i]) - x(c)),
                    (4, (0..4).map(|j| tableau.inverse[i][j] * (x(NODES[j]) - x(0.0))).sum::<f64>() - v(c)),
                    (4, x(0.0) + (0..4).map(|j| tableau.matrix[i][j] * v(NODES[j])).sum::<f64>() - x(c)),
                    (3, (0..4).map(|j| tableau.embedded[i + 1][j] * (x(NODES[j]) - x(0.0))).sum::<f64>() - v(c)),
                ];
                for (k, (degree, miss)) in misses.into_iter().enumerate() {
                    // At the end they all are quadratures of a higher degree.
                    let is_exact = miss.abs() < 2e-14;
                    assert!(if p <= degree { is_exact } else { i == 3 || !is_exact }, "{p} {i} {k}: {miss:e}");
                }
            }
            for (row, c) in tableau.outer.iter().zip(RADAU_NODES) {
                let miss = row.iter().zip(NODES).map(|(weight, node)| weight * x(node)).sum::<f64>() - x(c);
                assert!((miss.abs() < 2e-14) == (p <= 3 || c == 1.0), "{p} {c}: {miss:e}");
            }
        }
    }
}
