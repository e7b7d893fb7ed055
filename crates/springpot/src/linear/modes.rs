//! Eigenvalues of small motions.

use super::candidates::candidates;
use super::control::Holding;
use super::count::{BESIDE, count};
use super::linearisation::Linearisation;
use super::pencil::Pencil;
use super::refine::{Root, nullity, refine};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Spacings of the exponentials, ln λ, until no zero is missing.
const STEPS: [f64; 3] = [0.8, 0.55, 0.35];
/// Zeros that are one within this share of themselves.
const SAME: f64 = 1e-7;
/// Zeros whose turn of the phase is quick, rad from the cut.
const NEAR_THE_CUT: f64 = 0.3;
/// Nearer to 0, in units of the fastest rate, is what nothing holds.
const NOTHING: f64 = 1e-6;

/// The eigenvalues of small motions, and what is known of their number.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// By rising natural frequency; of a conjugate pair the one above the real axis.
    pub modes: Vec<Mode>,
    /// Independent motions that nothing holds: eigenvalue 0.
    pub free_motions: usize,
    /// Eigenvalues inside the plane without the negative axis as the principle of the argument counts them, conjugate ones twice; `None`
    /// where all powers of s are whole, so that a matrix has them all, or where the count does not end.
    pub counted: Option<usize>,
    /// Those among `modes` that the count is about.
    pub found: usize,
    /// Whether a power of s is broken: beside the modes there is then a decay that no exponential follows, t^(−1−alpha) at last.
    pub is_fractional: bool,
}

/// One eigenvalue s: motions e^{st}.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// s, 1/s; its imaginary part is not negative.
    pub eigenvalue: Complex64,
    /// δq as tangent coordinates, nv values, the one with most of the kinetic energy 1.
    pub shape: Vec<Complex64>,
    /// The velocity with most of the kinetic energy.
    pub largest: usize,
}

/// Why there are no modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ModesError {
    /// Forces move no joint.
    #[error("no joint is free to move: all are prescribed or locked")]
    NoFree,
    /// The equations hold numbers that are not finite, or masses that are not positive.
    #[error("the equations of small motions are not finite, or a mass is not positive")]
    NotFinite,
    /// The iteration for the eigenvalues does not end.
    #[error("the eigenvalues are not found: the iteration does not end")]
    NotFound,
}

impl Mode {
    /// |s|/2π, Hz.
    pub fn frequency(&self) -> f64 {
        self.eigenvalue.norm() / TAU
    }

    /// Im s/2π, Hz: of the decaying vibration; 0 where nothing vibrates.
    pub fn damped_frequency(&self) -> f64 {
        self.eigenvalue.im / TAU
    }

    /// −Re s/|s|.
    pub fn damping_ratio(&self) -> f64 {
        0.0 - self.eigenvalue.re / self.eigenvalue.norm()
    }

    /// −1/Re s, s: in which it falls to 1/e; negative where it grows, infinite where it does neither.
    pub fn time_constant(&self) -> f64 {
        -self.eigenvalue.re.recip()
    }

    /// Whether it grows.
    pub fn is_unstable(&self) -> bool {
        self.eigenvalue.re > 1e-12 * self.eigenvalue.norm()
    }
}

impl Modes {
    /// Whether no eigenvalue is missing: a matrix has them all, or as many are found as the principle of the argument counts.
    pub fn is_complete(&self) -> bool {
        !self.is_fractional || self.counted == Some(self.found)
    }
}

impl Linearisation {
    /// All eigenvalues of M s² + D s + K + Σ K_e*(s) g gᵀ, of the closed loop where something follows from the state, with |arg s| < π, and those
    /// on the negative axis that no broken power reaches.
    ///
    /// With exponentials in place of every s^alpha they are eigenvalues of a matrix; from these each is refined to rounding, and their number
    /// is compared with the turns of the determinant's phase around the cut plane.
    ///
    /// # Errors
    /// [`ModesError`].
    pub fn modes(&self) -> Result<Modes, ModesError> {
        if self.free.is_empty() {
            return Err(ModesError::NoFree);
        }
        let pencil = Pencil::new(self).ok_or(ModesError::NotFinite)?;
        let free_motions = self.free_motions(&pencil);
        let nothing = if free_motions > 0 { NOTHING } else { 0.0 };
        let is_fractional = !pencil.is_rational();
        let (roots, counted) = match is_fractional {
            false => (rational(&pencil, nothing).ok_or(ModesError::NotFound)?, None),
            true => fractional(&pencil, nothing).ok_or(ModesError::NotFound)?,
        };
        let found = roots.iter().filter(|root| is_counted(root.s)).map(|root| multiplicity(root.s)).sum();
        let mut modes: Vec<Mode> = roots.iter().map(|root| self.mode(&pencil, root)).collect();
        modes.sort_by(|a, b| a.eigenvalue.norm().total_cmp(&b.eigenvalue.norm()));
        Ok(Modes { modes, free_motions, counted, found, is_fractional })
    }

    fn mode(&self, pencil: &Pencil, root: &Root) -> Mode {
        let moved = &root.x[..pencil.free];
        let largest = (0..moved.len()).max_by(|&a, &b| moved[a].norm().total_cmp(&moved[b].norm())).unwrap_or(0);
        let mut shape = vec![Complex64::ZERO; self.left_over.len()];
        let unit = moved[largest] * pencil.scales[largest];
        for (i, &k) in self.free.iter().enumerate() {
            shape[k] = if unit == Complex64::ZERO { unit } else { moved[i] * pencil.scales[i] / unit };
        }
        let s = root.s * pencil.omega;
        Mode { eigenvalue: Complex64::new(s.re, s.im.abs()), shape, largest: self.free[largest] }
    }

    /// Independent motions without any stiffness.
    fn free_motions(&self, pencil: &Pencil) -> usize {
        let held = self.elements.iter().map(|element| Holding {
            gradient: &element.gradient,
            hessian: element.hessian.clone(),
            force: element.force,
            stiffness: element.tangent.relaxed(),
            tangent: &element.tangent,
            stretch: element.stretch,
        });
        let whole = self.control.static_stiffness(self.stiffness.clone(), &held.collect::<Vec<_>>());
        // What an integral holds does not move.
        let left: Vec<usize> = (0..pencil.free).filter(|&r| !self.control.integrates(self.free[r])).collect();
        let n = left.len();
        let entry = |(r, c): (usize, usize)| {
            let scales = pencil.scales[r] * pencil.scales[c] / (pencil.omega * pencil.omega);
            whole[self.free[r] * self.left_over.len() + self.free[c]] * scales
        };
        let pairs = left.iter().flat_map(|&r| left.iter().map(move |&c| (r, c)));
        let stiffness: Vec<f64> = pairs.map(entry).collect();
        let still = Pencil {
            size: n,
            free: n,
            mass: vec![0.0; n * n],
            damping: vec![0.0; n * n],
            springpots: Vec::new(),
            omega: pencil.omega,
            scales: vec![1.0; n],
            stiffness,
        };
        let largest = still.stiffness.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        // Next to the fastest rate what is left of sums is rounding.
        if largest <= 1e-14 { n } else { nullity(&still, Complex64::ONE) }
    }
}

/// Of whole powers a matrix has all eigenvalues, each as often as it counts; each is refined where it stands.
fn rational(pencil: &Pencil, nothing: f64) -> Option<Vec<Root>> {
    let found = candidates(pencil, STEPS[0])?;
    let upper = found.into_iter().filter(|s| s.im >= 0.0 && s.norm() > nothing);
    let root = |start: Complex64| {
        let root = refine(pencil, start);
        // Where two are near one another both would become the same.
        let near = root.filter(|root| (root.s - start).norm() <= 1e-5 * (start.norm() + 1e-6));
        near.or_else(|| Some(Root { s: start, x: refine_vector(pencil, start) }))
    };
    upper.map(root).collect()
}

/// The vector that T(s) all but annihilates.
fn refine_vector(pencil: &Pencil, s: Complex64) -> Vec<Complex64> {
    let lu = crate::linalg::ComplexLu::new(pencil.size, pencil.at(s)[0].clone());
    let mut x = vec![Complex64::ONE; pencil.size];
    for _ in 0..2 {
        x = lu.solve(&x);
        let size = x.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= size);
    }
    x
}

/// Zeros on the principal sheet, and their number.
fn fractional(pencil: &Pencil, nothing: f64) -> Option<(Vec<Root>, Option<usize>)> {
    let mut roots: Vec<Root> = Vec::new();
    let mut counted = None;
    let mut ends = None;
    // Where zeros of this sheet or the next one lie beside the way along the cut.
    let mut beside: Vec<f64> = Vec::new();
    for step in STEPS {
        let starts = candidates(pencil, step)?;
        for start in starts.into_iter().filter(|s| s.im >= 0.0 && s.norm() > nothing) {
            let Some(root) = refine(pencil, start) else { continue };
            if root.s.arg().abs() > PI - NEAR_THE_CUT {
                beside.push(root.s.norm());
            }
            let Some(root) = principal(pencil, root).filter(|root| root.s.norm() > nothing) else { continue };
            let same = roots.iter().filter(|other| (other.s - root.s).norm() <= SAME * root.s.norm()).count();
            if same == 0 || same < nullity(pencil, root.s) {
                roots.push(root);
            }
        }
        let sizes = || roots.iter().map(|root| root.s.norm());
        let wanted = (1e-4 * sizes().fold(1.0, f64::min), 1e3 * sizes().fold(1.0, f64::max));
        if ends != Some(wanted) {
            counted = count(pencil, wanted, &beside);
            ends = Some(wanted);
        }
        let found: usize = roots.iter().filter(|root| is_counted(root.s)).map(|root| multiplicity(root.s)).sum();
        if counted == Some(found) {
            break;
        }
    }
    Some((roots, counted))
}

/// The zero as one of the principal sheet; `None` where it lies on another one, or on the cut where broken powers reach it.
fn principal(pencil: &Pencil, root: Root) -> Option<Root> {
    let arg = root.s.arg();
    if arg > 1e-11 && arg < PI - 1e-11 {
        return Some(root);
    }
    if arg.abs() <= 1e-11 {
        return Some(Root { s: root.s.re.into(), ..root });
    }
    if arg.abs() < PI - 1e-11 {
        return None;
    }
    let [broken, whole] = pencil.shares(root.s, &root.x);
    (broken <= 1e-9 * whole).then(|| Root { s: root.s.re.into(), ..root })
}

fn is_counted(s: Complex64) -> bool {
    s.arg().abs() < PI - BESIDE
}

/// A zero above the real axis stands for two.
fn multiplicity(s: Complex64) -> usize {
    if s.im > 0.0 { 2 } else { 1 }
}
