//! Polynomials between two samples, from what is known at them.
//!
//! With θ = (t − t_j)/h the quintic is x₀ + Δ·S + h v₀·V₀ + h v₁·V₁ + h² w₀·W₀ + h² w₁·W₁, Δ = x₁ − x₀, v = x', w = x''
//! at both ends; the cubic has no w.

pub(super) mod stencil;

/// Coefficients of θ^p, p = 0 … 5.
pub(super) type Polynomial = [f64; 6];

/// Degree of the polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// From x and x' at both ends.
    Cubic,
    /// From x, x' and x'' at both ends.
    Quintic,
}

/// x, x' and x'' at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub(super) t: f64,
    pub(super) x: f64,
    pub(super) slope: f64,
    pub(super) bend: f64,
}

/// The shapes of one form: that of Δ, and those of slope and bend at the left and the right end.
pub(super) struct Shapes {
    pub(super) step: Polynomial,
    pub(super) slope: [Polynomial; 2],
    pub(super) bend: [Polynomial; 2],
}

impl Form {
    /// Number of points of its difference formulas.
    pub(super) fn points(self) -> usize {
        match self {
            Self::Cubic => stencil::CUBIC_POINTS,
            Self::Quintic => stencil::QUINTIC_POINTS,
        }
    }

    pub(super) const fn shapes(self) -> Shapes {
        match self {
            Self::Cubic => Shapes {
                step: [0.0, 0.0, 3.0, -2.0, 0.0, 0.0],
                slope: [[0.0, 1.0, -2.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 1.0, 0.0, 0.0]],
                bend: [[0.0; 6]; 2],
            },
            Self::Quintic => Shapes {
                step: [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
                slope: [[0.0, 1.0, 0.0, -6.0, 8.0, -3.0], [0.0, 0.0, 0.0, -4.0, 7.0, -3.0]],
                bend: [[0.0, 0.0, 0.5, -1.5, 1.5, -0.5], [0.0, 0.0, 0.0, 0.5, -1.0, 0.5]],
            },
        }
    }

    /// The polynomial between two samples, in powers of θ.
    pub(super) fn between(self, from: &Node, to: &Node) -> Polynomial {
        let shapes = self.shapes();
        let h = to.t - from.t;
        let data = [to.x - from.x, h * from.slope, h * to.slope, h * h * from.bend, h * h * to.bend];
        let [[v0, v1], [w0, w1]] = [shapes.slope, shapes.bend];
        let mut polynomial = [0.0; 6];
        let known = if self == Self::Cubic { 3 } else { 5 };
        for (factor, shape) in data.iter().zip([shapes.step, v0, v1, w0, w1]).take(known) {
            for (c, s) in polynomial.iter_mut().zip(shape) {
                *c += factor * s;
            }
        }
        polynomial[0] += from.x;
        polynomial
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_met() {
        let from = Node { t: 0.5, x: 1.0, slope: -2.0, bend: 3.0 };
        let to = Node { t: 0.9, x: 0.3, slope: 1.5, bend: -4.0 };
        for form in [Form::Cubic, Form::Quintic] {
            let c = form.between(&from, &to);
            let h = to.t - from.t;
            let sum = |weight: fn(f64) -> f64| -> f64 { (0..6).map(|p| weight(p as f64) * c[p]).sum() };
            assert_eq!((c[0], c[1]), (from.x, h * from.slope));
            assert!((sum(|_| 1.0) - 0.3).abs() < 1e-14 && (sum(|p| p) / h - 1.5).abs() < 1e-13);
            if form == Form::Quintic {
                assert!((2.0 * c[2] / (h * h) - 3.0).abs() < 1e-13);
                assert!((sum(|p| p * (p - 1.0)) / (h * h) + 4.0).abs() < 1e-12);
            }
        }
    }
}
