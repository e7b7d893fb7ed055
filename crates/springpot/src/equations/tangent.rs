//! How forces answer to the motion within a step, as one list that every matrix of a method is made of.

use super::control::ControlRun;
use crate::collocation::MAX_NODES;
use crate::elements::ElementBank;
use crate::law::Response;
use std::borrow::Cow;

/// A force that answers to the motion at the nodes of a step: on_r Σ_j (G_ij δy_j + P_ij δy'_j) is added to the equation of velocity r at node i.
#[derive(Debug, Clone)]
pub(crate) struct Coupling<'a> {
    path: Path<'a>,
    /// G and P.
    pub(crate) gain: [[[f64; MAX_NODES]; MAX_NODES]; 2],
}

/// What it acts on, and what it feels: rows of nv numbers.
#[derive(Debug, Clone)]
enum Path<'a> {
    /// One velocity and its coordinate.
    Joint(usize),
    /// δy = by·δq, δy' = by·δv.
    Measure { on: Cow<'a, [f64]>, by: &'a [f64] },
    /// δy = by_q·δq, δy' = by_v·δv.
    State { on: Cow<'a, [f64]>, by: [&'a [f64]; 2] },
}

/// All couplings of a step: `gradients` are ∂y/∂q of the elements (nv each). Elements count for nothing where an actuator takes their forces off.
pub(crate) fn couplings<'a>(
    gradients: impl Iterator<Item = &'a [f64]> + Clone,
    bank: &'a ElementBank,
    control: Option<&'a ControlRun>,
) -> Vec<Coupling<'a>> {
    let compensating = control.filter(|control| control.takes_off_any());
    let on = |gradient: &'a [f64]| match compensating {
        None => Cow::Borrowed(gradient),
        Some(control) => {
            let left = gradient.iter().enumerate().map(|(k, g)| if control.takes_off_elements(k) { 0.0 } else { *g });
            left.collect()
        }
    };
    let of_response = |path, response: &Response| Coupling { path, gain: [response.d_stroke, response.d_rate] };
    let elements = gradients.clone().enumerate();
    let mut all: Vec<_> =
        elements.map(|(e, by)| of_response(Path::Measure { on: on(by), by }, bank.response(e))).collect();
    let Some(control) = control else { return all };
    all.extend(control.responses().map(|(k, response)| of_response(Path::Joint(k), &response)));
    all.extend(control.inputs().iter().filter_map(|input| {
        let (on, by) = (on(gradients.clone().nth(input.element)?), input.by_state.each_ref().map(Vec::as_slice));
        Some(Coupling { path: Path::State { on, by }, gain: [input.force; 2] })
    }));
    all
}

#[cfg(test)]
impl<'a> Coupling<'a> {
    /// That of a force on all velocities that feels δq and δv.
    pub(crate) fn between(on: &'a [f64], by: [&'a [f64]; 2], gain: [[[f64; MAX_NODES]; MAX_NODES]; 2]) -> Self {
        Self { path: Path::State { on: Cow::Borrowed(on), by }, gain }
    }
}

impl Coupling<'_> {
    /// Whether it answers at each node of `count` to what is there alone, and alike at all.
    pub(crate) fn is_uniform(&self, count: usize) -> bool {
        let entry = |gain: &[[f64; MAX_NODES]; MAX_NODES], i: usize, j: usize| {
            gain[i][j] - if i == j { gain[0][0] } else { 0.0 }
        };
        self.gain.iter().all(|gain| (0..count * count).all(|k| entry(gain, k / count, k % count) == 0.0))
    }

    /// What it acts on, and what it feels of δq and of δv, of the velocities `free`.
    pub(crate) fn rows(&self, free: &[usize], [on, by_q, by_v]: [&mut Vec<f64>; 3]) {
        let unit = |k: usize| move |&r: &usize| f64::from(u8::from(r == k));
        for row in [&mut *on, by_q, by_v] {
            row.clear();
        }
        match &self.path {
            Path::Joint(k) => [on, by_q, by_v].into_iter().for_each(|row| row.extend(free.iter().map(unit(*k)))),
            Path::Measure { on: push, by } => {
                on.extend(free.iter().map(|&k| push[k]));
                [by_q, by_v].into_iter().for_each(|row| row.extend(free.iter().map(|&k| by[k])));
            }
            Path::State { on: push, by: [q, v] } => {
                on.extend(free.iter().map(|&k| push[k]));
                by_q.extend(free.iter().map(|&k| q[k]));
                by_v.extend(free.iter().map(|&k| v[k]));
            }
        }
    }

    /// Adds on ⊗ (x·by of δq + y·by of δv) over the velocities `free` to a matrix whose line r begins at `line(r)`.
    #[inline(always)]
    pub(crate) fn add(&self, [x, y]: [f64; 2], free: &[usize], matrix: &mut [f64], line: impl Fn(usize) -> usize) {
        match &self.path {
            Path::Joint(k) => {
                if let Some(r) = free.iter().position(|free| free == k) {
                    matrix[line(r) + r] += x + y;
                }
            }
            Path::Measure { on, by } => {
                for (r, &row) in free.iter().enumerate() {
                    let (push, line) = ((x + y) * on[row], &mut matrix[line(r)..][..free.len()]);
                    line.iter_mut().zip(free).for_each(|(entry, &column)| *entry += push * by[column]);
                }
            }
            Path::State { on, by: [by_q, by_v] } => {
                for (r, &row) in free.iter().enumerate() {
                    let (push, line) = (on[row], &mut matrix[line(r)..][..free.len()]);
                    let felt = |column: usize| x * by_q[column] + y * by_v[column];
                    line.iter_mut().zip(free).for_each(|(entry, &column)| *entry += push * felt(column));
                }
            }
        }
    }
}
