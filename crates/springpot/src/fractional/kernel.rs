//! The kernel t^−alpha/Γ(1−alpha) as a sum of positive exponentials with a verified error bound.
//!
//! # Why exponentials
//!
//! D^alpha x(t) = ∫₀ᵗ k(t−s) x'(s) ds with k(t) = t^−alpha/Γ(1−alpha) asks for the whole past at every time. An
//! exponential does not: ∫₀ᵗ e^{−λ(t−s)} x'(s) ds at t + h is e^{−λh} times what it was at t, and the share of the last
//! step. So with k(t) ≈ Σ_k w_k e^{−λ_k t} the past is one number for each k. Power laws need few: 36 exponentials hold
//! six decades of t to 1e-8.
//!
//! ```
//! use springpot::fractional::{Kernel, gamma::gamma};
//!
//! let kernel = Kernel::new(0.5, 1e-8, 1e-3, 1e3)?;
//! assert!(kernel.modes() <= 37 && kernel.weight.iter().all(|w| *w > 0.0));
//! for t in [1e-3, 0.1f64, 1e3] {
//!     let exact = t.powf(-0.5) / gamma(0.5);
//!     assert!((kernel.value(t) / exact - 1.0).abs() < 1e-8);
//! }
//! # Ok::<(), springpot::fractional::KernelError>(())
//! ```
//!
//! # How they are found
//!
//! With λ = e^y, t^−alpha/Γ(1−alpha) = (sin πα/π) ∫ e^{αy} exp(−e^y t) dy. The trapezoidal rule in y with step `eta`
//! errs by 2|Γ(α + 2πi/eta)|/Γ(α), relative and uniformly in t (Poisson summation). The fast end is cut where the
//! incomplete gamma function says that nothing is lost for t ≥ delta; the slow end, a geometric measure, is replaced by
//! its own Gauss rule. The number of modes grows like ln(horizon/delta)·ln(1/tolerance)/π².
//!
//! # What they mean
//!
//! Every weight is positive, so that each term is a Maxwell branch, a spring w_k in series with a dashpot w_k/λ_k, and
//! the whole is passive: what the sum misses of the kernel can never make energy.

use super::gamma::{gamma, ln_abs_gamma, ln_gamma, upper_gamma_ratio, upper_gamma_ratio_inverse};
use crate::linalg::gauss_rules;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Why a kernel could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KernelError {
    /// The order is outside (0, 1).
    #[error("a fractional kernel needs 0 < alpha < 1, not {0}")]
    Order(f64),
    /// The tolerance is outside the reach of double precision.
    #[error("the kernel tolerance must lie between 1e-13 and 0.1, not {0}")]
    Tolerance(f64),
    /// The interval is empty or not finite.
    #[error(
        "the kernel needs 0 < delta < horizon, both finite and less than 200 decades apart, \
         not delta = {delta} s and horizon = {horizon} s"
    )]
    Interval {
        /// Shortest lag, s.
        delta: f64,
        /// Longest lag, s.
        horizon: f64,
    },
    /// The sampled error exceeds the tolerance.
    #[error("the exponential kernel for alpha = {alpha} errs by {error:e}, more than {tolerance:e}")]
    Bound {
        /// Order.
        alpha: f64,
        /// Largest sampled relative error.
        error: f64,
        /// Tolerance asked for.
        tolerance: f64,
    },
}

/// t^−alpha/Γ(1−alpha) ≈ Σ_k w_k e^{−λ_k t} for delta ≤ t ≤ horizon, all w_k > 0, λ descending.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kernel {
    /// Order, 0 < alpha < 1.
    pub alpha: f64,
    /// Rates λ_k, 1/s, descending.
    pub lambda: Vec<f64>,
    /// Weights w_k, s^−alpha, all positive.
    pub weight: Vec<f64>,
    /// Step of the trapezoidal rule in ln λ.
    pub eta: f64,
    /// Shortest lag for which the bound holds, s.
    pub delta: f64,
    /// Longest lag for which the bound holds, s.
    pub horizon: f64,
    /// Bound of the relative error on [delta, horizon].
    pub tolerance: f64,
}

/// Lags at which a new kernel is compared with the power law, per period eta of the error in ln t.
const SAMPLES: usize = 8;

/// Orders below are taken for this one: t^−alpha is then 1 to rounding for any lag there is.
const SMALLEST_ORDER: f64 = f64::EPSILON;

/// Shortest delta, s, and longest horizon in units of delta: beyond them the rates overflow.
const SHORTEST: f64 = 1e-200;
const LONGEST: f64 = 1e200;

/// Rate of the fastest mode times delta, at least: what is faster must follow the shortest step, also where alpha is so small
/// that the bound needs no fast modes.
const SLOWEST_TOP: f64 = 2.0;

impl Kernel {
    /// Builds the kernel and samples its error.
    ///
    /// # Errors
    /// [`KernelError`] for an order outside (0, 1), an impossible interval or tolerance, and when the sampled error exceeds
    /// the tolerance.
    pub fn new(alpha: f64, tolerance: f64, delta: f64, horizon: f64) -> Result<Self, KernelError> {
        if !(alpha > 0.0 && alpha < 1.0) {
            return Err(KernelError::Order(alpha));
        }
        if !(1e-13..=0.1).contains(&tolerance) {
            return Err(KernelError::Tolerance(tolerance));
        }
        if !(delta > 0.0 && delta < horizon && horizon.is_finite()) || delta < SHORTEST || horizon / delta > LONGEST {
            return Err(KernelError::Interval { delta, horizon });
        }
        let alpha = alpha.max(SMALLEST_ORDER);
        let eta = trapezoid_step(alpha, tolerance);
        let scale = strength(alpha) * eta;
        let cut = 0.25 * tolerance;
        let slow = upper_gamma_ratio(alpha, SLOWEST_TOP) <= cut;
        let top = if slow { SLOWEST_TOP } else { upper_gamma_ratio_inverse(alpha, cut) } / delta;
        let (count, tail) = Tail::cheapest(alpha, eta, 0.3 * tolerance, top * horizon);

        let mut lambda: Vec<f64> = (0..count).map(|k| top * (-(k as f64) * eta).exp()).collect();
        let mut weight: Vec<f64> = lambda.iter().map(|l| scale * l.powf(alpha)).collect();
        let cut = top * (-(count as f64) * eta).exp();
        for (node, mass) in tail.nodes.iter().zip(&tail.masses) {
            lambda.push(cut * node);
            weight.push(scale * cut.powf(alpha) * mass);
        }
        let kernel = Self { alpha, lambda, weight, eta, delta, horizon, tolerance };
        let error = kernel.lattice_error(count);
        if error.is_nan() || error > tolerance {
            return Err(KernelError::Bound { alpha, error, tolerance });
        }
        Ok(kernel)
    }

    /// Number of exponentials.
    pub fn modes(&self) -> usize {
        self.lambda.len()
    }

    /// Σ_k w_k e^{−λ_k t}.
    pub fn value(&self, t: f64) -> f64 {
        self.lambda.iter().zip(&self.weight).map(|(l, w)| w * (-l * t).exp()).sum()
    }

    /// Largest relative error at `count` lags spread evenly in ln t over [delta, horizon].
    pub fn sampled_error(&self, count: usize) -> f64 {
        let inverse = 1.0 / gamma(1.0 - self.alpha);
        let ratio = (self.horizon / self.delta).ln();
        (0..=count)
            .map(|k| {
                let t = self.delta * (ratio * k as f64 / count as f64).exp();
                (self.value(t) / (inverse * t.powf(-self.alpha)) - 1.0).abs()
            })
            .fold(0.0, |largest: f64, error| if error > largest || error.is_nan() { error } else { largest })
    }

    /// Largest relative error at [`SAMPLES`] lags per eta in ln t over [delta, horizon], both ends among them.
    ///
    /// At these lags the first `count` modes, λ_0 e^{−kη}, share their exponentials: λ_k t depends on one index alone.
    fn lattice_error(&self, count: usize) -> f64 {
        let spacing = self.eta / SAMPLES as f64;
        let rows = ((self.horizon / self.delta).ln() / spacing).ceil() as usize;
        let first = SAMPLES * (count - 1);
        let shared: Vec<f64> = (0..=first + rows)
            .map(|m| (-self.lambda[0] * self.delta * ((m as f64 - first as f64) * spacing).exp()).exp())
            .collect();
        let inverse = 1.0 / gamma(1.0 - self.alpha);
        let mut largest = self.sampled_error(1);
        for row in 0..rows {
            let t = self.delta * (row as f64 * spacing).exp();
            let trapezoid: f64 = (0..count).map(|k| self.weight[k] * shared[first + row - SAMPLES * k]).sum();
            let tail: f64 = (count..self.modes()).map(|k| self.weight[k] * (-self.lambda[k] * t).exp()).sum();
            let error = ((trapezoid + tail) / (inverse * t.powf(-self.alpha)) - 1.0).abs();
            if error > largest || error.is_nan() {
                largest = error;
            }
        }
        largest
    }

    /// How many modes must be put in front so that the bound holds from `lag` on; 0 when it already does.
    pub(super) fn missing(&self, lag: f64) -> usize {
        if lag >= self.delta { 0 } else { ((self.delta / lag).ln() / self.eta).ceil() as usize + 2 }
    }

    /// Rate and weight of the k-th mode in front of the kernel, k = 1, 2, …
    pub(super) fn faster(&self, k: usize) -> (f64, f64) {
        let lambda = self.lambda[0] * (self.eta * k as f64).exp();
        (lambda, strength(self.alpha) * self.eta * lambda.powf(self.alpha))
    }

    /// Puts the modes in front that make the bound hold from `lag` on; their rates, none where it already does.
    pub(super) fn extend(&mut self, lag: f64) -> Vec<f64> {
        let missing = self.missing(lag);
        if missing == 0 {
            return Vec::new();
        }
        let front: Vec<(f64, f64)> = (1..=missing).rev().map(|k| self.faster(k)).collect();
        let rates: Vec<f64> = front.iter().map(|(lambda, _)| *lambda).collect();
        self.lambda.splice(0..0, rates.iter().copied());
        self.weight.splice(0..0, front.iter().map(|(_, weight)| *weight));
        self.delta *= (-self.eta * missing as f64).exp();
        rates
    }

    /// Takes the `count` fastest modes away; the bound then holds for longer lags only.
    pub(super) fn drop_fastest(&mut self, count: usize) {
        self.lambda.drain(..count);
        self.weight.drain(..count);
        self.delta *= (self.eta * count as f64).exp();
    }

    /// Σ w/λ^n, n = 1, 2, 3, over the geometric series of modes above λ_0: d1, d2, d3.
    ///
    /// Under a smooth rate x' the lag of such a mode is x'/λ − x''/λ² + …, so that together they store ½·d2·x'² and dissipate
    /// d1·x'² − 2·d2·x'·x'' + d3·x''², which is never negative.
    pub fn fast_tail(&self) -> [f64; 3] {
        let scale = strength(self.alpha) * self.eta;
        [1.0, 2.0, 3.0].map(|n| {
            let power = n - self.alpha;
            scale * self.lambda[0].powf(-power) / (self.eta * power).exp_m1()
        })
    }
}

/// sin(πα)/π = 1/(Γ(α)Γ(1−α)), without cancellation near α = 1.
pub(super) fn strength(alpha: f64) -> f64 {
    (PI * alpha.min(1.0 - alpha)).sin() / PI
}

/// Largest eta with 2|Γ(α + 2πi/eta)|/Γ(α) ≤ 0.45·tolerance.
fn trapezoid_step(alpha: f64, tolerance: f64) -> f64 {
    let excess =
        |eta: f64| (2.0f64).ln() + ln_abs_gamma(alpha, 2.0 * PI / eta) - ln_gamma(alpha) - (0.45 * tolerance).ln();
    let (mut low, mut high) = (0.05, 20.0);
    while high - low > 1e-12 * high {
        let middle = 0.5 * (low + high);
        if excess(middle) <= 0.0 { low = middle } else { high = middle }
    }
    low
}

/// Largest number of nodes of a slow tail.
pub(super) const LARGEST_TAIL: usize = 8;

/// Gauss rule of the slow tail {e^{−kη}, e^{−αkη}}, k ≥ 0, in units of its fastest rate.
struct Tail {
    nodes: Vec<f64>,
    masses: Vec<f64>,
}

impl Tail {
    /// The rule, and the number of trapezoidal modes before it, with the fewest modes in all.
    ///
    /// `span` is λ_0·horizon; the relative error of the tail stays below `tolerance` up to the horizon.
    fn cheapest(alpha: f64, eta: f64, tolerance: f64, span: f64) -> (usize, Self) {
        let (points, masses) = geometric_measure(alpha, eta);
        let to_kernel = strength(alpha) * eta * gamma(1.0 - alpha);
        let exponentials = |nodes: &[f64], masses: &[f64], s: f64| -> f64 {
            nodes.iter().zip(masses).map(|(y, m)| m * (-s * y).exp()).sum()
        };
        // Reaches are looked for on the lattice 1e-14·1.12^k. The error grows with s = λ_c t up to the first crossing, later for
        // every further node: each size goes on from the one before, in strides, then in halves.
        const STRIDE: usize = 8;
        let reach_at = |k: usize| 1e-14 * 1.12f64.powi(k as i32);
        let last = 344;
        let mut best: Option<(usize, Self)> = None;
        let mut low = 0;
        for (nodes, weights) in gauss_rules(&points, &masses, 1..=LARGEST_TAIL) {
            let holds = |k: usize| {
                let s = reach_at(k);
                let error = (exponentials(&points, &masses, s) - exponentials(&nodes, &weights, s)).abs();
                error * to_kernel * s.powf(alpha) <= tolerance
            };
            let mut high = low + STRIDE;
            while high < last && holds(high) {
                (low, high) = (high, high + STRIDE);
            }
            while high - low > 1 {
                let middle = low.midpoint(high);
                if holds(middle) { low = middle } else { high = middle }
            }
            let count = ((span / reach_at(low)).ln() / eta).ceil().max(1.0) as usize;
            if best.as_ref().is_none_or(|(c, tail)| count + nodes.len() < c + tail.nodes.len()) {
                best = Some((count, Self { nodes, masses: weights }));
            }
        }
        best.expect("some sizes were tried")
    }
}

/// The points e^{−kη} down to 1e-20 with masses e^{−αkη}; the rest of the geometric series sits at 0.
pub(super) fn geometric_measure(alpha: f64, eta: f64) -> (Vec<f64>, Vec<f64>) {
    let count = (46.0 / eta).ceil() as usize;
    let mut points: Vec<f64> = (0..count).map(|k| (-(k as f64) * eta).exp()).collect();
    let mut masses: Vec<f64> = (0..count).map(|k| (-(k as f64) * alpha * eta).exp()).collect();
    points.push(0.0);
    masses.push((-(count as f64) * alpha * eta).exp() / -(-alpha * eta).exp_m1());
    (points, masses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mode_counts_over_six_decades() {
        // Fewest modes known to reach each tolerance with this recipe; one more for the search grid.
        for (alpha, counts) in [(0.1, [16, 24, 32, 40]), (0.5, [20, 28, 36, 45]), (0.9, [22, 31, 39, 48])] {
            for (tolerance, count) in [1e-4, 1e-6, 1e-8, 1e-10].into_iter().zip(counts) {
                let kernel = Kernel::new(alpha, tolerance, 1e-3, 1e3).unwrap();
                assert!(kernel.modes() <= count + 1, "alpha {alpha}, {tolerance:e}: {} modes", kernel.modes());
                assert!(kernel.sampled_error(4000) < tolerance);
                assert!(kernel.weight.iter().all(|w| *w > 0.0));
                assert!(kernel.lambda.windows(2).all(|l| l[0] > l[1]));
            }
        }
    }

    #[test]
    fn builds_at_extreme_orders_and_spans() {
        for alpha in [5e-324, 1e-300, 1e-15, 3e-14, 1e-12, 1e-3, 0.01, 0.99, 0.9999, 1.0 - f64::EPSILON] {
            for (delta, horizon) in [(1e-3, 1e4), (1e-12, 3600.0), (0.9, 1.0)] {
                for tolerance in [1e-4, 1e-12] {
                    let kernel = Kernel::new(alpha, tolerance, delta, horizon).unwrap();
                    assert!(kernel.sampled_error(3000) <= tolerance, "{alpha} {delta} {tolerance:e}");
                    // What is faster than the modes is as little as what a step of delta misses.
                    let [damping, inertia, _] = kernel.fast_tail();
                    assert!(damping < delta.powf(1.0 - alpha) && inertia < delta.powf(2.0 - alpha), "{alpha} {delta}");
                }
            }
        }
    }

    #[test]
    fn modes_in_front_extend_the_bound() {
        let short = Kernel::new(0.7, 1e-8, 1e-2, 10.0).unwrap();
        let mut long = short.clone();
        let missing = long.missing(1e-5);
        for k in 1..=missing {
            let (lambda, weight) = short.faster(k);
            long.lambda.insert(0, lambda);
            long.weight.insert(0, weight);
        }
        long.delta = 1e-5;
        assert!(long.sampled_error(3000) < 1e-8);
    }

    #[test]
    fn refusals() {
        assert_eq!(Kernel::new(1.0, 1e-8, 1e-3, 1.0), Err(KernelError::Order(1.0)));
        assert!(matches!(Kernel::new(f64::NAN, 1e-8, 1e-3, 1.0), Err(KernelError::Order(_))));
        assert_eq!(Kernel::new(0.5, 1e-14, 1e-3, 1.0), Err(KernelError::Tolerance(1e-14)));
        for (delta, horizon) in [(1.0, 1.0), (0.0, 1.0), (1e-310, 1.0), (1e-150, 1e60), (1.0, f64::INFINITY)] {
            assert!(matches!(Kernel::new(0.5, 1e-8, delta, horizon), Err(KernelError::Interval { .. })));
        }
    }
}
