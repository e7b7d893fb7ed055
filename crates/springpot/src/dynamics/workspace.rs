//! Scratch memory of the algorithms.

use crate::model::Model;
use crate::spatial::{Force, Inertia, Motion, Placement, Scalar, Vec3};

/// Scratch for the `_into` algorithms on one [`Model`]; one per thread, reused from call to call.
///
/// It carries nothing from one call to the next.
#[derive(Debug, Clone)]
pub struct Workspace<T = f64> {
    /// Joint j in its parent link.
    pub(super) local: Vec<Placement<T>>,
    /// Links in the world (index 0 is the world); written only where pair forces act.
    pub(super) world: Vec<Placement<T>>,
    /// Links, in link axes (index 0 is the world).
    pub(super) velocity: Vec<Motion<T>>,
    pub(super) acceleration: Vec<Motion<T>>,
    pub(super) force: Vec<Force<T>>,
    /// All that joint j carries, about the joint's origin in world axes.
    pub(super) composite: Vec<Inertia<T>>,
    pub(super) columns: Vec<Vec3<T>>,
}

impl<T: Scalar> Workspace<T> {
    /// Scratch for `model`.
    pub fn new(model: &Model) -> Self {
        let n = model.nv();
        Self {
            local: vec![Placement::IDENTITY; n],
            world: vec![Placement::IDENTITY; n + 1],
            velocity: vec![Motion::ZERO; n + 1],
            acceleration: vec![Motion::ZERO; n + 1],
            force: vec![Force::ZERO; n + 1],
            composite: vec![Inertia::ZERO; n],
            columns: vec![Vec3::ZERO; n],
        }
    }
}
