//! Positions, velocities and accelerations inside a step.

use super::step::RadauStep;
use crate::collocation::integrals;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::equations::{Equations, Within};

/// The step just fitted as a function of time: the cubic through the regular accelerations at its start and its nodes, integrated
/// twice, and the share of singular starts, integrated exactly.
pub(super) struct Dense<'s> {
    pub(super) step: &'s RadauStep,
    pub(super) h: f64,
    pub(super) scratch: &'s mut Scratch,
}

/// Room for one place in a step.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    xi: Vec<f64>,
    singular: Vec<[f64; 3]>,
}

impl Within for Dense<'_> {
    fn velocity(&mut self, cx: Context, equations: &Equations, k: usize, theta: f64) -> f64 {
        let Self { step, h, scratch } = self;
        let from = step.origin.t;
        equations.singular_forces(cx, from, from + theta * *h, &mut scratch.singular);
        let [_, push, _] = integrals(step.fitted.cubic.each_ref().map(|u| u[k]), theta);
        let [_, extra, _] = equations.singular_motion(k, &scratch.singular);
        step.origin.v[k] + *h * push + extra
    }

    fn place(&mut self, cx: Context, equations: &Equations, t: f64, theta: f64, evaluation: &mut Evaluation) {
        let (step, h, scratch) = (self.step, self.h, &mut *self.scratch);
        let (model, origin) = (&step.model, &step.origin);
        equations.singular_forces(cx, origin.t, t, &mut scratch.singular);
        scratch.xi.clear();
        scratch.xi.resize(model.nv(), 0.0);
        for (j, _) in equations.forward().forced(model) {
            for k in model.v_range(j) {
                let [a, push, travel] = integrals(step.fitted.cubic.each_ref().map(|u| u[k]), theta);
                let extra = equations.singular_motion(k, &scratch.singular);
                let start = origin.v[k];
                evaluation.a[k] = a + extra[0];
                evaluation.v[k] = start + h * push + extra[1];
                scratch.xi[k] = if model.joint_space(j).quaternion().is_some() {
                    h * integrals(step.fitted.turning.each_ref().map(|u| u[k]), theta)[1]
                } else {
                    h * (theta * start + h * travel) + extra[2]
                };
            }
        }
        model.integrate_into(&origin.q, &scratch.xi, &mut evaluation.q);
        drive(cx, equations.forward(), t, evaluation);
    }
}
