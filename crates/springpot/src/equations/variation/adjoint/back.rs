//! Back over what was kept.
//!
//! With q̄ = ∂m/∂q and so on, in front of a step of stages Q_i, V_i, a_i and of matrix J (J δa = −ρ):
//!
//! ā_j += Σ_i h² (A²)_ij Q̄_i + h A_ij V̄_i, Jᵀ μ = ā, ρ̄ = −μ; then Q̄°_i = −K_iᵀ μ_i + …, q̄ = Σ Q̄_i + Q̄°_i, v̄ = Σ V̄_i + V̄°_i + c_i h (Q̄_i + Q̄°_i).

use super::tape::{Entry, KEPT, Layout, Row, RowOfElement, Slopes, Start, Step, StepOfElement};
use super::{Share, Tape};
use crate::collocation::radau::{A, A_SQUARED};
use crate::collocation::{RADAU_NODES, STAGES, TABLEAU, integrals};
use crate::equations::solve::Solve;
use crate::fractional::{MemoryAdjoint, PastOfStep};
use crate::law::variation::add;
use crate::law::variation::probe::{RATE, STROKE};

/// Columns of a row of a law.
const AT_ROW: [usize; 2] = [STROKE[STAGES + 1], RATE[STAGES + 1]];

/// ∂m/∂ all that is known where a step starts, for M numbers m side by side.
struct Front<'t> {
    tape: &'t Tape,
    /// M.
    count: usize,
    /// By q, v and a.
    motion: [Vec<f64>; 3],
    laws: Vec<Law>,
    /// By parameters.
    sum: Vec<f64>,
    solve: Solve,
}

/// By what an element knows.
struct Law {
    stroke: Vec<f64>,
    rate: Vec<f64>,
    memories: Vec<MemoryAdjoint>,
    variables: Vec<f64>,
}

/// One node of a step.
struct Stage {
    motion: [Vec<f64>; 3],
    /// Strokes and rates of the elements.
    strokes: Vec<Vec<f64>>,
    rates: Vec<Vec<f64>>,
}

impl Tape {
    /// The derivatives of numbers by all parameters: of each number its own, where it changes by its `shares` of rows.
    pub fn gradients(&self, shares: &[Vec<Share>]) -> Vec<Vec<f64>> {
        let count = shares.len();
        if count == 0 {
            return Vec::new();
        }
        let mut seeds: Vec<(usize, usize, usize, f64)> = Vec::new();
        for (m, own) in shares.iter().enumerate() {
            seeds.extend(own.iter().map(|share| (share.row, share.quantity, m, share.slope)));
        }
        seeds.sort_by_key(|(row, ..)| *row);
        let law = |layout: &Layout| Law {
            stroke: vec![0.0; count],
            rate: vec![0.0; count],
            memories: layout.ports.iter().map(|_| MemoryAdjoint::new(count)).collect(),
            variables: vec![0.0; layout.variables.len() * count],
        };
        let mut front = Front {
            tape: self,
            count,
            motion: [(); 3].map(|()| vec![0.0; self.nv * count]),
            laws: self.layouts.iter().map(law).collect(),
            sum: vec![0.0; self.count * count],
            solve: Solve::default(),
        };
        for entry in self.entries.backwards() {
            match entry {
                Entry::Row(row) => front.row(row, &seeds),
                Entry::Start(start) => front.start(start),
                Entry::Step(step) => front.step(step, &seeds),
            }
        }
        front.begin();
        (0..count).map(|m| (0..self.count).map(|p| front.sum[p * count + m]).collect()).collect()
    }
}

impl Front<'_> {
    /// What counts of the quantities of a row; `None` where nothing does.
    fn told(&self, row: &Row, seeds: &[(usize, usize, usize, f64)]) -> Option<Vec<f64>> {
        let count = self.count;
        let own = &seeds[seeds.partition_point(|(at, ..)| *at < row.number)..];
        let own = &own[..own.partition_point(|(at, ..)| *at == row.number)];
        if own.is_empty() {
            return None;
        }
        let mut by = vec![0.0; self.tape.quantities * count];
        own.iter().for_each(|(_, quantity, m, slope)| by[quantity * count + m] += slope);
        let width = 3 * (self.tape.nv + self.laws.len()) + self.tape.count;
        let mut to = vec![0.0; width * count];
        row.quantities.add_transposed(1.0, &by, &mut to, count);
        Some(to)
    }

    /// Shares out what counts of a row: what counts of its q, v and a, and by element of the columns of its law.
    fn share(&mut self, row: &Row, told: &[f64]) -> ([Vec<f64>; 3], Vec<Vec<f64>>) {
        let (count, nv, elements) = (self.count, self.tape.nv, self.laws.len());
        let mut motion = [0, 1, 2].map(|place| told[place * nv * count..(place + 1) * nv * count].to_vec());
        add(&mut self.sum, 1.0, &told[3 * (nv + elements) * count..]);
        let mut columns = Vec::new();
        for (e, RowOfElement { gradients, map, .. }) in row.elements.iter().enumerate() {
            let own = &told[3 * (nv + e) * count..3 * (nv + e + 1) * count];
            let mut by = vec![0.0; self.tape.layouts[e].columns * count];
            if own.iter().any(|own| *own != 0.0) {
                map.add_transposed(1.0, own, &mut by, count);
                let [stroke, rate] = AT_ROW.map(|column| by[column * count..(column + 1) * count].to_vec());
                self.measure(e, gradients, [&stroke, &rate], &mut motion);
            }
            columns.push(by);
        }
        (motion, columns)
    }

    /// Stroke and rate of element `e` count so much: so do q and v, and its rest.
    fn measure(
        &mut self,
        e: usize,
        [gradient, bend]: &[Vec<f64>; 2],
        [stroke, rate]: [&[f64]; 2],
        motion: &mut [Vec<f64>; 3],
    ) {
        let count = self.count;
        if stroke.iter().chain(rate).all(|by| *by == 0.0) {
            return;
        }
        let [q, v, _] = motion;
        for (k, (g, y)) in gradient.iter().zip(bend).enumerate() {
            let own = k * count..(k + 1) * count;
            add(&mut q[own.clone()], *g, stroke);
            add(&mut q[own.clone()], *y, rate);
            add(&mut v[own], *g, rate);
        }
        for (_, p, by) in self.tape.rests.iter().filter(|(own, ..)| *own == e) {
            add(&mut self.sum[p * count..(p + 1) * count], *by, stroke);
        }
    }

    /// The columns of the law of element `e` count so much, but for lags, nodes and rows.
    fn settle(&mut self, e: usize, columns: &[f64]) {
        let (count, layout, law) = (self.count, &self.tape.layouts[e], &mut self.laws[e]);
        let of = |column: usize| &columns[column * count..(column + 1) * count];
        add(&mut law.stroke, 1.0, of(STROKE[0]));
        add(&mut law.rate, 1.0, of(RATE[0]));
        for (block, column) in law.variables.chunks_exact_mut(count).zip(&layout.variables) {
            add(block, 1.0, of(*column));
        }
        for (memory, port) in law.memories.iter_mut().zip(&layout.ports) {
            add(&mut memory.travelled, 1.0, of(port.travelled));
            add(&mut memory.now, 1.0, of(port.now));
            add(&mut memory.origin, 1.0, of(port.origin));
        }
        for (column, p) in &layout.parameters {
            add(&mut self.sum[p * count..(p + 1) * count], 1.0, of(*column));
        }
    }

    /// What lags of the memories of element `e` told counts so much.
    fn tell(&mut self, e: usize, columns: &[f64], lags: &[Vec<f64>], pasts: &[Option<PastOfStep>]) {
        let (count, layout, law) = (self.count, &self.tape.layouts[e], &mut self.laws[e]);
        for (((memory, port), lags), past) in law.memories.iter_mut().zip(&layout.ports).zip(lags).zip(pasts) {
            let Some(past) = past else { continue };
            for (k, lag) in lags.iter().enumerate() {
                let column = port.lags[0] + k;
                memory.tell(past, *lag, &columns[column * count..(column + 1) * count]);
            }
        }
    }

    /// Over a row between two steps.
    fn row(&mut self, row: &Row, seeds: &[(usize, usize, usize, f64)]) {
        let Some(told) = self.told(row, seeds) else { return };
        let (motion, columns) = self.share(row, &told);
        self.motion.iter_mut().zip(&motion).for_each(|(to, by)| add(to, 1.0, by));
        columns.iter().enumerate().for_each(|(e, by)| self.settle(e, by));
    }

    /// Solves with a matrix that is kept transposed.
    fn solve(&mut self, matrix: &[f64], right: &mut [f64]) {
        let size = right.len() / self.count;
        if self.solve.factor(size, |to| to.copy_from_slice(matrix)) {
            self.solve.solve_rows(right, self.count);
        } else {
            right.fill(f64::NAN);
        }
    }

    /// Over slopes: −μ counts of what is unbalanced at a node, whose q, v and parameters get their share; gives what counts of the forces of elements.
    fn unbalance(&mut self, slopes: &Slopes, free: &[usize], mu: &[f64], motion: &mut [Vec<f64>; 3]) -> Vec<Vec<f64>> {
        let (count, nv) = (self.count, self.tape.nv);
        slopes.explicit.add_transposed(-1.0, mu, &mut self.sum, count);
        let [q, v, _] = motion;
        for (r, mu) in mu.chunks_exact(count).enumerate() {
            for k in 0..nv {
                let own = k * count..(k + 1) * count;
                add(&mut q[own.clone()], -slopes.by_q[r * nv + k], mu);
                add(&mut v[own], -slopes.by_v[r * nv + k], mu);
            }
        }
        let force = |[gradient, _]: &[Vec<f64>; 2]| {
            let mut sum = vec![0.0; count];
            free.iter().zip(mu.chunks_exact(count)).for_each(|(row, mu)| add(&mut sum, -gradient[*row], mu));
            sum
        };
        slopes.gradients.iter().map(force).collect()
    }

    /// Over accelerations that were worked out anew.
    fn start(&mut self, start: &Start) {
        let Start { free, mass, slopes, forces } = start;
        let count = self.count;
        let [_, _, a] = &mut self.motion;
        let mut mu: Vec<f64> = free.iter().flat_map(|&k| a[k * count..(k + 1) * count].iter().copied()).collect();
        a.fill(0.0);
        if mu.iter().all(|mu| *mu == 0.0) {
            return;
        }
        self.solve(mass, &mut mu);
        let mut motion = std::mem::take(&mut self.motion);
        let pulls = self.unbalance(slopes, free, &mu, &mut motion);
        self.motion = motion;
        for (e, (map, pull)) in forces.iter().zip(&pulls).enumerate() {
            let mut by = vec![0.0; self.tape.layouts[e].columns * count];
            map.add_transposed(1.0, pull, &mut by, count);
            self.settle(e, &by);
            // The row that was told is the start.
            let law = &mut self.laws[e];
            let [stroke, rate] = AT_ROW.map(|column| &by[column * count..(column + 1) * count]);
            add(&mut law.stroke, 1.0, stroke);
            add(&mut law.rate, 1.0, rate);
        }
    }

    /// Over a step.
    fn step(&mut self, step: &Step, seeds: &[(usize, usize, usize, f64)]) {
        let (count, nv, h) = (self.count, self.tape.nv, step.h);
        let elements = self.laws.len();
        let zeros = || [(); 3].map(|()| vec![0.0; nv * count]);
        let still = || vec![vec![0.0; count]; elements];
        let mut stages: [Stage; STAGES] =
            std::array::from_fn(|_| Stage { motion: zeros(), strokes: still(), rates: still() });
        let last = &mut stages[STAGES - 1];
        last.motion = std::mem::replace(&mut self.motion, zeros());
        for (e, law) in self.laws.iter_mut().enumerate() {
            std::mem::swap(&mut last.strokes[e], &mut law.stroke);
            std::mem::swap(&mut last.rates[e], &mut law.rate);
        }
        let mut columns: Vec<Vec<f64>> =
            self.tape.layouts.iter().map(|layout| vec![0.0; layout.columns * count]).collect();
        // What rows told, and what of it the past told.
        let mut told_by_lags = Vec::new();
        for row in &step.rows {
            let Some(told) = self.told(row, seeds) else { continue };
            let (motion, by) = self.share(row, &told);
            self.take_row(&motion, (row.theta, h, &step.free), &mut stages);
            for (sum, by) in columns.iter_mut().zip(&by) {
                add(sum, 1.0, by);
            }
            if !by.is_empty() {
                told_by_lags.push((row, by));
            }
        }
        // Lags of rows are others than those of the step: each is told by itself below.
        for (e, sum) in columns.iter_mut().enumerate() {
            for port in &self.tape.layouts[e].ports {
                let [first, room] = port.lags;
                sum[first * count..(first + room) * count].fill(0.0);
            }
        }
        self.take_back(step, &mut columns);
        for (e, by) in columns.iter().enumerate() {
            for (i, stage) in stages.iter_mut().enumerate() {
                let of = |column: usize| &by[column * count..(column + 1) * count];
                add(&mut stage.strokes[e], 1.0, of(STROKE[i + 1]));
                add(&mut stage.rates[e], 1.0, of(RATE[i + 1]));
            }
        }
        self.measure_stages(step, &mut stages);
        let mut mu = Self::accelerations(step, &stages, count);
        self.carry(step, &stages);
        self.solve(&step.matrix, &mut mu);
        let own = step.free.len() * count;
        let mut pulls = Vec::new();
        for (i, stage) in stages.iter_mut().enumerate() {
            stage.motion = zeros();
            pulls.push(self.unbalance(&step.stages[i], &step.free, &mu[i * own..(i + 1) * own], &mut stage.motion));
        }
        for (e, StepOfElement { response: [by_stroke, by_rate], forces, .. }) in step.elements.iter().enumerate() {
            let pull: Vec<f64> = pulls.iter().flat_map(|pulls| pulls[e].iter().copied()).collect();
            forces.add_transposed(1.0, &pull, &mut columns[e], count);
            for (m, stage) in stages.iter_mut().enumerate() {
                stage.strokes[e].fill(0.0);
                stage.rates[e].fill(0.0);
                for (i, pull) in pull.chunks_exact(count).enumerate() {
                    add(&mut stage.strokes[e], by_stroke[i][m], pull);
                    add(&mut stage.rates[e], by_rate[i][m], pull);
                }
            }
        }
        self.measure_stages(step, &mut stages);
        self.carry(step, &stages);
        for (e, (by, own)) in columns.iter().zip(&step.elements).enumerate() {
            let law = &mut self.laws[e];
            law.stroke.fill(0.0);
            law.rate.fill(0.0);
            self.settle(e, by);
            self.tell(e, by, &own.lags, &own.pasts);
        }
        for (row, by) in &told_by_lags {
            for (e, (by, of_row)) in by.iter().zip(&row.elements).enumerate() {
                self.tell(e, by, &of_row.lags, &step.elements[e].pasts);
            }
        }
    }

    /// What counts of a row at θ counts of the start and of the accelerations at the nodes.
    fn take_row(
        &mut self,
        [q, v, a]: &[Vec<f64>; 3],
        (theta, h, free): (f64, f64, &[usize]),
        stages: &mut [Stage; STAGES],
    ) {
        let count = self.count;
        let [q_start, v_start, _] = &mut self.motion;
        add(q_start, 1.0, q);
        add(v_start, 1.0, v);
        for &k in free {
            let own = k * count..(k + 1) * count;
            add(&mut v_start[own.clone()], h * theta, &q[own]);
        }
        for node in 0..=STAGES {
            let weights = integrals(TABLEAU.rates.map(|line| line[node]), theta);
            let to = match node {
                0 => &mut self.motion[2],
                _ => &mut stages[node - 1].motion[2],
            };
            for &k in free {
                let own = k * count..(k + 1) * count;
                add(&mut to[own.clone()], weights[0], &a[own.clone()]);
                add(&mut to[own.clone()], h * weights[1], &v[own.clone()]);
                add(&mut to[own.clone()], h * h * weights[2], &q[own]);
            }
        }
    }

    /// Over what laws keep behind the step: adds to what counts of their columns.
    fn take_back(&mut self, step: &Step, columns: &mut [Vec<f64>]) {
        let count = self.count;
        for ((law, own), by) in self.laws.iter_mut().zip(&step.elements).zip(columns) {
            let mut kept = Vec::new();
            for (memory, past) in law.memories.iter_mut().zip(&own.pasts) {
                let earlier = past.as_ref().map(|past| memory.take_back(past));
                memory.piece.iter().for_each(|piece| kept.extend_from_slice(piece));
                kept.extend_from_slice(&memory.travelled);
                kept.extend_from_slice(&memory.now);
                memory.piece = earlier.unwrap_or_else(|| [(); 4].map(|()| vec![0.0; count]));
                memory.travelled.fill(0.0);
                memory.now.fill(0.0);
            }
            debug_assert_eq!(kept.len(), law.memories.len() * KEPT * count);
            kept.extend_from_slice(&law.variables);
            law.variables.fill(0.0);
            own.kept.add_transposed(1.0, &kept, by, count);
        }
    }

    /// What counts of strokes and rates at the nodes counts of the motion there.
    fn measure_stages(&mut self, step: &Step, stages: &mut [Stage; STAGES]) {
        for (Stage { motion, strokes, rates }, slopes) in stages.iter_mut().zip(&step.stages) {
            for (e, (stroke, rate)) in strokes.iter().zip(rates.iter()).enumerate() {
                self.measure(e, &slopes.gradients[e], [stroke, rate], motion);
            }
        }
    }

    /// What counts of the accelerations at the nodes.
    fn accelerations(step: &Step, stages: &[Stage; STAGES], count: usize) -> Vec<f64> {
        let h = step.h;
        let mut all = Vec::with_capacity(STAGES * step.free.len() * count);
        for j in 0..STAGES {
            for &k in &step.free {
                let own = k * count..(k + 1) * count;
                let mut sum = stages[j].motion[2][own.clone()].to_vec();
                for (i, Stage { motion: [q, v, _], .. }) in stages.iter().enumerate() {
                    add(&mut sum, h * h * A_SQUARED[i][j], &q[own.clone()]);
                    add(&mut sum, h * A[i][j], &v[own.clone()]);
                }
                all.extend(sum);
            }
        }
        all
    }

    /// What counts of q and v at the nodes counts of the start.
    fn carry(&mut self, step: &Step, stages: &[Stage; STAGES]) {
        let count = self.count;
        let [q_start, v_start, _] = &mut self.motion;
        for (Stage { motion: [q, v, _], .. }, c) in stages.iter().zip(RADAU_NODES) {
            add(q_start, 1.0, q);
            add(v_start, 1.0, v);
            for &k in &step.free {
                let own = k * count..(k + 1) * count;
                add(&mut v_start[own.clone()], c * step.h, &q[own]);
            }
        }
    }

    /// Over what begins at t = 0.
    fn begin(&mut self) {
        let (count, tape) = (self.count, self.tape);
        for (e, (kept, gradients)) in tape.begin.kept.iter().zip(&tape.begin.gradients).enumerate() {
            let mut by = vec![0.0; tape.layouts[e].columns * count];
            let law = &self.laws[e];
            let mut all: Vec<f64> = law.memories.iter().flat_map(|memory| memory.origin.iter().copied()).collect();
            all.extend_from_slice(&law.variables);
            kept.add_transposed(1.0, &all, &mut by, count);
            self.settle(e, &by);
            let law = &self.laws[e];
            let (stroke, rate) = (law.stroke.clone(), law.rate.clone());
            let mut motion = std::mem::take(&mut self.motion);
            self.measure(e, gradients, [&stroke, &rate], &mut motion);
            self.motion = motion;
        }
        let [q, v, _] = &self.motion;
        for (k, p, [by_q, by_v]) in &tape.starts {
            let own = k * count..(k + 1) * count;
            let sum = &mut self.sum[p * count..(p + 1) * count];
            add(sum, *by_q, &q[own.clone()]);
            add(sum, *by_v, &v[own]);
        }
    }
}
