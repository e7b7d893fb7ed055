//! Singular shares of what parameters change.
//!
//! A force that is infinite at t = 0 has the share s·F of the accelerations, s = −M⁻¹ g at the start of a step. What is left has no jump: the
//! cubic through it tells rows, and the embedded formula the error. So of changes: δ(s F) = s δF + δs F with
//!
//! δs = −M⁻¹ (δg + δM s), δM s = ∂(M s)/∂q δq + ∂M/∂θ s.
//!
//! Changes of x(0) are singular also where the run itself is not, x(0) being 0.

use super::{ElementVariation, ROW, Variation, of_step};
use crate::collocation::STAGES;
use crate::dynamics::{Kinematics, RneaDerivatives, rnea_at_into};
use crate::elements::Forces;
use crate::equations::assembly::{Equations, singular_parts};
use crate::law::Term;
use crate::law::variation::PointVariation;
use crate::observe::Snapshot;
use crate::sensitivity::Seed;
use serde::{Deserialize, Serialize};

/// What singular forces have of the changes over a step.
#[derive(Debug, Default)]
pub(super) struct Singular {
    /// Whether any are.
    pub(super) is_there: bool,
    /// The same of the accelerations where the step starts, which are then without their share.
    starts_regular: bool,
    pub(super) elements: Vec<Share>,
}

/// One element.
#[derive(Debug, Clone, Default)]
pub(super) struct Share {
    /// s, of each velocity.
    of_force: Vec<f64>,
    /// δs, a block for each velocity.
    change: Vec<f64>,
    /// F at the end of the last step, and at the nodes of this one.
    force: [f64; STAGES + 1],
    /// δF there.
    force_change: Vec<f64>,
    /// x(0), and δx(0).
    stroke: f64,
    stroke_change: Vec<f64>,
}

/// What outlasts a step: whether the accelerations at its start are without their share; F and δF at the end of the last one.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct SingularState {
    starts_regular: bool,
    before: Vec<(f64, Vec<f64>)>,
}

impl Singular {
    pub(super) fn new(elements: usize, nv: usize, count: usize) -> Self {
        let share = Share {
            of_force: vec![0.0; nv],
            change: vec![0.0; nv * count],
            force: [0.0; STAGES + 1],
            force_change: vec![0.0; (STAGES + 1) * count],
            stroke: 0.0,
            stroke_change: vec![0.0; count],
        };
        Self { is_there: false, starts_regular: true, elements: vec![share; elements] }
    }

    pub(super) fn save(&self, count: usize) -> SingularState {
        let before = |own: &Share| (own.force[0], own.force_change[..count].to_vec());
        SingularState { starts_regular: self.starts_regular, before: self.elements.iter().map(before).collect() }
    }

    pub(super) fn load(&mut self, state: SingularState, count: usize) -> bool {
        if state.before.len() != self.elements.len() || state.before.iter().any(|(_, own)| own.len() != count) {
            return false;
        }
        self.starts_regular = state.starts_regular;
        for (own, (force, change)) in self.elements.iter_mut().zip(state.before) {
            own.force[0] = force;
            own.force_change[..count].copy_from_slice(&change);
        }
        true
    }

    /// The accelerations at the start were worked out anew, without their share.
    pub(super) fn restart(&mut self, count: usize) {
        self.starts_regular = true;
        for own in &mut self.elements {
            own.force[0] = 0.0;
            own.force_change[..count].fill(0.0);
        }
    }

    /// What of the acceleration of velocity `k` at point `i` of the step changes by parameter `p` is theirs.
    fn of_acceleration(&self, i: usize, k: usize, p: usize, count: usize) -> f64 {
        let own =
            |own: &Share| own.of_force[k] * own.force_change[i * count + p] + own.change[k * count + p] * own.force[i];
        self.elements.iter().map(own).sum()
    }
}

impl Variation {
    /// The run goes on behind a jump of forces.
    pub(in crate::equations) fn restart_singular(&mut self, equations: &Equations) {
        self.singular.restart(self.count());
        self.share_forces(equations);
    }

    /// Finds out whether something is singular, and what share forces have where the step starts.
    pub(crate) fn share_forces(&mut self, equations: &Equations) {
        let laws = self.elements.iter().any(|element| element.law.is_singular());
        self.singular.is_there = equations.is_singular() || laws;
        if !self.singular.is_there {
            return;
        }
        let (count, n, free) = (self.count(), self.nv(), self.of_run(equations.free()));
        let Self { system, by, nodes: [start, ..], singular, solve, workspace, .. } = self;
        let tau = &mut vec![0.0; n];
        let model = &system.model;
        let regular = !free.is_empty() && solve.factor_part(&start.slopes.d_a, n, &free);
        let mut still = Kinematics::new(model);
        still.update_velocity(model, &start.q_now, &vec![0.0; n]);
        let mut rest = RneaDerivatives::new(model);
        let mut turned = RneaDerivatives::new(model);
        Forces::default().inverse_dynamics_derivatives_into(model, &still, &vec![0.0; n], workspace, &mut rest);
        let mut right = Vec::new();
        for (e, Share { of_force, change, .. }) in singular.elements.iter_mut().enumerate() {
            of_force.fill(0.0);
            change.fill(0.0);
            if !regular {
                continue;
            }
            let [gradient, _] = &start.gradients[e];
            right.clear();
            right.extend(free.iter().map(|&k| -gradient[k]));
            solve.solve(&mut right);
            free.iter().zip(&right).for_each(|(&k, x)| of_force[k] = *x);
            Forces::default().inverse_dynamics_derivatives_into(model, &still, of_force, workspace, &mut turned);
            for (p, parameter) in by.parameters.iter().enumerate() {
                let mut owed = vec![0.0; n];
                for (k, owed) in owed.iter_mut().enumerate() {
                    for c in 0..n {
                        let at = k * n + c;
                        let by_place = start.hessians[e][at] + turned.d_q[at] - rest.d_q[at];
                        *owed += by_place * start.q[c * count + p];
                    }
                }
                for seed in &parameter.seeds {
                    if let Seed::Inertia(inertia) = seed {
                        let mut add = |a: &[f64], sign: f64| {
                            rnea_at_into(inertia, &still, &start.q_now, a, &[], workspace, tau);
                            owed.iter_mut().zip(&*tau).for_each(|(owed, tau)| *owed += sign * tau);
                        };
                        add(of_force, 1.0);
                        add(&vec![0.0; n], -1.0);
                    }
                }
                right.clear();
                right.extend(free.iter().map(|&k| -owed[k]));
                solve.solve(&mut right);
                free.iter().zip(&right).for_each(|(&k, x)| change[k * count + p] = *x);
            }
        }
    }

    /// What changes of singular forces at the nodes of the step that was asked.
    pub(super) fn ask_singular(&mut self, equations: &Equations) {
        if !self.singular.is_there {
            return;
        }
        let count = self.count();
        for (e, own) in self.singular.elements.iter_mut().enumerate() {
            own.force[1..].copy_from_slice(&equations.bank.response(e).singular[..STAGES]);
            let ElementVariation { law, stroke, rate, inputs, .. } = &self.elements[e];
            let told = of_step(count, [stroke, rate], inputs);
            equations.bank.vary_singular(e, &told, law, &mut own.force_change[count..]);
        }
    }

    /// The step goes into the past, the laws have taken it: what is left at its end is what the next one begins with.
    pub(super) fn commit_singular(&mut self, equations: &Equations) {
        self.ask_singular(equations);
        let (count, last) = (self.count(), STAGES * self.count());
        self.singular.starts_regular = false;
        for own in &mut self.singular.elements {
            own.force[0] = own.force[STAGES];
            own.force_change.copy_within(last..last + count, 0);
        }
    }

    /// Whether something is singular.
    pub(crate) fn is_singular(&self) -> bool {
        self.singular.is_there
    }

    /// What changes of the acceleration of velocity `k` at the start (0) or at a node of the step by parameter `p`, without the share of singular
    /// forces.
    pub(crate) fn regular(&self, i: usize, k: usize, p: usize) -> f64 {
        let (count, own) = (self.count(), self.nodes[i].a[k * self.count() + p]);
        if self.singular.is_there { own - self.singular.of_acceleration(i, k, p, count) } else { own }
    }

    /// Adds the share of singular forces to what changes of the motion at a row, at θ of the step or between two.
    pub(super) fn move_row(&mut self, equations: &Equations, theta: Option<f64>, snapshot: &Snapshot) {
        if !self.singular.is_there || (theta.is_none() && !self.singular.starts_regular) {
            return;
        }
        let (count, t) = (self.count(), snapshot.evaluation.t);
        let from = if theta.is_some() { equations.bank.from() } else { t };
        for e in 0..self.elements.len() {
            let point = snapshot.evaluation.elements[e].point(t);
            let mut force = [0.0; 3];
            equations.bank.for_each_singularity(e, point.inputs, &mut |term| {
                let parts = singular_parts(&term, from, t);
                force.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            });
            let changes = self.singular_at(equations, e, from, snapshot);
            let Share { of_force, change, .. } = &self.singular.elements[e];
            let row = &mut self.nodes[ROW];
            for (k, share) in of_force.iter().enumerate() {
                for p in 0..count {
                    let block = k * count + p;
                    let [value, once, twice] =
                        [0, 1, 2].map(|order| share * changes[order][p] + change[block] * force[order]);
                    row.a[block] += value;
                    if theta.is_some() {
                        row.v[block] += once;
                        row.q[block] += twice;
                    }
                }
            }
        }
    }

    /// What changes of the singular forces of element `e` at a row, and of their integrals since `from`.
    pub(super) fn singular_at(&self, equations: &Equations, e: usize, from: f64, snapshot: &Snapshot) -> [Vec<f64>; 3] {
        let count = self.count();
        let mut sums = [(); 3].map(|()| vec![0.0; count]);
        let ElementVariation { law, stroke, rate, inputs: [values, rates], .. } = &self.elements[e];
        let own = |blocks: &[f64]| blocks.len() / (ROW + 1) * ROW;
        let told = PointVariation {
            stroke: &stroke[ROW * count..],
            rate: &rate[ROW * count..],
            inputs: [&values[own(values)..], &rates[own(rates)..]],
            step: None,
            passed: None,
        };
        let point = snapshot.evaluation.elements[e].point(snapshot.evaluation.t);
        let [value, once, twice] = &mut sums;
        equations.bank.vary_singularity(e, (from, &point), &told, law, [value, once, twice]);
        sums
    }

    /// Takes in where elements start.
    pub(super) fn begin_singular(&mut self, equations: &Equations) {
        let count = self.count();
        for (e, (own, element)) in self.singular.elements.iter_mut().zip(&self.elements).enumerate() {
            own.stroke = equations.bank.point(e, 0).stroke;
            own.stroke_change.copy_from_slice(&element.stroke[..count]);
        }
        self.share_forces(equations);
    }

    /// How far velocity `k` travels by what parameter `p` changes of singular forces: about as far as the stroke is long by which they began.
    pub(super) fn jump_travel(&self, k: usize, p: usize) -> f64 {
        if !self.singular.is_there {
            return 0.0;
        }
        let (count, typical) = (self.count(), self.by.parameters[p].typical.abs());
        let of = |(e, own): (usize, &Share)| {
            let [gradient, _] = &self.nodes[0].gradients[e];
            let square: f64 = gradient.iter().map(|g| g * g).sum();
            let changes = own.force_change[count..].iter().skip(p).step_by(count).any(|change| *change != 0.0)
                || own.force[1] != 0.0 && own.change.iter().skip(p).step_by(count).any(|change| *change != 0.0);
            let relative = if changes && typical > 0.0 { own.stroke.abs() / typical } else { 0.0 };
            let stroke = if self.elements[e].law.is_singular() { own.stroke_change[p].abs() } else { 0.0 };
            if square > 0.0 { (stroke + relative) * gradient[k].abs() / square } else { 0.0 }
        };
        self.singular.elements.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// The longest first step in which what changes of x(0) moves the robot by no more than a share `rtol` of that: the estimate does not see it.
    pub(crate) fn longest_first(&self, equations: &Equations, rtol: f64) -> f64 {
        let (count, mut longest) = (self.count(), f64::INFINITY);
        for (e, own) in self.elements.iter().enumerate().filter(|(_, own)| own.law.is_singular()) {
            let ([gradient, _], point) = (&self.nodes[0].gradients[e], equations.bank.point(e, 0));
            let square: f64 = gradient.iter().map(|g| g * g).sum();
            let push = &self.singular.elements[e].of_force;
            self.system.elements[e].law.for_each_springpot(&point, &mut |Term { coefficient, order }| {
                let is_fractional = order > 0.0 && order < 1.0;
                for p in (0..count).filter(|p| is_fractional && own.stroke[*p] != 0.0) {
                    let kicks = push.iter().zip(gradient).enumerate().map(|(k, (push, g))| {
                        let travel = (own.stroke[p] * g / square).abs().max(self.nodes[0].q[k * count + p].abs());
                        (push * coefficient * own.stroke[p]).abs() / (rtol * travel)
                    });
                    let kick = kicks.filter(|kick| kick.is_finite()).fold(0.0, f64::max);
                    if kick > 0.0 {
                        longest = longest.min(kick.recip().powf((2.0 - order).recip()));
                    }
                }
            });
        }
        longest
    }
}
