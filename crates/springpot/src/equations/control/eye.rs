//! Senses as numbers: their values, time derivatives and slopes.

use crate::collocation::MAX_NODES;
use crate::control::{Feedback, Sense};
use crate::dynamics::{Kinematics, point_jacobian, point_jacobian_rate};
use crate::signal::Jet;
use crate::system::System;

/// Coordinate y and rate y' of an element.
pub(crate) type Read = [f64; 2];

/// The robot at one time, before forces are known.
#[derive(Clone, Copy)]
pub(crate) struct Eye<'a> {
    pub(crate) system: &'a System,
    pub(crate) t: f64,
    pub(crate) q: &'a [f64],
    pub(crate) v: &'a [f64],
    /// Positions and velocities there.
    pub(crate) kinematics: &'a Kinematics,
    /// What an element shows.
    pub(crate) element: &'a dyn Fn(usize) -> Read,
}

/// ∂s/∂q and ∂s/∂v of a sense, nv values each.
pub(crate) type Slopes = [Vec<f64>; 2];

/// How an input answers to the state, and the force of its element to it.
#[derive(Debug, Clone, Default)]
pub(crate) struct InputSlopes {
    pub(crate) element: usize,
    /// ∂u/∂q and ∂u/∂v at the start of the step.
    pub(crate) by_state: Slopes,
    /// ∂F_i/∂u_j.
    pub(crate) force: [[f64; MAX_NODES]; MAX_NODES],
}

impl Eye<'_> {
    /// The value of a sense; NaN of one that follows from forces.
    pub(crate) fn value(&self, sense: Sense) -> f64 {
        let site = || self.system.gripper.as_ref().expect("a gripper that is named");
        match sense {
            Sense::Coordinate { place, .. } | Sense::Part { place, .. } => self.q[place],
            Sense::Velocity(k) => self.v[k],
            Sense::Length(e) => (self.element)(e)[0],
            Sense::Stroke(e) => self.system.elements[e].stroke((self.element)(e)[0]),
            Sense::Rate(e) => (self.element)(e)[1],
            Sense::Gripper(along) => self.kinematics.position(site()).0[along.index()],
            Sense::GripperVelocity(along) => self.kinematics.velocity(site()).0[along.index()],
            Sense::Acceleration(_) | Sense::Force(_) | Sense::Derivative(_) => f64::NAN,
        }
    }

    /// The same with its time derivative under accelerations `a`.
    pub(super) fn jet(&self, sense: Sense, a: &[f64]) -> Jet {
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let first = match sense {
            Sense::Coordinate { velocity, .. } => self.v[velocity],
            Sense::Velocity(k) => a[k],
            Sense::Length(e) | Sense::Stroke(e) => (self.element)(e)[1],
            Sense::Gripper(along) => self.value(Sense::GripperVelocity(along)),
            Sense::Part { .. } | Sense::Rate(_) | Sense::GripperVelocity(_) => {
                let [by_q, by_v] = self.slopes(sense);
                dot(&by_q, self.v) + dot(&by_v, a)
            }
            Sense::Acceleration(_) | Sense::Force(_) | Sense::Derivative(_) => f64::NAN,
        };
        // Where nothing moves yet, what moves first is told by the second derivative.
        let second = match sense {
            Sense::Coordinate { velocity, .. } => a[velocity],
            Sense::Part { .. } if first == 0.0 => dot(&self.slopes(sense)[0], a),
            Sense::Length(e) | Sense::Stroke(e) if first == 0.0 => self.jet(Sense::Rate(e), a).first,
            Sense::Gripper(along) if first == 0.0 => self.jet(Sense::GripperVelocity(along), a).first,
            _ => 0.0,
        };
        Jet { value: self.value(sense), first, second }
    }

    /// How a sense answers to positions and velocities.
    pub(crate) fn slopes(&self, sense: Sense) -> Slopes {
        let (model, n) = (&self.system.model, self.system.model.nv());
        let mut slopes = [vec![0.0; n], vec![0.0; n]];
        let site = || self.system.gripper.as_ref().expect("a gripper that is named");
        match sense {
            Sense::Coordinate { velocity, .. } => slopes[0][velocity] = 1.0,
            Sense::Part { place, joint } => {
                let (own, range) = (model.q_range(joint), model.v_range(joint));
                let by_joint = model.joint_space(joint).slopes(&self.q[own.clone()], place - own.start);
                slopes[0][range.clone()].copy_from_slice(&by_joint[..range.len()]);
            }
            Sense::Velocity(k) => slopes[1][k] = 1.0,
            Sense::Length(e) | Sense::Stroke(e) => {
                slopes[0] = self.system.elements[e].measure.read(model, self.kinematics).1;
            }
            Sense::Rate(e) => {
                let measure = &self.system.elements[e].measure;
                let hessian = measure.hessian(model, self.kinematics);
                for (line, v) in hessian.chunks_exact(n).zip(self.v) {
                    slopes[0].iter_mut().zip(line).for_each(|(slope, second)| *slope += second * v);
                }
                slopes[1] = measure.read(model, self.kinematics).1;
            }
            Sense::Gripper(along) => {
                slopes[0].copy_from_slice(&point_jacobian(model, self.kinematics, site())[along.index() * n..][..n]);
            }
            Sense::GripperVelocity(along) => {
                let row = along.index() * n..(along.index() + 1) * n;
                slopes[0].copy_from_slice(&point_jacobian_rate(model, self.kinematics, site())[row.clone()]);
                slopes[1].copy_from_slice(&point_jacobian(model, self.kinematics, site())[row]);
            }
            Sense::Acceleration(_) | Sense::Force(_) | Sense::Derivative(_) => {}
        }
        slopes
    }

    /// How an expression answers to positions and velocities, whose slopes by its senses are these.
    pub(crate) fn answer(&self, law: &Feedback, by_sense: &[f64]) -> Slopes {
        let n = self.system.model.nv();
        let mut by_state = [vec![0.0; n], vec![0.0; n]];
        for (sense, slope) in law.senses().iter().zip(by_sense).filter(|(_, slope)| **slope != 0.0) {
            for (sum, of_sense) in by_state.iter_mut().zip(self.slopes(*sense)) {
                sum.iter_mut().zip(of_sense).for_each(|(sum, own)| *sum += slope * own);
            }
        }
        by_state
    }
}

/// What follows from forces, just before a sample.
pub(crate) trait Shown {
    /// Force of an element, N or N·m.
    fn force(&self, e: usize) -> f64;

    /// D^alpha x of an element.
    fn derivative(&self, e: usize) -> f64;

    /// An acceleration, rad/s² or m/s².
    fn acceleration(&self, k: usize) -> f64;

    /// Adds Σ F·∂y/∂q of all elements (nv).
    fn add_pull(&self, tau: &mut [f64]);
}
