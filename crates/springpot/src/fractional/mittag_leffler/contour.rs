//! The parabolas s = μ(1 + iu)² and the trapezoidal sums on them.

use super::pole::Poles;
use super::{Complex64, LANES};
use std::f64::consts::PI;

/// −ln of the relative error of the trapezoidal rule.
const DIGITS: f64 = 37.0;

/// Where √(w/μ) of a pole may not be on a parabola of its choice: 1 ± this.
const CLEARANCE: f64 = 0.18;

/// Ratio of the μ of two neighbouring parabolas: no pole is too close to both.
const SHRINK: f64 = ((1.0 + CLEARANCE) / (1.0 - CLEARANCE)) * ((1.0 + CLEARANCE) / (1.0 - CLEARANCE));

/// Terms may be larger than their sum by this without harm.
const FEW: f64 = 30.0;

/// Parabolas of falling size, one more than there are poles.
#[derive(Debug, Clone)]
pub(super) struct Contours {
    parabolas: Vec<Parabola>,
}

/// Nodes of the upper half, at u = h/2, 3h/2, …; the lower half is conjugate.
#[derive(Debug, Clone)]
pub(super) struct Parabola {
    pub(super) mu: f64,
    /// 2π/h.
    pub(super) frequency: f64,
    /// Poles with Re √(w/μ) below are part of the cut and take no term.
    pub(super) deepest: f64,
    /// s^a − 1, which keeps its digits as a → 0.
    power: Vec<Complex64>,
    /// h e^s s^{a−b} s'/(2πi), times n!.
    weight: Vec<Complex64>,
}

impl Contours {
    pub(super) fn new(a: f64, b: f64, n: usize) -> Self {
        // At the end of the strip of analyticity, u = i, s^{−b−na} s^½ stands against the accuracy.
        let exponent = (2.0 * (b + n as f64 * a) - 1.0).max(1.0);
        // A pole just beyond the cut adds its own order.
        let exponent = if n < Self::CAREFUL { exponent } else { exponent + n as f64 };
        let by_depth = |depth: f64| ((DIGITS + exponent * (1.0 / depth).ln()) / (1.0 - depth), depth);
        let depths = (1..=35).map(|k| by_depth(0.02 * k as f64));
        let (frequency, deepest) = depths.min_by(|x, y| x.0.total_cmp(&y.0)).expect("35 depths");
        // Largest μ that the lower half of the strip allows.
        let largest = frequency * frequency / (4.0 * (DIGITS + frequency));
        // The saddles of e^s s^{−b} and e^s s^{−b−na} are at b and b + na: the sum cancels least near them or below.
        let mu = (0.5 + b + 0.5 * n as f64 * a).clamp(1.0, largest);
        let count = a.ceil() as i32 + 1;
        // Poles of high order want more room, and wider parabolas to find it.
        let wider = if n < Self::CAREFUL { 0 } else { ((largest / mu).ln() / SHRINK.ln()) as i32 };
        let parabola = |k: i32| Parabola::new(a, b, n, mu * SHRINK.powi(-k), frequency, deepest);
        Self { parabolas: (0..count).chain((1..=wider.min(2)).map(|k| -k)).map(parabola).collect() }
    }

    /// From this derivative on every value is judged by the size of its terms.
    pub(super) const CAREFUL: usize = 3;

    /// The value on the first parabola that loses no digits, or else on the one that loses the fewest.
    pub(super) fn best(&self, a: f64, b: f64, n: usize, z: Complex64) -> Complex64 {
        let poles = Poles::of(a, z, 1.0);
        let first = self.clear_of(&poles);
        let others = self.parabolas.iter().filter(|parabola| parabola.mu != first.mu);
        let measured = |parabola: &Parabola| {
            let (mut value, mut size) = parabola.measured(n, z);
            for pole in poles.all() {
                let (term, largest) = pole.on_parabola(b, n, parabola);
                value += term;
                size += largest;
            }
            (value, size / value.norm().max(1e-3))
        };
        let mut best = measured(first);
        for parabola in others {
            // Also where both are infinite and this is NaN.
            if best.1 <= FEW || best.1.is_nan() {
                break;
            }
            let next = measured(parabola);
            if next.1 < best.1 {
                best = next;
            }
        }
        best.0
    }

    /// The largest parabola, which takes the fewest nodes.
    pub(super) fn widest(&self) -> &Parabola {
        &self.parabolas[0]
    }

    /// The largest parabola of which no pole is too close, or else the one farthest from all poles.
    pub(super) fn clear_of(&self, poles: &Poles) -> &Parabola {
        let distance = |parabola: &Parabola| {
            poles.iter().map(|pole| (1.0 - pole.depth(parabola.mu)).abs()).fold(f64::INFINITY, f64::min)
        };
        let clear = self.parabolas.iter().find(|parabola| distance(parabola) >= CLEARANCE);
        clear.unwrap_or_else(|| {
            let by_distance = |x: &&Parabola, y: &&Parabola| distance(x).total_cmp(&distance(y));
            self.parabolas.iter().max_by(by_distance).expect("there are parabolas")
        })
    }
}

impl Parabola {
    fn new(a: f64, b: f64, n: usize, mu: f64, frequency: f64, deepest: f64) -> Self {
        let h = 2.0 * PI / frequency;
        let growth = (a - b + 0.5).max(0.0);
        let factorial: f64 = (1..=n).map(|k| k as f64).product();
        // Near a pole of high order beside the cut, far nodes weigh more than their exponentials say.
        let digits = if n < Contours::CAREFUL { DIGITS } else { DIGITS + 2.5 * n as f64 };
        let (mut power, mut weight) = (Vec::new(), Vec::new());
        for k in 0.. {
            let u = (k as f64 + 0.5) * h;
            let norm = 1.0 + u * u;
            if mu * (1.0 - u * u) + growth * (mu * norm).ln().max(0.0) < -digits {
                break;
            }
            let s = Complex64::new(mu * (1.0 - u * u), 2.0 * mu * u);
            let ln_s = Complex64::new(mu.ln() + u.powi(2).ln_1p(), 2.0 * u.atan());
            let power_less_one = exp_m1(a * ln_s);
            // With the rounded s^a, so that its rounding cancels for small z.
            let integrand = (s - b * ln_s).exp() * (power_less_one + 1.0);
            power.push(power_less_one);
            weight.push(integrand * Complex64::new(1.0, u) * (factorial * h * mu / PI));
        }
        Self { mu, frequency, deepest, power, weight }
    }

    /// n!·h Σ_k f(u_k) at a real argument: twice the real part of the upper half.
    pub(super) fn real(&self, n: usize, x: f64) -> f64 {
        let shift = 1.0 - x;
        let nodes = self.power.iter().zip(&self.weight);
        if n == 0 {
            return 2.0 * nodes.fold(0.0, |sum, (p, w)| sum + real_term(p, w, shift));
        }
        2.0 * nodes.fold(0.0, |sum, (p, w)| sum + (w * (p + shift).inv().powu(n as u32 + 1)).re)
    }

    /// The same for several arguments, n = 0.
    pub(super) fn real_lanes(&self, x: &[f64; LANES]) -> [f64; LANES] {
        let shift = x.map(|x| 1.0 - x);
        let mut sum = [0.0; LANES];
        for (p, w) in self.power.iter().zip(&self.weight) {
            for lane in 0..LANES {
                sum[lane] += real_term(p, w, shift[lane]);
            }
        }
        sum.map(|sum| 2.0 * sum)
    }

    /// The same at any argument with the sum of the sizes of its terms.
    fn measured(&self, n: usize, z: Complex64) -> (Complex64, f64) {
        let shift = 1.0 - z;
        let order = n as u32 + 1;
        let nodes = self.power.iter().zip(&self.weight);
        nodes.fold((Complex64::ZERO, 0.0), |(sum, size), (p, w)| {
            let (upper, lower) = (w * (p + shift).inv().powu(order), w.conj() * (p.conj() + shift).inv().powu(order));
            (sum + upper + lower, size + upper.l1_norm() + lower.l1_norm())
        })
    }

    /// n!·h Σ_k f(u_k) at a complex argument.
    pub(super) fn complex(&self, n: usize, z: Complex64) -> Complex64 {
        let shift = Complex64::new(1.0 - z.re, -z.im);
        let order = n as u32 + 1;
        let nodes = self.power.iter().zip(&self.weight);
        nodes.fold(Complex64::ZERO, |sum, (p, w)| {
            let (upper, lower) = ((p + shift).inv(), (p.conj() + shift).inv());
            sum + match order {
                1 => w * upper + w.conj() * lower,
                order => w * upper.powu(order) + w.conj() * lower.powu(order),
            }
        })
    }
}

/// Re w/(s^a − x).
#[inline]
fn real_term(power: &Complex64, weight: &Complex64, shift: f64) -> f64 {
    let re = power.re + shift;
    (weight.re * re + weight.im * power.im) / (re * re + power.im * power.im)
}

/// e^z − 1 without cancellation near 0.
pub(super) fn exp_m1(z: Complex64) -> Complex64 {
    let half = (0.5 * z.im).sin();
    Complex64::new(z.re.exp_m1() * z.im.cos() - 2.0 * half * half, z.re.exp() * z.im.sin())
}
