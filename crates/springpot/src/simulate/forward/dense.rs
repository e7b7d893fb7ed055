//! Positions, velocities and accelerations inside a step.

use super::stepper::{Origin, Stage};
use crate::fractional::step::{MAX_NODES, lagrange_row};
use crate::law::State;
use crate::model::{JointKind, Model};
use crate::motion::{Drive, Forward};
use crate::simulate::System;
use crate::simulate::moment::Moment;

/// A step as a function of time: the cubic through the regular accelerations at its start and its nodes, integrated twice, and
/// the share of singular starts, integrated exactly.
pub(super) struct Dense<'a> {
    pub(super) system: &'a System,
    pub(super) forward: &'a Forward,
    pub(super) origin: &'a Origin,
    pub(super) h: f64,
    pub(super) stages: &'a [Stage; MAX_NODES],
    pub(super) regular: &'a [Vec<f64>; MAX_NODES + 1],
    /// Accelerations that a unit of each element's force gives; empty without singular starts.
    pub(super) yields: &'a [Vec<f64>],
    /// States of the elements' laws; empty without singular starts.
    pub(super) laws: &'a [State],
}

impl Dense<'_> {
    /// Fills q, v, a and what drives the joints at t = t_n + θh.
    pub(super) fn place(&self, t: f64, theta: f64, moment: &mut Moment) {
        let model = &self.system.model;
        let singular = self.singular(t);
        let mut xi = vec![0.0; model.nv()];
        for (j, drive) in model.own_joints().zip(&self.forward.drives) {
            if !matches!(drive, Drive::Force(_)) {
                continue;
            }
            for k in model.v_range(j) {
                let [a, v, x] = self.cubic(theta, |node| self.regular[node][k]);
                let [push, speed, travel] = singular
                    .iter()
                    .zip(self.yields)
                    .fold([0.0; 3], |sum, (part, share)| [0, 1, 2].map(|order| sum[order] + share[k] * part[order]));
                let start = self.origin.v[k];
                moment.a[k] = a + push;
                moment.v[k] = start + self.h * v + speed;
                xi[k] = self.h * (theta * start + self.h * x) + travel;
                if model.joint_kind(j) == JointKind::Floating {
                    let rate = |node: usize| if node == 0 { start } else { self.stages[node - 1].xi_rate[k] };
                    xi[k] = self.h * self.cubic(theta, rate)[1];
                }
            }
        }
        model.integrate_into(&self.origin.q, &xi, &mut moment.q);
        self.drive(model, t, moment);
    }

    /// What drives the joints at t, and those that signals move.
    pub(super) fn drive(&self, model: &Model, t: f64, moment: &mut Moment) {
        drive(model, self.forward, t, moment);
    }

    /// The cubic through values at the start and the nodes, its integral over θ, and the integral of that.
    fn cubic(&self, theta: f64, value: impl Fn(usize) -> f64) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for node in 0..=MAX_NODES {
            let (row, value) = (lagrange_row(node), value(node));
            let mut power = 1.0;
            for (p, coefficient) in row.into_iter().enumerate() {
                let (p, term) = (p as f64, coefficient * value * power);
                sums[0] += term;
                sums[1] += term * theta / (p + 1.0);
                sums[2] += term * theta * theta / ((p + 1.0) * (p + 2.0));
                power *= theta;
            }
        }
        sums
    }

    /// Of every element, the singular force at t, its integral from t_n, and the integral of that.
    fn singular(&self, t: f64) -> Vec<[f64; 3]> {
        if self.yields.is_empty() {
            return Vec::new();
        }
        let from = self.origin.t;
        self.system
            .elements
            .iter()
            .zip(self.laws)
            .map(|(element, law)| {
                let alpha = element.law.order();
                let mut inputs = vec![Default::default(); element.inputs.len()];
                element.inputs_at(t, &mut inputs);
                let point = crate::law::Point { t, stroke: 0.0, rate: 0.0, inputs: &inputs };
                let c = element.law.force(&point, 1.0) - element.law.force(&point, 0.0);
                // x(0) t^−alpha/Γ(1−alpha), integrated once and twice from 0.
                let parts = |t: f64| {
                    if t == 0.0 {
                        return [0.0; 3];
                    }
                    let value = element.law.singular(t, law);
                    [value, value * t / (1.0 - alpha), value * t * t / ((1.0 - alpha) * (2.0 - alpha))]
                };
                let ([value, once, twice], [_, before, before_twice]) = (parts(t), parts(from));
                [c * value, c * (once - before), c * (twice - before_twice - (t - from) * before)]
            })
            .collect()
    }
}

/// What drives the joints at t, and the places of those that signals move.
pub(in crate::simulate) fn drive(model: &Model, forward: &Forward, t: f64, moment: &mut Moment) {
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        let (q, v) = (model.q_range(j), model.v_range(j));
        match drive {
            Drive::Force(signals) => {
                for (k, signal) in v.zip(signals) {
                    moment.driven[k] = Some(signal.at(t).value);
                }
            }
            Drive::Prescribed(path) => {
                path.at(t, &mut moment.q[q], &mut moment.v[v.clone()], &mut moment.a[v]);
            }
            Drive::Locked => {
                moment.q[q.clone()].copy_from_slice(&forward.q[q]);
                moment.v[v.clone()].fill(0.0);
                moment.a[v].fill(0.0);
            }
        }
    }
}
