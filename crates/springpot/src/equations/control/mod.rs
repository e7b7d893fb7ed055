//! Control over a run: what laws that act at every time answer at the nodes of a step, and what is kept of errors and samples.
//!
//! Whatever is not smooth, a kink of an expression, a limit that is reached, is a *branch* that is held over a step, so that its functions go on smoothly
//! beyond its end; steps end where a branch is left ([`Guard`]), and the next one starts on another.

mod eye;
mod guards;
mod mode;
mod row;
mod sampler;
mod step;
mod term;
mod variation;

pub(crate) use eye::{Eye, InputSlopes, Shown};
pub(crate) use guards::ControlSeen;
pub(crate) use mode::Guard;
pub(crate) use row::Misread;
pub(crate) use sampler::{Sampler, SamplerState};
pub(crate) use step::End;
pub(crate) use variation::{
    ControlVariation, ControlVariationState, Held as HeldVariation, Jump, OfSamples, Place, Sides,
};

use crate::collocation::STAGES;
use crate::control::{Aim, AntiWindup, At, Control, Controlled, Feedback, Limit, Scratch, Shaping, TorqueSlopes};
use crate::dynamics::Kinematics;
use crate::law::{InputValue, Response};
use crate::system::System;
use crate::system::error::RunError;
use mode::Mode;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use term::Term;

/// At how many times a reference is looked at for how far it goes.
const LOOKS: usize = 32;

/// What a run keeps of its control: for every step anew, but for what [`ControlState`] holds.
#[derive(Debug, Clone)]
pub(crate) struct ControlRun {
    control: Arc<Control>,
    /// Expressions that act at every time.
    laws: Vec<LawRun>,
    /// The joints that a controller drives.
    joints: Vec<JointRun>,
    /// Whether the controller acts at every time.
    is_continuous: bool,
    /// Whether the generalized forces of the elements are taken off.
    compensates: bool,
    terms: Vec<Term>,
    nodes: [Node; STAGES + 1],
    scratch: Scratch,
    /// ∂τ/∂q and ∂τ/∂v at the start of the step.
    slopes: TorqueSlopes,
    input_slopes: Vec<InputSlopes>,
    changing: Changing,
    spare: Vec<f64>,
    /// Errors at both ends of a step whose nodes are not known, and when it starts and ends, s.
    ends: [Vec<[f64; 2]>; 2],
    span: [f64; 2],
    /// The longest step in which a filter of a sampled controller is known, s: no force tells of it.
    longest: f64,
    /// Whether a step is known at its nodes, not at its ends alone.
    knows_nodes: bool,
    known: Known,
    row: AtRow,
}

/// Changes of the branches.
#[derive(Debug, Clone, Default)]
struct Changing {
    /// At the end of the step.
    at_end: Vec<Guard>,
    /// What was left last, and when, s.
    left: (f64, Vec<Guard>),
    /// When the first of the changes happened that lie close together, and how many they are.
    together: (f64, u32),
}

/// What is known where the step starts.
#[derive(Debug, Clone, Copy, Default)]
struct Known {
    /// Whether the branches are those of a start that was looked at.
    branches: bool,
    /// Whether the reference was looked at.
    aim: bool,
}

/// Where the reference is and how the links are, at the time of a row.
#[derive(Debug, Clone)]
struct AtRow {
    aim: Aim,
    kinematics: Kinematics,
}

/// An expression that acts at every time.
#[derive(Debug, Clone)]
struct LawRun {
    law: Feedback,
    target: Target,
    /// Whether the element feels how fast it changes: a temperature that stretches it.
    stretches: bool,
    /// A bit for each of its kinks.
    branch: u64,
    /// Its largest value at an end of a step so far.
    largest: f64,
}

/// What an expression says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    /// The actuator force on a velocity.
    Torque(usize),
    /// Input `1` of element `0`.
    Input(usize, usize),
}

impl Target {
    /// The column that tells it.
    fn column(self, system: &System) -> String {
        match self {
            Self::Torque(k) => format!("tau.{}", system.model.v_labels()[k].name),
            Self::Input(e, i) => {
                let element = &system.elements[e];
                format!("{}.{}", element.name, element.entry.inputs[i].name)
            }
        }
    }
}

/// A joint that a controller drives.
#[derive(Debug, Clone)]
struct JointRun {
    velocity: usize,
    limit: Limit,
    /// Its integral, among the terms.
    integral: Option<usize>,
    mode: Mode,
    /// How far and how fast its reference goes.
    going: [f64; 2],
}

/// The start or a node of a step.
#[derive(Debug, Clone, Default)]
struct Node {
    t: f64,
    aim: Aim,
    /// ∂y/∂q of every element, where their forces are taken off.
    gradients: Vec<f64>,
    /// What every law sees, one after the other.
    seen: Vec<f64>,
    /// How fast every law changes, where its element feels that.
    rates: Vec<f64>,
    /// Error and its rate of every joint that the controller drives.
    errors: Vec<[f64; 2]>,
    /// What derivatives with a past take in its place.
    derived: Vec<[f64; 2]>,
    /// The controller's force without its terms (nv).
    law: Vec<f64>,
    /// Of every joint that it drives, before all limits, and before the last one.
    wanted: Vec<f64>,
    shaped: Vec<f64>,
    /// All that is added to the actuator forces (nv).
    torque: Vec<f64>,
}

/// What of it outlasts a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct ControlState {
    branches: Vec<u64>,
    largest: Vec<f64>,
    modes: Vec<Mode>,
    terms: Vec<term::Kept>,
    /// Of the start of the next step, what was wanted of its joints, what limits of rates let through, and what acts.
    wanted: Vec<f64>,
    shaped: Vec<f64>,
    torque: Vec<f64>,
    left: (f64, Vec<Guard>),
    together: (f64, u32),
}

impl ControlRun {
    /// How many numbers its derivatives keep from step to step, and of how many memories.
    pub(crate) fn kept(&self) -> [usize; 2] {
        [4 * self.terms.len() + self.joints.len(), self.terms.len()]
    }

    /// Of a system that is controlled; `has_fixed_steps`: in steps of one size.
    pub(crate) fn of(system: &System, has_fixed_steps: bool) -> Option<Box<Self>> {
        let control = system.control.clone();
        if control.is_empty() {
            return None;
        }
        let model = &system.model;
        let is_now = |sampling: &Option<crate::control::Sampling>| sampling.is_none() && !has_fixed_steps;
        let torques = control.torques.iter().filter(|own| is_now(&own.sampling)).map(|own| LawRun {
            law: own.law.clone(),
            target: Target::Torque(own.velocity),
            stretches: false,
            branch: 0,
            largest: 0.0,
        });
        let inputs = control.inputs.iter().filter(|own| is_now(&own.sampling)).map(|own| LawRun {
            law: own.law.clone(),
            target: Target::Input(own.element, own.input),
            stretches: system.elements[own.element].law.stretched_by() == Some(own.input),
            branch: 0,
            largest: 0.0,
        });
        let laws: Vec<LawRun> = torques.chain(inputs).collect();
        let driven = system.driven_velocities();
        let mut joints = Vec::new();
        let (mut is_continuous, mut compensates) = (false, false);
        if let Some(controlled) = &control.controller {
            is_continuous = is_now(&controlled.sampling);
            compensates = controlled.law.compensates_elements();
            joints.extend(driven.into_iter().filter(|&k| model.coordinate_of(k).is_some()).map(|velocity| JointRun {
                velocity,
                limit: controlled.limits.get(velocity).copied().unwrap_or_default(),
                integral: None,
                going: [0.0; 2],
                mode: Mode::default(),
            }));
        }
        let node = Node { law: vec![0.0; model.nv()], torque: vec![0.0; model.nv()], ..Node::default() };
        let square = || vec![0.0; model.nv() * model.nv()];
        Some(Box::new(Self {
            laws,
            joints,
            is_continuous,
            compensates,
            terms: Vec::new(),
            nodes: std::array::from_fn(|_| node.clone()),
            scratch: Scratch::new(model),
            slopes: TorqueSlopes { d_q: square(), d_v: square() },
            input_slopes: Vec::new(),
            changing: Changing::default(),
            spare: Vec::new(),
            ends: Default::default(),
            span: [0.0; 2],
            longest: f64::INFINITY,
            knows_nodes: !has_fixed_steps,
            known: Known::default(),
            row: AtRow { aim: Aim::default(), kinematics: Kinematics::new(model) },
            control,
        }))
    }

    fn controlled(&self) -> Option<&Controlled> {
        self.control.controller.as_ref()
    }

    /// Whether integrals stop while their force is at its limit.
    fn stops_windup(&self) -> bool {
        self.controlled().is_some_and(|controlled| controlled.anti_windup == AntiWindup::Conditional)
    }

    /// Whether anything of it acts at every time.
    pub(crate) fn acts_continuously(&self) -> bool {
        self.is_continuous || !self.laws.is_empty()
    }

    /// Begins the terms of its errors at t = 0, where the robot is.
    ///
    /// # Errors
    /// Where the reference cannot be followed, or a memory cannot be.
    pub(crate) fn begin(&mut self, system: &System, q: &[f64], v: &[f64], end: f64) -> Result<(), RunError> {
        self.terms.clear();
        self.changing.at_end.clear();
        self.changing.left.1.clear();
        (self.known.branches, self.known.aim) = (false, false);
        let Some(controlled) = self.control.controller.clone() else { return Ok(()) };
        for k in (0..=LOOKS).rev() {
            // Where a path cannot be followed so far, the run says when it comes there.
            let Ok(()) = self.aim_at(system, end * k as f64 / LOOKS as f64, 0) else { continue };
            let aim = &self.nodes[0].aim;
            for joint in &mut self.joints {
                let [error, _] = aim.error(&system.model, joint.velocity, q, v);
                joint.going = [joint.going[0].max(error.abs()), joint.going[1].max(aim.v[joint.velocity].abs())];
            }
        }
        self.aim_at(system, 0.0, 0)?;
        let mut laws = controlled.error_terms();
        if let Some(by) = &system.sensitivity {
            by.add_terms(&controlled, &mut laws);
        }
        for law in laws {
            let Some(joint) = self.joints.iter_mut().find(|joint| joint.velocity == law.velocity) else { continue };
            if law.order < 0.0 && law.gain != 0.0 {
                joint.integral = Some(self.terms.len());
            }
            let (aim, shaping) = (&self.nodes[0].aim, &controlled.shaping);
            let [taken, _] = match law.order > 0.0 {
                true => shaping.taken(aim, &system.model, law.velocity, [q, v]),
                false => aim.error(&system.model, law.velocity, q, v),
            };
            let term = Term::begin(law, taken, shaping.filter);
            self.terms.push(term.map_err(RunError::of_kernel("the controller"))?);
        }
        Ok(())
    }

    /// Builds the memories of its terms; `first` is the size of the first step.
    ///
    /// # Errors
    /// Where one cannot be built.
    pub(crate) fn open(&mut self, tolerance: f64, first: f64, horizon: f64) -> Result<(), RunError> {
        let filter = self.controlled().and_then(|controlled| controlled.shaping.filter).filter(|_| !self.is_continuous);
        self.longest = filter.map_or(f64::INFINITY, |time| term::longest_step(time, tolerance));
        let opened = self.terms.iter_mut().try_for_each(|term| term.open(tolerance, first, horizon));
        opened.map_err(RunError::of_kernel("the controller"))
    }

    /// Where the reference is at t, for the start (0) or a node of the step.
    fn aim_at(&mut self, system: &System, t: f64, node: usize) -> Result<(), RunError> {
        let Some(controlled) = &self.control.controller else { return Ok(()) };
        let (aim, scratch) = (&mut self.nodes[node].aim, &mut self.scratch.kinematics);
        Ok(controlled.reference.at_into(&system.model, system.gripper.as_ref(), t, scratch, aim)?)
    }

    /// How long a step from t may be, at most h, so that its nodes see what the reference does.
    pub(crate) fn reach(&self, t: f64, h: f64) -> f64 {
        let h = h.min(self.longest);
        let followed = self.controlled().filter(|_| self.is_continuous);
        followed.map_or(h, |controlled| controlled.reference.trajectory().reach(t, h))
    }

    /// What outlasts the steps.
    pub(crate) fn state(&self) -> ControlState {
        ControlState {
            branches: self.laws.iter().map(|law| law.branch).collect(),
            largest: self.laws.iter().map(|law| law.largest).collect(),
            modes: self.joints.iter().map(|joint| joint.mode).collect(),
            terms: self.terms.iter().map(|term| term.kept.clone()).collect(),
            wanted: self.nodes[0].wanted.clone(),
            shaped: self.nodes[0].shaped.clone(),
            torque: self.nodes[0].torque.clone(),
            left: self.changing.left.clone(),
            together: self.changing.together,
        }
    }

    /// Goes on from a state of the same system, after [`Self::begin`]; `false` where it is of another one.
    pub(crate) fn go_on(&mut self, state: ControlState) -> bool {
        let ControlState { branches, largest, modes, terms, wanted, shaped, torque, left, together } = state;
        let fits = [branches.len(), largest.len()] == [self.laws.len(); 2] && modes.len() == self.joints.len();
        if !fits || terms.len() != self.terms.len() || torque.len() != self.nodes[0].torque.len() {
            return false;
        }
        let kept = branches.into_iter().zip(largest);
        self.laws.iter_mut().zip(kept).for_each(|(law, kept)| (law.branch, law.largest) = kept);
        self.joints.iter_mut().zip(modes).for_each(|(joint, mode)| joint.mode = mode);
        self.terms.iter_mut().zip(terms).for_each(|(term, kept)| term.kept = kept);
        let start = &mut self.nodes[0];
        (start.wanted, start.shaped, start.torque) = (wanted, shaped, torque);
        (self.changing.left, self.changing.together) = (left, together);
        (self.known.branches, self.known.aim) = (true, false);
        true
    }

    /// Which branches are about to be left.
    fn leaves(&self) -> &[Guard] {
        &self.changing.at_end
    }

    /// What is added to the actuator forces at the start (0) or at a node of the step (nv).
    pub(crate) fn torque(&self, node: usize) -> &[f64] {
        &self.nodes[node].torque
    }

    /// How the terms of errors answer to the step: by velocity, as laws do.
    pub(crate) fn responses(&self) -> impl Iterator<Item = (usize, Response)> {
        let joint = |k: usize| self.joints.iter().find(move |joint| joint.velocity == k);
        let acting = self.terms.iter().filter(|_| self.is_continuous);
        acting.filter_map(move |term| {
            let mode = joint(term.law.velocity)?.mode;
            mode.follows().then(|| (term.law.velocity, term.response(mode.integrand)))
        })
    }

    /// How the inputs of elements answer to the state, and their forces to them.
    pub(crate) fn inputs(&self) -> &[InputSlopes] {
        &self.input_slopes
    }
}

/// What a controller is asked of a robot that is looked at.
fn at<'a>(eye: &Eye<'a>, aim: &'a Aim, shaping: &'a Shaping) -> At<'a> {
    At {
        model: &eye.system.model,
        gripper: eye.system.gripper.as_ref(),
        t: eye.t,
        q: eye.q,
        v: eye.v,
        kinematics: eye.kinematics,
        aim,
        shaping,
    }
}

/// The value of an input that follows from the state.
fn input(value: f64, rate: f64) -> InputValue {
    InputValue { value, rate }
}
