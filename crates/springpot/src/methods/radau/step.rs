//! What one step of Radau IIA(5) in the accelerations works on: its start, its stages, its elements.

use super::rounding::Rounding;
use super::sizes::{Sizes, Tolerance};
use super::stick::{Sliding, Stick};
use crate::actuation::Forward;
use crate::collocation::radau::A;
use crate::collocation::{STAGES, TABLEAU};
use crate::dynamics::{Kinematics, RneaDerivatives, Workspace};
use crate::elements::{Element, ElementBank, Forces, NoDirection, Reading};
use crate::equations::context::Context;
use crate::equations::kinks::Kinks;
use crate::law::{InputValue, Point};
use crate::linalg::Lu;
use crate::model::Model;
use crate::system::System;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Where a step starts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Origin {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// Accelerations without the share of a singular start.
    pub(super) a: Vec<f64>,
    /// Forces of the elements without the share of a singular start, N.
    pub(super) forces: Vec<f64>,
}

impl Origin {
    pub(super) fn new(system: &System, forward: &Forward) -> Self {
        let (a, forces) = (vec![0.0; system.model.nv()], vec![0.0; system.elements.len()]);
        Self { t: 0.0, q: forward.q.clone(), v: forward.v.clone(), a, forces }
    }
}

/// One element over the step.
#[derive(Debug, Clone)]
pub(super) struct ElementStage {
    /// At the start (0) and at the nodes.
    pub(super) readings: [Reading; STAGES + 1],
    /// ∂y/∂q at the start.
    pub(super) gradient: Vec<f64>,
    /// −M⁻¹ ∂y/∂q at the start: the accelerations that a unit of force gives. Only kept up to date where a run needs
    /// it.
    pub(super) share: Vec<f64>,
    /// What a singular start had in the force at the start of the step, N.
    pub(super) singular_before: f64,
}

impl ElementStage {
    /// Why the element lost its direction between two nodes, where it did.
    pub(super) fn lost(&self) -> Option<NoDirection> {
        self.readings.windows(2).find_map(|two| two[0].lost_until(&two[1]))
    }
}

/// The robot at one node.
#[derive(Debug, Clone)]
pub(super) struct Stage {
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// Accelerations, the share of a singular start included.
    pub(super) a: Vec<f64>,
    /// Tangent vector from the start of the step.
    pub(super) xi: Vec<f64>,
    pub(super) xi_rate: Vec<f64>,
    pub(super) kinematics: Kinematics,
}

/// All that a step takes over from those before it: whatever else a [`RadauStep`] holds, every attempt fills anew.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Carried {
    origin: Origin,
    cubic: [Vec<f64>; STAGES + 1],
    last: Option<f64>,
    is_singular: bool,
    singular_before: Vec<f64>,
    contraction: f64,
    sliding: Sliding,
    sizes: Sizes,
}

/// The step from an [`Origin`].
#[derive(Debug)]
pub(super) struct RadauStep {
    pub(super) model: Arc<Model>,
    pub(super) forward: Arc<Forward>,
    pub(super) tolerance: Tolerance,
    pub(super) rtol: f64,
    /// Whether a springpot can be unstable where it is stiff.
    pub(super) may_yield: bool,
    /// Elements whose forces have kinks.
    pub(super) stops: Vec<usize>,
    /// Friction that sticks.
    pub(super) stick: Stick,
    /// Velocities that no signal prescribes and no friction holds.
    pub(super) free: Vec<usize>,
    pub(super) origin: Origin,
    pub(super) stages: [Stage; STAGES],
    pub(super) elements: Vec<ElementStage>,
    /// Accelerations at the start and at the nodes without the share of a singular start.
    pub(super) regular: [Vec<f64>; STAGES + 1],
    /// Coefficients of θ^p of the cubic through `regular` over the last step fitted.
    pub(super) cubic: [Vec<f64>; STAGES + 1],
    /// The same of the rate of ξ, for robots with floating joints.
    pub(super) turning: [Vec<f64>; STAGES + 1],
    /// Size of the step before, whose cubic predicts the next; none after a break.
    pub(super) last: Option<f64>,
    /// Whether a start is singular, so that its share of the accelerations is kept apart.
    pub(super) is_singular: bool,
    /// Accelerations that a run with a singular start arrived with at the origin, before their share of it was taken off.
    pub(super) arrived: Vec<f64>,
    /// Whether the linearisation is that of the origin.
    pub(super) linearised: bool,
    pub(super) start: Kinematics,
    pub(super) workspace: Workspace,
    pub(super) slopes: RneaDerivatives,
    pub(super) newton: Lu,
    pub(super) filter: Lu,
    pub(super) mass: Lu,
    pub(super) residual: Vec<f64>,
    pub(super) tau: Vec<f64>,
    /// Coordinates of joints that no force drives, while the others are moved.
    pub(super) held: Vec<f64>,
    pub(super) forces: Forces,
    /// Actuator forces of the free velocities at the nodes.
    pub(super) drives: [Vec<f64>; STAGES],
    /// Ratio of successive increments, carried from step to step.
    pub(super) contraction: f64,
    /// How large the motion is.
    pub(super) sizes: Sizes,
    /// The energy turned over so far, J.
    pub(super) energy: f64,
    /// How fast and how far each free velocity moves until the end of this step.
    pub(super) sized: Vec<[f64; 2]>,
    /// What rounding does in this step.
    pub(super) rounding: Rounding,
    /// Errors that are allowed in this step, of each free velocity and of its coordinate.
    pub(super) allowed: Vec<[f64; 2]>,
    /// What rounding makes of each free velocity in this step.
    pub(super) noise: Vec<f64>,
    pub(super) scratch: EstimateScratch,
}

/// Room for the error estimate.
#[derive(Debug, Default)]
pub(super) struct EstimateScratch {
    pub(super) positions: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    pub(super) error: Vec<f64>,
}

impl RadauStep {
    pub(super) fn new(cx: Context, forward: &Arc<Forward>, tolerance: Tolerance, rtol: f64) -> Self {
        let (system, model) = (cx.system, &cx.system.model);
        let nv = model.nv();
        let stage = Stage {
            q: forward.q.clone(),
            v: vec![0.0; nv],
            a: vec![0.0; nv],
            xi: vec![0.0; nv],
            xi_rate: vec![0.0; nv],
            kinematics: Kinematics::new(model),
        };
        let elements = system.elements.iter().map(|_| ElementStage {
            readings: Default::default(),
            gradient: vec![0.0; nv],
            share: vec![0.0; nv],
            singular_before: 0.0,
        });
        Self {
            model: model.clone(),
            forward: forward.clone(),
            tolerance,
            rtol,
            may_yield: system.elements.iter().any(may_yield),
            stops: Kinks::of(system).elements().to_vec(),
            stick: Stick::new(model, forward),
            free: forward.free_velocities(model),
            origin: Origin::new(system, forward),
            stages: std::array::from_fn(|_| stage.clone()),
            elements: elements.collect(),
            regular: std::array::from_fn(|_| vec![0.0; nv]),
            cubic: std::array::from_fn(|_| vec![0.0; nv]),
            turning: std::array::from_fn(|_| vec![0.0; nv]),
            last: None,
            is_singular: false,
            arrived: vec![0.0; nv],
            linearised: false,
            start: Kinematics::new(model),
            workspace: Workspace::new(model),
            slopes: RneaDerivatives::new(model),
            newton: Lu::default(),
            filter: Lu::default(),
            mass: Lu::default(),
            residual: Vec::new(),
            tau: vec![0.0; nv],
            held: Vec::new(),
            forces: Forces::default(),
            drives: Default::default(),
            contraction: 0.0,
            sizes: Sizes::new(&forward.q, nv),
            energy: 0.0,
            sized: Vec::new(),
            rounding: Rounding::default(),
            allowed: Vec::new(),
            noise: Vec::new(),
            scratch: EstimateScratch::default(),
        }
    }

    /// Sums of A over a quantity of the stages: what row `i` adds to stage `i`.
    pub(super) fn collocate(&self, i: usize, of: impl Fn(&Stage) -> f64) -> f64 {
        A[i].iter().zip(&self.stages).map(|(a, stage)| a * of(stage)).sum()
    }

    /// Fits the cubics of the step that was just attempted.
    pub(super) fn fit(&mut self) {
        let is_one_degree = self.model.is_one_degree();
        for p in 0..=STAGES {
            let row = TABLEAU.rates[p];
            for j in 0..self.model.nv() {
                self.cubic[p][j] = row.iter().zip(&self.regular).map(|(l, a)| l * a[j]).sum();
                if !is_one_degree {
                    let nodes = self.stages.iter().map(|stage| stage.xi_rate[j]);
                    let rates = std::iter::once(self.origin.v[j]).chain(nodes);
                    self.turning[p][j] = row.iter().zip(rates).map(|(l, rate)| l * rate).sum();
                }
            }
        }
    }

    /// Goes on to the end of the step that was just attempted and fitted.
    pub(super) fn accept(&mut self, bank: &ElementBank, h: f64, to: f64) {
        self.last = Some(h);
        self.linearised = false;
        let end = &self.stages[STAGES - 1];
        self.origin.q.copy_from_slice(&end.q);
        self.origin.v.copy_from_slice(&end.v);
        self.origin.a.copy_from_slice(&end.a);
        self.sizes.take(&self.model, to, &self.origin.q, &self.origin.v);
        for (e, (force, element)) in self.origin.forces.iter_mut().zip(&mut self.elements).enumerate() {
            let response = bank.response(e);
            let singular = response.singular[STAGES - 1];
            *force = response.force[STAGES - 1] - singular;
            element.singular_before = singular;
        }
        self.origin.t = to;
    }

    /// What the next step takes over.
    pub(super) fn carried(&self) -> Carried {
        let mut origin = self.origin.clone();
        if self.linearised && self.is_singular {
            origin.a.copy_from_slice(&self.arrived);
        }
        Carried {
            origin,
            cubic: self.cubic.clone(),
            last: self.last,
            is_singular: self.is_singular,
            singular_before: self.elements.iter().map(|element| element.singular_before).collect(),
            contraction: self.contraction,
            sliding: self.stick.sliding.clone(),
            sizes: self.sizes.clone(),
        }
    }

    /// Goes on from what was carried.
    pub(super) fn restore(&mut self, carried: Carried) {
        let Carried { origin, cubic, last, is_singular, singular_before, contraction, sliding, sizes } = carried;
        (self.origin, self.cubic, self.last) = (origin, cubic, last);
        (self.is_singular, self.contraction, self.linearised) = (is_singular, contraction, false);
        self.stick.sliding = sliding;
        self.free = self.stick.free();
        self.sizes = sizes;
        for (element, before) in self.elements.iter_mut().zip(singular_before) {
            element.singular_before = before;
        }
    }

    /// The origin was set from outside: nothing can be predicted from what was.
    pub(super) fn restart(&mut self) {
        self.last = None;
        self.linearised = false;
        self.elements.iter_mut().for_each(|element| element.singular_before = 0.0);
    }
}

/// Whether a springpot of the element can be unstable where it is stiff.
pub(super) fn may_yield(element: &Element) -> bool {
    let inputs = vec![InputValue::default(); element.inputs.len()];
    let mut may_yield = false;
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
    element.law.for_each_springpot(&at, &mut |term| may_yield |= term.is_yielding());
    may_yield
}
