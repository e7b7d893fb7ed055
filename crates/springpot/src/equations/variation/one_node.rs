//! What parameters change over a step of one size, of one stage: what the laws are asked at its node, and what rows and the ledger are told behind it.

use super::{ElementVariation, ROW, Variation};
use crate::collocation::{RADAU_NODES, STAGES};
use crate::equations::assembly::Equations;
use crate::equations::evaluate::Evaluation;
use crate::equations::node::Node;
use crate::equations::resistance::sign;
use crate::law::Response;
use crate::system::sensitivity::{Seed, Sensitivity, SensitivityError};
use crate::system::{Action, System};

/// The stage of a step, among the nodes; that at its end is [`STAGES`].
pub(crate) const STAGE: usize = 1;

/// What is known of steps of one size.
#[derive(Debug)]
pub(super) struct OneSize {
    /// The direction in which each velocity of the run slides against friction that sticks in the step, 0 where it is held.
    sliding: Vec<f64>,
    /// Whether what changes of the accelerations at the start and at the end of the step is known.
    pub(super) accelerated: [bool; 2],
}

/// Where a step of one size takes its elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Told {
    /// At the stage, which is its end.
    End,
    /// The mean stroke, and the rate from end to end.
    Mean,
}

impl OneSize {
    /// # Errors
    /// What such steps go over, so that nothing tells its derivatives.
    pub(super) fn new(system: &System, by: &Sensitivity) -> Result<Self, SensitivityError> {
        let unknown = |what: &str| Err(SensitivityError::Unknown { what: format!("{what} in steps of one size") });
        let mut seeds = by.parameters.iter().flat_map(|parameter| &parameter.seeds);
        if seeds.any(|seed| matches!(seed, Seed::Switch { .. })) {
            return unknown("the time at which a function jumps");
        }
        if system.events.iter().any(|event| matches!(event.action, Action::Set(_))) {
            return unknown("events that set something");
        }
        Ok(Self { sliding: vec![0.0; system.model.nv()], accelerated: [false; 2] })
    }

    /// The direction in which velocity `k`, which is `v` there, slides at node `i`.
    pub(super) fn sliding(&self, i: usize, k: usize, v: f64) -> f64 {
        if i == STAGE { self.sliding[k] } else { sign(v) }
    }
}

impl Variation {
    /// Sees where the step starts.
    pub(super) fn see_start_of_one(&mut self, equations: &Equations, start: Node) {
        self.look(0, start);
        self.aim(equations, 0);
        (0..self.elements.len()).for_each(|e| self.measure(e, 0));
    }

    /// Sees the stage of a step, where the elements pull with `force` and velocities slide in these directions, and where the step ends.
    pub(crate) fn see_stage(
        &mut self,
        equations: &Equations,
        [stage, end]: [Node; 2],
        force: &[f64],
        sliding: impl Iterator<Item = f64>,
    ) {
        if let Some(OneSize { sliding: own, accelerated: [_, at_end] }) = &mut self.one_size {
            own.clear();
            own.extend(sliding);
            *at_end = false;
        }
        self.see(equations, STAGE, stage, force);
        self.steer(STAGE, equations, force);
        self.look(STAGES, end);
        self.aim(equations, STAGES);
    }

    /// Where errors are remembered, sees where references are at node `i`.
    fn aim(&mut self, equations: &Equations, i: usize) {
        if equations.control.as_ref().is_some_and(|run| run.remembers()) {
            let still = vec![0.0; self.elements.len()];
            self.steer(i, equations, &still);
        }
    }

    /// Works out what is told of the elements over a step of size `h` whose stage and end move as the nodes have it.
    pub(crate) fn tell_stage(&mut self, told: Told, h: f64) {
        let count = self.count();
        for e in 0..self.elements.len() {
            self.measure(e, STAGES);
            match told {
                Told::End => self.measure(e, STAGE),
                Told::Mean => {
                    let ElementVariation { stroke, rate, .. } = &mut self.elements[e];
                    for p in 0..count {
                        let [from, at, to] = [0, STAGE, STAGES].map(|i| i * count + p);
                        rate[at] = (stroke[to] - stroke[from]) / h;
                        stroke[at] = 0.5 * (stroke[from] + stroke[to]);
                    }
                }
            }
        }
    }

    /// What changes of the force of element `e` at the stage, parameter by parameter.
    pub(crate) fn stage_force(&self, response: &Response, e: usize, force: &mut [f64]) {
        let (count, element) = (self.count(), &self.elements[e]);
        let (by_stroke, by_rate) = (response.d_stroke[0][0], response.d_rate[0][0]);
        let own = STAGE * count..(STAGE + 1) * count;
        let told = element.stroke[own.clone()].iter().zip(&element.rate[own]).zip(&element.force);
        for (force, ((x, rate), explicit)) in force.iter_mut().zip(told) {
            *force = explicit + by_stroke * x + by_rate * rate;
        }
    }

    /// Works out what the ledger is told of a step of size `h` from `from` to `to`: strokes on a straight line, rates of the cubic through both ends.
    pub(crate) fn tell_ledger(&mut self, [from, to]: [f64; 2], h: f64) {
        let count = self.count();
        for ElementVariation { stroke, rate, .. } in &mut self.elements {
            for (c, i) in RADAU_NODES.into_iter().zip(1..STAGES) {
                for p in 0..count {
                    let [start, at, end] = [0, i, STAGES].map(|i| i * count + p);
                    let travel = stroke[end] - stroke[start];
                    stroke[at] = stroke[start] + c * travel;
                    rate[at] = 6.0 * c * (1.0 - c) * travel / h
                        + (1.0 - c) * (1.0 - 3.0 * c) * rate[start]
                        + c * (3.0 * c - 2.0) * rate[end];
                }
            }
        }
        for (c, i) in RADAU_NODES.into_iter().zip(1..) {
            self.look_at_inputs(i, if c == 1.0 { to } else { from + c * h });
        }
    }

    /// What changes of the accelerations that solve the equations of motion at the start (0) or at the end (1) of the step, where the run has those of
    /// `at`: the velocities `free` follow from forces, but those that `rests` says.
    pub(crate) fn accelerate_end(
        &mut self,
        equations: &Equations,
        end: usize,
        at: &Evaluation,
        (free, rests): (&[usize], impl Fn(usize) -> bool),
    ) {
        let (i, theta) = (end * STAGES, (end == 1).then_some(1.0));
        let Some(OneSize { accelerated, .. }) = &mut self.one_size else { return };
        if std::mem::replace(&mut accelerated[end], true) {
            return;
        }
        let moving: Vec<usize> = free.iter().copied().filter(|k| !rests(*k)).collect();
        let free = self.of_run(&moving);
        if free.is_empty() {
            return self.nodes[i].a.fill(0.0);
        }
        let bank = &equations.bank;
        let force = (0..self.elements.len()).map(|e| match end {
            0 => bank.now(e, &at.elements[e].point(at.t)).map_or(0.0, |now| now.finite_force()),
            _ => bank.end(e).force(),
        });
        let force: Vec<f64> = force.collect();
        self.see(equations, i, Node { t: at.t, q: &at.q, v: &at.v, a: &at.a }, &force);
        self.steer(i, equations, &force);
        for e in 0..self.elements.len() {
            self.measure(e, i);
            self.observe(equations, (e, i), theta, &at.elements[e].point(at.t));
        }
        self.solve_node(i, &free);
    }

    /// What changes of the motion at θ of a step of size `h`, into node [`ROW`]: as rows have it between its ends, whose accelerations are known, but that
    /// of the stage where the step starts with none.
    pub(crate) fn go_between(&mut self, theta: f64, h: f64, has_first: bool) {
        let [start, nodes @ ..] = &mut self.nodes;
        let [stage, .., end, row] = nodes;
        let rest = 1.0 - theta;
        let first = if has_first { &start.a } else { &stage.a };
        for block in 0..row.q.len() {
            let travel = end.q[block] - start.q[block];
            let bent = theta * (rest * rest * h * start.v[block] - theta * rest * h * end.v[block]);
            row.q[block] = start.q[block] + bent + theta * theta * (3.0 - 2.0 * theta) * travel;
            row.v[block] = rest * start.v[block] + theta * end.v[block];
            row.a[block] = rest * first[block] + theta * end.a[block];
        }
    }

    /// The motion changes at a row as at the end of the step.
    pub(crate) fn take_end(&mut self) {
        let [.., end, row] = &mut self.nodes;
        row.q.copy_from_slice(&end.q);
        row.v.copy_from_slice(&end.v);
        row.a.copy_from_slice(&end.a);
    }
}

const _: () = assert!(STAGE < STAGES && STAGES < ROW);
