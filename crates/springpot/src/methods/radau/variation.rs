//! What parameters change over a step of Radau IIA: the step with its size frozen, differentiated.
//!
//! Q_i = q + c_i h v + h² Σ_j (A²)_ij a_j and V_i = v + h Σ_j A_ij a_j are linear, and so are their changes. Those of the accelerations solve the
//! linearised equations of motion of all stages at once, with the slopes at the stages themselves: J δa = −ρ, ρ what is unbalanced where the
//! accelerations stay. Joints that turn freely are not linear in that; what J does not know of them is left over, and taken up by the same J again.

use super::estimate::raw;
use super::step::{EstimateScratch, RadauStep};
use crate::collocation::radau::{A, A_SQUARED, ESTIMATE, GAMMA};
use crate::collocation::{RADAU_NODES, STAGES, TABLEAU, integrals};
use crate::equations::{
    Equations, Found, Node, NodeVariation, Origin, ROW, Recording, StepErrors, TANGENTS, Variation,
};
use crate::linalg::Lu;
use crate::linalg::columns::{add, put};
use crate::model::{FreeTurn, Turned, add_turned};

/// A joint that turns freely over a step: how its turns at the stages answer to its velocities there.
#[derive(Debug)]
pub(super) struct TurnedStages {
    /// In the run, and its first velocity in the extended robot.
    free: FreeTurn,
    first: usize,
    /// Of the rates ξ' by v and by ξ, stage by stage.
    rates: [[Turned; 2]; STAGES],
    /// Of what the steps to the stages carry along, and by ξ.
    steps: [[Turned; 2]; STAGES],
    /// Of 1 − h A ∂ξ'/∂ξ.
    lu: Lu,
    /// What changes of ξ' at the stages, in blocks.
    rate_changes: [Vec<f64>; STAGES],
}

impl TurnedStages {
    /// What changes of the turns where velocities change as the stages have it.
    fn place(&mut self, variation: &mut Variation, h: f64) {
        let (count, d) = (variation.count(), self.free.count());
        let own = self.first * count..(self.first + d) * count;
        // ξ'_j = J⁻¹ δv_j + B_j δξ_j, δξ_i = h Σ A_ij ξ'_j.
        let mut by_velocity = vec![vec![0.0; d * count]; STAGES];
        for (j, sum) in by_velocity.iter_mut().enumerate() {
            add_turned(sum, &self.rates[j][0], &variation.nodes[j + 1].v[own.clone()], count);
        }
        let mut xi = vec![0.0; STAGES * d * count];
        for (i, xi) in xi.chunks_exact_mut((d * count).max(1)).enumerate() {
            for (j, sum) in by_velocity.iter().enumerate() {
                xi.iter_mut().zip(sum).for_each(|(xi, sum)| *xi += h * A[i][j] * sum);
            }
        }
        self.lu.solve_rows(&mut xi, count);
        let [start, stages @ .., _] = &mut variation.nodes;
        for (i, xi) in xi.chunks_exact((d * count).max(1)).enumerate() {
            let rate = &mut self.rate_changes[i];
            rate.clone_from(&by_velocity[i]);
            add_turned(rate, &self.rates[i][1], xi, count);
            let q = &mut stages[i].q[own.clone()];
            q.fill(0.0);
            add_turned(q, &self.steps[i][0], &start.q[own.clone()], count);
            add_turned(q, &self.steps[i][1], xi, count);
        }
    }
}

impl RadauStep {
    /// Looks at the joints that turn freely in the step that was solved, of size `h`.
    fn look_at_turns(&mut self, equations: &Equations, variation: &Variation, h: f64) -> bool {
        self.turned.clear();
        let (model, free) = (&self.model, equations.free());
        for turn in model.free_turns().filter(|turn| free.contains(&turn.velocities.start)) {
            let (d, first) = (turn.count(), variation.of_run(&[turn.velocities.start])[0]);
            let rates = self.stages.each_ref().map(|stage| turn.rate_slopes(&stage.xi, &stage.v));
            let steps = self.stages.each_ref().map(|stage| turn.step_slopes(&stage.xi));
            let mut lu = Lu::default();
            let regular = lu.factor(STAGES * d, |matrix| {
                for (r, line) in matrix.chunks_exact_mut(STAGES * d).enumerate() {
                    for (c, entry) in line.iter_mut().enumerate() {
                        *entry = f64::from(u8::from(r == c)) - h * A[r / d][c / d] * rates[c / d][1][r % d][c % d];
                    }
                }
            });
            if !regular {
                return false;
            }
            self.turned.push(TurnedStages { free: turn, first, rates, steps, lu, rate_changes: Default::default() });
        }
        true
    }

    /// Sees the stages of the step that was solved, of size `h`, where signals at its end are those at `t_end`.
    fn see_stages(&self, equations: &Equations, variation: &mut Variation, h: f64, t_end: f64) {
        let elements = variation.elements.len();
        let mut force = vec![0.0; STAGES * elements];
        for (place, force) in force.iter_mut().enumerate() {
            *force = variation.response(equations, place % elements).force[place / elements];
        }
        let times = [self.origin.t + RADAU_NODES[0] * h, self.origin.t + RADAU_NODES[1] * h, t_end];
        variation.see_stages(equations, std::array::from_fn(|i| self.stages[i].node(times[i])), &force);
        for i in 0..STAGES {
            variation.steer(i + 1, equations, &force[i * elements..(i + 1) * elements]);
        }
    }

    /// Keeps what it takes to go back through the step, as [`Self::vary`] has it.
    pub(super) fn keep(
        &self,
        equations: &Equations,
        (variation, recording): (&mut Variation, &Recording),
        h: f64,
        t_end: f64,
    ) -> bool {
        let times = [self.origin.t, self.origin.t + RADAU_NODES[0] * h, self.origin.t + RADAU_NODES[1] * h, t_end];
        let Origin { q, v, a, .. } = &self.origin;
        let nodes = std::array::from_fn(|i| match i {
            0 => Node { t: times[0], q, v, a },
            _ => self.stages[i - 1].node(times[i]),
        });
        let fill = |variation: &Variation, stages: &[NodeVariation], matrix: &mut [f64]| {
            self.fill_matrix(equations, (variation, stages), (equations.free(), h), matrix);
        };
        recording.keep_step(variation, equations, (h, nodes), fill)
    }

    /// Works out what changes over the step that was solved, of size `h`, where signals at its end are those at `t_end`; false where nothing does
    /// so in one way.
    pub(super) fn vary(&mut self, equations: &Equations, variation: &mut Variation, h: f64, t_end: f64) -> bool {
        variation.catch_up(equations);
        variation.share_forces(equations);
        let free = variation.of_run(equations.free());
        self.see_stages(equations, variation, h, t_end);
        if !self.model.is_one_degree() && !self.look_at_turns(equations, variation, h) {
            return false;
        }
        variation.pass(equations, |variation, again| self.vary_once(equations, variation, &free, (h, again)))
    }

    /// Works out what changes at the stages; where asked `again`, under what changes of the forces that is known.
    fn vary_once(
        &mut self,
        equations: &Equations,
        variation: &mut Variation,
        free: &[usize],
        (h, again): (f64, bool),
    ) -> bool {
        variation.rest_stages();
        self.place_variation(variation, free, (h, false));
        variation.follow(equations);
        if !again {
            variation.ask(equations);
        }
        if free.is_empty() {
            return true;
        }
        let mut found = Found::new(variation.count());
        loop {
            if !self.solve_variation(equations, variation, (free, h), &mut found) {
                return false;
            }
            self.place_variation(variation, free, (h, true));
            variation.follow(equations);
            // Where all is linear it is found at once.
            if self.turned.is_empty() || found.is_all() {
                return true;
            }
        }
    }

    /// What changes at the stages under what changes of the accelerations there, or under none.
    fn place_variation(&mut self, variation: &mut Variation, free: &[usize], (h, moves): (f64, bool)) {
        let count = variation.count();
        if free.len() < variation.own_v().len() {
            (1..=STAGES).for_each(|i| variation.take_motion(i));
        }
        let [start, stages @ .., _] = &mut variation.nodes;
        place(start, stages, free, (h, moves, count));
        for turned in &mut self.turned {
            turned.place(variation, h);
        }
    }

    /// The estimate of the step's error of the parameter whose changes it knows least, in units of its tolerance; the step was varied and estimated.
    ///
    /// The embedded formula of the state, for changes, through the same filter.
    pub(super) fn estimate_variation(&mut self, equations: &Equations, variation: &Variation, h: f64) -> f64 {
        let (count, free, step) = (variation.count(), variation.of_run(equations.free()), h * GAMMA);
        let (n, own, mass) = (self.model.nv(), equations.free(), &equations.slopes().d_a);
        if free.is_empty() || count == 0 {
            return 0.0;
        }
        let [start, stages @ .., _] = &variation.nodes;
        let EstimateScratch { changes: [speeds, places, errors], stiffness, is_factored, .. } = &mut self.scratch;
        [&mut *speeds, places].into_iter().for_each(|blocks| blocks.resize(free.len() * count, 0.0));
        for (r, &k) in free.iter().enumerate() {
            let block = k * count..(k + 1) * count;
            let at = [start, &stages[0], &stages[1], &stages[2]];
            let mut rates = at.map(|node| &node.v[block.clone()]);
            if let Some((of_turn, first)) = rates_of_turn(&self.turned, k) {
                let own = (k - first) * count..(k - first + 1) * count;
                rates[1..].iter_mut().zip(of_turn).for_each(|(rates, turn)| *rates = &turn[own.clone()]);
            }
            let weights = [GAMMA, ESTIMATE[0], ESTIMATE[1], ESTIMATE[2]].map(|weight| h * weight);
            let own = r * count..(r + 1) * count;
            put(&mut places[own.clone()], weights, rates);
            if variation.is_singular() {
                for (p, speed) in speeds[own].iter_mut().enumerate() {
                    let [first, nodes @ ..] = [0, 1, 2, 3].map(|i| variation.regular(i, k, p));
                    *speed = raw(h, first, nodes);
                }
            } else {
                put(&mut speeds[own], weights, at.map(|node| &node.a[block.clone()]));
            }
        }
        // M r_v − h γ_0 K r_q.
        errors.clear();
        errors.resize(free.len() * count, 0.0);
        for (r, error) in errors.chunks_exact_mut(count).enumerate() {
            for (c, (speed, place)) in speeds.chunks_exact(count).zip(places.chunks_exact(count)).enumerate() {
                let (mass, stiffness) = (mass[own[r] * n + own[c]], step * stiffness[r * free.len() + c]);
                add(error, [mass, -stiffness], [speed, place]);
            }
        }
        match is_factored {
            true => self.system.filter(errors, count),
            false => self.filter.solve_rows(errors, count),
        }
        places.iter_mut().zip(&*errors).for_each(|(place, error)| *place += step * error);
        let (rtol, errors) = (TANGENTS * self.errors.tolerance.rtol, [&errors[..], &places[..]]);
        variation.step_error(&free, StepErrors { errors, moved: &self.errors.sized, rtol })
    }

    /// What changes of the motion at θ of the step that was solved, of size `h`, into node [`ROW`].
    pub(super) fn vary_within(&self, variation: &mut Variation, theta: f64, h: f64) {
        let count = variation.count();
        variation.take_start(ROW);
        // Accelerations, and their integrals, as sums over the nodes.
        let of_node = |i: usize| integrals(TABLEAU.rates.map(|line| line[i]), theta);
        let [a, b, c, d] = [0, 1, 2, 3].map(of_node);
        let [value, once, twice] = [0, 1, 2].map(|which| [a, b, c, d].map(|of_node| of_node[which]));
        for k in variation.own_v().to_vec() {
            let own = k * count..(k + 1) * count;
            let singular: Option<[Vec<f64>; 4]> = variation
                .is_singular()
                .then(|| [0, 1, 2, 3].map(|i| (0..count).map(|p| variation.regular(i, k, p)).collect()));
            let [nodes @ .., row] = &mut variation.nodes;
            let at = match &singular {
                Some(at) => at.each_ref().map(Vec::as_slice),
                None => nodes.each_ref().map(|node| &node.a[own.clone()]),
            };
            put(&mut row.a[own.clone()], value, at);
            add(&mut row.q[own.clone()], [h * theta], [&row.v[own.clone()]]);
            add(&mut row.q[own.clone()], twice.map(|share| h * h * share), at);
            add(&mut row.v[own], once.map(|share| h * share), at);
        }
        let mut xi = vec![0.0; self.model.nv()];
        for TurnedStages { free, first, rate_changes, .. } in &self.turned {
            for k in free.velocities.clone() {
                xi[k] = h * integrals(self.fitted.turning.each_ref().map(|u| u[k]), theta)[1];
            }
            let [carried, along] = free.step_slopes(&xi);
            let own = first * count..(first + free.count()) * count;
            let mut change = vec![0.0; own.len()];
            let [start, .., row] = &mut variation.nodes;
            for (at, change) in change.iter_mut().enumerate() {
                let [a, b, c] = rate_changes.each_ref().map(|rates| rates[at]);
                let nodes = [start.v[own.start + at], a, b, c];
                let cubic = TABLEAU.rates.map(|line| line.iter().zip(nodes).map(|(l, rate)| l * rate).sum::<f64>());
                *change = h * integrals(cubic, theta)[1];
            }
            let q = &mut row.q[own.clone()];
            q.fill(0.0);
            add_turned(q, &carried, &start.q[own], count);
            add_turned(q, &along, &change, count);
        }
    }

    /// J Δδa = −ρ: Δδa to the stages of `variation`. J is factored where nothing was found yet.
    fn solve_variation(
        &self,
        equations: &Equations,
        variation: &mut Variation,
        (free, h): (&[usize], f64),
        found: &mut Found,
    ) -> bool {
        let (count, own) = (variation.count(), free.len());
        let size = STAGES * own;
        let mut solve = std::mem::take(&mut variation.room.solve);
        let regular = !found.is_first()
            || solve.factor(size, |matrix| {
                let [_, stages @ .., _] = &variation.nodes;
                self.fill_matrix(equations, (variation, stages), (free, h), matrix);
            });
        if regular {
            let mut right = std::mem::take(&mut variation.room.right);
            right.clear();
            right.resize(size * count, 0.0);
            let mut forces = vec![0.0; variation.elements.len() * count];
            for (i, stage) in right.chunks_exact_mut((own * count).max(1)).enumerate() {
                for (e, force) in forces.chunks_exact_mut(count.max(1)).enumerate() {
                    variation.force(variation.response(equations, e), e, i + 1, force);
                }
                for (sum, &row) in stage.chunks_exact_mut(count.max(1)).zip(free) {
                    variation.add_unbalanced(i + 1, row, sum);
                    variation.add_pulled(i + 1, row, |e| &forces[e * count..][..count], sum);
                }
            }
            solve.solve_rows(&mut right, count);
            found.take(&right, |column| {
                let stages = variation.nodes[1..=STAGES].iter();
                let all = stages.flat_map(|stage| free.iter().map(move |&k| stage.a[k * count + column].abs()));
                all.fold(0.0, f64::max)
            });
            for (i, stage) in right.chunks_exact((own * count).max(1)).enumerate() {
                for (own, &k) in stage.chunks_exact(count.max(1)).zip(free) {
                    found.add(&mut variation.nodes[i + 1].a[k * count..][..count], own);
                }
            }
            found.go_on();
            variation.room.right = right;
        }
        variation.room.solve = solve;
        regular && !found.fails()
    }

    /// J into zeros, where the stages were seen as `stages` have it, of which velocities `free` are.
    pub(super) fn fill_matrix(
        &self,
        equations: &Equations,
        (variation, stages): (&Variation, &[NodeVariation]),
        (free, h): (&[usize], f64),
        matrix: &mut [f64],
    ) {
        let (n, own) = (stages[0].nv(), free.len());
        let size = STAGES * own;
        for (i, lines) in matrix.chunks_exact_mut(own * size).enumerate() {
            let slopes = &stages[i].slopes;
            for (line, &row) in lines.chunks_exact_mut(size).zip(free) {
                let [by_q, by_v, by_a] = [&slopes.d_q, &slopes.d_v, &slopes.d_a].map(|by| &by[row * n..(row + 1) * n]);
                for (c, &column) in free.iter().enumerate() {
                    for j in 0..STAGES {
                        line[j * own + c] = h * A[i][j] * by_v[column] + h * h * A_SQUARED[i][j] * by_q[column];
                    }
                    line[i * own + c] += by_a[column];
                }
            }
        }
        // What changes of an element's strokes, rates and forces by the accelerations of all stages.
        let (mut strokes, mut rates, mut force) = (vec![0.0; STAGES * size], vec![0.0; STAGES * size], vec![0.0; size]);
        for e in 0..variation.elements.len() {
            let response = variation.response(equations, e);
            let slopes = [0, 1, 2].map(|m| &stages[m].gradients[e]);
            for (m, [g, y]) in slopes.iter().enumerate() {
                for j in 0..STAGES {
                    let (twice, once, from) = (h * h * A_SQUARED[m][j], h * A[m][j], m * size + j * own);
                    let blocks = strokes[from..from + own].iter_mut().zip(&mut rates[from..from + own]);
                    for ((stroke, rate), &column) in blocks.zip(free) {
                        (*stroke, *rate) = (twice * g[column], twice * y[column] + once * g[column]);
                    }
                }
            }
            let [moved, carried] = [&strokes, &rates].map(|rows| [0, 1, 2].map(|m| &rows[m * size..(m + 1) * size]));
            for (i, lines) in matrix.chunks_exact_mut(own * size).enumerate() {
                let ([a, b, c, _], [d, e, f, _]) = (response.d_stroke[i], response.d_rate[i]);
                put(&mut force, [a, b, c], moved);
                add(&mut force, [d, e, f], carried);
                let [on, _] = slopes[i];
                let felt = |row: usize| on[row] != 0.0 && !variation.relieves(i + 1, row);
                for (line, &row) in lines.chunks_exact_mut(size).zip(free).filter(|(_, row)| felt(**row)) {
                    add(line, [on[row]], [&force]);
                }
            }
        }
        for i in 0..STAGES {
            self.answer_to_state(equations, variation, (i, free, h), matrix);
        }
    }

    /// Adds how what follows from the state answers to the accelerations to the lines of stage `i` of the matrix: terms of errors, and inputs.
    fn answer_to_state(
        &self,
        equations: &Equations,
        variation: &Variation,
        (i, free, h): (usize, &[usize], f64),
        matrix: &mut [f64],
    ) {
        let (own, size) = (free.len(), STAGES * free.len());
        let through = |m: usize, j: usize| (h * h * A_SQUARED[m][j], h * A[m][j]);
        for (velocity, response) in equations.term_responses() {
            let row = variation.of_run(&[velocity])[0];
            let Some(r) = free.iter().position(|k| *k == row && !variation.is_held(row)) else { continue };
            for (j, m) in (0..STAGES).flat_map(|j| (0..STAGES).map(move |m| (j, m))) {
                let (twice, once) = through(m, j);
                matrix[(i * own + r) * size + j * own + r] +=
                    response.d_stroke[i][m] * twice + response.d_rate[i][m] * once;
            }
        }
        for m in 0..STAGES {
            for (e, input, [by_q, by_v]) in variation.input_slopes(m + 1) {
                let force = equations.bank.by_input(e, input)[i][m];
                let [on, _] = &variation.nodes[i + 1].gradients[e];
                for (r, &row) in free.iter().enumerate().filter(|(_, row)| !variation.relieves(i + 1, **row)) {
                    for j in 0..STAGES {
                        let (twice, once) = through(m, j);
                        let line = &mut matrix[(i * own + r) * size + j * own..][..own];
                        for (entry, &column) in line.iter_mut().zip(free) {
                            *entry += on[row] * force * (twice * by_q[column] + once * by_v[column]);
                        }
                    }
                }
            }
        }
    }
}

/// What changes of q and v at the stages, block by block.
fn place(
    start: &NodeVariation,
    stages: &mut [NodeVariation; STAGES],
    free: &[usize],
    (h, moves, count): (f64, bool, usize),
) {
    let [first, second, third] = stages;
    for &k in free {
        let block = k * count..(k + 1) * count;
        let (q, rates) = (&start.q[block.clone()], &start.v[block.clone()]);
        let a = [&first.a[block.clone()], &second.a[block.clone()], &third.a[block.clone()]];
        let moved = [(&mut first.v, &mut first.q), (&mut second.v, &mut second.q), (&mut third.v, &mut third.q)];
        for (((to_v, to_q), c), (once, twice)) in moved.into_iter().zip(RADAU_NODES).zip(A.iter().zip(&A_SQUARED)) {
            let (to_v, to_q, along) = (&mut to_v[block.clone()], &mut to_q[block.clone()], c * h);
            if moves {
                let [once, twice] = [once.map(|by| h * by), twice.map(|by| h * h * by)];
                put(to_v, [1.0, once[0], once[1], once[2]], [rates, a[0], a[1], a[2]]);
                put(to_q, [1.0, along, twice[0], twice[1], twice[2]], [q, rates, a[0], a[1], a[2]]);
            } else {
                to_v.copy_from_slice(rates);
                put(to_q, [1.0, along], [q, rates]);
            }
        }
    }
}

/// What changes of ξ' at the stages, of the joint that turns freely and has velocity `k` of the extended robot, and the first of its velocities.
fn rates_of_turn(turned: &[TurnedStages], k: usize) -> Option<(&[Vec<f64>; STAGES], usize)> {
    let own = |turned: &&TurnedStages| (turned.first..turned.first + turned.free.count()).contains(&k);
    turned.iter().find(own).map(|turned| (&turned.rate_changes, turned.first))
}
