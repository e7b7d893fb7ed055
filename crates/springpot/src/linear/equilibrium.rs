//! Where a robot comes to rest.

use super::error::LinearError;
use super::statics::Statics;
use crate::linalg::Lu;
use crate::system::System;

/// Steps after which there is no equilibrium.
const MOST_STEPS: usize = 3000;
/// The longest step, m or rad.
const LONGEST: f64 = 0.2;
/// What may be left over, in units of the terms of the balance.
const ENOUGH: f64 = 1e-13;
/// What is left over where rounding ends the steps.
const ROUNDING: f64 = 1e-9;

/// A configuration in which the robot stays at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Coordinates, nq values.
    pub q: Vec<f64>,
    /// Steps that led there.
    pub steps: usize,
    /// The largest torque that is left over, in units of the terms of its balance.
    pub residual: f64,
}

impl System {
    /// The static equilibrium that the robot sinks into from `start` (nq): gravity, elements as they are after endless rest, and the torques
    /// and inputs of time `t`; joints that signals or locks hold stay at `start`.
    ///
    /// Implicit steps of M q' = −(g(q) − ΣQ − τ), as if it moved through honey, longer as less is left over: at last Newton's (C. T. Kelley,
    /// D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508). Their matrices are positive definite, so that no upright pendulum is
    /// found unless `start` is one. Feedback and controllers that act at every time are in it ([`System::linearised`]): a joint whose error is
    /// integrated is where its reference is.
    ///
    /// # Errors
    /// [`LinearError`].
    pub fn equilibrium(&self, start: &[f64], t: f64) -> Result<Equilibrium, LinearError> {
        let (moved, held) = (self.moved_by_forces(), self.strokes_at_start());
        let mut q = start.to_vec();
        let mut statics = self.at_rest(&q, t, &held)?;
        if statics.torques.is_none() {
            return Err(LinearError::Given);
        }
        // What integrals hold is where they want it.
        for (k, wanted) in statics.control.held.iter().enumerate() {
            if let (Some(place), Some(wanted)) = (self.model.coordinate_of(k), wanted) {
                q[place] = *wanted;
            }
        }
        let free: Vec<usize> = moved.into_iter().filter(|&k| statics.control.held[k].is_none()).collect();
        statics = self.at_rest(&q, t, &held)?;
        // Terms that vanish where it rests are measured by what they were on the way.
        let mut sizes = vec![0.0f64; free.len()];
        let mut left_over = |statics: &Statics| -> (Vec<f64>, f64) {
            let each = free.iter().map(|&k| statics.missing(k)).collect::<Vec<_>>();
            for (size, &k) in sizes.iter_mut().zip(&free) {
                *size = size.max(statics.size(k));
            }
            let floor = 1e-3 * sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
            let share = |(residual, size): (&f64, &f64)| match *residual {
                0.0 => 0.0,
                residual => residual.abs() / size.max(floor),
            };
            let largest = each.iter().zip(&sizes).map(share).fold(0.0, f64::max);
            (each, largest)
        };
        let (mut residual, mut share) = left_over(&statics);
        let mut patience = f64::INFINITY;
        let (mut best, mut settled) = ((f64::INFINITY, q.clone()), 0);
        for steps in 0..MOST_STEPS {
            if share < 0.5 * best.0 {
                settled = 0;
            }
            if share < best.0 {
                best = (share, q.clone());
            }
            settled += 1;
            if share <= ENOUGH || (best.0 <= ROUNDING && settled > 8) {
                let (residual, q) = best;
                return Ok(Equilibrium { q, steps, residual });
            }
            let Some((step, taken)) = self.step(&statics, &free, &residual, patience) else { break };
            let longest = step.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let factor = (LONGEST / longest).min(1.0);
            let mut whole = vec![0.0; self.model.nv()];
            free.iter().zip(&step).for_each(|(&k, step)| whole[k] = factor * step);
            q = self.model.integrate(&q, &whole);
            statics = self.at_rest(&q, t, &held)?;
            let before = norm(&residual);
            (residual, share) = left_over(&statics);
            patience = taken * (before / norm(&residual)).clamp(0.1, 10.0);
        }
        let worst = residual.iter().zip(&free).max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
        let (torque, k) = worst.map_or((0.0, 0), |(torque, &k)| (*torque, k));
        let label = &self.model.v_labels()[k];
        let unit = label.dimension.units().force;
        Err(LinearError::NothingHolds { joint: label.name.clone(), torque: torque.abs(), unit })
    }

    /// −(M/h + K)⁻¹ residual over the free velocities with the largest h up to `patience` at which the matrix is positive definite, and h.
    fn step(&self, statics: &Statics, free: &[usize], residual: &[f64], patience: f64) -> Option<(Vec<f64>, f64)> {
        let (n, count) = (self.model.nv(), free.len());
        let mut stiffness = vec![0.0; count * count];
        let mut mass = stiffness.clone();
        let whole = statics.stiffness(self);
        for (r, &row) in free.iter().enumerate() {
            for (c, &column) in free.iter().enumerate() {
                stiffness[r * count + c] = whole[row * n + column];
                mass[r * count + c] = statics.slopes.d_a[row * n + column];
            }
        }
        let trace = |m: &[f64]| (0..count).map(|k| m[k * (count + 1)].abs()).sum::<f64>();
        // From the first on no step is longer than what the stiffness answers.
        let natural = trace(&mass) / norm(&stiffness).max(f64::MIN_POSITIVE);
        let mut h = if patience.is_finite() { patience } else { 0.1 * natural };
        let mut lu = Lu::default();
        for _ in 0..80 {
            let matrix: Vec<f64> = mass.iter().zip(&stiffness).map(|(m, k)| m / h + k).collect();
            if is_positive_definite(&matrix, count) && lu.factor(count, |entries| entries.copy_from_slice(&matrix)) {
                let mut step: Vec<f64> = residual.iter().map(|r| -r).collect();
                lu.solve(&mut step);
                if step.iter().all(|x| x.is_finite()) {
                    return Some((step, h));
                }
            }
            h *= 0.25;
        }
        None
    }
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Whether xᵀ m x > 0 for all x ≠ 0: the pivots of the symmetric part are positive.
fn is_positive_definite(m: &[f64], n: usize) -> bool {
    let mut a: Vec<f64> = (0..n * n).map(|k| 0.5 * (m[k] + m[k % n * n + k / n])).collect();
    for k in 0..n {
        let pivot = a[k * (n + 1)];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / pivot;
            (k..n).for_each(|j| a[i * n + j] -= factor * a[k * n + j]);
        }
    }
    true
}
