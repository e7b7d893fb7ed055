//! Closures: rough starts, unknown kinks, noise.

use super::support::{Function, Random, of_power};
use springpot::fractional::{Definition, DerivativeError, FunctionError, Piecewise};

#[test]
fn powers_that_are_no_polynomials_at_the_start() {
    for power in [0.1, 0.5, 1.5, 2.5] {
        let x = Piecewise::of(|t| t.powf(power), 0.0..=10.0, 1e-15).unwrap();
        for order in [-1.5, -0.5, 0.1, 0.5, 0.9, 0.99, 1.0, 1.5, 1.99] {
            // x must have as many derivatives as the order needs.
            if order > power + 1.0 || (order > 1.0 && power < 1.0) {
                continue;
            }
            let derivative = x.derivative(order, Definition::RiemannLiouville).unwrap();
            let scale = [0.01, 10.0].map(|t| of_power(power, order, t).abs()).into_iter().fold(0.0, f64::max);
            for t in [0.01, 0.03, 0.5, 1.0, 3.3, 10.0] {
                let (estimate, exact) = (derivative.at(t), of_power(power, order, t));
                let error = (estimate.value - exact).abs();
                // Second derivatives of degree 16 magnify rounding.
                let bound = if order > 1.0 { 1e-9 } else { 1e-10 };
                assert!(error <= bound * scale.max(1.0), "D^{order} t^{power} at {t}: {error:e}");
                assert!(error <= estimate.error && estimate.error <= 1e-8 * scale.max(1.0), "{estimate:?}");
            }
        }
    }
}

/// D^order of t^power at a random time of a random interval, Caputo or Riemann–Liouville, where it is defined: the error
/// stays below its estimate, and where x' is finite or asked for no more than once both are small.
fn random_powers(count: usize, seed: u64) {
    let mut random = Random(seed);
    let (mut compared, mut worst) = (0, 0.0f64);
    while compared < count {
        let power = match (4.0 * random.next()) as u32 {
            0 => 1.0 + 0.4 * random.next(),
            1 => 2.0 + 0.2 * random.next(),
            _ => 3.0 * random.next(),
        };
        let order = match (4.0 * random.next()) as u32 {
            0 => 1.0 + 0.4 * random.next(),
            1 => 1.0 + random.next(),
            _ => 4.0 * random.next() - 2.0,
        };
        let end = 10f64.powf(3.0 * random.next() - 1.0);
        let t = end * random.next();
        let caputo = random.next() < 0.5;
        if caputo && order > 1.0 && power < 1.0 {
            continue;
        }
        let definition = if caputo { Definition::Caputo } else { Definition::RiemannLiouville };
        let x = Piecewise::of(|t| t.powf(power), 0.0..=end, 1e-15).unwrap();
        let (found, exact) = (x.derivative(order, definition).unwrap().at(t), of_power(power, order, t));
        let error = (found.value - exact).abs();
        let case = format!("{definition} D^{order} t^{power} at {t} of {end}: {found:?}, not {exact}");
        assert!(error <= found.error, "{case}");
        if power >= 1.0 || order <= 1.0 {
            assert!(found.error <= 1e-5 * exact.abs().max(t.powf(power - order)), "{case}");
        }
        worst = worst.max(error / found.error);
        compared += 1;
    }
    println!("{compared} powers, worst error over estimate {worst:.2}");
}

#[test]
fn random_powers_stay_below_their_estimates() {
    random_powers(150, 1);
}

/// Some ten seconds.
#[test]
#[ignore = "takes long"]
fn three_thousand_random_powers_stay_below_their_estimates() {
    random_powers(3000, 7);
}

/// t^1.05 has x'(0) = 0, but at no time that a computer can tell from 0.
#[test]
fn starts_that_are_almost_lines() {
    for (power, order) in [(1.05, 1.02), (1.1, 1.05), (1.2, 1.1), (1.01, 1.005), (1.003, 1.5)] {
        // A line, and a second power.
        for (slope, other) in [(0.0, 0.0), (3.0, 0.0), (-1.0, 0.5)] {
            let x =
                Piecewise::of(|t| t.powf(power) + slope * t + other * t.powf(power + 0.7), 0.0..=2.0, 1e-15).unwrap();
            let caputo = x.derivative(order, Definition::Caputo).unwrap();
            for t in [0.01, 0.4, 1.0, 2.0] {
                let exact = of_power(power, order, t) + other * of_power(power + 0.7, order, t);
                let found = caputo.at(t);
                let error = (found.value - exact).abs();
                assert!(
                    error <= found.error && found.error < 1e-5,
                    "D^{order} t^{power} at {t}: {found:?}, not {exact}"
                );
            }
            let rl = x.derivative(order, Definition::RiemannLiouville).unwrap();
            let first = x.derivative(1.0, Definition::Caputo).unwrap().at(0.0).value;
            assert!((first - slope).abs() < 1e-6, "x'(0) of t^{power} + {slope} t: {first}");
            assert_eq!(rl.at(0.0).value.is_nan(), slope != 0.0, "t^{power} + {slope} t");
        }
    }
    // x'(0) is infinite: there is no Caputo derivative above order 1, and the estimate says so.
    for power in [0.1, 0.5, 0.99] {
        let x = Piecewise::of(|t| t.powf(power), 0.0..=2.0, 1e-15).unwrap();
        assert_eq!(x.derivative(1.3, Definition::Caputo).unwrap().at(1.0).error, f64::INFINITY);
    }
}

/// Below order 1 kinks and jumps at unknown times are closed in; above it the estimate says that they were not.
#[test]
fn unknown_kinks_and_jumps() {
    let functions: [(Function, f64); 2] =
        [(|t| (t - 1.3).abs() + t - 1.3, 1.0), (|t| if t > 1.3 { 2.0 } else { 0.0 }, 0.0)];
    for (function, power) in functions {
        let x = Piecewise::of(function, 0.0..=10.0, 1e-15).unwrap();
        for order in [-1.5, -0.5, 0.1, 0.5, 0.99, 1.5] {
            let derivative = x.derivative(order, Definition::Caputo).unwrap();
            for t in [0.7f64, 1.2, 1.31, 2.0, 9.5] {
                let exact = if t > 1.3 { 2.0 * of_power(power, order, t - 1.3) } else { 0.0 };
                let estimate = derivative.at(t);
                let error = (estimate.value - exact).abs();
                assert!(error <= estimate.error.max(1e-11), "a = {order}, t = {t}: {error:e} {estimate:?}");
                assert!(order > 1.0 || error <= 1e-11, "a = {order}, t = {t}: {error:e}");
            }
        }
    }
}

/// The estimate follows the tolerance, and the error stays below it.
#[test]
fn looser_tolerances_are_estimated() {
    let function = |t: f64| (3.0 * t).sin() / (1.0 + t);
    let exact = Piecewise::of(function, 0.0..=10.0, 1e-15).unwrap();
    for (rtol, most) in [(1e-4, 1e-1), (1e-7, 1e-4), (1e-10, 1e-7)] {
        let rough = Piecewise::of(function, 0.0..=10.0, rtol).unwrap();
        assert!(rough.pieces() <= exact.pieces());
        let at = |x: &Piecewise, t: f64| x.derivative(0.7, Definition::Caputo).unwrap().at(t);
        for t in [0.1, 1.0, 5.5, 9.9] {
            let estimate = at(&rough, t);
            assert!((estimate.value - at(&exact, t).value).abs() <= estimate.error && estimate.error < most);
        }
    }
}

#[test]
fn any_interval_has_its_own_start() {
    let shifted = Piecewise::of(|t| (t - 5.0).sin(), 5.0..=9.0, 1e-15).unwrap();
    let plain = Piecewise::of(f64::sin, 0.0..=4.0, 1e-15).unwrap();
    for order in [-0.5, 0.5, 1.5] {
        let [a, b] = [&shifted, &plain].map(|x| x.derivative(order, Definition::Caputo).unwrap());
        for t in [0.0, 0.1, 1.7, 4.0] {
            assert!((a.at(5.0 + t).value - b.at(t).value).abs() < 1e-10);
        }
        assert!(a.at(4.9).value.is_nan() && a.at(9.1).value.is_nan() && a.at(f64::NAN).value.is_nan());
    }
    assert!((shifted.value(6.0) - 1f64.sin()).abs() < 1e-14 && shifted.value(0.0).is_nan());
}

#[test]
fn what_is_refused() {
    let of = |f: fn(f64) -> f64, start: f64, end: f64, rtol: f64| Piecewise::of(f, start..=end, rtol).unwrap_err();
    assert!(matches!(of(|t| t, 1.0, 1.0, 1e-9), FunctionError::Interval { .. }));
    assert!(matches!(of(|t| t, 0.0, f64::NAN, 1e-9), FunctionError::Interval { .. }));
    assert!(matches!(of(|t| t, 0.0, f64::INFINITY, 1e-9), FunctionError::Interval { .. }));
    assert_eq!(of(|t| t, 0.0, 1.0, 1e-16), FunctionError::Tolerance(1e-16));
    assert!(matches!(of(|t| 1.0 / t, 0.0, 1.0, 1e-9), FunctionError::NotFinite { t: 0.0, .. }));
    assert!(matches!(of(|t| (t - 1.0).sqrt(), 0.0, 3.0, 1e-9), FunctionError::NotFinite { .. }));
    // A new random number at every call.
    let mut seed = std::cell::Cell::new(1u64);
    let noise = |_: f64| {
        seed.set(seed.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        (seed.get() >> 40) as f64
    };
    assert!(matches!(Piecewise::of(noise, 0.0..=1.0, 1e-9), Err(FunctionError::Unresolved { .. })));
    seed.get_mut();

    let x = Piecewise::of(|t| t, 0.0..=1.0, 1e-9).unwrap();
    for order in [-2.1, 2.001, f64::NAN, f64::INFINITY] {
        assert!(matches!(x.derivative(order, Definition::Caputo), Err(DerivativeError::Order(_))));
    }
    let next = Piecewise::of(|t| t, 1.5..=2.0, 1e-9).unwrap();
    assert_eq!(x.then(next).unwrap_err(), FunctionError::Interval { start: 1.0, end: 1.5 });
    assert!(matches!(Piecewise::spline(&[3.0], &[1.0]), Err(FunctionError::Samples(_))));
    assert!(matches!(Piecewise::spline(&[3.0, 3.0], &[1.0, 2.0]), Err(FunctionError::Samples(_))));
    assert!(matches!(Piecewise::spline(&[3.0, 4.0], &[1.0, f64::NAN]), Err(FunctionError::Samples(_))));
}
