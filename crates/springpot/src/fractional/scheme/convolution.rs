//! Causal convolution of two sequences.

use realfft::{FftError, RealFftPlanner, RealToComplex};
use std::cell::RefCell;
use std::sync::Arc;

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

/// The inverse transform is a forward one too, by Hartley's: with Y the spectrum of y of size M and h_k = Re Y_k − Im
/// Y_k, y_n = (Re H_n − Im H_n)/M. So there is one plan, and planning takes as long as all transforms.
fn fft_convolution(weights: &[f64], x: &[f64]) -> Result<Vec<f64>, FftError> {
    // So long that the circular convolution's wrap-around falls on zeros.
    let size = (x.len() + weights.len()).next_power_of_two();
    let transform = plan(size);
    let mut real = transform.make_input_vec();
    let mut scratch = transform.make_scratch_vec();
    let mut product = transform.make_output_vec();
    real[..x.len()].copy_from_slice(x);
    transform.process_with_scratch(&mut real, &mut product, &mut scratch)?;

    let mut spectrum = transform.make_output_vec();
    real.fill(0.0);
    real[..weights.len()].copy_from_slice(weights);
    transform.process_with_scratch(&mut real, &mut spectrum, &mut scratch)?;

    for (k, (a, b)) in product.iter().zip(&spectrum).enumerate() {
        let y = a * b;
        // Y_{M−k} is the conjugate; at k = 0 and M/2 it is Y_k, which is real.
        real[(size - k) % size] = y.re + y.im;
        real[k] = y.re - y.im;
    }
    transform.process_with_scratch(&mut real, &mut spectrum, &mut scratch)?;
    let scale = 1.0 / size as f64;
    let value = |n: usize| match spectrum.get(n) {
        Some(h) => h.re - h.im,
        None => spectrum[size - n].re + spectrum[size - n].im,
    };
    Ok((0..x.len()).map(|n| value(n) * scale).collect())
}

/// Longest transform whose plan is kept, some 4 MB of it per thread.
const KEPT_SIZE: usize = 1 << 18;

/// The transform of this size. The last one of a thread is kept: columns of one file have one length.
fn plan(size: usize) -> Arc<dyn RealToComplex<f64>> {
    thread_local! {
        static LAST: RefCell<Option<Arc<dyn RealToComplex<f64>>>> = const { RefCell::new(None) };
    }
    LAST.with_borrow_mut(|last| {
        if let Some(plan) = last.as_ref().filter(|plan| plan.len() == size) {
            return Arc::clone(plan);
        }
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(size);
        if size <= KEPT_SIZE {
            *last = Some(Arc::clone(&plan));
        }
        plan
    })
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
