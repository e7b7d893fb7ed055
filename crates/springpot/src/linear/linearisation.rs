//! The equations of small motions about a configuration.

use super::control::LinearControl;
use super::error::LinearError;
use super::statics::ElementAtRest;
use crate::dynamics::point_jacobian;
use crate::law::{Heated, Tangent};
use crate::model::{FrictionLaw, Model};
use crate::system::System;
use std::sync::Arc;

/// A system about a configuration at rest: M s² + D s + K + Σ K_e*(s) g_e g_eᵀ, and what follows from the state beside it. Matrices are nv × nv,
/// row-major.
#[derive(Debug, Clone)]
pub struct Linearisation {
    /// The configuration, nq values.
    pub q: Vec<f64>,
    /// The velocities that forces move, in rising order; signals move the others, or nothing does.
    pub free: Vec<usize>,
    /// Mass matrix M.
    pub mass: Vec<f64>,
    /// D of damping and friction of joints.
    pub damping: Vec<f64>,
    /// K of gravity and of the forces that the elements keep: ∂g/∂q + Σ F_e ∂²y_e.
    pub stiffness: Vec<f64>,
    /// The elements, in their order.
    pub elements: Vec<LinearElement>,
    /// Feedback and controllers that act at every time.
    pub control: LinearControl,
    /// The torque that is missing for an equilibrium on every velocity that forces move, else 0 (nv). Kinematics that are given have actuators
    /// that hold them.
    pub left_over: Vec<f64>,
    /// The joints that friction which sticks would hold; it has no part in what is linear.
    pub sticking: Vec<String>,
    pub(super) model: Arc<Model>,
    /// The sum of the magnitudes of all that acts on every velocity (nv).
    pub(super) sizes: Vec<f64>,
    /// The velocities of joints of one degree that signals move.
    pub(super) moved: Vec<usize>,
    /// ∂q/∂ξ of coordinates by tangent steps, nq × nv.
    pub(super) coordinates: Vec<f64>,
    /// Jacobian of the gripper, 3 × nv.
    pub(super) gripper: Option<Vec<f64>>,
}

/// An element about rest.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearElement {
    /// Its name.
    pub name: String,
    /// x, m or rad.
    pub stroke: f64,
    /// F that remains, N or N·m.
    pub force: f64,
    /// ∂y/∂q_b, nv values.
    pub gradient: Vec<f64>,
    /// Its law under small motions.
    pub tangent: Tangent,
    /// How many inputs it has.
    pub(super) inputs: usize,
    /// An input that stretches it, and by how much per unit of it.
    pub(super) stretch: Option<(usize, f64)>,
    /// ∂²y/∂q_a∂q_b, nv × nv.
    pub(super) hessian: Vec<f64>,
}

impl System {
    /// The small motions about the configuration `q` (nq) at rest, torques and inputs as they are at `t`.
    ///
    /// Forces that remain are those after endless rest: springpots and dashpots carry nothing. Where kinematics are given all joints are
    /// free and the actuators hold the configuration with constant forces; of forward dynamics, prescribed and locked joints stand still.
    /// Of what follows from the state ([`System::control`]) all that acts at every time is in it, its reference as it is at `t` standing still;
    /// where an integral acts it holds its joint with whatever that takes. What is sampled is left out.
    ///
    /// # Errors
    /// [`LinearError`].
    pub fn linearised(&self, q: &[f64], t: f64) -> Result<Linearisation, LinearError> {
        if let Some(value) = q.iter().find(|value| !value.is_finite()) {
            return Err(LinearError::Value { what: "q".to_owned(), problem: format!("{value} is no finite number") });
        }
        let model = &self.model;
        let statics = self.at_rest(q, t, &self.strokes_at_start())?;
        let free = self.moved_by_forces();
        let mut left_over = vec![0.0; model.nv()];
        free.iter().for_each(|&k| left_over[k] = statics.missing(k));
        let sizes = (0..model.nv()).map(|k| statics.size(k)).collect();
        let mut damping = vec![0.0; model.nv() * model.nv()];
        crate::equations::resistance::add_tangents(self, &vec![0.0; model.nv()], &mut damping);
        let sticks = |&j: &usize| model.friction()[j] > 0.0 && model.friction_laws()[j] == FrictionLaw::Sticking;
        let sticking = (0..model.joint_count()).filter(sticks).map(|j| model.joint_names()[j].clone()).collect();
        let linear = |(element, at): (&crate::elements::Element, ElementAtRest)| LinearElement {
            name: element.name.clone(),
            stroke: at.stroke,
            force: at.law.force,
            gradient: at.gradient,
            tangent: at.law.tangent,
            inputs: element.entry.inputs.len(),
            stretch: element.law.as_heated().and_then(Heated::stretch),
            hessian: element.measure.hessian(model, &statics.kinematics),
        };
        let elements = self.elements.iter().zip(statics.elements).map(linear).collect();
        let gripper = self.gripper.as_ref().map(|site| point_jacobian(model, &statics.kinematics, site));
        Ok(Linearisation {
            q: q.to_vec(),
            free,
            mass: statics.slopes.d_a,
            damping,
            stiffness: statics.slopes.d_q,
            elements,
            control: statics.control.linear,
            left_over,
            sticking,
            model: self.model.clone(),
            sizes,
            moved: self.moved_by_signals(),
            coordinates: coordinate_slopes(model, q),
            gripper,
        })
    }
}

impl Linearisation {
    /// The largest torque that is missing for an equilibrium: its velocity, its size and its unit; `None` where it is rounding.
    pub fn largest_left_over(&self) -> Option<(String, f64, &'static str)> {
        let size = |k: &usize| self.left_over[*k].abs();
        let k = self.free.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let terms = self.sizes[k] + size(&k);
        let label = &self.model.v_labels()[k];
        let is_rounding = size(&k) <= 1e-9 * terms.max(1e-3);
        (!is_rounding).then(|| (label.name.clone(), size(&k), label.dimension.units().force))
    }

    /// The names of the velocities, in their order.
    pub fn velocity_names(&self) -> Vec<String> {
        self.model.v_labels().into_iter().map(|label| label.name).collect()
    }
}

/// ∂q/∂ξ of q ⊕ ξ: 1 but for the numbers of floating joints.
fn coordinate_slopes(model: &Model, q: &[f64]) -> Vec<f64> {
    let (nq, nv) = (model.nq(), model.nv());
    let mut slopes = vec![0.0; nq * nv];
    for j in model.own_joints() {
        let (places, rates) = (model.q_range(j), model.v_range(j));
        for k in rates.clone() {
            if rates.len() == 1 {
                slopes[places.start * nv + k] = 1.0;
                continue;
            }
            let h = 1e-4;
            let moved = |factor: f64| {
                let mut step = vec![0.0; nv];
                step[k] = factor * h;
                model.integrate(q, &step)
            };
            let [far, near, back, farther] = [2.0, 1.0, -1.0, -2.0].map(moved);
            for i in places.clone() {
                slopes[i * nv + k] = (8.0 * (near[i] - back[i]) - (far[i] - farther[i])) / (12.0 * h);
            }
        }
    }
    slopes
}
