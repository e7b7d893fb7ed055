//! Completely monotone relaxation moduli and their spectra.

use super::PronyError;
use crate::fractional::gamma::gamma;
use crate::fractional::mittag_leffler::{Complex64, MittagLeffler, MittagLefflerError};
use std::f64::consts::PI;

/// A completely monotone relaxation modulus, G(t) = G_e + ∫ H(τ) e^{−t/τ} d ln τ with G_e ≥ 0 and H ≥ 0.
///
/// By Bernstein's theorem every completely monotone G has this form. G(t) is the stress (or force) at time t after a
/// unit step of strain (or stroke), in any unit of modulus or stiffness; H and G_e are in the same unit.
pub trait Relaxation {
    /// G_e, what never relaxes.
    fn equilibrium(&self) -> f64;

    /// The relaxation spectrum H(τ) for τ > 0, s. For τ → 0 and τ → ∞ it must fall off at least like a power of τ.
    fn spectrum(&self, tau: f64) -> f64;

    /// G(t) for t > 0, s.
    fn relaxation(&self, t: f64) -> f64;

    /// The complex modulus G*(ω) = G' + iG'' at the angular frequency ω > 0, rad/s: G_e + ∫ H(τ) iωτ/(1 + iωτ) d ln τ.
    fn complex_modulus(&self, omega: f64) -> Complex64;
}

/// A springpot beside a spring: G(t) = G_e + c t^−alpha/Γ(1−alpha) and G* = G_e + c (iω)^alpha.
///
/// H(τ) = c sin(π alpha)/π τ^−alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Springpot {
    coefficient: f64,
    order: f64,
    equilibrium: f64,
}

impl Springpot {
    /// From c > 0 in modulus·s^alpha, 0 < alpha < 1 and G_e ≥ 0.
    ///
    /// # Errors
    /// [`PronyError::Order`] and [`PronyError::Modulus`] for values out of range.
    pub fn new(coefficient: f64, order: f64, equilibrium: f64) -> Result<Self, PronyError> {
        check_order(order)?;
        check_moduli(coefficient, equilibrium)?;
        Ok(Self { coefficient, order, equilibrium })
    }
}

impl Relaxation for Springpot {
    fn equilibrium(&self) -> f64 {
        self.equilibrium
    }

    fn spectrum(&self, tau: f64) -> f64 {
        self.coefficient * sine(self.order) / PI * tau.powf(-self.order)
    }

    fn relaxation(&self, t: f64) -> f64 {
        self.equilibrium + self.coefficient * t.powf(-self.order) / gamma(1.0 - self.order)
    }

    fn complex_modulus(&self, omega: f64) -> Complex64 {
        self.equilibrium + Complex64::from_polar(self.coefficient * omega.powf(self.order), 0.5 * PI * self.order)
    }
}

/// The fractional Zener (standard linear) model, a spring beside a spring and a springpot in series.
///
/// With the Mittag-Leffler function, G(t) = G_e + G_1 E_alpha(−(t/τ_1)^alpha); G* = G_e + G_1 x/(1 + x), x = (iωτ_1)^alpha.
/// H(τ) = G_1 sin(π alpha)/π / (y + 2 cos π alpha + 1/y), y = (τ/τ_1)^alpha (Caputo & Mainardi 1971). With G_e = 0 it is
/// the fractional Maxwell model.
#[derive(Debug, Clone)]
pub struct FractionalZener {
    equilibrium: f64,
    modulus: f64,
    order: f64,
    time: f64,
    function: MittagLeffler,
}

impl FractionalZener {
    /// From G_e ≥ 0, G_1 > 0, 0 < alpha < 1 and τ_1 > 0, s.
    ///
    /// # Errors
    /// [`PronyError::Order`], [`PronyError::Modulus`] and [`PronyError::Time`] for values out of range.
    pub fn new(equilibrium: f64, modulus: f64, order: f64, time: f64) -> Result<Self, PronyError> {
        check_order(order)?;
        check_moduli(modulus, equilibrium)?;
        if !(time > 0.0 && time.is_finite()) {
            return Err(PronyError::Time(time));
        }
        let out_of_range = |_: MittagLefflerError| PronyError::Order(order);
        let function = MittagLeffler::new(order, 1.0).map_err(out_of_range)?;
        Ok(Self { equilibrium, modulus, order, time, function })
    }
}

impl Relaxation for FractionalZener {
    fn equilibrium(&self) -> f64 {
        self.equilibrium
    }

    fn spectrum(&self, tau: f64) -> f64 {
        let x = (tau / self.time).powf(self.order);
        // 2(1 + cos πα) taken apart, for α near 1.
        let gap = (0.5 * PI * (1.0 - self.order)).sin();
        let rest = (x.sqrt() - 1.0 / x.sqrt()).powi(2) + 4.0 * gap * gap;
        self.modulus * sine(self.order) / PI / rest
    }

    fn relaxation(&self, t: f64) -> f64 {
        self.equilibrium + self.modulus * self.function.real(-(t / self.time).powf(self.order))
    }

    fn complex_modulus(&self, omega: f64) -> Complex64 {
        let x = Complex64::from_polar((omega * self.time).powf(self.order), 0.5 * PI * self.order);
        self.equilibrium + self.modulus / (1.0 + x.inv())
    }
}

/// A modulus given by its spectrum alone: G_e and a function H(τ) ≥ 0.
///
/// G and G* are integrals over ln τ by the trapezoidal rule, whose step is halved until nothing changes: H should be
/// smooth on the scale of ln τ. Beyond a factor of 1e20 around the time asked for, H is taken for a power of τ.
#[derive(Debug, Clone, Copy)]
pub struct Spectrum<F> {
    equilibrium: f64,
    spectrum: F,
}

impl<F: Fn(f64) -> f64> Spectrum<F> {
    /// From G_e ≥ 0 and H(τ), τ in s.
    ///
    /// # Errors
    /// [`PronyError::Modulus`] for a negative or infinite G_e.
    pub fn new(equilibrium: f64, spectrum: F) -> Result<Self, PronyError> {
        check_moduli(1.0, equilibrium)?;
        Ok(Self { equilibrium, spectrum })
    }

    /// ∫ H(τ) r(τ/unit) d ln τ.
    fn integral(&self, unit: f64, response: impl Fn(f64) -> Complex64) -> Complex64 {
        let sum = |step: f64, offset: f64| -> Complex64 {
            let half = (REACH / step) as i64;
            let term = |k: i64| {
                let x = ((k as f64 + offset) * step).exp();
                (self.spectrum)(unit * x) * response(x) * step
            };
            let geometric = |last: Complex64, before: Complex64| {
                let ratio = last.norm() / before.norm();
                if ratio < 1.0 { last * ratio / (1.0 - ratio) } else { Complex64::ZERO }
            };
            let inner: Complex64 = (-half..=half).map(term).sum();
            inner + geometric(term(half), term(half - 1)) + geometric(term(-half), term(1 - half))
        };
        let (mut step, mut value) = (0.5, sum(0.5, 0.0));
        while step > 0.005 {
            let finer = 0.5 * (value + sum(step, 0.5));
            let change = (finer - value).norm();
            (step, value) = (0.5 * step, finer);
            if change <= 1e-13 * value.norm() {
                break;
            }
        }
        value
    }
}

impl<F: Fn(f64) -> f64> Relaxation for Spectrum<F> {
    fn equilibrium(&self) -> f64 {
        self.equilibrium
    }

    fn spectrum(&self, tau: f64) -> f64 {
        (self.spectrum)(tau)
    }

    fn relaxation(&self, t: f64) -> f64 {
        self.equilibrium + self.integral(t, |x| Complex64::new((-1.0 / x).exp(), 0.0)).re
    }

    fn complex_modulus(&self, omega: f64) -> Complex64 {
        self.equilibrium + self.integral(1.0 / omega, |x| Complex64::new(x, 0.0) / Complex64::new(x, -1.0))
    }
}

/// How far in ln τ spectra are summed on either side; geometric series stand for what is beyond.
pub(super) const REACH: f64 = 46.0;

/// sin πα without cancellation near 1.
fn sine(order: f64) -> f64 {
    (PI * order.min(1.0 - order)).sin()
}

fn check_order(order: f64) -> Result<(), PronyError> {
    if order > 0.0 && order < 1.0 { Ok(()) } else { Err(PronyError::Order(order)) }
}

fn check_moduli(modulus: f64, equilibrium: f64) -> Result<(), PronyError> {
    let bad = |value: f64, admissible: bool| if admissible && value.is_finite() { Ok(()) } else { Err(value) };
    bad(modulus, modulus > 0.0).and(bad(equilibrium, equilibrium >= 0.0)).map_err(PronyError::Modulus)
}
