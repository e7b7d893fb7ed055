//! Scratch memory of the algorithms.

use super::body_coriolis::BodyCoriolis;
use super::joint::Stands;
use crate::model::Model;
use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Placement, Scalar, Vec3};

/// Scratch for the `_into` algorithms on one [`Model`]; one per thread, reused from call to call.
///
/// It carries nothing from one call to the next.
#[derive(Debug, Clone)]
pub struct Workspace<T = f64> {
    pub(super) stands: Stands<T>,
    /// Joint j in its parent link.
    pub(super) local: Vec<Placement<T>>,
    /// Links in the world (index 0 is the world); written only where pair forces act.
    pub(super) world: Vec<Placement<T>>,
    /// Links (index 0 is the world): in link axes, or in world axes about the origin or the reference point.
    pub(super) velocity: Vec<Motion<T>>,
    pub(super) acceleration: Vec<Motion<T>>,
    pub(super) force: Vec<Force<T>>,
    /// All that joint j carries, about the joint's origin or the reference point in world axes.
    pub(super) composite: Vec<Inertia<T>>,
    pub(super) columns: Vec<Vec3<T>>,
    pub(super) articulated: Articulated<T>,
    pub(super) axes: Axes<T>,
    pub(super) body_coriolis: Vec<BodyCoriolis<T>>,
    /// ∂l/∂q and ∂l'/∂q of a pair.
    pub(super) gradient: Vec<T>,
    pub(super) rate_gradient: Vec<T>,
    /// Joints on the way from a frame to the world.
    pub(super) path: Vec<usize>,
    /// The mass matrix, where joints follow one another.
    pub(super) mass: Vec<T>,
}

/// What joint j carries when all joints beyond it are free.
#[derive(Debug, Clone)]
pub(super) struct Articulated<T> {
    pub(super) inertia: Vec<ArticulatedInertia<T>>,
    /// v × S q̇.
    pub(super) bias: Vec<Motion<T>>,
    /// U = I S.
    pub(super) column: Vec<Force<T>>,
    /// 1/(S·U).
    pub(super) inverse_pivot: Vec<T>,
    /// What is left of τ for the articulated body.
    pub(super) effort: Vec<T>,
}

/// Axes of the degrees of freedom at the reference point, and their rates.
#[derive(Debug, Clone)]
pub(super) struct Axes<T> {
    pub(super) unit: Vec<Motion<T>>,
    pub(super) rate: Vec<Motion<T>>,
    pub(super) own_rate: Vec<Motion<T>>,
    /// The sum of both, which the derivatives take once for each degree that carries another.
    pub(super) both_rates: Vec<Motion<T>>,
    pub(super) second_rate: Vec<Motion<T>>,
}

impl<T: Scalar> Articulated<T> {
    fn new(joints: usize, degrees: usize) -> Self {
        Self {
            inertia: vec![ArticulatedInertia::ZERO; joints],
            bias: vec![Motion::ZERO; joints],
            column: vec![Force::ZERO; degrees],
            inverse_pivot: vec![T::ZERO; degrees],
            effort: vec![T::ZERO; degrees],
        }
    }
}

impl<T: Scalar> Axes<T> {
    fn new(degrees: usize) -> Self {
        let zero = || vec![Motion::ZERO; degrees];
        Self { unit: zero(), rate: zero(), own_rate: zero(), both_rates: zero(), second_rate: zero() }
    }
}

impl<T: Scalar> Workspace<T> {
    /// Scratch for `model`.
    pub fn new(model: &Model) -> Self {
        let (n, d) = (model.joint_count(), model.degrees().len());
        let dense = if model.is_free_of_followers() { 0 } else { model.nv() };
        Self {
            stands: Stands::new(model),
            local: vec![Placement::IDENTITY; n],
            world: vec![Placement::IDENTITY; n + 1],
            velocity: vec![Motion::ZERO; n + 1],
            acceleration: vec![Motion::ZERO; n + 1],
            force: vec![Force::ZERO; n + 1],
            composite: vec![Inertia::ZERO; n],
            columns: vec![Vec3::ZERO; d],
            articulated: Articulated::new(n, d),
            axes: Axes::new(d),
            body_coriolis: vec![BodyCoriolis::ZERO; n],
            gradient: vec![T::ZERO; d],
            rate_gradient: vec![T::ZERO; d],
            path: Vec::with_capacity(n),
            mass: vec![T::ZERO; dense * dense],
        }
    }
}
