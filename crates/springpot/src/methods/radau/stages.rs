//! The stages of a step: where they are, and what drives them.

use super::step::RadauStep;
use crate::collocation::radau::A_SQUARED;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::equations::Equations;
use crate::equations::context::Context;
use crate::system::error::RunError;

/// Most iterations for the tangent vectors of floating joints.
const MOST_TURNS: usize = 30;

impl RadauStep {
    /// First guess of the stages' accelerations: the last cubic goes on.
    pub(super) fn predict(&mut self, h: f64) {
        for (stage, c) in self.stages.iter_mut().zip(RADAU_NODES) {
            match self.fitted.last {
                Some(size) => {
                    let theta = 1.0 + c * (h / size).min(4.0);
                    let [u0, u1, u2, u3] = &self.fitted.cubic;
                    for (j, a) in stage.a.iter_mut().enumerate() {
                        *a = u0[j] + theta * (u1[j] + theta * (u2[j] + theta * u3[j]));
                    }
                }
                None => stage.a.copy_from_slice(&self.origin.a),
            }
        }
    }

    /// What drives the joints at the nodes.
    pub(super) fn take_drives(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        h: f64,
        t_end: f64,
    ) -> Result<(), RunError> {
        for (i, (stage, c)) in self.stages.iter_mut().zip(RADAU_NODES).enumerate() {
            let at = if c == 1.0 { t_end } else { self.origin.t + c * h };
            stage.xi.fill(0.0);
            equations.drive(cx, (i, at), &self.origin.q, [&mut stage.q, &mut stage.v, &mut stage.a])?;
        }
        Ok(())
    }

    /// Positions and velocities of the stages from their accelerations, and what is seen there; `false` where a floating joint
    /// turns too far in the step.
    pub(super) fn place_stages(&mut self, cx: Context, equations: &mut Equations, h: f64) -> bool {
        for i in 0..STAGES {
            for &k in equations.free() {
                let push = self.collocate(i, |stage| stage.a[k]);
                let travel: f64 = A_SQUARED[i].iter().zip(&self.stages).map(|(a, stage)| a * stage.a[k]).sum();
                let v = self.origin.v[k];
                self.stages[i].v[k] = v + h * push;
                self.stages[i].xi[k] = h * (RADAU_NODES[i] * v + h * travel);
            }
        }
        if !self.model.is_one_degree() && !self.bend_tangents(equations.free(), h) {
            return false;
        }
        for i in 0..STAGES {
            self.move_free_joints(equations, i);
            let stage = &mut self.stages[i];
            stage.kinematics.update_velocity(&self.model, &stage.q, &stage.v);
            equations.see(cx, i + 1, [&stage.q, &stage.v], &stage.kinematics);
        }
        true
    }

    /// q_i = q_0 ⊕ ξ_i of the joints that forces drive; the others are where their signals say.
    fn move_free_joints(&mut self, equations: &Equations, i: usize) {
        let (stage, free) = (&mut self.stages[i], equations.free());
        if self.model.is_one_degree() {
            for &k in free {
                let index = self.model.coordinate_of(k).expect("a joint of one degree");
                stage.q[index] = self.origin.q[index] + stage.xi[k];
            }
            return;
        }
        if free.len() == self.model.nv() {
            self.model.integrate_into(&self.origin.q, &stage.xi, &mut stage.q);
            return;
        }
        self.held.clone_from(&stage.q);
        self.model.integrate_into(&self.origin.q, &stage.xi, &mut stage.q);
        equations.keep_moved(&self.model, &self.held, &mut stage.q);
    }

    /// Floating joints: ξ_i = h Σ_j A_ij J_r⁻¹(ξ_j) v_j, by iteration.
    fn bend_tangents(&mut self, free: &[usize], h: f64) -> bool {
        let mut before = f64::INFINITY;
        for _ in 0..MOST_TURNS {
            for stage in &mut self.stages {
                self.model.tangent_rate_into(&stage.xi, &stage.v, &mut stage.xi_rate);
            }
            let (mut change, mut size): (f64, f64) = (0.0, 0.0);
            for i in 0..STAGES {
                for &k in free {
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
