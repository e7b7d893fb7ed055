//! How large what parameters change is, and how well a step knows it.

use super::{Variation, of_step};
use crate::collocation::STAGES;
use crate::equations::assembly::Equations;
use crate::law::variation::VariationError;
use crate::system::sensitivity::Sensitivity;
use fearless_simd::{Level, dispatch};
use serde::{Deserialize, Serialize};

/// How far ahead what begins to change is measured, as a share of the run: in shorter steps rounding would be all that is seen of it.
const AHEAD: f64 = 1e-6;

/// What changes may err in a step, in units of what the motion may: so they come to the accuracy that the motion comes to in its own steps.
pub(crate) const TANGENTS: f64 = 4.0;

/// Share of what the motion comes to that a change by the whole of a parameter is expected to come to at least.
const BEGUN: f64 = 1e-3;

/// Share of the largest change below which that of one velocity counts as so large.
const BESIDE: f64 = 1e-4;

/// What a step knows of the changes of its velocities and places, and what the motion itself comes to.
pub(crate) struct StepErrors<'a> {
    /// Errors of v and of q, a block of parameters for each of the rows.
    pub(crate) errors: [&'a [f64]; 2],
    /// Speed and travel of the motion at each row.
    pub(crate) moved: &'a [[f64; 2]],
    /// Tolerance of what changes, relative.
    pub(crate) rtol: f64,
}

/// How large changes have been.
#[derive(Debug)]
pub(super) struct Sizes {
    pub(super) so_far: SizesSoFar,
    /// For each parameter, by how much of what the motion comes to it is expected to change that at least, in units of the parameter.
    expected: Vec<f64>,
}

/// What of it outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SizesSoFar {
    /// Of q and v, in the blocks of the nodes.
    motion: [Vec<f64>; 2],
    /// Of the inner variables of every element.
    hidden: Vec<Vec<f64>>,
}

impl Sizes {
    pub(super) fn new(by: &Sensitivity, nv: usize, elements: usize) -> Self {
        let (count, typical) = (by.parameters.len(), by.parameters.iter().map(|parameter| parameter.typical.abs()));
        let zeros = || vec![0.0; nv * count];
        Self {
            so_far: SizesSoFar { motion: [zeros(), zeros()], hidden: vec![Vec::new(); elements] },
            expected: typical.map(|typical| if typical == 0.0 { 0.0 } else { BEGUN / typical }).collect(),
        }
    }
}

impl SizesSoFar {
    /// Whether those of a run of the same parameters, robot and elements.
    pub(super) fn fits(&self, other: &Self) -> bool {
        self.motion[0].len() == other.motion[0].len()
            && self.motion[1].len() == other.motion[1].len()
            && self.hidden.len() == other.hidden.len()
    }
}

impl Variation {
    /// Whether its errors share in the choice of steps.
    pub(crate) fn shares_in_steps(&self) -> bool {
        self.by.control
    }

    /// The estimate of the step's error of the parameter whose changes of the velocities `rows` it knows least, in units of its tolerance: the rms of q and
    /// v of all rows.
    ///
    /// A change is measured by how large it has been so far, that at the end of the step at hand included. What hardly changes beside the others is
    /// measured by them, and what begins like no power of t, alike on every scale of it, by the travel and the speed of the motion itself.
    pub(crate) fn step_error(&self, rows: &[usize], errors: StepErrors) -> f64 {
        self.step_errors(rows, errors).into_iter().fold(0.0, f64::max)
    }

    /// The same of each parameter; 0 of one whose changes ended.
    pub(crate) fn step_errors(&self, rows: &[usize], StepErrors { errors, moved, rtol }: StepErrors) -> Vec<f64> {
        let count = self.count();
        let (last, [sizes_q, sizes_v]) = (&self.nodes[STAGES], &self.sizes.so_far.motion);
        let sides = [(sizes_q, &last.q), (sizes_v, &last.v)];
        let block = |k: usize| k * count..(k + 1) * count;
        let mut beside = [vec![0.0f64; count], vec![0.0f64; count]];
        for (beside, (sizes, last)) in beside.iter_mut().zip(sides) {
            for block in self.own_v.iter().map(|&k| block(k)) {
                dispatch!(Level::new(), _ => grow(beside, BESIDE, [&sizes[block.clone()], &last[block]]));
            }
        }
        let (mut sums, mut jumps, none) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        for (r, (&k, [speed, travel])) in rows.iter().zip(moved).enumerate() {
            jumps.iter_mut().enumerate().for_each(|(p, jump)| *jump = self.jump_travel(k, p));
            let measured = [(errors[1], travel, &jumps), (errors[0], speed, &none)];
            for (((sizes, last), beside), (errors, moved, jumps)) in sides.iter().zip(&beside).zip(measured) {
                let own = [&sizes[block(k)], &last[block(k)], beside, &self.sizes.expected, &errors[block(r)], jumps];
                dispatch!(Level::new(), _ => add_shares(&mut sums, (rtol, *moved), own));
            }
        }
        let rms = |(p, sum): (usize, &f64)| {
            let rms = (sum / (2 * rows.len()) as f64).sqrt();
            let rms = if rms.is_nan() { f64::INFINITY } else { rms };
            if self.knows(p) { rms } else { 0.0 }
        };
        sums.iter().enumerate().map(rms).collect()
    }

    /// The estimate of the step's error of what changes of the inner variables of laws, the worst one in units of its tolerance, `rtol` of its size.
    pub(crate) fn hidden_error(&self, equations: &Equations, (rtol, end): (f64, f64)) -> f64 {
        let (mut worst, count) = (0.0f64, self.count());
        let ahead = (AHEAD * end / equations.bank.size()).max(1.0);
        for ((e, element), sizes) in self.elements.iter().enumerate().zip(&self.sizes.so_far.hidden) {
            if element.law.variables().is_empty() {
                continue;
            }
            let told = of_step(count, [&element.stroke, &element.rate], &element.inputs);
            equations.bank.vary_errors(e, &told, &element.law, &mut |variable, own| {
                let VariationError { parameter: p, error, change, coming, size } = own;
                if error == 0.0 || !self.knows(p) {
                    return;
                }
                let so_far = sizes.get(variable * count + p).copied().unwrap_or(0.0);
                let share = error / (rtol * so_far.max(change).max(ahead * coming).max(self.sizes.expected[p] * size));
                worst = if share.is_nan() { f64::INFINITY } else { worst.max(share) };
            });
        }
        worst
    }

    /// Takes in how large the changes where the next step starts are.
    pub(super) fn take_sizes(&mut self) {
        if !self.shares_in_steps() {
            return;
        }
        for (element, sizes) in self.elements.iter().zip(&mut self.sizes.so_far.hidden) {
            let now = element.law.variables();
            sizes.resize(now.len(), 0.0);
            sizes.iter_mut().zip(now).for_each(|(size, now)| *size = size.max(now.abs()));
        }
        let (count, Self { nodes: [start, ..], sizes, own_v, .. }) = (self.by.parameters.len(), self);
        let [q, v] = &mut sizes.so_far.motion;
        for (sizes, now) in [(q, &start.q), (v, &start.v)] {
            for block in own_v.iter().map(|k| k * count..(k + 1) * count) {
                dispatch!(Level::new(), _ => grow(&mut sizes[block.clone()], 1.0, [&now[block.clone()], &now[block]]));
            }
        }
    }
}

/// Makes sizes at least `share` of the larger one of two, column by column.
#[inline(always)]
fn grow(sizes: &mut [f64], share: f64, [first, second]: [&[f64]; 2]) {
    let count = sizes.len();
    let (first, second) = (&first[..count], &second[..count]);
    for p in 0..count {
        sizes[p] = sizes[p].max(share * first[p].abs().max(second[p].abs()));
    }
}

/// Adds the squares of errors in units of what they may be: of sizes so far and at the end of the step, of what stands beside, what is expected of what
/// `moved`, the errors, and how far a jump goes.
#[inline(always)]
fn add_shares(sums: &mut [f64], (rtol, moved): (f64, f64), of: [&[f64]; 6]) {
    let count = sums.len();
    let [sizes, last, beside, expected, errors, jumps] = of.map(|own| &own[..count]);
    for p in 0..count {
        let size = sizes[p].max(last[p].abs()).max(beside[p]);
        let share = errors[p] / (rtol * size.max(moved * expected[p]).max(jumps[p]));
        sums[p] += if errors[p] == 0.0 { 0.0 } else { share * share };
    }
}
