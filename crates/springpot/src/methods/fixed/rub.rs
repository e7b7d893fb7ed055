//! Friction that sticks, over one step: f ∈ F·Sgn(v) at its end.

use super::step::OneStage;
use crate::equations::coulomb::Candidate;
use crate::system::error::RunError;

/// By how much friction may exceed its limit and still hold, as a share of it: far below the error of a step.
pub(super) const SLACK: f64 = 1e-10;

impl OneStage {
    /// The free velocities at which friction sticks, with their places among the free ones.
    pub(super) fn rubbing(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let free = self.free.iter().copied().enumerate();
        free.filter(|&(_, k)| self.limits[k] > 0.0)
    }

    /// Takes friction off the change of the accelerations that an iteration found without it, and notes what it holds.
    ///
    /// # Errors
    /// [`RunError::NoHold`].
    pub(super) fn rub(&mut self, h: f64) -> Result<(), RunError> {
        let Self { free, limits, coulomb, origin, a, residual, newton, held, .. } = self;
        coulomb.candidates.clear();
        for (place, &k) in free.iter().enumerate().filter(|(_, k)| limits[**k] > 0.0) {
            // The acceleration less the one that ends at rest.
            let offset = origin.v[k] / h + a[k];
            coulomb.candidates.push(Candidate { place, limit: limits[k], slack: SLACK * limits[k], offset });
        }
        if coulomb.candidates.is_empty() {
            return Ok(());
        }
        if let Err(c) = coulomb.solve(newton, residual) {
            let k = free[coulomb.candidates[c].place];
            return Err(RunError::NoHold { t: origin.t, joint: self.model.v_labels()[k].name.clone() });
        }
        for (candidate, direction) in coulomb.candidates.iter().zip(&coulomb.directions) {
            held[free[candidate.place]] = *direction == 0;
        }
        Ok(())
    }
}
