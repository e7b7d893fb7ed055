//! The Mittag-Leffler function E_{a,b}(z) = Σ_k z^k/Γ(ak + b) and its derivatives, for real and complex z.
//!
//! ```
//! use springpot::fractional::mittag_leffler::MittagLeffler;
//!
//! // Relaxation of a fractional Maxwell element of order ½: E_{½,1}(−√t) = e^t erfc √t.
//! let relaxation = MittagLeffler::new(0.5, 1.0)?;
//! assert!((relaxation.real(-1.0) - 0.427_583_576_155_807).abs() < 1e-14);
//!
//! // Many arguments at once, and the second derivative with respect to z.
//! let mut values = [0.0; 3];
//! relaxation.real_into(&[-0.1, -1.0, -10.0], &mut values);
//! let curvature = MittagLeffler::derivative(0.5, 1.0, 2)?.real(-1.0);
//! assert!(values[1] == relaxation.real(-1.0) && curvature > 0.0);
//! # Ok::<(), springpot::fractional::mittag_leffler::MittagLefflerError>(())
//! ```
//!
//! # Method
//!
//! With Hankel's contour around the negative axis,
//!
//! E_{a,b}^{(n)}(z) = n!/(2πi) ∫ e^s s^{a−b} (s^a − z)^{−n−1} ds.
//!
//! On the parabola s = μ(1 + iu)² the trapezoidal rule of step h in u converges geometrically (Weideman & Trefethen
//! 2007). A pole w of the integrand, w^a = z with |arg w| < π, would spoil that when it comes near the parabola. Its
//! share of the rule's error is known in closed form (the residue of the integrand times 1/(1 − e^{−2πi u/h}),
//! Trefethen & Weideman 2014, §5), so that, with nodes at odd multiples of h/2,
//!
//! E_{a,b}(z) = h Σ_k f(u_k) + Σ_w w^{1−b} e^w/a / (1 + e^{−(2π/h)(√(w/μ) − 1)}).
//!
//! The logistic factor is 1 for poles outside the parabola and 0 for those deep inside. Nodes and weights thus depend
//! on a and b alone, and one sum serves every z, however large. Where a pole comes close to the parabola, a smaller one
//! is used, since a node close to a pole costs digits; from the third derivative on, where poles are of high order, every
//! value is judged by the size of its terms, and other parabolas are tried. The derivatives of the pole terms are taken by
//! truncated power series. Below |z| = 0.05 the series of the definition is shorter.
//!
//! Below b = −1 the integrand e^s s^{a−b} is large on every parabola and cancels. There the contour is drawn onto both
//! sides of the cut, r e^{±iπ}, and what is integrated is their difference,
//!
//! E_{a,b}(z) = 1/π ∫₀^∞ e^{−r} r^{a−b} (r^a sin πb + z sin π(a−b))/((r^a e^{iπa} − z)(r^a e^{−iπa} − z)) dr
//!   + Σ_w w^{1−b} e^w/a,
//!
//! with sines of the exact distances to whole numbers: near whole a and b, where almost all of E_{a,b} cancels, the
//! integrand is as small as it must be, and at whole ones it is 0. The trapezoidal rule in ln r, on a ray turned away from
//! the poles, takes their terms in and out by the same closed form. Where the series of the definition loses no digits
//! it is taken instead.
//!
//! # Accuracy
//!
//! The error is below 1e-12·max(|E|, 1e-3) in the admissible range; `tests/mittag_leffler` measures it. One thing no
//! method in double precision escapes: where parts of the sum, a term w^{1−b} e^w/a or the integral along the cut, are
//! much larger than E, as near zeros of oscillating E_{2,b}(−x), the error is a few roundings of w times that part. Ninth and
//! tenth derivatives at b < −1 may reach twice the bound where a pole is beside the cut and nearer to 0 than 1.
//!
//! # Sources
//!
//! - J. A. C. Weideman, L. N. Trefethen, Parabolic and hyperbolic contours for computing the Bromwich integral, Math.
//!   Comp. 76 (2007) 1341.
//! - L. N. Trefethen, J. A. C. Weideman, The exponentially convergent trapezoidal rule, SIAM Review 56 (2014) 385.
//! - R. Garrappa, Numerical evaluation of two and three parameter Mittag-Leffler functions, SIAM J. Numer. Anal. 53
//!   (2015) 1350.

mod contour;
mod exact;
mod pole;
mod ray;
mod series;

use contour::Contours;
use pole::Poles;
use ray::Rays;
use series::Series;

pub use num_complex::Complex64;

/// Why a Mittag-Leffler function is not available.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MittagLefflerError {
    /// The first parameter is out of range.
    #[error("a Mittag-Leffler function needs 0 < a ≤ {MAX_A}, not a = {0}")]
    Order(f64),
    /// The second parameter is out of range.
    #[error("the Mittag-Leffler function needs −{MAX_B} ≤ b ≤ {MAX_B}, not b = {0}")]
    Parameter(f64),
    /// The derivative is of too high an order.
    #[error("derivatives of the Mittag-Leffler function go to order {MAX_DERIVATIVE}, not to {0}")]
    Derivative(usize),
}

/// Largest first parameter.
pub const MAX_A: f64 = 5.0;
/// Largest absolute value of the second parameter.
pub const MAX_B: f64 = 20.0;
/// Highest derivative.
pub const MAX_DERIVATIVE: usize = 10;

/// The contour beyond the reach of the series.
#[derive(Debug, Clone)]
enum Around {
    Parabolas(Contours),
    Cut(Box<Rays>),
}

/// E_{a,b}, or its n-th derivative with respect to z, prepared for many arguments.
///
/// 0 < a ≤ [`MAX_A`], |b| ≤ [`MAX_B`], n ≤ [`MAX_DERIVATIVE`]; any finite z. The value is infinite where it exceeds the
/// range of f64 (for complex z both parts are then infinite or not defined) and NaN where z is not finite.
#[derive(Debug, Clone)]
pub struct MittagLeffler {
    a: f64,
    b: f64,
    n: usize,
    around: Around,
    series: Series,
}

impl MittagLeffler {
    /// E_{a,b}.
    ///
    /// # Errors
    /// [`MittagLefflerError`] for a parameter out of range.
    pub fn new(a: f64, b: f64) -> Result<Self, MittagLefflerError> {
        Self::derivative(a, b, 0)
    }

    /// dⁿE_{a,b}/dzⁿ, which is n! times the three-parameter function of Prabhakar with γ = n + 1 and b + na.
    ///
    /// # Errors
    /// [`MittagLefflerError`] for a parameter or an order out of range.
    pub fn derivative(a: f64, b: f64, n: usize) -> Result<Self, MittagLefflerError> {
        if !(f64::MIN_POSITIVE..=MAX_A).contains(&a) {
            return Err(MittagLefflerError::Order(a));
        }
        if !(-MAX_B..=MAX_B).contains(&b) {
            return Err(MittagLefflerError::Parameter(b));
        }
        if n > MAX_DERIVATIVE {
            return Err(MittagLefflerError::Derivative(n));
        }
        let around = if b < Rays::BELOW {
            Around::Cut(Box::new(Rays::new(a, b, n)))
        } else {
            Around::Parabolas(Contours::new(a, b, n))
        };
        Ok(Self { a, b, n, around, series: Series::new(a, b, n) })
    }

    /// The value at a real argument.
    pub fn real(&self, x: f64) -> f64 {
        if !x.is_finite() {
            return f64::NAN;
        }
        if x.abs() <= Series::REACH {
            return self.series.real(x);
        }
        let contours = match &self.around {
            Around::Parabolas(contours) => contours,
            Around::Cut(rays) => return rays.value(self.a, self.b, Complex64::from(x)).re,
        };
        if self.n >= Contours::CAREFUL {
            return contours.best(self.a, self.b, self.n, Complex64::from(x)).re;
        }
        let poles = Poles::of_real(self.a, x, 1.0);
        let contour = contours.clear_of(&poles);
        let around = contour.real(self.n, x);
        poles.iter().fold(around, |sum, pole| {
            let term = pole.on_parabola(self.b, self.n, contour).0.re;
            // A pair of conjugate poles.
            sum + if pole.is_real() { term } else { 2.0 * term }
        })
    }

    /// The value at a complex argument.
    pub fn complex(&self, z: Complex64) -> Complex64 {
        if z.im == 0.0 {
            return Complex64::new(self.real(z.re), 0.0);
        }
        if !z.is_finite() {
            return Complex64::new(f64::NAN, f64::NAN);
        }
        if z.norm() <= Series::REACH {
            return self.series.complex(z);
        }
        let contours = match &self.around {
            Around::Parabolas(contours) => contours,
            Around::Cut(rays) => return rays.value(self.a, self.b, z),
        };
        if self.n >= Contours::CAREFUL {
            return contours.best(self.a, self.b, self.n, z);
        }
        let poles = Poles::of_complex(self.a, z, 1.0);
        let contour = contours.clear_of(&poles);
        poles.iter().fold(contour.complex(self.n, z), |sum, pole| sum + pole.on_parabola(self.b, self.n, contour).0)
    }

    /// The values at real arguments, the same to the bit as those of [`Self::real`].
    ///
    /// Where there is no pole (x < 0 and a ≤ 1, the relaxation functions), several arguments are summed side by side.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn real_into(&self, x: &[f64], values: &mut [f64]) {
        assert_eq!(x.len(), values.len(), "as many values as arguments");
        let mut blocks = x.chunks_exact(LANES);
        let mut done = 0;
        for block in &mut blocks {
            let block: &[f64; LANES] = block.try_into().expect("a whole block");
            let out = &mut values[done..done + LANES];
            let free = self.n == 0 && self.a <= 1.0 && block.iter().all(|x| *x < -Series::REACH && x.is_finite());
            match &self.around {
                Around::Parabolas(contours) if free => out.copy_from_slice(&contours.widest().real_lanes(block)),
                _ => out.iter_mut().zip(block).for_each(|(value, x)| *value = self.real(*x)),
            }
            done += LANES;
        }
        values[done..].iter_mut().zip(blocks.remainder()).for_each(|(value, x)| *value = self.real(*x));
    }

    /// The values at complex arguments.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn complex_into(&self, z: &[Complex64], values: &mut [Complex64]) {
        assert_eq!(z.len(), values.len(), "as many values as arguments");
        values.iter_mut().zip(z).for_each(|(value, z)| *value = self.complex(*z));
    }
}

/// E_{a,b}(z); [`MittagLeffler`] is faster for several arguments.
///
/// # Errors
/// [`MittagLefflerError`] for a parameter out of range.
pub fn mittag_leffler(a: f64, b: f64, z: Complex64) -> Result<Complex64, MittagLefflerError> {
    Ok(MittagLeffler::new(a, b)?.complex(z))
}

/// Arguments that are summed side by side.
const LANES: usize = 8;
