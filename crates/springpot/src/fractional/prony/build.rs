//! From a spectrum to a short series: trapezoidal rule in ln τ, Gauss rules for its ends, verification.

use super::relaxation::REACH;
use super::relaxation::Relaxation;
use super::{PronyError, PronySeries, Slowest, Term, Window};
use crate::fractional::mittag_leffler::Complex64;
use crate::linalg::gauss_rule;
use std::f64::consts::PI;

/// Shares of the tolerance: trapezoidal rule, fast end, slow end.
const SHARES: [f64; 3] = [0.45, 0.25, 0.28];

/// Finest trapezoidal step in ln τ.
const FINEST: f64 = 0.01;

/// Places of the grid within one step that are tried.
const PHASES: usize = 4;

/// Most branches of a Gauss rule.
const LARGEST_RULE: usize = 8;

/// e^−x below this x counts in no sum.
const GONE: f64 = 60.0;

/// Largest error over the largest one found: with 29 points to a factor of e it is within 3 %.
const MARGIN: f64 = 1.03;

/// Tolerances are tightened this often when the whole errs by more than its parts.
const ATTEMPTS: usize = 8;

pub(super) fn series(
    material: &impl Relaxation,
    window: Window,
    tolerance: f64,
    slowest: Slowest,
) -> Result<PronySeries, PronyError> {
    let (from, to) = window.ends();
    if !(from > 0.0 && from < to && to.is_finite() && to / from <= 1e15 && from >= 1e-60 && to <= 1e60) {
        return Err(PronyError::Window { from, to });
    }
    if !(1e-11..=0.1).contains(&tolerance) {
        return Err(PronyError::Tolerance(tolerance));
    }
    // A number that does not divide those of the building points.
    let checks = 1 + 29 * (to / from).ln().ceil().max(8.0) as usize;
    let (mut inner, mut least) = (tolerance, f64::INFINITY);
    for _ in 0..ATTEMPTS {
        let (residual, terms) = attempt(material, window, inner, slowest)?;
        let equilibrium = material.equilibrium() + residual;
        let mut series = PronySeries { equilibrium, residual, terms, window, tolerance, error: 0.0 };
        series.error = series.sampled_error(material, checks);
        // Between two points the error may be a little larger.
        if MARGIN * series.error <= tolerance {
            return Ok(series);
        }
        least = least.min(series.error);
        inner *= 0.8;
    }
    Err(PronyError::Bound { error: least, tolerance })
}

/// The larger of two, or NaN.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// What stays, and the branches.
fn attempt(
    material: &impl Relaxation,
    window: Window,
    tolerance: f64,
    slowest: Slowest,
) -> Result<(f64, Vec<Term>), PronyError> {
    let (from, to) = window.ends();
    let count = (8.0 * (to / from).ln()).clamp(50.0, 300.0) as usize;
    let samples: Vec<Sample> = window.points(count).map(|at| Sample::new(material, window, at)).collect();
    let mut eta = (1.5 * PI * PI / (1.0 / tolerance).ln()).min(3.0);
    let mut least = f64::INFINITY;
    while eta > FINEST {
        let grid = |phase: usize| Grid::new(material, window, &samples, eta, phase as f64 / PHASES as f64);
        let error = |grid: &Grid| grid.trapezoidal_error(material.equilibrium(), &samples);
        let first = grid(0)?;
        least = least.min(error(&first));
        if error(&first) <= SHARES[0] * tolerance {
            let grids = [Ok(first)].into_iter().chain((1..PHASES).map(grid)).collect::<Result<Vec<_>, _>>()?;
            let fine = grids.iter().filter(|grid| error(grid) <= SHARES[0] * tolerance);
            let compressed = fine.map(|grid| grid.compressed(&samples, tolerance, slowest));
            let shortest = compressed.min_by_key(|(_, terms)| terms.len()).expect("the first grid is fine enough");
            return Ok(shortest);
        }
        eta *= 0.95;
    }
    Err(PronyError::Bound { error: least, tolerance })
}

/// A point of the window and what the material does there.
struct Sample {
    window: Window,
    at: f64,
    exact: Complex64,
}

impl Sample {
    fn new(material: &impl Relaxation, window: Window, at: f64) -> Self {
        let exact = match window {
            Window::Times { .. } => material.relaxation(at).into(),
            Window::Frequencies { .. } => material.complex_modulus(at),
        };
        Self { window, at, exact }
    }

    /// What a branch of modulus 1 and of this relaxation time adds.
    fn response(&self, tau: f64) -> Complex64 {
        match self.window {
            Window::Times { .. } => (-self.at / tau).exp().into(),
            Window::Frequencies { .. } => {
                let x = self.at * tau;
                Complex64::new(x, 1.0) * if x < 1e100 { x / (1.0 + x * x) } else { 1.0 / x }
            }
        }
    }

    fn share(&self, difference: Complex64) -> f64 {
        difference.norm() / self.exact.norm()
    }
}

/// The trapezoidal rule in ln τ: branches of rising τ.
struct Grid {
    terms: Vec<Term>,
    /// Moduli beyond the last term (which count as τ = ∞), and viscosities before the first (τ = 0).
    beyond: f64,
    before: f64,
    /// sums[j][s]: what the terms from the j-th on add at sample s.
    sums: Vec<Vec<Complex64>>,
}

impl Grid {
    fn new(
        material: &impl Relaxation,
        window: Window,
        samples: &[Sample],
        eta: f64,
        phase: f64,
    ) -> Result<Self, PronyError> {
        let (from, to) = window.ends();
        let (low, high) = match window {
            Window::Times { .. } => (from.ln() - GONE.ln(), to.ln() + REACH),
            Window::Frequencies { .. } => (-to.ln() - REACH, -from.ln() + REACH),
        };
        let (first, last) = ((low / eta).floor() as i64, (high / eta).ceil() as i64);
        let mut terms = Vec::new();
        for k in first..=last {
            let tau = ((k as f64 + phase) * eta).exp();
            let value = material.spectrum(tau);
            if !(value >= 0.0 && value.is_finite()) {
                return Err(PronyError::Spectrum { tau, value });
            }
            terms.push(Term { modulus: eta * value, relaxation_time: tau });
        }
        let beyond = geometric(terms[terms.len() - 1].modulus, terms[terms.len() - 2].modulus);
        let before = geometric(terms[0].viscosity(), terms[1].viscosity());
        let mut sums = vec![vec![Complex64::new(beyond, 0.0); samples.len()]];
        for term in terms.iter().rev() {
            let tail = &sums[sums.len() - 1];
            let with = tail.iter().zip(samples).map(|(sum, s)| sum + s.response(term.relaxation_time) * term.modulus);
            sums.push(with.collect());
        }
        sums.reverse();
        Ok(Self { terms, beyond, before, sums })
    }

    fn trapezoidal_error(&self, equilibrium: f64, samples: &[Sample]) -> f64 {
        let whole = self.sums[0].iter().zip(samples);
        let missing = |sample: &Sample| match sample.window {
            Window::Times { .. } => Complex64::ZERO,
            Window::Frequencies { .. } => Complex64::new(0.0, sample.at * self.before),
        };
        whole.map(|(sum, s)| s.share(sum + equilibrium + missing(s) - s.exact)).fold(0.0, larger)
    }

    /// What stays, and the branches with both ends compressed.
    fn compressed(&self, samples: &[Sample], tolerance: f64, slowest: Slowest) -> (f64, Vec<Term>) {
        let slow = self.slow_end(samples, SHARES[2] * tolerance, slowest);
        let fast = match samples[0].window {
            Window::Times { .. } => self.without_fast(samples, SHARES[1] * tolerance, slow.at),
            Window::Frequencies { .. } => self.fast_end(samples, SHARES[1] * tolerance, slow.at),
        };
        let inner = &self.terms[fast.at..slow.at];
        let mut terms: Vec<Term> = fast.terms.iter().chain(inner).chain(&slow.terms).copied().collect();
        // A spectrum that ends somewhere has no branches beyond.
        terms.retain(|term| term.modulus > 0.0);
        (slow.stays, terms)
    }

    /// The rule for all from some term on that leaves the fewest terms.
    fn slow_end(&self, samples: &[Sample], tolerance: f64, slowest: Slowest) -> End {
        let rules = (1..=LARGEST_RULE).filter_map(|size| {
            let fits = |at: usize| {
                let end = self.slow_rule(at, size, slowest);
                let error = |(s, sample): (usize, &Sample)| {
                    let rule: Complex64 =
                        end.terms.iter().map(|t| sample.response(t.relaxation_time) * t.modulus).sum();
                    sample.share(rule + end.stays - self.sums[at][s])
                };
                samples.iter().enumerate().map(error).fold(0.0, larger) <= tolerance
            };
            // The error falls as fewer terms are replaced.
            let (mut wrong, mut right) = (0, self.terms.len() - LARGEST_RULE);
            if !fits(right) {
                return None;
            }
            while right - wrong > 1 {
                let middle = (wrong + right) / 2;
                if fits(middle) { right = middle } else { wrong = middle }
            }
            Some(self.slow_rule(right, size, slowest))
        });
        rules.min_by_key(|end| end.at + end.terms.len()).unwrap_or(End {
            at: self.terms.len(),
            stays: 0.0,
            terms: vec![],
        })
    }

    /// Gauss rule in 1/τ of the terms from `at` on, or the Radau rule with a node at 1/τ = 0.
    fn slow_rule(&self, at: usize, size: usize, slowest: Slowest) -> End {
        let tail = &self.terms[at..];
        let unit = tail[0].relaxation_time;
        let mut points: Vec<f64> = tail.iter().map(|term| unit / term.relaxation_time).collect();
        let mut masses: Vec<f64> = tail.iter().map(|term| term.modulus).collect();
        points.push(0.0);
        masses.push(self.beyond);
        let total: f64 = masses.iter().sum();
        let (nodes, weights) = match slowest {
            Slowest::Relaxes => gauss_rule(&points, &masses, size),
            Slowest::Stays => {
                let weighted: Vec<f64> = points.iter().zip(&masses).map(|(point, mass)| point * mass).collect();
                let (nodes, weights) = gauss_rule(&points, &weighted, size);
                let weights = nodes.iter().zip(&weights).map(|(node, weight)| weight / node).collect();
                (nodes, weights)
            }
        };
        let term = |(node, modulus): (&f64, &f64)| Term { modulus: *modulus, relaxation_time: unit / node };
        let terms: Vec<Term> = nodes.iter().zip(&weights).map(term).filter(|t| t.relaxation_time < 1e300).collect();
        let stays = match slowest {
            Slowest::Relaxes => 0.0,
            Slowest::Stays => (total - terms.iter().map(|term| term.modulus).sum::<f64>()).max(0.0),
        };
        End { at, stays, terms }
    }

    /// Leaves out what is gone before the window begins.
    fn without_fast(&self, samples: &[Sample], tolerance: f64, most: usize) -> End {
        let left_out = |at: &usize| samples[0].share(self.sums[0][0] - self.sums[*at][0]) <= tolerance;
        let at = (0..=most).take_while(left_out).last().unwrap_or(0);
        End { at, stays: 0.0, terms: Vec::new() }
    }

    /// The rule for all before some term that leaves the fewest terms: Gauss in τ, for the viscosities.
    fn fast_end(&self, samples: &[Sample], tolerance: f64, most: usize) -> End {
        let rules = (1..=LARGEST_RULE).filter_map(|size| {
            let fits = |at: usize| {
                let end = self.fast_rule(at, size);
                let error = |(s, sample): (usize, &Sample)| {
                    let rule: Complex64 =
                        end.terms.iter().map(|t| sample.response(t.relaxation_time) * t.modulus).sum();
                    let dashpot = Complex64::new(0.0, sample.at * self.before);
                    sample.share(rule - dashpot - (self.sums[0][s] - self.sums[at][s]))
                };
                samples.iter().enumerate().map(error).fold(0.0, larger) <= tolerance
            };
            let (mut right, mut wrong) = (LARGEST_RULE, most + 1);
            if most < LARGEST_RULE || !fits(right) {
                return None;
            }
            while wrong - right > 1 {
                let middle = (wrong + right) / 2;
                if fits(middle) { right = middle } else { wrong = middle }
            }
            Some(self.fast_rule(right, size))
        });
        rules.max_by_key(|end| end.at as i64 - end.terms.len() as i64).unwrap_or(End {
            at: 0,
            stays: 0.0,
            terms: vec![],
        })
    }

    fn fast_rule(&self, at: usize, size: usize) -> End {
        let head = &self.terms[..at];
        let unit = head[at - 1].relaxation_time;
        let mut points: Vec<f64> = head.iter().rev().map(|term| term.relaxation_time / unit).collect();
        let mut masses: Vec<f64> = head.iter().rev().map(Term::viscosity).collect();
        points.push(0.0);
        masses.push(self.before);
        let (nodes, weights) = gauss_rule(&points, &masses, size);
        let term = |(node, viscosity): (&f64, &f64)| {
            let relaxation_time = unit * node;
            Term { modulus: viscosity / relaxation_time, relaxation_time }
        };
        let terms = nodes.iter().zip(&weights).rev().map(term).filter(|t| t.modulus.is_finite()).collect();
        End { at, stays: 0.0, terms }
    }
}

/// What stands for one end of the grid: the terms before (or from) `at` are replaced.
struct End {
    at: usize,
    stays: f64,
    terms: Vec<Term>,
}

/// What follows on `last` in a geometric series, `before` being the one before it; 0 where it does not fall.
fn geometric(last: f64, before: f64) -> f64 {
    let ratio = last / before;
    if last > 0.0 && ratio < 1.0 { last * ratio / (1.0 - ratio) } else { 0.0 }
}
