//! What is out of range, infinite or no number.

use springpot::fractional::gamma::reciprocal_gamma;
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler, MittagLefflerError, mittag_leffler};

#[test]
fn parameters_out_of_range_are_refused() {
    for a in [0.0, -0.5, 5.1, 1e-310, f64::INFINITY] {
        assert_eq!(MittagLeffler::new(a, 1.0).unwrap_err(), MittagLefflerError::Order(a));
    }
    assert!(matches!(MittagLeffler::new(f64::NAN, 1.0), Err(MittagLefflerError::Order(_))));
    for b in [20.1, -21.0, f64::NEG_INFINITY] {
        assert_eq!(MittagLeffler::new(0.5, b).unwrap_err(), MittagLefflerError::Parameter(b));
    }
    assert!(matches!(mittag_leffler(0.5, f64::NAN, Complex64::ZERO), Err(MittagLefflerError::Parameter(_))));
    let error = MittagLeffler::derivative(0.5, 1.0, 11).unwrap_err();
    assert_eq!(error.to_string(), "derivatives of the Mittag-Leffler function go to order 10, not to 11");
}

#[test]
fn what_is_no_number_stays_none() {
    let half = MittagLeffler::new(0.5, 1.0).unwrap();
    assert!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].iter().all(|x| half.real(*x).is_nan()));
    assert!(half.complex(Complex64::new(1.0, f64::NAN)).is_nan());
}

#[test]
fn overflow_is_infinite_and_underflow_is_zero() {
    let half = MittagLeffler::new(0.5, 1.0).unwrap();
    // 2 e^{x²} at the end of the range of f64.
    assert!(half.real(26.6).is_finite() && half.real(26.7) == f64::INFINITY);
    assert_eq!(half.real(1e200), f64::INFINITY);
    assert!(half.complex(Complex64::new(1e3, 1.0)).re.is_infinite());
    let product = half.real(-1e150) * 1e150 * std::f64::consts::PI.sqrt();
    assert!((product - 1.0).abs() < 1e-12, "{product}");
    for n in 0..=3 {
        for z in [Complex64::new(1e3, 1.0), Complex64::new(-1e300, 1e300), Complex64::new(0.0, 1e308)] {
            for a in [1e-3, 0.02, 0.5, 1.0, 1.9, 4.0] {
                let value = MittagLeffler::derivative(a, 1.0, n).unwrap().complex(z);
                assert!(!value.is_nan() || value.re.is_infinite() || value.im.is_infinite(), "{a} {n} {z}: {value}");
            }
        }
    }
}

#[test]
fn the_limits_of_the_order_and_of_the_argument() {
    for b in [-1.5, 0.0, 1.0, 3.3] {
        for a in [1e-300, 1e-9, 0.3, 2.0, 5.0] {
            let function = MittagLeffler::new(a, b).unwrap();
            let at_zero = reciprocal_gamma(b);
            assert!((function.real(0.0) - at_zero).abs() <= 1e-12 * at_zero.abs().max(1e-3), "a = {a}, b = {b}");
            // 1/(Γ(b)(1 − z)) as a → 0.
            if a < 1e-200 {
                for x in [-1e6, -3.0, -1.0, -0.5, 0.5] {
                    let exact = at_zero / (1.0 - x);
                    let error = (function.real(x) - exact).abs();
                    assert!(error <= 1e-12 * exact.abs().max(1e-3), "E_{{{a},{b}}}({x})");
                }
            }
        }
    }
}
