//! One step of the explicit method: its stages, its end, and what lies between.

use super::tableau::{ALL_STAGES, LAST_TERMS, LEADS, PLACES, STAGES, TERMS, Weights};
use crate::account::works::{Works, polynomial};
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
    xi: Vec<f64>,
    xi_rate: Vec<f64>,
}

/// A step from an [`Origin`].
///
/// What is integrated are ξ, the tangent vector from the start with q = q_0 ⊕ ξ, by its rate J_r(ξ)⁻¹ v; v; and the works of [`Works`], by the
/// powers.
/// Rows of `slopes` and `terms` hold these, one behind the other.
#[derive(Debug)]
pub(super) struct ExplicitStep {
    model: Arc<Model>,
    pub(super) found: AtOnce,
    slopes: [Vec<f64>; ALL_STAGES],
    /// Of the polynomial between the ends.
    terms: [Vec<f64>; TERMS],
    /// At the stage under way, and at the end.
    at: Place,
    pub(super) end: Place,
    /// What the step changes.
    change: Vec<f64>,
    /// Forces of the elements and the links at the end.
    pub(super) forces: Vec<f64>,
    pub(super) kinematics: Kinematics,
    sum: Vec<f64>,
    /// Whether the first slopes are those of the origin, and whether the terms are those of the step.
    is_begun: bool,
    is_dense: bool,
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
            slopes: std::array::from_fn(|_| vec![0.0; n]),
            terms: std::array::from_fn(|_| vec![0.0; n]),
            at: Place::new(model),
            end: Place::new(model),
            change: vec![0.0; n],
            forces: vec![0.0; system.elements.len()],
            kinematics: Kinematics::new(model),
            sum: vec![0.0; n],
            is_begun: false,
            is_dense: false,
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
        (self.is_dense, self.t_end) = (false, t_end);
        if !self.is_begun {
            self.sum.fill(0.0);
            if !self.slope(cx, equations, origin, (0, 0.0))? {
                return Ok(false);
            }
            self.is_begun = true;
        }
        for stage in 1..=STAGES {
            self.lead(LEADS[stage], h);
            if !self.slope(cx, equations, origin, (stage, h))? {
                return Ok(false);
            }
        }
        self.change.copy_from_slice(&self.sum);
        std::mem::swap(&mut self.at, &mut self.end);
        self.forces.copy_from_slice(self.found.forces.values());
        std::mem::swap(&mut self.kinematics, &mut self.found.kinematics);
        Ok(true)
    }

    /// h Σ w_j of the slopes.
    fn lead(&mut self, weights: Weights, h: f64) {
        combine(&self.slopes, weights, h, &mut self.sum);
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
        let Self { model, at, sum, found, slopes, t_end, .. } = &mut *self;
        let [way, push] = [&sum[..n], &sum[n..2 * n]];
        at.go(model, origin, [way, push]);
        let c = PLACES[stage];
        let (t, node) = match c {
            1.0 => (*t_end, collocation::STAGES),
            _ => (origin.t + c * h, if stage < STAGES { collocation::STAGES } else { BETWEEN }),
        };
        let slope = &mut slopes[stage];
        let (motion, powers) = slope.split_at_mut(2 * n);
        let Place { q, v, a, xi, xi_rate } = at;
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
        Ok(is_found && powers.iter().all(|power| power.is_finite()))
    }

    /// Σ w_j of the slopes of the step.
    pub(super) fn sum_of(&self, weights: Weights, sum: &mut Vec<f64>) {
        sum.resize(self.change.len(), 0.0);
        combine(&self.slopes, weights, 1.0, sum);
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
        if std::mem::replace(&mut self.is_dense, true) {
            return Ok(());
        }
        for stage in STAGES + 1..ALL_STAGES {
            self.lead(LEADS[stage], h);
            self.slope(cx, equations, origin, (stage, h))?;
        }
        let Self { slopes, terms, change, .. } = self;
        let [way, first, second, last @ ..] = terms;
        for (at, change) in change.iter().enumerate() {
            let [start, end] = [slopes[0][at], slopes[STAGES][at]];
            way[at] = *change;
            first[at] = h * start - change;
            second[at] = 2.0 * change - h * (end + start);
        }
        last.iter_mut().zip(LAST_TERMS).for_each(|(term, weights)| combine(slopes, weights, h, term));
        Ok(())
    }

    /// Number `at` of what is integrated from the start of the step to θ, and its derivative by θ; the polynomial is there.
    fn between(&self, at: usize, theta: f64) -> [f64; 2] {
        polynomial(std::array::from_fn(|term| self.terms[term][at]), theta)
    }

    /// What the step does to the works, and how within it, where that was worked out.
    pub(super) fn tell_works(&self, works: &mut Works) {
        let from = 2 * self.model.nv();
        works.take(&self.change[from..], self.is_dense.then(|| self.terms.each_ref().map(|term| &term[from..])));
    }

    /// Goes on to the end of the step.
    pub(super) fn accept(&mut self, free: &[usize]) {
        let (first, rest) = self.slopes.split_at_mut(1);
        std::mem::swap(&mut first[0], &mut rest[STAGES - 1]);
        // Seen from there the tangent vector begins anew.
        free.iter().for_each(|&k| first[0][k] = self.end.v[k]);
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
        let powers = &mut self.sum[2 * self.model.nv()..];
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
        let Self { model, at, sum, found, slopes, .. } = self;
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
        self.between(self.model.nv() + k, theta)[0]
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
            let [push, slope] = self.between(n + k, theta);
            xi[k] = self.between(k, theta)[0];
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

/// sum ← h Σ w_j of the slopes.
fn combine(slopes: &[Vec<f64>; ALL_STAGES], weights: Weights, h: f64, sum: &mut [f64]) {
    sum.fill(0.0);
    for &(j, weight) in weights {
        sum.iter_mut().zip(&slopes[j]).for_each(|(sum, slope)| *sum += weight * slope);
    }
    sum.iter_mut().for_each(|sum| *sum *= h);
}
