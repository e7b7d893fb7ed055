//! What one step of Radau IIA(5) in the accelerations works on: its start and its stages.

use super::newton::Contraction;
use super::system::StageSystem;
use super::variation::TurnedStages;
use crate::actuation::Forward;
use crate::collocation::radau::A;
use crate::collocation::{STAGES, TABLEAU};
use crate::dynamics::Kinematics;
use crate::equations::{Equations, Node, Origin, Solve};
use crate::methods::chosen::{Errors, Sizes, Tolerance};
use crate::model::Model;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

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

impl Stage {
    pub(super) fn node(&self, t: f64) -> Node<'_> {
        Node { t, q: &self.q, v: &self.v, a: &self.a }
    }
}

/// All that a step takes over from those before it: whatever else a [`RadauStep`] holds, every attempt fills anew.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Carried {
    origin: Origin,
    cubic: [Vec<f64>; STAGES + 1],
    last: Option<f64>,
    contraction: Contraction,
    sizes: Sizes,
}

/// The step from an [`Origin`].
#[derive(Debug)]
pub(in crate::methods) struct RadauStep {
    pub(in crate::methods) model: Arc<Model>,
    pub(super) rtol: f64,
    pub(in crate::methods) origin: Origin,
    pub(super) stages: [Stage; STAGES],
    pub(super) fitted: Fitted,
    /// Accelerations that a run with a singular start arrived with at the origin, where their share of it was taken off.
    arrived: Option<Vec<f64>>,
    pub(super) system: StageSystem,
    pub(super) filter: Solve,
    pub(super) residual: Vec<f64>,
    /// Coordinates of joints that no force drives, while the others are moved.
    pub(super) held: Vec<f64>,
    /// Ratio of successive increments, carried from step to step.
    pub(super) contraction: Contraction,
    pub(in crate::methods) errors: Errors,
    pub(super) scratch: EstimateScratch,
    /// What parameters change of joints that turn freely, over the step that was varied last.
    pub(super) turned: Vec<TurnedStages>,
}

/// The step that was fitted last as a function of time.
#[derive(Debug)]
pub(super) struct Fitted {
    /// Accelerations at the start and at the nodes without the share of a singular start.
    pub(super) regular: [Vec<f64>; STAGES + 1],
    /// Coefficients of θ^p of the cubic through these.
    pub(super) cubic: [Vec<f64>; STAGES + 1],
    /// The same of the rate of ξ, for robots with floating joints.
    pub(super) turning: [Vec<f64>; STAGES + 1],
    /// Size of the step, whose cubic predicts the next; none after a break.
    pub(super) last: Option<f64>,
}

/// Room for the error estimate.
#[derive(Debug, Default)]
pub(super) struct EstimateScratch {
    pub(super) positions: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    /// Whether the filter was factored with the system of the step.
    pub(super) is_factored: bool,
    pub(super) error: Vec<f64>,
    /// Of what parameters change, in blocks: raw estimates of velocities and places, and the filtered ones.
    pub(super) changes: [Vec<f64>; 3],
}

impl RadauStep {
    pub(super) fn new(model: &Arc<Model>, forward: &Forward, tolerance: Tolerance, rtol: f64) -> Self {
        let nv = model.nv();
        let stage = Stage {
            q: forward.q.clone(),
            v: vec![0.0; nv],
            a: vec![0.0; nv],
            xi: vec![0.0; nv],
            xi_rate: vec![0.0; nv],
            kinematics: Kinematics::new(model),
        };
        let rows = || std::array::from_fn(|_| vec![0.0; nv]);
        Self {
            model: model.clone(),
            rtol,
            origin: Origin::new(model, forward),
            stages: std::array::from_fn(|_| stage.clone()),
            fitted: Fitted { regular: rows(), cubic: rows(), turning: rows(), last: None },
            arrived: None,
            system: StageSystem::default(),
            filter: Solve::default(),
            residual: Vec::new(),
            held: Vec::new(),
            contraction: Contraction::default(),
            errors: Errors::new(tolerance, Sizes::new(&forward.q, nv)),
            scratch: EstimateScratch::default(),
            turned: Vec::new(),
        }
    }

    /// Sums of A over a quantity of the stages: what row `i` adds to stage `i`.
    pub(super) fn collocate(&self, i: usize, of: impl Fn(&Stage) -> f64) -> f64 {
        A[i].iter().zip(&self.stages).map(|(a, stage)| a * of(stage)).sum()
    }

    /// Takes out of the accelerations at the origin, which was linearised anew, what the end of the last step had of a singular start, seen from
    /// here, so that the rest has no jump.
    pub(super) fn take_off_singular(&mut self, equations: &Equations) {
        if equations.is_singular() {
            self.arrived = Some(self.origin.a.clone());
            equations.take_off_singular_before(&mut self.origin.a);
        }
    }

    /// Fits the cubics of the step that was just attempted.
    pub(super) fn fit(&mut self) {
        let is_one_degree = self.model.is_one_degree();
        let Fitted { regular, cubic, turning, .. } = &mut self.fitted;
        for p in 0..=STAGES {
            let row = TABLEAU.rates[p];
            for j in 0..self.model.nv() {
                cubic[p][j] = row.iter().zip(&*regular).map(|(l, a)| l * a[j]).sum();
                if !is_one_degree {
                    let nodes = self.stages.iter().map(|stage| stage.xi_rate[j]);
                    let rates = std::iter::once(self.origin.v[j]).chain(nodes);
                    turning[p][j] = row.iter().zip(rates).map(|(l, rate)| l * rate).sum();
                }
            }
        }
    }

    /// Goes on to the end of the step that was just attempted and fitted.
    pub(super) fn accept(&mut self, h: f64, to: f64) {
        (self.fitted.last, self.arrived) = (Some(h), None);
        let Self { stages: [.., end], origin, errors, model, .. } = self;
        arrive(origin, errors, model, to, [&end.q, &end.v, &end.a]);
    }

    /// Goes on to the end of a step of another method.
    pub(in crate::methods) fn arrive(&mut self, to: f64, end: [&[f64]; 3]) {
        arrive(&mut self.origin, &mut self.errors, &self.model, to, end);
    }

    /// What the next step takes over.
    pub(super) fn carried(&self) -> Carried {
        let mut origin = self.origin.clone();
        if let Some(arrived) = &self.arrived {
            origin.a.copy_from_slice(arrived);
        }
        Carried {
            origin,
            cubic: self.fitted.cubic.clone(),
            last: self.fitted.last,
            contraction: self.contraction,
            sizes: self.errors.sizes.clone(),
        }
    }

    /// Goes on from what was carried.
    pub(super) fn restore(&mut self, carried: Carried) {
        let Carried { origin, cubic, last, contraction, sizes } = carried;
        (self.origin, self.arrived, self.fitted.cubic, self.fitted.last) = (origin, None, cubic, last);
        (self.contraction, self.errors.sizes) = (contraction, sizes);
    }

    /// The origin was set from outside: nothing can be predicted from what was.
    pub(in crate::methods) fn restart(&mut self) {
        (self.fitted.last, self.arrived) = (None, None);
    }
}

/// The origin goes on to the end of a step.
fn arrive(origin: &mut Origin, errors: &mut Errors, model: &Model, to: f64, [q, v, a]: [&[f64]; 3]) {
    origin.q.copy_from_slice(q);
    origin.v.copy_from_slice(v);
    origin.a.copy_from_slice(a);
    errors.sizes.take(model, to, q, v);
    origin.t = to;
}
