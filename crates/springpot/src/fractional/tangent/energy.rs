//! The derivative of what a springpot stores and dissipates.

use super::columns::add;
use super::ports::{DISSIPATED, STORED, Weights, key};
use super::{MemoryTangent, TangentPoint, TangentStep};
use crate::collocation::Nodes;
use crate::fractional::exponentials::moments;
use crate::fractional::history::{History, Squares};
use crate::fractional::lanes::{LANES, sum};
use crate::fractional::memory::{Memory, StepStart};
use crate::fractional::step::{CUBIC, Form, RatePolynomial, SEXTIC};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};

/// The derivative of [`crate::fractional::Energy`], P numbers each.
#[derive(Debug)]
pub struct EnergyTangent<'a> {
    /// ∂/∂θ of what is stored.
    pub stored: &'a mut [f64],
    /// ∂/∂θ of the rate of dissipation; infinite at the time of a jump.
    pub dissipation: &'a mut [f64],
}

impl EnergyTangent<'_> {
    fn rows(&mut self) -> [&mut [f64]; 2] {
        [&mut *self.stored, &mut *self.dissipation]
    }
}

/// What both forms have of δu_p and of δα.
#[derive(Default)]
struct Grown {
    by_u: [[f64; SEXTIC]; 2],
    by_order: [f64; 2],
}

/// What both forms have of δz and of δu_p of the last piece, where columns stand for these.
#[derive(Default)]
struct OfPast {
    modes: [Vec<f64>; 2],
    piece: [[f64; SEXTIC]; 2],
}

impl MemoryTangent {
    /// The derivative of [`Memory::energy`] at θ, 0 ≤ θ ≤ 1, whose kinematics are those of `point`.
    ///
    /// With Z_k = e^{−λ_k θh} z_k + θh Σ_p u_p θ^p ψ_p(λ_k θh): δψ = Σ w Z δZ + d2 x' δx' + ½δα(Σ ẇ Z² + ḋ2 x'²), and likewise the rate of
    /// dissipation with λ and all of d1, d2, d3.
    pub fn energy(
        &self,
        memory: &Memory,
        step: &TangentStep,
        theta: f64,
        point: &TangentPoint,
        delta_u: &[f64],
        out: &mut EnergyTangent,
    ) {
        out.stored.fill(0.0);
        out.dissipation.fill(0.0);
        let Some(past) = memory.past() else { return self.energy_at_limit(memory, point, out) };
        if theta == 0.0 && past.is_empty() {
            return;
        }
        let polynomial = &step.polynomial;
        let longer = if polynomial.h > 0.0 { past.extended(Nodes::Radau.positions()[0] * polynomial.h) } else { None };
        let mut of_past = self.ports.as_ref().filter(|ports| !ports.has_no_sums()).map(|_| OfPast::default());
        let grown = match step.coefficients() {
            CUBIC => self.add_modes::<CUBIC>(past, polynomial, theta, &mut of_past, out.rows()),
            _ => self.add_modes::<SEXTIC>(past, polynomial, theta, &mut of_past, out.rows()),
        };
        self.add_grown(&grown, theta, delta_u, out.rows());
        if let Some(longer) = &longer {
            let front = longer.kernel().modes() - past.kernel().modes();
            self.add_front(longer, front, (polynomial, theta), delta_u, &mut of_past, out.rows());
        }
        self.add_told(past, of_past, (theta, polynomial.h), out.rows());
        let settled = longer.as_ref().unwrap_or(past);
        let stored_by = if theta == 0.0 { past } else { settled };
        self.add_settled([stored_by, settled], polynomial, theta, point, delta_u, out.rows());
        self.add_jumps(past, step, theta, point, out.rows());
    }

    /// The derivative of [`Memory::stored`] at t, between two steps, and of the rate of dissipation there.
    pub fn energy_now(&self, memory: &Memory, t: f64, point: &TangentPoint, out: &mut EnergyTangent) {
        let start = StepStart { t, h: 0.0, stroke: point.stroke, rate: point.rate };
        let polynomial = RatePolynomial::NONE;
        let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
        self.energy(memory, &step, 0.0, point, &[], out);
    }

    fn energy_at_limit(&self, memory: &Memory, point: &TangentPoint, out: &mut EnergyTangent) {
        if memory.alpha() == 0.0 {
            self.limit(memory, point.delta_stroke, point.delta_rate, out.stored);
            out.stored.iter_mut().for_each(|stored| *stored *= point.stroke - memory.held());
        } else {
            add(out.dissipation, 2.0 * point.rate, point.delta_rate);
        }
    }

    /// The modes that are kept, with what moves by δz added.
    fn add_modes<const N: usize>(
        &self,
        past: &History,
        step: &RatePolynomial,
        theta: f64,
        of_past: &mut Option<OfPast>,
        [stored, dissipation]: [&mut [f64]; 2],
    ) -> Grown {
        let lag = theta * step.h;
        let at = past.lag_of(lag, N);
        let scaled = scaled(step, theta);
        let mut grown = Grown::default();
        dispatch!(Level::new(), simd => {
            let (mut by_u, mut by_order) = ([[f64x8::splat(simd, 0.0); N]; 2], [f64x8::splat(simd, 0.0); 2]);
            let mut seen = 0;
            let mut weights = inlined(#[inline(always)] |k| {
                let [lambda, weight, z] = past.block(simd, k);
                let (decay, psi): (_, [_; N]) = at.moments(simd, k);
                let value = mode(z, decay, psi, &scaled, lag);
                let stored = weight * value;
                let forms = [stored, stored * lambda * 2.0];
                // Many parameters ask for a block again.
                if k == seen {
                    seen += 1;
                    for q in 0..2 {
                        let grown = forms[q] * lag;
                        for p in 0..N {
                            by_u[q][p] += grown * psi[p];
                        }
                        if let Some(order) = &self.by_order {
                            by_order[q] += forms[q] * value * order.ratio(simd, k) * 0.5;
                        }
                    }
                }
                [forms[0] * decay, forms[1] * decay]
            });
            match of_past {
                None => self.modes.contract(simd, weights, [&mut *stored, &mut *dissipation]),
                Some(OfPast { modes, .. }) => {
                    for k in 0..past.blocks() {
                        for (modes, block) in modes.iter_mut().zip(weights(k)) {
                            let mut own = [0.0; LANES];
                            block.store_array(&mut own);
                            modes.extend(own);
                        }
                    }
                    modes.iter_mut().for_each(|modes| modes.truncate(past.kernel().modes()));
                }
            }
            for q in 0..2 {
                for p in 0..N {
                    grown.by_u[q][p] = sum(by_u[q][p]);
                }
                grown.by_order[q] = sum(by_order[q]);
            }
        });
        if let Some(order) = &self.by_order {
            let Squares { weighted, with_rates } = order.slow.squares(lag, &scaled);
            grown.by_order[0] += 0.5 * weighted;
            grown.by_order[1] += with_rates;
        }
        grown
    }

    fn add_grown(&self, grown: &Grown, theta: f64, delta_u: &[f64], [stored, dissipation]: [&mut [f64]; 2]) {
        for (q, out) in [stored, dissipation].into_iter().enumerate() {
            // At the start of a step nothing of it has grown.
            let mut power = 1.0;
            for (by_u, row) in
                grown.by_u[q].iter().zip(delta_u.chunks_exact(self.parameters.max(1))).take_while(|_| theta > 0.0)
            {
                add(out, power * by_u, row);
                power *= theta;
            }
            add(out, grown.by_order[q], &self.alpha);
        }
    }

    /// The `front` fastest modes of a history, which the memory makes for short steps alone; they have seen the last piece.
    fn add_front(
        &self,
        longer: &History,
        front: usize,
        (step, theta): (&RatePolynomial, f64),
        delta_u: &[f64],
        of_past: &mut Option<OfPast>,
        out: [&mut [f64]; 2],
    ) {
        let (lag, scaled, coefficients) = (theta * step.h, scaled(step, theta), delta_u.len() / self.parameters.max(1));
        let (mut grown, mut by_last) = (Grown::default(), [[0.0; SEXTIC]; 2]);
        let kernel = longer.kernel();
        for k in 0..front {
            let (lambda, weight) = (kernel.lambda[k], kernel.weight[k]);
            let mut psi = [0.0; SEXTIC];
            moments(lambda * lag, &mut psi[..coefficients]);
            let decay = (-lambda * lag).exp();
            let taken: f64 = scaled.iter().zip(psi).map(|(y, psi)| y * psi).sum();
            let value = decay * longer.fast_mode(lambda) + lag * taken;
            // What is stored at the start of a step was stored without them.
            let stored = if theta == 0.0 { 0.0 } else { weight * value };
            for (q, form) in [stored, 2.0 * weight * lambda * value].into_iter().enumerate() {
                let last = longer.fast_moments(lambda, self.piece.rows());
                for p in 0..SEXTIC {
                    grown.by_u[q][p] += form * lag * psi[p];
                    by_last[q][p] += form * decay * last[p];
                }
                if let Some(order) = &self.by_order {
                    grown.by_order[q] += 0.5 * value * order.weight(lambda, form);
                }
            }
        }
        let [stored, dissipation] = out;
        match of_past {
            Some(of_past) => of_past.piece = by_last,
            None => {
                for (by_last, out) in by_last.iter().zip([&mut *stored, &mut *dissipation]) {
                    (0..self.piece.rows()).for_each(|p| add(out, by_last[p], self.piece.row(p)));
                }
            }
        }
        self.add_grown(&grown, theta, delta_u, [stored, dissipation]);
    }

    /// What the past is told by columns for: no number where they have no room.
    fn add_told(&self, past: &History, told: Option<OfPast>, (theta, h): (f64, f64), out: [&mut [f64]; 2]) {
        let Some(ports) = self.ports.as_ref().filter(|_| !past.is_empty()) else { return };
        let OfPast { modes: [first, second], piece: [of_first, of_second] } = told.unwrap_or_default();
        let sums = [(STORED, first, of_first), (DISSIPATED, second, of_second)];
        for (out, (which, modes, piece)) in out.into_iter().zip(sums) {
            match ports.column_of_sum(key(which, theta * h, h), || {
                let piece = piece[..self.piece.rows()].to_vec();
                Weights { modes, piece }
            }) {
                Some(column) => out[column] += 1.0,
                None => out.fill(f64::NAN),
            }
        }
    }

    /// What is faster than the modes of a history, one for what is stored and one for the dissipation.
    fn add_settled(
        &self,
        pasts: [&History; 2],
        step: &RatePolynomial,
        theta: f64,
        point: &TangentPoint,
        delta_u: &[f64],
        [stored, dissipation]: [&mut [f64]; 2],
    ) {
        let (rate, bend) = (point.rate, step.bend(theta));
        let [[_, inertia, _], [d1, d2, d3]] = pasts.map(History::fast_tail);
        add(stored, inertia * rate, point.delta_rate);
        add(dissipation, 2.0 * (d1 * rate - d2 * bend), point.delta_rate);
        let by_bend = 2.0 * (d3 * bend - d2 * rate);
        if step.h > 0.0 {
            let mut power = by_bend / step.h;
            for (p, row) in delta_u.chunks_exact(self.parameters.max(1)).enumerate().skip(1) {
                add(dissipation, p as f64 * power, row);
                power *= theta;
            }
        }
        if let Some(order) = &self.by_order {
            let [[_, inertia, _], [d1, d2, d3]] = pasts.map(|past| order.fast_tail(past));
            add(stored, 0.5 * inertia * rate * rate, &self.alpha);
            add(dissipation, rate * (d1 * rate - 2.0 * d2 * bend) + d3 * bend * bend, &self.alpha);
        }
    }

    /// Jumps that are not in the modes, each as j e^{−λ·age} in δz.
    fn add_jumps(
        &self,
        past: &History,
        step: &TangentStep,
        theta: f64,
        point: &TangentPoint,
        [stored, dissipation]: [&mut [f64]; 2],
    ) {
        let polynomial = &step.polynomial;
        let (lag, scaled, bend) = (theta * polynomial.h, scaled(polynomial, theta), polynomial.bend(theta));
        for jump in &self.jumps {
            let age = step.start.t + lag - jump.t;
            let (at, since) = (past.lag_of(lag, SEXTIC), past.lag(age));
            let [mut plain, mut rated] = dispatch!(Level::new(), simd => {
                let mut totals = [f64x8::splat(simd, 0.0); 2];
                for k in 0..past.blocks() {
                    let [lambda, _, z] = past.block(simd, k);
                    let (decay, psi): (_, [_; SEXTIC]) = at.moments(simd, k);
                    let value = since.weighted(simd, k) * mode(z, decay, psi, &scaled, lag);
                    totals[0] += value;
                    totals[1] += value * lambda * 2.0;
                }
                [sum(totals[0]), sum(totals[1])]
            });
            if age == 0.0 {
                let [d1, d2, _] = past.fast_tail();
                plain += d1 * point.rate - d2 * bend;
                rated = if point.rate == 0.0 { rated } else { f64::INFINITY.copysign(point.rate) };
            } else {
                for k in 1..=past.kernel().missing(age) {
                    let (lambda, weight) = past.kernel().faster(k);
                    let settled = weight * (-lambda * age).exp() * (point.rate - bend / lambda);
                    plain += settled / lambda;
                    rated += 2.0 * settled;
                }
            }
            jump.add(plain, stored);
            jump.add(rated, dissipation);
        }
    }
}

/// A closure as it is, whose attributes have a place only where it is told.
#[inline(always)]
fn inlined<I, O, F: FnMut(I) -> O>(closure: F) -> F {
    closure
}

/// u_p θ^p.
fn scaled(step: &RatePolynomial, theta: f64) -> [f64; SEXTIC] {
    let mut power = 1.0;
    step.u.map(|u| {
        let coefficient = power * u;
        power *= theta;
        coefficient
    })
}

/// A block of modes at the lag, whose moments are `decay` and `psi`.
#[inline(always)]
fn mode<S: Simd, const N: usize>(
    z: f64x8<S>,
    decay: f64x8<S>,
    psi: [f64x8<S>; N],
    y: &[f64; SEXTIC],
    lag: f64,
) -> f64x8<S> {
    let mut grown = psi[0] * y[0];
    for p in 1..N {
        grown += psi[p] * y[p];
    }
    decay * z + grown * lag
}
