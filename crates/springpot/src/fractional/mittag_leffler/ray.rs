//! The integral along both sides of the cut arg s = ±π, for b so far below 0 that the parabola's sum would cancel.

use super::Complex64;
use super::exact::Exact;
use super::pole::Poles;
use super::series::LongSeries;
use std::f64::consts::PI;

/// −ln of the relative error of the trapezoidal rule.
const DIGITS: f64 = 39.0;

/// Turns of the ray, and their negatives: near a pole the integrand is large, and where e^{−r} turns it is so everywhere.
const TURNS: [f64; 4] = [0.0, 0.35, 0.7, 1.0];

/// Poles with |arg w| below this many π: farther ones are beyond the strip in which the integrand decays.
const SHEET: f64 = 1.5;

/// Nodes s = r e^{±iπ} with ln r = kh + iδ for every turn δ.
///
/// With P = r^a e^{iπa} − z above and P̄ = r^a e^{−iπa} − z below the cut, G = e^{−iπa}P/z, H = e^{iπa}P̄/z and m = n + 1,
/// the share of the cut is
///
/// n!/(π z^m) ∫₀^∞ e^{−r} r^{a−b} (sin π(b+an)·Re G^m + cos π(b+an)·Im G^m)/(G H)^m dr,
///
/// where Re and Im stand for the parts of (q + i sin πa)^m that are even and odd in sin πa, q = r^a/z − cos πa. The
/// sines are taken of the exact distance to a whole number, so that nothing cancels where a, b or both are nearly
/// whole, and the integrand is as small as what is left.
#[derive(Debug, Clone)]
pub(super) struct Rays {
    n: usize,
    /// Of r in the integrand, as far as no pole takes over.
    exponent: f64,
    /// sin πa and 1 − cos πa.
    sine: f64,
    versine: f64,
    /// sin and cos of π(b + an).
    mixture: [f64; 2],
    rays: [Ray; TURNS.len()],
    series: LongSeries,
}

/// Nodes of one turn.
#[derive(Debug, Clone)]
struct Ray {
    turn: f64,
    step: f64,
    /// r^a − 1.
    power: Vec<Complex64>,
    /// n! h e^{−r} r^{a−b+1}/π.
    weight: Vec<Complex64>,
}

impl Rays {
    /// Largest b for which the rays are taken.
    pub(super) const BELOW: f64 = -1.0;

    pub(super) fn new(a: f64, b: f64, n: usize) -> Self {
        let exponent = a - b + 1.0;
        let (sine, cosine) = Exact::new(a, 1, 0.0).sin_cos_pi();
        let (s, c) = Exact::new(a, n, b).sin_cos_pi();
        let rays = TURNS.map(|turn| Ray::new(a, exponent, n, turn));
        let half_sine = (0.5 * PI * a).sin();
        let versine = if cosine > 0.0 && a < 0.5 { 2.0 * half_sine * half_sine } else { 1.0 - cosine };
        let exponent = (exponent - a * (n + 1) as f64).max(0.0);
        Self { n, exponent, sine, versine, mixture: [s, c], rays, series: LongSeries::new(a, b, n) }
    }

    /// dⁿE/dzⁿ at z ≠ 0.
    pub(super) fn value(&self, a: f64, b: f64, z: Complex64) -> Complex64 {
        if let Some(value) = self.series.value(z) {
            return value;
        }
        let poles = Poles::of(a, z, SHEET);
        // ln of what the sum may lose.
        let loss = |turn: f64| {
            let distances = poles.all().map(|pole| (pole.beyond_cut() - turn).abs());
            let clearance = distances.fold(ENOUGH, f64::min);
            -self.exponent * turn.cos().ln() - (self.n + 1) as f64 * clearance.ln()
        };
        let turns = self.rays.iter().flat_map(|ray| [(ray, ray.turn), (ray, -ray.turn)]);
        let (ray, turn, _) = turns.fold((&self.rays[0], 0.0, loss(0.0)), |best, (ray, turn)| {
            let loss = loss(turn);
            if loss < best.2 { (ray, turn, loss) } else { best }
        });
        poles
            .all()
            .fold(self.cut(z, ray, turn), |sum, pole| sum + pole.term(b, self.n, &pole.switch_at_cut(turn, ray.step)).0)
    }

    fn cut(&self, z: Complex64, ray: &Ray, turn: f64) -> Complex64 {
        let m = self.n as u32 + 1;
        let inverse = z.inv();
        // (r^a − z cos πa)/z from what is exact near r^a = 1 = z.
        let shift = (1.0 - z) * inverse + self.versine;
        let [s, c] = self.mixture;
        let nodes = ray.power.iter().zip(&ray.weight);
        let sum: Complex64 = nodes
            .map(|(power, weight)| {
                let (power, weight) = if turn < 0.0 { (power.conj(), weight.conj()) } else { (*power, *weight) };
                let q = power * inverse + shift;
                let (mut even, mut odd) = (q, Complex64::from(self.sine));
                for _ in 1..m {
                    (even, odd) = (even * q - odd * self.sine, even * self.sine + odd * q);
                }
                weight * (even * s + odd * c) / (q * q + self.sine * self.sine).powu(m)
            })
            .sum();
        sum * inverse.powu(m)
    }
}

impl Ray {
    fn new(a: f64, exponent: f64, n: usize, turn: f64) -> Self {
        // Where the strip ends, towards the imaginary axis, e^{−r} decays more slowly.
        let frequency = |depth: f64| (DIGITS + exponent * (turn.cos() / (turn + depth).cos()).ln()) / depth;
        let depths = (1..=19).map(|k| 0.05 * f64::from(k) * (0.5 * PI - turn));
        let step = 2.0 * PI / depths.map(frequency).fold(f64::INFINITY, f64::min);
        let factorial: f64 = (1..=n).map(|k| k as f64).product();
        // From where r^exponent is nothing up to where e^{−r} is.
        let first = (-(DIGITS / exponent + 1.0) / step).floor();
        let peak = exponent * (exponent.ln() - 1.0);
        let (mut power, mut weight) = (Vec::new(), Vec::new());
        for k in 0.. {
            let y = (first + f64::from(k)) * step;
            if exponent * y - y.exp() * turn.cos() < peak - DIGITS && y.exp() > exponent {
                break;
            }
            let ln_r = Complex64::new(y, turn);
            power.push(super::contour::exp_m1(a * ln_r));
            weight.push((exponent * ln_r - ln_r.exp()).exp() * (factorial * step / PI));
        }
        Self { turn, step, power, weight }
    }
}

/// A pole farther than this from the ray, in radians, makes nothing better.
const ENOUGH: f64 = 2.0;
