//! What each scheme must reproduce to rounding, and the agreement of its code paths.

use crate::support::{KINDS, all_schemes, any_grid_schemes, assert_close, derivative, power, uneven, uniform};
use proptest::prelude::*;
use springpot::fractional::Kind;
use springpot::fractional::gamma::reciprocal_gamma;
use springpot::fractional::scheme::{Samples, Scheme, causal_convolution, differenced_rates, direct_convolution};

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn backward_differences_are_exact_on_their_polynomials(
        order in 1u8..=6,
        alpha in -2.0f64..2.0,
        coefficients in prop::array::uniform8(-1.0f64..1.0),
        steps in 8usize..700,
    ) {
        // Integrals keep one degree less, derivatives above order 1 one more.
        let degree = usize::from(order) - 1 + usize::from(alpha > 0.0) + usize::from(alpha > 1.0);
        let t = uniform(steps);
        let polynomial = |t: f64| coefficients[..=degree].iter().rev().fold(0.0, |s, c| s * t + c);
        let x: Vec<f64> = t.iter().map(|&t| polynomial(t)).collect();
        for kind in KINDS {
            let exact = t.iter().map(|&t| -> f64 {
                (0..=degree).map(|k| coefficients[k] * power(k as f64, t, alpha, kind)).sum()
            });
            let largest = exact.clone().skip(1).chain(x.iter().copied()).fold(1.0, |m: f64, v: f64| m.max(v.abs()));
            let y = derivative(Scheme::Fbdf(order), &t, &x, alpha, kind);
            // Rounding of x is multiplied by the start polynomial's differences, up to 2^d, and h^−alpha or t^−alpha.
            let scale = if alpha > 0.0 { 100f64.powf(alpha) } else { t[steps].max(1.0).powf(-alpha) };
            let rounding = f64::EPSILON * largest * scale * f64::from(1u32 << degree) * 8.0;
            assert_close(&y, exact, rounding, &format!("fbdf-{order}, alpha = {alpha}, {kind:?}"));
        }
    }

    #[test]
    fn l1_is_exact_on_broken_lines(
        alpha in -2.0f64..=1.0,
        kinks in prop::collection::vec((1usize..60, -2.0f64..2.0), 1..6),
        start in -1.0f64..1.0,
        regular in any::<bool>(),
    ) {
        // x = x(0) + Σ slope·max(t − kink, 0).
        let t = if regular { uniform(60) } else { uneven(60) };
        let line = |order: f64, s: f64| if s > 0.0 { power(1.0, s, order, Kind::RiemannLiouville) } else { 0.0 };
        let kinked = |order: f64, s: f64| kinks.iter().map(|(k, c)| c * line(order, s - t[*k])).sum::<f64>();
        let x: Vec<f64> = t.iter().map(|&s| start + kinked(0.0, s)).collect();
        let exact = t.iter().map(|&s| start * power(0.0, s, alpha, Kind::Caputo) + kinked(alpha, s));
        let y = derivative(Scheme::L1, &t, &x, alpha, Kind::Caputo);
        assert_close(&y, exact, 1e-12, &format!("alpha = {alpha}"));
    }

    #[test]
    fn l1_2_is_exact_on_parabolas_but_for_the_straight_first_step(alpha in -2.0f64..2.0, regular in any::<bool>()) {
        let t = if regular { uniform(150) } else { uneven(150) };
        let x: Vec<f64> = t.iter().map(|t| 0.4 - t + 1.5 * t * t).collect();
        let first = t[1];
        for kind in KINDS {
            let exact = t.iter().map(|&s| {
                // Missing: 1.5/Γ(1−α) ∫₀^first (s−τ)^−α (2τ − first) dτ, above α = 1 its finite part.
                let rest = |p: f64| if s > first { (s - first).powf(p) } else { 0.0 };
                let integral = |p: f64| s.powf(p) - rest(p);
                let missing = (2.0 * s - first) * integral(1.0 - alpha) * reciprocal_gamma(2.0 - alpha)
                    - 2.0 * (1.0 - alpha) * integral(2.0 - alpha) * reciprocal_gamma(3.0 - alpha);
                let power = |k| power(k, s, alpha, kind);
                0.4 * power(0.0) - power(1.0) + 1.5 * (power(2.0) - missing)
            });
            let y = derivative(Scheme::L12, &t, &x, alpha, kind);
            // x is right to ε and divided by h^alpha, h ≥ 0.006.
            let tolerance = 2e-12 + 16.0 * f64::EPSILON * 0.006f64.powf(-alpha);
            assert_close(&y, exact, tolerance, &format!("alpha = {alpha}, regular {regular}, {kind:?}"));
        }
    }

    #[test]
    fn transformed_convolution_is_the_direct_sum(
        weights in prop::collection::vec(-1.0f64..1.0, 1..1100),
        x in prop::collection::vec(-1.0f64..1.0, 1..1100),
    ) {
        let (fast, direct) = (causal_convolution(&weights, &x), direct_convolution(&weights, &x));
        prop_assert_eq!(fast.len(), x.len());
        for (n, (a, b)) in fast.iter().zip(&direct).enumerate() {
            prop_assert!((a - b).abs() < 2e-13, "row {}: {} {}", n, a, b);
        }
    }

    #[test]
    fn the_two_kinds_differ_by_the_jumps_at_the_start(alpha in 0.01f64..1.99, start in -3.0f64..3.0) {
        let t = uniform(300);
        let x: Vec<f64> = t.iter().map(|t| start + (5.0 * t).sin()).collect();
        let rate: Vec<f64> = t.iter().map(|t| 5.0 * (5.0 * t).cos()).collect();
        // The cut memory alone has no closed form of what it leaves of the jump.
        for scheme in all_schemes().into_iter().filter(|s| *s != Scheme::ShortGrunwaldLetnikov(30)) {
            if !scheme.orders().contains(&alpha) {
                continue;
            }
            let samples = Samples { t: &t, x: &x, rate: Some(&rate) };
            let [caputo, rl] = KINDS.map(|kind| scheme.differentiate(&samples, alpha, kind).unwrap());
            let speed = if alpha > 1.0 { 5.0 } else { 0.0 };
            for n in 1..t.len() {
                let jumps = start * power(0.0, t[n], alpha, Kind::RiemannLiouville)
                    + speed * power(1.0, t[n], alpha, Kind::RiemannLiouville);
                // Grünwald–Letnikov sums the constant and the line too.
                let sums = if scheme == Scheme::GrunwaldLetnikov { 1.05 } else { 0.0 };
                let missed = sums * (start.abs() / n as f64 + speed * 0.01) * t[n].powf(-alpha);
                let rounding = 1e-12 + 64.0 * f64::EPSILON * 100f64.powf(alpha);
                prop_assert!((rl[n] - caputo[n] - jumps).abs() < missed + rounding, "{} row {}", scheme, n);
            }
        }
    }

    #[test]
    fn integrals_are_the_same_for_both_kinds_and_begin_at_zero(alpha in -2.0f64..-0.01, start in -3.0f64..3.0) {
        let t = uniform(150);
        let x: Vec<f64> = t.iter().map(|t| start + (5.0 * t).sin()).collect();
        for scheme in all_schemes().into_iter().filter(|scheme| scheme.orders().contains(&alpha)) {
            let [caputo, rl] = KINDS.map(|kind| derivative(scheme, &t, &x, alpha, kind));
            prop_assert_eq!(&caputo, &rl, "{}", scheme);
            prop_assert_eq!(caputo[0], 0.0);
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
fn grunwald_letnikov_is_a_semigroup_to_rounding() {
    // (1−z)^a (1−z)^b = (1−z)^{a+b}, whatever the samples are.
    let t = uniform(500);
    let x: Vec<f64> = t.iter().enumerate().map(|(n, t)| (3.0 * t).sin() + if n % 7 == 3 { 1.0 } else { 0.2 }).collect();
    let gl = |x: &[f64], order: f64| {
        let mut y = derivative(Scheme::GrunwaldLetnikov, &t, x, order, Kind::RiemannLiouville);
        // Row 0 of the sum itself, which the derivative's limit replaces.
        y[0] = 0.01f64.powf(-order) * x[0];
        y
    };
    for (a, b) in [(-0.7, -0.5), (0.4, 0.3), (0.6, -0.6), (-1.5, 1.2), (0.8, 0.9), (1.9, -1.9)] {
        let twice = gl(&gl(&x, b), a);
        let once = if a + b == 0.0 { x.clone() } else { gl(&x, a + b) };
        let size = 0.01f64.powf(-a.max(0.0) - b.max(0.0)) * 5f64.powf((-a).max(0.0) + (-b).max(0.0));
        assert_close(&twice, once.iter().copied(), 1e-14 * size, &format!("{a} + {b}"));
    }
}

#[test]
fn discontinuous_samples_are_a_steep_line_to_l1() {
    // x jumps from 0 to 1 between rows 40 and 41: exact for that ramp, and within O(h) of the step itself behind it.
    let ramp = |t: &[f64], order: f64, s: f64| {
        let kink =
            |from: f64| if s > from { (s - from).powf(1.0 - order) * reciprocal_gamma(2.0 - order) } else { 0.0 };
        (kink(t[40]) - kink(t[41])) / (t[41] - t[40])
    };
    for t in [uniform(100), uneven(100)] {
        let x: Vec<f64> = (0..t.len()).map(|n| if n > 40 { 1.0 } else { 0.0 }).collect();
        for order in [-1.5, -1.0, -0.3, 0.1, 0.5, 0.99] {
            let y = derivative(Scheme::L1, &t, &x, order, Kind::Caputo);
            assert_close(&y, t.iter().map(|&s| ramp(&t, order, s)), 1e-11, &format!("order {order}"));
            let middle = 0.5 * (t[40] + t[41]);
            for n in 60..t.len() {
                let step = power(0.0, t[n] - middle, order, Kind::RiemannLiouville);
                // The ramp is the mean over one step, symmetric about its middle: an error of order h².
                assert!((y[n] - step).abs() < 2.0 * step.abs() / f64::from((n as i32 - 40).pow(2)), "{order} {n}");
            }
        }
    }
}

#[test]
fn a_cut_memory_costs_what_the_principle_of_short_memory_says() {
    let t = uniform(2000);
    for (name, x) in
        [("constant", vec![1.0; t.len()]), ("wave", t.iter().map(|t| (0.7 * t).cos()).collect::<Vec<f64>>())]
    {
        for memory in [100u32, 400] {
            let length = f64::from(memory) * 0.01;
            for order in [0.1, 0.5, 0.9, 1.5] {
                let [whole, short] = [Scheme::GrunwaldLetnikov, Scheme::ShortGrunwaldLetnikov(memory)]
                    .map(|scheme| derivative(scheme, &t, &x, order, Kind::RiemannLiouville));
                // Up to N samples nothing is cut.
                assert_close(&short[..=memory as usize], whole.iter().copied(), 1e-9, name);
                let largest = whole.iter().zip(&short).skip(1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                // The bound is that of the integral; the sum's own is larger by order (order − 1)/(2N) of it.
                let slack = 1.0 + order / f64::from(memory);
                let bound = slack * length.powf(-order) * reciprocal_gamma(1.0 - order).abs();
                assert!(largest < bound, "{name}, {order}: {largest} above {bound}");
                if name == "constant" {
                    // After t ≫ L it is reached up to the part (L/t)^order that the whole memory has lost by itself.
                    let reached = 1.0 - (length / 20.0).powf(order);
                    assert!(largest > 0.99 * bound / slack * reached, "{order}: {largest}, bound {bound}");
                }
            }
        }
    }
    // Caputo counts from x(0), above order 1 from x(0) + x'(0) t as the whole sum does.
    let line: Vec<f64> = t.iter().map(|t| 3.0 + 2.0 * t).collect();
    let x: Vec<f64> = t.iter().map(|t| 3.0 + (2.0 * t).sin()).collect();
    for order in [0.5, 1.5] {
        let [whole, short] = [Scheme::GrunwaldLetnikov, Scheme::ShortGrunwaldLetnikov(300)]
            .map(|scheme| derivative(scheme, &t, &x, order, Kind::Caputo));
        let bound = 1.01 * 3f64.powf(-order) * reciprocal_gamma(1.0 - order).abs();
        assert!(whole.iter().zip(&short).all(|(a, b)| (a - b).abs() < bound), "{order}");
    }
    let straight = derivative(Scheme::GrunwaldLetnikov, &t, &line, 1.5, Kind::Caputo);
    assert!(straight.iter().all(|y| y.abs() < 1e-10));
}

#[test]
fn noise_in_the_first_samples_fades() {
    // A change of the first samples by δ is worth δ h^−a in a row of its own, less by t^−a or t^{−a−1} later on.
    let t = uniform(4000);
    for p in 1..=6u8 {
        for order in [-1.5, -0.5, 0.5, 1.5] {
            let x: Vec<f64> =
                (0..t.len()).map(|n| [0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0].get(n).map_or(0.0, |x| *x)).collect();
            let y = derivative(Scheme::Fbdf(p), &t, &x, order, Kind::RiemannLiouville);
            let degree = f64::from(p) - 1.0 + f64::max(0.0, order.ceil());
            let size = |n: usize| {
                let n = n as f64;
                // What the sum itself leaves of the first samples, and the start polynomial's top coefficient.
                let fade = if order > 1.0 {
                    n.powf(1.0 - order)
                } else if order > 0.0 {
                    n.powf(-order)
                } else {
                    n.powf(-order - 1.0)
                };
                0.01f64.powf(-order) * 2f64.powf(degree) * 2.0 * fade
            };
            for n in [100, 1000, 4000] {
                assert!(y[n].abs() < size(n), "fbdf-{p}, order {order}, row {n}: {:.2e} {:.2e}", y[n], size(n));
            }
        }
    }
}

#[test]
fn direct_rows_agree_with_transformed_ones() {
    let regular = uniform(500);
    let function = |t: f64| 0.2 + (3.0 * t).sin() + t * t;
    let x: Vec<f64> = regular.iter().map(|&t| function(t)).collect();
    for alpha in [-1.7, -1.0, -0.4, 0.05, 0.5, 0.95, 1.0, 1.4, 2.0] {
        // The first step split in two on its chord is the same broken line, summed term by term.
        let (mut t, mut line) = (regular.clone(), x.clone());
        t.insert(1, 0.5 * regular[1]);
        line.insert(1, 0.5 * (x[0] + x[1]));
        if alpha <= 1.0 {
            let direct = derivative(Scheme::L1, &t, &line, alpha, Kind::RiemannLiouville);
            let fast = derivative(Scheme::L1, &regular, &x, alpha, Kind::RiemannLiouville);
            assert_close(&direct[1..], fast[..].iter().copied(), 1e-11, &format!("l1, alpha = {alpha}"));
        }

        // A first step off by 1e-8 sends every row to the direct sums and moves the result as little.
        let mut t = regular.clone();
        t[1] *= 1.0 + 1e-8;
        assert_eq!(Samples { t: &t, x: &x, rate: None }.uniform_prefix().rows, 2);
        let moved: Vec<f64> = t.iter().map(|&t| function(t)).collect();
        for scheme in [Scheme::L1, Scheme::L12].into_iter().filter(|scheme| scheme.orders().contains(&alpha)) {
            let direct = derivative(scheme, &t, &moved, alpha, Kind::Caputo);
            let fast = derivative(scheme, &regular, &x, alpha, Kind::Caputo);
            let moved_by = 1e-7 * 100f64.powf((alpha - 1.0).max(0.0));
            assert_close(&direct, fast.iter().copied(), moved_by, &format!("{scheme}, alpha = {alpha}"));
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
