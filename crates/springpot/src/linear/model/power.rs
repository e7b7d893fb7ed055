//! s^alpha over a band as a rational function with few real poles, all below 0, and weights above 0.
//!
//! R(s) = g ∏(s + z_k)/∏(s + p_k) with z_0 < p_1 < z_1 < … : ln R − alpha ln s is a sum of logarithms, smooth in ln z and ln p, and its largest
//! size over the band is what is made least, by Levenberg–Marquardt steps whose weights go where it is large (C. L. Lawson, thesis, UCLA 1961).
//! Interlacing zeros and poles are those of a network of springs and dashpots (A. Oustaloup, La commande CRONE, 1991).

use crate::linalg::Triangle;
use num_complex::Complex64;

/// Most poles of one springpot.
pub(super) const MOST: usize = 44;
const ROUNDS: usize = 6;
const STEPS: usize = 12;
/// The damping that steps begin with, and its factor where one is worth it: from a start that is near, and from one that is not.
const BOLD: [f64; 2] = [1e-6, 0.05];
const CAREFUL: [f64; 2] = [1e-3, 0.2];

/// s^alpha ≈ d0 + d1 s + Σ w_i s/(s + p_i) over a band.
#[derive(Debug, Clone)]
pub(super) struct Power {
    pub(super) spring: f64,
    pub(super) dashpot: f64,
    /// w_i and p_i, 1/s.
    pub(super) branches: Vec<[f64; 2]>,
    /// The largest |R/s^alpha − 1| over the band.
    pub(super) error: f64,
}

impl Power {
    /// R(s).
    pub(super) fn at(&self, s: Complex64) -> Complex64 {
        let branches = self.branches.iter().map(|[weight, pole]| s * *weight / (s + *pole));
        self.spring + self.dashpot * s + branches.sum::<Complex64>()
    }
}

/// Approximations of one order over one band with 0, 1, 2, … poles, as they are asked for.
#[derive(Debug)]
pub(super) struct Powers {
    order: f64,
    /// Angular frequencies, rad/s.
    band: [f64; 2],
    /// Whether R is bounded at infinity.
    is_proper: bool,
    /// ln of zeros and poles in turn, the middle of the band 0, and ln g.
    found: Vec<(Vec<f64>, f64)>,
    powers: Vec<Power>,
}

impl Powers {
    pub(super) fn new(order: f64, band: [f64; 2], is_proper: bool) -> Self {
        Self { order, band, is_proper, found: Vec::new(), powers: Vec::new() }
    }

    /// That of `count` poles; `None` beyond [`MOST`], or where more of them gain nothing.
    pub(super) fn get(&mut self, count: usize) -> Option<&Power> {
        while self.powers.len() <= count && self.powers.len() <= MOST {
            self.add();
        }
        self.powers.get(count)
    }

    /// The fewest poles of an error up to `error`.
    pub(super) fn fewest(&mut self, error: f64) -> Option<usize> {
        let mut best = (f64::INFINITY, 0);
        for count in 0..=MOST {
            let own = self.get(count)?.error;
            if own <= error {
                return Some(count);
            }
            if own < best.0 {
                best = (own, count);
            }
            // Errors fall by one factor for each pole, and where rounding ends that they fall no more.
            let falls = if count > 5 { own / self.get(count - 1)?.error } else { 0.0 };
            if count > best.1 + 2 || own * falls.powi((MOST - count) as i32) > 10.0 * error {
                break;
            }
        }
        None
    }

    /// The count of the smallest error so far.
    pub(super) fn best(&self) -> usize {
        let errors = self.powers.iter().map(|power| power.error).enumerate();
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(count, _)| count)
    }

    fn add(&mut self) {
        let count = self.powers.len();
        let half = 0.5 * (self.band[1] / self.band[0]).ln();
        let places = if self.is_proper { 2 * count } else { 2 * count + 1 };
        let start = match self.found.last() {
            Some((before, _)) if before.len() >= 4 => stretched(before, places),
            _ => self.spread(places, half),
        };
        let fit = Fit::new(self.order, half, count);
        let best = self.powers.iter().map(|other| other.error).fold(f64::INFINITY, f64::min);
        let (mut logs, mut gain) = fit.run(start.clone(), BOLD);
        let mut power = self.physical(&logs, gain, &fit);
        if power.error > 0.8 * best {
            let (other, by) = fit.run(start, CAREFUL);
            let careful = self.physical(&other, by, &fit);
            if careful.error < power.error {
                (logs, gain, power) = (other, by, careful);
            }
        }
        // Where rounding ends the search the last one that was found is where the next starts.
        if self.powers.iter().all(|other| power.error < other.error) {
            self.found.push((logs, gain));
        }
        self.powers.push(power);
    }

    /// Zeros and poles in turn with the slope alpha between them.
    fn spread(&self, places: usize, half: f64) -> Vec<f64> {
        let period = 2.0 * half / (0.5 * places as f64).max(1.0);
        let mut at = Vec::with_capacity(places);
        let mut place = 0.0;
        for k in 0..places {
            at.push(place);
            place += period * if k % 2 == 0 { self.order } else { 1.0 - self.order };
        }
        let middle = 0.5 * at.last().copied().unwrap_or(0.0);
        at.iter().map(|place| place - middle).collect()
    }

    /// In rad/s, as partial fractions.
    fn physical(&self, logs: &[f64], gain: f64, fit: &Fit) -> Power {
        let middle = (self.band[0] * self.band[1]).sqrt();
        let zeros: Vec<f64> = logs.iter().step_by(2).map(|x| middle * x.exp()).collect();
        let poles: Vec<f64> = logs.iter().skip(1).step_by(2).map(|x| middle * x.exp()).collect();
        let excess = zeros.len() as i32 - poles.len() as i32;
        let gain = gain.exp() * middle.powf(self.order) / middle.powi(excess);
        let ratio = |at: f64, skipped: Option<usize>| {
            // Factor by factor, so that nothing overflows.
            let mut product = gain;
            for k in 0..zeros.len().max(poles.len()) {
                product *= zeros.get(k).map_or(1.0, |zero| zero - at);
                product /= poles.get(k).filter(|_| Some(k) != skipped).map_or(1.0, |pole| pole - at);
            }
            product
        };
        let branches: Vec<[f64; 2]> =
            poles.iter().enumerate().map(|(i, &pole)| [-ratio(pole, Some(i)) / pole, pole]).collect();
        let mut power =
            Power { spring: ratio(0.0, None), dashpot: if excess == 1 { gain } else { 0.0 }, branches, error: 0.0 };
        let is_passive = power.branches.iter().all(|[weight, pole]| *weight > 0.0 && *pole > 0.0);
        let off = |x: f64| {
            let s = Complex64::new(0.0, middle * x.exp());
            (power.at(s) / s.powf(self.order) - 1.0).norm()
        };
        let largest = fit.finer().map(off).fold(0.0, f64::max);
        power.error = if is_passive && largest.is_finite() { largest } else { f64::INFINITY };
        power
    }
}

/// As many zeros and poles in turn as wanted along the same distribution: zeros over zeros, and each pole at its share of the way to the next
/// zero.
fn stretched(before: &[f64], places: usize) -> Vec<f64> {
    let zeros: Vec<f64> = before.iter().step_by(2).copied().collect();
    let spacing = |k: usize| match zeros.get(k + 1) {
        Some(next) => next - zeros[k],
        None => zeros[k] - zeros[k - 1],
    };
    let shares: Vec<f64> =
        before.iter().skip(1).step_by(2).enumerate().map(|(k, pole)| (pole - zeros[k]) / spacing(k)).collect();
    let along = |values: &[f64], share: f64| {
        let u = share * (values.len() - 1) as f64;
        let k = (u.floor() as usize).min(values.len().saturating_sub(2));
        match values.get(k + 1) {
            Some(next) => values[k] + (u - k as f64) * (next - values[k]),
            None => values[k],
        }
    };
    let count = places.div_ceil(2);
    let share = |k: usize, count: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
    let moved: Vec<f64> = (0..count).map(|k| along(&zeros, share(k, count))).collect();
    let poles = places / 2;
    let mut all = Vec::with_capacity(places);
    for k in 0..count {
        all.push(moved[k]);
        if k < poles {
            let next = moved.get(k + 1).map_or_else(|| moved[k] - moved[k - 1], |next| next - moved[k]);
            all.push(moved[k] + along(&shares, share(k, poles)) * next);
        }
    }
    all
}

/// Least |ln R − alpha ln s| over [−half, half] of ln ω.
struct Fit {
    order: f64,
    places: Vec<f64>,
}

impl Fit {
    fn new(order: f64, half: f64, count: usize) -> Self {
        let points = 40 + 8 * (count + 1);
        let place = |k: usize| half * (std::f64::consts::PI * k as f64 / (points - 1) as f64).cos();
        Self { order, places: (0..points).map(place).collect() }
    }

    /// Three times as many places.
    fn finer(&self) -> impl Iterator<Item = f64> {
        let between = self
            .places
            .windows(2)
            .flat_map(|pair| [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|share| pair[0] + share * (pair[1] - pair[0])));
        between.chain(self.places.last().copied())
    }

    /// ln R − alpha ln s at each place.
    fn residuals(&self, logs: &[f64], gain: f64) -> Vec<Complex64> {
        let zeros: Vec<f64> = logs.iter().map(|x| x.exp()).collect();
        let one = |&x: &f64| {
            let s = Complex64::new(0.0, x.exp());
            let mut sum = gain - self.order * s.ln();
            for (k, place) in zeros.iter().enumerate() {
                sum += if k % 2 == 0 { (s + *place).ln() } else { -(s + *place).ln() };
            }
            sum
        };
        self.places.iter().map(one).collect()
    }

    fn run(&self, mut logs: Vec<f64>, [mut damping, shrinks]: [f64; 2]) -> (Vec<f64>, f64) {
        let mut gain = 0.0;
        let first = self.residuals(&logs, 0.0);
        gain -= first.iter().map(|r| r.re).sum::<f64>() / first.len() as f64;
        let mut weights = vec![1.0; self.places.len()];
        let largest = |residuals: &[Complex64]| residuals.iter().map(|r| r.norm()).fold(0.0, f64::max);
        let mut best = (largest(&self.residuals(&logs, gain)), logs.clone(), gain);
        for round in 0..ROUNDS {
            for _ in 0..if round == 0 { 5 * STEPS } else { STEPS } {
                let (moved, by, gained) = self.step(&logs, gain, &weights, (&mut damping, shrinks));
                (logs, gain) = (moved, by);
                if !gained {
                    break;
                }
            }
            let residuals = self.residuals(&logs, gain);
            let most = largest(&residuals);
            if most < best.0 {
                best = (most, logs.clone(), gain);
            }
            let mean = residuals.iter().map(|r| r.norm()).sum::<f64>() / residuals.len() as f64;
            if mean.is_nan() || mean <= 0.0 {
                break;
            }
            for (weight, residual) in weights.iter_mut().zip(&residuals) {
                *weight = (*weight * (residual.norm() / mean).max(1e-3)).max(1e-6);
            }
            let total = weights.iter().sum::<f64>() / weights.len() as f64;
            weights.iter_mut().for_each(|weight| *weight /= total);
        }
        (best.1, best.2)
    }

    /// One step, and whether it was worth it.
    fn step(
        &self,
        logs: &[f64],
        gain: f64,
        weights: &[f64],
        (damping, shrinks): (&mut f64, f64),
    ) -> (Vec<f64>, f64, bool) {
        let n = logs.len() + 1;
        let cost = |residuals: &[Complex64]| -> f64 {
            residuals.iter().zip(weights).map(|(r, weight)| weight * r.norm_sqr()).sum()
        };
        let residuals = self.residuals(logs, gain);
        let before = cost(&residuals);
        let mut rows = Vec::with_capacity(2 * residuals.len() * (n + 1));
        for ((x, residual), weight) in self.places.iter().zip(&residuals).zip(weights) {
            let (s, root) = (Complex64::new(0.0, x.exp()), weight.sqrt());
            let slopes: Vec<Complex64> = logs
                .iter()
                .enumerate()
                .map(|(k, log)| {
                    let place = log.exp();
                    let slope = place / (s + place);
                    if k % 2 == 0 { slope } else { -slope }
                })
                .collect();
            rows.extend(slopes.iter().map(|slope| root * slope.re).chain([root, -root * residual.re]));
            rows.extend(slopes.iter().map(|slope| root * slope.im).chain([0.0, -root * residual.im]));
        }
        let mut all = Triangle::new(n + 1);
        all.absorb(&mut rows);
        for _ in 0..12 {
            let mut triangle = all.clone();
            let mut damped = vec![0.0; n * (n + 1)];
            (0..n).for_each(|k| damped[k * (n + 2)] = *damping * all.norm(k).max(1e-12));
            triangle.absorb(&mut damped);
            let mut step = vec![0.0; n];
            for k in (0..n).rev() {
                let own: f64 = (k + 1..n).map(|j| triangle.at(k, j) * step[j]).sum();
                step[k] = (triangle.at(k, n) - own) / triangle.at(k, k);
            }
            let moved: Vec<f64> = logs.iter().zip(&step).map(|(log, step)| log + step.clamp(-1.0, 1.0)).collect();
            let by = gain + step[n - 1];
            // Zeros and poles stay in turn.
            let in_turn = moved.windows(2).all(|pair| pair[0] < pair[1]);
            let after = if in_turn { cost(&self.residuals(&moved, by)) } else { f64::INFINITY };
            if after < before {
                *damping = (*damping * shrinks).max(1e-16);
                return (moved, by, after < before * (1.0 - 1e-6));
            }
            *damping = (*damping * if shrinks < 0.1 { 10.0 } else { 5.0 }).min(1e6);
        }
        (logs.to_vec(), gain, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_poles_are_exact_over_the_band() {
        for order in [0.05, 0.2, 0.5, 0.8, 0.95] {
            for is_proper in [false, true] {
                let mut powers = Powers::new(order, [0.6, 630.0], is_proper);
                let mut before = f64::INFINITY;
                for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
                    let count = powers.fewest(tolerance).unwrap_or_else(|| panic!("{order} {tolerance}"));
                    let power = powers.get(count).unwrap().clone();
                    assert!(
                        power.error <= tolerance && power.error < before && count <= 30,
                        "{order} {tolerance}: {power:?}"
                    );
                    before = power.error;
                    for k in 0..=1000 {
                        let s = Complex64::new(0.0, 0.6 * 1050f64.powf(f64::from(k) / 1000.0));
                        let off = (power.at(s) / s.powf(order) - 1.0).norm();
                        assert!(off <= 1.02 * power.error, "{order} {tolerance} at {s}: {off}");
                    }
                }
            }
        }
    }
}
