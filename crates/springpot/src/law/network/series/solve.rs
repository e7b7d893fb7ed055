//! The strokes of the parts at which all have one force.

use super::{ENOUGH, MOST_HALVINGS, MOST_ITERATIONS, Matrix, Values};
use crate::collocation::{MAX_NODES, Nodes};
use crate::fractional::{Form, RatePolynomial};
use crate::law::network::{MOST_IN_SERIES, Network};
use crate::law::state::StateRef;
use crate::law::step::{Response, Step};

/// Change of the strokes, in units of the largest, at which nonlinear parts end where rounding lets them come no nearer.
const NEARLY: f64 = 1e-9;

/// Square of what counts as rounding of forces.
const ROUNDED: f64 = 1e-28;

/// A part that is softer than this share of the stiffest counts as that soft.
const SOFTEST: f64 = 1e-30;

/// One part over a step, as it is told of it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inner {
    pub(super) stroke: Values,
    pub(super) rate: Values,
}

/// The inner strokes that fit, and what follows.
pub(super) struct Solved {
    pub(super) inner: [Inner; MOST_IN_SERIES],
    pub(super) force: [f64; MAX_NODES],
    pub(super) tangent: Matrix,
    /// By how much the force at the end follows an error of that of each part.
    pub(super) shares: [f64; MOST_IN_SERIES],
}

impl Inner {
    /// Rates of the polynomial through the strokes.
    fn take_rates(&mut self, nodes: Nodes, h: f64) {
        let count = nodes.count();
        for (i, row) in nodes.inverse().iter().enumerate().take(count) {
            self.rate[i + 1] = (0..count).map(|j| row[j] * (self.stroke[j + 1] - self.stroke[0])).sum::<f64>() / h;
        }
        self.rate[0] = RatePolynomial::through_strokes(h, nodes, &self.stroke).u[0];
    }

    pub(super) fn step<'a>(&'a self, whole: &Step<'a>) -> Step<'a> {
        let count = whole.nodes.count() + 1;
        Step { form: Form::Strokes, stroke: &self.stroke[..count], rate: &self.rate[..count], ..*whole }
    }
}

/// Finds the strokes of the parts under the strokes of `step`, whose nodes are theirs, from those at its start.
pub(super) fn solve(parts: &[Network], step: &Step, starts: &[f64], state: &mut StateRef) -> Solved {
    let nodes = step.nodes;
    let (count, inverse) = (nodes.count(), nodes.inverse());
    let is_linear = parts.iter().all(Network::is_linear);
    let mut search = Search::default();
    let mut inner = [Inner::default(); MOST_IN_SERIES];
    let missing = step.stroke[0] - starts.iter().sum::<f64>();
    for (inner, start) in inner.iter_mut().zip(starts) {
        for k in 0..=count {
            let moved = step.stroke[k] - step.stroke[0] + missing;
            // A nonlinear part would begin far from where it is: the stiffness where it was shares the way out.
            inner.stroke[k] = start + if k == 0 || !is_linear { 0.0 } else { moved / parts.len() as f64 };
        }
        inner.take_rates(nodes, step.h);
    }
    let (mut force, mut tangent) = ([0.0; MAX_NODES], [[0.0; MAX_NODES]; MAX_NODES]);
    let mut shares = [0.0; MOST_IN_SERIES];
    let mut is_found = is_linear;
    while search.ways <= MOST_ITERATIONS {
        let mut compliances = [[[0.0; MAX_NODES]; MAX_NODES]; MOST_IN_SERIES];
        let mut forces = [[0.0; MAX_NODES]; MOST_IN_SERIES];
        let mut each = *state;
        let mut stiffest = 0.0f64;
        for (k, part) in parts.iter().enumerate() {
            let mut response = Response::default();
            part.evaluate_part(&inner[k].step(step), &mut each, &mut response);
            forces[k] = response.force;
            let stiffness = &mut compliances[k];
            for i in 0..count {
                for j in 0..count {
                    let through_rates = (0..count).map(|m| response.d_rate[i][m] * inverse[m][j]).sum::<f64>();
                    stiffness[i][j] = response.d_stroke[i][j] + through_rates / step.h;
                    stiffest = stiffest.max(stiffness[i][j].abs());
                }
            }
        }
        if !is_linear && !search.goes_on(&forces[..parts.len()], count, &mut inner) {
            for inner in inner.iter_mut().take(parts.len()) {
                inner.take_rates(nodes, step.h);
            }
            if search.halvings > MOST_HALVINGS {
                is_found = search.change <= NEARLY;
                break;
            }
            continue;
        }
        let floor = (SOFTEST * stiffest).max(f64::MIN_POSITIVE);
        compliances.iter_mut().take(parts.len()).for_each(|matrix| invert(matrix, count, floor));
        let mut whole: Matrix = Default::default();
        let mut right = [0.0; MAX_NODES];
        for i in 0..count {
            let gathered: f64 = inner.iter().take(parts.len()).map(|inner| inner.stroke[i + 1]).sum();
            right[i] = step.stroke[i + 1] - gathered;
            for (matrix, forces) in compliances.iter().zip(&forces).take(parts.len()) {
                for j in 0..count {
                    whole[i][j] += matrix[i][j];
                    right[i] += matrix[i][j] * forces[j];
                }
            }
        }
        invert(&mut whole, count, f64::MIN_POSITIVE);
        tangent = whole;
        let product = |matrix: &Matrix, vector: &[f64; MAX_NODES], i: usize| -> f64 {
            (0..count).map(|j| matrix[i][j] * vector[j]).sum()
        };
        force = std::array::from_fn(|i| product(&tangent, &right, i));
        for (share, matrix) in shares.iter_mut().zip(&compliances) {
            *share = (0..count).map(|j| tangent[count - 1][j] * matrix[j][count - 1]).sum::<f64>().abs();
        }
        let (mut change, mut size) = (0.0f64, step.resolution);
        search.from = inner;
        for (k, matrix) in compliances.iter().enumerate().take(parts.len()) {
            let lacking: [f64; MAX_NODES] = std::array::from_fn(|i| force[i] - forces[k][i]);
            for i in 0..count {
                let delta = product(matrix, &lacking, i);
                inner[k].stroke[i + 1] += delta;
                // Not `max`, which would pass over what is no number.
                change = if delta.abs() > change || delta.is_nan() { delta.abs() } else { change };
                size = size.max(inner[k].stroke[i + 1].abs());
            }
            inner[k].take_rates(nodes, step.h);
        }
        if is_linear {
            break;
        }
        search.change = change / size;
        if search.change <= search.enough() {
            is_found = true;
            break;
        }
    }
    if !is_found {
        force = [f64::NAN; MAX_NODES];
        inner.iter_mut().for_each(|inner| inner.stroke[1..].fill(f64::NAN));
    }
    *state = super::advance(parts, *state);
    Solved { inner, force, tangent, shares }
}

/// A search for the strokes at which nonlinear parts have one force: along Newton's way, in halves where the whole does not bring
/// their forces together.
#[derive(Default)]
struct Search {
    /// Where the way begins.
    from: [Inner; MOST_IN_SERIES],
    /// How far the forces were apart there, N²; none before the first way, on which the strokes begin to add up.
    apart: Option<f64>,
    halvings: usize,
    ways: usize,
    is_rounding: bool,
    /// Change of the strokes on the last whole way, in units of the largest.
    change: f64,
}

impl Search {
    /// Whether forces are nearer each other than where the way began; else `inner` is half as far on it. Far from rounding only: there
    /// nothing brings them nearer.
    fn goes_on(&mut self, forces: &[[f64; MAX_NODES]], count: usize, inner: &mut [Inner; MOST_IN_SERIES]) -> bool {
        let (mut apart, mut size) = (0.0, 0.0);
        for i in 0..count {
            let mean = forces.iter().map(|force| force[i]).sum::<f64>() / forces.len() as f64;
            apart += forces.iter().map(|force| (force[i] - mean).powi(2)).sum::<f64>();
            size += forces.iter().map(|force| force[i].powi(2)).sum::<f64>();
        }
        self.is_rounding = self.ways > 1 && apart <= ROUNDED * size;
        let is_nearer = match self.apart {
            _ if self.ways < 2 => apart.is_finite(),
            Some(before) => apart < before || self.is_rounding,
            None => true,
        };
        if is_nearer {
            (self.apart, self.halvings) = (Some(apart), 0);
            self.ways += 1;
            return true;
        }
        self.halvings += 1;
        for (inner, from) in inner.iter_mut().zip(&self.from) {
            for (stroke, from) in inner.stroke.iter_mut().zip(from.stroke) {
                *stroke = 0.5 * (*stroke + from);
            }
        }
        false
    }

    /// Change at which the search ends: forces that are one but for rounding come no nearer.
    fn enough(&self) -> f64 {
        if self.is_rounding { NEARLY } else { ENOUGH }
    }
}

/// The inverse of the leading `count` rows and columns, by elimination with pivots; a pivot below `floor` counts as that.
fn invert(matrix: &mut Matrix, count: usize, floor: f64) {
    let mut inverse: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs())).unwrap_or(k);
        matrix.swap(k, pivot);
        inverse.swap(k, pivot);
        if matrix[k][k].abs() < floor {
            matrix[k][k] = floor;
        }
        let scale = matrix[k][k].recip();
        (matrix[k], inverse[k]) = (matrix[k].map(|x| x * scale), inverse[k].map(|x| x * scale));
        for i in (0..count).filter(|&i| i != k) {
            let factor = matrix[i][k];
            for j in 0..count {
                matrix[i][j] -= factor * matrix[k][j];
                inverse[i][j] -= factor * inverse[k][j];
            }
        }
    }
    *matrix = inverse;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_undo() {
        let matrix: Matrix =
            [[1e-3, 2.0, 0.5, 0.1], [3.0, -1.0, 2.0, 0.7], [0.1, 0.2, 5.0, -2.0], [0.4, 0.3, -0.2, 1.0]];
        for count in 1..=MAX_NODES {
            let mut inverse = matrix;
            invert(&mut inverse, count, f64::MIN_POSITIVE);
            for i in 0..count {
                for j in 0..count {
                    let product: f64 = (0..count).map(|k| matrix[i][k] * inverse[k][j]).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12, "{count}: {product}");
                }
            }
        }
    }
}
