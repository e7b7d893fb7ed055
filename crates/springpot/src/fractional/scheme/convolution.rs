//! Causal convolution of two sequences.

use realfft::{FftError, RealFftPlanner, RealToComplex};
use std::cell::RefCell;
use std::sync::Arc;

/// Up to this length of the weights the direct sum is quicker than transforms.
const DIRECT_LENGTH: usize = 64;

/// y_n = Σ_{k=0}^n w_{n−k} x_k for n = 0 … len(x) − 1, by zero-padded FFT in O(N log N).
///
/// Weights beyond the last one given are 0. The rounding error of row n is a few ulp of ‖w‖₂‖x‖₂ of the first 2n rows, at
/// most 64 times as large: a start that is much smaller than the rest has a transform of its own.
pub fn causal_convolution(weights: &[f64], x: &[f64]) -> Vec<f64> {
    sum_of_convolutions(&[(weights, x)], x.len())
}

/// The sum of causal convolutions of weights and data, row 0 to `rows` − 1, with one transform back for all.
pub(in crate::fractional) fn sum_of_convolutions(pairs: &[(&[f64], &[f64])], rows: usize) -> Vec<f64> {
    let pairs: Vec<(&[f64], &[f64])> =
        pairs.iter().map(|(weights, x)| (&weights[..weights.len().min(rows)], &x[..x.len().min(rows)])).collect();
    let direct = || {
        let row = |n: usize| pairs.iter().map(|(weights, x)| direct_row(weights, x, n)).sum();
        (0..rows).map(row).collect()
    };
    if pairs.iter().all(|(weights, _)| weights.len() <= DIRECT_LENGTH) {
        return direct();
    }
    // The transform refuses nothing but buffers of a wrong length, and these are its own.
    let mut y = fft_convolution(&pairs, rows).unwrap_or_else(|_| direct());
    if let Some(start) = quiet_start(&pairs, rows) {
        y[..start].copy_from_slice(&sum_of_convolutions(&pairs, start));
    }
    y
}

/// Where ‖w‖₂‖x‖₂ of a start falls below that of all rows by this, the rounding of the rest would drown it.
const QUIET: f64 = 64.0;

/// The longest start, a half, a quarter, … of the rows, that is so quiet; each costs half of the one before at most.
fn quiet_start(pairs: &[(&[f64], &[f64])], rows: usize) -> Option<usize> {
    let norm = |values: &[f64], count: usize| -> f64 { values.iter().take(count).map(|v| v * v).sum() };
    let size = |count: usize| -> f64 { pairs.iter().map(|(w, x)| (norm(w, count) * norm(x, count)).sqrt()).sum() };
    let all = size(rows) / QUIET;
    (1..usize::BITS).map(|k| rows >> k).take_while(|start| *start > 0).find(|start| size(*start) < all)
}

/// The same sum term by term, in O(N²).
pub fn direct_convolution(weights: &[f64], x: &[f64]) -> Vec<f64> {
    (0..x.len()).map(|n| direct_row(weights, x, n)).collect()
}

/// Σ_k w_k x_{n−k}; x beyond its last value is 0.
fn direct_row(weights: &[f64], x: &[f64], n: usize) -> f64 {
    let known = x.len().min(n + 1);
    let beyond = weights.get(n + 1 - known..).unwrap_or_default();
    x[..known].iter().rev().zip(beyond).map(|(x, w)| w * x).sum()
}

/// The inverse transform is a forward one too, by Hartley's: with Y the spectrum of y of size M and h_k = Re Y_k − Im
/// Y_k, y_n = (Re H_n − Im H_n)/M. So there is one plan, and planning takes as long as all transforms.
fn fft_convolution(pairs: &[(&[f64], &[f64])], rows: usize) -> Result<Vec<f64>, FftError> {
    // So long that the circular convolution's wrap-around falls on zeros.
    let longest = pairs.iter().map(|(weights, x)| weights.len() + x.len()).max().unwrap_or(2);
    let size = transform_length(longest.max(rows));
    let transform = plan(size);
    let mut real = transform.make_input_vec();
    let mut scratch = transform.make_scratch_vec();
    let (mut data, mut spectrum) = (transform.make_output_vec(), transform.make_output_vec());
    let mut total = transform.make_output_vec();
    for (weights, x) in pairs {
        for (values, spectrum) in [(x, &mut data), (weights, &mut spectrum)] {
            real.fill(0.0);
            real[..values.len()].copy_from_slice(values);
            transform.process_with_scratch(&mut real, spectrum, &mut scratch)?;
        }
        for ((sum, a), b) in total.iter_mut().zip(&data).zip(&spectrum) {
            *sum += a * b;
        }
    }

    for (k, y) in total.iter().enumerate() {
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
    Ok((0..rows).map(|n| value(n) * scale).collect())
}

/// The least 2^k, 3·2^k or 5·2^k that is not below `least`.
fn transform_length(least: usize) -> usize {
    let power = |factor: usize| factor * least.div_ceil(factor).next_power_of_two();
    power(2).min(power(6)).min(power(10))
}

/// Longest transform whose plan is kept, some 4 MB of it per thread.
const KEPT_SIZE: usize = 1 << 18;

/// Plans kept by a thread: columns of one file have one length, and quiet starts a few others.
const KEPT_PLANS: usize = 6;

/// The transform of this size; the last few of a thread are kept.
fn plan(size: usize) -> Arc<dyn RealToComplex<f64>> {
    thread_local! {
        static KEPT: RefCell<Vec<Arc<dyn RealToComplex<f64>>>> = const { RefCell::new(Vec::new()) };
    }
    KEPT.with_borrow_mut(|kept| {
        if let Some(plan) = kept.iter().find(|plan| plan.len() == size) {
            return Arc::clone(plan);
        }
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(size);
        if size <= KEPT_SIZE {
            if kept.len() == KEPT_PLANS {
                kept.remove(0);
            }
            kept.push(Arc::clone(&plan));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_never_too_short() {
        for least in [2, 128, 129, 200_000, 1_000_001] {
            let size = transform_length(least);
            assert!(size >= least && size.is_multiple_of(2) && size < 2 * least, "{least}: {size}");
        }
    }
}
