//! What follows from the state at one node: what a controller and expressions say, and how that answers.

use super::super::eye::{Eye, Slopes};
use super::super::mode::{Bound, Mode, Slew};
use super::super::{ControlRun, Target};
use super::{ControlVariation, Place};
use crate::control::{Aim, At, RobotChange, Sense};
use crate::dynamics::{RneaDerivatives, point_jacobian, point_jacobian_rate};
use crate::system::sensitivity::Seed;

impl ControlVariation {
    /// Looks at node `i`: what follows from the state there, and how. `slopes` are those of the equations of motion, from which it is taken, as from
    /// `explicit`, what changes of them where the motion stays; elements pull with `force`, whose second derivatives are `hessians`.
    pub(crate) fn see(
        &mut self,
        i: usize,
        run: &ControlRun,
        at: Place,
        (force, hessians): (&[f64], &[Vec<f64>]),
        (slopes, explicit): (&mut RneaDerivatives, &mut [f64]),
    ) {
        let n = self.system.model.nv();
        let node = &mut self.nodes[i];
        for blocks in [&mut node.slopes, &mut node.wanted] {
            blocks.d_q.fill(0.0);
            blocks.d_v.fill(0.0);
        }
        node.explicit.fill(0.0);
        node.wanted_explicit.fill(0.0);
        node.relieved.fill(false);
        self.steer(i, run, at);
        self.feed_back(i, run, at);
        let (count, node) = (self.count(), &mut self.nodes[i]);
        for (&row, held) in self.own_v.iter().zip(self.held.torques.chunks_exact(count)) {
            node.explicit[row * count..][..count].iter_mut().zip(held).for_each(|(sum, own)| *sum += own);
        }
        let node = &self.nodes[i];
        slopes.d_q.iter_mut().zip(&node.slopes.d_q).for_each(|(sum, own)| *sum -= own);
        slopes.d_v.iter_mut().zip(&node.slopes.d_v).for_each(|(sum, own)| *sum -= own);
        explicit.iter_mut().zip(&node.explicit).for_each(|(sum, own)| *sum -= own);
        for row in (0..n).filter(|row| node.relieved[*row]) {
            for (force, hessian) in force.iter().zip(hessians) {
                let lines = slopes.d_q[row * n..][..n].iter_mut().zip(&hessian[row * n..]);
                lines.for_each(|(slope, second)| *slope -= force * second);
            }
        }
    }

    /// What the controller says at node `i`.
    fn steer(&mut self, i: usize, run: &ControlRun, at: Place) {
        let (Some(controlled), Some(law)) = (run.controlled(), &self.law) else { return };
        let (model, count) = (&self.system.model, self.by.parameters.len());
        let [own, aim] = &mut self.aims;
        // Where a reference cannot be followed the run says so.
        own.gripper = [[f64::NAN; 3]; 2];
        let _ = controlled.reference.at_into(&self.run_model, None, at.t, &mut self.wanted, own);
        for (&place, q) in self.own_q.iter().zip(&own.q) {
            aim.q[place] = *q;
        }
        for (&k, (v, a)) in self.own_v.iter().zip(own.v.iter().zip(&own.a)) {
            (aim.v[k], aim.a[k]) = (*v, *a);
        }
        aim.gripper = own.gripper;
        let site = self.system.gripper.as_ref();
        self.leads_gripper = !own.gripper[0][0].is_nan();
        let follows = site.filter(|_| !self.leads_gripper);
        let mut jacobians = [Vec::new(), Vec::new()];
        if let Some(site) = follows {
            self.wanted.update_velocity(model, &aim.q, &aim.v);
            aim.gripper = [self.wanted.position(site).0, self.wanted.velocity(site).0];
            jacobians = [point_jacobian(model, &self.wanted, site), point_jacobian_rate(model, &self.wanted, site)];
        }
        let [q, v, a] = at.motion;
        let (kinematics, shaping) = (at.kinematics, &controlled.shaping);
        let asked = At { model, gripper: site, t: at.t, q, v, kinematics, aim, shaping };
        let node = &mut self.nodes[i];
        node.gripper = aim.gripper[0];
        node.errors.clear();
        node.errors.extend(self.joints.iter().map(|joint| asked.error(joint.row)));
        law.slopes(&asked, &mut self.scratch, &mut node.wanted);
        let n = model.nv();
        let mut change = Aim { q: vec![0.0; model.nq()], v: vec![0.0; n], a: vec![0.0; n], gripper: [[0.0; 3]; 2] };
        let mut tau = vec![0.0; n];
        for (p, parameter) in self.by.parameters.iter().enumerate() {
            for blocks in [&mut change.q, &mut change.v, &mut change.a] {
                blocks.fill(0.0);
            }
            change.gripper = [[0.0; 3]; 2];
            tau.fill(0.0);
            let mut moved = vec![0.0; n];
            let mut leads = false;
            for seed in &parameter.seeds {
                match seed {
                    Seed::Reference { velocity, by } => {
                        let (k, by) = (self.own_v[*velocity], by.at(at.t));
                        if let Some(place) = model.coordinate_of(k) {
                            change.q[place] += by.value;
                        }
                        moved[k] += by.value;
                        change.v[k] += by.first;
                        change.a[k] += by.second;
                        leads = true;
                    }
                    Seed::ReferencePoint { axis, by } => {
                        let by = by.at(at.t);
                        change.gripper[0][*axis] += by.value;
                        change.gripper[1][*axis] += by.first;
                        leads = true;
                    }
                    Seed::Place { velocity, by } => {
                        moved[*velocity] += by;
                        leads = true;
                    }
                    Seed::Controller { number, by } => {
                        let number = number.of_robot(&self.own_v);
                        law.add_by_number(&number, *by, &asked, &mut self.scratch, &mut tau);
                    }
                    Seed::Inertia(robot) => {
                        law.add_by_robot(&asked, RobotChange::Inertia(robot), &mut self.scratch, &mut tau);
                    }
                    Seed::Gravity(robot) => {
                        law.add_by_robot(&asked, RobotChange::Gravity(robot), &mut self.scratch, &mut tau);
                    }
                    _ => {}
                }
            }
            if leads {
                if follows.is_some() {
                    let [jacobian, rate] = jacobians.each_ref().map(|columns| columns.chunks_exact(n));
                    for (axis, (jacobian, rate)) in jacobian.zip(rate).enumerate() {
                        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                        change.gripper[0][axis] = dot(jacobian, &moved);
                        change.gripper[1][axis] = dot(jacobian, &change.v) + dot(rate, &moved);
                    }
                }
                law.add_by_aim(&asked, &change, &mut self.scratch, &mut tau);
            }
            for (moves, change) in node.gripper_moves.iter_mut().zip(change.gripper[0]) {
                moves[p] = change;
            }
            for (joint, [place, speed]) in self.joints.iter().zip(&mut node.aims) {
                (place[p], speed[p]) = (moved[joint.row], change.v[joint.row]);
            }
            (0..n).for_each(|k| node.wanted_explicit[k * count + p] = tau[k]);
        }
        if run.joints.iter().any(|joint| joint.limit.torque.is_finite() || joint.limit.rate.is_finite()) {
            // The aim goes on, but for accelerations that change.
            tau.fill(0.0);
            for k in 0..n {
                if let Some(place) = model.coordinate_of(k) {
                    change.q[place] = aim.v[k];
                }
            }
            change.v.copy_from_slice(&aim.a);
            change.a.fill(0.0);
            change.gripper = [aim.gripper[1], [f64::NAN; 3]];
            if follows.is_some() {
                let rows = jacobians.each_ref().map(|columns| columns.chunks_exact(n));
                let [jacobian, rate] = rows;
                for (axis, (jacobian, rate)) in jacobian.zip(rate).enumerate() {
                    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                    change.gripper[1][axis] = dot(jacobian, &aim.a) + dot(rate, &aim.v);
                }
            }
            law.add_by_aim(&asked, &change, &mut self.scratch, &mut tau);
            let is_known = !run.controlled().is_some_and(|controlled| controlled.law.follows_accelerations());
            for (drift, joint) in node.drifts.iter_mut().zip(&self.joints) {
                let line = joint.row * n..(joint.row + 1) * n;
                let along = |slopes: &[f64], by: &[f64]| -> f64 {
                    slopes[line.clone()].iter().zip(by).map(|(slope, by)| slope * by).sum()
                };
                let by_state = along(&node.wanted.d_q, v) + along(&node.wanted.d_v, a);
                *drift = if is_known { tau[joint.row] + by_state } else { f64::NAN };
            }
        }
        let acting = self.joints.iter().zip(&run.joints).filter(|_| run.is_continuous);
        for (joint, state) in acting {
            let (row, Mode { bound, slew, .. }) = (joint.row, state.mode);
            let blocks = row * count..(row + 1) * count;
            if state.mode.follows() {
                node.slopes.d_q[row * n..][..n].copy_from_slice(&node.wanted.d_q[row * n..][..n]);
                node.slopes.d_v[row * n..][..n].copy_from_slice(&node.wanted.d_v[row * n..][..n]);
                node.explicit[blocks.clone()].copy_from_slice(&node.wanted_explicit[blocks]);
                node.relieved[row] = run.compensates;
                continue;
            }
            for (p, explicit) in node.explicit[blocks].iter_mut().enumerate() {
                *explicit = match (bound, slew) {
                    (Bound::At(sign), _) => f64::from(sign) * joint.limit[p],
                    (Bound::Free, Slew::Goes { sign, since, .. }) => {
                        joint.from[p] + f64::from(sign) * (at.t - since) * joint.rate_limit[p]
                    }
                    (Bound::Free, Slew::Follows) => 0.0,
                };
            }
        }
    }

    /// What expressions say at node `i`.
    fn feed_back(&mut self, i: usize, run: &ControlRun, at: Place) {
        let (n, count) = (self.system.model.nv(), self.by.parameters.len());
        let [q, v, _] = at.motion;
        let read = |e: usize| at.readings[e];
        let eye = Eye { system: &self.system, t: at.t, q, v, kinematics: at.kinematics, element: &read };
        let node = &mut self.nodes[i];
        node.inputs.clear();
        let mut slopes = Vec::new();
        for (law, state) in self.laws.iter().zip(&run.laws) {
            let seen: Vec<f64> = law.senses.iter().map(|sense| eye.value(*sense)).collect();
            law.law.slopes_on(state.branch, at.t, &seen, &mut slopes);
            let (mut by_state, mut own) = ([vec![0.0; n], vec![0.0; n]], vec![0.0; count]);
            for (sense, slope) in law.senses.iter().zip(&slopes).filter(|(_, slope)| **slope != 0.0) {
                add_sense(&eye, *sense, *slope, at, (&mut by_state, &mut own));
            }
            for (own, slopes) in own.iter_mut().zip(&law.own) {
                *own += slopes.iter().map(|slope| slope.value_on(state.branch, at.t, &seen)).sum::<f64>();
            }
            match law.target {
                Target::Torque(row) => {
                    let [by_q, by_v] = by_state;
                    let lines = [(&mut node.slopes.d_q, by_q), (&mut node.slopes.d_v, by_v)];
                    for (matrix, line) in lines {
                        matrix[row * n..][..n].iter_mut().zip(line).for_each(|(sum, own)| *sum += own);
                    }
                    node.explicit[row * count..][..count].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                }
                Target::Input(e, input) => node.inputs.push((e, input, by_state, own)),
            }
        }
        for (e, input, held) in &self.held.inputs {
            node.inputs.push((*e, *input, [vec![0.0; n], vec![0.0; n]], held.clone()));
        }
    }
}

/// Adds what a sense changes of an expression whose slope by it is `slope`: ∂/∂q and ∂/∂v, and where the motion stays.
pub(super) fn add_sense(eye: &Eye, sense: Sense, slope: f64, at: Place, (by_state, own): (&mut Slopes, &mut [f64])) {
    for (sum, of_sense) in by_state.iter_mut().zip(eye.slopes(sense)) {
        sum.iter_mut().zip(of_sense).for_each(|(sum, own)| *sum += slope * own);
    }
    if let Sense::Stroke(e) = sense {
        own.iter_mut().zip((at.rests)(e)).for_each(|(sum, rest)| *sum += slope * rest);
    }
}
