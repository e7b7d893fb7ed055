//! What a law of control says of its derivatives: exact, for runs that are differentiated by parameters.

use super::computed_torque::ComputedTorque;
use super::controller::{Aim, At, ErrorTerm, Scratch, TorqueSlopes};
use super::impedance::Impedance;
use super::pd_gravity::PdGravity;
use super::pid::Pid;
use crate::dynamics::{gravity_into, point_jacobian_into, point_jacobian_rate_into, rnea_at_into};
use crate::model::Model;
use crate::spatial::Vec3;
use std::fmt;

/// What a law of control answers where its run is differentiated; forces without their error terms throughout, and joints of one degree alone.
pub trait ControllerVariation: fmt::Debug + Send + Sync {
    /// The same law of a robot of `nv` velocities, of which `velocities` are those that it is about, in their order.
    fn on(&self, velocities: &[usize], nv: usize) -> Box<dyn ControllerVariation>;

    /// Adds ∂τ/∂q and ∂τ/∂v, nv × nv, row-major. Nothing may be left out.
    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes);

    /// Adds what changes of τ (nv) where what it aims at changes by `change`.
    fn add_by_aim(&self, at: &At, change: &Aim, scratch: &mut Scratch, tau: &mut [f64]);

    /// Adds what changes of τ (nv) with the robot that it knows.
    fn add_by_robot(&self, at: &At, change: RobotChange, scratch: &mut Scratch, tau: &mut [f64]);

    /// Whether it has such a number, by which it is differentiated.
    fn has(&self, number: &ControllerNumber) -> bool;

    /// Adds `by` times ∂τ/∂number (nv).
    fn add_by_number(&self, number: &ControllerNumber, by: f64, at: &At, scratch: &mut Scratch, tau: &mut [f64]);

    /// The error terms that a number moves.
    fn terms_by_number(&self, _number: &ControllerNumber) -> Vec<TermChange> {
        Vec::new()
    }
}

/// A number of a controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControllerNumber {
    /// Its name: `kp`, `kd`, `ki`, `lambda`, `mu`.
    pub name: String,
    /// The velocity that it belongs to; `None`: it acts at the gripper.
    pub velocity: Option<usize>,
}

/// What changes of the robot that a controller knows.
#[derive(Debug, Clone, Copy)]
pub enum RobotChange<'a> {
    /// Inertias, by those of this model.
    Inertia(&'a Model),
    /// The field of gravity, by that of this model.
    Gravity(&'a Model),
}

/// An error term, and by how much it changes with one unit of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermChange {
    /// As it is.
    pub term: ErrorTerm,
    /// ∂gain.
    pub gain: f64,
    /// ∂order.
    pub order: f64,
}

impl ControllerNumber {
    /// The same of another robot, whose velocities are these.
    pub(crate) fn of_robot(&self, velocities: &[usize]) -> Self {
        Self { name: self.name.clone(), velocity: self.velocity.map(|k| velocities[k]) }
    }

    /// Which velocity it belongs to, where it is called `name`.
    fn of(&self, name: &str) -> Option<usize> {
        self.velocity.filter(|_| self.name == name)
    }
}

/// `values` of the velocities of another robot; 0 for all others.
fn spread(values: &[f64], velocities: &[usize], nv: usize) -> Vec<f64> {
    let mut spread = vec![0.0; nv];
    velocities.iter().zip(values).for_each(|(&k, value)| spread[k] = *value);
    spread
}

fn add_gravity(change: RobotChange, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
    let (RobotChange::Inertia(model) | RobotChange::Gravity(model)) = change;
    gravity_into(model, at.kinematics, &mut scratch.workspace, &mut scratch.row);
    tau.iter_mut().zip(&scratch.row).for_each(|(tau, own)| *tau += own);
}

impl ControllerVariation for PdGravity {
    fn on(&self, velocities: &[usize], nv: usize) -> Box<dyn ControllerVariation> {
        Box::new(Self { kp: spread(&self.kp, velocities, nv), kd: spread(&self.kd, velocities, nv) })
    }

    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        super::Controller::slopes(self, at, scratch, slopes);
    }

    fn add_by_aim(&self, at: &At, change: &Aim, _: &mut Scratch, tau: &mut [f64]) {
        for (k, tau) in tau.iter_mut().enumerate() {
            let [error, rate] = change.moved(at, k);
            *tau += self.kp[k] * error + self.kd[k] * rate;
        }
    }

    fn add_by_robot(&self, at: &At, change: RobotChange, scratch: &mut Scratch, tau: &mut [f64]) {
        add_gravity(change, at, scratch, tau);
    }

    fn has(&self, number: &ControllerNumber) -> bool {
        number.of("kp").or(number.of("kd")).is_some()
    }

    fn add_by_number(&self, number: &ControllerNumber, by: f64, at: &At, _: &mut Scratch, tau: &mut [f64]) {
        for (name, which) in [("kp", 0), ("kd", 1)] {
            if let Some(k) = number.of(name) {
                tau[k] += by * at.error(k)[which];
            }
        }
    }
}

impl ControllerVariation for ComputedTorque {
    fn on(&self, velocities: &[usize], nv: usize) -> Box<dyn ControllerVariation> {
        let [kp, kd] = [&self.kp, &self.kd].map(|gains| spread(gains, velocities, nv));
        Box::new(Self { kp, kd, compensate_elements: self.compensate_elements })
    }

    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        super::Controller::slopes(self, at, scratch, slopes);
    }

    fn add_by_aim(&self, at: &At, change: &Aim, scratch: &mut Scratch, tau: &mut [f64]) {
        let mut wanted = change.a.clone();
        for (k, wanted) in wanted.iter_mut().enumerate() {
            let [error, rate] = change.moved(at, k);
            *wanted += self.kp[k] * error + self.kd[k] * rate;
        }
        self.add_mass(at, &wanted, scratch, tau);
    }

    fn add_by_robot(&self, at: &At, change: RobotChange, scratch: &mut Scratch, tau: &mut [f64]) {
        let RobotChange::Inertia(model) = change else { return add_gravity(change, at, scratch, tau) };
        self.accelerations(at, &mut scratch.row);
        let mut own = vec![0.0; tau.len()];
        rnea_at_into(model, at.kinematics, at.q, &scratch.row, &[], &mut scratch.workspace, &mut own);
        tau.iter_mut().zip(&own).for_each(|(tau, own)| *tau += own);
    }

    fn has(&self, number: &ControllerNumber) -> bool {
        number.of("kp").or(number.of("kd")).is_some()
    }

    fn add_by_number(&self, number: &ControllerNumber, by: f64, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
        let mut wanted = vec![0.0; tau.len()];
        for (name, which) in [("kp", 0), ("kd", 1)] {
            if let Some(k) = number.of(name) {
                wanted[k] += by * at.error(k)[which];
            }
        }
        self.add_mass(at, &wanted, scratch, tau);
    }
}

impl ComputedTorque {
    /// Adds M·a.
    fn add_mass(&self, at: &At, a: &[f64], scratch: &mut Scratch, tau: &mut [f64]) {
        let Scratch { workspace, derivatives, row, .. } = scratch;
        row.fill(0.0);
        crate::dynamics::rnea_derivatives_into(at.model, at.kinematics, row, &[], workspace, derivatives);
        for (tau, line) in tau.iter_mut().zip(derivatives.d_a.chunks_exact(a.len())) {
            *tau += line.iter().zip(a).map(|(m, a)| m * a).sum::<f64>();
        }
    }
}

impl ControllerVariation for Pid {
    fn on(&self, velocities: &[usize], nv: usize) -> Box<dyn ControllerVariation> {
        let [kp, ki, kd] = [&self.kp, &self.ki, &self.kd].map(|gains| spread(gains, velocities, nv));
        let [lambda, mu] = [&self.lambda, &self.mu].map(|orders| spread(orders, velocities, nv));
        Box::new(Self { kp, ki, kd, lambda, mu })
    }

    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        super::Controller::slopes(self, at, scratch, slopes);
    }

    fn add_by_aim(&self, at: &At, change: &Aim, _: &mut Scratch, tau: &mut [f64]) {
        for (k, tau) in tau.iter_mut().enumerate() {
            let [error, rate] = change.moved(at, k);
            *tau += self.kp[k] * error + if self.mu[k] == 1.0 { self.kd[k] * rate } else { 0.0 };
        }
    }

    fn add_by_robot(&self, _: &At, _: RobotChange, _: &mut Scratch, _: &mut [f64]) {}

    fn has(&self, number: &ControllerNumber) -> bool {
        let is_inside = |order: f64| 0.0 < order && order < 1.0;
        let orders = [("lambda", &self.lambda), ("mu", &self.mu)];
        ["kp", "kd", "ki"].into_iter().any(|name| number.of(name).is_some())
            || orders.into_iter().any(|(name, orders)| number.of(name).is_some_and(|k| is_inside(orders[k])))
    }

    fn add_by_number(&self, number: &ControllerNumber, by: f64, at: &At, _: &mut Scratch, tau: &mut [f64]) {
        if let Some(k) = number.of("kp") {
            tau[k] += by * at.error(k)[0];
        }
        if let Some(k) = number.of("kd").filter(|&k| self.mu[k] == 1.0) {
            tau[k] += by * at.error(k)[1];
        }
    }

    fn terms_by_number(&self, number: &ControllerNumber) -> Vec<TermChange> {
        let integral = |k: usize| ErrorTerm { velocity: k, order: -self.lambda[k], gain: self.ki[k] };
        let derivative = |k: usize| ErrorTerm { velocity: k, order: self.mu[k], gain: self.kd[k] };
        let all = [
            number.of("ki").map(|k| TermChange { term: integral(k), gain: 1.0, order: 0.0 }),
            number.of("lambda").map(|k| TermChange { term: integral(k), gain: 0.0, order: -1.0 }),
            number.of("kd").filter(|&k| self.mu[k] < 1.0).map(|k| TermChange {
                term: derivative(k),
                gain: 1.0,
                order: 0.0,
            }),
            number.of("mu").map(|k| TermChange { term: derivative(k), gain: 0.0, order: 1.0 }),
        ];
        all.into_iter().flatten().collect()
    }
}

impl ControllerVariation for Impedance {
    fn on(&self, _: &[usize], _: usize) -> Box<dyn ControllerVariation> {
        Box::new(*self)
    }

    /// −∂Q_g/∂q + Jᵀ ∂F/∂q + Σ ∂J_iᵀ/∂q F_i, where ∂J/∂q_c is the rate of J under the unit velocity c.
    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        super::Controller::slopes(self, at, scratch, slopes);
        let (Some(site), n, Vec3(force)) = (at.gripper, at.model.nv(), self.force(at)) else { return };
        let Scratch { kinematics, row, jacobians: [_, rate], .. } = scratch;
        for c in 0..n {
            row.fill(0.0);
            row[c] = 1.0;
            kinematics.update_velocity(at.model, at.q, row);
            point_jacobian_rate_into(at.model, kinematics, site, rate);
            for (rate, force) in rate.chunks_exact(n).zip(force) {
                (0..n).for_each(|b| slopes.d_q[b * n + c] += rate[b] * force);
            }
        }
    }

    fn add_by_aim(&self, at: &At, change: &Aim, scratch: &mut Scratch, tau: &mut [f64]) {
        let [position, mut velocity] = change.gripper.map(Vec3);
        if at.shaping.on_measurement {
            velocity = Vec3::default();
        }
        self.add_pull(at, position * self.kp + velocity * self.kd, scratch, tau);
    }

    fn add_by_robot(&self, at: &At, change: RobotChange, scratch: &mut Scratch, tau: &mut [f64]) {
        add_gravity(change, at, scratch, tau);
    }

    fn has(&self, number: &ControllerNumber) -> bool {
        number.velocity.is_none() && matches!(&*number.name, "kp" | "kd")
    }

    fn add_by_number(&self, number: &ControllerNumber, by: f64, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
        let (kp, kd) = if number.name == "kp" { (by, 0.0) } else { (0.0, by) };
        self.add_pull(at, Self { kp, kd }.force(at), scratch, tau);
    }
}

impl Impedance {
    /// Adds J_Hᵀ·force.
    fn add_pull(&self, at: &At, force: Vec3, scratch: &mut Scratch, tau: &mut [f64]) {
        let Some(site) = at.gripper else { return };
        let [jacobian, _] = &mut scratch.jacobians;
        point_jacobian_into(at.model, at.kinematics, site, jacobian);
        for (row, force) in jacobian.chunks_exact(at.model.nv()).zip(force.0) {
            tau.iter_mut().zip(row).for_each(|(tau, column)| *tau += column * force);
        }
    }
}

impl Aim {
    /// What an aim that changes by this changes of what the proportional and the derivative part of velocity `k` take.
    fn moved(&self, at: &At, k: usize) -> [f64; 2] {
        let takes_rate = at.shaping.filter.is_none() && !at.shaping.on_measurement;
        let rate = if takes_rate { self.v[k] } else { 0.0 };
        at.model.coordinate_of(k).map_or([0.0; 2], |place| [at.shaping.weight(k) * self.q[place], rate])
    }
}
