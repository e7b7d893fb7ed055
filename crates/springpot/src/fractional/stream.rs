//! D^alpha of uniform samples as they come: constant time and memory per sample.

use super::kernel::{Kernel, KernelError};
use super::step::{exponential_moments, local_factors};

/// Caputo derivative of order 0 < alpha < 1 of samples that come with their rates, spaced by h.
///
/// Cubic Hermite interpolation against the exact kernel on the newest interval, exponentials for the past: order 4 − alpha.
/// Riemann–Liouville adds x(0) t^−alpha/Γ(1−alpha).
#[derive(Debug, Clone)]
pub struct Stream {
    local: [f64; 3],
    /// Structure of arrays, padded to whole blocks with modes of weight 0.
    decay: Vec<Block>,
    weighted_decay: Vec<Block>,
    moments: [Vec<Block>; 3],
    z: Vec<Block>,
    inverse_step: f64,
    last: Option<(f64, f64)>,
}

const LANES: usize = 8;
type Block = [f64; LANES];

impl Stream {
    /// A stream of at most `count` samples; `tolerance` bounds the relative error of the kernel.
    ///
    /// # Errors
    /// [`KernelError`] where no kernel can be built.
    pub fn new(alpha: f64, h: f64, count: usize, tolerance: f64) -> Result<Self, KernelError> {
        let kernel = Kernel::new(alpha, tolerance, h, h * count.max(2) as f64)?;
        let factors = local_factors(alpha);
        let scale = h.powf(1.0 - alpha);
        // The Hermite polynomial of x': v0 + (6D − 4v0 − 2v1)θ + (3v0 + 3v1 − 6D)θ², sorted by v0, v1, D.
        let by_data = |f: [f64; 3]| [f[0] - 4.0 * f[1] + 3.0 * f[2], 3.0 * f[2] - 2.0 * f[1], 6.0 * (f[1] - f[2])];
        let local = by_data([scale * factors[0], scale * factors[1], scale * factors[2]]);
        let moments: Vec<[f64; 3]> = kernel
            .lambda
            .iter()
            .map(|l| {
                let psi = exponential_moments(l * h);
                by_data([h * psi[0], h * psi[1], h * psi[2]])
            })
            .collect();
        let decay: Vec<f64> = kernel.lambda.iter().map(|l| (-l * h).exp()).collect();
        let weighted: Vec<f64> = decay.iter().zip(&kernel.weight).map(|(e, w)| e * w).collect();
        let blocks = kernel.modes().div_ceil(LANES);
        Ok(Self {
            local,
            decay: padded(decay.iter().copied()),
            weighted_decay: padded(weighted.iter().copied()),
            moments: std::array::from_fn(|k| padded(moments.iter().map(|m| m[k]))),
            z: vec![[0.0; LANES]; blocks],
            inverse_step: 1.0 / h,
            last: None,
        })
    }

    /// Takes x and x' of the next sample and returns D^alpha x there (0 at the first).
    pub fn push(&mut self, x: f64, rate: f64) -> f64 {
        let Some((x0, v0)) = self.last.replace((x, rate)) else { return 0.0 };
        let slope = (x - x0) * self.inverse_step;
        let mut sums = [0.0; LANES];
        for b in 0..self.z.len() {
            let (z, decay, weighted) = (&mut self.z[b], &self.decay[b], &self.weighted_decay[b]);
            let [m0, m1, m2] = [&self.moments[0][b], &self.moments[1][b], &self.moments[2][b]];
            for l in 0..LANES {
                sums[l] += weighted[l] * z[l];
                z[l] = decay[l] * z[l] + (m0[l] * v0 + m1[l] * rate + m2[l] * slope);
            }
        }
        let history: f64 = sums.iter().sum();
        history + self.local[0] * v0 + self.local[1] * rate + self.local[2] * slope
    }
}

/// Caputo derivative of uniform samples spaced by h, rates taken from five samples (order 4, one-sided at the ends).
///
/// Errs by O(h^{4−alpha}) plus `tolerance`, relative to the largest value of a smooth signal.
///
/// # Errors
/// [`KernelError`] where no kernel can be built.
///
/// # Panics
/// With fewer than five samples.
pub fn derivative_of_samples(x: &[f64], h: f64, alpha: f64, tolerance: f64) -> Result<Vec<f64>, KernelError> {
    assert!(x.len() >= 5, "five samples are needed to difference the rates");
    let mut stream = Stream::new(alpha, h, x.len(), tolerance)?;
    Ok((0..x.len()).map(|n| stream.push(x[n], rate_from_samples(x, n, h))).collect())
}

/// x' at sample n by the five-point formulas of order 4.
fn rate_from_samples(x: &[f64], n: usize, h: f64) -> f64 {
    const CENTRAL: [f64; 5] = [1.0, -8.0, 0.0, 8.0, -1.0];
    const FIRST: [f64; 5] = [-25.0, 48.0, -36.0, 16.0, -3.0];
    const SECOND: [f64; 5] = [-3.0, -10.0, 18.0, -6.0, 1.0];
    let last = x.len() - 1;
    let sum = |start: usize, weights: [f64; 5]| -> f64 { (0..5).map(|k| weights[k] * x[start + k]).sum() };
    let mirrored = |weights: [f64; 5]| -> f64 { -(0..5).map(|k| weights[k] * x[last - k]).sum::<f64>() };
    let difference = match (n, last - n) {
        (0, _) => sum(0, FIRST),
        (1, _) => sum(0, SECOND),
        (_, 0) => mirrored(FIRST),
        (_, 1) => mirrored(SECOND),
        _ => sum(n - 2, CENTRAL),
    };
    difference / (12.0 * h)
}

fn padded(values: impl Iterator<Item = f64>) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    for (k, value) in values.enumerate() {
        if k % LANES == 0 {
            blocks.push([0.0; LANES]);
        }
        blocks[k / LANES][k % LANES] = value;
    }
    blocks
}
