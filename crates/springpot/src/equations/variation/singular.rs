//! Singular shares of what parameters change.
//!
//! A force that is infinite at t = 0 has the share s·F of the accelerations, s = −M⁻¹ g at the start of a step. What is left has no jump: the
//! cubic through it tells rows, and the embedded formula the error. So of changes: δ(s F) = s δF + δs F with
//!
//! δs = −M⁻¹ (δg + δM s), δM s = ∂(M s)/∂q δq + ∂M/∂θ s.
//!
//! Changes of x(0) are singular also where the run itself is not, x(0) being 0.

use super::{ElementVariation, ROW, Room, Variation, of_step};
use crate::collocation::STAGES;
use crate::dynamics::{Kinematics, RneaDerivatives, rnea_at_into};
use crate::elements::Forces;
use crate::equations::assembly::{Equations, singular_parts};
use crate::law::{Point, Term};
use crate::observe::Snapshot;
use crate::system::sensitivity::Seed;
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
    is_there: bool,
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

    /// Every block that outlasts a step.
    pub(super) fn each_block(&mut self, count: usize, take: &mut dyn FnMut(&mut [f64])) {
        for own in self.elements.iter_mut().filter(|_| self.is_there) {
            take(&mut own.force_change[..count]);
        }
    }

    pub(super) fn save(&self, count: usize) -> SingularState {
        let before = |own: &Share| (own.force[0], own.force_change[..count].to_vec());
        SingularState {
            is_there: self.is_there,
            starts_regular: self.starts_regular,
            before: self.elements.iter().map(before).collect(),
        }
    }

    pub(super) fn load(&mut self, state: SingularState, count: usize) -> bool {
        if state.before.len() != self.elements.len() || state.before.iter().any(|(_, own)| own.len() != count) {
            return false;
        }
        (self.is_there, self.starts_regular) = (state.is_there, state.starts_regular);
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
        let regular = {
            let Self { nodes: [start, ..], room: Room { solve, .. }, .. } = self;
            !free.is_empty() && solve.factor_part(&start.slopes.d_a, n, &free)
        };
        let mut right = Vec::new();
        for e in 0..self.elements.len() {
            let mut own = std::mem::take(&mut self.singular.elements[e]);
            own.of_force.fill(0.0);
            own.change.fill(0.0);
            if regular {
                right.clear();
                right.extend(free.iter().map(|&k| -self.nodes[0].gradients[e][0][k]));
                self.room.solve.solve(&mut right);
                free.iter().zip(&right).for_each(|(&k, x)| own.of_force[k] = *x);
                let mut owed = self.change_of_mass(&own.of_force);
                let [start, ..] = &self.nodes;
                for (k, owed) in owed.chunks_exact_mut(count.max(1)).enumerate() {
                    for (c, changes) in start.q.chunks_exact(count.max(1)).enumerate() {
                        let bend = start.hessians[e][k * n + c];
                        owed.iter_mut().zip(changes).for_each(|(owed, change)| *owed += bend * change);
                    }
                }
                self.solve_free(&free, &owed, &mut own.change);
            }
            self.singular.elements[e] = own;
        }
    }

    /// δM a where the step starts, velocity by velocity in blocks: ∂(M a)/∂q δq + ∂M/∂θ a.
    pub(super) fn change_of_mass(&mut self, a: &[f64]) -> Vec<f64> {
        let (count, n) = (self.count(), self.nv());
        let Self { system, by, nodes: [start, ..], room: Room { workspace, .. }, .. } = self;
        let (model, tau) = (&system.model, &mut vec![0.0; n]);
        let (mut still, none) = (Kinematics::new(model), vec![0.0; n]);
        still.update_velocity(model, &start.q_now, &none);
        let [mut rest, mut turned] = [RneaDerivatives::new(model), RneaDerivatives::new(model)];
        Forces::default().inverse_dynamics_derivatives_into(model, &still, &none, workspace, &mut rest);
        Forces::default().inverse_dynamics_derivatives_into(model, &still, a, workspace, &mut turned);
        let mut sum = vec![0.0; n * count];
        for (k, sum) in sum.chunks_exact_mut(count.max(1)).enumerate() {
            for (c, changes) in start.q.chunks_exact(count.max(1)).enumerate() {
                let by_place = turned.d_q[k * n + c] - rest.d_q[k * n + c];
                sum.iter_mut().zip(changes).for_each(|(sum, change)| *sum += by_place * change);
            }
        }
        for (p, parameter) in by.parameters.iter().enumerate() {
            for seed in &parameter.seeds {
                if let Seed::Inertia(inertia) = seed {
                    let mut add = |a: &[f64], sign: f64| {
                        rnea_at_into(inertia, &still, &start.q_now, a, &[], workspace, tau);
                        tau.iter().enumerate().for_each(|(k, tau)| sum[k * count + p] += sign * tau);
                    };
                    add(a, 1.0);
                    add(&none, -1.0);
                }
            }
        }
        sum
    }

    /// Writes −M⁻¹ of the blocks `owed`, over the velocities `free`, whose part of M is factored, to `out`.
    pub(super) fn solve_free(&mut self, free: &[usize], owed: &[f64], out: &mut [f64]) {
        let count = self.count();
        let mut right: Vec<f64> = free.iter().flat_map(|&k| &owed[k * count..(k + 1) * count]).map(|x| -x).collect();
        self.room.solve.solve_rows(&mut right, count);
        for (own, &k) in right.chunks_exact(count.max(1)).zip(free) {
            out[k * count..(k + 1) * count].copy_from_slice(own);
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
        let is_apart = theta.is_some() || self.singular.starts_regular;
        if !self.singular.is_there || !is_apart || self.one_size.is_some() {
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
            let changes = self.singular_at(equations, (e, ROW), from, &point);
            let Share { of_force, change, .. } = &self.singular.elements[e];
            let row = &mut self.nodes[ROW];
            for (k, share) in of_force.iter().enumerate() {
                let turns_by_itself = self.system.model.coordinate_of(k).is_some();
                for p in 0..count {
                    let block = k * count + p;
                    let [value, once, twice] =
                        [0, 1, 2].map(|order| share * changes[order][p] + change[block] * force[order]);
                    row.a[block] += value;
                    if theta.is_some() {
                        row.v[block] += once;
                        // Of joints that turn freely the turn follows from their velocities.
                        if turns_by_itself {
                            row.q[block] += twice;
                        }
                    }
                }
            }
        }
    }

    /// What changes of the singular forces of element `e` at node `i`, where it is told `at`, and of their integrals since `from`.
    pub(super) fn singular_at(
        &self,
        equations: &Equations,
        (e, i): (usize, usize),
        from: f64,
        at: &Point,
    ) -> [Vec<f64>; 3] {
        let mut sums = [(); 3].map(|()| vec![0.0; self.count()]);
        let own = &self.elements[e];
        let [value, once, twice] = &mut sums;
        equations.bank.vary_singularity(
            e,
            (from, at),
            &own.told(self.count(), i, None),
            &own.law,
            [value, once, twice],
        );
        sums
    }

    /// Takes in where elements start.
    pub(super) fn begin_singular(&mut self, equations: &Equations) {
        let count = self.count();
        for (e, (own, element)) in self.singular.elements.iter_mut().zip(&self.elements).enumerate() {
            own.stroke = equations.bank.point(e, 0).stroke;
            own.stroke_change.copy_from_slice(&element.stroke[..count]);
        }
        if self.one_size.is_some() {
            self.singular.is_there = self.elements.iter().any(|element| element.law.is_singular());
            self.singular.is_there |= (0..self.elements.len()).any(|e| equations.bank.is_singular(e));
            return;
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
