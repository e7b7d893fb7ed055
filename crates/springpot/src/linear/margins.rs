//! How far a loop is from −1: phase, gain and delay margins, and the peak of its sensitivity.

use super::assembly::{Assembly, Parts};
use super::linearisation::Linearisation;
use super::modes::ModesError;
use super::response::Excitation;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Decades below and above the rates of the eigenvalues that are looked at.
const DECADES: f64 = 7.0;
/// Places in a decade.
const PLACES: usize = 60;
/// Beside a resonance, in units of its half width.
const BESIDE: [f64; 9] = [0.0, 0.2, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// An imaginary part below this share is rounding.
const REAL: f64 = 1e-12;

/// The loop opened at the torque of one velocity, closed by negative feedback: L = −τ_control/τ, where τ alone acts in place of what control says
/// of that velocity. All other loops stay closed.
#[derive(Debug, Clone)]
pub struct LoopGain<'a> {
    assembly: Assembly<'a>,
    velocity: usize,
}

/// How far a loop is from −1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// The smallest lag at a crossover |L| = 1 that brings L to −1, 0 ≤ φ < 2π, rad, and the angular frequency, rad/s; `None` where |L| never is 1.
    pub phase: Option<(f64, f64)>,
    /// The smallest factor above 1 that brings L to −1, and the angular frequency, rad/s; `None` where none does.
    pub gain: Option<(f64, f64)>,
    /// The smallest φ/ω over all crossovers, s.
    pub delay: Option<f64>,
    /// The largest |1/(1 + L)|, and the angular frequency, rad/s; without one where it is approached at ever higher frequencies.
    pub sensitivity: (f64, Option<f64>),
    /// Whether the closed loop is unstable.
    pub is_unstable: bool,
}

impl Linearisation {
    /// The loop through the torque of `velocity`; `None` where forces do not move it.
    pub fn loop_gain(&self, velocity: usize) -> Option<LoopGain<'_>> {
        self.free.contains(&velocity).then(|| LoopGain {
            assembly: Assembly::new(self, &[Excitation::Torque(velocity)], Parts::All, Some(velocity)),
            velocity,
        })
    }
}

impl LoopGain<'_> {
    /// L(iω), ω in rad/s.
    pub fn at(&self, omega: f64) -> Complex64 {
        let s = Complex64::new(0.0, omega);
        let powers = self.assembly.powers(s);
        let columns = &self.assembly.solve(s, &powers)[0];
        -self.assembly.said[self.velocity].times(s, &self.assembly.springpots, &powers, columns)
    }

    /// The margins: zeros of ln |L| and of Im L, between which the places looked at lie close to one another around all eigenvalues.
    ///
    /// # Errors
    /// [`ModesError`].
    pub fn margins(&self) -> Result<Margins, ModesError> {
        let closed = self.assembly.linear.modes()?;
        let mut rates: Vec<Complex64> = closed.modes.iter().map(|mode| mode.eigenvalue).collect();
        rates.extend(self.opened().modes()?.modes.iter().map(|mode| mode.eigenvalue));
        let places = places(&rates);
        let ln = |u: f64| self.at(u.exp()).norm().ln();
        let values: Vec<Complex64> = places.iter().map(|u| self.at(u.exp())).collect();
        let crossovers = zeros(&places, &values.iter().map(|l| l.norm().ln()).collect::<Vec<_>>(), &ln);
        let lag = |u: &f64| ((self.at(u.exp()).arg() + PI).rem_euclid(TAU), u.exp());
        let lags: Vec<(f64, f64)> = crossovers.iter().map(lag).collect();
        let phase = lags.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
        let delay = lags.iter().map(|(lag, omega)| lag / omega).min_by(f64::total_cmp);
        let imaginary = |l: Complex64| if l.im.abs() <= REAL * l.norm() { 0.0 } else { l.im };
        let parts: Vec<f64> = values.iter().map(|l| imaginary(*l)).collect();
        let real = zeros(&places, &parts, &|u| self.at(u.exp()).im);
        let mut factors: Vec<(f64, f64)> = real
            .iter()
            .map(|u| (self.at(u.exp()), u.exp()))
            .collect::<Vec<_>>()
            .into_iter()
            .filter(|(l, _)| l.re < 0.0 && l.im.abs() <= 1e-6 * l.norm())
            .map(|(l, omega)| (l.norm().recip(), omega))
            .collect();
        let still = self.at(0.0);
        if still.re < 0.0 && still.is_finite() && still.im.abs() <= REAL * still.norm() {
            factors.push((still.norm().recip(), 0.0));
        }
        let gain = factors.into_iter().filter(|(factor, _)| *factor > 1.0).min_by(|a, b| a.0.total_cmp(&b.0));
        let is_unstable = closed.modes.iter().any(|mode| mode.is_unstable());
        Ok(Margins { phase, gain, delay, sensitivity: self.peak(&places, &values), is_unstable })
    }

    /// The same robot without what control says of the velocity.
    fn opened(&self) -> Linearisation {
        let (k, mut linear) = (self.velocity, self.assembly.linear.clone());
        let n = linear.left_over.len();
        let control = &mut linear.control;
        for matrix in [&mut control.by_q, &mut control.by_v] {
            if let Some(line) = matrix.get_mut(k * n..(k + 1) * n) {
                line.fill(0.0);
            }
        }
        control.terms.retain(|term| term.velocity != k);
        control
            .relieved
            .iter_mut()
            .enumerate()
            .filter(|(own, _)| *own == k)
            .for_each(|(_, relieved)| *relieved = false);
        linear
    }

    /// The largest |1/(1 + L)|.
    fn peak(&self, places: &[f64], values: &[Complex64]) -> (f64, Option<f64>) {
        let size = |l: Complex64| (1.0 + l).norm().recip();
        let sizes: Vec<f64> = values.iter().map(|l| size(*l)).collect();
        let ln = |u: f64| -size(self.at(u.exp())).ln();
        let inside =
            (1..places.len().saturating_sub(1)).filter(|&k| sizes[k] >= sizes[k - 1] && sizes[k] >= sizes[k + 1]);
        let found = inside.map(|k| {
            let u = lowest(&ln, [places[k - 1], places[k], places[k + 1]]);
            (size(self.at(u.exp())).max(sizes[k]), Some(u.exp()))
        });
        let ends = [(sizes.first().copied(), Some(0.0)), (sizes.last().copied(), None)];
        let ends = ends.into_iter().filter_map(|(size, omega)| size.map(|size| (size, omega)));
        // An end counts unless what is inside is above it by more than rounding.
        let best = found.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, None));
        ends.fold(best, |best, end| if end.0 * (1.0 + 1e-9) > best.0 { end } else { best })
    }
}

/// ln ω where a loop is looked at.
fn places(rates: &[Complex64]) -> Vec<f64> {
    let sizes = || rates.iter().map(|s| s.norm()).filter(|size| *size > 0.0);
    let low = sizes().fold(f64::INFINITY, f64::min).min(1.0).ln() - DECADES * std::f64::consts::LN_10;
    let high = sizes().fold(0.0, f64::max).max(1.0).ln() + DECADES * std::f64::consts::LN_10;
    let count = ((high - low) / std::f64::consts::LN_10 * PLACES as f64).ceil() as usize;
    let mut all: Vec<f64> = (0..=count).map(|k| low + (high - low) * k as f64 / count as f64).collect();
    for s in rates.iter().filter(|s| s.im != 0.0) {
        let width = (s.re / s.norm()).abs().clamp(1e-9, 0.3);
        for beside in BESIDE {
            all.extend([1.0, -1.0].map(|side| s.im.abs().ln() + side * beside * width));
        }
    }
    all.retain(|u| u.is_finite());
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a - *b < 1e-13);
    all
}

/// Zeros of a function of which `values` are known at rising `places`, also where it but touches zero from one side between them.
fn zeros(places: &[f64], values: &[f64], of: &dyn Fn(f64) -> f64) -> Vec<f64> {
    let mut found = Vec::new();
    for k in 1..places.len() {
        let (a, b) = (values[k - 1], values[k]);
        if a == 0.0 && (k == 1 || values[k - 2] * b < 0.0) {
            found.push(places[k - 1]);
        }
        if a * b < 0.0 {
            found.push(zero(of, [places[k - 1], places[k]], a));
            continue;
        }
        let Some(&c) = values.get(k + 1) else { continue };
        // An extremum towards zero between three places of one sign.
        if a * b > 0.0 && b * c > 0.0 && b.abs() < a.abs() && b.abs() < c.abs() {
            let sign = b.signum();
            let u = lowest(&|u| sign * of(u), [places[k - 1], places[k], places[k + 1]]);
            if sign * of(u) < 0.0 {
                found.push(zero(of, [places[k - 1], u], a));
                found.push(zero(of, [u, places[k + 1]], -sign));
            }
        }
    }
    found
}

/// The zero between two places, at the first of which the function has the sign of `first`.
fn zero(of: &dyn Fn(f64) -> f64, [mut low, mut high]: [f64; 2], first: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if of(middle) * first > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Where a function is least within three places, the middle one of which is below the others: golden sections.
fn lowest(of: &dyn Fn(f64) -> f64, [mut low, middle, mut high]: [f64; 3]) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let mut best = (of(middle), middle);
    for _ in 0..80 {
        let [left, right] = [high - ratio * (high - low), low + ratio * (high - low)];
        let [a, b] = [left, right].map(of);
        for (value, at) in [(a, left), (b, right)] {
            if value < best.0 {
                best = (value, at);
            }
        }
        if a < b { high = right } else { low = left }
    }
    best.1
}
