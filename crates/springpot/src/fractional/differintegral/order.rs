//! Every order is an integral of order beta, 0 ≤ beta < 1, of a piecewise polynomial y:
//!
//! D^a x = I^beta y + jumps, y = x⁽ᵐ⁾, m = ⌈a⌉, beta = m − a; x⁽⁻¹⁾ and x⁽⁻²⁾ are running integrals from 0.

use super::definition::Definition;
use super::error::DerivativeError;
use crate::fractional::gamma::reciprocal_gamma;

/// An order from −2 to 2, split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Order {
    pub(super) order: f64,
    /// m = ⌈a⌉.
    pub(super) whole: i32,
    /// 1 − beta in (0, 1]; 1 where a is an integer and no kernel is left.
    pub(super) alpha: f64,
}

impl Order {
    pub(super) fn new(order: f64) -> Result<Self, DerivativeError> {
        if !(-2.0..=2.0).contains(&order) {
            return Err(DerivativeError::Order(order));
        }
        let ceiling = order.ceil();
        let whole = ceiling as i32;
        // What rounds to an integer without being one keeps a kernel.
        let alpha = if order == ceiling { 1.0 } else { (order - (ceiling - 1.0)).min(1.0 - f64::EPSILON) };
        Ok(Self { order, whole, alpha })
    }

    pub(super) fn is_integer(&self) -> bool {
        self.alpha == 1.0
    }

    pub(super) fn beta(&self) -> f64 {
        1.0 - self.alpha
    }

    /// Whether jumps of x or x' leave an infinite derivative behind.
    pub(super) fn is_singular(&self) -> bool {
        self.order > 0.0 && !self.is_integer()
    }

    /// p!/Γ(p+1+beta) for p = 0 … count − 1: I^beta θ^p at θ = 1.
    pub(super) fn factors(&self, count: usize) -> Vec<f64> {
        let mut factor = reciprocal_gamma(1.0 + self.beta());
        (0..count)
            .map(|p| {
                if p > 0 {
                    factor *= p as f64 / (p as f64 + self.beta());
                }
                factor
            })
            .collect()
    }

    /// Coefficients of y on a piece of width h from those of x; `running` holds ∫x and ∫∫x up to its start and is moved
    /// on to its end.
    pub(super) fn lower(&self, h: f64, x: &[f64], running: &mut [f64; 2], y: &mut Vec<f64>) {
        y.clear();
        match self.whole {
            0 => y.extend_from_slice(x),
            1 => {
                let per_width = 1.0 / h;
                y.extend(x.iter().enumerate().skip(1).map(|(p, c)| p as f64 * c * per_width));
            }
            2 => y.extend(x.iter().enumerate().skip(2).map(|(p, c)| (p * (p - 1)) as f64 * c / (h * h))),
            -1 => {
                y.push(running[0]);
                y.extend(x.iter().enumerate().map(|(p, c)| h * c / (p + 1) as f64));
                running[0] = y.iter().sum();
            }
            _ => {
                let first = |p: usize, c: f64| h * c / (p + 1) as f64;
                y.extend([running[1], h * running[0]]);
                y.extend(x.iter().enumerate().map(|(p, c)| h * first(p, *c) / (p + 2) as f64));
                running[0] += x.iter().enumerate().map(|(p, c)| first(p, *c)).sum::<f64>();
                running[1] = y.iter().sum();
            }
        }
        if y.is_empty() {
            y.push(0.0);
        }
    }
}

/// A jump of x and of x' at one time, and what D^a makes of it: J (t−τ)^−a/Γ(1−a) + K (t−τ)^{1−a}/Γ(2−a).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jump {
    pub(super) t: f64,
    /// Factor of (t−τ)^−a.
    value: f64,
    /// Factor of (t−τ)^{1−a}.
    slope: f64,
    order: f64,
}

impl Jump {
    /// Of x by `value` and x' by `slope`; nothing where the order leaves no trace of them.
    pub(super) fn new(order: &Order, t: f64, value: f64, slope: f64) -> Option<Self> {
        let a = order.order;
        let slope = if order.whole == 2 { slope * reciprocal_gamma(2.0 - a) } else { 0.0 };
        let value = value * reciprocal_gamma(1.0 - a);
        (order.is_singular() && (value != 0.0 || slope != 0.0)).then_some(Self { t, value, slope, order: a })
    }

    /// The start of x at t = 0: `None` for Caputo, and where x(0), x'(0) are 0 or what rounding leaves of it.
    pub(super) fn start(order: &Order, definition: Definition, value: f64, slope: f64) -> Option<Self> {
        if definition == Definition::Caputo { None } else { Self::new(order, 0.0, value, slope) }
    }

    /// At t > τ.
    pub(super) fn at(&self, t: f64) -> f64 {
        let lag = t - self.t;
        let power = lag.powf(-self.order);
        (self.value + self.slope * lag) * power
    }
}
