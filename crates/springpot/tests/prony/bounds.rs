//! The verified error holds where nobody looked while building, and the series are as short as the recipe promises.

use springpot::fractional::mittag_leffler::MittagLeffler;
use springpot::fractional::prony::{FractionalZener, PronySeries, Relaxation, Slowest, Spectrum, Springpot, Window};

const SIX_DECADES: [Window; 2] = [Window::Times { from: 1e-3, to: 1e3 }, Window::Frequencies { from: 1e-3, to: 1e3 }];

/// Builds, and asserts the bound on points of its own, positive moduli and rising times.
fn built(material: &impl Relaxation, window: Window, tolerance: f64, slowest: Slowest) -> PronySeries {
    let series = PronySeries::new(material, window, tolerance, slowest).unwrap();
    let (Window::Times { from, to } | Window::Frequencies { from, to }) = window;
    let mut largest = 0.0f64;
    let count = 1777;
    for k in 0..=count {
        // A square root grid in the logarithm, unlike any used in building.
        let at = from * ((to / from).ln() * (k as f64 / count as f64).sqrt()).exp();
        let error = match window {
            Window::Times { .. } => (series.relaxation(at) / material.relaxation(at) - 1.0).abs(),
            Window::Frequencies { .. } => {
                let exact = material.complex_modulus(at);
                (series.complex_modulus(at) - exact).norm() / exact.norm()
            }
        };
        largest = largest.max(error);
    }
    assert!(largest <= (1.03 * series.error).min(tolerance), "{largest:e} beyond the verified {:e}", series.error);
    assert!(series.error <= tolerance, "{:e}", series.error);
    assert!(series.terms.iter().all(|term| term.modulus > 0.0 && term.relaxation_time > 0.0), "{:?}", series.terms);
    assert!(series.terms.windows(2).all(|pair| pair[0].relaxation_time < pair[1].relaxation_time));
    assert!(series.equilibrium >= material.equilibrium());
    series
}

#[test]
fn springpots_take_as_few_branches_as_the_recipe() {
    // Times and frequencies over six decades at 1e-4, 1e-6, 1e-8.
    for (order, times, frequencies) in
        [(0.1, [16, 24, 32], [18, 27, 36]), (0.5, [20, 28, 37], [21, 29, 38]), (0.9, [22, 31, 39], [18, 27, 36])]
    {
        let springpot = Springpot::new(50.0, order, 0.0).unwrap();
        for (window, counts) in SIX_DECADES.into_iter().zip([times, frequencies]) {
            for (tolerance, count) in [1e-4, 1e-6, 1e-8].into_iter().zip(counts) {
                let series = built(&springpot, window, tolerance, Slowest::Relaxes);
                let size = series.terms.len();
                println!("{order} {window:?} {tolerance:e}: {size} for {count}, {:e}", series.error);
                assert!(size <= count + 2, "alpha = {order}, {tolerance:e}: {size} branches");
                assert_eq!(series.equilibrium, 0.0);
            }
        }
    }
}

#[test]
fn what_stays_is_a_positive_spring_and_costs_at_most_two_branches() {
    for order in [0.05, 0.3, 0.5, 0.8, 0.95] {
        let springpot = Springpot::new(3.0, order, 0.0).unwrap();
        for window in SIX_DECADES {
            let relaxes = built(&springpot, window, 1e-5, Slowest::Relaxes);
            let stays = built(&springpot, window, 1e-5, Slowest::Stays);
            assert!(stays.equilibrium > 0.0 && stays.terms.len() <= relaxes.terms.len() + 2, "alpha = {order}");
        }
    }
}

#[test]
fn zener_and_maxwell_models_meet_mittag_leffler() {
    for (equilibrium, order, time) in [(0.0, 0.5, 1.0), (2e5, 0.3, 0.02), (1.0, 0.7, 30.0), (0.1, 0.9, 1.0)] {
        let material = FractionalZener::new(equilibrium, 7.0, order, time).unwrap();
        for window in SIX_DECADES {
            for tolerance in [1e-3, 1e-6] {
                built(&material, window, tolerance, Slowest::Relaxes);
            }
        }
        let series = built(&material, SIX_DECADES[0], 1e-7, Slowest::Stays);
        let function = MittagLeffler::new(order, 1.0).unwrap();
        for t in [2e-3, 0.7, 44.0, 999.0] {
            let exact = equilibrium + 7.0 * function.real(-f64::powf(t / time, order));
            assert!((series.relaxation(t) / exact - 1.0).abs() <= 1e-7, "t = {t}");
        }
    }
}

#[test]
fn any_spectrum_will_do() {
    // A log-normal box of relaxation times beside a spring: smooth, and gone on both sides.
    let bell = Spectrum::new(0.5, |tau: f64| (-0.5 * (tau.ln() / 1.5).powi(2)).exp()).unwrap();
    // G = G_e + ∫ H d ln τ at t → 0.
    let whole = 0.5 + 1.5 * (2.0 * std::f64::consts::PI).sqrt();
    assert!((bell.relaxation(1e-14) / whole - 1.0).abs() < 1e-12, "{}", bell.relaxation(1e-14));
    for window in SIX_DECADES {
        let series = built(&bell, window, 1e-6, Slowest::Relaxes);
        assert!(series.terms.len() < 25 && series.equilibrium == 0.5, "{}", series.terms.len());
    }
    // The spectrum of a springpot alone gives its modulus, and that of a Zener model too.
    let springpot = Springpot::new(4.0, 0.35, 0.2).unwrap();
    let zener = FractionalZener::new(0.3, 2.0, 0.6, 5.0).unwrap();
    for at in [1e-3, 0.4, 1.0, 77.0] {
        let by_spectrum = Spectrum::new(0.2, |tau| springpot.spectrum(tau)).unwrap();
        assert!((by_spectrum.relaxation(at) / springpot.relaxation(at) - 1.0).abs() < 1e-12);
        assert!((by_spectrum.complex_modulus(at) / springpot.complex_modulus(at) - 1.0).norm() < 1e-12);
        let by_spectrum = Spectrum::new(0.3, |tau| zener.spectrum(tau)).unwrap();
        assert!((by_spectrum.relaxation(at) / zener.relaxation(at) - 1.0).abs() < 1e-12);
        assert!((by_spectrum.complex_modulus(at) / zener.complex_modulus(at) - 1.0).norm() < 1e-12);
    }
}

#[test]
fn storage_and_loss_are_those_of_the_branches() {
    let springpot = Springpot::new(1.0, 0.5, 0.0).unwrap();
    let series = built(&springpot, Window::Frequencies { from: 0.1, to: 10.0 }, 1e-3, Slowest::Stays);
    let modulus = series.complex_modulus(3.0);
    let sum = |f: &dyn Fn(f64) -> f64| series.terms.iter().map(|t| t.modulus * f(3.0 * t.relaxation_time)).sum::<f64>();
    assert!((modulus.re - series.equilibrium - sum(&|x| x * x / (1.0 + x * x))).abs() < 1e-14);
    assert!((modulus.im - sum(&|x| x / (1.0 + x * x))).abs() < 1e-14);
    assert!((series.complex_modulus(1e12).re / series.instantaneous() - 1.0).abs() < 1e-12);
    assert_eq!(series.complex_modulus(0.0).re, series.equilibrium);
}

#[test]
fn the_sampled_error_notices_a_wrong_branch() {
    let springpot = Springpot::new(1.0, 0.5, 0.0).unwrap();
    let mut series = built(&springpot, SIX_DECADES[0], 1e-6, Slowest::Relaxes);
    series.terms[9].modulus *= 1.0001;
    assert!(series.sampled_error(&springpot, 500) > 1e-6);
}
