//! Positions, velocities and accelerations inside a step.

use super::drives::drive;
use super::stepper::Stepper;
use crate::law::{InputValue, Point};
use crate::model::JointKind;
use crate::motion::Drive;
use crate::simulate::moment::Moment;

/// The step just fitted as a function of time: the cubic through the regular accelerations at its start and its nodes, integrated
/// twice, and the share of singular starts, integrated exactly.
pub(super) struct Dense<'s, 'a> {
    pub(super) stepper: &'s Stepper<'a>,
    pub(super) h: f64,
    /// Of each element the singular share of D^alpha x at t = 1 s, x(0)/Γ(1−alpha); 0 without one.
    pub(super) starts: &'s [f64],
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
        for (element, &unit) in stepper.system.elements.iter().zip(self.starts) {
            if unit == 0.0 {
                scratch.singular.push([0.0; 3]);
                continue;
            }
            let alpha = element.law.order();
            scratch.inputs.clear();
            scratch.inputs.resize(element.inputs.len(), InputValue::default());
            element.inputs_at(t, &mut scratch.inputs);
            let point = Point { t, stroke: 0.0, rate: 0.0, inputs: &scratch.inputs };
            let c = element.law.force(&point, 1.0) - element.law.force(&point, 0.0);
            let parts = |t: f64| {
                let value = if t == 0.0 { 0.0 } else { unit * t.powf(-alpha) };
                [value, value * t / (1.0 - alpha), value * t * t / ((1.0 - alpha) * (2.0 - alpha))]
            };
            let ([value, once, twice], [_, before, before_twice]) = (parts(t), parts(from));
            scratch.singular.push([c * value, c * (once - before), c * (twice - before_twice - (t - from) * before)]);
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
