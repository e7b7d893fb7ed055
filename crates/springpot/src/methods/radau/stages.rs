//! The stages of a step: where they are, what drives them, and the linearisation at its start.

use super::step::{Origin, RadauStep, Stage, may_yield};
use crate::actuation::Drive;
use crate::collocation::radau::{A_SQUARED, GAMMA};
use crate::collocation::{RADAU_NODES, STAGES};
use crate::elements::{ElementBank, Pull};
use crate::equations::context::Context;
use crate::equations::control::{ControlRun, Eye};
use crate::equations::drives::{force_at, take_path};
use crate::equations::resistance::add_tangents;
use crate::fractional::Form;
use crate::system::error::RunError;

/// Above this stiffness a springpot of order below ½ takes its polynomial through strokes, which is stable however stiff.
const STIFF: f64 = 10.0;

/// Most iterations for the tangent vectors of floating joints.
const MOST_TURNS: usize = 30;

impl RadauStep {
    /// Mass, damping and stiffness at the start of the step, and the elements there.
    pub(super) fn linearise(
        &mut self,
        cx: Context,
        bank: &mut ElementBank,
        control: Option<&mut ControlRun>,
    ) -> Result<(), RunError> {
        if self.linearised {
            return Ok(());
        }
        self.start.update_velocity(&self.model, &self.origin.q, &self.origin.v);
        self.rounding.forget();
        self.forces.clear();
        for (element, force) in cx.system.elements.iter().zip(&self.origin.forces) {
            self.forces.push(&element.measure, Pull::constant(*force));
        }
        let (origin, slopes) = (&self.origin, &mut self.slopes);
        let workspace = &mut self.workspace;
        self.forces.inverse_dynamics_derivatives_into(&self.model, &self.start, &origin.a, workspace, slopes);
        add_tangents(&self.model, &origin.v, &mut slopes.d_v);
        let t = origin.t;
        for (e, (element, stage)) in cx.system.elements.iter().zip(&mut self.elements).enumerate() {
            let [reading, ..] = &mut stage.readings;
            element.measure.read_into(&self.model, &self.start, &mut stage.gradient, reading);
            element.check_direction(t, reading)?;
            bank.set_stroke(e, 0, element.stroke(reading.coordinate), reading.rate);
            bank.set_resolution(e, element.resolution(reading.coordinate));
        }
        if let Some(control) = control {
            let read = |e: usize| {
                let [reading, ..] = &self.elements[e].readings;
                [reading.coordinate, reading.rate]
            };
            let Origin { q, v, .. } = &self.origin;
            let eye = Eye { system: cx.system, t, q, v, kinematics: &self.start, element: &read };
            control.see_start(&eye)?;
            control.linearise(&eye, &mut self.slopes);
        }
        if self.is_singular || self.may_yield {
            self.share_forces();
        }
        if self.is_singular {
            self.arrived.copy_from_slice(&self.origin.a);
            // What the last step's end had of it, seen from this step's start, so that the rest has no jump.
            for element in &self.elements {
                for &k in &self.free {
                    self.origin.a[k] -= element.share[k] * element.singular_before;
                }
            }
        }
        self.linearised = true;
        Ok(())
    }

    /// −M⁻¹ ∂y/∂q of every element over the free velocities.
    fn share_forces(&mut self) {
        let (n, free, slopes) = (self.model.nv(), &self.free, &self.slopes);
        let regular = self.mass.factor_part(n, &slopes.d_a, free);
        for element in &mut self.elements {
            element.share.fill(0.0);
            if !regular {
                continue;
            }
            let x = &mut self.scratch.error;
            x.clear();
            x.extend(free.iter().map(|&k| -element.gradient[k]));
            self.mass.solve(x);
            free.iter().zip(x).for_each(|(&k, x)| element.share[k] = *x);
        }
    }

    /// Through strokes where the rates would be unstable: order below ½ and h² c (γ_0 h)^−alpha gᵀ M⁻¹ g ≥ 10, in sum over such
    /// elements, since several may pull at one joint.
    pub(super) fn choose_forms(&mut self, cx: Context, bank: &mut ElementBank, h: f64) {
        let mut stiffness = 0.0;
        if !self.may_yield {
            return;
        }
        for (e, (element, stage)) in cx.system.elements.iter().zip(&self.elements).enumerate() {
            element.law.for_each_springpot(&bank.point(e, 0), &mut |term| {
                if term.is_yielding() {
                    let softness: f64 = stage.gradient.iter().zip(&stage.share).map(|(g, s)| -g * s).sum();
                    stiffness += h * h * term.stiffness(1.0 / (GAMMA * h)) * softness;
                }
            });
        }
        for (e, element) in cx.system.elements.iter().enumerate() {
            let through_strokes = stiffness >= STIFF && may_yield(element);
            bank.set_form(e, if through_strokes { Form::Strokes } else { Form::Rates });
        }
    }

    /// First guess of the stages' accelerations: the last cubic goes on.
    pub(super) fn predict(&mut self, h: f64) {
        for (stage, c) in self.stages.iter_mut().zip(RADAU_NODES) {
            match self.last {
                Some(size) => {
                    let theta = 1.0 + c * (h / size).min(4.0);
                    let [u0, u1, u2, u3] = &self.cubic;
                    for (j, a) in stage.a.iter_mut().enumerate() {
                        *a = u0[j] + theta * (u1[j] + theta * (u2[j] + theta * u3[j]));
                    }
                }
                None => stage.a.copy_from_slice(&self.origin.a),
            }
        }
    }

    pub(super) fn take_inputs(&self, cx: Context, bank: &mut ElementBank, h: f64, t_end: f64) -> Result<(), RunError> {
        let t = self.origin.t;
        let nodes = [t, t + RADAU_NODES[0] * h, t + RADAU_NODES[1] * h, t_end];
        for (e, element) in cx.system.elements.iter().enumerate().filter(|(_, element)| !element.inputs.is_empty()) {
            for (k, at) in nodes.into_iter().enumerate() {
                let values = bank.inputs_mut(e, k);
                cx.inputs_at(e, at, values);
                element.check_inputs(at, values)?;
            }
        }
        Ok(())
    }

    /// What drives the joints at the nodes.
    pub(super) fn take_drives(&mut self, cx: Context, h: f64, t_end: f64) -> Result<(), RunError> {
        let t = self.origin.t;
        for (stage, (c, drives)) in self.stages.iter_mut().zip(RADAU_NODES.into_iter().zip(&mut self.drives)) {
            let at = if c == 1.0 { t_end } else { t + c * h };
            drives.clear();
            for (j, drive) in self.model.own_joints().zip(&self.forward.drives) {
                let (q, v) = (self.model.q_range(j), self.model.v_range(j));
                match drive {
                    Drive::Force(signals) => {
                        for (k, signal) in v.zip(signals) {
                            let force = force_at(cx, k, signal, at)?;
                            if !self.stick.holds(k) {
                                drives.push(force);
                                continue;
                            }
                            stage.q[q.clone()].copy_from_slice(&self.origin.q[q.clone()]);
                            (stage.v[k], stage.a[k], stage.xi[k]) = (0.0, 0.0, 0.0);
                        }
                    }
                    Drive::Prescribed(path) => {
                        take_path(&self.model, j, path, at, &mut stage.q, &mut stage.v, &mut stage.a)?;
                        stage.xi[v].fill(0.0);
                    }
                    Drive::Locked => {
                        stage.q[q.clone()].copy_from_slice(&self.origin.q[q]);
                        stage.a[v].fill(0.0);
                    }
                }
            }
        }
        Ok(())
    }

    /// Positions and velocities of the stages from their accelerations, and the elements there; `false` where a floating joint
    /// turns too far in the step.
    pub(super) fn place_stages(
        &mut self,
        cx: Context,
        bank: &mut ElementBank,
        mut control: Option<&mut ControlRun>,
        h: f64,
    ) -> bool {
        for i in 0..STAGES {
            for &k in &self.free {
                let push = self.collocate(i, |stage| stage.a[k]);
                let travel: f64 = A_SQUARED[i].iter().zip(&self.stages).map(|(a, stage)| a * stage.a[k]).sum();
                let v = self.origin.v[k];
                self.stages[i].v[k] = v + h * push;
                self.stages[i].xi[k] = h * (RADAU_NODES[i] * v + h * travel);
            }
        }
        if !self.model.is_one_degree() && !self.bend_tangents(h) {
            return false;
        }
        for i in 0..STAGES {
            self.move_free_joints(i);
            let stage = &mut self.stages[i];
            stage.kinematics.update_velocity(&self.model, &stage.q, &stage.v);
            for (e, (element, step)) in cx.system.elements.iter().zip(&mut self.elements).enumerate() {
                // The gradient is that of the start; `tau` is free until the residual is asked for.
                let reading = &mut step.readings[i + 1];
                element.measure.read_into(&self.model, &stage.kinematics, &mut self.tau, reading);
                bank.set_stroke(e, i + 1, element.stroke(reading.coordinate), reading.rate);
                if let Some(control) = control.as_deref_mut() {
                    control.keep_gradient(i + 1, e, &self.tau);
                }
            }
            if let Some(control) = control.as_deref_mut() {
                let read = |e: usize| {
                    let reading = &self.elements[e].readings[i + 1];
                    [reading.coordinate, reading.rate]
                };
                let (system, Stage { q, v, kinematics, .. }) = (cx.system, &*stage);
                control.see(i + 1, &Eye { system, t: control.time(i + 1), q, v, kinematics, element: &read });
                control.write_inputs(cx, i + 1, bank);
            }
        }
        true
    }

    /// q_i = q_0 ⊕ ξ_i of the joints that forces drive; the others are where their signals say.
    fn move_free_joints(&mut self, i: usize) {
        let stage = &mut self.stages[i];
        if self.free.len() == self.model.nv() {
            self.model.integrate_into(&self.origin.q, &stage.xi, &mut stage.q);
            return;
        }
        if self.model.is_one_degree() {
            for &k in &self.free {
                let index = self.model.coordinate_of(k).expect("a joint of one degree");
                stage.q[index] = self.origin.q[index] + stage.xi[k];
            }
            return;
        }
        let held = &mut self.held;
        held.clone_from(&stage.q);
        self.model.integrate_into(&self.origin.q, &stage.xi, &mut stage.q);
        for (j, drive) in self.model.own_joints().zip(&self.forward.drives) {
            if !matches!(drive, Drive::Force(_)) {
                stage.q[self.model.q_range(j)].copy_from_slice(&held[self.model.q_range(j)]);
            }
        }
    }

    /// Floating joints: ξ_i = h Σ_j A_ij J_r⁻¹(ξ_j) v_j, by iteration.
    fn bend_tangents(&mut self, h: f64) -> bool {
        let mut before = f64::INFINITY;
        for _ in 0..MOST_TURNS {
            for stage in &mut self.stages {
                self.model.tangent_rate_into(&stage.xi, &stage.v, &mut stage.xi_rate);
            }
            let (mut change, mut size): (f64, f64) = (0.0, 0.0);
            for i in 0..STAGES {
                for &k in &self.free {
                    let xi = h * self.collocate(i, |stage| stage.xi_rate[k]);
                    change = change.max((xi - self.stages[i].xi[k]).abs());
                    size = size.max(xi.abs());
                    self.stages[i].xi[k] = xi;
                }
            }
            // What no longer shrinks is rounding.
            let rounding = 64.0 * f64::EPSILON * size;
            if change <= 0.25 * f64::EPSILON * size || (change <= rounding && change >= before) {
                return true;
            }
            if !change.is_finite() {
                return false;
            }
            before = change;
        }
        false
    }
}
