//! Causal convolution of two sequences.

use realfft::{FftError, RealFftPlanner};

/// Below this length the direct sum is quicker than three transforms.
const DIRECT_LENGTH: usize = 64;

/// y_n = Σ_{k=0}^n w_{n−k} x_k for n = 0 … len(x) − 1, by zero-padded FFT in O(N log N).
///
/// Weights beyond the last one given are 0. The rounding error is a few ulp of ‖w‖₂‖x‖₂, the same for every n.
pub fn causal_convolution(weights: &[f64], x: &[f64]) -> Vec<f64> {
    let weights = &weights[..weights.len().min(x.len())];
    if weights.len() <= DIRECT_LENGTH {
        return direct_convolution(weights, x);
    }
    // The transform refuses nothing but buffers of a wrong length, and these are its own.
    fft_convolution(weights, x).unwrap_or_else(|_| direct_convolution(weights, x))
}

/// The same sum term by term, in O(N²).
pub fn direct_convolution(weights: &[f64], x: &[f64]) -> Vec<f64> {
    (0..x.len()).map(|n| x[..=n].iter().rev().zip(weights).map(|(x, w)| w * x).sum()).collect()
}

fn fft_convolution(weights: &[f64], x: &[f64]) -> Result<Vec<f64>, FftError> {
    // So long that the circular convolution's wrap-around falls on zeros.
    let size = (x.len() + weights.len()).next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let forward = planner.plan_fft_forward(size);
    let inverse = planner.plan_fft_inverse(size);

    let mut real = forward.make_input_vec();
    let mut scratch = forward.make_scratch_vec();
    let mut product = forward.make_output_vec();
    real[..x.len()].copy_from_slice(x);
    forward.process_with_scratch(&mut real, &mut product, &mut scratch)?;

    let mut spectrum = forward.make_output_vec();
    real.fill(0.0);
    real[..weights.len()].copy_from_slice(weights);
    forward.process_with_scratch(&mut real, &mut spectrum, &mut scratch)?;

    for (a, b) in product.iter_mut().zip(&spectrum) {
        *a *= *b;
    }
    inverse.process(&mut product, &mut real)?;
    real.truncate(x.len());
    let scale = 1.0 / size as f64;
    for y in &mut real {
        *y *= scale;
    }
    Ok(real)
}

/// x_n − x_{n−1} with x_{−1} = `before`.
pub(super) fn differences(x: &[f64], before: f64) -> Vec<f64> {
    let previous = std::iter::once(&before).chain(x);
    x.iter().zip(previous).map(|(x, p)| x - p).collect()
}

/// What the weights of order `alpha` act on: the differences of x for derivatives, x − x(0) for integrals.
///
/// So neither small differences of large numbers nor long sums of small ones are formed.
pub(super) fn from_start(x: &[f64], alpha: f64) -> Vec<f64> {
    if alpha > 0.0 { differences(x, x[0]) } else { x.iter().map(|value| value - x[0]).collect() }
}
