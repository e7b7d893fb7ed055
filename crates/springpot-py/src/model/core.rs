//! The engine's model, and what its algorithms work in.

use springpot::dynamics::batch::BatchWorkspace;
use springpot::dynamics::{AbaDerivatives, Kinematics, RneaDerivatives, Workspace};
use springpot::model::Model;
use std::sync::{Arc, Mutex, PoisonError};

/// Scratch kept for later calls, at most.
const KEPT: usize = 64;

/// A model that many threads ask at once.
#[derive(Debug)]
#[expect(clippy::vec_box, reason = "scratch is large, and goes to and fro in every call")]
pub(crate) struct Core {
    pub(crate) model: Arc<Model>,
    pub(crate) is_free_of_quaternions: bool,
    free: Mutex<Vec<Box<Scratch>>>,
}

/// What one thread works in.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub(crate) kinematics: Kinematics,
    pub(crate) workspace: Workspace,
    pub(crate) inverse_slopes: RneaDerivatives,
    pub(crate) forward_slopes: AbaDerivatives,
    /// nv × nv.
    pub(crate) matrix: Vec<f64>,
    /// The state at hand.
    pub(crate) inputs: [Vec<f64>; 3],
    /// States side by side, made when they are first asked for.
    pub(crate) together: Option<BatchWorkspace>,
}

impl Core {
    pub(crate) fn new(model: Arc<Model>) -> Self {
        let is_free_of_quaternions = (0..model.joint_count()).all(|j| model.joint_space(j).quaternion().is_none());
        Self { model, is_free_of_quaternions, free: Mutex::default() }
    }

    /// What somebody gave back, or new.
    #[inline]
    pub(crate) fn scratch(&self) -> Box<Scratch> {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        free.unwrap_or_else(|| {
            let model = &*self.model;
            Box::new(Scratch {
                kinematics: Kinematics::new(model),
                workspace: Workspace::new(model),
                inverse_slopes: RneaDerivatives::new(model),
                forward_slopes: AbaDerivatives::new(model),
                matrix: vec![0.0; model.nv() * model.nv()],
                inputs: Default::default(),
                together: None,
            })
        })
    }

    #[inline]
    pub(crate) fn give_back(&self, scratch: Box<Scratch>) {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        if free.len() < KEPT {
            free.push(scratch);
        }
    }
}
