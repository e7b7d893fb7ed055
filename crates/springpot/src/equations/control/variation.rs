//! What parameters change of what follows from the state: exact slopes at the nodes themselves, of the branches that the step is on.
//!
//! All is about the robot of [`Sensitivity::extended`], in blocks of one number for each parameter.

use super::eye::{Eye, Read, Slopes};
use super::mode::{Bound, Guard, Mode, Slew};
use super::term::{Integrand, TermVariation};
use super::{ControlRun, Target};
use crate::collocation::STAGES;
use crate::control::{
    Aim, At, ControllerVariation, Feedback, FeedbackSlope, RobotChange, Scratch, Sense, TorqueSlopes,
};
use crate::dynamics::{Kinematics, RneaDerivatives, point_jacobian, point_jacobian_rate};
use crate::fractional::KernelError;
use crate::model::Model;
use crate::sensitivity::{Seed, Sensitivity, SensitivityError};
use crate::signal::Jet;
use crate::system::System;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The start, the nodes and a row.
const PLACES: usize = STAGES + 2;

/// The node of a row.
const ROW: usize = STAGES + 1;

/// What is asked of one node of the variation of a run.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(crate) t: f64,
    /// q, v and a of the extended robot.
    pub(crate) motion: [&'a [f64]; 3],
    pub(crate) kinematics: &'a Kinematics,
    /// Coordinate y and rate y' of every element, and what changes of its stroke where the robot stays.
    pub(crate) readings: &'a [Read],
    pub(crate) rests: &'a dyn Fn(usize) -> &'a [f64],
}

/// What parameters change of control.
#[derive(Debug)]
pub(crate) struct ControlVariation {
    by: Arc<Sensitivity>,
    system: Arc<System>,
    run_model: Arc<Model>,
    own_q: Vec<usize>,
    own_v: Vec<usize>,
    /// The law of the controller, of the extended robot.
    law: Option<Box<dyn ControllerVariation>>,
    /// Whether its reference says itself where the gripper is to be; else that follows from the joints.
    leads_gripper: bool,
    joints: Vec<JointVariation>,
    terms: Vec<TermVariation>,
    laws: Vec<LawSlopes>,
    /// Expressions that are sampled.
    sampled: Vec<LawSlopes>,
    /// Of what sampled laws said last: torques (nv blocks), and inputs.
    held: Held,
    nodes: [NodeControl; PLACES],
    scratch: Scratch,
    /// Of the extended robot, where the reference has it.
    wanted: Kinematics,
    aims: [Aim; 2],
    /// What branches of joints were left, and from where.
    left: Vec<Left>,
}

/// What changes of what sampled laws said last.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Held {
    /// Of the torques, a block for each velocity of the run, or nothing.
    pub(super) torques: Vec<f64>,
    /// Of inputs: which, and a block.
    pub(super) inputs: Vec<(usize, usize, Vec<f64>)>,
}

/// On which side of its limits a force of a sampled controller is: of its rate, and of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sides {
    pub(super) rate: i8,
    pub(super) force: i8,
}

/// A force that jumps at a time that parameters move.
#[derive(Debug)]
pub(crate) struct Jump {
    /// δt*.
    pub(crate) moved: Vec<f64>,
    /// The column that says what jumps.
    pub(crate) what: String,
    /// The element whose input it is, where it is one.
    pub(crate) element: Option<usize>,
}

/// A joint that was on another branch.
#[derive(Debug)]
struct Left {
    joint: usize,
    mode: Mode,
    /// Of its force before the last limit.
    shaped: Vec<f64>,
    /// Of the time at which it was left.
    moved: Vec<f64>,
}

/// A joint that the controller drives.
#[derive(Debug, Clone)]
struct JointVariation {
    /// Its velocity in the run, and in the extended robot.
    velocity: usize,
    row: usize,
    /// Of the largest force and of how fast it may change.
    limit: Vec<f64>,
    rate_limit: Vec<f64>,
    /// Of the force that goes at its largest rate, as seen from its beginning.
    from: Vec<f64>,
    /// Its branch since the last change.
    mode: Mode,
}

/// An expression.
#[derive(Debug, Clone)]
struct LawSlopes {
    law: Feedback,
    /// What it sees of the extended robot.
    senses: Vec<Sense>,
    target: Target,
    /// By the numbers of its own that each parameter moves.
    own: Vec<Vec<FeedbackSlope>>,
}

/// The start, a node or a row.
#[derive(Debug, Clone, Default)]
struct NodeControl {
    /// Of what acts, the terms apart: ∂τ/∂q and ∂τ/∂v, and where the motion stays.
    slopes: TorqueSlopes,
    explicit: Vec<f64>,
    /// The same of the forces that the controller wants, before all limits.
    wanted: TorqueSlopes,
    wanted_explicit: Vec<f64>,
    /// Of every velocity, whether its actuator takes the forces of the elements off.
    relieved: Vec<bool>,
    /// Of the terms, where the motion changes as it does.
    pushed: Vec<f64>,
    /// Where the reference wants each joint, and how fast.
    aims: Vec<[Vec<f64>; 2]>,
    /// Where the gripper is wanted, and what changes of that, a block for each coordinate.
    gripper: [f64; 3],
    gripper_moves: [Vec<f64>; 3],
    /// Errors of the joints.
    errors: Vec<[f64; 2]>,
    /// How fast the forces change that are wanted of them, terms apart.
    drifts: Vec<f64>,
    /// Of every expression for an input: ∂u/∂q and ∂u/∂v, and where the motion stays.
    inputs: Vec<(usize, usize, Slopes, Vec<f64>)>,
}

/// What outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct ControlVariationState {
    terms: Vec<TermVariation>,
    from: Vec<Vec<f64>>,
    modes: Vec<Mode>,
}

impl ControlVariation {
    /// Of a run that is controlled by `run`, differentiated by `by`.
    ///
    /// # Errors
    /// What has no derivative.
    pub(crate) fn new(
        run: &ControlRun,
        system: &System,
        by: &Arc<Sensitivity>,
        extended: &Arc<System>,
        [own_q, own_v]: [&[usize]; 2],
    ) -> Result<Box<Self>, SensitivityError> {
        let unknown = |what: String| Err(SensitivityError::Unknown { what });
        let (model, count) = (&extended.model, by.parameters.len());
        let controller = run.control.controller.as_ref();
        let law = match controller {
            None => None,
            Some(controlled) => match controlled.law.variation() {
                None => return unknown(format!("the controller {:?}", controlled.law)),
                Some(law) => {
                    for number in by.numbers() {
                        if !law.has(number) {
                            return unknown(format!("`{}` of the controller", number.name));
                        }
                    }
                    Some(law.on(own_v, model.nv()))
                }
            },
        };
        if run.compensates && run.joints.iter().any(|joint| joint.limit.rate.is_finite()) {
            return unknown("limits of rates of forces that take the elements off".to_owned());
        }
        if !run.knows_nodes {
            return unknown("control in steps of one size".to_owned());
        }
        let each = |of: &dyn Fn(&Seed) -> f64| -> Vec<f64> {
            by.parameters.iter().map(|parameter| parameter.seeds.iter().map(of).sum()).collect()
        };
        let joints = run.joints.iter().map(|joint| {
            let k = joint.velocity;
            JointVariation {
                velocity: k,
                row: own_v[k],
                limit: each(&|seed| match seed {
                    Seed::Limit { velocity, by } if *velocity == k => *by,
                    _ => 0.0,
                }),
                rate_limit: each(&|seed| match seed {
                    Seed::RateLimit { velocity, by } if *velocity == k => *by,
                    _ => 0.0,
                }),
                from: vec![0.0; count],
                mode: joint.mode,
            }
        });
        let joints: Vec<_> = joints.collect();
        if let Some(law) = run.laws.iter().find(|law| law.stretches) {
            return unknown(format!("a temperature by feedback that stretches, {}", law.law.expression()));
        }
        let laws = run.laws.iter().map(|law| LawSlopes::new(&law.law, law.target, by, [own_q, own_v]));
        let laws = laws.collect();
        let torques = run.control.torques.iter().filter(|own| own.sampling.is_some());
        let torques = torques.map(|own| (&own.law, Target::Torque(own.velocity)));
        let inputs = run.control.inputs.iter().filter(|own| own.sampling.is_some());
        let inputs = inputs.map(|own| (&own.law, Target::Input(own.element, own.input)));
        let sampled: Vec<LawSlopes> =
            torques.chain(inputs).map(|(law, target)| LawSlopes::new(law, target, by, [own_q, own_v])).collect();
        if sampled.iter().any(|law| law.senses.iter().any(|sense| matches!(sense, Sense::Derivative(_)))) {
            return unknown("D^alpha x that feedback samples".to_owned());
        }
        let square = || TorqueSlopes { d_q: vec![0.0; model.nv().pow(2)], d_v: vec![0.0; model.nv().pow(2)] };
        let blocks = || vec![0.0; model.nv() * count];
        let node = NodeControl {
            slopes: square(),
            explicit: blocks(),
            wanted: square(),
            wanted_explicit: blocks(),
            relieved: vec![false; model.nv()],
            pushed: blocks(),
            aims: joints.iter().map(|_| [vec![0.0; count], vec![0.0; count]]).collect(),
            gripper: [f64::NAN; 3],
            gripper_moves: std::array::from_fn(|_| vec![0.0; count]),
            errors: vec![[0.0; 2]; joints.len()],
            drifts: vec![0.0; joints.len()],
            inputs: Vec::new(),
        };
        let [q, v] = [model.neutral(), vec![0.0; model.nv()]];
        let aim = Aim { q, a: v.clone(), v, gripper: [[0.0; 3]; 2] };
        Ok(Box::new(Self {
            by: by.clone(),
            run_model: system.model.clone(),
            own_q: own_q.to_vec(),
            own_v: own_v.to_vec(),
            law,
            leads_gripper: false,
            joints,
            terms: Vec::new(),
            laws,
            sampled,
            held: Held::default(),
            nodes: std::array::from_fn(|_| node.clone()),
            scratch: Scratch::new(model),
            wanted: Kinematics::new(model),
            aims: [Aim::default(), aim],
            left: Vec::new(),
            system: extended.clone(),
        }))
    }

    fn count(&self) -> usize {
        self.by.parameters.len()
    }

    /// Elements and inputs that follow from the state.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.laws.iter().chain(&self.sampled).filter_map(|law| match law.target {
            Target::Input(e, i) => Some((e, i)),
            Target::Torque(_) => None,
        })
    }

    /// Begins what changes of the terms, where the start was seen.
    ///
    /// # Errors
    /// An order that has no derivative.
    pub(crate) fn begin(&mut self, run: &ControlRun, at: [&[f64]; 2]) -> Result<(), SensitivityError> {
        let count = self.count();
        self.terms.clear();
        for term in &run.terms {
            let (mut gain, mut order) = (vec![0.0; count], vec![0.0; count]);
            let variation = run.controlled().and_then(|controlled| controlled.law.variation());
            for (p, parameter) in self.by.parameters.iter().enumerate() {
                for seed in &parameter.seeds {
                    let (Seed::Controller { number, by }, Some(law)) = (seed, variation) else { continue };
                    for change in law.terms_by_number(number) {
                        if change.term.velocity == term.law.velocity
                            && (change.term.order < 0.0) == (term.law.order < 0.0)
                        {
                            gain[p] += by * change.gain;
                            order[p] += by * change.order;
                        }
                    }
                }
            }
            let place = self.joints.iter().position(|joint| joint.velocity == term.law.velocity);
            let Some(place) = place else { continue };
            let error = self.error(0, place, at).0;
            let begun = TermVariation::begin(term, gain, &order, &error);
            self.terms.push(begun.map_err(|error: KernelError| SensitivityError::Unknown {
                what: format!("the controller: {error}"),
            })?);
        }
        Ok(())
    }

    /// What changes of the error of a joint and of its rate at node `i`, where coordinates and velocities change by these blocks.
    fn error(&self, i: usize, joint: usize, [q, v]: [&[f64]; 2]) -> (Vec<f64>, Vec<f64>) {
        let (count, row) = (self.count(), self.joints[joint].row);
        let [place, speed] = &self.nodes[i].aims[joint];
        let off = |aim: &[f64], own: &[f64]| -> Vec<f64> {
            aim.iter().zip(&own[row * count..]).map(|(aim, own)| aim - own).collect()
        };
        (off(place, q), off(speed, v))
    }

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
        let asked = At { model, gripper: site, t: at.t, q, v, kinematics: at.kinematics, aim };
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

    /// Of every expression for an input at node `i`: ∂u/∂q and ∂u/∂v, and what changes of u where the motion stays.
    pub(crate) fn input_slopes(&self, i: usize) -> impl Iterator<Item = (usize, usize, &Slopes, &[f64])> {
        self.nodes[i].inputs.iter().map(|(e, input, by_state, own)| (*e, *input, by_state, &own[..]))
    }

    /// What the terms and the errors do where the motion at the start and at the nodes changes by the blocks `motion` of q and v.
    pub(crate) fn follow(&mut self, run: &ControlRun, motion: [[&[f64]; 2]; STAGES + 1]) {
        for m in 0..self.terms.len() {
            let Some((joint, mode)) = self.joint_of(run, m) else { continue };
            for (i, motion) in motion.into_iter().enumerate() {
                let (errors, rates) = self.error(i, joint, motion);
                for (p, error) in errors.into_iter().zip(rates).enumerate() {
                    self.terms[m].set_error(i, p, error.into());
                }
            }
            self.terms[m].follow(&run.terms[m], mode.integrand);
            if mode.integrand == Integrand::Slides && run.joints[joint].integral == Some(m) {
                motion.into_iter().enumerate().for_each(|(i, motion)| self.slide(i, joint, run, motion));
            }
        }
    }

    /// The integral of a joint keeps its force at the limit at node `i`, whatever else changes of it.
    fn slide(&mut self, i: usize, joint: usize, run: &ControlRun, [q, v]: [&[f64]; 2]) {
        let (Some(m), Bound::At(sign)) = (run.joints[joint].integral, run.joints[joint].mode.bound) else { return };
        let (n, count, node, own) = (self.system.model.nv(), self.count(), &self.nodes[i], &self.joints[joint]);
        let along = |slopes: &[f64], blocks: &[f64], p: usize| -> f64 {
            slopes[own.row * n..][..n].iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        let others = |p: usize| {
            let still = node.wanted_explicit[own.row * count + p];
            still + along(&node.wanted.d_q, q, p) + along(&node.wanted.d_v, v, p)
        };
        let wanted = (0..count).map(|p| f64::from(sign) * own.limit[p] - others(p)).collect::<Vec<_>>();
        self.terms[m].slide(i, &run.terms[m], &wanted);
    }

    /// The joint that term `m` belongs to, and what it does there.
    fn joint_of(&self, run: &ControlRun, m: usize) -> Option<(usize, Mode)> {
        let velocity = run.terms[m].law.velocity;
        let joint = run.joints.iter().position(|joint| joint.velocity == velocity)?;
        Some((joint, run.joints[joint].mode))
    }

    /// Asks the terms what changes of them where the motion at the nodes stays.
    pub(crate) fn ask(&mut self, run: &ControlRun) {
        self.terms.iter_mut().zip(&run.terms).for_each(|(own, term)| own.ask(term));
    }

    /// Works out what the terms do at node `i` (from 1), as [`Self::follow`] had the motion; also to forces that do not follow where `all` are asked.
    pub(crate) fn push(&mut self, i: usize, run: &ControlRun, all: bool) {
        let count = self.count();
        self.nodes[i].pushed.fill(0.0);
        for m in 0..self.terms.len() {
            let Some((joint, _)) = self.joint_of(run, m).filter(|(_, mode)| all || run.is_continuous && mode.follows())
            else {
                continue;
            };
            let row = self.joints[joint].row;
            for p in 0..count {
                self.nodes[i].pushed[row * count + p] += self.terms[m].force(&run.terms[m], i, p);
            }
        }
    }

    /// The same at the start (0), or at a row, which is at θ of the step at hand or between two; the motion changes there by the blocks of q and v.
    pub(crate) fn push_at(
        &mut self,
        i: usize,
        theta: Option<f64>,
        (run, all): (&ControlRun, bool),
        motion: [&[f64]; 2],
    ) {
        let count = self.count();
        self.nodes[i].pushed.fill(0.0);
        for m in 0..self.terms.len() {
            let Some((joint, mode)) =
                self.joint_of(run, m).filter(|(_, mode)| all || run.is_continuous && mode.follows())
            else {
                continue;
            };
            let changes = self.error(i, joint, motion);
            let (now, changes) = (self.nodes[i].errors[joint], [&changes.0[..], &changes.1[..]]);
            let row = self.joints[joint].row;
            let out = &mut self.nodes[i].pushed[row * count..][..count];
            let (term, own) = (&run.terms[m], &self.terms[m]);
            match theta {
                Some(theta) => own.add_at(term, theta, now, changes, mode.integrand, out),
                None => own.add_now(term, now, changes, mode.integrand, out),
            }
        }
    }

    /// What the terms add to the force on velocity `row` of the extended robot at node `i` by parameter `p`.
    pub(crate) fn pushed(&self, i: usize, row: usize, p: usize) -> f64 {
        self.nodes[i].pushed[row * self.count() + p]
    }

    /// Whether the actuator of velocity `row` takes the forces of the elements off at node `i`.
    pub(crate) fn relieves(&self, i: usize, row: usize) -> bool {
        self.nodes[i].relieved[row]
    }

    /// Where the gripper is wanted at the row, and what changes of that, a block for each coordinate.
    pub(crate) fn gripper(&self) -> ([f64; 3], &[Vec<f64>; 3]) {
        (self.nodes[ROW].gripper, &self.nodes[ROW].gripper_moves)
    }

    /// What changes of the force on velocity `row` at the row, the compensation of elements apart, where the motion changes by these blocks.
    pub(crate) fn torque(&self, row: usize, p: usize, [q, v]: [&[f64]; 2]) -> f64 {
        let (n, count, node) = (self.system.model.nv(), self.count(), &self.nodes[ROW]);
        let along = |slopes: &[f64], blocks: &[f64]| -> f64 {
            slopes[row * n..][..n].iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        let own = node.explicit[row * count + p] + node.pushed[row * count + p];
        along(&node.slopes.d_q, q) + along(&node.slopes.d_v, v) + own
    }

    /// Takes the step into what changes of the terms, where the motion at the start and at the nodes changes by these blocks; the run has not taken
    /// it yet.
    pub(crate) fn commit(&mut self, run: &ControlRun, motion: [[&[f64]; 2]; STAGES + 1]) {
        if run.joints.iter().any(|joint| joint.mode.integrand == Integrand::Slides) {
            // What integrals take that keep forces at their limits is known once the step is solved.
            self.follow(run, motion);
        }
        self.terms.iter_mut().zip(&run.terms).for_each(|(own, term)| own.commit(term));
        self.nodes.swap(0, STAGES);
    }

    /// Looks at what `run` is about to leave at node `i`, where the motion changes by these blocks: by how much parameters move the times of jumps of
    /// forces, and what jumps.
    pub(crate) fn foresee(&mut self, i: usize, run: &ControlRun, at: Place, motion: [&[f64]; 2]) -> Vec<Jump> {
        let mut found = Vec::new();
        if i > 0 {
            self.push(i, run, true);
        } else {
            self.push_at(i, None, (run, true), motion);
        }
        for &guard in run.leaves() {
            match guard {
                Guard::Branch { law, bit } if self.laws[law].law.expression().jumps_at(bit) => {
                    let target = self.laws[law].target;
                    let what = target.column(&self.system);
                    let element = if let Target::Input(e, _) = target { Some(e) } else { None };
                    let moved = self.moved((law, bit), run, at, motion);
                    found.push(Jump { moved, what, element });
                }
                Guard::Branch { .. } => {}
                Guard::Reaches { joint, .. }
                | Guard::Returns { joint }
                | Guard::Turns { joint }
                | Guard::Empties { joint }
                | Guard::Fills { joint }
                | Guard::Outruns { joint, .. }
                | Guard::Catches { joint } => {
                    let mode = run.joints[joint].mode;
                    let shaped = self.shaped(i, joint, mode, at.t, motion);
                    let own = &self.joints[joint];
                    let drift = self.drift(i, joint, run);
                    let moved = match (guard, mode.bound, mode.slew) {
                        (Guard::Reaches { sign, .. }, ..) | (Guard::Returns { .. }, Bound::At(sign), _) => {
                            let over = shaped.iter().zip(&own.limit);
                            over.map(|(shaped, limit)| (f64::from(sign) * limit - shaped) / drift).collect()
                        }
                        (Guard::Catches { .. }, _, Slew::Goes { sign, .. }) => {
                            let follows = Mode { slew: Slew::Follows, ..mode };
                            let wanted = self.shaped(i, joint, follows, at.t, motion);
                            let rate = f64::from(sign) * run.joints[joint].limit.rate;
                            let off = shaped.iter().zip(&wanted);
                            off.map(|(shaped, wanted)| (shaped - wanted) / (drift - rate)).collect()
                        }
                        _ => vec![0.0; shaped.len()],
                    };
                    self.left.push(Left { joint, mode, shaped, moved });
                }
            }
        }
        found
    }

    /// By how much parameters move the time at which a kink of an expression is passed: δt* = −δγ/γ̇.
    fn moved(&self, (law, bit): (usize, u32), run: &ControlRun, at: Place, motion: [&[f64]; 2]) -> Vec<f64> {
        let (count, own, branch) = (self.count(), &self.laws[law], run.laws[law].branch);
        let [q, v, a] = at.motion;
        let read = |e: usize| at.readings[e];
        let eye = Eye { system: &self.system, t: at.t, q, v, kinematics: at.kinematics, element: &read };
        let jets: Vec<Jet> = own.senses.iter().map(|sense| eye.jet(*sense, a)).collect();
        let seen: Vec<f64> = jets.iter().map(|jet| jet.value).collect();
        let guard = |time: Jet, jets: &[Jet]| own.law.expression().guard_jet(branch, bit, time, jets);
        let rate = guard(Jet::time(at.t), &jets).map_or(0.0, |jet| jet.first);
        let (mut by_state, mut change) = ([vec![0.0; v.len()], vec![0.0; v.len()]], vec![0.0; count]);
        for (k, sense) in own.senses.iter().enumerate() {
            let alone = seen.iter().enumerate().map(|(j, value)| Jet {
                value: *value,
                first: if j == k { 1.0 } else { 0.0 },
                second: 0.0,
            });
            let alone: Vec<Jet> = alone.collect();
            let slope = guard(Jet::constant(at.t), &alone).map_or(0.0, |jet| jet.first);
            add_sense(&eye, *sense, slope, at, (&mut by_state, &mut change));
        }
        for (p, change) in change.iter_mut().enumerate() {
            *change += own.own[p].iter().map(|slope| slope.guard_on(branch, bit, at.t, &seen)).sum::<f64>();
            for (slopes, blocks) in by_state.iter().zip(motion) {
                *change += slopes.iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum::<f64>();
            }
            *change /= -rate;
        }
        change
    }

    /// How fast the force that is wanted of a joint changes at node `i`: at the end of the step, or at its start.
    fn drift(&self, i: usize, joint: usize, run: &ControlRun) -> f64 {
        let mut sum = self.nodes[i].drifts[joint];
        for term in run.terms.iter().filter(|term| term.law.velocity == self.joints[joint].velocity) {
            if term.law.order > -1.0 {
                sum = f64::NAN;
            }
            let runs = run.joints[joint].mode.integrand == Integrand::Runs;
            sum += if runs { term.law.gain * self.nodes[i].errors[joint][0] } else { 0.0 };
        }
        if sum.is_finite() { sum } else { run.drift(joint, if i == 0 { 0.0 } else { 1.0 }) }
    }

    /// What changes of the force of a joint before its last limit at node `i`, on a branch.
    fn shaped(&self, i: usize, joint: usize, mode: Mode, t: f64, [q, v]: [&[f64]; 2]) -> Vec<f64> {
        let (n, count, node, own) = (self.system.model.nv(), self.count(), &self.nodes[i], &self.joints[joint]);
        let along = |slopes: &[f64], blocks: &[f64], p: usize| -> f64 {
            slopes[own.row * n..][..n].iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        let of = |p: usize| match mode.slew {
            Slew::Goes { sign, since, .. } => own.from[p] + f64::from(sign) * (t - since) * own.rate_limit[p],
            Slew::Follows => {
                let still = node.wanted_explicit[own.row * count + p] + node.pushed[own.row * count + p];
                still + along(&node.wanted.d_q, q, p) + along(&node.wanted.d_v, v, p)
            }
        };
        (0..count).map(of).collect()
    }

    /// Goes onto the branches that `run` is on at t, from those that were left.
    ///
    /// # Errors
    /// Where that has no derivative.
    pub(crate) fn settle(&mut self, run: &ControlRun, t: f64, motion: [&[f64]; 2]) -> Result<(), SensitivityError> {
        let unknown = |what: &str| Err(SensitivityError::Unknown { what: format!("{what}, at t = {t} s") });
        for Left { joint, mode, shaped, moved } in std::mem::take(&mut self.left) {
            let (now, error) = (run.joints[joint].mode, self.nodes[0].errors[joint][0]);
            if let Some(m) = run.joints[joint].integral.filter(|_| now.integrand != mode.integrand) {
                let own = run.terms.iter().filter(|term| term.law.velocity == run.joints[joint].velocity);
                if own.count() > 1 && [mode, now].iter().any(|mode| mode.integrand == Integrand::Slides) {
                    return unknown("a fractional derivative of a controller beside an integral that keeps its limit");
                }
                if run.terms[m].law.order > -1.0 {
                    return unknown("a fractional integral of a controller that stops at its limit");
                }
                let taken = |mode: Mode| if mode.integrand == Integrand::Runs { error } else { 0.0 };
                match [mode.integrand, now.integrand] {
                    [_, Integrand::Slides] => self.slide(0, joint, run, motion),
                    [Integrand::Slides, _] => {}
                    _ => self.terms[m].jump(taken(mode) - taken(now), &moved),
                }
            }
            match (mode.slew, now.slew) {
                (Slew::Follows, Slew::Goes { .. }) => self.joints[joint].from = shaped,
                (Slew::Goes { sign: before, .. }, Slew::Goes { sign, .. }) if mode.slew != now.slew => {
                    let turn = f64::from(before - sign) * run.joints[joint].limit.rate;
                    let turned = shaped.iter().zip(&moved).map(|(shaped, moved)| shaped + turn * moved);
                    self.joints[joint].from = turned.collect();
                }
                _ => {}
            }
            self.joints[joint].mode = now;
        }
        for joint in 0..self.joints.len() {
            let (now, before) = (run.joints[joint].mode, self.joints[joint].mode);
            if now.slew != before.slew && now.slew != Slew::Follows {
                // The reference jumped.
                self.joints[joint].from = self.shaped(0, joint, before, t, motion);
            }
            self.joints[joint].mode = now;
        }
        Ok(())
    }

    /// From now on what sampled laws said changes so.
    pub(crate) fn hold(&mut self, held: &Held) {
        self.held.clone_from(held);
    }

    /// What changes of what the sampled expression for a target of the run says of the row that was seen, where elements pull with forces that change
    /// by `forces`, and the motion changes by these blocks of q, v and a.
    pub(crate) fn say(
        &self,
        target: Target,
        at: Place,
        forces: &dyn Fn(usize) -> (f64, Vec<f64>),
        [dq, dv, da]: [&[f64]; 3],
    ) -> Vec<f64> {
        let count = self.count();
        let target = target.of_robot(&self.own_v);
        let Some(law) = self.sampled.iter().find(|law| law.target == target) else { return vec![0.0; count] };
        let [q, v, a] = at.motion;
        let read = |e: usize| at.readings[e];
        let eye = Eye { system: &self.system, t: at.t, q, v, kinematics: at.kinematics, element: &read };
        let seen: Vec<f64> = law
            .senses
            .iter()
            .map(|sense| match *sense {
                Sense::Acceleration(k) => a[k],
                Sense::Force(e) => forces(e).0,
                sense => eye.value(sense),
            })
            .collect();
        let jets: Vec<Jet> = seen.iter().map(|value| Jet::constant(*value)).collect();
        let branch = law.law.expression().branch(at.t, &jets);
        let (mut slopes, mut said) = (Vec::new(), vec![0.0; count]);
        law.law.slopes_on(branch, at.t, &seen, &mut slopes);
        let mut by_state = [vec![0.0; v.len()], vec![0.0; v.len()]];
        let mut by_forces = vec![0.0; v.len()];
        for (sense, slope) in law.senses.iter().zip(&slopes).filter(|(_, slope)| **slope != 0.0) {
            match *sense {
                Sense::Acceleration(k) => by_forces[k] += slope,
                Sense::Force(e) => said.iter_mut().zip(forces(e).1).for_each(|(sum, own)| *sum += slope * own),
                sense => add_sense(&eye, sense, *slope, at, (&mut by_state, &mut said)),
            }
        }
        let [by_q, by_v] = &by_state;
        for (p, said) in said.iter_mut().enumerate() {
            for (slopes, blocks) in [(by_q, dq), (by_v, dv), (&by_forces, da)] {
                *said += slopes.iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum::<f64>();
            }
            *said += law.own[p].iter().map(|slope| slope.value_on(branch, at.t, &seen)).sum::<f64>();
        }
        said
    }

    /// The same of a sampled controller, whose forces are on these sides of their limits, by velocity of the run; `before` is what changed of what it
    /// said before, ahead of its last limit, and `pull` what changes of Σ F·∂y/∂q of a velocity of the extended robot. Gives what changes ahead of
    /// the last limit and behind it.
    pub(crate) fn say_of_controller(
        &mut self,
        run: &ControlRun,
        (sides, before, period): (&[Sides], &[f64], f64),
        pull: &dyn Fn(usize, usize) -> f64,
        motion: [&[f64]; 2],
        t: f64,
    ) -> [Vec<f64>; 2] {
        let count = self.count();
        self.push_at(ROW, None, (run, true), motion);
        let mut said = [vec![0.0; sides.len() * count], vec![0.0; sides.len() * count]];
        for (joint, own) in self.joints.iter().enumerate() {
            let Sides { rate, force } = sides[own.velocity];
            let wanted = self.shaped(ROW, joint, Mode::default(), t, motion);
            for (p, wanted) in wanted.into_iter().enumerate() {
                let place = own.velocity * count + p;
                let shaped = match rate {
                    0 => wanted + if run.compensates { pull(own.row, p) } else { 0.0 },
                    sign => before[place] + f64::from(sign) * period * own.rate_limit[p],
                };
                let behind = if force == 0 { shaped } else { f64::from(force) * own.limit[p] };
                (said[0][place], said[1][place]) = (shaped, behind);
            }
        }
        said
    }

    /// What outlasts the steps.
    pub(crate) fn save(&self) -> ControlVariationState {
        ControlVariationState {
            terms: self.terms.clone(),
            from: self.joints.iter().map(|joint| joint.from.clone()).collect(),
            modes: self.joints.iter().map(|joint| joint.mode).collect(),
        }
    }

    /// Goes on from what was saved; `false` where that is of another run.
    pub(crate) fn load(&mut self, run: &ControlRun, state: ControlVariationState) -> bool {
        let ControlVariationState { terms, from, modes } = state;
        if terms.len() != run.terms.len() || [from.len(), modes.len()] != [self.joints.len(); 2] {
            return false;
        }
        self.terms = terms;
        let kept = self.joints.iter_mut().zip(from.into_iter().zip(modes));
        kept.for_each(|(joint, (from, mode))| (joint.from, joint.mode) = (from, mode));
        true
    }
}

impl LawSlopes {
    fn new(law: &Feedback, target: Target, by: &Sensitivity, [own_q, own_v]: [&[usize]; 2]) -> Self {
        let senses = law.senses().iter().map(|sense| sense.of_robot([own_q, own_v]));
        let own = by.parameters.iter().map(|parameter| {
            let slopes = parameter.seeds.iter().filter_map(|seed| match (seed, target) {
                (Seed::TorqueFeedback { velocity, by }, Target::Torque(k)) if *velocity == k => Some(by.clone()),
                (Seed::InputFeedback { element, input, by }, Target::Input(e, i)) if [*element, *input] == [e, i] => {
                    Some(by.clone())
                }
                _ => None,
            });
            slopes.collect()
        });
        Self { law: law.clone(), senses: senses.collect(), target: target.of_robot(own_v), own: own.collect() }
    }
}

impl Target {
    /// The same of another robot, whose velocities are these.
    fn of_robot(self, velocities: &[usize]) -> Self {
        match self {
            Self::Torque(k) => Self::Torque(velocities[k]),
            input @ Self::Input(..) => input,
        }
    }
}

/// Adds what a sense changes of an expression whose slope by it is `slope`: ∂/∂q and ∂/∂v, and where the motion stays.
fn add_sense(eye: &Eye, sense: Sense, slope: f64, at: Place, (by_state, own): (&mut Slopes, &mut [f64])) {
    for (sum, of_sense) in by_state.iter_mut().zip(eye.slopes(sense)) {
        sum.iter_mut().zip(of_sense).for_each(|(sum, own)| *sum += slope * own);
    }
    if let Sense::Stroke(e) = sense {
        own.iter_mut().zip((at.rests)(e)).for_each(|(sum, rest)| *sum += slope * rest);
    }
}
