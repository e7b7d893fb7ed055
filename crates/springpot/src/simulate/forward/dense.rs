//! Positions, velocities and accelerations inside a step.

use super::drives::drive;
use super::stepper::Stepper;
use crate::law::{InputValue, State};
use crate::model::JointKind;
use crate::motion::Drive;
use crate::simulate::moment::Moment;

/// The step just fitted as a function of time: the cubic through the regular accelerations at its start and its nodes, integrated
/// twice, and the share of singular starts, integrated exactly.
pub(super) struct Dense<'s, 'a> {
    pub(super) stepper: &'s Stepper<'a>,
    pub(super) h: f64,
    /// The laws' states that tell of singular starts.
    pub(super) starts: &'s [State],
    pub(super) scratch: &'s mut Scratch,
}

/// Room for one place in a step.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    xi: Vec<f64>,
    singular: Vec<[f64; 3]>,
    inputs: Vec<InputValue>,
}

impl Dense<'_, '_> {
    /// Fills q, v, a and what drives the joints at t = t_n + θh.
    pub(super) fn place(&mut self, t: f64, theta: f64, moment: &mut Moment) {
        self.take_singular(t);
        let (stepper, h, scratch) = (self.stepper, self.h, &mut *self.scratch);
        let (model, origin) = (stepper.model, &stepper.origin);
        scratch.xi.clear();
        scratch.xi.resize(model.nv(), 0.0);
        for (j, driven) in model.own_joints().zip(&stepper.forward.drives) {
            if !matches!(driven, Drive::Force(_)) {
                continue;
            }
            for k in model.v_range(j) {
                let [a, push, travel] = integrals(stepper.cubic.each_ref().map(|u| u[k]), theta);
                let singular = scratch.singular.iter().zip(&stepper.elements);
                let extra = singular.fold([0.0; 3], |sum, (part, element)| {
                    [0, 1, 2].map(|order| sum[order] + element.share[k] * part[order])
                });
                let start = origin.v[k];
                moment.a[k] = a + extra[0];
                moment.v[k] = start + h * push + extra[1];
                scratch.xi[k] = if model.joint_kind(j) == JointKind::Floating {
                    h * integrals(stepper.turning.each_ref().map(|u| u[k]), theta)[1]
                } else {
                    h * (theta * start + h * travel) + extra[2]
                };
            }
        }
        model.integrate_into(&origin.q, &scratch.xi, &mut moment.q);
        drive(model, stepper.forward, t, moment);
    }

    /// Velocity `k`, which a force drives, at t = t_n + θh.
    pub(super) fn velocity(&mut self, k: usize, theta: f64) -> f64 {
        let (stepper, h) = (self.stepper, self.h);
        self.take_singular(stepper.origin.t + theta * h);
        let [_, push, _] = integrals(stepper.cubic.each_ref().map(|u| u[k]), theta);
        let singular = self.scratch.singular.iter().zip(&stepper.elements);
        let extra: f64 = singular.map(|(part, element)| element.share[k] * part[1]).sum();
        stepper.origin.v[k] + h * push + extra
    }

    /// Of every element, the singular force at t, its integral from the start of the step, and the integral of that.
    fn take_singular(&mut self, t: f64) {
        let (stepper, scratch) = (self.stepper, &mut *self.scratch);
        scratch.singular.clear();
        if !stepper.is_singular {
            return;
        }
        let from = stepper.origin.t;
        for (element, state) in stepper.system.elements.iter().zip(self.starts) {
            scratch.inputs.clear();
            scratch.inputs.resize(element.inputs.len(), InputValue::default());
            element.inputs_at(t, &mut scratch.inputs);
            let mut sum = [0.0; 3];
            element.law.for_each_singularity(&scratch.inputs, state, &mut |term| {
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
