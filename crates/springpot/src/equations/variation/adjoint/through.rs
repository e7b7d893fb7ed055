//! Back through a step by its own equations ([`SolvedStep`]).

use super::back::Backwards;
use super::step::{ElementPlan, KEPT, POINTS, SolvedStep};
use crate::collocation::radau::{A, A_SQUARED};
use crate::collocation::{RADAU_NODES, STAGES, TABLEAU, integrals};
use crate::fractional::OfStep;

/// What counts of q, v and a at the start and at the stages, velocity by velocity, blocks of M numbers.
struct OfNodes([[Vec<f64>; 3]; POINTS]);

/// ∂y/∂q and ∂y'/∂q of an element at the start and at the stages, by velocities and places, and its forces at the stages by its columns.
struct OfElement<'a> {
    plan: &'a ElementPlan,
    slopes: &'a [f64],
    forces: &'a [f64],
}

impl OfElement<'_> {
    fn slopes(&self, node: usize) -> [&[f64]; 2] {
        let width = self.slopes.len() / (2 * POINTS);
        [0, 1].map(|which| &self.slopes[(2 * node + which) * width..][..width])
    }

    /// What counts of strokes and rates counts so much of the motion.
    fn hand_on(&self, by: &[f64], nodes: &mut OfNodes, count: usize) {
        for (m, [q, v, _]) in nodes.0.iter_mut().enumerate() {
            let [strokes, rates] = [m, POINTS + m].map(|column| &by[column * count..][..count]);
            let [gradient, bend] = self.slopes(m);
            for (k, (q, v)) in q.chunks_exact_mut(count).zip(v.chunks_exact_mut(count)).enumerate() {
                add(q, gradient[k], strokes);
                add(q, bend[k], rates);
                add(v, gradient[k], rates);
            }
        }
    }
}

impl Backwards {
    pub(super) fn through(&mut self, step: &SolvedStep) {
        let (count, plan, h) = (self.count, &*step.plan, step.h);
        let (n, size) = (plan.velocities, plan.velocities * count);
        let mut nodes = OfNodes(std::array::from_fn(|_| [(); 3].map(|()| vec![0.0; size])));
        let behind = &self.state[..];
        for (which, blocks) in nodes.0[STAGES].iter_mut().enumerate() {
            blocks.copy_from_slice(&behind[which * size..(which + 1) * size]);
        }
        for (number, theta) in &step.rows {
            self.over_row((*number, *theta), step, &mut nodes);
        }
        // What each element has by its columns.
        let width = 2 * n + plan.places() + plan.explicit.len();
        let (rows, mut rest) = step.numbers.split_at(STAGES * n * width);
        let elements: Vec<OfElement> = plan
            .elements
            .iter()
            .map(|plan_of| {
                let (slopes, more) = rest.split_at(2 * POINTS * (n + plan.places()));
                let (forces, more) = more.split_at(STAGES * plan_of.columns);
                rest = more;
                OfElement { plan: plan_of, slopes, forces }
            })
            .collect();
        let mut of_columns: Vec<Vec<f64>> = elements.iter().map(|own| vec![0.0; own.plan.columns * count]).collect();
        let (mut memories, mut kept) = (step.memories.iter().zip(&mut self.memories), &self.state[3 * size..]);
        for (own, by) in elements.iter().zip(&mut of_columns) {
            let columns = own.plan.columns;
            let mut add_rows = |factors: &[f64]| {
                for factors in factors.chunks_exact(count) {
                    let (row, more) = rest.split_at(columns);
                    by.chunks_exact_mut(count).zip(row).for_each(|(by, value)| add(by, *value, factors));
                    rest = more;
                }
            };
            for (of_step, memory) in memories.by_ref().take(own.plan.memories) {
                let (now, more) = kept.split_at(KEPT * count);
                add_rows(now);
                kept = more;
                if let Some(past) = &of_step.past {
                    let OfStep { piece, .. } = memory.take_back(past);
                    let pieces = piece.iter().chain(std::iter::repeat(&self.none)).take(of_step.rows);
                    pieces.for_each(|factors| add_rows(factors));
                }
            }
            own.hand_on(by, &mut nodes, count);
        }
        // ∂m/∂a, and through the equations of all stages at once to −∂m/∂ρ.
        let mut unbalanced = vec![0.0; STAGES * size];
        for (j, sum) in unbalanced.chunks_exact_mut(size.max(1)).enumerate() {
            let [.., a] = &nodes.0[j + 1];
            sum.copy_from_slice(a);
            for (i, [q, v, _]) in nodes.0[1..].iter().enumerate() {
                add(sum, h * h * A_SQUARED[i][j], q);
                add(sum, h * A[i][j], v);
            }
        }
        self.solve.clone_from(&step.transposed);
        self.solve.solve_rows(&mut unbalanced, count);
        unbalanced.iter_mut().for_each(|own| *own = -*own);
        self.under(step, (rows, width), &unbalanced, &mut nodes);
        for (own, sums) in elements.iter().zip(&mut of_columns) {
            let mut by = vec![0.0; own.plan.columns * count];
            let mut force = vec![0.0; count];
            for i in 0..STAGES {
                let [gradient, _] = own.slopes(i + 1);
                force.fill(0.0);
                let stage = unbalanced[i * size..(i + 1) * size].chunks_exact(count);
                stage.zip(gradient).for_each(|(by, slope)| add(&mut force, *slope, by));
                let row = &own.forces[i * own.plan.columns..][..own.plan.columns];
                by.chunks_exact_mut(count).zip(row).for_each(|(by, value)| add(by, *value, &force));
            }
            own.hand_on(&by, &mut nodes, count);
            sums.iter_mut().zip(&by).for_each(|(sum, by)| *sum += by);
            self.of_element(step, own, sums);
        }
        self.go_to_start(step, &nodes, &of_columns);
    }

    /// What counts of a row at θ of the step ([`crate::methods`] has how it follows from the nodes).
    fn over_row(&mut self, (number, theta): (usize, f64), step: &SolvedStep, nodes: &mut OfNodes) {
        let (count, h) = (self.count, step.h);
        let Some((seeds, rests)) = self.counted(number) else { return };
        for (m, counts) in self.counts.iter_mut().enumerate() {
            *counts |= rests.iter().skip(m).step_by(count).any(|rests| *rests);
        }
        let of_node = |i: usize| integrals(TABLEAU.rates.map(|line| line[i]), theta);
        for (seeds, of) in seeds.chunks_exact(count).zip(&step.plan.motion) {
            let Some((which, k)) = *of else { continue };
            let own = k * count..(k + 1) * count;
            for (i, [.., a]) in nodes.0.iter_mut().enumerate() {
                let [value, once, twice] = of_node(i);
                add(&mut a[own.clone()], [h * h * twice, h * once, value][which], seeds);
            }
            let [[q, v, _], ..] = &mut nodes.0;
            match which {
                0 => {
                    add(&mut q[own.clone()], 1.0, seeds);
                    add(&mut v[own], h * theta, seeds);
                }
                1 => add(&mut v[own], 1.0, seeds),
                _ => {}
            }
        }
    }

    /// What counts of what is unbalanced at the stages counts so much of the motion there, of places and of parameters.
    fn under(&mut self, step: &SolvedStep, (rows, width): (&[f64], usize), unbalanced: &[f64], nodes: &mut OfNodes) {
        let (count, plan) = (self.count, &*step.plan);
        let n = plan.velocities;
        let mut of_places = vec![0.0; plan.places() * count];
        for (r, (row, by)) in rows.chunks_exact(width.max(1)).zip(unbalanced.chunks_exact(count)).enumerate() {
            let [q, v, _] = &mut nodes.0[r / n + 1];
            let (by_q, rest) = row.split_at(n);
            let (by_v, rest) = rest.split_at(n);
            let (by_places, explicit) = rest.split_at(plan.places());
            for (blocks, slopes) in [(q, by_q), (v, by_v), (&mut of_places, by_places)] {
                blocks.chunks_exact_mut(count).zip(slopes).for_each(|(own, slope)| add(own, *slope, by));
            }
            for (p, value) in plan.explicit.iter().zip(explicit) {
                add(&mut self.sum[p * count..][..count], *value, by);
            }
        }
        for (place, p, by) in &plan.placed {
            add(&mut self.sum[p * count..][..count], *by, &of_places[place * count..][..count]);
        }
    }

    /// What parameters have of the columns of an element.
    fn of_element(&mut self, step: &SolvedStep, own: &OfElement, by: &[f64]) {
        let (count, plan) = (self.count, &*step.plan);
        for (p, column) in own.plan.law.iter().zip(own.plan.own()..) {
            add(&mut self.sum[p * count..][..count], 1.0, &by[column * count..][..count]);
        }
        for m in 0..POINTS {
            let [strokes, rates] = [m, POINTS + m].map(|column| &by[column * count..][..count]);
            let [gradient, bend] = own.slopes(m);
            own.plan.rest.iter().for_each(|(p, rest)| add(&mut self.sum[p * count..][..count], *rest, strokes));
            for (place, p, by) in &plan.placed {
                let sum = &mut self.sum[p * count..][..count];
                add(sum, gradient[plan.velocities + place] * by, strokes);
                add(sum, bend[plan.velocities + place] * by, rates);
            }
        }
    }

    /// To the state in front of the step, and to the past of its memories.
    fn go_to_start(&mut self, step: &SolvedStep, nodes: &OfNodes, of_columns: &[Vec<f64>]) {
        let (count, plan, h) = (self.count, &*step.plan, step.h);
        let size = plan.velocities * count;
        self.state.clear();
        self.state.resize(step.starts.numbers * count, 0.0);
        let [start, stages @ ..] = &nodes.0;
        for (which, blocks) in start.iter().enumerate() {
            self.state[which * size..(which + 1) * size].copy_from_slice(blocks);
        }
        let (to_q, rest) = self.state.split_at_mut(size);
        for ([q, v, _], c) in stages.iter().zip(RADAU_NODES) {
            add(to_q, 1.0, q);
            add(&mut rest[..size], c * h, q);
            add(&mut rest[..size], 1.0, v);
        }
        let (mut number, mut memories) = (3 * size, step.memories.iter().zip(&mut self.memories));
        for (own, by) in plan.elements.iter().zip(of_columns) {
            for (k, (of_step, memory)) in memories.by_ref().take(own.memories).enumerate() {
                let kept = &by[own.memory(k) * count..][..KEPT * count];
                self.state[number..number + kept.len()].copy_from_slice(kept);
                number += kept.len();
                for (column, told) in &of_step.told {
                    memory.tell(of_step.past.as_ref(), told, &by[column * count..][..count]);
                }
            }
        }
    }
}

/// to += factor·by.
fn add(to: &mut [f64], factor: f64, by: &[f64]) {
    to.iter_mut().zip(by).for_each(|(to, by)| *to += factor * by);
}
