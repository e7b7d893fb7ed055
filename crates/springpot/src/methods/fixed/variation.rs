//! What parameters change over a step of one size: the step that was taken, differentiated.
//!
//! With κ = c h the stage is at q_0 + κ v and v = v_0 + κ a, and so are their changes; those of a solve the linearised equations of motion there,
//! (M + κ D + κ² K) δa = −ρ, the answers of the elements among K and D, ρ what is unbalanced where a stays. The iterations of the step have found its
//! solution as far as they go; the derivative is that of the solution. Joints that turn freely are not linear in that: what the matrix does not know of
//! them is left over, and taken up by the same matrix again.

use super::step::OneStage;
use crate::collocation::STAGES;
use crate::equations::{Equations, Found, Node, STAGE, Told, Variation};
use crate::model::{FreeTurn, Turned, add_turned};
use crate::system::fixed_step::Method;

/// What the last iteration may still change of the velocities, as a share of what the step changes of them and of a millionth of themselves: what it
/// leaves of derivatives is the power 3/2 of it.
const FOUND: f64 = 1e-4;
const BESIDE: f64 = 1e-6;

/// A joint that turns freely: its first velocity in the extended robot, and how the steps to the stage and to the end answer.
struct TurnedStep {
    first: usize,
    count: usize,
    steps: [[Turned; 2]; 2],
}

impl OneStage {
    /// Works out what changes over the step of size `h` that was solved, where the bank is still told the stage; false where nothing does so in one way.
    pub(super) fn vary(&self, equations: &Equations, variation: &mut Variation, h: f64) -> bool {
        let elements = 0..equations.bank.len();
        let force: Vec<f64> = elements.map(|e| variation.response(equations, e).force[0]).collect();
        let [stage, end] = [&self.stage, &self.end].map(|at| Node { t: at.t, q: &at.q, v: &at.v, a: &self.a });
        let mut sliding = vec![0.0; self.model.nv()];
        for (candidate, direction) in self.coulomb.candidates.iter().zip(&self.coulomb.directions) {
            sliding[self.free[candidate.place]] = f64::from(*direction);
        }
        variation.see_stage(equations, [stage, end], &force, sliding.into_iter());
        variation.pass(equations, |variation, again| self.vary_once(equations, variation, (h, again)))
    }

    /// Whether the iterations of the step came to its solution, as they do but where smooth friction is steeper than the step.
    pub(super) fn is_found(&self) -> bool {
        let kappa = self.method.node();
        let sizes = self.free.iter().map(|&k| {
            let [from, to] = [self.origin.v[k], self.end.v[k]];
            kappa * (to - from).abs() + BESIDE * from.abs().max(to.abs())
        });
        self.correction <= FOUND * sizes.fold(f64::MIN_POSITIVE, f64::max)
    }

    fn told(&self) -> Told {
        match self.method {
            Method::BackwardEuler => Told::End,
            Method::Midpoint => Told::Mean,
        }
    }

    /// Works out what changes at the stage and at the end; where asked `again`, under what changes of the forces that is known.
    fn vary_once(&self, equations: &Equations, variation: &mut Variation, (h, again): (f64, bool)) -> bool {
        let (kappa, free) = (self.method.node() * h, variation.of_run(&self.free));
        let turns = self.turns(variation, [kappa, h]);
        for i in [STAGE, STAGES] {
            variation.take_start(i);
            variation.nodes[i].a.fill(0.0);
        }
        self.place_variation(variation, &free, &turns, h);
        if !again {
            variation.ask(equations);
        }
        if free.is_empty() {
            return true;
        }
        let mut found = Found::new(variation.count());
        loop {
            if !self.solve_variation(equations, variation, (&free, kappa, h), &mut found) {
                return false;
            }
            self.place_variation(variation, &free, &turns, h);
            // Where all is linear it is found at once.
            if turns.is_empty() || found.is_all() {
                return true;
            }
        }
    }

    /// The joints that turn freely, by h v of the stage over these times.
    fn turns(&self, variation: &Variation, times: [f64; 2]) -> Vec<TurnedStep> {
        let free = self.model.free_turns().filter(|turn| self.free.contains(&turn.velocities.start));
        let turned = |turn: FreeTurn| {
            let steps = times.map(|time| {
                let xi: Vec<f64> = self.stage.v.iter().map(|v| time * v).collect();
                turn.step_slopes(&xi)
            });
            TurnedStep { first: variation.of_run(&[turn.velocities.start])[0], count: turn.count(), steps }
        };
        free.map(turned).collect()
    }

    /// What changes at the stage and at the end under what changes of the accelerations.
    fn place_variation(&self, variation: &mut Variation, free: &[usize], turns: &[TurnedStep], h: f64) {
        let (count, kappa) = (variation.count(), self.method.node() * h);
        let [start, stage, .., end, _] = &mut variation.nodes;
        for block in free.iter().flat_map(|&k| k * count..(k + 1) * count) {
            let a = stage.a[block];
            stage.v[block] = start.v[block] + kappa * a;
            end.v[block] = start.v[block] + h * a;
            stage.q[block] = start.q[block] + kappa * stage.v[block];
            end.q[block] = start.q[block] + h * stage.v[block];
            end.a[block] = a;
        }
        for TurnedStep { first, count: d, steps } in turns {
            let own = first * count..(first + d) * count;
            let speeds = stage.v[own.clone()].to_vec();
            for ((q, [carried, along]), time) in [&mut stage.q, &mut end.q].into_iter().zip(steps).zip([kappa, h]) {
                let q = &mut q[own.clone()];
                q.fill(0.0);
                add_turned(q, carried, &start.q[own.clone()], count);
                let turned: Vec<f64> = speeds.iter().map(|speed| time * speed).collect();
                add_turned(q, along, &turned, count);
            }
        }
        variation.tell_stage(self.told(), h);
    }

    /// What changes of the motion at θ of the step of size `h` that ends at the end of this one, of joints that turn freely.
    pub(super) fn turn_between(&self, variation: &mut Variation, theta: f64, h: f64) {
        let (model, rest) = (&self.model, 1.0 - theta);
        let mut xi = vec![0.0; model.nv()];
        let (count, mut rate) = (variation.count(), xi.clone());
        model.difference_into(&self.origin.q, &self.end.q, &mut xi);
        model.tangent_rate_into(&xi, &self.end.v, &mut rate);
        for turn in model.free_turns().filter(|turn| self.free.contains(&turn.velocities.start)) {
            let first = variation.of_run(&[turn.velocities.start])[0];
            let own = first * count..(first + turn.count()) * count;
            // As rows have it: a cubic through ξ and ξ' at both ends.
            let [a, b, c] = [theta * rest * rest * h, theta * theta * rest * h, theta * theta * (3.0 - 2.0 * theta)];
            let mut at = vec![0.0; model.nv()];
            for k in turn.velocities.clone() {
                at[k] = a * self.origin.v[k] - b * rate[k] + c * xi[k];
            }
            let [by_velocity, by_turn] = turn.rate_slopes(&xi, &self.end.v);
            let [start, stage, .., end, row] = &mut variation.nodes;
            let travel: Vec<f64> = stage.v[own.clone()].iter().map(|v| h * v).collect();
            let mut rates = vec![0.0; travel.len()];
            add_turned(&mut rates, &by_velocity, &end.v[own.clone()], count);
            add_turned(&mut rates, &by_turn, &travel, count);
            let begun = start.v[own.clone()].iter().zip(&rates).zip(&travel);
            let change: Vec<f64> = begun.map(|((v, rate), travel)| a * v - b * rate + c * travel).collect();
            let [carried, along] = turn.step_slopes(&at);
            let q = &mut row.q[own.clone()];
            q.fill(0.0);
            add_turned(q, &carried, &start.q[own], count);
            add_turned(q, &along, &change, count);
        }
    }

    /// (M + κ D + κ² K) Δδa = −ρ: Δδa to the stage of `variation`. What is held comes to rest at the end.
    fn solve_variation(
        &self,
        equations: &Equations,
        variation: &mut Variation,
        (free, kappa, h): (&[usize], f64, f64),
        found: &mut Found,
    ) -> bool {
        let (n, count, own) = (variation.nv(), variation.count(), free.len());
        let held: Vec<bool> = self.free.iter().map(|&k| self.held[k]).collect();
        let mut solve = std::mem::take(&mut variation.room.solve);
        let [_, stage, .., end, _] = &variation.nodes;
        let regular = !found.is_first()
            || solve.factor(own, |matrix| {
                for (line, &row) in matrix.chunks_exact_mut(own).zip(free) {
                    for (entry, &column) in line.iter_mut().zip(free) {
                        let at = row * n + column;
                        *entry = stage.slopes.d_a[at] + kappa * (stage.slopes.d_v[at] + kappa * stage.slopes.d_q[at]);
                    }
                }
                for e in 0..equations.bank.len() {
                    let response = variation.response(equations, e);
                    let (stroke, rate) = (response.d_stroke[0][0], response.d_rate[0][0]);
                    let [on, bend] = &stage.gradients[e];
                    let along = |column: usize| match self.told() {
                        Told::End => kappa * ((kappa * stroke + rate) * on[column] + kappa * rate * bend[column]),
                        Told::Mean => kappa * (kappa * stroke + rate) * end.gradients[e][0][column],
                    };
                    for (line, &row) in matrix.chunks_exact_mut(own).zip(free) {
                        line.iter_mut().zip(free).for_each(|(entry, &column)| *entry += on[row] * along(column));
                    }
                }
                for r in (0..own).filter(|r| held[*r]) {
                    let line = &mut matrix[r * own..(r + 1) * own];
                    line.fill(0.0);
                    line[r] = 1.0;
                }
            });
        if regular {
            let mut right = std::mem::take(&mut variation.room.right);
            right.clear();
            right.resize(own * count, 0.0);
            let mut forces = vec![0.0; equations.bank.len() * count];
            for (e, force) in forces.chunks_exact_mut(count.max(1)).enumerate() {
                variation.stage_force(variation.response(equations, e), e, force);
            }
            for ((sum, &row), held) in right.chunks_exact_mut(count.max(1)).zip(free).zip(&held) {
                if *held {
                    let own = row * count..(row + 1) * count;
                    let (start, a) = (&variation.nodes[0].v[own.clone()], &variation.nodes[STAGE].a[own]);
                    sum.iter_mut().zip(start.iter().zip(a)).for_each(|(sum, (v, a))| *sum = v / h + a);
                    continue;
                }
                variation.add_unbalanced(STAGE, row, sum);
                variation.add_pulled(STAGE, row, |e| &forces[e * count..][..count], sum);
            }
            solve.solve_rows(&mut right, count);
            let a = &mut variation.nodes[STAGE].a;
            found.take(&right, |column| free.iter().fold(0.0, |most, &k| f64::max(most, a[k * count + column].abs())));
            for (own, &k) in right.chunks_exact(count.max(1)).zip(free) {
                found.add(&mut a[k * count..][..count], own);
            }
            found.go_on();
            variation.room.right = right;
        }
        variation.room.solve = solve;
        regular && !found.fails()
    }
}
