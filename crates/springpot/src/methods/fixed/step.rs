//! One step of a fixed-step method: one stage, a fixed number of Newton iterations.

use super::element_step::ElementStep;
use crate::actuation::Forward;
use crate::dynamics::{Kinematics, RneaDerivatives, Workspace};
use crate::elements::{ElementBank, Forces};
use crate::equations::Solve;
use crate::equations::context::Context;
use crate::equations::coulomb::Coulomb;
use crate::equations::drives::force_at;
use crate::equations::resistance::{add_secants, add_smooth_resistance, holding_forces};
use crate::law::Response;
use crate::model::Model;
use crate::system::error::RunError;
use crate::system::fixed_step::Method;
use std::sync::Arc;

/// Newton iterations of every step.
pub const ITERATIONS: u32 = 3;

/// The robot at one time.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) kinematics: Kinematics,
}

/// Steps of one method from one [`Place`] to the next.
///
/// With c the node of the method (1 or ½) and κ = c h, the stage has the velocities v_0 + κ a and the place q_0 ⊕ κ v, and the
/// accelerations a solve RNEA(q, v, a) = τ + ΣQ there. The step ends at v_0 + h a and q_0 ⊕ h v.
#[derive(Debug, Clone)]
pub(super) struct OneStage {
    pub(super) model: Arc<Model>,
    pub(super) forward: Arc<Forward>,
    pub(super) method: Method,
    /// Velocities that no signal prescribes.
    pub(super) free: Vec<usize>,
    /// What friction that sticks can hold at every velocity, and whether it does so at the end of the step (nv).
    pub(super) limits: Vec<f64>,
    pub(super) held: Vec<bool>,
    pub(super) coulomb: Coulomb,
    pub(super) origin: Place,
    pub(super) stage: Place,
    pub(super) end: Place,
    /// Accelerations of the stage.
    pub(super) a: Vec<f64>,
    /// Tangent vector from the start, 0 where a joint is not free.
    xi: Vec<f64>,
    moved: Vec<f64>,
    pub(super) elements: Vec<ElementStep>,
    drives: Vec<f64>,
    workspace: Workspace,
    slopes: RneaDerivatives,
    pub(super) newton: Solve,
    pub(super) residual: Vec<f64>,
    tau: Vec<f64>,
    pub(super) forces: Forces,
    /// Largest change of a stage's velocity in the last iteration of the last step.
    pub(super) correction: f64,
}

impl OneStage {
    /// At rest where the motion starts; nothing is asked of the laws.
    ///
    /// # Errors
    /// Where the force of an element has no direction.
    pub(super) fn new(cx: Context, forward: &Arc<Forward>, method: Method) -> Result<Self, RunError> {
        let (system, model) = (cx.system, &cx.system.model);
        let nv = model.nv();
        let free = forward.free_velocities(model);
        let mut start =
            Place { t: 0.0, q: forward.q.clone(), v: forward.v.clone(), kinematics: Kinematics::new(model) };
        let mut a = vec![0.0; nv];
        forward.locked(model).for_each(|j| start.v[model.v_range(j)].fill(0.0));
        for (j, path) in forward.paths(model) {
            let (q, v) = (model.q_range(j), model.v_range(j));
            path.at(0.0, &mut start.q[q], &mut start.v[v.clone()], &mut a[v]);
        }
        start.kinematics.update_velocity(model, &start.q, &start.v);
        let elements = system.elements.iter().map(|element| ElementStep::new(element, model, &start.kinematics));
        let elements = elements.collect::<Result<Vec<_>, _>>()?;
        let mut stepper = Self {
            model: model.clone(),
            forward: forward.clone(),
            method,
            origin: start.clone(),
            stage: start.clone(),
            end: start,
            a,
            xi: vec![0.0; nv],
            moved: vec![0.0; model.nq()],
            drives: vec![0.0; free.len()],
            workspace: Workspace::new(model),
            slopes: RneaDerivatives::new(model),
            newton: Solve::default(),
            residual: vec![0.0; free.len()],
            tau: vec![0.0; nv],
            forces: Forces::with_room_for(system.elements.iter().map(|element| &element.measure)),
            correction: 0.0,
            elements,
            free,
            limits: holding_forces(model),
            held: vec![false; nv],
            coulomb: Coulomb::default(),
        };
        // Room for the factors, so that no step allocates.
        let count = stepper.free.len();
        stepper.newton.reserve(count);
        stepper.coulomb.reserve(stepper.rubbing().count(), count);
        Ok(stepper)
    }

    /// Works out the step of size `h` to `to`; the origin stays.
    ///
    /// # Errors
    /// [`RunError`]; the step may be tried again with other torques.
    pub(super) fn attempt(&mut self, cx: Context, bank: &mut ElementBank, to: f64, h: f64) -> Result<(), RunError> {
        let (kappa, t) = (self.method.node() * h, self.stage_time(to, h));
        self.stage.t = t;
        self.end.t = to;
        self.begin_elements(cx, bank, h, t)?;
        self.take_drives(cx, t)?;
        for &k in &self.free {
            // Not those of the step before: where an element is stiff they would lead far away.
            self.a[k] = 0.0;
        }
        self.correction = 0.0;
        self.held.fill(false);
        self.place(kappa, h);
        self.respond(cx, bank, h)?;
        for _ in 0..ITERATIONS {
            self.improve(bank, kappa, h)?;
            self.place(kappa, h);
            self.respond(cx, bank, h)?;
        }
        self.check_end(cx, h)
    }

    /// The time of the stage of a step of size `h` to `to`: the end of a step comes from a table of times, as that of the last one.
    pub(super) fn stage_time(&self, to: f64, h: f64) -> f64 {
        if self.method.node() == 1.0 { to } else { self.origin.t + self.method.node() * h }
    }

    /// Goes on to the end of the step that was just worked out.
    pub(super) fn accept(&mut self) {
        std::mem::swap(&mut self.origin, &mut self.end);
        for element in &mut self.elements {
            element.ends.swap(0, 1);
        }
    }

    /// Goes on from where an earlier step ended.
    pub(super) fn go_on(&mut self, cx: Context, t: f64, q: &[f64], v: &[f64]) {
        let (model, origin) = (&self.model, &mut self.origin);
        origin.t = t;
        origin.q.copy_from_slice(q);
        origin.v.copy_from_slice(v);
        origin.kinematics.update_velocity(model, q, v);
        for (element, step) in cx.system.elements.iter().zip(&mut self.elements) {
            let [at_stage, at_end] = &mut step.gradients;
            element.measure.read_into(model, &origin.kinematics, at_end, &mut step.ends[0]);
            // With backward Euler's method the stage is the end.
            at_stage.copy_from_slice(at_end);
        }
    }

    fn take_drives(&mut self, cx: Context, t: f64) -> Result<(), RunError> {
        let (model, stage, end) = (&self.model, &mut self.stage, &mut self.end);
        for (drive, (k, signal)) in self.drives.iter_mut().zip(self.forward.forces(model)) {
            *drive = force_at(cx, k, signal, t)?;
        }
        for j in self.forward.locked(model) {
            self.a[model.v_range(j)].fill(0.0);
        }
        // The accelerations at the end are not asked for.
        self.forward.take_paths(model, end.t, &mut end.q, &mut end.v, &mut self.a)?;
        self.forward.take_paths(model, t, &mut stage.q, &mut stage.v, &mut self.a)
    }

    /// Places the stage and the end under the accelerations.
    fn place(&mut self, kappa: f64, h: f64) {
        let (model, ends_at_stage) = (&self.model, self.method.node() == 1.0);
        for &k in &self.free {
            self.stage.v[k] = self.origin.v[k] + kappa * self.a[k];
            self.end.v[k] = self.origin.v[k] + h * self.a[k];
            if self.held[k] {
                self.end.v[k] = 0.0;
                if ends_at_stage {
                    self.stage.v[k] = 0.0;
                }
            }
            self.xi[k] = kappa * self.stage.v[k];
        }
        model.integrate_into(&self.origin.q, &self.xi, &mut self.moved);
        take_moved(model, &self.forward, &self.moved, &mut self.stage.q);
        self.stage.kinematics.update_velocity(model, &self.stage.q, &self.stage.v);
        if ends_at_stage {
            self.end.q.copy_from_slice(&self.stage.q);
            self.end.v.copy_from_slice(&self.stage.v);
            return;
        }
        for &k in &self.free {
            self.xi[k] = h * self.stage.v[k];
        }
        model.integrate_into(&self.origin.q, &self.xi, &mut self.moved);
        take_moved(model, &self.forward, &self.moved, &mut self.end.q);
        self.end.kinematics.update_velocity(model, &self.end.q, &self.end.v);
    }

    /// One Newton iteration with all derivatives taken anew: (M + κ D + κ² K) Δa = −residual.
    fn improve(&mut self, bank: &ElementBank, kappa: f64, h: f64) -> Result<(), RunError> {
        let (n, free) = (self.model.nv(), &self.free);
        if free.is_empty() {
            return Ok(());
        }
        let (stage, workspace) = (&self.stage, &mut self.workspace);
        let (at, tau) = ((&stage.q[..], &self.a[..]), &mut self.tau);
        self.forces.inverse_dynamics_into(&self.model, &stage.kinematics, at, workspace, tau);
        add_smooth_resistance(&self.model, &stage.v, &mut self.tau);
        for ((r, &k), drive) in self.residual.iter_mut().zip(free).zip(&self.drives) {
            *r = drive - self.tau[k];
        }
        let (a, slopes) = (&self.a, &mut self.slopes);
        self.forces.inverse_dynamics_derivatives_into(&self.model, &stage.kinematics, a, workspace, slopes);
        add_secants(&self.model, &stage.v, &mut self.slopes.d_v);
        let (slopes, count) = (&mut self.slopes, free.len());
        if self.method.node() != 1.0 {
            // ∂F/∂a = (κ² ∂F/∂x + κ ∂F/∂x') ∂y/∂q, taken at the end; added to the place of κ² K.
            for (e, step) in self.elements.iter().enumerate() {
                let Response { d_stroke, d_rate, .. } = bank.response(e);
                let stiffness = d_stroke[0][0] + d_rate[0][0] / kappa;
                let [at_stage, at_end] = &step.gradients;
                for (line, push) in slopes.d_q.chunks_exact_mut(n).zip(at_stage) {
                    for (entry, g) in line.iter_mut().zip(at_end) {
                        *entry += stiffness * push * g;
                    }
                }
            }
        }
        let regular = self.newton.factor(count, |matrix| {
            for (line, &row) in matrix.chunks_exact_mut(count).zip(free) {
                for (entry, &column) in line.iter_mut().zip(free) {
                    let at = row * n + column;
                    *entry = slopes.d_a[at] + kappa * (slopes.d_v[at] + kappa * slopes.d_q[at]);
                }
            }
        });
        if regular {
            self.newton.solve(&mut self.residual);
            self.rub(h)?;
        }
        self.correction = 0.0;
        for (&k, change) in self.free.iter().zip(&self.residual) {
            if !(regular && change.is_finite()) {
                return Err(self.too_long(h, k));
            }
            self.a[k] += change;
            self.correction = self.correction.max((kappa * change).abs());
        }
        Ok(())
    }

    /// Whether the end of the step is one to go on from.
    fn check_end(&mut self, cx: Context, h: f64) -> Result<(), RunError> {
        if let Some(k) = self.end.v.iter().position(|v| !v.is_finite()) {
            return Err(self.too_long(h, k));
        }
        for (element, step) in cx.system.elements.iter().zip(&self.elements) {
            let [start, end] = &step.ends;
            if let Some(why) = start.lost_until(end).or(end.check().err()) {
                return Err(element.without_direction(self.end.t, why));
            }
        }
        if self.method.node() == 1.0 {
            std::mem::swap(&mut self.end, &mut self.stage);
        }
        Ok(())
    }

    fn too_long(&self, h: f64, k: usize) -> RunError {
        RunError::FixedStep { t: self.origin.t, h, joint: self.model.v_labels()[k].name.clone() }
    }
}

/// Takes the places of all joints but those that signals move.
fn take_moved(model: &Model, forward: &Forward, moved: &[f64], q: &mut [f64]) {
    for j in forward.forced(model).map(|(j, _)| j).chain(forward.locked(model)) {
        q[model.q_range(j)].copy_from_slice(&moved[model.q_range(j)]);
    }
}
