//! What a step and its rows ask of the derivative of a memory.

use super::columns::add;
use super::order::{ByOrder, local_moments};
use super::ports::{MEAN, Weights, key};
use super::{MemoryTangent, TangentPoint, TangentStep};
use crate::collocation::{NODE_POLYNOMIAL, Nodes};
use crate::fractional::history::History;
use crate::fractional::kind::Kind;
use crate::fractional::memory::{Memory, NEXT_TO_NODE};
use crate::fractional::step::{CUBIC, Form, SEXTIC};
use fearless_simd::{Level, dispatch};

/// What stands for parts of D^α x that are infinite at a time at or before the start of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singular {
    /// Moments, as [`Memory::singular_moments`]: for motions that follow from forces.
    Moments,
    /// Values at the nodes, as [`Memory::singular_part`]: along a given motion.
    Values,
    /// Nothing.
    Apart,
}

impl MemoryTangent {
    /// What D^α x moves by at the nodes where strokes and rates at the nodes themselves are held, s rows of P; `start` is the place where
    /// the step begins.
    ///
    /// Like [`Memory::respond`], with what `singular` says for singular parts. With [`Nodes::Midpoint`] of the mean over the step.
    pub fn explicit(
        &self,
        memory: &Memory,
        step: &TangentStep,
        singular: Singular,
        start: &TangentPoint,
        out: &mut [f64],
    ) {
        out.fill(0.0);
        let count = step.nodes.count();
        if memory.alpha() == 0.0 {
            if memory.kind() == Kind::Caputo {
                (0..count).for_each(|i| add(self.row(out, i), -1.0, &self.origin));
            }
            return;
        }
        let both = memory.both(step.form, step.places);
        for i in 0..count {
            let (h, local) = (step.start.h, memory.local());
            match (step.form, step.places) {
                (Form::Strokes, places) => {
                    let factors = match places {
                        None => local.stroke_row(h, i, step.nodes),
                        Some(places) => local.stroke_row_at(h, i, places),
                    };
                    add(self.row(out, i), -factors.iter().sum::<f64>(), start.delta_stroke);
                }
                // x' itself.
                (Form::Rates | Form::Hermite, _) if !memory.is_fractional() => {}
                (Form::Hermite, _) => {
                    let Some(both) = &both else { continue };
                    let (rates, strokes) = local.rows_of_both(both, h, i);
                    add(self.row(out, i), rates[0], start.delta_rate);
                    add(self.row(out, i), -strokes.iter().sum::<f64>(), start.delta_stroke);
                }
                (Form::Rates, places) => {
                    let factors = match places {
                        None => local.rate_row(h, i, step.nodes),
                        Some(places) => local.rate_row_at(h, i, places),
                    };
                    add(self.row(out, i), factors[0], start.delta_rate);
                }
            }
        }
        let Some(past) = memory.past() else { return };
        self.add_past(past, step, out);
        if let Some(by_order) = &self.by_order {
            for i in 0..count {
                add(self.row(out, i), by_order_at_node(by_order, memory, past, step, i), &self.alpha);
            }
        }
        self.add_singular(memory, step, singular, out);
    }

    fn row<'a>(&self, out: &'a mut [f64], i: usize) -> &'a mut [f64] {
        &mut out[i * self.parameters..][..self.parameters]
    }

    /// Adds what the past moves by at the nodes.
    fn add_past(&self, past: &History, step: &TangentStep, out: &mut [f64]) {
        let lag = |i: usize| step.positions()[i] * step.start.h;
        match step.nodes {
            Nodes::One => self.add_histories(past, [lag(0)], out),
            Nodes::Midpoint => self.add_mean_history(past, step.start.h, out),
            Nodes::Radau => self.add_histories::<3>(past, std::array::from_fn(lag), out),
            Nodes::Inner => self.add_histories::<4>(past, std::array::from_fn(lag), out),
        }
    }

    fn add_mean_history(&self, past: &History, h: f64, out: &mut [f64]) {
        if past.is_empty() && !self.is_recalled {
            return;
        }
        let at = past.lag(h);
        let [_, d2, _] = past.fast_tail();
        if let Some(ports) = &self.ports {
            let weights = || {
                let [psi, ..]: [_; CUBIC] = past.moments(h).1;
                let modes = past.kernel().weight.iter().zip(psi).map(|(weight, psi)| weight * psi).collect();
                Weights { modes, piece: vec![d2 / h; CUBIC] }
            };
            match ports.column_of_sum(key(MEAN, h, h), weights) {
                Some(column) => out[column] += 1.0,
                None => out.fill(f64::NAN),
            }
            return;
        }
        dispatch!(Level::new(), simd => self.modes.contract(
            simd,
            #[inline(always)]
            |k| {
                let [_, weight, _] = past.block(simd, k);
                let (_, [psi, ..]): (_, [_; CUBIC]) = at.moments(simd, k);
                [weight * psi]
            },
            [&mut *out],
        ));
        (0..self.piece.rows()).for_each(|p| add(out, d2 / h, self.piece.row(p)));
    }

    /// The derivative of D^α x without singular parts at θ, 0 < θ ≤ 1, whose kinematics are those of `point`; `delta_u` is that of the
    /// coefficients u_p of the step, as many rows of P.
    ///
    /// It is that of [`Memory::derivative_between`] inside a step of rates at Radau nodes, else of [`Memory::regular_derivative`].
    pub fn at(
        &self,
        memory: &Memory,
        step: &TangentStep,
        theta: f64,
        point: &TangentPoint,
        delta_u: &[f64],
        out: &mut [f64],
    ) {
        let Some(past) = memory.past() else { return self.limit(memory, point.delta_stroke, point.delta_rate, out) };
        let (u, h, lag) = (&step.polynomial, step.polynomial.h, theta * step.polynomial.h);
        out.fill(0.0);
        let mut moments = local_moments(memory.local(), h, theta);
        let mut by_order = self
            .by_order
            .as_ref()
            .map(|by_order| (by_order.local_moments(memory.local(), h, theta), by_order.history(past, lag)));
        let is_between = step.form == Form::Rates && step.nodes == Nodes::Radau && theta < 1.0;
        if is_between {
            // The exact x' at θ weighs as the node polynomial says, and the cubic that much less.
            let nodes = step.places.map_or(NODE_POLYNOMIAL, |places| places.node_polynomial());
            let node = nodes.iter().rev().fold(0.0, |sum, c| sum * theta + c);
            let weight = node / (node * node + NEXT_TO_NODE);
            let between = |moments: &[f64]| weight * nodes.iter().zip(moments).map(|(n, m)| n * m).sum::<f64>();
            let shift = |moments: &mut [f64; SEXTIC]| {
                let between = between(moments);
                let mut power = 1.0;
                for moment in &mut moments[..CUBIC] {
                    *moment -= between * power;
                    power *= theta;
                }
                between
            };
            add(out, shift(&mut moments), point.delta_rate);
            if let Some((local, history)) = &mut by_order {
                *history += shift(local) * point.rate;
            }
        }
        moments
            .into_iter()
            .zip(delta_u.chunks_exact(self.parameters.max(1)))
            .for_each(|(moment, row)| add(out, moment, row));
        self.add_histories(past, [lag], out);
        if let Some((local, history)) = by_order {
            let moved: f64 = u.u.iter().zip(local).map(|(u, moment)| u * moment).sum();
            add(out, moved + history, &self.alpha);
        }
    }
}

/// ∂D^α x/∂α at node i.
fn by_order_at_node(by_order: &ByOrder, memory: &Memory, past: &History, step: &TangentStep, i: usize) -> f64 {
    let (h, local) = (step.start.h, memory.local());
    match step.nodes {
        Nodes::Midpoint => {
            let mean = local.rate_row(h, i, Nodes::Midpoint)[1];
            by_order.mean_local(mean, h) * step.polynomial.u[0] + by_order.mean_history(past, h)
        }
        Nodes::One | Nodes::Radau | Nodes::Inner => {
            let c = step.positions()[i];
            by_order.local(local, &step.polynomial, c) + by_order.history(past, c * h)
        }
    }
}
