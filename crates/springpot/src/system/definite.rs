//! Whether the mass matrix stays positive definite where inertias were accepted that no body has.

use super::System;
use super::error::RunError;
use crate::dynamics::{Kinematics, Workspace, indefinite_joint_into};
use crate::model::{Dimension, Model, Space};

/// Configurations are looked at that are no farther apart than this, rad and m.
const TURN: f64 = 0.05;
const SHIFT: f64 = 0.01;
/// Most of them between two that a method knows.
const MOST: f64 = 1000.0;

/// Looks at the configurations that a motion meets.
#[derive(Debug, Clone)]
pub(crate) struct Definite {
    kinematics: Kinematics,
    workspace: Workspace,
    mass: Vec<f64>,
    between: Vec<f64>,
}

impl Definite {
    /// Nothing for robots whose mass matrix cannot be indefinite.
    pub(crate) fn of(model: &Model) -> Option<Self> {
        model.may_be_indefinite().then(|| Self {
            kinematics: Kinematics::new(model),
            workspace: Workspace::new(model),
            mass: vec![0.0; model.nv() * model.nv()],
            between: vec![0.0; model.nq()],
        })
    }

    /// Refuses the configuration `q` at time `t` where the mass matrix is not positive definite.
    ///
    /// # Errors
    /// [`RunError::IndefiniteMassMatrix`].
    pub(super) fn check(&mut self, model: &Model, t: f64, q: &[f64]) -> Result<(), RunError> {
        self.kinematics.update_position(model, q);
        match indefinite_joint_into(model, &self.kinematics, &mut self.workspace, &mut self.mass) {
            Some(joint) => Err(RunError::IndefiniteMassMatrix { t, joint: model.joint_names()[joint].clone() }),
            None => Ok(()),
        }
    }

    /// As [`Self::check`], on the way from one time and configuration to another, which is known at its ends alone: a long step of
    /// a smooth motion would pass over a whole turn.
    ///
    /// # Errors
    /// [`RunError::IndefiniteMassMatrix`].
    pub(crate) fn check_way(
        &mut self,
        model: &Model,
        [from, to]: [f64; 2],
        [start, end]: [&[f64]; 2],
    ) -> Result<(), RunError> {
        // Where a floating joint stands makes no difference to what it carries.
        let own = || model.own_joints().filter(|&j| model.joint_space(j) != Space::Pose);
        // Of a quaternion and its negative, which are the same attitude, the nearer to the start.
        let sign_of = |j: usize| {
            let along: f64 = model.q_range(j).map(|k| start[k] * end[k]).sum();
            if model.joint_space(j).quaternion().is_some() && along < 0.0 { -1.0 } else { 1.0 }
        };
        let parts = own().flat_map(|j| {
            let (apart, sign) = match model.joint_space(j).dimension() {
                Some(Dimension::Length) => (SHIFT, 1.0),
                Some(_) => (TURN, 1.0),
                // A component of a quaternion changes by at most half of what it turns.
                None => (0.5 * TURN, sign_of(j)),
            };
            model.q_range(j).map(move |k| (sign * end[k] - start[k]).abs() / apart)
        });
        let count = parts.fold(1.0, f64::max).ceil().min(MOST);
        let mut between = std::mem::take(&mut self.between);
        let outcome = (1..=count as usize).try_for_each(|part| {
            let share = part as f64 / count;
            between.copy_from_slice(end);
            for j in own() {
                let sign = sign_of(j);
                for k in model.q_range(j) {
                    between[k] = start[k] + share * (sign * end[k] - start[k]);
                }
            }
            self.check(model, from + share * (to - from), &between)
        });
        self.between = between;
        outcome
    }
}

impl System {
    /// Refuses a start where the mass matrix is not positive definite.
    ///
    /// # Errors
    /// [`RunError::IndefiniteMassMatrix`].
    pub(crate) fn check_definite(&self, q: &[f64]) -> Result<(), RunError> {
        Definite::of(&self.model).map_or(Ok(()), |mut definite| definite.check(&self.model, 0.0, q))
    }
}
