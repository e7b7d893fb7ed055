//! The Newton iteration for the accelerations of the stages: three unknowns for each free velocity.

use super::step::RadauStep;
use crate::collocation::STAGES;
use crate::collocation::radau::A;
use crate::equations::Equations;
use crate::equations::context::Context;
use crate::system::error::RunError;
use serde::{Deserialize, Serialize};

/// Newton iterations after which a step is given up.
const MOST_ITERATIONS: u32 = 10;

/// Ratio of increments that larger ones are taken for, and what is not known since the iteration diverged.
const MOST_CONTRACTION: f64 = 0.9;

/// Ratio of successive increments of the iteration, in the step where it was seen last.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Contraction {
    ratio: f64,
    /// Size of that step, s; 0 where none was seen.
    size: f64,
}

impl Contraction {
    /// What may be expected of a step of size `h`: what the matrix does not know of a step grows at least as its square.
    fn at(self, h: f64) -> f64 {
        let grown = if self.size > 0.0 { (h / self.size).max(1.0) } else { 1.0 };
        (self.ratio * grown * grown).clamp(1e-3, MOST_CONTRACTION)
    }
}

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
        equations: &mut Equations,
        h: f64,
        t_end: f64,
    ) -> Result<Outcome, RunError> {
        if equations.begin(cx, self.origin.node(), h, t_end)? {
            self.take_off_singular(equations);
        }
        equations.prepare(cx, t_end)?;
        self.predict(h);
        self.take_drives(cx, equations, h, t_end)?;
        self.allow(cx, equations, h);
        let (mut before, mut iterations) = (f64::INFINITY, 0);
        let mut worst = equations.free().first().copied().unwrap_or(0);
        if !self.place_stages(cx, equations, h) {
            return Ok(Outcome::Diverged { iterations, worst });
        }
        equations.answer();
        let count = equations.free().len();
        if count == 0 {
            self.collect_regular(equations);
            return Ok(Outcome::Converged { iterations });
        }
        equations.take_input_forces();
        if !self.system.factor(equations, self.model.nv(), h) {
            return Ok(Outcome::Diverged { iterations, worst });
        }
        loop {
            iterations += 1;
            self.fill_residual(cx, equations, t_end);
            let free = equations.free();
            if let Some(k) = self.residual.iter().position(|r| !r.is_finite()) {
                return Ok(Outcome::Diverged { iterations, worst: free[k % count] });
            }
            self.system.solve(&mut self.residual);
            for (stage, change) in self.stages.iter_mut().zip(self.residual.chunks_exact(count)) {
                for (&k, delta) in free.iter().zip(change) {
                    stage.a[k] -= delta;
                }
            }
            if iterations == 1 && self.errors.finds_nothing_moving() {
                self.allow(cx, equations, h);
            }
            let size;
            (size, worst) = self.velocity_change(equations.free(), h);
            let placed = size.is_finite() && self.place_stages(cx, equations, h);
            if placed {
                equations.answer();
            }
            if iterations > 1 {
                self.contraction = Contraction { ratio: size / before, size: h };
            }
            if !placed || (iterations > 2 && self.contraction.ratio >= 1.0) {
                self.contraction = Contraction { ratio: MOST_CONTRACTION, size: h };
                return Ok(Outcome::Diverged { iterations, worst });
            }
            let theta = self.contraction.at(h);
            if size * theta / (1.0 - theta) <= 1.0 {
                break;
            }
            if iterations == MOST_ITERATIONS {
                return Ok(Outcome::Diverged { iterations, worst });
            }
            before = size;
        }
        self.collect_regular(equations);
        Ok(Outcome::Converged { iterations })
    }

    /// The residual of the free velocities, node by node.
    fn fill_residual(&mut self, cx: Context, equations: &mut Equations, t_end: f64) {
        self.residual.clear();
        for (i, stage) in self.stages.iter().enumerate() {
            equations.residual(cx, i + 1, stage.node(t_end), &stage.kinematics, &mut self.residual);
        }
    }

    /// rms over stages and velocities of |h Σ_j A_ij Δa_j| in units of what the iteration may leave, and the velocity with the largest
    /// share; Δa is what `residual` holds. Each velocity has its own rounding: one that is all rounding says nothing of the others.
    fn velocity_change(&self, free: &[usize], h: f64) -> (f64, usize) {
        let (count, enough) = (free.len(), self.enough(free, h));
        let (mut sum, mut worst, mut largest) = (0.0, free[0], 0.0);
        for (r, &k) in free.iter().enumerate() {
            let left = enough * self.errors.allowed[r][0] + ROUNDED * self.errors.noise[r];
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
    fn enough(&self, free: &[usize], h: f64) -> f64 {
        let end = &self.stages[STAGES - 1];
        let moved = |k: usize| end.v[k].abs().max(self.origin.v[k].abs()) + h * end.a[k].abs();
        let largest = free.iter().zip(&self.errors.allowed).fold(0.0, |m: f64, (&k, [v, _])| m.max(moved(k) / v));
        self.rtol.sqrt().min(0.03) + 2e-14 * largest
    }
}
