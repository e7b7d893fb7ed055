//! Measured orders of convergence of the grid schemes against independent reference values and closed forms.

use crate::support::{KINDS, derivative, derivative_of_sine, file, number, references};
use springpot::fractional::Kind;
use springpot::fractional::gamma::{gamma, reciprocal_gamma};
use springpot::fractional::scheme::Scheme;

const ALPHAS: [f64; 3] = [0.1, 0.5, 0.9];

type Function = (&'static str, fn(f64) -> f64, usize);

/// The functions of the file, with the refinement that gives each about the same step in radians.
const FUNCTIONS: [Function; 4] = [
    ("0.7*sin(8t)+0.1*t", |t| 0.7 * (8.0 * t).sin() + 0.1 * t, 8),
    ("1+sin(3t)", |t| 1.0 + (3.0 * t).sin(), 2),
    ("cos(3t)", |t| (3.0 * t).cos(), 2),
    ("exp(-t)", |t| (-t).exp(), 1),
];

/// Steps to t = 2 at which the order is measured (fine enough for the asymptotics, coarse enough for rounding).
fn grid_schemes() -> Vec<(Scheme, usize)> {
    let low = [Scheme::GrunwaldLetnikov, Scheme::L1, Scheme::L12, Scheme::Fbdf(1), Scheme::Fbdf(2), Scheme::Fbdf(3)];
    let high = [(Scheme::Fbdf(4), 80), (Scheme::Fbdf(5), 48), (Scheme::Fbdf(6), 40)];
    low.map(|scheme| (scheme, 320)).into_iter().chain(high).collect()
}

fn uniform(end: f64, steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| end * k as f64 / steps as f64).collect()
}

#[test]
fn every_scheme_shows_its_order_on_the_reference_functions() {
    let file = file();
    let mut compared = 0;
    for (name, function, refinement) in FUNCTIONS {
        let rows: Vec<_> = references(&file, name).into_iter().filter(|r| (0.5..=2.0).contains(&r.t)).collect();
        for (scheme, steps) in grid_schemes() {
            for alpha in ALPHAS {
                for kind in KINDS {
                    let mut error = |steps: usize| -> f64 {
                        let t = uniform(2.0, steps);
                        let x: Vec<f64> = t.iter().map(|&t| function(t)).collect();
                        let y = derivative(scheme, &t, &x, alpha, kind);
                        let errors = rows.iter().filter(|r| r.alpha == alpha).map(|r| {
                            compared += 1;
                            (y[(r.t * steps as f64 / 2.0).round() as usize] - r.value(kind)).abs()
                        });
                        errors.fold(0.0, f64::max)
                    };
                    let (coarse, fine) = (error(steps * refinement), error(2 * steps * refinement));
                    let order = (coarse / fine).log2();
                    assert!(
                        (order - scheme.order(alpha)).abs() < 0.25,
                        "{scheme}, {name}, alpha = {alpha}, {kind:?}: order {order:.2}, errors {coarse:.2e} {fine:.2e}"
                    );
                }
            }
        }
    }
    // 4 functions · 9 schemes · 3 alphas · 2 kinds · 2 grids · 5 times
    assert_eq!(compared, 4 * 9 * 3 * 2 * 2 * 5);
}

/// Caputo derivative or integral of e^−t by its power series.
fn caputo_of_decay(t: f64, alpha: f64) -> f64 {
    let term = |k: i32| (-1f64).powi(k) * t.powf(f64::from(k) - alpha) * reciprocal_gamma(f64::from(k) + 1.0 - alpha);
    (alpha.ceil().max(0.0) as i32..60).map(term).sum()
}

/// Derivative or integral of 1 + sin 3t by its power series.
fn series_of_wave(t: f64, order: f64, kind: Kind) -> f64 {
    let least = if kind == Kind::Caputo { order.ceil().max(0.0) as i32 } else { 0 };
    let term = |k: i32| {
        let coefficient = match k {
            0 => 1.0,
            k if k % 2 == 0 => 0.0,
            k => 3f64.powi(k) * if k % 4 == 1 { 1.0 } else { -1.0 },
        };
        coefficient * t.powf(f64::from(k) - order) * reciprocal_gamma(f64::from(k) + 1.0 - order)
    };
    (least..60).map(term).sum()
}

#[test]
fn every_scheme_shows_its_order_from_double_integrals_to_second_derivatives() {
    let mut measured = 0;
    for (scheme, steps) in grid_schemes() {
        for order in [-2.0, -1.5, -1.0, -0.5, -0.1, 0.1, 0.5, 0.9, 0.99, 1.0, 1.1, 1.5, 1.9, 2.0] {
            if !scheme.orders().contains(&order) {
                continue;
            }
            for kind in KINDS {
                let error = |steps: usize| -> f64 {
                    let t = uniform(2.0, steps);
                    let x: Vec<f64> = t.iter().map(|t| 1.0 + (3.0 * t).sin()).collect();
                    let y = derivative(scheme, &t, &x, order, kind);
                    let rows = t.iter().zip(&y).filter(|(t, _)| **t > 0.5);
                    rows.map(|(t, y)| (y - series_of_wave(*t, order, kind)).abs()).fold(0.0, f64::max)
                };
                let (coarse, fine) = (error(2 * steps), error(4 * steps));
                let found = (coarse / fine).log2();
                assert!(
                    (found - scheme.order(order)).abs() < 0.25,
                    "{scheme}, order {order}, {kind:?}: {found:.2}, errors {coarse:.2e} {fine:.2e}"
                );
                measured += 1;
            }
        }
    }
    // 8 schemes have all of them, l1 lacks four.
    assert_eq!(measured, 2 * (8 * 14 + 10));
}

#[test]
fn one_after_the_other_is_both_at_once() {
    // D^a D^b x = D^{a+b} x up to the error of the scheme, for x = t⁸ e^−2t, which starts so flat that all are smooth.
    for (scheme, steps) in grid_schemes() {
        for (a, b) in [(-0.7, -0.5), (-1.2, -0.8), (0.6, -0.6), (0.4, 0.3), (0.9, 0.7)] {
            let orders = [a, b, a + b];
            if !orders.iter().all(|order| scheme.orders().contains(order)) {
                continue;
            }
            let error = |steps: usize| -> f64 {
                let t = uniform(2.0, steps);
                let x: Vec<f64> = t.iter().map(|t| t.powi(8) * (-2.0 * t).exp()).collect();
                let [first, once] = [b, a + b].map(|order| derivative(scheme, &t, &x, order, Kind::RiemannLiouville));
                let twice = derivative(scheme, &t, &first, a, Kind::RiemannLiouville);
                let rows = t.iter().zip(twice.iter().zip(&once)).filter(|(t, _)| **t > 0.5);
                rows.map(|(_, (twice, once))| (twice - once).abs()).fold(0.0, f64::max)
            };
            let wanted = orders.iter().map(|order| scheme.order(*order)).fold(f64::INFINITY, f64::min);
            let (coarse, fine) = (error(2 * steps), error(4 * steps));
            let found = (coarse / fine).log2();
            // Powers of one formula commute by themselves, to rounding.
            let commute = fine < 1e-13 * f64::powf(2.0 * steps as f64, a.max(0.0) + b.max(0.0));
            assert!(commute || found > wanted - 0.25, "{scheme}, {a} + {b}: {found:.2} for {wanted:.2}, {fine:.1e}");
            let must_commute = matches!(scheme, Scheme::GrunwaldLetnikov);
            assert!(commute || !must_commute, "{a} + {b}: {fine:.1e}");
        }
    }
}

#[test]
fn starting_corrections_do_not_spoil_coarse_samples() {
    // Corrections are differences of large numbers up to row 256 and series behind. Where a wave turns by 0.3 rad in a
    // step its Taylor polynomial is some 10⁸ there, and the errors before and behind must still be the formula's own.
    for r in references(&file(), "0.7*sin(8t)+0.1*t").iter().filter(|r| r.t >= 0.05) {
        let line = r.t.powf(1.0 - r.alpha) * reciprocal_gamma(2.0 - r.alpha);
        let own = 0.7 * derivative_of_sine(r.t, 8.0, r.alpha) + 0.1 * line;
        assert!((own - r.rl).abs() < 1e-13 * 8f64.powf(r.alpha), "closed form: {r:?} {own}");
    }
    let t = uniform(60.0, 600);
    let x: Vec<f64> = t.iter().map(|t| (3.0 * t).sin()).collect();
    for p in 3..=6 {
        for order in [-0.9, -0.5, 0.1, 0.5, 0.9, 1.5, 1.95] {
            let y = derivative(Scheme::Fbdf(p), &t, &x, order, Kind::RiemannLiouville);
            let error = |rows: std::ops::Range<usize>| {
                rows.map(|n| (y[n] - derivative_of_sine(t[n], 3.0, order)).abs()).fold(0.0, f64::max)
            };
            let (before, behind) = (error(150..256), error(256..600));
            // The formula's symbol errs by |order|/(p+1) (ωh)^p of the derivative.
            let leading = order.abs() / f64::from(p + 1) * 0.3f64.powi(p.into()) * 3f64.powf(order);
            assert!(before < 3.0 * leading, "fbdf-{p}, order {order}: {before:.1e}, leading {leading:.1e}");
            assert!((0.5..2.0).contains(&(behind / before)), "fbdf-{p}, order {order}: {before:.1e} {behind:.1e}");
        }
    }
}

#[test]
fn a_million_rows_do_not_drown_in_rounding() {
    // Dyadic times make t² exact; what is left are the rounding of the sums and, of l1-2, the straight first step.
    let (rows, step) = (1_000_001, 2f64.powi(-17));
    let t: Vec<f64> = (0..rows).map(|k| k as f64 * step).collect();
    let x: Vec<f64> = t.iter().map(|t| t * t).collect();
    let end = t[rows - 1];
    for (scheme, order) in [(Scheme::L12, -1.5), (Scheme::Fbdf(3), -0.5), (Scheme::Fbdf(2), 1.5), (Scheme::L12, 1.5)] {
        let y = derivative(scheme, &t, &x, order, Kind::Caputo);
        let exact = |t: f64| 2.0 * t.powf(2.0 - order) * reciprocal_gamma(3.0 - order);
        let error = (1000..rows).step_by(997).map(|n| (y[n] - exact(t[n])).abs()).fold(0.0, f64::max);
        // An ulp of ‖w‖‖Δx‖ h^−a for derivatives, some of the largest value for integrals.
        let differences = 2.0 * step * end * (rows as f64 / 3.0).sqrt();
        let size = if order > 0.0 { differences * step.powf(-order) } else { 4.0 * end.powf(2.0 - order) };
        let rounding = f64::EPSILON * size;
        assert!(error < rounding, "{scheme}, order {order}: {error:.1e}, allowed {rounding:.1e}");
    }
}

#[test]
fn backward_differences_keep_their_order_in_every_row() {
    // e^−t has x(0), x'(0), x''(0), … ≠ 0: without starting weights all orders drop to 1 and less.
    for (order, steps) in [(1, 160), (2, 160), (3, 160), (4, 80), (5, 40), (6, 40)] {
        for alpha in [-2.0, -1.5, -1.0, -0.5, -0.1, 0.05, 0.1, 0.5, 0.9, 0.99, 1.1, 1.5, 1.9, 2.0] {
            let error = |steps: usize| -> f64 {
                let t = uniform(2.0, steps);
                let x: Vec<f64> = t.iter().map(|t| (-t).exp()).collect();
                let y = derivative(Scheme::Fbdf(order), &t, &x, alpha, Kind::Caputo);
                let errors = t.iter().zip(&y).skip(1).map(|(t, y)| (y - caputo_of_decay(*t, alpha)).abs());
                errors.fold(0.0, f64::max)
            };
            let measured = (error(steps) / error(2 * steps)).log2();
            assert!((measured - f64::from(order)).abs() < 0.25, "fbdf-{order}, alpha = {alpha}: {measured:.2}");
        }
    }
}

#[test]
fn l1_and_l1_2_keep_their_order_on_uneven_grids() {
    // Steps between 0.6 and 1.6 of the mean one, smoothly varying, and the first not special.
    let warp = |u: f64| 2.0 * (u + 0.2 * (std::f64::consts::PI * u).sin().powi(2) * (1.0 - u));
    for scheme in [Scheme::L1, Scheme::L12] {
        for alpha in [-1.5, -0.5, 0.1, 0.5, 0.9, 1.5].into_iter().filter(|alpha| scheme.orders().contains(alpha)) {
            let error = |steps: usize| -> f64 {
                let t: Vec<f64> = (0..=steps).map(|k| warp(k as f64 / steps as f64)).collect();
                let x: Vec<f64> = t.iter().map(|t| (-t).exp()).collect();
                let y = derivative(scheme, &t, &x, alpha, Kind::Caputo);
                let rows = t.iter().zip(&y).filter(|(t, _)| **t > 0.5);
                rows.map(|(t, y)| (y - caputo_of_decay(*t, alpha)).abs()).fold(0.0, f64::max)
            };
            let measured = (error(400) / error(800)).log2();
            assert!((measured - scheme.order(alpha)).abs() < 0.25, "{scheme}, alpha = {alpha}: {measured:.2}");
        }
    }
}

#[test]
fn the_rate_at_alpha_one_has_the_order_of_the_scheme() {
    for (scheme, steps) in grid_schemes() {
        let error = |steps: usize| -> f64 {
            let t = uniform(2.0, steps);
            let x: Vec<f64> = t.iter().map(|t| (3.0 * t).cos() + t).collect();
            let y = derivative(scheme, &t, &x, 1.0, Kind::Caputo);
            // The first step of l1-2 is a straight line, of order 1.
            let skip = usize::from(scheme == Scheme::L12);
            let rows = t.iter().zip(&y).enumerate().filter(|(n, _)| skip == 0 || *n != 1);
            rows.map(|(_, (t, y))| (y - 1.0 + 3.0 * (3.0 * t).sin()).abs()).fold(0.0, f64::max)
        };
        let measured = (error(2 * steps) / error(4 * steps)).log2();
        assert!((measured - scheme.order(1.0)).abs() < 0.25, "{scheme}: {measured:.2}");
    }
}

#[test]
fn the_whole_reference_file_is_met() {
    let file = file();
    let (steps, end) = (5000, 50.0);
    let t = uniform(end, steps);
    let row = |time: f64| (time * steps as f64 / end).round() as usize;
    let mut compared = 0;
    for (name, function, _) in FUNCTIONS {
        let x: Vec<f64> = t.iter().map(|&t| function(t)).collect();
        let all = references(&file, name);
        for alpha in ALPHAS {
            for kind in KINDS {
                let y = derivative(Scheme::Fbdf(6), &t, &x, alpha, kind);
                // Leading error alpha/7 h⁶ |x^(6)|-ish with h = 0.01, at most doubled near the start.
                let frequency: f64 = if name.contains("8t") { 8.0 } else { 3.0 };
                let tolerance = 2.0 / 7.0 * alpha * frequency.powf(6.0 + alpha) * 1e-12 + 1e-11;
                for r in all.iter().filter(|r| r.alpha == alpha) {
                    compared += 1;
                    let error = (y[row(r.t)] - r.value(kind)).abs();
                    assert!(error < tolerance, "{name}, alpha = {alpha}, {kind:?}, t = {}: {error:.1e}", r.t);
                }
            }
        }
    }
    assert_eq!(compared, 480);

    // Powers: integer ones are exact up to rounding; t^0.5 and t^3.7 are not smooth at 0, but fade.
    let mut compared = 0;
    for r in file["powers_t^k"].as_array().unwrap() {
        let (power, alpha, time) = (number(r, "k"), number(r, "alpha"), number(r, "t"));
        let exact = gamma(power + 1.0) * reciprocal_gamma(power + 1.0 - alpha) * time.powf(power - alpha);
        assert!((exact - number(r, "rl")).abs() < 1e-13 * exact.abs(), "closed form: {r}");
        compared += 1;
    }
    assert_eq!(compared, 360);
    for (power, scheme) in [
        (0.0, Scheme::Fbdf(6)),
        (1.0, Scheme::Fbdf(6)),
        (2.0, Scheme::Fbdf(6)),
        (5.0, Scheme::Fbdf(6)),
        (3.7, Scheme::L12),
        (0.5, Scheme::L1),
    ] {
        let x: Vec<f64> = t.iter().map(|t| t.powf(power)).collect();
        for alpha in ALPHAS {
            for kind in KINDS {
                let y = derivative(scheme, &t, &x, alpha, kind);
                for r in file["powers_t^k"].as_array().unwrap() {
                    if number(r, "k") != power || number(r, "alpha") != alpha {
                        continue;
                    }
                    let (time, exact) = (number(r, "t"), number(r, if kind == Kind::Caputo { "caputo" } else { "rl" }));
                    let tolerance = if power.fract() == 0.0 {
                        // Exact but for the rounding of x, which h^−alpha multiplies.
                        16.0 * f64::EPSILON * end.powf(power) * (end / steps as f64).powf(-alpha)
                    } else if time >= 0.2 {
                        // Relative error of row n, up to a constant of order one.
                        2.0 * exact.abs() * (row(time) as f64).powf(-scheme.order(alpha))
                    } else {
                        continue;
                    };
                    let error = (y[row(time)] - exact).abs();
                    assert!(
                        error < tolerance,
                        "t^{power}, {scheme}, alpha = {alpha}, {kind:?}, t = {time}: {error:.1e} of {exact:.1e}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 360 + 4 * 120 + 2 * 102);
}

#[test]
fn long_records_do_not_drown_in_rounding() {
    // 10⁵ samples of ten seconds; the truncation errors are below 1e-10 from order 4 on.
    let rl = references(&file(), "0.7*sin(8t)+0.1*t").into_iter().filter(|r| r.t <= 10.0 && r.t >= 0.05);
    let rows: Vec<_> = rl.collect();
    let t = uniform(10.0, 100_000);
    let x: Vec<f64> = t.iter().map(|t| 0.7 * (8.0 * t).sin() + 0.1 * t).collect();
    for (scheme, alpha, tolerance) in [
        (Scheme::GrunwaldLetnikov, 0.5, 1e-3),
        (Scheme::L1, 0.5, 2e-5),
        (Scheme::L12, 0.5, 1e-8),
        (Scheme::Fbdf(4), 0.1, 1e-11),
        (Scheme::Fbdf(4), 0.5, 1e-11),
        (Scheme::Fbdf(6), 0.5, 1e-11),
        (Scheme::Fbdf(6), 0.9, 1e-9),
    ] {
        let y = derivative(scheme, &t, &x, alpha, Kind::RiemannLiouville);
        for r in rows.iter().filter(|r| r.alpha == alpha) {
            let error = (y[(r.t * 1e4).round() as usize] - r.rl).abs();
            assert!(error < tolerance, "{scheme}, alpha = {alpha}, t = {}: {error:.1e}", r.t);
        }
    }
}
