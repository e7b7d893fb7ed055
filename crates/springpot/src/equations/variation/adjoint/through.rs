//! Back through a step by its own equations ([`SolvedStep`]).

use super::back::Backwards;
use super::step::{ElementPlan, KEPT, POINTS, SolvedStep};
use super::weighing::Weighing;
use crate::collocation::radau::{A, A_SQUARED};
use crate::collocation::{RADAU_NODES, STAGES, TABLEAU, integrals};
use crate::fractional::OfStep;
use crate::linalg::columns::Block;

/// Room to go back through steps in: blocks of M numbers.
#[derive(Debug, Default)]
pub(super) struct Through {
    /// What counts of q, v and a at the start and at the stages, velocity by velocity.
    nodes: [[Vec<f64>; 3]; POINTS],
    /// Of the columns of each element, and of one by what is unbalanced alone.
    columns: Vec<Vec<f64>>,
    again: Vec<f64>,
    /// Of what is unbalanced at the stages, velocity by velocity.
    unbalanced: Vec<f64>,
    force: Vec<f64>,
    none: Vec<f64>,
    solve: [Vec<Block>; 2],
    weighing: Option<Box<Weighing>>,
}

/// ∂y/∂q and ∂y'/∂q of an element at the start and at the stages, and its forces at the stages by its columns.
#[derive(Clone, Copy)]
struct OfElement<'a> {
    plan: &'a ElementPlan,
    slopes: &'a [f64],
    forces: &'a [f64],
}

impl<'a> OfElement<'a> {
    fn slopes(&self, node: usize) -> [&'a [f64]; 2] {
        let width = self.slopes.len() / (2 * POINTS);
        [0, 1].map(|which| &self.slopes[(2 * node + which) * width..][..width])
    }

    /// What counts of strokes and rates counts so much of the motion.
    fn hand_on(&self, by: &[f64], nodes: &mut [[Vec<f64>; 3]; POINTS], count: usize) {
        for (m, [q, v, _]) in nodes.iter_mut().enumerate() {
            let [strokes, rates] = [m, POINTS + m].map(|column| &by[column * count..][..count]);
            let [gradient, bend] = self.slopes(m);
            spread(q, gradient, strokes);
            spread(q, bend, rates);
            spread(v, gradient, rates);
        }
    }
}

impl Backwards {
    pub(super) fn through(&mut self, step: &SolvedStep) {
        let (count, plan, h) = (self.count, &*step.plan, step.h);
        let (n, size) = (plan.velocities, plan.velocities * count);
        let mut room = std::mem::take(&mut self.room);
        let Through { nodes, columns, again, unbalanced, force, none, solve, weighing } = &mut room;
        nodes.iter_mut().flatten().for_each(|blocks| clear(blocks, size));
        clear(none, count);
        for (which, blocks) in nodes[STAGES].iter_mut().enumerate() {
            blocks.copy_from_slice(&self.state[which * size..(which + 1) * size]);
        }
        for (number, theta) in &step.rows {
            self.over_row((*number, *theta), step, nodes);
        }
        let (rows, of_elements) = step.equations().split_at(STAGES * n * 2 * n);
        let width_of = |plan_of: &ElementPlan| (2 * POINTS * n, STAGES * plan_of.columns);
        let elements = || {
            plan.elements.iter().scan(of_elements, |rest, plan_of| {
                let (slopes, forces) = width_of(plan_of);
                let (own, more) = rest.split_at(slopes + forces);
                *rest = more;
                let (slopes, forces) = own.split_at(slopes);
                Some(OfElement { plan: plan_of, slopes, forces })
            })
        };
        // What each element has by its columns.
        let of_all: usize = plan.elements.iter().map(|own| width_of(own).0 + width_of(own).1).sum();
        let (mut rest, mut kept) = (&of_elements[of_all..], &self.state[3 * size..]);
        let mut memories = step.memories.iter().zip(&mut self.memories);
        columns.resize_with(plan.elements.len(), Vec::new);
        for (own, by) in elements().zip(&mut *columns) {
            clear(by, own.plan.columns * count);
            let mut add_row = |factors: &[f64]| {
                let (row, more) = rest.split_at(own.plan.columns);
                spread(by, row, factors);
                rest = more;
            };
            for (of_step, memory) in memories.by_ref().take(own.plan.memories) {
                let (now, more) = kept.split_at(KEPT * count);
                now.chunks_exact(count).for_each(&mut add_row);
                kept = more;
                if let Some(past) = &of_step.past {
                    let OfStep { piece, .. } = memory.take_back(past);
                    let pieces = piece.iter().chain(std::iter::repeat(&*none)).take(of_step.rows);
                    pieces.for_each(|factors| add_row(factors));
                }
            }
            own.hand_on(by, nodes, count);
        }
        // ∂m/∂a, and through the equations of all stages at once −∂m/∂ρ.
        clear(unbalanced, STAGES * size);
        for (j, sum) in unbalanced.chunks_exact_mut(size.max(1)).enumerate() {
            let [.., a] = &nodes[j + 1];
            sum.copy_from_slice(a);
            for (i, [q, v, _]) in nodes[1..].iter().enumerate() {
                add(sum, h * h * A_SQUARED[i][j], q);
                add(sum, h * A[i][j], v);
            }
        }
        step.transposed.solve_rows_within(solve, unbalanced, count);
        unbalanced.iter_mut().for_each(|own| *own = -*own);
        for (own, sums) in elements().zip(&mut *columns) {
            clear(again, own.plan.columns * count);
            for (i, stage) in unbalanced.chunks_exact(size.max(1)).enumerate() {
                let [gradient, _] = own.slopes(i + 1);
                clear(force, count);
                stage.chunks_exact(count).zip(gradient).for_each(|(by, slope)| add(force, *slope, by));
                spread(again, &own.forces[i * own.plan.columns..][..own.plan.columns], force);
            }
            own.hand_on(again, nodes, count);
            add(sums, 1.0, again);
            self.of_element(own, sums);
        }
        for (r, (row, by)) in rows.chunks_exact(2 * n).zip(unbalanced.chunks_exact(count)).enumerate() {
            let ([q, v, _], (by_q, by_v)) = (&mut nodes[r / n + 1], row.split_at(n));
            spread(q, by_q, by);
            spread(v, by_v, by);
        }
        let weighing = weighing.get_or_insert_with(|| Box::new(Weighing::of(plan)));
        weighing.weigh(step, (unbalanced, columns, count), &mut self.sum);
        self.go_to_start(step, &room);
        self.room = room;
    }

    /// What counts of a row at θ of the step: how that follows from the nodes, [`crate::methods`] has it.
    fn over_row(&mut self, (number, theta): (usize, f64), step: &SolvedStep, nodes: &mut [[Vec<f64>; 3]; POINTS]) {
        let (count, h) = (self.count, step.h);
        let Some((seeds, rests)) = self.counted(number) else { return };
        for (m, counts) in self.counts.iter_mut().enumerate() {
            *counts |= rests.iter().skip(m).step_by(count).any(|rests| *rests);
        }
        let of_node = |i: usize| integrals(TABLEAU.rates.map(|line| line[i]), theta);
        for (seeds, of) in seeds.chunks_exact(count).zip(&step.plan.motion) {
            let Some((which, k)) = *of else { continue };
            let own = k * count..(k + 1) * count;
            for (i, [.., a]) in nodes.iter_mut().enumerate() {
                let [value, once, twice] = of_node(i);
                add(&mut a[own.clone()], [h * h * twice, h * once, value][which], seeds);
            }
            let [[q, v, _], ..] = nodes;
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

    /// What parameters have of the columns of an element.
    fn of_element(&mut self, own: OfElement, by: &[f64]) {
        let count = self.count;
        for (p, column) in own.plan.law.iter().zip(own.plan.own()..) {
            add(&mut self.sum[p * count..][..count], 1.0, &by[column * count..][..count]);
        }
        for m in 0..POINTS {
            let strokes = &by[m * count..][..count];
            own.plan.rest.iter().for_each(|(p, rest)| add(&mut self.sum[p * count..][..count], *rest, strokes));
        }
    }

    /// To the state in front of the step, and to the past of its memories.
    fn go_to_start(&mut self, step: &SolvedStep, room: &Through) {
        let (count, plan, h) = (self.count, &*step.plan, step.h);
        let size = plan.velocities * count;
        clear(&mut self.state, step.state * count);
        let [start, stages @ ..] = &room.nodes;
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
        for (own, by) in plan.elements.iter().zip(&room.columns) {
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

/// So many zeros.
fn clear(blocks: &mut Vec<f64>, size: usize) {
    blocks.clear();
    blocks.resize(size, 0.0);
}

/// to += factor·by.
fn add(to: &mut [f64], factor: f64, by: &[f64]) {
    to.iter_mut().zip(by).for_each(|(to, by)| *to += factor * by);
}

/// Adds values times by, a block for each value.
fn spread(to: &mut [f64], values: &[f64], by: &[f64]) {
    match by {
        [by] => add(to, *by, values),
        _ => to.chunks_exact_mut(by.len()).zip(values).for_each(|(to, value)| add(to, *value, by)),
    }
}
