//! Numbers that a step integrates, by their slopes at its stages.

use super::tableau::{ALL_STAGES, LAST_TERMS, STAGES, TERMS, Weights};
use crate::account::works::polynomial;

/// Numbers y with slopes y' at the stages: y_i = y_0 + h Σ a_ij y'_j, and the polynomial of order 7 between the ends.
#[derive(Debug)]
pub(super) struct Integrated {
    pub(super) slopes: [Vec<f64>; ALL_STAGES],
    /// Of the polynomial between the ends, where `is_dense`.
    terms: [Vec<f64>; TERMS],
    is_dense: bool,
    /// What the step changes, and what leads to the stage under way.
    pub(super) change: Vec<f64>,
    pub(super) sum: Vec<f64>,
}

impl Integrated {
    /// Of `n` numbers.
    pub(super) fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            slopes: std::array::from_fn(|_| zeros()),
            terms: std::array::from_fn(|_| zeros()),
            is_dense: false,
            change: zeros(),
            sum: zeros(),
        }
    }

    /// Of `n` numbers from now on.
    pub(super) fn resize(&mut self, n: usize) {
        let Self { slopes, terms, change, sum, .. } = self;
        slopes.iter_mut().chain(terms).chain([change, sum]).for_each(|numbers| numbers.resize(n, 0.0));
    }

    /// Begins a step, where nothing leads to its first stage.
    pub(super) fn begin(&mut self) {
        self.is_dense = false;
        self.sum.fill(0.0);
    }

    /// h Σ w_j y'_j leads to the stage under way.
    pub(super) fn lead(&mut self, weights: Weights, h: f64) {
        combine(&self.slopes, weights, h, &mut self.sum);
    }

    /// What leads to the stage under way is what the step changes.
    pub(super) fn end(&mut self) {
        self.change.copy_from_slice(&self.sum);
    }

    /// Σ w_j y'_j of the step.
    pub(super) fn sum_of(&self, weights: Weights, sum: &mut Vec<f64>) {
        sum.resize(self.change.len(), 0.0);
        combine(&self.slopes, weights, 1.0, sum);
    }

    /// Whether the polynomial is that of the step.
    pub(super) fn is_dense(&self) -> bool {
        self.is_dense
    }

    /// Works out the polynomial between the ends of the step, of size `h`, whose last stages are there.
    pub(super) fn fill_between(&mut self, h: f64) {
        self.is_dense = true;
        let Self { slopes, terms, change, .. } = self;
        let [way, first, second, last @ ..] = terms;
        for (at, change) in change.iter().enumerate() {
            let [start, end] = [slopes[0][at], slopes[STAGES][at]];
            way[at] = *change;
            first[at] = h * start - change;
            second[at] = 2.0 * change - h * (end + start);
        }
        last.iter_mut().zip(LAST_TERMS).for_each(|(term, weights)| combine(slopes, weights, h, term));
    }

    /// The terms of the polynomial, where it is that of the step.
    pub(super) fn terms(&self) -> Option<[&[f64]; TERMS]> {
        self.is_dense.then(|| self.terms.each_ref().map(Vec::as_slice))
    }

    /// Number `at` from the start of the step to θ, and its derivative by θ; the polynomial is there.
    pub(super) fn between(&self, at: usize, theta: f64) -> [f64; 2] {
        polynomial(std::array::from_fn(|term| self.terms[term][at]), theta)
    }
}

/// sum ← h Σ w_j of the slopes.
fn combine(slopes: &[Vec<f64>; ALL_STAGES], weights: Weights, h: f64, sum: &mut [f64]) {
    sum.fill(0.0);
    for &(j, weight) in weights {
        sum.iter_mut().zip(&slopes[j]).for_each(|(sum, slope)| *sum += weight * slope);
    }
    sum.iter_mut().for_each(|sum| *sum *= h);
}
