//! Rows between the ends of a step, and accelerations that solve the equations of motion there.

use super::rub::SLACK;
use crate::actuation::Forward;
use crate::dynamics::{Kinematics, Workspace, crba_into};
use crate::equations::context::Context;
use crate::equations::coulomb::{Candidate, Coulomb};
use crate::equations::drives::drive;
use crate::equations::evaluate::{Evaluation, Scratch};
use crate::equations::resistance::holding_forces;
use crate::equations::{Place, Solve};
use crate::model::Model;
use crate::system::error::RunError;

/// A step between its ends: places by the cubic Hermite form in the tangent space of the start, velocities and accelerations by
/// straight lines.
pub(super) struct Between<'a> {
    cx: Context<'a>,
    forward: &'a Forward,
    from: &'a Place,
    to: &'a Place,
    /// Accelerations at both ends.
    a: [&'a [f64]; 2],
    h: f64,
    /// Tangent vector from start to end.
    xi: Vec<f64>,
    /// How fast it grows at the end.
    xi_rate: Vec<f64>,
}

impl<'a> Between<'a> {
    pub(super) fn new(
        cx: Context<'a>,
        forward: &'a Forward,
        [from, to]: [&'a Place; 2],
        a: [&'a [f64]; 2],
        h: f64,
    ) -> Self {
        let (model, nv) = (&cx.system.model, cx.system.model.nv());
        let (mut xi, mut xi_rate) = (vec![0.0; nv], vec![0.0; nv]);
        model.difference_into(&from.q, &to.q, &mut xi);
        model.tangent_rate_into(&xi, &to.v, &mut xi_rate);
        Self { cx, forward, from, to, a, h, xi, xi_rate }
    }

    /// Fills q, v, a and what drives the joints at t = t_n + θh.
    pub(super) fn place(&self, t: f64, theta: f64, evaluation: &mut Evaluation) {
        let mut xi = vec![0.0; self.xi.len()];
        let rest = 1.0 - theta;
        for (k, xi) in xi.iter_mut().enumerate() {
            let (v, w) = (self.h * self.from.v[k], self.h * self.xi_rate[k]);
            *xi = theta * (rest * rest * v - theta * rest * w) + theta * theta * (3.0 - 2.0 * theta) * self.xi[k];
            evaluation.v[k] = rest * self.from.v[k] + theta * self.to.v[k];
            evaluation.a[k] = rest * self.a[0][k] + theta * self.a[1][k];
        }
        self.cx.system.model.integrate_into(&self.from.q, &xi, &mut evaluation.q);
        drive(self.cx, self.forward, t, evaluation);
    }
}

/// Solves for accelerations.
#[derive(Debug)]
pub(super) struct Accelerator {
    kinematics: Kinematics,
    workspace: Workspace,
    mass: Vec<f64>,
    solve: Solve,
    free: Vec<usize>,
    /// What friction that sticks can hold at every velocity.
    limits: Vec<f64>,
    coulomb: Coulomb,
}

impl Accelerator {
    pub(super) fn new(cx: Context, forward: &Forward) -> Self {
        let model = &cx.system.model;
        Self {
            kinematics: Kinematics::new(model),
            workspace: Workspace::new(model),
            mass: vec![0.0; model.nv() * model.nv()],
            solve: Solve::default(),
            free: forward.free_velocities(model),
            limits: holding_forces(model),
            coulomb: Coulomb::default(),
        }
    }

    /// Fills an `evaluation`, whose q and v are there, for the time `t`: the accelerations of the joints that no signal moves solve
    /// M a = τ − nle − Σ g F under the `forces` of the elements, which see the evaluation's kinematics.
    pub(super) fn fill(
        &mut self,
        cx: Context,
        forward: &Forward,
        t: f64,
        scratch: &mut Scratch,
        evaluation: &mut Evaluation,
        mut forces: impl FnMut(usize, &Evaluation) -> f64,
    ) -> Result<(), RunError> {
        let model = &cx.system.model;
        for &k in &self.free {
            evaluation.a[k] = 0.0;
        }
        drive(cx, forward, t, evaluation);
        cx.fill(t, t, None, scratch, evaluation)?;
        let mut push: Vec<f64> =
            self.free.iter().map(|&k| evaluation.driven[k].unwrap_or(0.0) - evaluation.rigid[k]).collect();
        for e in 0..cx.system.elements.len() {
            let force = forces(e, evaluation);
            for (push, &k) in push.iter_mut().zip(&self.free) {
                *push -= force * evaluation.elements[e].gradient[k];
            }
        }
        self.kinematics.update_position(model, &evaluation.q);
        crba_into(model, &self.kinematics, &mut self.workspace, &mut self.mass);
        if self.solve.factor_part(&self.mass, model.nv(), &self.free) {
            self.solve.solve(&mut push);
            self.hold(t, model, evaluation, &mut push)?;
        }
        for (push, &k) in push.iter().zip(&self.free) {
            evaluation.a[k] = *push;
        }
        cx.fill(t, t, None, scratch, evaluation)
    }

    /// Takes the friction that sticks off the accelerations `a` of the joints at rest.
    fn hold(&mut self, t: f64, model: &Model, evaluation: &Evaluation, a: &mut [f64]) -> Result<(), RunError> {
        let Self { free, limits, coulomb, solve, .. } = self;
        coulomb.candidates.clear();
        for (place, &k) in free.iter().enumerate().filter(|(_, k)| limits[**k] > 0.0 && evaluation.v[**k] == 0.0) {
            coulomb.candidates.push(Candidate { place, limit: limits[k], slack: SLACK * limits[k], offset: 0.0 });
        }
        if coulomb.candidates.is_empty() {
            return Ok(());
        }
        let outcome = coulomb.solve(solve, a);
        outcome.map_err(|c| {
            let k = free[coulomb.candidates[c].place];
            RunError::NoHold { t, joint: model.v_labels()[k].name.clone() }
        })
    }
}
