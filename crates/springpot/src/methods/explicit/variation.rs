//! What parameters change over an explicit step: the step with its size frozen, differentiated.
//!
//! Stage by stage ξ_i = h Σ a_ij ξ'_j and v_i = v_0 + h Σ a_ij a_j are linear, and so are their changes; those of the accelerations follow from the
//! equations of motion linearised at the stage itself, M δa = −(K δq + D δv + δ explicit), and works from their flows in the same way. Stages are
//! seen side by side, since the motion through them is known; between the ends what changes is a polynomial of order 7, as the motion is.

use super::attempt::corrected;
use super::integrated::Integrated;
use super::method::Explicit;
use super::step::{ExplicitStep, Place};
use super::tableau::{FIFTH, LEADS, PLACES, STAGES, THIRD};
use crate::account::recorder::Recorder;
use crate::collocation;
use crate::elements::ElementBank;
use crate::equations::{AtOnce, Equations, Node, ROW, STAGE, StepErrors, TANGENTS, Variation};
use crate::law::{InputValue, Point};
use crate::methods::stepper::Target;
use crate::model::{FreeTurn, Model, add_turned};
use crate::observe::Snapshot;

/// Where in the bank a stage is told.
const POINT: usize = 1;

/// A stage as it was seen: the robot, and what its elements were told and answered.
#[derive(Debug, Default)]
pub(super) struct StageSeen {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// Tangent vector from the start of the step.
    xi: Vec<f64>,
    forces: Vec<f64>,
    /// Stroke and rate of every element, and where its inputs end.
    told: Vec<([f64; 2], usize)>,
    inputs: Vec<InputValue>,
}

impl StageSeen {
    pub(super) fn take(&mut self, t: f64, at: &Place, found: &AtOnce, bank: &ElementBank) {
        self.t = t;
        self.q.clone_from(&at.q);
        self.v.clone_from(&at.v);
        self.a.clone_from(&at.a);
        self.xi.clone_from(&at.xi);
        self.forces.clear();
        self.forces.extend_from_slice(found.forces.values());
        self.told.clear();
        self.inputs.clear();
        for e in 0..bank.len() {
            let point = bank.point(e, POINT);
            self.inputs.extend_from_slice(point.inputs);
            self.told.push(([point.stroke, point.rate], self.inputs.len()));
        }
    }

    fn node(&self) -> Node<'_> {
        Node { t: self.t, q: &self.q, v: &self.v, a: &self.a }
    }

    /// What element `e` was told.
    fn point(&self, e: usize) -> Point<'_> {
        let ([stroke, rate], to) = self.told[e];
        let from = if e == 0 { 0 } else { self.told[e - 1].1 };
        Point { t: self.t, stroke, rate, inputs: &self.inputs[from..to] }
    }
}

/// What changes over the step that was varied last: blocks of ξ and v of every velocity that is sought, then of the works.
#[derive(Debug)]
pub(super) struct Varied {
    integrated: Integrated,
    /// Joints that turn freely.
    turns: Vec<FreeTurn>,
}

/// The velocities that are sought: in the extended robot, and how many columns each has.
struct Sought {
    free: Vec<usize>,
    count: usize,
}

impl Sought {
    fn of(equations: &Equations, variation: &Variation) -> Self {
        Self { free: variation.of_run(equations.free()), count: variation.count() }
    }

    /// Where blocks of the works begin.
    fn works(&self) -> usize {
        2 * self.free.len() * self.count
    }

    /// The joints that turn freely, each with the place of its first velocity among them.
    fn turns<'t>(
        &'t self,
        turns: &'t [FreeTurn],
        variation: &'t Variation,
    ) -> impl Iterator<Item = (&'t FreeTurn, usize)> {
        turns.iter().filter_map(|turn| {
            let first = variation.own_v()[turn.velocities.start];
            Some((turn, self.free.iter().position(|&k| k == first)?))
        })
    }
}

impl Varied {
    pub(super) fn new(model: &Model) -> Self {
        Self { integrated: Integrated::new(0), turns: model.free_turns().collect() }
    }

    /// Works out what changes over the step of size `h`; false where nothing does so in one way.
    fn work_out(&mut self, step: &ExplicitStep, equations: &Equations, variation: &mut Variation, h: f64) -> bool {
        let Some(seen) = &step.seen else { return false };
        let sought = Sought::of(equations, variation);
        self.integrated.resize(sought.works() + variation.flow_count() * sought.count);
        self.integrated.begin();
        variation.begin_integrated(equations, |e| step.power(0, e));
        self.slope(equations, variation, &sought, (0, 0), (None, &|e| equations.bank.point(e, 0)));
        let mut force = Vec::new();
        for first in (1..=STAGES).step_by(collocation::STAGES) {
            let stages = [0, 1, 2].map(|more| &seen[first + more]);
            force.clear();
            stages.iter().for_each(|stage| force.extend_from_slice(&stage.forces));
            variation.see_stages(equations, stages.map(StageSeen::node), &force);
            for (i, stage) in (1..).zip(stages) {
                variation.steer(i, equations, &stage.forces);
                if !self.pass(equations, variation, &sought, (first + i - 1, i, h), stage) {
                    return false;
                }
            }
        }
        self.integrated.end();
        variation.take_integrated(&self.integrated.change[sought.works()..], |e| step.power(STAGES, e));
        true
    }

    /// Goes on to a stage of a step of size `h`, which was seen at node `i`.
    fn pass(
        &mut self,
        equations: &Equations,
        variation: &mut Variation,
        sought: &Sought,
        (stage, i, h): (usize, usize, f64),
        seen: &StageSeen,
    ) -> bool {
        self.integrated.lead(LEADS[stage], h);
        self.place(variation, sought, i, |at| self.integrated.sum[at], &seen.xi);
        let is_regular = variation.accelerate_at(equations, i, &sought.free, |e| seen.point(e));
        self.slope(equations, variation, sought, (stage, i), (Some(seen), &|e| seen.point(e)));
        is_regular
    }

    /// Puts what changes of q and v at node `i`, whose way from the start of the step is ξ and changes so.
    fn place(&self, variation: &mut Variation, sought: &Sought, i: usize, change: impl Fn(usize) -> f64, xi: &[f64]) {
        variation.take_motion(i);
        let Sought { free, count } = sought;
        let (own, turns) = (free.len() * count, sought.turns(&self.turns, variation));
        let turns: Vec<_> = turns.map(|(turn, r)| (turn.count(), turn.step_slopes(xi), r)).collect();
        let [start, others @ ..] = &mut variation.nodes;
        let node = &mut others[i - 1];
        for (r, &k) in free.iter().enumerate() {
            for p in 0..*count {
                node.q[k * count + p] += change(r * count + p);
                node.v[k * count + p] += change(own + r * count + p);
            }
        }
        for (d, [carried, along], r) in turns {
            let way: Vec<f64> = (r * count..(r + d) * count).map(&change).collect();
            let block = free[r] * count..(free[r] + d) * count;
            let q = &mut node.q[block.clone()];
            q.fill(0.0);
            add_turned(q, &carried, &start.q[block], *count);
            add_turned(q, &along, &way, *count);
        }
    }

    /// Takes the slopes of a stage at node `i`; none was seen where it is the start of the step.
    fn slope<'p>(
        &mut self,
        equations: &Equations,
        variation: &Variation,
        sought: &Sought,
        (stage, i): (usize, usize),
        (seen, at): (Option<&StageSeen>, &dyn Fn(usize) -> Point<'p>),
    ) {
        let (Self { integrated: Integrated { slopes, sum, .. }, turns }, Sought { free, count }) = (self, sought);
        let (motion, flows) = slopes[stage].split_at_mut(sought.works());
        let (turned, pushed) = motion.split_at_mut(free.len() * count);
        let node = &variation.nodes[i];
        for (r, &k) in free.iter().enumerate() {
            let (own, block) = (r * count..(r + 1) * count, k * count..(k + 1) * count);
            turned[own.clone()].copy_from_slice(&node.v[block.clone()]);
            pushed[own].copy_from_slice(&node.a[block]);
        }
        for (seen, (turn, r)) in
            seen.into_iter().flat_map(|seen| sought.turns(turns, variation).map(move |turn| (seen, turn)))
        {
            let [by_velocity, by_turn] = turn.rate_slopes(&seen.xi, &seen.v);
            let (own, k) = (r * count..(r + turn.count()) * count, free[r]);
            let rates = &mut turned[own.clone()];
            rates.fill(0.0);
            add_turned(rates, &by_velocity, &node.v[k * count..(k + turn.count()) * count], *count);
            add_turned(rates, &by_turn, &sum[own], *count);
        }
        variation.flows_at(equations, i, at, flows);
    }

    /// The estimate of the step's error of the parameter whose changes it knows least, in units of its tolerance, `rtol` of their size: those of the
    /// motion, for changes. The motion itself is `moved` so fast and so far at each velocity.
    fn error(&self, equations: &Equations, variation: &Variation, (h, rtol): (f64, f64), moved: &[[f64; 2]]) -> f64 {
        let sought = Sought::of(equations, variation);
        let own = sought.works() / 2;
        let [fifth, third] = [FIFTH, THIRD].map(|weights| {
            let mut sum = Vec::new();
            self.integrated.sum_of(weights, &mut sum);
            sum.iter_mut().for_each(|sum| *sum *= h);
            let (places, rest) = sum.split_at(own);
            variation.step_errors(&sought.free, StepErrors { errors: [&rest[..own], places], moved, rtol })
        });
        let both = fifth.into_iter().zip(third).filter(|(fifth, _)| *fifth != 0.0);
        both.fold(0.0, |worst, (fifth, third)| f64::max(worst, corrected(fifth.powi(2), third.powi(2))))
    }

    /// Works out the stages between the ends of the step of size `h`.
    fn fill_between(&mut self, step: &ExplicitStep, equations: &Equations, variation: &mut Variation, h: f64) {
        let (Some(seen), false) = (&step.seen, self.integrated.is_dense()) else { return };
        let sought = Sought::of(equations, variation);
        for (stage, seen) in seen.iter().enumerate().skip(STAGES + 1) {
            variation.see(equations, STAGE, seen.node(), &seen.forces);
            variation.steer(STAGE, equations, &seen.forces);
            self.pass(equations, variation, &sought, (stage, STAGE, h), seen);
        }
        self.integrated.fill_between(h);
    }

    /// Puts what changes at θ of the step of size `h` into node [`ROW`], where the robot is as `shown`.
    fn look_between(
        &mut self,
        step: &ExplicitStep,
        (equations, variation): (&Equations, &mut Variation),
        (theta, h): (f64, f64),
        shown: &Snapshot,
    ) {
        self.fill_between(step, equations, variation, h);
        let sought = Sought::of(equations, variation);
        let mut xi = vec![0.0; shown.evaluation.v.len()];
        equations.free().iter().for_each(|&k| xi[k] = step.integrated.between(k, theta)[0]);
        self.place(variation, &sought, ROW, |at| self.integrated.between(at, theta)[0], &xi);
        let at = &shown.evaluation;
        let force: Vec<f64> = (0..variation.elements.len()).map(|e| shown.force(e)).collect();
        variation.see(equations, ROW, Node { t: at.t, q: &at.q, v: &at.v, a: &at.a }, &force);
        variation.steer(ROW, equations, &force);
        variation.accelerate_at(equations, ROW, &sought.free, |e| at.elements[e].point(at.t));
        let works = sought.works()..self.integrated.change.len();
        variation.take_integrated_at_row(works.map(|at| self.integrated.between(at, theta)[0]));
    }
}

impl Explicit {
    /// The error of what parameters change over the step that was worked out and told, where that shares in the choice of steps.
    pub(super) fn variation_error(&mut self, recorder: &mut Recorder, target: &Target) -> f64 {
        if !recorder.variation.as_ref().is_some_and(|variation| variation.shares_in_steps()) {
            return 0.0;
        }
        if !self.vary_step(recorder, target) {
            return f64::INFINITY;
        }
        let Recorder { equations, variation: Some(variation), .. } = recorder else { return 0.0 };
        let allowed = (target.size, TANGENTS * self.tolerance.rtol);
        self.varied.error(equations, variation, allowed, &self.radau.step.errors.sized)
    }

    /// Works out what parameters change over the step that was worked out and told; false where nothing does so in one way.
    pub(super) fn vary_step(&mut self, recorder: &mut Recorder, target: &Target) -> bool {
        let Recorder { equations, variation: Some(variation), .. } = recorder else { return true };
        let Self { step, radau, varied, kept, .. } = self;
        if std::mem::take(&mut kept.is_behind_kink) {
            variation.start_anew(equations, radau.step.origin.node());
        }
        let leaning = equations.lean(target.size, &radau.step.errors.noise);
        if let Some(seen) = &mut step.seen {
            let ends = seen.iter_mut().zip(PLACES).take(STAGES + 1).filter(|(_, c)| *c == 1.0);
            for (end, _) in ends {
                for &e in equations.leaning() {
                    let near = equations.bank.point(e, collocation::STAGES);
                    end.told[e].0 = [near.stroke, near.rate];
                }
            }
        }
        let is_regular = varied.work_out(step, equations, variation, target.size);
        equations.stand(leaning);
        is_regular
    }

    /// What changes at a row within the step, or at its end.
    pub(super) fn vary_row(&mut self, recorder: &mut Recorder, within: Option<(f64, f64)>, shown: &Snapshot) {
        let Recorder { equations, variation: Some(variation), .. } = recorder else { return };
        match within {
            None => variation.take_start(ROW),
            Some((1.0, _)) => variation.take_end(),
            Some(within) => self.varied.look_between(&self.step, (equations, variation), within, shown),
        }
    }
}
