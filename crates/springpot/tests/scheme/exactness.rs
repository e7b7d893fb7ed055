//! What each scheme must reproduce to rounding, the limits of alpha, and the agreement of its code paths.

use proptest::prelude::*;
use springpot::fractional::Kind;
use springpot::fractional::gamma::{gamma, reciprocal_gamma};
use springpot::fractional::scheme::{Samples, Scheme, causal_convolution, differenced_rates, direct_convolution};

const KINDS: [Kind; 2] = [Kind::Caputo, Kind::RiemannLiouville];

fn derivative(scheme: Scheme, t: &[f64], x: &[f64], alpha: f64, kind: Kind) -> Vec<f64> {
    scheme.differentiate(&Samples { t, x, rate: None }, alpha, kind).unwrap()
}

fn all_schemes() -> Vec<Scheme> {
    let plain =
        [Scheme::GrunwaldLetnikov, Scheme::L1, Scheme::L12, Scheme::Expansion2004(40), Scheme::Expansion2008(40)];
    (1..=6).map(Scheme::Fbdf).chain(plain).collect()
}

fn any_grid_schemes() -> [Scheme; 4] {
    [Scheme::L1, Scheme::L12, Scheme::Expansion2004(40), Scheme::Expansion2008(40)]
}

/// D^alpha t^k; with Caputo 0 for k = 0.
fn power(k: f64, t: f64, alpha: f64, kind: Kind) -> f64 {
    if k == 0.0 && kind == Kind::Caputo {
        return 0.0;
    }
    gamma(k + 1.0) * reciprocal_gamma(k + 1.0 - alpha) * t.powf(k - alpha)
}

/// A grid without any two equal steps.
fn uneven(steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| k as f64 * 0.01 + 0.004 * (1.3 * k as f64).sin()).collect()
}

fn uniform(steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| k as f64 * 0.01).collect()
}

fn assert_close(got: &[f64], wanted: impl IntoIterator<Item = f64>, tolerance: f64, what: &str) {
    let mut count = 0;
    for (n, (got, wanted)) in got.iter().zip(wanted).enumerate().skip(1) {
        assert!((got - wanted).abs() <= tolerance, "{what}, row {n}: {got} instead of {wanted}");
        count += 1;
    }
    assert_eq!(count, got.len() - 1, "{what}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn backward_differences_are_exact_on_their_polynomials(
        order in 1u8..=6,
        alpha in 0.02f64..1.0,
        coefficients in prop::array::uniform7(-1.0f64..1.0),
        steps in 7usize..700,
    ) {
        let (t, degree) = (uniform(steps), usize::from(order));
        let x: Vec<f64> = t.iter().map(|t| coefficients[..=degree].iter().rev().fold(0.0, |s, c| s * t + c)).collect();
        for kind in KINDS {
            let exact = t.iter().map(|&t| -> f64 {
                (0..=degree).map(|k| coefficients[k] * power(k as f64, t, alpha, kind)).sum()
            });
            let largest = exact.clone().skip(1).fold(1.0, |m: f64, v: f64| m.max(v.abs()));
            let y = derivative(Scheme::Fbdf(order), &t, &x, alpha, kind);
            // Rounding of x is multiplied by the start polynomial's differences, up to 2^p, and by h^−alpha.
            let rounding = f64::EPSILON * largest * 100f64.powf(alpha) * f64::from(1u32 << order) * 8.0;
            assert_close(&y, exact, rounding, &format!("fbdf-{order}, alpha = {alpha}, {kind:?}"));
        }
    }

    #[test]
    fn l1_is_exact_on_broken_lines(
        alpha in 0.0f64..=1.0,
        kinks in prop::collection::vec((1usize..60, -2.0f64..2.0), 1..6),
        start in -1.0f64..1.0,
    ) {
        // x = x(0) + Σ slope·max(t − kink, 0) on an uneven grid.
        let t = uneven(60);
        let slope = |alpha: f64, t: f64| if t <= 0.0 { 0.0 } else { t.powf(1.0 - alpha) * reciprocal_gamma(2.0 - alpha) };
        let x: Vec<f64> = t.iter().map(|&s| start + kinks.iter().map(|(k, c)| c * (s - t[*k]).max(0.0)).sum::<f64>()).collect();
        let exact = t.iter().map(|&s| kinks.iter().map(|(k, c)| c * slope(alpha, s - t[*k])).sum::<f64>());
        let y = derivative(Scheme::L1, &t, &x, alpha, Kind::Caputo);
        assert_close(&y, exact, 1e-12, &format!("alpha = {alpha}"));
    }

    #[test]
    fn l1_2_is_exact_on_parabolas_but_for_the_straight_first_step(alpha in 0.0f64..0.999, regular in any::<bool>()) {
        let t = if regular { uniform(150) } else { uneven(150) };
        let x: Vec<f64> = t.iter().map(|t| 0.4 - t + 1.5 * t * t).collect();
        let first = t[1];
        let exact = t.iter().map(|&s| {
            // Missing: 1.5/Γ(1−α) ∫₀^first (s−τ)^−α (2τ − first) dτ.
            let integral = |a: f64, p: f64| (s.powf(p) - (s - first).max(0.0).powf(p)) * a;
            let missing = (2.0 * s - first) * integral(1.0 / (1.0 - alpha), 1.0 - alpha)
                - 2.0 * integral(1.0 / (2.0 - alpha), 2.0 - alpha);
            -power(1.0, s, alpha, Kind::Caputo) + 1.5 * power(2.0, s, alpha, Kind::Caputo)
                - 1.5 * missing * reciprocal_gamma(1.0 - alpha)
        });
        let y = derivative(Scheme::L12, &t, &x, alpha, Kind::Caputo);
        assert_close(&y, exact, 2e-12, &format!("alpha = {alpha}, regular {regular}"));
    }

    #[test]
    fn transformed_convolution_is_the_direct_sum(
        weights in prop::collection::vec(-1.0f64..1.0, 1100),
        x in prop::collection::vec(-1.0f64..1.0, 1..1100),
    ) {
        let (fast, direct) = (causal_convolution(&weights, &x), direct_convolution(&weights, &x));
        prop_assert_eq!(fast.len(), x.len());
        for (n, (a, b)) in fast.iter().zip(&direct).enumerate() {
            prop_assert!((a - b).abs() < 2e-13, "row {}: {} {}", n, a, b);
        }
    }

    #[test]
    fn the_two_kinds_differ_by_the_jump_at_the_start(alpha in 0.01f64..0.99, start in -3.0f64..3.0) {
        let t = uniform(300);
        let x: Vec<f64> = t.iter().map(|t| start + (5.0 * t).sin()).collect();
        for scheme in all_schemes() {
            let (caputo, rl) =
                (derivative(scheme, &t, &x, alpha, Kind::Caputo), derivative(scheme, &t, &x, alpha, Kind::RiemannLiouville));
            // Grünwald–Letnikov sums the constant too, and errs by α/2·h/t of its derivative.
            let relative = |t: f64| if scheme == Scheme::GrunwaldLetnikov { 0.01 / t } else { 1e-12 };
            for n in 1..t.len() {
                let jump = start * t[n].powf(-alpha) * reciprocal_gamma(1.0 - alpha);
                let tolerance = relative(t[n]) * jump.abs() + 1e-12;
                prop_assert!((rl[n] - caputo[n] - jump).abs() < tolerance, "{} row {}", scheme, n);
            }
        }
    }
}

#[test]
fn expansions_are_exact_where_their_derivation_is() {
    let t = uneven(200);
    for alpha in [0.1, 0.5, 0.9, 0.999] {
        for terms in [2, 7, 100, 3000] {
            let constant = vec![2.5; t.len()];
            let line: Vec<f64> = t.iter().map(|t| 2.5 - 3.0 * t).collect();
            for kind in KINDS {
                let exact = t.iter().map(|&t| 2.5 * power(0.0, t, alpha, kind));
                for scheme in [Scheme::Expansion2004(terms), Scheme::Expansion2008(terms)] {
                    let y = derivative(scheme, &t, &constant, alpha, kind);
                    assert_close(&y, exact.clone(), 1e-10, &format!("{scheme}, constant, alpha = {alpha}, {kind:?}"));
                }
                let exact = exact.zip(&t).map(|(c, &t)| c - 3.0 * power(1.0, t, alpha, kind));
                let y = derivative(Scheme::Expansion2004(terms), &t, &line, alpha, kind);
                assert_close(&y, exact, 1e-10, &format!("{terms} terms, line, alpha = {alpha}, {kind:?}"));
            }
        }
    }
}

#[test]
fn order_zero_is_the_function_to_the_bit() {
    let t = uniform(40);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + (7.0 * t).cos()).collect();
    for scheme in all_schemes() {
        assert_eq!(derivative(scheme, &t, &x, 0.0, Kind::RiemannLiouville), x, "{scheme}");
        let shifted: Vec<f64> = x.iter().map(|v| v - x[0]).collect();
        assert_eq!(derivative(scheme, &t, &x, 0.0, Kind::Caputo), shifted, "{scheme}");
    }
}

#[test]
fn order_one_is_a_rate_and_the_limit_of_the_orders_below() {
    let t = uniform(400);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + (2.0 * t).sin()).collect();
    let exact: Vec<f64> = t.iter().map(|t| 2.0 * (2.0 * t).cos()).collect();
    for scheme in all_schemes() {
        for kind in KINDS {
            let rate = derivative(scheme, &t, &x, 1.0, kind);
            let given = scheme.differentiate(&Samples { t: &t, x: &x, rate: Some(&exact) }, 1.0, kind).unwrap();
            assert!(rate.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 0.1), "{scheme}, {kind:?}");
            assert_eq!(given[0], exact[0], "{scheme}");
            // The 2008 form alone has another limit: 0.
            if !matches!(scheme, Scheme::Expansion2008(_)) {
                let below = derivative(scheme, &t, &x, 1.0 - 1e-10, kind);
                let jump = 1e-10 * 400.0 / t[1];
                assert_close(&below, rate.iter().copied(), jump, &format!("{scheme}, {kind:?}"));
            }
        }
    }
}

#[test]
fn row_zero_is_empty_only_where_the_derivative_is_singular() {
    let t = uniform(40);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + t).collect();
    let still: Vec<f64> = t.iter().map(|t| t * t).collect();
    for scheme in all_schemes() {
        let y = derivative(scheme, &t, &x, 0.5, Kind::RiemannLiouville);
        assert!(y[0].is_nan() && y[1..].iter().all(|v| v.is_finite()), "{scheme}");
        assert_eq!(derivative(scheme, &t, &x, 0.5, Kind::Caputo)[0], 0.0, "{scheme}");
        assert_eq!(derivative(scheme, &t, &still, 0.5, Kind::RiemannLiouville)[0], 0.0, "{scheme}");
    }
}

#[test]
fn direct_rows_agree_with_transformed_ones() {
    let regular = uniform(500);
    let function = |t: f64| 0.2 + (3.0 * t).sin() + t * t;
    let x: Vec<f64> = regular.iter().map(|&t| function(t)).collect();
    for alpha in [0.05, 0.5, 0.95, 1.0] {
        // The first step split in two on its chord is the same broken line, summed term by term.
        let (mut t, mut line) = (regular.clone(), x.clone());
        t.insert(1, 0.5 * regular[1]);
        line.insert(1, 0.5 * (x[0] + x[1]));
        let direct = derivative(Scheme::L1, &t, &line, alpha, Kind::RiemannLiouville);
        let fast = derivative(Scheme::L1, &regular, &x, alpha, Kind::RiemannLiouville);
        assert_close(&direct[1..], fast[..].iter().copied(), 1e-11, &format!("l1, alpha = {alpha}"));

        // A first step off by 1e-8 sends every row to the direct sums and moves the result as little.
        let mut t = regular.clone();
        t[1] *= 1.0 + 1e-8;
        assert_eq!(Samples { t: &t, x: &x, rate: None }.uniform_prefix().rows, 2);
        let moved: Vec<f64> = t.iter().map(|&t| function(t)).collect();
        for scheme in [Scheme::L1, Scheme::L12] {
            let direct = derivative(scheme, &t, &moved, alpha, Kind::Caputo);
            let fast = derivative(scheme, &regular, &x, alpha, Kind::Caputo);
            assert_close(&direct, fast.iter().copied(), 1e-7, &format!("{scheme}, alpha = {alpha}"));
        }
    }
}

#[test]
fn a_shorter_last_step_leaves_the_rows_before_alone() {
    let mut t = uniform(2000);
    t.push(t[2000] + 0.0037);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + t * t).collect();
    for scheme in any_grid_schemes() {
        let with = derivative(scheme, &t, &x, 0.5, Kind::Caputo);
        let without = derivative(scheme, &t[..2001], &x[..2001], 0.5, Kind::Caputo);
        assert_close(&with[..2001], without.iter().copied(), 1e-11, &scheme.to_string());
        let error = |n: usize| (with[n] - power(2.0, t[n], 0.5, Kind::Caputo)).abs();
        let before = (1..2001).map(error).fold(0.0, f64::max);
        assert!(error(2001) < 1.001 * before, "{scheme}: {} after {before}", error(2001));
    }
}

#[test]
fn differenced_rates_are_exact_to_degree_four() {
    let t = uneven(30);
    let x: Vec<f64> = t.iter().map(|t| 1.0 - t + t * t - 2.0 * t.powi(4)).collect();
    for (rate, t) in differenced_rates(&t, &x).iter().zip(&t) {
        assert!((rate - (-1.0 + 2.0 * t - 8.0 * t.powi(3))).abs() < 1e-11);
    }
    assert_eq!(differenced_rates(&[0.0, 0.5], &[1.0, 2.0]), [2.0, 2.0]);
}
