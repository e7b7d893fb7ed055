//! What a step of Radau IIA may err, and how large a motion begins.

use super::step::RadauStep;
use crate::equations::context::Context;
use crate::equations::{Equations, Outlook};
use crate::system::error::RunError;

impl RadauStep {
    /// What the errors of velocities and coordinates may be in a step of size `h`, in the order of the free velocities.
    pub(super) fn allow(&mut self, cx: Context, equations: &mut Equations, h: f64) {
        let Self { stages, errors, origin, .. } = self;
        let own = |k: usize| stages.iter().fold(0.0, |largest: f64, stage| largest.max(h * stage.a[k].abs()));
        let tolerance = errors.tolerance;
        errors.allow(cx, equations, (origin, h), tolerance, own);
    }

    /// The rate at which the system answers the accelerations at the origin, rad/s.
    pub(super) fn answering_rate(&self, cx: Context, equations: &Equations, slowest: f64) -> f64 {
        equations.answering_rate(cx, &self.origin.v, &self.origin.a, slowest)
    }

    /// Expects what the accelerations at the origin begin in a run until `end`; nothing of steps longer than `longest` seconds.
    ///
    /// # Errors
    /// Where what drives the robot is not finite.
    pub(super) fn expect(
        &mut self,
        cx: Context,
        equations: &Equations,
        end: f64,
        longest: f64,
    ) -> Result<(), RunError> {
        let omega = self.answering_rate(cx, equations, 1.0 / end);
        let (origin, sizes) = (&self.origin, &mut self.errors.sizes);
        sizes.take(&self.model, origin.t, &origin.q, &origin.v);
        sizes.expect(origin.t, &origin.a, omega, equations.is_singular());
        // What moves has a size; samples and breaks come by the thousand.
        if origin.t < 2.0 * sizes.looked() && !equations.free().iter().any(|&k| sizes.rests(k)) {
            return Ok(());
        }
        let rests = |k: usize| sizes.rests(k);
        let from = Outlook { at: origin.node(), rests: &rests, response: sizes.response() };
        let (ahead, stretch) = equations.foresee(cx, from, longest.min(sizes.response()))?;
        sizes.look_ahead(ahead, stretch);
        Ok(())
    }
}

/// Of a singular start with the stroke `jump`, how far it moves each velocity: |jump|·|g_k|/g·g.
pub(super) fn jump_travel(jump: f64, gradient: &[f64], k: usize) -> f64 {
    let square: f64 = gradient.iter().map(|g| g * g).sum();
    if square > 0.0 { jump.abs() * gradient[k].abs() / square } else { 0.0 }
}
