//! What parameters change of places, inertias, gravity and what pushes joints, weighed by what counts of a step.

use super::step::{Plan, SolvedStep};
use crate::collocation::STAGES;
use crate::dynamics::{Abreast, Kinematics, Sought, Weights, Workspace, weigh_measure};
use crate::elements::Reading;
use crate::equations::variation::Variation;
use crate::equations::variation::seen::pushed;
use crate::system::System;
use crate::system::sensitivity::Sensitivity;
use std::sync::Arc;

/// The robot that parameters change.
#[derive(Debug)]
pub(super) struct Changed {
    system: Arc<System>,
    by: Arc<Sensitivity>,
    /// Of every coordinate and velocity of the run, which of its own it is.
    own_q: Vec<usize>,
    own_v: Vec<usize>,
    /// All its coordinates, at the start of the run.
    start: Vec<f64>,
    /// What moves places: velocity, parameter, by how much.
    placed: Vec<(usize, usize, f64)>,
    /// Parameters of the changes of inertias and gravity.
    inertias: Vec<usize>,
    /// Parameter, velocity, and by how much its rotor changes.
    rotors: Vec<(usize, usize, f64)>,
    /// Parameters, and which of their seeds push a joint.
    pushes: Vec<(usize, usize)>,
    /// Elements that are no lines.
    others: Vec<usize>,
}

impl Changed {
    pub(super) fn of(variation: &Variation) -> Self {
        let Variation { system, by, own_v, inertias, placed, pushes, coordinates, room, .. } = variation;
        let is_other = |e: &usize| room.abreast.sought.lines.iter().all(|(line, _)| line != e);
        Self {
            system: system.clone(),
            by: by.clone(),
            own_q: coordinates.own.clone(),
            own_v: own_v.clone(),
            start: coordinates.values.clone(),
            placed: placed.clone(),
            inertias: inertias.parameters().collect(),
            rotors: inertias.rotors.clone(),
            pushes: pushes.clone(),
            others: (0..system.elements.len()).filter(is_other).collect(),
        }
    }

    /// Every parameter of these.
    pub(super) fn each_parameter(&self) -> impl Iterator<Item = usize> + '_ {
        let of_rotors = self.rotors.iter().map(|(p, ..)| p);
        let of_robot = self.inertias.iter().chain(of_rotors).chain(self.placed.iter().map(|(_, p, _)| p));
        of_robot.chain(self.pushes.iter().map(|(p, _)| p)).copied()
    }

    fn weighs_robot(&self) -> bool {
        !self.placed.is_empty() || !self.inertias.is_empty()
    }
}

/// Room to weigh in.
#[derive(Debug)]
pub(super) struct Weighing {
    abreast: Abreast,
    /// q, v and a of the start and of the stages.
    states: Vec<[Vec<f64>; 3]>,
    weights: Vec<f64>,
    sums: Vec<f64>,
    /// Of what is no line: weights, and ∂y/∂q and ∂²y/∂q².
    of_measure: Vec<f64>,
    kinematics: Kinematics,
    workspace: Workspace,
    measured: [Vec<f64>; 2],
}

impl Weighing {
    pub(super) fn of(plan: &Plan) -> Self {
        let Changed { system, own_v, start, by, .. } = &plan.changed;
        let (model, n) = (&system.model, system.model.nv());
        let inertias = crate::equations::variation::inertias::Inertias::of(by);
        let sought = Sought {
            moves: (0..n).map(|k| own_v.contains(&k)).collect(),
            links: inertias.links(),
            fields: inertias.fields(),
            lines: super::alone::lines(system),
        };
        Self {
            abreast: Abreast::new(model, sought),
            states: vec![[start.clone(), vec![0.0; n], vec![0.0; n]]; STAGES + 1],
            weights: Vec::new(),
            sums: Vec::new(),
            of_measure: Vec::new(),
            kinematics: Kinematics::new(model),
            workspace: Workspace::new(model),
            measured: [vec![0.0; n], vec![0.0; n * n]],
        }
    }

    /// Adds to the `sum` of each parameter, M numbers each, what it changes of the step where what is unbalanced at the stages counts `unbalanced`, and
    /// the columns of each element count `columns`.
    pub(super) fn weigh(
        &mut self,
        step: &SolvedStep,
        (unbalanced, columns, count): (&[f64], &[Vec<f64>], usize),
        sum: &mut [f64],
    ) {
        let changed = &step.plan.changed;
        let Changed { system, by, own_q, own_v, .. } = changed;
        let (model, own) = (&system.model, own_v.len());
        for (numbers, [q, v, a]) in step.motion().zip(&mut self.states) {
            let [own_of_q, own_of_v, own_of_a] = numbers;
            own_q.iter().zip(own_of_q).for_each(|(k, value)| q[*k] = *value);
            own_v
                .iter()
                .zip(own_of_v.iter().zip(own_of_a))
                .for_each(|(k, values)| (v[*k], a[*k]) = (*values.0, *values.1));
        }
        let mut add = |p: usize, factor: f64, numbers: &[f64]| {
            sum[p * count..][..count].iter_mut().zip(numbers).for_each(|(sum, number)| *sum += factor * number);
        };
        let of_stage = |i: usize, k: usize| {
            let r = own_v.iter().position(|own| *own == k).map_or(0, |r| i * own + r);
            &unbalanced[r * count..][..count]
        };
        for (i, [_, v, a]) in self.states[1..].iter().enumerate() {
            for (p, which) in &changed.pushes {
                let at = (step.times[i], &v[..]);
                if let Some((k, value)) = pushed(model, own_v, &by.parameters[*p].seeds[*which], at) {
                    add(*p, value, of_stage(i, k));
                }
            }
            changed.rotors.iter().for_each(|(p, k, rotor)| add(*p, rotor * a[*k], of_stage(i, *k)));
        }
        if !changed.weighs_robot() {
            return;
        }
        let n = model.nv();
        let width = self.abreast.sought.weights(count);
        self.weights.clear();
        self.weights.resize((STAGES + 1) * width, 0.0);
        let of_measure = |i: usize, e: usize, into: &mut [f64]| {
            into[..count].copy_from_slice(&columns[e][i * count..][..count]);
            into[count..2 * count].copy_from_slice(&columns[e][(STAGES + 1 + i) * count..][..count]);
            into[2 * count] = i.checked_sub(1).map_or(0.0, |stage| step.force(stage)[e]);
        };
        for (i, row) in self.weights.chunks_exact_mut(width).enumerate() {
            if let Some(stage) = i.checked_sub(1) {
                for (r, k) in own_v.iter().enumerate() {
                    row[k * count..][..count].copy_from_slice(&unbalanced[(stage * own + r) * count..][..count]);
                }
            }
            let of_lines = row[n * count..].chunks_exact_mut(2 * count + 1);
            self.abreast.sought.lines.iter().zip(of_lines).for_each(|((e, _), into)| of_measure(i, *e, into));
        }
        self.sums.clear();
        self.sums.resize(self.abreast.sought.sums(count), 0.0);
        let states: Vec<_> = self.states.iter().map(|state| state.each_ref().map(Vec::as_slice)).collect();
        self.abreast.weigh(model, &states, &Weights { count, rows: &self.weights }, &mut self.sums);
        let moves = &self.abreast.sought.moves;
        if !changed.others.is_empty() && !changed.placed.is_empty() {
            self.of_measure.resize(2 * count + 1, 0.0);
            for (i, [q, v, _]) in self.states.iter().enumerate() {
                self.kinematics.update_velocity_of_moving(model, q, v, moves);
                for e in &changed.others {
                    let ([gradient, hessian], measure) = (&mut self.measured, &system.elements[*e].measure);
                    measure.read_into(model, &self.kinematics, gradient, &mut Reading::default());
                    measure.hessian_of_moving(model, &self.kinematics, moves, &mut self.workspace, hessian);
                    of_measure(i, *e, &mut self.of_measure);
                    let own = &self.weights[i * width..][..n * count];
                    weigh_measure((moves, v, own), &self.of_measure, [gradient, hessian], &mut self.sums[..n * count]);
                }
            }
        }
        for (k, p, by) in &changed.placed {
            add(*p, *by, &self.sums[k * count..][..count]);
        }
        for (p, sums) in changed.inertias.iter().zip(self.sums[n * count..].chunks_exact(count)) {
            add(*p, 1.0, sums);
        }
    }
}
