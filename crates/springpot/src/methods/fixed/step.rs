//! One step of a fixed-step method: one stage, a fixed number of Newton iterations.

use crate::actuation::Forward;
use crate::dynamics::Kinematics;
use crate::elements::ElementBank;
use crate::equations::context::Context;
use crate::equations::coulomb::Coulomb;
use crate::equations::resistance::holding_forces;
use crate::equations::{OneNode, Place, Solve};
use crate::model::Model;
use crate::system::error::RunError;
use crate::system::fixed_step::Method;
use std::sync::Arc;

/// Newton iterations of every step.
pub const ITERATIONS: u32 = 3;

/// Steps of one method from one [`Place`] to the next.
///
/// With c the node of the method (1 or ½) and κ = c h, the stage has the velocities v_0 + κ a and the place q_0 ⊕ κ v, and the
/// accelerations a solve RNEA(q, v, a) = τ + ΣQ there. The step ends at v_0 + h a and q_0 ⊕ h v.
#[derive(Debug, Clone)]
pub(super) struct OneStage {
    pub(super) model: Arc<Model>,
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
    pub(super) equations: OneNode,
    moving: Moving,
    pub(super) newton: Solve,
    pub(super) residual: Vec<f64>,
    /// Largest change of a stage's velocity in the last iteration of the last step.
    pub(super) correction: f64,
}

/// Room for where joints move.
#[derive(Debug, Clone)]
struct Moving {
    /// Tangent vector from the start, 0 where a joint is not free.
    xi: Vec<f64>,
    q: Vec<f64>,
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
        let mut stepper = Self {
            model: model.clone(),
            method,
            equations: OneNode::new(system, forward, method.nodes(), &start.kinematics)?,
            origin: start.clone(),
            stage: start.clone(),
            end: start,
            a,
            moving: Moving { xi: vec![0.0; nv], q: vec![0.0; model.nq()] },
            newton: Solve::default(),
            residual: vec![0.0; free.len()],
            correction: 0.0,
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
        self.equations.begin(cx, bank, [self.origin.t, t], h)?;
        self.equations.drive(cx, &mut self.stage, &mut self.end, &mut self.a)?;
        for &k in &self.free {
            // Not those of the step before: where an element is stiff they would lead far away.
            self.a[k] = 0.0;
        }
        self.correction = 0.0;
        self.held.fill(false);
        self.place(kappa, h);
        self.equations.answer(cx, bank, [&self.stage, &self.end], h)?;
        for _ in 0..ITERATIONS {
            self.improve(cx, bank, kappa, h)?;
            self.place(kappa, h);
            self.equations.answer(cx, bank, [&self.stage, &self.end], h)?;
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
        self.equations.accept();
    }

    /// Goes on from where an earlier step ended.
    pub(super) fn go_on(&mut self, cx: Context, t: f64, q: &[f64], v: &[f64]) {
        let (model, origin) = (&self.model, &mut self.origin);
        origin.t = t;
        origin.q.copy_from_slice(q);
        origin.v.copy_from_slice(v);
        origin.kinematics.update_velocity(model, q, v);
        self.equations.go_on(cx, &origin.kinematics);
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
            self.moving.xi[k] = kappa * self.stage.v[k];
        }
        model.integrate_into(&self.origin.q, &self.moving.xi, &mut self.moving.q);
        self.equations.move_others(model, &self.moving.q, &mut self.stage.q);
        self.stage.kinematics.update_velocity(model, &self.stage.q, &self.stage.v);
        if ends_at_stage {
            self.end.q.copy_from_slice(&self.stage.q);
            self.end.v.copy_from_slice(&self.stage.v);
            return;
        }
        for &k in &self.free {
            self.moving.xi[k] = h * self.stage.v[k];
        }
        model.integrate_into(&self.origin.q, &self.moving.xi, &mut self.moving.q);
        self.equations.move_others(model, &self.moving.q, &mut self.end.q);
        self.end.kinematics.update_velocity(model, &self.end.q, &self.end.v);
    }

    /// One Newton iteration with all derivatives taken anew: (M + κ D + κ² K) Δa = −residual.
    fn improve(&mut self, cx: Context, bank: &ElementBank, kappa: f64, h: f64) -> Result<(), RunError> {
        let (n, free) = (self.model.nv(), &self.free);
        if free.is_empty() {
            return Ok(());
        }
        self.equations.residual(cx, free, &self.stage, &self.a, &mut self.residual);
        let slopes = self.equations.linearise(cx, bank, &self.stage, &self.a, kappa);
        let count = free.len();
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
        self.equations.check_end(cx, self.end.t)?;
        if self.method.node() == 1.0 {
            std::mem::swap(&mut self.end, &mut self.stage);
        }
        Ok(())
    }

    fn too_long(&self, h: f64, k: usize) -> RunError {
        RunError::FixedStep { t: self.origin.t, h, joint: self.model.v_labels()[k].name.clone() }
    }
}
