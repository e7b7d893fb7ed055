//! Accelerations from places and velocities of one time, where no law keeps anything: what explicit methods ask.

use crate::collocation::STAGES;
use crate::dynamics::{Kinematics, Workspace, crba_into};
use crate::elements::{Forces, NoDirection, Pull, Reading};
use crate::equations::assembly::Equations;
use crate::equations::context::Context;
use crate::equations::control::Eye;
use crate::equations::drives::force_at;
use crate::equations::resistance::{add_smooth_resistance, joint_loss};
use crate::equations::solve::Solve;
use crate::law::Power;
use crate::model::Model;
use crate::system::System;
use crate::system::error::RunError;

/// Where in the bank it is told.
const POINT: usize = 1;

/// Powers that belong to no element: of the actuators, and what joints lose, W. Behind them stand two of each element, dissipated and supplied.
pub(crate) const OWN_POWERS: usize = 2;

/// What was found at the time that was asked about last.
#[derive(Debug)]
pub(crate) struct AtOnce {
    pub(crate) kinematics: Kinematics,
    pub(crate) readings: Vec<Reading>,
    pub(crate) forces: Forces,
    /// The first element that has no direction, and why.
    pub(crate) lost: Option<(usize, NoDirection)>,
    workspace: Workspace,
    gradient: Vec<f64>,
    /// Forces of the actuators, what joints resist by, and what of the forces is left without the accelerations that are sought (nv).
    driven: Vec<f64>,
    tau: Vec<f64>,
    left: Vec<f64>,
    /// What elements pull by, where a controller takes that off (nv).
    pull: Vec<f64>,
    /// Whether forces drive all joints.
    is_free: bool,
    mass: Vec<f64>,
    solve: Solve,
    right: Vec<f64>,
}

impl AtOnce {
    pub(crate) fn new(system: &System, free: usize) -> Self {
        let model = &system.model;
        let zero = || vec![0.0; model.nv()];
        let is_free = free == model.nv();
        let mass = if is_free { Vec::new() } else { vec![0.0; model.nv() * model.nv()] };
        Self {
            kinematics: Kinematics::new(model),
            readings: vec![Reading::default(); system.elements.len()],
            forces: Forces::with_room_for(system.elements.iter().map(|element| &element.measure)),
            lost: None,
            workspace: Workspace::new(model),
            gradient: zero(),
            driven: zero(),
            tau: zero(),
            left: zero(),
            pull: zero(),
            is_free,
            mass,
            solve: Solve::default(),
            right: Vec::new(),
        }
    }
}

impl Equations {
    /// The accelerations `a` at t from `q` and `v`, whose shares of joints that signals move are filled in; and the powers there, of actuators and
    /// joints, then dissipated and supplied of every element, W. `false` where an element has no direction or the accelerations are not finite.
    ///
    /// Control looks from `node`: from the last one what it sees at the end of a step stays with it.
    ///
    /// # Errors
    /// Where a signal is not finite, an input breaks a rule of its law, or a reference cannot be followed.
    pub(crate) fn accelerate_at(
        &mut self,
        cx: Context,
        found: &mut AtOnce,
        (t, node): (f64, usize),
        [q, v, a]: [&mut [f64]; 3],
        powers: &mut [f64],
    ) -> Result<bool, RunError> {
        let (system, model) = (cx.system, &*cx.system.model);
        a.fill(0.0);
        self.forward.take_paths(model, t, q, v, a)?;
        found.kinematics.update_velocity(model, q, v);
        if !self.read_at(cx, found, (t, node), [q, v])? {
            return Ok(false);
        }
        self.pull_at(cx, found, powers);
        found.driven.fill(0.0);
        for (k, signal) in self.forward.forces(model) {
            found.driven[k] = force_at(cx, k, signal, t)?;
        }
        if node == STAGES {
            let own = self.free.iter().map(|&k| found.driven[k]);
            self.driven[STAGES - 1].clear();
            self.driven[STAGES - 1].extend(own);
        }
        if let Some(control) = &mut self.control {
            control.answer_from(node, &found.pull);
            let added = control.torque(node);
            let own = self.free.iter().filter(|k| !cx.holds_force(**k));
            own.for_each(|&k| found.driven[k] += added[k]);
        }
        found.tau.fill(0.0);
        add_smooth_resistance(system, v, &mut found.tau);
        let led = if found.is_free {
            let AtOnce { kinematics, forces, workspace, driven, tau, .. } = &mut *found;
            tau.iter_mut().zip(&*driven).for_each(|(tau, driven)| *tau = driven - *tau);
            forces.forward_dynamics_into(model, kinematics, tau, workspace, a);
            0.0
        } else {
            found.accelerate_part(model, &self.free, [q, v, a])
        };
        if let Some(control) = self.control.as_ref().filter(|control| control.has_inputs()) {
            let read = |e: usize| [found.readings[e].coordinate, found.readings[e].rate];
            let eye = Eye { system, t, q, v, kinematics: &found.kinematics, element: &read };
            control.write_rates(POINT, &eye, a, &mut self.bank);
            for e in 0..system.elements.len() {
                put(powers, e, self.bank.at_first_node(e).1);
            }
        }
        powers[0] = led + found.driven.iter().zip(&*v).map(|(force, v)| force * v).sum::<f64>();
        powers[1] = joint_loss(system, v);
        Ok(a.iter().all(|a| a.is_finite()))
    }

    /// Tells the bank strokes, rates and inputs, and control what it sees; `false` where an element has no direction.
    fn read_at(
        &mut self,
        cx: Context,
        found: &mut AtOnce,
        (t, node): (f64, usize),
        [q, v]: [&[f64]; 2],
    ) -> Result<bool, RunError> {
        let AtOnce { kinematics, readings, gradient, lost, .. } = found;
        *lost = None;
        for (e, (element, reading)) in cx.system.elements.iter().zip(&mut *readings).enumerate() {
            element.measure.read_into(&cx.system.model, kinematics, gradient, reading);
            let why = self.elements[e].readings[0].lost_until(reading).or_else(|| reading.check().err());
            *lost = lost.or(why.map(|why| (e, why)));
            self.bank.set_stroke(e, POINT, element.stroke(reading.coordinate), reading.rate);
            if !element.inputs.is_empty() {
                let values = self.bank.inputs_mut(e, POINT);
                cx.inputs_at(e, t, values);
                element.check_inputs(t, values)?;
            }
            if let Some(control) = &mut self.control {
                control.keep_gradient(node, e, gradient);
            }
        }
        if let Some(control) = self.control.as_mut().filter(|_| lost.is_none()) {
            let read = |e: usize| [readings[e].coordinate, readings[e].rate];
            control.look_from(node, &Eye { system: cx.system, t, q, v, kinematics, element: &read })?;
            control.write_inputs_to(cx, [node, POINT], &mut self.bank);
        }
        Ok(lost.is_none())
    }

    /// Asks the laws for forces and powers.
    fn pull_at(&mut self, cx: Context, found: &mut AtOnce, powers: &mut [f64]) {
        let AtOnce { kinematics, readings, forces, gradient, pull, .. } = found;
        forces.clear();
        pull.fill(0.0);
        let compensates = self.control.as_ref().is_some_and(|control| control.compensates());
        for (e, element) in cx.system.elements.iter().enumerate() {
            let (force, power) = self.bank.at_first_node(e);
            forces.push(&element.measure, Pull::constant(force));
            put(powers, e, power);
            if compensates {
                element.measure.read_into(&cx.system.model, kinematics, gradient, &mut readings[e]);
                pull.iter_mut().zip(&*gradient).for_each(|(sum, slope)| *sum += force * slope);
            }
        }
    }
}

impl AtOnce {
    /// The accelerations of the velocities `free`, where the others' are known, and the power of the actuators that these take, W.
    fn accelerate_part(&mut self, model: &Model, free: &[usize], [q, v, a]: [&mut [f64]; 3]) -> f64 {
        let Self { kinematics, forces, workspace, driven, tau, left, mass, solve, right, .. } = self;
        forces.inverse_dynamics_into(model, kinematics, (q, a), workspace, left);
        left.iter_mut().zip(&*tau).for_each(|(left, tau)| *left += tau);
        crba_into(model, kinematics, workspace, mass);
        right.clear();
        right.extend(free.iter().map(|&k| driven[k] - left[k]));
        if !free.is_empty() && solve.factor_part(mass, model.nv(), free) {
            solve.solve(right);
        }
        free.iter().zip(&*right).for_each(|(&k, own)| a[k] = *own);
        // Of joints that signals move: what stays where it is takes no power.
        let mut power = 0.0;
        let mut others = free.iter().peekable();
        for (k, (row, v)) in mass.chunks_exact(model.nv()).zip(&*v).enumerate() {
            if others.next_if(|free| **free == k).is_none() && *v != 0.0 {
                let inertia: f64 = free.iter().map(|&c| row[c] * a[c]).sum();
                power += (left[k] + inertia) * v;
            }
        }
        power
    }
}

/// Puts the flows of element `e` in their places.
fn put(powers: &mut [f64], e: usize, power: Power) {
    powers[OWN_POWERS + 2 * e..][..2].copy_from_slice(&[power.dissipation, power.input]);
}
