//! What follows from the state, about rest: the one place that linearises feedback and controllers.

use super::error::LinearError;
use crate::control::{Aim, At, Controlled, ErrorTerm, Feedback, Scratch, TorqueSlopes};
use crate::dynamics::{Kinematics, point_jacobian};
use crate::equations::control::Eye;
use crate::law::Tangent;
use crate::motion::Trajectory;
use crate::signal::Jet;
use crate::system::System;
use num_complex::Complex64;

/// Continuous feedback and a continuous controller under small motions e^{st} of a robot of nv velocities:
///
/// δτ = (∂τ/∂q + s ∂τ/∂v) δq + Σ gain s^order δe + Σ F ∂y/∂q of the elements that are taken off, δe = δq_d − δq.
///
/// Limits of rates do not act on small motions. A force at its limit, and an expression beyond a kink, answer as they do there; sampled laws are
/// not in it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinearControl {
    /// ∂τ/∂q, nv × nv, row-major; the terms apart.
    pub by_q: Vec<f64>,
    /// ∂τ/∂v.
    pub by_v: Vec<f64>,
    /// Integrals and memories of errors.
    pub terms: Vec<ErrorTerm>,
    /// T, s, of a filter 1/(1 + T s) behind those of order above 0.
    pub filter: Option<f64>,
    /// Whether those take −δq in place of δe.
    pub on_measurement: bool,
    /// Inputs of elements that follow from the state.
    pub inputs: Vec<LinearInput>,
    /// Of every velocity, whether its actuator takes the forces of the elements off.
    pub relieved: Vec<bool>,
    /// How torques answer to what the controller aims at, of every joint of its reference.
    pub aims: Vec<LinearAim>,
}

/// An input of an element that follows from the state: δu = (∂u/∂q + s ∂u/∂v) δq.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearInput {
    /// The element.
    pub element: usize,
    /// Which of its inputs.
    pub input: usize,
    /// ∂u/∂q, nv values.
    pub by_q: Vec<f64>,
    /// ∂u/∂v.
    pub by_v: Vec<f64>,
}

/// How torques answer to the reference of one velocity: δτ = (τ_q + s τ_v + s² τ_a) δq_d, the terms apart.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearAim {
    /// The velocity, of a joint of one degree.
    pub velocity: usize,
    /// ∂τ/∂q_d, ∂τ/∂v_d and ∂τ/∂a_d, nv values each.
    pub torque: [Vec<f64>; 3],
}

/// What follows from the state at rest.
pub(super) struct ControlAtRest {
    /// What it adds to the actuator forces (nv), integrals apart.
    pub(super) torque: Vec<f64>,
    /// Where an integral holds a joint (nv): its reference.
    pub(super) held: Vec<Option<f64>>,
    pub(super) linear: LinearControl,
}

/// The inputs that follow from the state at rest: element, input, value.
pub(super) fn inputs<'a>(system: &'a System, eye: &'a Eye) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
    let now = system.control.inputs.iter().filter(|own| own.sampling.is_none());
    now.map(|own| (own.element, own.input, of(&own.law, eye).0))
}

/// What acts at rest, where elements pull by `pull` = Σ F ∂y/∂q (nv), and actuators hold the robot with `needed` beside what signals say (nv).
///
/// # Errors
/// Where the reference cannot be followed, or what follows is no number.
pub(super) fn at_rest(eye: &Eye, pull: &[f64], needed: &[f64]) -> Result<ControlAtRest, LinearError> {
    let (system, n) = (eye.system, eye.v.len());
    let control = &system.control;
    let mut rest = ControlAtRest {
        torque: vec![0.0; n],
        held: vec![None; n],
        linear: LinearControl { relieved: vec![false; n], ..LinearControl::default() },
    };
    if control.is_empty() {
        return Ok(rest);
    }
    rest.linear.by_q = vec![0.0; n * n];
    rest.linear.by_v = vec![0.0; n * n];
    for own in control.torques.iter().filter(|own| own.sampling.is_none()) {
        let (k, (value, by_state)) = (own.velocity, of(&own.law, eye));
        rest.torque[k] += value;
        let linear = &mut rest.linear;
        for (matrix, by) in [&mut linear.by_q, &mut linear.by_v].into_iter().zip(by_state) {
            matrix[k * n..][..n].iter_mut().zip(by).for_each(|(sum, own)| *sum += own);
        }
    }
    for own in control.inputs.iter().filter(|own| own.sampling.is_none()) {
        let (_, [by_q, by_v]) = of(&own.law, eye);
        rest.linear.inputs.push(LinearInput { element: own.element, input: own.input, by_q, by_v });
    }
    if let Some(controlled) = control.controller.as_ref().filter(|controlled| controlled.sampling.is_none()) {
        rest.add(controlled, eye, pull, needed)?;
    }
    if let Some(k) = (0..n).find(|&k| !rest.torque[k].is_finite()) {
        let what = format!("tau.{}", system.model.v_labels()[k].name);
        return Err(LinearError::Value { what, problem: format!("{} is no finite number", rest.torque[k]) });
    }
    Ok(rest)
}

/// The value of an expression, and how it answers to positions and velocities.
fn of(law: &Feedback, eye: &Eye) -> (f64, [Vec<f64>; 2]) {
    let seen: Vec<f64> = law.senses().iter().map(|sense| eye.value(*sense)).collect();
    let jets: Vec<Jet> = seen.iter().map(|value| Jet::constant(*value)).collect();
    let branch = law.expression().branch(eye.t, &jets);
    let mut slopes = Vec::new();
    law.slopes_on(branch, eye.t, &seen, &mut slopes);
    (law.value_on(branch, eye.t, &seen), eye.answer(law, &slopes))
}

impl ControlAtRest {
    /// A controller whose reference stands still where it is at the time.
    fn add(&mut self, controlled: &Controlled, eye: &Eye, pull: &[f64], needed: &[f64]) -> Result<(), LinearError> {
        let (system, n) = (eye.system, eye.v.len());
        let (model, law) = (&*system.model, &*controlled.law);
        let mut scratch = Scratch::new(model);
        let mut aim = Aim::default();
        let spare = &mut Kinematics::new(model);
        controlled.reference.at_into(model, system.gripper.as_ref(), eye.t, spare, &mut aim).map_err(|why| {
            LinearError::Value { what: "the reference of the controller".to_owned(), problem: why.to_string() }
        })?;
        aim.v.fill(0.0);
        aim.a.fill(0.0);
        aim.gripper[1] = [0.0; 3];
        let at = At {
            model,
            gripper: system.gripper.as_ref(),
            t: eye.t,
            q: eye.q,
            v: eye.v,
            kinematics: eye.kinematics,
            aim: &aim,
            shaping: &controlled.shaping,
        };
        let mut tau = vec![0.0; n];
        controlled.torque(&at, &mut scratch, &mut tau);
        let mut slopes = TorqueSlopes { d_q: vec![0.0; n * n], d_v: vec![0.0; n * n] };
        match law.variation() {
            Some(exact) => exact.slopes(&at, &mut scratch, &mut slopes),
            None => law.slopes(&at, &mut scratch, &mut slopes),
        }
        let terms: Vec<ErrorTerm> = controlled.error_terms().into_iter().filter(|term| term.gain != 0.0).collect();
        let mut follows = vec![false; n];
        for k in system.driven_velocities().into_iter().filter(|&k| model.coordinate_of(k).is_some()) {
            let limit = controlled.limits.get(k).map_or(f64::INFINITY, |limit| limit.torque);
            let integrates = terms.iter().any(|term| term.velocity == k && term.order < 0.0);
            let taken = if law.compensates_elements() { pull[k] } else { 0.0 };
            let wanted = if integrates { needed[k] - self.torque[k] } else { tau[k] + taken };
            if wanted.abs() > limit {
                self.torque[k] += limit.copysign(wanted);
                continue;
            }
            follows[k] = true;
            self.torque[k] += tau[k] + taken;
            self.held[k] = model.coordinate_of(k).filter(|_| integrates).map(|place| aim.q[place]);
            let linear = &mut self.linear;
            linear.relieved[k] = law.compensates_elements();
            for (sum, own) in [(&mut linear.by_q, &slopes.d_q), (&mut linear.by_v, &slopes.d_v)] {
                sum[k * n..][..n].iter_mut().zip(&own[k * n..]).for_each(|(sum, own)| *sum += own);
            }
        }
        (self.linear.filter, self.linear.on_measurement) =
            (controlled.shaping.filter, controlled.shaping.on_measurement);
        self.linear.terms = terms.into_iter().filter(|term| follows[term.velocity]).collect();
        self.linear.aims = aims(controlled, &at, spare, &mut scratch, &follows);
        Ok(())
    }
}

/// How torques answer to the joints of a reference.
fn aims(
    controlled: &Controlled,
    at: &At,
    wanted: &mut Kinematics,
    scratch: &mut Scratch,
    follows: &[bool],
) -> Vec<LinearAim> {
    let (model, n) = (at.model, at.v.len());
    let (Trajectory::Prescribed(_), Some(law)) = (controlled.reference.trajectory(), controlled.law.variation()) else {
        return Vec::new();
    };
    wanted.update_velocity(model, &at.aim.q, at.v);
    let jacobian = at.gripper.map(|site| point_jacobian(model, wanted, site));
    let gripper = |k: usize| match &jacobian {
        Some(jacobian) => std::array::from_fn(|axis| jacobian[axis * n + k]),
        None => [0.0; 3],
    };
    let one = |k: usize, place: usize| {
        let torque = std::array::from_fn(|order| {
            let mut change = Aim { q: vec![0.0; model.nq()], v: vec![0.0; n], a: vec![0.0; n], gripper: [[0.0; 3]; 2] };
            match order {
                0 => (change.q[place], change.gripper[0]) = (1.0, gripper(k)),
                1 => (change.v[k], change.gripper[1]) = (1.0, gripper(k)),
                _ => change.a[k] = 1.0,
            }
            let mut tau = vec![0.0; n];
            law.add_by_aim(at, &change, scratch, &mut tau);
            tau.iter_mut().zip(follows).filter(|(_, follows)| !**follows).for_each(|(tau, _)| *tau = 0.0);
            tau
        });
        LinearAim { velocity: k, torque }
    };
    let mut one = one;
    (0..n).filter_map(|k| model.coordinate_of(k).map(|place| one(k, place))).collect()
}

/// An element at rest as it holds the robot.
pub(super) struct Holding<'a> {
    pub(super) gradient: &'a [f64],
    pub(super) hessian: Vec<f64>,
    pub(super) force: f64,
    /// dF/dx that remains.
    pub(super) stiffness: f64,
    pub(super) tangent: &'a Tangent,
    pub(super) stretch: Option<(usize, f64)>,
}

impl LinearControl {
    /// What holds the robot at rest, nv × nv: `stiffness` is that of gravity and of the forces that the `elements` keep. Integrals apart.
    pub(super) fn static_stiffness(&self, mut stiffness: Vec<f64>, elements: &[Holding]) -> Vec<f64> {
        let n = stiffness.len().isqrt();
        stiffness.iter_mut().zip(&self.by_q).for_each(|(sum, by_q)| *sum -= by_q);
        for (e, element) in elements.iter().enumerate() {
            for r in 0..n {
                if self.relieved.get(r) == Some(&true) {
                    (0..n).for_each(|c| stiffness[r * n + c] -= element.force * element.hessian[r * n + c]);
                    continue;
                }
                let push = element.gradient[r];
                for c in 0..n {
                    stiffness[r * n + c] += element.stiffness * push * element.gradient[c];
                }
                for own in self.inputs.iter().filter(|own| own.element == e) {
                    let stretch = element.stretch.filter(|(input, _)| *input == own.input).map_or(0.0, |(_, by)| by);
                    let gain = element.tangent.gain(Complex64::ZERO, own.input).re + stretch * element.stiffness;
                    (0..n).for_each(|c| stiffness[r * n + c] += gain * push * own.by_q[c]);
                }
            }
        }
        stiffness
    }

    /// The terms that keep a number of their own: integrals, and derivatives behind a filter.
    pub(super) fn kept(&self) -> impl Iterator<Item = &ErrorTerm> {
        self.terms.iter().filter(|term| term.order < 0.0 || self.filter.is_some())
    }

    /// Whether an integral holds velocity `k`.
    pub(super) fn integrates(&self, k: usize) -> bool {
        self.terms.iter().any(|term| term.velocity == k && term.order < 0.0)
    }
}
