//! The derivative of kernels by their order against t^−α/Γ(1−α)·(ψ(1−α) − ln t).

use super::super::order::ByOrder;
use crate::fractional::Kernel;
use crate::fractional::gamma::{digamma, gamma};

/// Largest error of k_α in units of k over lags of [delta, horizon], and the largest |ψ(1−α) − ln t| there.
fn error(alpha: f64, tolerance: f64, delta: f64, horizon: f64) -> [f64; 2] {
    let kernel = Kernel::new(alpha, tolerance, delta, horizon).unwrap();
    let by_order = ByOrder::of(&kernel);
    let (inverse, digamma) = (1.0 / gamma(1.0 - alpha), digamma(1.0 - alpha));
    let (mut worst, mut largest) = (0.0f64, 1.0f64);
    for k in 0..=1000 {
        let t = delta * (horizon / delta).powf(f64::from(k) / 1000.0);
        let value = inverse * t.powf(-alpha);
        let exact = value * (digamma - t.ln());
        worst = worst.max((by_order.kernel_by_order(&kernel, t) - exact).abs() / value);
        largest = largest.max((digamma - t.ln()).abs());
    }
    let tail = by_order.ratios().iter().filter(|ratio| **ratio == 0.0).count();
    let more = by_order.slow.kernel().modes() - tail;
    assert!((2..=5).contains(&more), "{alpha} {tolerance:e}: {more} nodes more in the tail");
    [worst, largest]
}

/// k errs by ε; its derivative by that times |ψ(1−α) − ln t|, and what is cut off at the fast end by 1/α.
#[test]
fn is_as_good_as_the_kernel() {
    for alpha in [0.02, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98] {
        for tolerance in [1e-6, 1e-8, 1e-11] {
            for (delta, horizon) in [(1e-6, 1.0), (1e-3, 100.0), (1e-8, 1e4)] {
                let [error, largest] = error(alpha, tolerance, delta, horizon);
                let bound = tolerance * (0.6 * largest + 0.6 / alpha);
                assert!(error < bound, "{alpha} {tolerance:e} {delta:e} {horizon:e}: {error:e} > {bound:e}");
            }
        }
    }
}

/// Kernels of extreme orders and spans have a tail that is found.
#[test]
fn has_a_tail_of_its_own_at_extremes() {
    for alpha in [1e-12, 1e-3, 0.01, 0.5, 0.99, 0.9999, 1.0 - f64::EPSILON] {
        for (delta, horizon) in [(1e-3, 1e4), (1e-12, 3600.0), (0.9, 1.0), (1e-100, 1.0)] {
            for tolerance in [1e-2, 1e-4, 1e-8, 1e-12] {
                let kernel = Kernel::new(alpha, tolerance, delta, horizon).unwrap();
                let by_order = ByOrder::of(&kernel);
                assert!(by_order.kernel_by_order(&kernel, horizon).is_finite(), "{alpha} {delta} {tolerance:e}");
            }
        }
    }
}

/// Modes in front and modes dropped keep it.
#[test]
fn follows_the_kernel() {
    let mut kernel = Kernel::new(0.4, 1e-9, 1e-2, 10.0).unwrap();
    let mut by_order = ByOrder::of(&kernel);
    let before = kernel.clone();
    let front = kernel.extend(1e-6);
    by_order.follow(&before, &front, 0);
    let exact = |t: f64| t.powf(-0.4) / gamma(0.6) * (digamma(0.6) - t.ln());
    let error =
        |by_order: &ByOrder, kernel: &Kernel, t: f64| (by_order.kernel_by_order(kernel, t) / exact(t) - 1.0).abs();
    for t in [1e-6, 1e-4, 1.0, 10.0] {
        assert!(error(&by_order, &kernel, t) < 2e-8, "{t}: {:e}", error(&by_order, &kernel, t));
    }
    by_order.follow(&kernel, &[], 17);
    kernel.drop_fastest(17);
    assert_eq!(by_order.ratios().len(), kernel.modes());
    assert!(error(&by_order, &kernel, kernel.delta) < 2e-8);
}
