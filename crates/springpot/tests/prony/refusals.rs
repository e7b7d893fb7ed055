//! What has no Prony series.

use springpot::fractional::prony::{FractionalZener, PronyError, PronySeries, Slowest, Spectrum, Springpot, Window};

const SECOND: Window = Window::Times { from: 1e-3, to: 1.0 };

fn of(material: &impl springpot::fractional::prony::Relaxation, window: Window, tolerance: f64) -> PronyError {
    PronySeries::new(material, window, tolerance, Slowest::Relaxes).unwrap_err()
}

#[test]
fn impossible_materials() {
    for order in [0.0, 1.0, -0.5, f64::NAN] {
        assert!(matches!(Springpot::new(1.0, order, 0.0), Err(PronyError::Order(_))), "{order}");
        assert!(matches!(FractionalZener::new(0.0, 1.0, order, 1.0), Err(PronyError::Order(_))), "{order}");
    }
    for modulus in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(Springpot::new(modulus, 0.5, 0.0), Err(PronyError::Modulus(modulus)));
    }
    assert_eq!(Springpot::new(1.0, 0.5, -2.0), Err(PronyError::Modulus(-2.0)));
    assert!(matches!(FractionalZener::new(1.0, 1.0, 0.5, 0.0), Err(PronyError::Time(0.0))));
}

#[test]
fn impossible_windows_and_tolerances() {
    let springpot = Springpot::new(1.0, 0.5, 0.0).unwrap();
    for (from, to) in [(1.0, 1.0), (2.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (1.0, f64::INFINITY), (1e-9, 1e9)] {
        assert_eq!(of(&springpot, Window::Times { from, to }, 1e-4), PronyError::Window { from, to });
    }
    assert!(matches!(of(&springpot, Window::Times { from: f64::NAN, to: 1.0 }, 1e-4), PronyError::Window { .. }));
    for tolerance in [1e-12, 0.2, -1.0] {
        assert_eq!(of(&springpot, SECOND, tolerance), PronyError::Tolerance(tolerance));
    }
}

#[test]
fn spectra_that_are_none() {
    let negative = Spectrum::new(0.0, |tau: f64| if tau > 0.1 { -1.0 } else { tau }).unwrap();
    assert!(matches!(of(&negative, SECOND, 1e-4), PronyError::Spectrum { value: -1.0, .. }));
    let broken = Spectrum::new(0.0, |_| f64::NAN).unwrap();
    assert!(matches!(of(&broken, SECOND, 1e-4), PronyError::Spectrum { .. }));
    // A spectrum with edges is not smooth: no step of the rule is fine enough for ten digits.
    let edged = Spectrum::new(0.0, |tau: f64| if (0.01..1.0).contains(&tau) { 1.0 } else { 0.0 }).unwrap();
    assert!(matches!(of(&edged, SECOND, 1e-9), PronyError::Bound { tolerance: 1e-9, .. }));
}
