//! One step of the explicit method: its stages, its end, and what lies between.

use super::integrated::Integrated;
use super::tableau::{ALL_STAGES, LEADS, PLACES, STAGES};
use super::variation::StageSeen;
use crate::account::works::Works;
use crate::actuation::Forward;
use crate::collocation;
use crate::dynamics::Kinematics;
use crate::equations::context::Context;
use crate::equations::{AtOnce, Equations, OWN_POWERS, Origin};
use crate::model::Model;
use crate::system::System;
use crate::system::error::RunError;
use std::sync::Arc;

/// The node from whose place control looks between the ends of a step.
const BETWEEN: usize = 1;

/// The robot at one time of the step.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) a: Vec<f64>,
    /// Tangent vector from the start of the step, and its rate.
    pub(super) xi: Vec<f64>,
    xi_rate: Vec<f64>,
}

/// A step from an [`Origin`].
///
/// What is integrated are ξ, the tangent vector from the start with q = q_0 ⊕ ξ, by its rate J_r(ξ)⁻¹ v; v; and the works of [`Works`], by the
/// powers.
/// Rows of what is `integrated` hold these, one behind the other.
#[derive(Debug)]
pub(super) struct ExplicitStep {
    model: Arc<Model>,
    pub(super) found: AtOnce,
    pub(super) integrated: Integrated,
    /// At the stage under way, and at the end.
    at: Place,
    pub(super) end: Place,
    /// Forces of the elements and the links at the end.
    pub(super) forces: Vec<f64>,
    pub(super) kinematics: Kinematics,
    /// The stages as they were seen, where what parameters change is asked for.
    pub(super) seen: Option<Box<[StageSeen; ALL_STAGES]>>,
    /// Whether the first slopes are those of the origin.
    is_begun: bool,
    /// Time of the last stage, s.
    t_end: f64,
    pub(super) evaluations: u64,
}

impl Place {
    fn new(model: &Model) -> Self {
        let zero = || vec![0.0; model.nv()];
        Self { q: vec![0.0; model.nq()], v: zero(), a: zero(), xi: zero(), xi_rate: zero() }
    }
}

/// Of what is integrated: how many numbers.
fn length(system: &System) -> usize {
    2 * system.model.nv() + OWN_POWERS + 2 * system.elements.len()
}

impl ExplicitStep {
    pub(super) fn new(system: &System, forward: &Forward) -> Self {
        let model = &system.model;
        let n = length(system);
        let free = forward.free_velocities(model).len();
        Self {
            model: model.clone(),
            found: AtOnce::new(system, free),
            integrated: Integrated::new(n),
            at: Place::new(model),
            end: Place::new(model),
            forces: vec![0.0; system.elements.len()],
            kinematics: Kinematics::new(model),
            seen: system.sensitivity.as_ref().map(|_| Box::default()),
            is_begun: false,
            t_end: 0.0,
            evaluations: 0,
        }
    }

    /// The origin is another one than the end of the last step.
    pub(super) fn forget(&mut self) {
        self.is_begun = false;
    }

    /// Works out the stages of a step of size `h` whose end is at `t_end`; `false` where one of them cannot be.
    ///
    /// # Errors
    /// What a signal or an input says.
    pub(super) fn attempt(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        origin: &Origin,
        (h, t_end): (f64, f64),
    ) -> Result<bool, RunError> {
        self.t_end = t_end;
        self.integrated.begin();
        if !self.is_begun {
            if !self.slope(cx, equations, origin, (0, 0.0))? {
                return Ok(false);
            }
            self.is_begun = true;
        }
        for stage in 1..=STAGES {
            self.integrated.lead(LEADS[stage], h);
            if !self.slope(cx, equations, origin, (stage, h))? {
                return Ok(false);
            }
        }
        self.integrated.end();
        std::mem::swap(&mut self.at, &mut self.end);
        self.forces.copy_from_slice(self.found.forces.values());
        std::mem::swap(&mut self.kinematics, &mut self.found.kinematics);
        Ok(true)
    }

    /// The slopes of a stage, whose way from the origin is `sum`.
    fn slope(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        origin: &Origin,
        (stage, h): (usize, f64),
    ) -> Result<bool, RunError> {
        // Rows and looks inside, whose stages come later, do not count.
        self.evaluations += u64::from(stage <= STAGES);
        let n = self.model.nv();
        let Self { model, at, found, integrated: Integrated { slopes, sum, .. }, seen, t_end, .. } = self;
        let [way, push] = [&sum[..n], &sum[n..2 * n]];
        at.go(model, origin, [way, push]);
        let c = PLACES[stage];
        let (t, node) = match c {
            1.0 => (*t_end, collocation::STAGES),
            _ => (origin.t + c * h, if stage < STAGES { collocation::STAGES } else { BETWEEN }),
        };
        let slope = &mut slopes[stage];
        let (motion, powers) = slope.split_at_mut(2 * n);
        let Place { q, v, a, xi, xi_rate } = &mut *at;
        let is_found = equations.accelerate_at(cx, found, (t, node), [q, v, a], powers)?;
        let (turn, speed) = motion.split_at_mut(n);
        turn.fill(0.0);
        speed.fill(0.0);
        if !model.is_one_degree() {
            model.tangent_rate_into(xi, v, xi_rate);
        }
        let rate = if model.is_one_degree() { &*v } else { &*xi_rate };
        for &k in equations.free() {
            (turn[k], speed[k]) = (rate[k], a[k]);
        }
        if let Some(seen) = seen {
            seen[stage].take(t, at, found, &equations.bank);
        }
        Ok(is_found && powers.iter().all(|power| power.is_finite()))
    }

    /// Works out the polynomial between the ends of the step, of size `h`, unless that was done.
    ///
    /// # Errors
    /// What a signal or an input says.
    pub(super) fn fill_between(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        origin: &Origin,
        h: f64,
    ) -> Result<(), RunError> {
        if self.integrated.is_dense() {
            return Ok(());
        }
        for stage in STAGES + 1..ALL_STAGES {
            self.integrated.lead(LEADS[stage], h);
            self.slope(cx, equations, origin, (stage, h))?;
        }
        self.integrated.fill_between(h);
        Ok(())
    }

    /// What element `e` dissipates and is supplied with at a stage, W.
    pub(super) fn power(&self, stage: usize, e: usize) -> [f64; 2] {
        let from = 2 * self.model.nv() + OWN_POWERS + 2 * e;
        [0, 1].map(|which| self.integrated.slopes[stage][from + which])
    }

    /// What the step does to the works, and how within it, where that was worked out.
    pub(super) fn tell_works(&self, works: &mut Works) {
        let from = 2 * self.model.nv();
        works.take(
            &self.integrated.change[from..],
            self.integrated.terms().map(|terms| terms.map(|term| &term[from..])),
        );
    }

    /// Goes on to the end of the step.
    pub(super) fn accept(&mut self, free: &[usize]) {
        let slopes = &mut self.integrated.slopes;
        slopes.swap(0, STAGES);
        // Seen from there the tangent vector begins anew.
        free.iter().for_each(|&k| slopes[0][k] = self.end.v[k]);
    }

    /// The accelerations at any time of the step, from q and v there.
    ///
    /// # Errors
    /// What a signal or an input says.
    pub(super) fn accelerate(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        t: f64,
        [q, v, a]: [&mut [f64]; 3],
    ) -> Result<(), RunError> {
        let powers = &mut self.integrated.sum[2 * self.model.nv()..];
        equations.accelerate_at(cx, &mut self.found, (t, BETWEEN), [q, v, a], powers).map(|_| ())
    }

    /// What the slopes at the origin change by, over `size`, a small number, where ξ and v are `size` times `way` off there: ξ of all velocities,
    /// then v. `way` is exchanged for it.
    ///
    /// # Errors
    /// What a signal or an input says.
    pub(super) fn probe(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        origin: &Origin,
        (way, size): (&mut [f64], f64),
    ) -> Result<(), RunError> {
        let n = self.model.nv();
        let Self { model, at, found, integrated: Integrated { slopes, sum, .. }, .. } = self;
        way.iter_mut().for_each(|way| *way *= size);
        at.go(model, origin, [&way[..n], &way[n..]]);
        let Place { q, v, a, xi, xi_rate } = at;
        equations.accelerate_at(cx, found, (origin.t, BETWEEN), [q, v, a], &mut sum[2 * n..])?;
        model.tangent_rate_into(xi, v, xi_rate);
        way.fill(0.0);
        for &k in equations.free() {
            way[k] = (xi_rate[k] - slopes[0][k]) / size;
            way[n + k] = (a[k] - slopes[0][n + k]) / size;
        }
        Ok(())
    }

    /// What the step adds to velocity `k` until θ.
    pub(super) fn push(&self, k: usize, theta: f64) -> f64 {
        self.integrated.between(self.model.nv() + k, theta)[0]
    }

    /// Fills q, v and a of the joints that forces drive at θ of the step from `origin`, of size `h`, whose polynomial is there.
    pub(super) fn place(
        &self,
        equations: &Equations,
        (origin, h): (&Origin, f64),
        theta: f64,
        xi: &mut Vec<f64>,
        [q, v, a]: [&mut [f64]; 3],
    ) {
        let n = self.model.nv();
        xi.clear();
        xi.resize(n, 0.0);
        v.copy_from_slice(&origin.v);
        a.fill(0.0);
        for &k in equations.free() {
            let [push, slope] = self.integrated.between(n + k, theta);
            xi[k] = self.integrated.between(k, theta)[0];
            (v[k], a[k]) = (origin.v[k] + push, slope / h);
        }
        self.model.integrate_into(&origin.q, xi, q);
    }
}

impl Place {
    /// Goes the way ξ from the origin, and to the velocities that `push` adds to; joints that do not move stay to the bit.
    fn go(&mut self, model: &Model, origin: &Origin, [way, push]: [&[f64]; 2]) {
        let Self { q, v, xi, .. } = self;
        xi.copy_from_slice(way);
        v.iter_mut().zip(origin.v.iter().zip(push)).for_each(|(v, (from, push))| *v = from + push);
        if way.iter().all(|xi| *xi == 0.0) {
            q.copy_from_slice(&origin.q);
        } else {
            model.integrate_into(&origin.q, way, q);
        }
    }
}
