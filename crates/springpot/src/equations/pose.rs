//! Where the robot and its elements are, without running anything.

use super::evaluate::{Evaluation, Scratch};
use crate::control::Aim;
use crate::dynamics::Kinematics;
use crate::model::{Anchor, Model, Parent};
use crate::spatial::Vec3;
use crate::system::error::RunError;
use crate::system::{Motion, System};

/// An element at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementStart {
    /// y(0): the length of a line, m, or the coordinate of a joint, m or rad.
    pub length: f64,
    /// x(0), m or rad.
    pub stroke: f64,
    /// ∂y/∂q_b, nv values.
    pub gradient: Vec<f64>,
    /// Whether its energies are unknown since it was unloaded and jumps to x(0) ≠ 0.
    pub singular: bool,
    /// Whether its energies are unknown for that or another reason.
    pub hides_energy: bool,
    /// Whether its force is infinite then, as that of a springpot is; in series with a spring it is not.
    pub infinite: bool,
}

/// The motion at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Coordinates, nq values.
    pub q: Vec<f64>,
    /// Velocities, nv values.
    pub v: Vec<f64>,
    /// Accelerations, nv values.
    pub a: Vec<f64>,
}

/// The robot in one configuration.
#[derive(Debug, Clone)]
pub struct Pose<'a> {
    model: &'a Model,
    kinematics: Kinematics,
}

impl System {
    /// Every element at t = 0.
    ///
    /// # Errors
    /// What keeps a run from starting.
    pub fn element_starts(&self) -> Result<Vec<ElementStart>, RunError> {
        let mut evaluation = Evaluation::new(self);
        let State { q, v, a } = self.state(0.0)?;
        self.check_definite(&q)?;
        (evaluation.q, evaluation.v, evaluation.a) = (q, v, a);
        self.context().fill(0.0, 0.0, None, &mut Scratch::new(&self.model), &mut evaluation)?;
        let starts = self.elements.iter().zip(evaluation.elements).map(|(element, state)| {
            let begun = element.begin(state.reading.coordinate, &state.inputs);
            let law = begun.map_err(RunError::of_kernel(&element.name))?;
            let (singular, infinite) = (!law.has_finite_work(), law.is_singular());
            let hides_energy = singular || !law.is_accounted();
            let (length, stroke) = (state.reading.coordinate, state.stroke);
            Ok(ElementStart { length, stroke, gradient: state.gradient, singular, infinite, hides_energy })
        });
        starts.collect()
    }

    /// The robot at time t.
    ///
    /// # Errors
    /// [`RunError::Path`] where the motion cannot be followed.
    pub fn pose(&self, t: f64) -> Result<Pose<'_>, RunError> {
        let state = self.state(t)?;
        Ok(Pose { model: &self.model, kinematics: Kinematics::at_position(&self.model, &state.q) })
    }

    /// Coordinates, velocities and accelerations at time t; of forward dynamics where it starts, without the accelerations that follow from forces.
    ///
    /// # Errors
    /// [`RunError::Path`] where the motion cannot be followed.
    pub fn state(&self, t: f64) -> Result<State, RunError> {
        let (nq, nv) = (self.model.nq(), self.model.nv());
        let mut state = State { q: vec![0.0; nq], v: vec![0.0; nv], a: vec![0.0; nv] };
        if let Motion::Forward(forward) = &self.motion {
            state.q.copy_from_slice(&forward.q);
            state.v.copy_from_slice(&forward.v);
        }
        let at_start = matches!(self.motion, Motion::Forward(_));
        self.place(if at_start { 0.0 } else { t }, &mut state)?;
        Ok(state)
    }

    /// Where the gripper is to be at time t, m, world axes: on its path, or where the reference of a controller has it; `None` where nothing says so.
    ///
    /// # Errors
    /// [`RunError::Path`] where the path or the reference cannot be followed.
    pub fn wanted(&self, t: f64) -> Result<Option<[f64; 3]>, RunError> {
        let (nq, nv) = (self.model.nq(), self.model.nv());
        match (&self.motion, &self.control.controller) {
            (Motion::Given(trajectory), _) => {
                let wanted =
                    trajectory.at(&self.model, t, &mut vec![0.0; nq], &mut vec![0.0; nv], &mut vec![0.0; nv])?;
                Ok(wanted.map(|wanted| wanted.position))
            }
            (Motion::Forward(_), Some(controlled)) if self.gripper.is_some() => {
                let (mut kinematics, mut aim) = (Kinematics::new(&self.model), Aim::default());
                controlled.reference.at_into(&self.model, self.gripper.as_ref(), t, &mut kinematics, &mut aim)?;
                Ok(Some(aim.gripper[0]))
            }
            (Motion::Forward(_), _) => Ok(None),
        }
    }

    /// Puts what is given in advance of the motion at time t into `state`: all of it, or prescribed joints.
    ///
    /// # Errors
    /// [`RunError::Path`] where the motion cannot be followed.
    pub(crate) fn place(&self, t: f64, state: &mut State) -> Result<(), RunError> {
        let State { q, v, a } = state;
        match &self.motion {
            Motion::Given(trajectory) => {
                trajectory.at(&self.model, t, q, v, a)?;
            }
            Motion::Forward(forward) => {
                for (j, path) in forward.paths(&self.model) {
                    let (own, velocities) = (self.model.q_range(j), self.model.v_range(j));
                    path.at(t, &mut q[own], &mut v[velocities.clone()], &mut a[velocities]);
                }
            }
        }
        Ok(())
    }
}

impl Pose<'_> {
    /// World position of a body's joint frame, m; the origin for a body that does not exist.
    pub fn origin(&self, body: Parent) -> [f64; 3] {
        self.point(&Anchor { body, point: [0.0; 3] })
    }

    /// World position of a point, m; the origin for a body that does not exist.
    pub fn point(&self, anchor: &Anchor) -> [f64; 3] {
        self.model.resolve(anchor).map_or([0.0; 3], |site| self.kinematics.position(&site).0)
    }

    /// World components of what moving joint `joint` turns about or shifts along.
    pub fn joint_axis(&self, joint: usize) -> [f64; 3] {
        self.kinematics.link(joint + 1).rotation.z_axis().0
    }

    /// World components of a direction given in a body's axes.
    pub fn direction(&self, body: Parent, direction: [f64; 3]) -> [f64; 3] {
        self.model.frame(body).map_or(direction, |frame| (self.kinematics.frame(&frame).rotation * Vec3(direction)).0)
    }
}
