//! D^a along pieces, one after the other: constant time for each.

use crate::fractional::differintegral::error::DerivativeError;
use crate::fractional::differintegral::order::Order;
use crate::fractional::history::History;
use crate::fractional::kernel::{Kernel, KernelError};

/// Relative error of the kernel t^{beta−1}/Γ(beta) as a sum of exponentials, where nothing else is asked for.
pub(in crate::fractional::differintegral) const KERNEL_TOLERANCE: f64 = 1e-12;

/// Most coefficients of a piece of y.
const MOST: usize = 8;

/// I^beta x⁽ᵐ⁾ at the ends of pieces of x.
#[derive(Debug, Clone)]
pub(in crate::fractional::differintegral) struct March {
    order: Order,
    /// None where the order is an integer.
    past: Option<History>,
    running: [f64; 2],
    factors: Vec<f64>,
    y: Vec<f64>,
    /// h^beta of the last width.
    scale: (f64, f64),
}

impl March {
    /// For pieces from `shortest` on, up to `horizon`, with a kernel that errs by `tolerance`.
    pub(in crate::fractional::differintegral) fn new(
        order: Order,
        shortest: f64,
        horizon: f64,
        tolerance: f64,
    ) -> Result<Self, DerivativeError> {
        let past = if order.is_integer() { None } else { Some(past_of(&order, shortest, horizon, tolerance)?) };
        let (factors, y) = (order.factors(MOST), Vec::with_capacity(MOST));
        Ok(Self { order, past, running: [0.0; 2], factors, y, scale: (0.0, 0.0) })
    }

    /// The value at the end of the next piece of x, given by its coefficients in powers of θ; `end` is its time.
    pub(in crate::fractional::differintegral) fn advance(&mut self, width: f64, x: &[f64], end: f64) -> f64 {
        self.order.lower(width, x, &mut self.running, &mut self.y);
        let Some(past) = &mut self.past else { return self.y.iter().sum() };
        // Equal steps differ by the rounding of their times.
        let slack = 4.0 * f64::EPSILON * end;
        if (width - self.scale.0).abs() > slack {
            self.scale = (width, width.powf(self.order.beta()));
        }
        let local: f64 = self.y.iter().zip(&self.factors).map(|(c, factor)| c * factor).sum();
        past.extend(width);
        self.scale.1 * local + past.advance(width, &self.y, slack + 1e-12 * width)
    }
}

/// An empty past of pieces from `shortest` on, up to `horizon`, with a kernel that errs by `tolerance`.
pub(in crate::fractional::differintegral) fn past_of(
    order: &Order,
    shortest: f64,
    horizon: f64,
    tolerance: f64,
) -> Result<History, KernelError> {
    // A single piece has no past, but the kernel wants an interval.
    Ok(History::new(Kernel::new(order.alpha, tolerance, shortest, horizon.max(2.0 * shortest))?))
}
