//! Positions, velocities and accelerations inside a step.

use super::step::ExplicitStep;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::equations::{Equations, Origin, Within};

/// The step just worked out as a function of time; its polynomial is there.
pub(super) struct Between<'s> {
    pub(super) step: &'s ExplicitStep,
    pub(super) origin: &'s Origin,
    pub(super) h: f64,
    pub(super) xi: &'s mut Vec<f64>,
}

impl Within for Between<'_> {
    fn velocity(&mut self, _: Context, _: &Equations, k: usize, theta: f64) -> f64 {
        self.origin.v[k] + self.step.push(k, theta)
    }

    fn place(&mut self, cx: Context, equations: &Equations, t: f64, theta: f64, evaluation: &mut Evaluation) {
        let Evaluation { q, v, a, .. } = evaluation;
        self.step.place(equations, (self.origin, self.h), theta, self.xi, [q, v, a]);
        drive(cx, equations.forward(), t, evaluation);
    }
}
