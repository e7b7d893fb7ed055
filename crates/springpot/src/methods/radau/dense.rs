//! Positions, velocities and accelerations inside a step.

use super::step::RadauStep;
use crate::actuation::Drive;
use crate::elements::ElementBank;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::law::InputValue;
use crate::model::JointKind;

/// The step just fitted as a function of time: the cubic through the regular accelerations at its start and its nodes, integrated
/// twice, and the share of singular starts, integrated exactly.
pub(super) struct Dense<'s> {
    pub(super) cx: Context<'s>,
    pub(super) step: &'s RadauStep,
    pub(super) bank: &'s ElementBank,
    pub(super) h: f64,
    pub(super) scratch: &'s mut Scratch,
}

/// Room for one place in a step.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    xi: Vec<f64>,
    singular: Vec<[f64; 3]>,
    inputs: Vec<InputValue>,
}

impl Dense<'_> {
    /// Fills q, v, a and what drives the joints at t = t_n + θh.
    pub(super) fn place(&mut self, t: f64, theta: f64, evaluation: &mut Evaluation) {
        self.take_singular(t);
        let (step, h, scratch) = (self.step, self.h, &mut *self.scratch);
        let (model, origin) = (&step.model, &step.origin);
        scratch.xi.clear();
        scratch.xi.resize(model.nv(), 0.0);
        for (j, driven) in model.own_joints().zip(&step.forward.drives) {
            if !matches!(driven, Drive::Force(_)) {
                continue;
            }
            for k in model.v_range(j) {
                let [a, push, travel] = integrals(step.cubic.each_ref().map(|u| u[k]), theta);
                let singular = scratch.singular.iter().zip(&step.elements);
                let extra = singular.fold([0.0; 3], |sum, (part, element)| {
                    [0, 1, 2].map(|order| sum[order] + element.share[k] * part[order])
                });
                let start = origin.v[k];
                evaluation.a[k] = a + extra[0];
                evaluation.v[k] = start + h * push + extra[1];
                scratch.xi[k] = if model.joint_kind(j) == JointKind::Floating {
                    h * integrals(step.turning.each_ref().map(|u| u[k]), theta)[1]
                } else {
                    h * (theta * start + h * travel) + extra[2]
                };
            }
        }
        model.integrate_into(&origin.q, &scratch.xi, &mut evaluation.q);
        drive(self.cx, &step.forward, t, evaluation);
    }

    /// Velocity `k`, which a force drives, at t = t_n + θh.
    pub(super) fn velocity(&mut self, k: usize, theta: f64) -> f64 {
        let (step, h) = (self.step, self.h);
        self.take_singular(step.origin.t + theta * h);
        let [_, push, _] = integrals(step.cubic.each_ref().map(|u| u[k]), theta);
        let singular = self.scratch.singular.iter().zip(&step.elements);
        let extra: f64 = singular.map(|(part, element)| element.share[k] * part[1]).sum();
        step.origin.v[k] + h * push + extra
    }

    /// Of every element, the singular force at t, its integral from the start of the step, and the integral of that.
    fn take_singular(&mut self, t: f64) {
        let (step, scratch) = (self.step, &mut *self.scratch);
        scratch.singular.clear();
        if !step.is_singular {
            return;
        }
        let from = step.origin.t;
        for (e, element) in self.cx.system.elements.iter().enumerate() {
            scratch.inputs.clear();
            scratch.inputs.resize(element.inputs.len(), InputValue::default());
            self.cx.inputs_at(e, t, &mut scratch.inputs);
            let mut sum = [0.0; 3];
            self.bank.for_each_singularity(e, &scratch.inputs, &mut |term| {
                let alpha = term.order;
                let parts = |t: f64| {
                    let value = if t == 0.0 { 0.0 } else { term.coefficient * t.powf(-alpha) };
                    [value, value * t / (1.0 - alpha), value * t * t / ((1.0 - alpha) * (2.0 - alpha))]
                };
                let ([value, once, twice], [_, before, before_twice]) = (parts(t), parts(from));
                sum[0] += value;
                sum[1] += once - before;
                sum[2] += twice - before_twice - (t - from) * before;
            });
            scratch.singular.push(sum);
        }
    }
}

/// The cubic with coefficients `u` at θ, its integral from 0, and the integral of that.
fn integrals(u: [f64; 4], theta: f64) -> [f64; 3] {
    let [u0, u1, u2, u3] = u;
    let value = u0 + theta * (u1 + theta * (u2 + theta * u3));
    let once = theta * (u0 + theta * (u1 / 2.0 + theta * (u2 / 3.0 + theta * u3 / 4.0)));
    let twice = theta * theta * (u0 / 2.0 + theta * (u1 / 6.0 + theta * (u2 / 12.0 + theta * u3 / 20.0)));
    [value, once, twice]
}
