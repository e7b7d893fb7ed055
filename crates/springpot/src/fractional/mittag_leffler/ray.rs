//! The integral along both sides of the cut arg s = ±π, for b so far below 0 that the parabola's sum would cancel.

use super::Complex64;
use super::exact::Exact;
use super::pole::Poles;
use super::series::LongSeries;
use std::f64::consts::PI;

/// −ln of the relative error of the trapezoidal rule.
const DIGITS: f64 = 39.0;

/// Turns of the ray, of which that is taken which keeps farthest from all poles; also their negatives.
const TURNS: [f64; 3] = [0.0, 0.35, 0.7];

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
    step: f64,
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
        let turn = TURNS[TURNS.len() - 1];
        // Where the strip ends, towards the imaginary axis, e^{−r} decays more slowly.
        let frequency = |depth: f64| (DIGITS + exponent * (turn.cos() / (turn + depth).cos()).ln()) / depth;
        let strips = (4..=42).map(|k| frequency(0.02 * f64::from(k)));
        let step = 2.0 * PI / strips.fold(f64::INFINITY, f64::min);
        let (sine, cosine) = Exact::new(a, 1, 0.0).sin_cos_pi();
        let (s, c) = Exact::new(a, n, b).sin_cos_pi();
        let rays = TURNS.map(|turn| Ray::new(a, exponent, n, step, turn));
        let half_sine = (0.5 * PI * a).sin();
        let versine = if cosine > 0.0 && a < 0.5 { 2.0 * half_sine * half_sine } else { 1.0 - cosine };
        Self { n, step, sine, versine, mixture: [s, c], rays, series: LongSeries::new(a, b, n) }
    }

    /// dⁿE/dzⁿ at z ≠ 0.
    pub(super) fn value(&self, a: f64, b: f64, z: Complex64) -> Complex64 {
        if let Some(value) = self.series.value(z) {
            return value;
        }
        let poles = Poles::of(a, z, SHEET);
        let clearance = |turn: f64| poles.all().map(|pole| (pole.beyond_cut() - turn).abs()).fold(ENOUGH, f64::min);
        let turn = TURNS
            .iter()
            .flat_map(|turn| [*turn, -turn])
            .fold(0.0, |best, turn| if clearance(turn) > clearance(best) { turn } else { best });
        poles
            .all()
            .fold(self.cut(z, turn), |sum, pole| sum + pole.term(b, self.n, &pole.switch_at_cut(turn, self.step)).0)
    }

    fn cut(&self, z: Complex64, turn: f64) -> Complex64 {
        let ray = &self.rays[TURNS.iter().position(|t| *t == turn.abs()).unwrap_or(0)];
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
    fn new(a: f64, exponent: f64, n: usize, step: f64, turn: f64) -> Self {
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
        Self { power, weight }
    }
}

/// A pole farther than this from the ray, in radians, does no harm.
const ENOUGH: f64 = 0.8;
