//! Equal steps: D^a of a Hermite spline with exact moments of the kernel, as one convolution of each kind of data.
//!
//! Row n is the sum over the pieces j < n of 1/Γ(b) ∫₀¹ (k+1−θ)^{b−1} y_j(θ) dθ, k = n−1−j, in units of h^b, where y_j
//! is a sum of shapes times Δ_j, h v_j, h v_{j+1}, … (see [`super::hermite`]).

use super::hermite::{Form, Polynomial, Shapes};
use super::order::Order;
use crate::fractional::gamma::reciprocal_gamma;
use crate::fractional::scheme::sum_of_convolutions;

/// Samples of one kind of data: its value at the left and the right end of a piece has these shapes.
struct Channel<'a> {
    data: &'a [f64],
    left: Polynomial,
    right: Polynomial,
}

/// x with h x' and h² x'' at every sample, spaced by h.
pub(super) struct Grid<'a> {
    pub(super) step: f64,
    pub(super) x: &'a [f64],
    pub(super) slope: &'a [f64],
    pub(super) bend: &'a [f64],
}

/// I^beta x⁽ᵐ⁾ at every sample for an order that is not an integer; 0 in row 0.
pub(super) fn differintegral(form: Form, order: &Order, grid: &Grid) -> Vec<f64> {
    let whole = order.whole.max(0);
    let exponent = f64::from(whole) - order.order;
    let Shapes { step, slope, bend } = form.shapes();
    let derived = |shape: Polynomial| (0..whole).fold(shape, |shape, _| derivative(shape));
    let differences: Vec<f64>;
    let first = if whole == 0 {
        let mut left = step.map(|c| -c);
        left[0] += 1.0;
        Channel { data: grid.x, left, right: step }
    } else {
        differences = grid.x.windows(2).map(|x| x[1] - x[0]).collect();
        Channel { data: &differences, left: derived(step), right: [0.0; 6] }
    };
    let mut channels = vec![first, Channel { data: grid.slope, left: derived(slope[0]), right: derived(slope[1]) }];
    if form == Form::Quintic {
        channels.push(Channel { data: grid.bend, left: derived(bend[0]), right: derived(bend[1]) });
    }
    let weights = weights(exponent, &channels, grid.x.len());
    let mut y = convolved(&channels, &weights, grid.x.len());
    let scale = grid.step.powf(-order.order);
    for y in &mut y {
        *y *= scale;
    }
    y[0] = 0.0;
    y
}

/// d/dθ.
fn derivative(shape: Polynomial) -> Polynomial {
    std::array::from_fn(|p| if p < 5 { (p + 1) as f64 * shape[p + 1] } else { 0.0 })
}

/// Moments of the left and the right shape of a channel at k = 0 … rows − 1.
type Columns = [Vec<f64>; 2];

/// All moments of all channels.
fn weights(exponent: f64, channels: &[Channel], rows: usize) -> Vec<Columns> {
    let rule = GaussLegendre::new();
    let inverses: Vec<f64> = (0..rows).map(|k| 1.0 / (k as f64 + 0.5)).collect();
    let powers: Vec<f64> = (0..rows).map(|k| (k as f64 + 0.5).powf(exponent - 1.0)).collect();
    let column = |shape: Polynomial| -> Vec<f64> {
        if shape == [0.0; 6] {
            return vec![0.0; rows];
        }
        let moment = Moment::new(exponent, shape);
        let mut column = Vec::with_capacity(rows);
        column.push(moment.at_zero);
        column.extend((1..rows.min(SERIES_FROM)).map(|k| rule.integral(exponent, &moment, k as f64 + 0.5)));
        let far = powers.iter().zip(&inverses).skip(column.len()).map(|(power, inverse)| (*power, *inverse));
        let near = 256 - SERIES_FROM;
        column.extend(far.clone().take(near).map(|(power, inverse)| power * moment.series::<TERMS>(inverse)));
        column.extend(far.clone().skip(near).take(FAR).map(|(power, inverse)| power * moment.series::<7>(inverse)));
        column.extend(far.skip(near + FAR).map(|(power, inverse)| power * moment.series::<4>(inverse)));
        column
    };
    channels.iter().map(|channel| [column(channel.left), column(channel.right)]).collect()
}

/// Rows between k = 256 and k = 65 536.
const FAR: usize = 65_536 - 256;

/// From this k on the kernel is a binomial series about the middle of the piece.
const SERIES_FROM: usize = 16;
/// Terms of the series: (2k+1)^−TERMS is below one ulp at k = 16.
const TERMS: usize = 13;

/// 1/Γ(b) ∫₀¹ (k+1−θ)^{b−1} s(θ) dθ of one shape s for all k.
struct Moment {
    at_zero: f64,
    /// s/Γ(b) in powers of u = θ − ½.
    centred: Polynomial,
    /// Coefficients of (k+½)^{b−1−i}.
    series: [f64; TERMS],
}

impl Moment {
    fn new(exponent: f64, shape: Polynomial) -> Self {
        let inverse = reciprocal_gamma(exponent);
        // k = 0: Σ s_p p!/Γ(p+1+b).
        let mut factor = reciprocal_gamma(1.0 + exponent);
        let mut at_zero = 0.0;
        for (p, s) in shape.iter().enumerate() {
            if p > 0 {
                factor *= p as f64 / (p as f64 + exponent);
            }
            at_zero += factor * s;
        }
        // Horner's rule at ½ + u.
        let mut centred = [0.0; 6];
        for s in shape.iter().rev() {
            for q in (1..6).rev() {
                centred[q] = 0.5 * centred[q] + centred[q - 1];
            }
            centred[0] = 0.5 * centred[0] + s * inverse;
        }
        let mut binomial = 1.0;
        let series = std::array::from_fn(|i| {
            if i > 0 {
                binomial *= (i as f64 - exponent) / i as f64;
            }
            let integral =
                |q: usize| if (i + q) % 2 == 1 { 0.0 } else { 0.5f64.powi((i + q) as i32) / (i + q + 1) as f64 };
            binomial * (0..6).map(|q| centred[q] * integral(q)).sum::<f64>()
        });
        Self { at_zero, centred, series }
    }

    fn shape_at(&self, u: f64) -> f64 {
        self.centred.iter().rev().fold(0.0, |sum, c| sum * u + c)
    }

    /// The first `N` terms: 13 from k = 16 on, 7 from 256, 4 from 65 536.
    fn series<const N: usize>(&self, inverse: f64) -> f64 {
        (0..N).rev().fold(0.0, |sum, i| sum * inverse + self.series[i])
    }
}

/// Points of the Gauss–Legendre rule; for k ≥ 1 it errs by less than one ulp.
const POINTS: usize = 16;

/// The rule on |u| ≤ ½.
struct GaussLegendre {
    nodes: [f64; POINTS],
    weights: [f64; POINTS],
}

impl GaussLegendre {
    fn new() -> Self {
        let mut rule = Self { nodes: [0.0; POINTS], weights: [0.0; POINTS] };
        let n = POINTS as f64;
        for i in 0..POINTS {
            // Newton's method from Tricomi's guess.
            let mut z = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            for _ in 0..8 {
                let (p, slope) = legendre(z);
                z -= p / slope;
            }
            let slope = legendre(z).1;
            rule.nodes[i] = 0.5 * z;
            rule.weights[i] = 1.0 / ((1.0 - z * z) * slope * slope);
        }
        rule
    }

    /// 1/Γ(b) ∫ (middle − u)^{b−1} s(u) du.
    fn integral(&self, exponent: f64, moment: &Moment, middle: f64) -> f64 {
        let term = |(u, weight): (&f64, &f64)| weight * (middle - u).powf(exponent - 1.0) * moment.shape_at(*u);
        self.nodes.iter().zip(&self.weights).map(term).sum()
    }
}

/// P_n and P_n' at z, n = [`POINTS`].
fn legendre(z: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, z);
    for k in 2..=POINTS {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * z * p - (k - 1.0) * before) / k);
    }
    (p, POINTS as f64 * (z * p - before) / (z * z - 1.0))
}

/// Σ over the channels of Σ_{i≤n} C_{n−i} u_i − R_n u_0 with C_i = R_i + L_{i−1}.
fn convolved(channels: &[Channel], weights: &[Columns], rows: usize) -> Vec<f64> {
    let kernel = |[left, right]: &Columns| -> Vec<f64> {
        (0..rows).map(|i| right[i] + if i > 0 { left[i - 1] } else { 0.0 }).collect()
    };
    let kernels: Vec<Vec<f64>> = weights.iter().map(kernel).collect();
    let pairs: Vec<(&[f64], &[f64])> =
        kernels.iter().zip(channels).map(|(kernel, channel)| (&kernel[..], channel.data)).collect();
    let mut y = sum_of_convolutions(&pairs, rows);
    for (channel, [_, right]) in channels.iter().zip(weights) {
        for (y, weight) in y.iter_mut().zip(right) {
            *y -= weight * channel.data[0];
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_agree_where_their_forms_meet() {
        let rule = GaussLegendre::new();
        for exponent in [0.01, 0.5, 0.99, 1.0, 1.3, 2.0] {
            for power in 0..6 {
                let mut shape = [0.0; 6];
                shape[power] = 1.0;
                let moment = Moment::new(exponent, shape);
                for k in [16, 40, 255, 256, 3000, 65_535, 65_536, 1_000_000] {
                    let middle = k as f64 + 0.5;
                    let series = match k {
                        ..256 => moment.series::<TERMS>(1.0 / middle),
                        256..65_536 => moment.series::<7>(1.0 / middle),
                        _ => moment.series::<4>(1.0 / middle),
                    };
                    let gauss = rule.integral(exponent, &moment, middle);
                    let ratio = middle.powf(exponent - 1.0) * series / gauss;
                    assert!((ratio - 1.0).abs() < 1e-14, "b {exponent}, θ^{power}, k {k}");
                }
            }
        }
    }
}
