//! The Newton iteration for the accelerations of the stages: three unknowns for each free velocity.

use super::step::RadauStep;
use crate::collocation::radau::{A, A_SQUARED};
use crate::collocation::{MAX_NODES, STAGES};
use crate::elements::{ElementBank, Pull};
use crate::equations::context::Context;
use crate::equations::control::ControlRun;
use crate::equations::resistance::add_smooth_resistance;
use crate::equations::tangent::couplings;
use crate::system::error::RunError;

/// Newton iterations after which a step is given up.
const MOST_ITERATIONS: u32 = 10;

/// How a step went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outcome {
    /// The stages are found.
    Converged { iterations: u32 },
    /// They are not; the velocity that was farthest off.
    Diverged { iterations: u32, worst: usize },
}

/// Share of what rounding is allowed below which increments are rounding: the allowance is a generous one.
const ROUNDED: f64 = 0.25;

impl RadauStep {
    /// Solves the step of size `h`; nothing but scratch changes. Inputs at the end are taken at `t_end`.
    pub(super) fn attempt(
        &mut self,
        cx: Context,
        bank: &mut ElementBank,
        mut control: Option<&mut ControlRun>,
        h: f64,
        t_end: f64,
    ) -> Result<Outcome, RunError> {
        bank.start(self.origin.t, h);
        self.take_inputs(cx, bank, h, t_end)?;
        self.linearise(cx, bank, control.as_deref_mut())?;
        if let Some(control) = control.as_deref_mut() {
            control.start(cx, self.origin.t, h, t_end)?;
            control.write_inputs(cx, 0, bank);
        }
        self.choose_forms(cx, bank, h);
        bank.prepare();
        self.predict(h);
        self.take_drives(cx, h, t_end)?;
        self.allow(cx, bank, control.as_deref(), h);
        let count = self.free.len();
        let (mut before, mut iterations) = (f64::INFINITY, 0);
        let mut worst = self.free.first().copied().unwrap_or(0);
        if !self.place_stages(cx, bank, control.as_deref_mut(), h) {
            return Ok(Outcome::Diverged { iterations, worst });
        }
        respond(bank, control.as_deref_mut());
        if count == 0 {
            self.collect_regular(bank);
            return Ok(Outcome::Converged { iterations });
        }
        if let Some(control) = control.as_deref_mut() {
            control.take_input_forces(bank);
        }
        if !self.factor(bank, control.as_deref(), h) {
            return Ok(Outcome::Diverged { iterations, worst });
        }
        loop {
            iterations += 1;
            self.fill_residual(cx, bank, control.as_deref());
            if let Some(k) = self.residual.iter().position(|r| !r.is_finite()) {
                return Ok(Outcome::Diverged { iterations, worst: self.free[k % count] });
            }
            self.newton.solve(&mut self.residual);
            for (stage, change) in self.stages.iter_mut().zip(self.residual.chunks_exact(count)) {
                for (&k, delta) in self.free.iter().zip(change) {
                    stage.a[k] -= delta;
                }
            }
            if iterations == 1 && self.sized.iter().any(|[speed, _]| *speed == 0.0) {
                self.allow(cx, bank, control.as_deref(), h);
            }
            let size;
            (size, worst) = self.velocity_change(h);
            let placed = size.is_finite() && self.place_stages(cx, bank, control.as_deref_mut(), h);
            if placed {
                respond(bank, control.as_deref_mut());
            }
            if iterations > 1 {
                self.contraction = size / before;
            }
            if !placed || (iterations > 2 && self.contraction >= 1.0) {
                self.contraction = 0.0;
                return Ok(Outcome::Diverged { iterations, worst });
            }
            let theta = self.contraction.clamp(1e-3, 0.9);
            if size * theta / (1.0 - theta) <= 1.0 {
                break;
            }
            if iterations == MOST_ITERATIONS {
                return Ok(Outcome::Diverged { iterations, worst });
            }
            before = size;
        }
        self.collect_regular(bank);
        Ok(Outcome::Converged { iterations })
    }

    /// RNEA(q_i, v_i, a_i) + resistance − drive, node by node, of the free velocities.
    fn fill_residual(&mut self, cx: Context, bank: &ElementBank, control: Option<&ControlRun>) {
        self.residual.clear();
        for i in 0..STAGES {
            self.forces.clear();
            for (e, element) in cx.system.elements.iter().enumerate() {
                self.forces.push(&element.measure, Pull::constant(bank.response(e).force[i]));
            }
            let stage = &self.stages[i];
            let (at, workspace, tau) = ((&stage.q[..], &stage.a[..]), &mut self.workspace, &mut self.tau);
            self.forces.inverse_dynamics_into(&self.model, &stage.kinematics, at, workspace, tau);
            add_smooth_resistance(&self.model, &stage.v, &mut self.tau);
            self.stick.add_sliding(&mut self.tau);
            let forces = self.free.iter().zip(&self.drives[i]);
            self.residual.extend(forces.map(|(&k, drive)| self.tau[k] - drive));
            if let Some(control) = control {
                let residual = &mut self.residual[i * self.free.len()..];
                for (residual, &k) in residual.iter_mut().zip(&self.free).filter(|(_, k)| !cx.holds_force(**k)) {
                    *residual -= control.torque(i + 1)[k];
                }
            }
        }
    }

    /// I⊗M + hA⊗D + h²A²⊗K + Σ on ⊗ (h² G A² by_q + h P A by_v) of all couplings, over the free velocities.
    fn factor(&mut self, bank: &ElementBank, control: Option<&ControlRun>, h: f64) -> bool {
        let (n, count, free) = (self.model.nv(), self.free.len(), &self.free);
        let slopes = &self.slopes;
        let size = STAGES * count;
        let couplings = couplings(self.elements.iter().map(|element| &element.gradient[..]), bank, control);
        let product = |x: &[[f64; MAX_NODES]; MAX_NODES], y: &[[f64; STAGES]; STAGES], i: usize, j: usize| -> f64 {
            (0..STAGES).map(|m| x[i][m] * y[m][j]).sum()
        };
        self.newton.factor(size, |matrix| {
            for i in 0..STAGES {
                for j in 0..STAGES {
                    let (damping, stiffness) = (h * A[i][j], h * h * A_SQUARED[i][j]);
                    let line = |r: usize| (i * count + r) * size + j * count;
                    for (r, &row) in free.iter().enumerate() {
                        for (entry, &column) in matrix[line(r)..][..count].iter_mut().zip(free) {
                            let at = row * n + column;
                            *entry = damping * slopes.d_v[at] + stiffness * slopes.d_q[at];
                            if i == j {
                                *entry += slopes.d_a[at];
                            }
                        }
                    }
                    for coupling in &couplings {
                        let [stroke, rate] = &coupling.gain;
                        let share = [h * h * product(stroke, &A_SQUARED, i, j), h * product(rate, &A, i, j)];
                        coupling.add(share, free, matrix, line);
                    }
                }
            }
        })
    }

    /// rms over stages and velocities of |h Σ_j A_ij Δa_j| in units of what the iteration may leave, and the velocity with the largest
    /// share; Δa is what `residual` holds. Each velocity has its own rounding: one that is all rounding says nothing of the others.
    fn velocity_change(&self, h: f64) -> (f64, usize) {
        let (count, enough) = (self.free.len(), self.enough(h));
        let (mut sum, mut worst, mut largest) = (0.0, self.free[0], 0.0);
        for (r, &k) in self.free.iter().enumerate() {
            let left = enough * self.allowed[r][0] + ROUNDED * self.noise[r];
            for row in &A {
                let moved: f64 = (0..STAGES).map(|j| row[j] * self.residual[j * count + r]).sum();
                let square = (h * moved / left).powi(2);
                sum += square;
                if square > largest {
                    (worst, largest) = (k, square);
                }
            }
        }
        ((sum / (STAGES * count) as f64).sqrt(), worst)
    }

    /// The share of the tolerance that the iteration may leave, not below rounding.
    fn enough(&self, h: f64) -> f64 {
        let end = &self.stages[STAGES - 1];
        let moved = |k: usize| end.v[k].abs().max(self.origin.v[k].abs()) + h * end.a[k].abs();
        let largest = self.free.iter().zip(&self.allowed).fold(0.0, |m: f64, (&k, [v, _])| m.max(moved(k) / v));
        self.rtol.sqrt().min(0.03) + 2e-14 * largest
    }
}

/// The laws' answers to the stages, and those of what controls the robot.
fn respond(bank: &mut ElementBank, control: Option<&mut ControlRun>) {
    (0..bank.len()).for_each(|e| bank.evaluate_element(e));
    if let Some(control) = control {
        control.answer(bank);
    }
}
