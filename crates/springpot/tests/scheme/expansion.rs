//! The Atanacković–Stanković expansions against their known errors and rates of convergence.

use crate::support::{file, references};
use springpot::fractional::Kind;
use springpot::fractional::gamma::gamma;
use springpot::fractional::scheme::{Samples, Scheme};

const SIGNAL: &str = "0.7*sin(8t)+0.1*t";

/// Derivative of the signal at `end` from samples every millisecond.
fn at_end(scheme: Scheme, end: f64, alpha: f64, with_rates: bool) -> f64 {
    let steps = (end * 1e3).round() as usize;
    let t: Vec<f64> = (0..=steps).map(|k| end * k as f64 / steps as f64).collect();
    let x: Vec<f64> = t.iter().map(|t| 0.7 * (8.0 * t).sin() + 0.1 * t).collect();
    let rate: Vec<f64> = t.iter().map(|t| 5.6 * (8.0 * t).cos() + 0.1).collect();
    let samples = Samples { t: &t, x: &x, rate: with_rates.then_some(rate.as_slice()) };
    scheme.differentiate(&samples, alpha, Kind::RiemannLiouville).unwrap()[steps]
}

fn relative_error(scheme: Scheme, end: f64, alpha: f64, with_rates: bool) -> f64 {
    let all = references(&file(), SIGNAL);
    let exact = all.iter().find(|r| r.t == end && r.alpha == alpha).unwrap().value(Kind::RiemannLiouville);
    (at_end(scheme, end, alpha, with_rates) / exact - 1.0).abs()
}

#[test]
fn truncation_errors_meet_independent_values() {
    // Relative errors computed independently with exact moments, to two digits: N, 2008 form, 2004 form.
    type Row = (f64, f64, [(u32, f64, f64); 4]);
    let table: [Row; 4] = [
        (0.5, 1.0, [(7, 1.2e-1, 2.8e-1), (20, 6.0e-3, 7.7e-2), (100, 2.8e-2, 7.4e-3), (1000, 1.1e-2, 2.3e-4)]),
        (0.5, 10.0, [(7, 9.1e-1, 6.0e-1), (20, 7.3e-1, 5.4e-1), (100, 2.8e-1, 1.9e-1), (1000, 3.6e-2, 7.9e-3)]),
        (0.9, 10.0, [(7, 9.7e-1, 4.9e-1), (20, 9.0e-1, 4.6e-1), (100, 6.1e-1, 2.3e-1), (1000, 3.2e-1, 2.3e-2)]),
        (0.1, 10.0, [(7, 5.1, 3.1), (20, 3.4, 2.6), (100, 7.9e-1, 6.0e-1), (1000, 3.5e-2, 1.0e-2)]),
    ];
    let mut compared = 0;
    for (alpha, end, columns) in table {
        for (terms, error_2008, error_2004) in columns {
            for (scheme, printed) in
                [(Scheme::Expansion2008(terms), error_2008), (Scheme::Expansion2004(terms), error_2004)]
            {
                let measured = relative_error(scheme, end, alpha, true);
                let last_digit = 10f64.powf(printed.log10().floor() - 1.0);
                assert!(
                    (measured - printed).abs() < 0.51 * last_digit,
                    "{scheme}, alpha = {alpha}, t = {end}: {measured:.3e}, printed {printed:.1e}"
                );
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 32);
}

#[test]
fn many_terms_converge_at_the_theoretical_rate() {
    // In t = 1 the signal has turned by 8 radians: N = 1000 is far in the asymptotic range.
    for alpha in [0.1, 0.5, 0.9] {
        for (scheme, wanted) in [
            (Scheme::Expansion2008 as fn(u32) -> Scheme, alpha - 1.0),
            (Scheme::Expansion2004 as fn(u32) -> Scheme, alpha - 2.0),
        ] {
            let (coarse, fine) = (scheme(1000), scheme(4000));
            let errors = [coarse, fine].map(|s| relative_error(s, 1.0, alpha, true));
            let slope = (errors[1] / errors[0]).log2() / 2.0;
            assert!((slope - wanted).abs() < 0.05, "{coarse}, alpha = {alpha}: slope {slope:.3}, errors {errors:?}");
            assert!((-slope - coarse.order(alpha)).abs() < 0.05);
        }
    }
}

#[test]
fn leading_error_terms_are_those_of_the_documentation() {
    // x = t², where both remainders have one term: 2 t^{2−alpha} times the documented constants.
    let (alpha, n) = (0.5, 4000.0f64);
    let t: Vec<f64> = (0..=200).map(|k| f64::from(k) / 200.0).collect();
    let x: Vec<f64> = t.iter().map(|t| t * t).collect();
    let exact = gamma(3.0) / gamma(3.0 - alpha);
    let error = |scheme: Scheme| {
        scheme.differentiate(&Samples { t: &t, x: &x, rate: None }, alpha, Kind::Caputo).unwrap()[200] - exact
    };
    let predicted_2008 = 2.0 * n.powf(alpha - 1.0) / ((1.0 - alpha) * gamma(alpha) * gamma(1.0 - alpha));
    let predicted_2004 = 2.0 * n.powf(alpha - 2.0) / ((2.0 - alpha) * gamma(2.0 - alpha) * gamma(alpha - 1.0).abs());
    let (measured_2008, measured_2004) = (error(Scheme::Expansion2008(4000)), error(Scheme::Expansion2004(4000)));
    assert!((measured_2008.abs() / predicted_2008 - 1.0).abs() < 0.02, "{measured_2008:e} {predicted_2008:e}");
    assert!((measured_2004.abs() / predicted_2004 - 1.0).abs() < 0.02, "{measured_2004:e} {predicted_2004:e}");
}

#[test]
fn the_grid_matters_less_than_the_truncation() {
    for (scheme, alpha) in [(Scheme::Expansion2004(1000), 0.5), (Scheme::Expansion2008(1000), 0.9)] {
        let exact_rates = at_end(scheme, 1.0, alpha, true);
        let differenced = at_end(scheme, 1.0, alpha, false);
        assert!((exact_rates - differenced).abs() < 1e-6, "{scheme}: {exact_rates} {differenced}");
    }
}

#[test]
fn thousands_of_terms_over_a_long_time_stay_finite() {
    // t^p itself overflows from p = 154 on at t = 100.
    let t: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.25).collect();
    let x: Vec<f64> = t.iter().map(|t| (0.1 * t).sin()).collect();
    for scheme in [Scheme::Expansion2004(5000), Scheme::Expansion2008(5000)] {
        let y = scheme.differentiate(&Samples { t: &t, x: &x, rate: None }, 0.5, Kind::Caputo).unwrap();
        assert!(y.iter().all(|v| v.is_finite() && v.abs() < 0.5), "{scheme}");
    }
}
