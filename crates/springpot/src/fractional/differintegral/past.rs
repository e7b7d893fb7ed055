//! The past of y = x⁽ᵐ⁾ as exponentials: I^beta y at the end of a piece is its own exact share and Σ_k w_k e^{−λ_k h}
//! z_k.

use super::order::Order;
use crate::fractional::kernel::{Kernel, KernelError};

/// Relative error of the kernel t^{beta−1}/Γ(beta) as a sum of exponentials, where nothing else is asked for.
pub(super) const KERNEL_TOLERANCE: f64 = 1e-12;

/// Modes side by side; what is missing to a whole block has weight 0.
const LANES: usize = 8;
type Block = [f64; LANES];

/// Exponentials with their lags z_k = ∫ e^{−λ_k(t−s)} y(s) ds.
#[derive(Debug, Clone)]
pub(super) struct Past {
    pub(super) kernel: Kernel,
    pub(super) z: Vec<f64>,
    /// The last piece, from which faster modes are made.
    last: (f64, Vec<f64>),
    table: Table,
}

/// e^{−λh}, w e^{−λh} and h ψ_p(λh) of every mode for one width h; the moments of a block stand together.
#[derive(Debug, Clone, Default)]
struct Table {
    width: f64,
    decay: Vec<Block>,
    weighted: Vec<Block>,
    moments: Vec<Block>,
}

impl Past {
    /// For pieces from `shortest` on, up to `horizon`, with a kernel that errs by `tolerance`.
    pub(super) fn new(order: &Order, shortest: f64, horizon: f64, tolerance: f64) -> Result<Self, KernelError> {
        // A single piece has no past, but the kernel wants an interval.
        let kernel = Kernel::new(order.alpha, tolerance, shortest, horizon.max(2.0 * shortest))?;
        let z = vec![0.0; kernel.modes()];
        Ok(Self { kernel, z, last: (0.0, Vec::new()), table: Table::default() })
    }

    /// Σ_k w_k e^{−λ_k h} z_k at the end of a piece, which it then takes into the past; `slack` is the rounding of its
    /// width.
    pub(super) fn advance(&mut self, width: f64, y: &[f64], slack: f64) -> f64 {
        self.extend(width);
        self.table.set(&self.kernel, width, y.len(), slack);
        self.z.resize(LANES * self.table.decay.len(), 0.0);
        let z = self.z.as_chunks_mut().0;
        // The lengths of the splines at orders below 1 and −1, unrolled; any other in a loop.
        let history = match y.len() {
            3 => self.table.advance::<3>(z, y),
            5 => self.table.advance::<5>(z, y),
            count => self.table.advance_by(count, z, y),
        };
        self.last.0 = width;
        self.last.1.clear();
        self.last.1.extend_from_slice(y);
        history
    }

    /// Puts the faster modes that shorter pieces need in front: what they remember lies within the last piece.
    fn extend(&mut self, lag: f64) {
        let modes = self.kernel.modes();
        let rates = self.kernel.extend(lag);
        if rates.is_empty() {
            return;
        }
        let (width, y) = &self.last;
        let mut psi = vec![0.0; y.len()];
        let lags: Vec<f64> = rates
            .iter()
            .map(|lambda| {
                exponential_moments(lambda * width, &mut psi);
                width * psi.iter().zip(y).map(|(psi, c)| psi * c).sum::<f64>()
            })
            .collect();
        self.z.truncate(modes);
        self.z.splice(0..0, lags);
        self.table.width = 0.0;
    }
}

impl Table {
    fn advance<const COUNT: usize>(&self, z: &mut [Block], y: &[f64]) -> f64 {
        self.advance_by(COUNT, z, &y[..COUNT])
    }

    /// Σ w e^{−λh} z, and z of the end of a piece with `count` coefficients.
    #[inline(always)]
    fn advance_by(&self, count: usize, z: &mut [Block], y: &[f64]) -> f64 {
        let mut sums = [0.0; LANES];
        let blocks = z.iter_mut().zip(&self.decay).zip(&self.weighted).zip(self.moments.chunks_exact(count));
        for (((z, decay), weighted), moments) in blocks {
            let mut next = [0.0; LANES];
            for l in 0..LANES {
                sums[l] += weighted[l] * z[l];
                next[l] = decay[l] * z[l];
            }
            for p in 0..count {
                for l in 0..LANES {
                    next[l] += y[p] * moments[p][l];
                }
            }
            *z = next;
        }
        sums.iter().sum()
    }

    fn set(&mut self, kernel: &Kernel, width: f64, count: usize, slack: f64) {
        let blocks = kernel.modes().div_ceil(LANES);
        if (width - self.width).abs() <= slack + 1e-12 * width && self.moments.len() == blocks * count {
            return;
        }
        self.width = width;
        for (column, length) in [(&mut self.decay, 1), (&mut self.weighted, 1), (&mut self.moments, count)] {
            column.clear();
            column.resize(blocks * length, [0.0; LANES]);
        }
        let mut psi = vec![0.0; count];
        for (k, (lambda, weight)) in kernel.lambda.iter().zip(&kernel.weight).enumerate() {
            let (block, lane) = (k / LANES, k % LANES);
            let decay = (-lambda * width).exp();
            self.decay[block][lane] = decay;
            self.weighted[block][lane] = weight * decay;
            exponential_moments(lambda * width, &mut psi);
            for (moments, psi) in self.moments[block * count..].iter_mut().zip(&psi) {
                moments[lane] = width * psi;
            }
        }
    }
}

/// ψ_p(X) = ∫₀¹ e^{−X(1−θ)} θ^p dθ for X ≥ 0 and p = 0 … psi.len() − 1.
///
/// ψ_p = (1 − pψ_{p−1})/X upwards while p ≤ X, ψ_{p−1} = (1 − Xψ_p)/p downwards from the series of the last one while p
/// > X: no step enlarges an error.
pub(super) fn exponential_moments(x: f64, psi: &mut [f64]) {
    let Some(last) = psi.len().checked_sub(1) else { return };
    // First p that comes from above.
    let meeting = if x >= last as f64 { last + 1 } else { x as usize + 1 };
    if x >= 1.0 {
        psi[0] = -(-x).exp_m1() / x;
        for p in 1..meeting.min(last + 1) {
            psi[p] = (1.0 - p as f64 * psi[p - 1]) / x;
        }
    }
    if meeting > last && x >= 1.0 {
        return;
    }
    // ψ_P = 1/(P+1) (1 − X/(P+2) (1 − X/(P+3) (…))); the factors left out multiply to less than one ulp.
    let mut series = 0.0;
    for m in (0..16 + 3 * x as usize).rev() {
        series = (1.0 - x * series) / (last + 1 + m) as f64;
    }
    psi[last] = series;
    let lowest = if x >= 1.0 { meeting } else { 0 };
    for p in (lowest..last).rev() {
        psi[p] = (1.0 - x * psi[p + 1]) / (p + 1) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_meet_their_integrals() {
        let integral = |x: f64, p: i32| {
            let rule = |panels: usize| -> f64 {
                (0..panels)
                    .map(|k| {
                        let theta = (k as f64 + 0.5) / panels as f64;
                        (-x * (1.0 - theta)).exp() * theta.powi(p)
                    })
                    .sum::<f64>()
                    / panels as f64
            };
            (4.0 * rule(4000) - rule(2000)) / 3.0
        };
        for count in [1, 4, 7, 18] {
            for x in [0.0, 1e-9, 0.3, 0.999, 1.0, 1.5, 2.999, 3.0, 3.001, 6.5, 16.9, 17.0, 17.1, 60.0] {
                let mut psi = vec![0.0; count];
                exponential_moments(x, &mut psi);
                for (p, psi) in psi.iter().enumerate() {
                    let expected = integral(x, p as i32);
                    assert!((psi / expected - 1.0).abs() < 2e-8, "psi_{p}({x}) = {psi}, not {expected}");
                }
                // To the last digits: the first four by another road, the rest by the recurrence that binds them.
                for (psi, other) in psi.iter().zip(crate::fractional::step::exponential_moments(x)) {
                    assert!((psi / other - 1.0).abs() < 2e-14, "{x}: {psi} {other}");
                }
                for p in 1..count {
                    assert!((p as f64 * psi[p - 1] + x * psi[p] - 1.0).abs() < 1e-14, "psi_{p}({x})");
                }
            }
        }
    }
}
