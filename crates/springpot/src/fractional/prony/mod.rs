//! Prony series: springs and Maxwell branches that stand for a completely monotone relaxation modulus, with a verified
//! error.
//!
//! ```
//! use springpot::fractional::prony::{PronySeries, Slowest, Springpot, Window};
//!
//! // 50 N·s^½/m between 1 ms and 10 s, relative error below 1e-4.
//! let springpot = Springpot::new(50.0, 0.5, 0.0)?;
//! let series = PronySeries::new(&springpot, Window::Times { from: 1e-3, to: 10.0 }, 1e-4, Slowest::Relaxes)?;
//! assert!(series.error <= 1e-4 && series.terms.len() < 20);
//! assert!((series.relaxation(0.2) / (50.0 / (std::f64::consts::PI * 0.2).sqrt()) - 1.0).abs() <= 1e-4);
//! # Ok::<(), springpot::fractional::prony::PronyError>(())
//! ```
//!
//! # Method
//!
//! G(t) = G_e + ∫ H(τ) e^{−t/τ} d ln τ. The trapezoidal rule in ln τ converges geometrically for a smooth spectrum H,
//! and every one of its terms is a Maxwell branch of modulus ηH(τ_k) ≥ 0. Its step η is the largest that meets its
//! share of the tolerance on the window. What relaxes more slowly than the window sees is a discrete measure in 1/τ, of
//! which the Gauss rule takes the place, with as few branches as the tolerance allows; what is faster than a frequency
//! band sees is treated alike in τ, what is faster than a time window sees is left out. Gauss rules of a positive
//! measure have positive weights, so the series is passive whatever the tolerance. [`Slowest::Stays`] takes the Radau
//! rule with a node at 1/τ = 0 for the slow part: a spring that keeps, within the bound, what has not relaxed by the
//! end of the window. Finite-element codes want such a long-term modulus.
//!
//! At last the whole series is compared with G (or G*) at points that had no part in building it.
//!
//! Sources: W. McLean, Exponential sum approximations for t^−β (2018); G. H. Golub, J. H. Welsch, Calculation of Gauss
//! quadrature rules, Math. Comp. 23 (1969) 221; F. Mainardi, Fractional Calculus and Waves in Linear Viscoelasticity
//! (2010).

mod build;
mod export;
mod relaxation;

pub use export::Bulk;
pub use relaxation::{FractionalZener, Relaxation, Spectrum, Springpot};

use super::mittag_leffler::Complex64;
use serde::{Deserialize, Serialize};

/// Why there is no Prony series.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PronyError {
    /// The order is out of range.
    #[error("a fractional relaxation needs 0 < alpha < 1, not {0}")]
    Order(f64),
    /// A modulus is negative, zero or not finite.
    #[error("moduli must be finite and positive (an equilibrium modulus may be 0), not {0}")]
    Modulus(f64),
    /// A relaxation time is not positive.
    #[error("a relaxation time must be positive and finite, not {0} s")]
    Time(f64),
    /// The window is empty or not finite.
    #[error("the window needs 0 < from < to, at most a factor of 1e15 apart, not from {from} to {to}")]
    Window {
        /// Its beginning, s or rad/s.
        from: f64,
        /// Its end, s or rad/s.
        to: f64,
    },
    /// The tolerance is out of reach.
    #[error("the tolerance must lie between 1e-11 and 0.1, not {0}")]
    Tolerance(f64),
    /// The spectrum is negative or not finite somewhere.
    #[error("the relaxation spectrum must be finite and not negative, but H({tau:e} s) = {value}")]
    Spectrum {
        /// Relaxation time, s.
        tau: f64,
        /// The spectrum there.
        value: f64,
    },
    /// The verified error exceeds the tolerance: the spectrum is not smooth enough, or falls off too slowly.
    #[error("the best Prony series errs by {error:.1e}, more than {tolerance:e}")]
    Bound {
        /// Largest relative error found.
        error: f64,
        /// Tolerance asked for.
        tolerance: f64,
    },
    /// A finite-element code needs a modulus that stays.
    #[error("the normalised moduli add up to 1: without an equilibrium modulus the long-term modulus is 0")]
    NoEquilibrium,
    /// Normalised moduli cannot hold the smallest modulus of the window.
    #[error(
        "normalised moduli lose the bound: rounding their sum changes the smallest modulus of the window by {0:.1e}"
    )]
    Digits(f64),
}

/// Where a Prony series holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Window {
    /// Times after a step of strain, s: the bound is on |ΔG|/G.
    Times {
        /// Shortest time, s.
        from: f64,
        /// Longest time, s.
        to: f64,
    },
    /// Angular frequencies, rad/s: the bound is on |ΔG*|/|G*|.
    Frequencies {
        /// Lowest angular frequency, rad/s.
        from: f64,
        /// Highest angular frequency, rad/s.
        to: f64,
    },
}

/// What becomes of the part that relaxes more slowly than the window sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slowest {
    /// It relaxes in slow branches; the equilibrium modulus is that of the material.
    Relaxes,
    /// Some of it stays as a spring, added to the equilibrium modulus.
    Stays,
}

/// A Maxwell branch: a spring in series with a dashpot of viscosity modulus·relaxation_time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Modulus of the spring, positive, in the unit of G.
    pub modulus: f64,
    /// Relaxation time, s.
    pub relaxation_time: f64,
}

impl Term {
    /// Viscosity of the dashpot, in the unit of G times s.
    pub fn viscosity(&self) -> f64 {
        self.modulus * self.relaxation_time
    }
}

/// G(t) ≈ G_e + Σ_k g_k e^{−t/τ_k}, all g_k > 0: a spring beside Maxwell branches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PronySeries {
    /// G_e, the long-term modulus of the series.
    pub equilibrium: f64,
    /// The part of G_e that stands for what relaxes after the window; 0 with [`Slowest::Relaxes`].
    pub residual: f64,
    /// The branches, fastest first.
    pub terms: Vec<Term>,
    /// Where the bound holds.
    pub window: Window,
    /// The bound asked for.
    pub tolerance: f64,
    /// Largest relative error found on the window.
    pub error: f64,
}

impl PronySeries {
    /// The shortest series found whose verified relative error on the window is at most `tolerance`.
    ///
    /// # Errors
    /// [`PronyError`] for an impossible window, tolerance or spectrum, and where the bound is not met.
    pub fn new(
        material: &impl Relaxation,
        window: Window,
        tolerance: f64,
        slowest: Slowest,
    ) -> Result<Self, PronyError> {
        build::series(material, window, tolerance, slowest)
    }

    /// G(t), t ≥ 0 in s.
    pub fn relaxation(&self, t: f64) -> f64 {
        self.terms.iter().map(|term| term.modulus * (-t / term.relaxation_time).exp()).sum::<f64>() + self.equilibrium
    }

    /// G*(ω) = G' + iG'': storage and loss modulus at the angular frequency ω, rad/s.
    pub fn complex_modulus(&self, omega: f64) -> Complex64 {
        let branch = |term: &Term| {
            let x = omega * term.relaxation_time;
            Complex64::new(x, 1.0) * (term.modulus * x / (1.0 + x * x))
        };
        self.terms.iter().map(branch).sum::<Complex64>() + self.equilibrium
    }

    /// G(0), the modulus of all branches together.
    pub fn instantaneous(&self) -> f64 {
        self.relaxation(0.0)
    }

    /// Largest relative error against a material at `count` points of the window, spread evenly in the logarithm.
    pub fn sampled_error(&self, material: &impl Relaxation, count: usize) -> f64 {
        self.window.points(count).map(|at| self.error_at(material, at)).fold(0.0, build::larger)
    }

    fn error_at(&self, material: &impl Relaxation, at: f64) -> f64 {
        let (own, exact) = match self.window {
            Window::Times { .. } => (self.relaxation(at).into(), material.relaxation(at).into()),
            Window::Frequencies { .. } => (self.complex_modulus(at), material.complex_modulus(at)),
        };
        (own - exact).norm() / exact.norm()
    }
}

impl Window {
    fn ends(self) -> (f64, f64) {
        let (Self::Times { from, to } | Self::Frequencies { from, to }) = self;
        (from, to)
    }

    /// `count` points from end to end, spread evenly in the logarithm.
    fn points(self, count: usize) -> impl Iterator<Item = f64> {
        let (from, to) = self.ends();
        let last = count.max(2) - 1;
        (0..=last).map(move |k| match k {
            0 => from,
            k if k == last => to,
            k => from * ((to / from).ln() * k as f64 / last as f64).exp(),
        })
    }
}
