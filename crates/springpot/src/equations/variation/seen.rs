//! Nodes as they are seen: what the elements measure there, the slopes of the equations of motion, and what changes where the motion stays.

use super::{NodeVariation, Saltation, Variation};
use crate::collocation::STAGES;
use crate::dynamics::{Abreast, Found, Workspace};
use crate::elements::Reading;
use crate::equations::assembly::Equations;
use crate::equations::node::Node;
use crate::equations::resistance::add_tangents;
use crate::model::{FrictionLaw, Model};
use crate::system::System;
use crate::system::sensitivity::Seed;

impl Variation {
    /// Looks at node `i` of the step, where the run is at `at`: what its elements measure, and their inputs.
    pub(crate) fn look(&mut self, i: usize, at: Node) {
        self.stand(i, at);
        self.measure_all(i, |_| true);
        self.look_at_inputs(i, at.t);
    }

    /// Puts the robot at node `i` to where the run is.
    fn stand(&mut self, i: usize, at: Node) {
        let (q, node) = (&mut self.coordinates.values, &mut self.nodes[i]);
        self.coordinates.own.iter().zip(at.q).for_each(|(&k, value)| q[k] = *value);
        for (&k, (v, a)) in self.own_v.iter().zip(at.v.iter().zip(at.a)) {
            (node.v_now[k], node.a_now[k]) = (*v, *a);
        }
        node.t = at.t;
        node.q_now.copy_from_slice(q);
    }

    /// What those elements measure at node `i`, whose kinematics are worked out for that.
    fn measure_all(&mut self, i: usize, wanted: impl Fn(usize) -> bool) {
        let Self { system, own_v, nodes, room, .. } = self;
        nodes[i].measure_all((system, own_v), &room.abreast.sought.moves, &mut room.workspace, wanted);
    }

    /// Looks at node `i`, where the elements pull with `force`, and sees the slopes there, and what changes where the motion stays.
    pub(crate) fn see(&mut self, equations: &Equations, i: usize, at: Node, force: &[f64]) {
        self.look(i, at);
        let Self { system, nodes, room, .. } = self;
        let NodeVariation { kinematics, a_now, slopes, efforts, .. } = &mut nodes[i];
        let (sought, found) = (&room.abreast.sought, (slopes, &mut efforts[..]));
        sought.slopes_into(&system.model, kinematics, a_now, &mut room.workspace, found);
        self.weigh(equations, i, at, force);
    }

    /// The same of all stages, side by side; the elements pull with `force`, stage by stage.
    pub(crate) fn see_stages(&mut self, equations: &Equations, at: [Node; STAGES], force: &[f64]) {
        for (i, at) in (1..).zip(at) {
            self.stand(i, at);
            self.look_at_inputs(i, at.t);
        }
        let Self { system, nodes: [_, stages @ .., _], room, .. } = self;
        see_all(&mut room.abreast, &system.model, stages);
        let elements = self.elements.len();
        for (i, at) in (1..).zip(at) {
            if self.room.stands {
                let lines: Vec<usize> = self.room.abreast.sought.lines.iter().map(|(e, _)| *e).collect();
                self.measure_all(i, |e| !lines.contains(&e));
            }
            self.weigh(equations, i, at, &force[(i - 1) * elements..i * elements]);
        }
    }

    /// Adds to what was found at node `i` what the elements, resistances and parameters have in it.
    fn weigh(&mut self, equations: &Equations, i: usize, at: Node, force: &[f64]) {
        let Self { by, system, own_v, nodes, saltation, inertias, pushes, one_size, .. } = self;
        let Saltation { held, .. } = saltation;
        let (model, node, count) = (&system.model, &mut nodes[i], by.parameters.len());
        let n = model.nv();
        node.pull_and_resist((system, own_v), force);
        own_v.iter().for_each(|k| node.explicit[k * count..(k + 1) * count].fill(0.0));
        for (velocity, by) in held.drives() {
            let row = own_v[velocity] * count;
            node.explicit[row..row + count].iter_mut().zip(by).for_each(|(sum, by)| *sum -= by);
        }
        for &(p, which) in pushes.iter() {
            let mut add = |k: usize, value: f64| node.explicit[k * count + p] += value;
            match &by.parameters[p].seeds[which] {
                Seed::Drive { velocity, .. } if held.drive(*velocity).is_some() => {}
                Seed::Friction { joint, by } if model.friction_laws()[*joint] == FrictionLaw::Sticking => {
                    let (k, ratio, _) = felt(model, *joint, &node.v_now);
                    let own = own_v.iter().position(|own| *own == k);
                    let direction = |own: usize| match one_size {
                        Some(one_size) => one_size.sliding(i, own, at.v[own]),
                        None => equations.sliding(own, at.v[own]),
                    };
                    add(k, by * ratio.abs() * own.map_or(0.0, direction));
                }
                seed => {
                    pushed(model, own_v, seed, (at.t, &node.v_now)).into_iter().for_each(|(k, value)| add(k, value))
                }
            }
        }
        let NodeVariation { explicit, efforts, a_now, .. } = node;
        let changes = efforts.len() / n.max(1);
        for &k in own_v.iter() {
            let (sums, own) = (&mut explicit[k * count..(k + 1) * count], &efforts[k * changes..(k + 1) * changes]);
            inertias.parameters().zip(own).for_each(|(p, effort)| sums[p] += effort);
        }
        inertias.rotors.iter().for_each(|(p, k, rotor)| explicit[k * count + p] += rotor * a_now[*k]);
    }
}

/// Sees all nodes side by side, where the robot stands as they have it.
pub(super) fn see_all(abreast: &mut Abreast, model: &Model, nodes: &mut [NodeVariation]) {
    let (mut states, mut found) = (Vec::with_capacity(nodes.len()), Vec::with_capacity(nodes.len()));
    for node in nodes {
        let NodeVariation { q_now, v_now, a_now, slopes, efforts, readings, gradients, hessians, .. } = node;
        states.push([&q_now[..], v_now, a_now]);
        found.push(Found { slopes, efforts, readings, gradients, hessians });
    }
    abreast.see(model, &states, &mut found);
}

impl NodeVariation {
    /// What those elements measure, where the robot stands as the node has it and the velocities `own_v` move; kinematics are worked out for that.
    pub(super) fn measure_all(
        &mut self,
        (system, own_v): (&System, &[usize]),
        moves: &[bool],
        workspace: &mut Workspace,
        wanted: impl Fn(usize) -> bool,
    ) {
        let (node, model) = (self, &system.model);
        node.kinematics.update_velocity_of_moving(model, &node.q_now, &node.v_now, moves);
        let n = model.nv();
        let measured = node.gradients.iter_mut().zip(&mut node.hessians).zip(&mut node.readings);
        for (e, (element, (([gradient, bend], kept), told))) in system.elements.iter().zip(measured).enumerate() {
            if !wanted(e) {
                continue;
            }
            let mut reading = Reading::default();
            element.measure.read_into(model, &node.kinematics, gradient, &mut reading);
            *told = [reading.coordinate, reading.rate];
            element.measure.hessian_of_moving(model, &node.kinematics, moves, workspace, kept);
            // y'_b = Σ_a ∂(∂y/∂q_a)/∂q_b v_a.
            bend.fill(0.0);
            for &k in own_v {
                let (line, v) = (&kept[k * n..(k + 1) * n], node.v_now[k]);
                bend.iter_mut().zip(line).for_each(|(bend, h)| *bend += h * v);
            }
        }
    }

    /// Adds to the slopes what elements that pull with `force` and the resistances of joints have in them.
    pub(super) fn pull_and_resist(&mut self, (system, own_v): (&System, &[usize]), force: &[f64]) {
        let (slopes, n) = (&mut self.slopes, system.model.nv());
        for (force, hessian) in force.iter().zip(&self.hessians).filter(|(force, _)| **force != 0.0) {
            for &row in own_v {
                let line = row * n..(row + 1) * n;
                let bent = hessian[line.clone()].iter();
                slopes.d_q[line].iter_mut().zip(bent).for_each(|(slope, bent)| *slope += force * bent);
            }
        }
        add_tangents(system, &self.v_now, &mut slopes.d_v);
    }
}

/// What a seed adds to the equation of motion of which velocity of the extended robot, which moves with v at time t: of signals, of damping, and of
/// friction that does not stick.
pub(super) fn pushed(model: &Model, own_v: &[usize], seed: &Seed, (t, v): (f64, &[f64])) -> Option<(usize, f64)> {
    match seed {
        Seed::Drive { velocity, by } => Some((own_v[*velocity], -by.value(t))),
        Seed::Damping { joint, by } => {
            let (k, ratio, speed) = felt(model, *joint, v);
            Some((k, by * ratio * speed))
        }
        Seed::Friction { joint, by } => {
            let (k, ratio, speed) = felt(model, *joint, v);
            match model.friction_laws()[*joint] {
                FrictionLaw::Smooth { speed: width } => Some((k, by * ratio * (speed / width).tanh())),
                FrictionLaw::Sticking => None,
            }
        }
        _ => None,
    }
}

/// Velocity, ratio and speed of a joint of the extended robot.
pub(super) fn felt(model: &Model, joint: usize, v: &[f64]) -> (usize, f64, f64) {
    let (k, ratio) = (model.v_range(joint).start, model.followed(joint).map_or(1.0, |(_, ratio, _)| ratio));
    (k, ratio, ratio * v[k])
}
