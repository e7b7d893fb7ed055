//! What parameters change of what follows from the state: exact slopes at the nodes themselves, of the branches that the step is on.
//!
//! All is about the robot of [`Sensitivity::extended`], in blocks of one number for each parameter.

mod leave;
mod sampled;
mod see;

pub(crate) use leave::Jump;
pub(crate) use sampled::{Held, OfSamples, Sides};

use super::eye::{Read, Slopes};
use super::mode::Mode;
use super::term::{Integrand, TermVariation};
use super::{ControlRun, Target};
use crate::collocation::STAGES;
use crate::control::{Aim, Controlled, ControllerVariation, Feedback, FeedbackSlope, Scratch, Sense, TorqueSlopes};
use crate::dynamics::Kinematics;
use crate::fractional::{KernelError, MemoryTangent};
use crate::model::Model;
use crate::system::System;
use crate::system::sensitivity::{Seed, Sensitivity, SensitivityError};
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
    left: Vec<leave::Left>,
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
            Some(controlled) => match controlled.variation() {
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
            let variation = run.controlled().and_then(Controlled::variation);
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

    /// The same of a step of which the ends alone are known, where the motion changes by these blocks; the run was told them.
    pub(crate) fn commit_ends(&mut self, run: &ControlRun, motion: [[&[f64]; 2]; 2]) {
        for m in 0..self.terms.len() {
            let Some((joint, _)) = self.joint_of(run, m) else { continue };
            let ends = [0, STAGES].into_iter().zip(motion).map(|(i, motion)| self.error(i, joint, motion));
            let ends: Vec<_> = ends.collect();
            self.terms[m].commit_ends(&run.terms[m], run.end_of_term(m), &ends);
        }
        self.nodes.swap(0, STAGES);
    }

    /// Every block that outlasts a step; of memories what they keep beside their modes.
    pub(crate) fn each_block(&mut self, take: &mut dyn FnMut(&mut [f64])) {
        for term in &mut self.terms {
            take(&mut term.integral);
            term.tangent.kept_mut().into_iter().for_each(&mut *take);
        }
        self.joints.iter_mut().for_each(|joint| take(&mut joint.from));
    }

    /// The memories of its terms.
    pub(crate) fn memories_mut(&mut self) -> impl Iterator<Item = &mut MemoryTangent> {
        self.terms.iter_mut().map(|term| &mut term.tangent)
    }

    /// Whether branches were left whose changes are not crossed yet.
    pub(crate) fn leaves_branches(&self) -> bool {
        !self.left.is_empty()
    }

    /// What is held changes in another way where the step starts.
    pub(crate) fn stand_again(&mut self) {
        let [start, ..] = &mut self.nodes;
        for (e, input, by) in &self.held.inputs {
            let own = start.inputs.iter_mut().filter(|(own_e, own_input, ..)| (own_e, own_input) == (e, input));
            own.for_each(|(.., own)| own.copy_from_slice(by));
        }
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
