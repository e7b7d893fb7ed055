//! The embedded error estimate of a step.

use super::step::RadauStep;
use crate::collocation::radau::{ESTIMATE, GAMMA, LEFT, RIGHT};
use crate::collocation::{MAX_NODES, STAGES};
use crate::equations::Equations;

impl RadauStep {
    /// Accelerations without what a singular start adds: a_i − s σ_i with s σ = −M⁻¹ Σ g F_singular.
    pub(super) fn collect_regular(&mut self, equations: &Equations) {
        let regular = &mut self.fitted.regular;
        regular[0].copy_from_slice(&self.origin.a);
        for (i, stage) in self.stages.iter().enumerate() {
            regular[i + 1].copy_from_slice(&stage.a);
            if equations.is_singular() {
                equations.take_off_singular(i + 1, &mut regular[i + 1]);
            }
        }
    }

    /// The estimate, filtered by the linearised equations of motion: rms in units of the tolerance, and the velocity with the
    /// largest share of it.
    pub(super) fn estimate(&mut self, equations: &Equations, h: f64) -> (f64, usize) {
        let (n, free, slopes) = (self.model.nv(), equations.free(), equations.slopes());
        let count = free.len();
        if count == 0 {
            return (0.0, 0);
        }
        let step = h * GAMMA;
        let (stages, regular, is_one_degree) = (&self.stages, &self.fitted.regular, self.model.is_one_degree());
        let scratch = &mut self.scratch;
        scratch.velocities.clear();
        scratch.positions.clear();
        for &k in free {
            scratch.velocities.push(raw(h, regular[0][k], [1, 2, 3].map(|i| regular[i][k])));
            let rates = stages.each_ref().map(|stage| if is_one_degree { stage.v[k] } else { stage.xi_rate[k] });
            scratch.positions.push(raw(h, self.origin.v[k], rates));
        }
        // K with the elements' stiffness as the scheme sees it: lᵀ G r + lᵀ P r/(h γ_0).
        scratch.stiffness.clear();
        scratch.stiffness.extend((0..count * count).map(|k| slopes.d_q[free[k / count] * n + free[k % count]]));
        let along = |m: &[[f64; MAX_NODES]; MAX_NODES]| -> f64 {
            (0..3).map(|i| LEFT[i] * (0..3).map(|j| m[i][j] * RIGHT[j]).sum::<f64>()).sum()
        };
        let couplings = equations.couplings();
        for coupling in &couplings {
            let [stroke, rate] = coupling.gain.each_ref().map(along);
            coupling.add([stroke, rate / step], free, &mut scratch.stiffness, |r| r * count);
        }
        scratch.is_factored = self.system.has_filter(&couplings);
        let regular = scratch.is_factored
            || self.filter.factor(count, |matrix| {
                for (k, entry) in matrix.iter_mut().enumerate() {
                    let at = free[k / count] * n + free[k % count];
                    *entry = slopes.d_a[at] + step * slopes.d_v[at] + step * step * scratch.stiffness[k];
                }
            });
        if !regular {
            return (f64::INFINITY, free[0]);
        }
        self.filter_error(equations, step);
        self.weigh(free, step)
    }

    /// M r_v − h γ_0 K r_q through the filter that was factored, of the raw r_v and r_q in `scratch`, whose error this leaves there.
    pub(super) fn filter_error(&mut self, equations: &Equations, step: f64) {
        let (n, free, mass) = (self.model.nv(), equations.free(), &equations.slopes().d_a);
        let (count, scratch) = (free.len(), &mut self.scratch);
        scratch.error.clear();
        for r in 0..count {
            let row = (0..count).map(|c| {
                let mass = mass[free[r] * n + free[c]];
                mass * scratch.velocities[c] - step * scratch.stiffness[r * count + c] * scratch.positions[c]
            });
            scratch.error.push(row.sum());
        }
        match scratch.is_factored {
            true => self.system.filter(&mut scratch.error, 1),
            false => self.filter.solve(&mut scratch.error),
        }
    }

    /// rms of the error in `scratch` in units of the tolerance.
    fn weigh(&self, free: &[usize], step: f64) -> (f64, usize) {
        let (mut sum, mut worst, mut largest) = (0.0, free[0], -1.0);
        for (r, &k) in free.iter().enumerate() {
            let (e_v, r_q) = (self.scratch.error[r], self.scratch.positions[r]);
            let [v, q] = self.errors.allowed[r];
            let square = (e_v / v).powi(2) + ((r_q + step * e_v) / q).powi(2);
            if square > largest {
                (worst, largest) = (k, square);
            }
            sum += square;
        }
        ((sum / (2 * free.len()) as f64).sqrt(), worst)
    }
}

/// The embedded formula, h (γ_0 x_0 + Σ e_i x_i), of a quantity at the start and at the nodes.
pub(super) fn raw(h: f64, start: f64, at: [f64; STAGES]) -> f64 {
    h * (GAMMA * start + ESTIMATE.iter().zip(at).map(|(e, x)| e * x).sum::<f64>())
}
