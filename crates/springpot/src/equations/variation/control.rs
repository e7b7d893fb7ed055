//! What follows from the state, as the variation of a run asks for it.

use super::{NodeVariation, ROW, Variation};
use crate::equations::assembly::Equations;
use crate::equations::control::{ControlRun, HeldVariation, Jump, OfSamples, Place, Shown, Sides, Target};
use crate::observe::Snapshot;

impl Variation {
    /// Sees what follows from the state at node `i`, which was seen, where the elements pull with `force`.
    pub(crate) fn steer(&mut self, i: usize, equations: &Equations, force: &[f64]) {
        let (Some(control), Some(run)) = (&mut self.control, &equations.control) else { return };
        let NodeVariation { t, kinematics, slopes, q_now, v_now, a_now, readings, hessians, explicit, .. } =
            &mut self.nodes[i];
        let rests = |e: usize| &self.elements[e].rest[..];
        let at = Place { t: *t, motion: [q_now, v_now, a_now], kinematics, readings, rests: &rests };
        // A force that is held follows from nothing.
        let (n, count) = (v_now.len(), explicit.len() / v_now.len().max(1));
        let rows: Vec<usize> = self.saltation.held.drives().map(|(k, _)| self.own_v[k]).collect();
        let blocks = |row: usize| [row * n..(row + 1) * n, row * count..(row + 1) * count];
        let kept = rows.iter().map(|&row| {
            let [own, by] = blocks(row);
            [slopes.d_q[own.clone()].to_vec(), slopes.d_v[own].to_vec(), explicit[by].to_vec()]
        });
        let kept: Vec<_> = kept.collect();
        control.see(i, run, at, (force, hessians), (slopes, explicit));
        for (&row, [d_q, d_v, changes]) in rows.iter().zip(&kept) {
            let [own, by] = blocks(row);
            slopes.d_q[own.clone()].copy_from_slice(d_q);
            slopes.d_v[own].copy_from_slice(d_v);
            explicit[by].copy_from_slice(changes);
        }
    }

    /// Whether branches of control were left whose changes are not crossed yet.
    pub(super) fn leaves_branches(&self) -> bool {
        self.control.as_ref().is_some_and(|control| control.leaves_branches())
    }

    /// Whether the actuator force in the equation of velocity `row` is held, whatever else says what it is.
    pub(crate) fn is_held(&self, row: usize) -> bool {
        self.saltation.held.drives().any(|(k, _)| self.own_v[k] == row)
    }

    /// What changes of the inputs that follow from the state at node `i`, where the motion changes as the node has it.
    pub(crate) fn feed_back(&mut self, i: usize) {
        let (count, Some(control)) = (self.count(), &self.control) else { return };
        let node = &self.nodes[i];
        for (e, input, [by_q, by_v], own) in control.input_slopes(i) {
            if self.saltation.held.input(e, input).is_some() {
                continue;
            }
            let [values, _] = &mut self.elements[e].inputs;
            let inputs = values.len() / ((ROW + 1) * count);
            let change = &mut values[(i * inputs + input) * count..][..count];
            change.copy_from_slice(own);
            for (k, (by_q, by_v)) in by_q.iter().zip(by_v).enumerate() {
                let (q, v) = (&node.q[k * count..][..count], &node.v[k * count..][..count]);
                change.iter_mut().zip(q.iter().zip(v)).for_each(|(change, (q, v))| *change += by_q * q + by_v * v);
            }
        }
    }

    /// What the terms of a controller do at the start (0) or at a row, at θ of the step at hand or between two.
    pub(super) fn push_at(&mut self, i: usize, theta: Option<f64>, equations: &Equations) {
        if let (Some(control), Some(run)) = (&mut self.control, &equations.control) {
            let node = &self.nodes[i];
            control.push_at(i, theta, (run, false), [&node.q, &node.v]);
        }
    }

    /// How inputs that follow from the state answer to it at node `i`: element, input, ∂u/∂q and ∂u/∂v.
    pub(crate) fn input_slopes(&self, i: usize) -> impl Iterator<Item = (usize, usize, &[Vec<f64>; 2])> {
        let slopes = self.control.iter().flat_map(move |control| control.input_slopes(i));
        let follows = |e: usize, input: usize| self.saltation.held.input(e, input).is_none();
        slopes.filter(move |(e, input, ..)| follows(*e, *input)).map(|(e, input, by_state, _)| (e, input, by_state))
    }

    /// Whether elements count for nothing in the equation of velocity `row` at node `i`, since its actuator takes their forces off.
    pub(crate) fn relieves(&self, i: usize, row: usize) -> bool {
        self.control.as_ref().is_some_and(|control| control.relieves(i, row)) && !self.is_held(row)
    }

    /// What changes of the force that follows from the state, on velocity `k` at the row that was read.
    pub(super) fn steered(&self, k: usize, p: usize, snapshot: &Snapshot) -> f64 {
        let Some(control) = self.control.as_ref().filter(|_| !self.is_held(self.own_v[k])) else { return 0.0 };
        let (count, n, row, node) = (self.count(), self.nv(), self.own_v[k], &self.nodes[ROW]);
        let mut sum = control.torque(row, p, [&node.q, &node.v]);
        if control.relieves(ROW, row) {
            for (e, ([gradient, _], hessian)) in node.gradients.iter().zip(&node.hessians).enumerate() {
                let turned = hessian[row * n..][..n].iter().enumerate();
                let turned: f64 = turned.map(|(k, second)| second * node.q[k * count + p]).sum();
                sum += gradient[row] * self.elements[e].row[0][p] + snapshot.force(e) * turned;
            }
        }
        sum
    }

    /// Sees what control is about to leave at node `i`: the start, or the end of the step.
    pub(crate) fn foresee(&mut self, i: usize, equations: &Equations) {
        let (Some(control), Some(run)) = (&mut self.control, &equations.control) else { return };
        if !run.changes() {
            return;
        }
        let node = &self.nodes[i];
        let rests = |e: usize| &self.elements[e].rest[..];
        let motion = [&node.q_now[..], &node.v_now, &node.a_now];
        let at = Place { t: node.t, motion, kinematics: &node.kinematics, readings: &node.readings, rests: &rests };
        let found = control.foresee(i, run, at, [&node.q, &node.v]);
        let t = node.t;
        for Jump { moved, element } in found {
            self.comes_later(t, moved);
            if let Some(e) = element {
                self.note_inputs(equations, e, t);
            }
        }
    }
}

impl OfSamples for Variation {
    fn count(&self) -> usize {
        self.by.parameters.len()
    }

    fn hold(&mut self, held: Option<&HeldVariation>) {
        if let (Some(control), Some(held)) = (&mut self.control, held) {
            control.hold(held);
        }
    }

    fn say(&self, target: Target, shown: &dyn Shown) -> Vec<f64> {
        let (node, Some(control)) = (&self.nodes[ROW], &self.control) else { return Vec::new() };
        let rests = |e: usize| &self.elements[e].rest[..];
        let motion = [&node.q_now[..], &node.v_now, &node.a_now];
        let at = Place { t: node.t, motion, kinematics: &node.kinematics, readings: &node.readings, rests: &rests };
        let forces = |e: usize| (shown.force(e), self.elements[e].row[0].clone());
        control.say(target, at, &forces, [&node.q, &node.v, &node.a])
    }

    fn say_of_controller(
        &mut self,
        run: &ControlRun,
        told: (&[Sides], &[f64], f64),
        shown: &dyn Shown,
    ) -> [Vec<f64>; 2] {
        let Self { nodes, elements, control, system, .. } = self;
        let (n, node, Some(control)) = (system.model.nv(), &nodes[ROW], control) else { return Default::default() };
        let pull = |row: usize, p: usize| {
            let of = |(e, ([gradient, _], hessian)): (usize, (&[Vec<f64>; 2], &Vec<f64>))| {
                let blocks = node.q.chunks_exact(node.q.len() / n);
                let turned: f64 = hessian[row * n..][..n].iter().zip(blocks).map(|(second, q)| second * q[p]).sum();
                gradient[row] * elements[e].row[0][p] + shown.force(e) * turned
            };
            node.gradients.iter().zip(&node.hessians).enumerate().map(of).sum::<f64>()
        };
        control.say_of_controller(run, told, &pull, [&node.q, &node.v], node.t)
    }
}
