//! The derivative of a [`Memory`] by parameters: of D^alpha x, its energies and all that a step adds to it.
//!
//! With steps, nodes and kernel held, a memory is a linear map of x', so that its derivative by any number θ of which x depends is the
//! same memory of δx' = ∂x'/∂θ: P parameters are P columns beside each mode, which share every exponential with it,
//!
//! δz_k ← e^{−X} δz_k + h Σ_p δu_p ψ_p(X), X = λ_k h.
//!
//! What begins elsewhere are the explicit parts of a step, δD_i = Σ_j stroke_ij (δx_j − δx_0) + Σ_j rate_ij δx'_j + explicit_i
//! ([`MemoryTangent::explicit`]), where the factors are those of [`Memory::respond`]. Where θ moves the order itself, by δα = ∂α/∂θ,
//!
//! explicit_i = … + δα [Σ_p ∂_αL_ip u_p + Σ_k ẇ_k e^{−λ_k c_i h} z_k + x(0) ∂_ασ_i],
//!
//! L_ip = h^{1−α} c_i^{p+1−α} p!/Γ(p+2−α), ∂_αL_ip = L_ip (ψ(p+2−α) − ln c_i h), h in s. The weights ẇ of
//! k_α = t^−α/Γ(1−α)·(ψ(1−α) − ln t) have both signs and need more nodes in the slow tail than those of the kernel: that tail is a
//! history of its own here, and a memory has the same bits whether it is differentiated or not. Coefficients with s^α in their unit are
//! held as numbers in SI units.
//!
//! So differentiated, with the sizes of accepted steps held, a run has the derivatives of its own numbers and not only those that it comes
//! near to: internal differentiation (H. G. Bock, Springer Ser. Chem. Phys. 18 (1981) 102–125). What a kernel errs by, ε, ∂/∂α errs by
//! times |ψ(1−α) − ln t|, and by 0.6 ε/α more. Orders of 0 and 1 keep no past and are no parameters.
//!
//! ```
//! use springpot::collocation::{Nodes, RADAU_NODES};
//! use springpot::fractional::{Form, Kind, Memory, MemoryTangent, RatePolynomial, StepStart, TangentSeeds, TangentStep};
//!
//! // D^α of x = a t², by α and by a = 1, at t = 1.
//! let mut memory = Memory::new(0.5, Kind::Caputo, 0.0, 0.0, 1e-11, 1e-3, 1.0)?;
//! let seeds = TangentSeeds { alpha: &[1.0, 0.0], origin: &[0.0; 2], jump: &[0.0; 2] };
//! let mut tangent = MemoryTangent::new(&memory, &seeds)?;
//! for k in 0..10 {
//!     let (t, h) = (0.1 * k as f64, 0.1);
//!     let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| 2.0 * (t + c * h)).collect();
//!     let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &rates);
//!     let start = StepStart { t, h, stroke: t * t, rate: 2.0 * t };
//!     let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
//!     // α moves no stroke, a moves all of them.
//!     let delta_u: Vec<f64> = polynomial.u.iter().flat_map(|u| [0.0, *u]).collect();
//!     tangent.commit(&memory, &step, &delta_u, None);
//!     memory.commit(&polynomial);
//! }
//! let mut found = [0.0; 2];
//! tangent.now(&memory, &[0.0; 2], &[0.0; 2], &mut found);
//! // D^α t² = 2 t^{2−α}/Γ(3−α), at t = 1 with the derivative 2ψ(3−α)/Γ(3−α) by α; ψ(5/2) = 8/3 − γ − 2 ln 2.
//! let value = 8.0 / (3.0 * std::f64::consts::PI.sqrt());
//! assert!((found[0] - value * (8.0 / 3.0 - 0.577_215_664_901_532_9 - 4f64.ln())).abs() < 1e-9);
//! assert!((found[1] - value).abs() < 1e-9);
//! # Ok::<(), springpot::fractional::KernelError>(())
//! ```

mod adjoint;
mod ask;
mod columns;
mod commit;
mod energy;
mod jump;
mod order;
mod ports;
mod state;
#[cfg(test)]
mod tests;

pub(crate) use adjoint::{MemoryAdjoint, OfStep, PastOfStep};
pub use ask::Singular;
pub use commit::TangentEnd;
pub use energy::EnergyTangent;
pub(crate) use ports::{PortColumns, Told};

use super::history::History;
use super::kernel::KernelError;
use super::kind::Kind;
use super::memory::{Memory, StepStart};
use super::step::{CUBIC, Form, RatePolynomial, SEXTIC};
use crate::collocation::{Gaps, MAX_NODES, Nodes, Places, TABLEAU};
use crate::linalg::columns::put;
use columns::{Columns, add, rows};
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f64x8};
use jump::Jump;
use order::ByOrder;
use ports::Ports;
use serde::{Deserialize, Serialize};

/// What P parameters move of a memory at t = 0, P numbers each.
#[derive(Debug, Clone, Copy)]
pub struct TangentSeeds<'a> {
    /// ∂α/∂θ.
    pub alpha: &'a [f64],
    /// ∂x(0)/∂θ.
    pub origin: &'a [f64],
    /// The same where a Riemann–Liouville start counts as singular, also from x(0) = 0; 0 elsewhere.
    pub jump: &'a [f64],
}

/// A step as a memory and its derivative see it.
#[derive(Debug, Clone, Copy)]
pub struct TangentStep<'a> {
    /// Where it begins.
    pub start: StepStart,
    /// Its nodes.
    pub nodes: Nodes,
    /// The three nodes where they are elsewhere; what moves them is not differentiated.
    pub places: Option<&'a Places>,
    /// What its polynomial goes through.
    pub form: Form,
    /// x' over the step.
    pub polynomial: RatePolynomial,
}

/// A place in a step: x and x' there, and their derivatives, P numbers each.
#[derive(Debug, Clone, Copy)]
pub struct TangentPoint<'a> {
    /// x.
    pub stroke: f64,
    /// x'.
    pub rate: f64,
    /// ∂x/∂θ.
    pub delta_stroke: &'a [f64],
    /// ∂x'/∂θ.
    pub delta_rate: &'a [f64],
}

impl TangentStep<'_> {
    fn positions(&self) -> &[f64] {
        self.places.map_or(self.nodes.positions(), |places| places.positions())
    }

    /// How many coefficients its polynomial has: 7 with [`Form::Hermite`], else 4.
    pub fn coefficients(&self) -> usize {
        self.form.coefficients()
    }

    /// The derivative of the coefficients u_p of its polynomial, as many rows of P, from those of strokes and rates at 0 and at the nodes, s + 1 rows of P each.
    pub fn delta_polynomial(&self, delta_stroke: &[f64], delta_rate: &[f64], out: &mut [f64]) {
        let parameters = out.len() / self.coefficients();
        if self.form == Form::Hermite {
            // What the strokes tell beside the rates is a small difference.
            let of = (self.places, &Gaps::at(self.places));
            for j in 0..parameters {
                let [stroke, rate] =
                    [delta_stroke, delta_rate].map(|all| [0, 1, 2, 3].map(|k| all[k * parameters + j]));
                let RatePolynomial { u, .. } = RatePolynomial::through_both(self.start.h, of, [&stroke, &rate]);
                out[j..].iter_mut().step_by(parameters).zip(u).for_each(|(out, u)| *out = u);
            }
            return;
        }
        if (self.form, self.nodes, self.places) == (Form::Rates, Nodes::Radau, None) {
            let rates = [0, 1, 2, 3].map(|k| &delta_rate[k * parameters..(k + 1) * parameters]);
            let lines = out.chunks_exact_mut(parameters.max(1)).zip(&TABLEAU.rates);
            lines.for_each(|(out, line)| put(out, *line, rates));
            return;
        }
        out.fill(0.0);
        let data = if self.form == Form::Rates { delta_rate } else { delta_stroke };
        for (k, data) in data.chunks_exact(parameters.max(1)).enumerate().take(self.nodes.count() + 1) {
            let mut unit = [0.0; MAX_NODES + 1];
            unit[k] = 1.0;
            let (values, h) = (&unit[..=self.nodes.count()], self.start.h);
            let column = match (self.form, self.places) {
                (Form::Strokes, None) => RatePolynomial::through_strokes(h, self.nodes, values),
                (Form::Strokes, Some(places)) => RatePolynomial::through_strokes_at(h, places, values),
                (_, None) => RatePolynomial::through_rates(h, self.nodes, values),
                (_, Some(places)) => RatePolynomial::through_rates_at(h, places, values),
            };
            for (out, factor) in out.chunks_exact_mut(parameters.max(1)).zip(column.u) {
                if factor != 0.0 {
                    add(out, factor, data);
                }
            }
        }
    }
}

/// The derivative of one [`Memory`] by P parameters.
///
/// Ask it and commit it before the memory commits the same step. Matrices of several rows have P numbers in a row; δ is ∂/∂θ, so that
/// with x in m, t in s and θ in any unit \[θ\], δD^α x is in m/s^α/\[θ\]. Finite for 0 ≤ α ≤ 1 but at t = 0 of a singular start and at the time
/// of a jump.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MemoryTangent {
    parameters: usize,
    /// ∂α/∂θ.
    alpha: Vec<f64>,
    /// δx(0).
    origin: Vec<f64>,
    /// δ of what the modes have seen of the stroke.
    travelled: Vec<f64>,
    /// δD^α x after the last committed step without singular parts.
    now: Vec<f64>,
    /// In the place of it.
    told: Option<Vec<f64>>,
    /// Shares of the stroke that jumped.
    jumps: Vec<Jump>,
    /// δz.
    modes: Columns,
    /// δu_p of the last piece.
    piece: Columns,
    /// Where α moves.
    by_order: Option<ByOrder>,
    /// Whether the modes begin with a past, be that of the memory none.
    is_recalled: bool,
    /// Columns that stand for its past, where it is to be told what that does.
    #[serde(skip)]
    ports: Option<Ports>,
}

impl MemoryTangent {
    /// The derivative of a memory at t = 0.
    ///
    /// One that has no kernel yet knows what holds there, [`Self::now`] and [`Self::singular_part`]; see [`Self::open`].
    ///
    /// # Errors
    /// [`KernelError::Order`] where α is a parameter and 0 or 1: the derivative by it is finite there, but asks for a memory that such an
    /// order does not have.
    ///
    /// # Panics
    /// Where the seeds are not as many as each other, and where α is a parameter of a memory whose longest steps have dropped slow modes.
    pub fn new(memory: &Memory, seeds: &TangentSeeds) -> Result<Self, KernelError> {
        let parameters = seeds.alpha.len();
        assert!(seeds.origin.len() == parameters && seeds.jump.len() == parameters, "P numbers of every seed");
        if !memory.is_fractional() && seeds.alpha.iter().any(|alpha| *alpha != 0.0) {
            return Err(KernelError::Order(memory.alpha()));
        }
        let mut tangent = Self {
            parameters,
            alpha: seeds.alpha.to_vec(),
            origin: seeds.origin.to_vec(),
            travelled: vec![0.0; parameters],
            now: vec![0.0; parameters],
            told: None,
            jumps: Vec::new(),
            modes: Columns::new(parameters, 0),
            piece: Columns::new(parameters, CUBIC),
            by_order: None,
            is_recalled: false,
            ports: None,
        };
        tangent.jump_at_start(memory, seeds.jump);
        tangent.open(memory);
        Ok(tangent)
    }

    /// At t = 0, x(0) changes by `origin`, P numbers: of a Riemann–Liouville start all of it jumps there.
    pub fn begin(&mut self, memory: &Memory, origin: &[f64]) {
        self.origin.copy_from_slice(origin);
        self.jumps.clear();
        self.jump_at_start(memory, origin);
    }

    /// What of x jumps at t = 0 changes by so much.
    fn jump_at_start(&mut self, memory: &Memory, jump: &[f64]) {
        let is_singular = memory.is_fractional() && memory.kind() == Kind::RiemannLiouville;
        if is_singular && jump.iter().any(|jump| *jump != 0.0) {
            self.jumps.push(Jump::of_start(jump));
        }
    }

    /// Makes the columns of a memory that has a kernel, where there are none yet.
    pub fn open(&mut self, memory: &Memory) {
        let Some(past) = memory.past() else { return };
        if self.is_open() {
            return;
        }
        self.modes = Columns::new(self.parameters, past.kernel().modes());
        if self.alpha.iter().any(|alpha| *alpha != 0.0) {
            self.by_order = Some(ByOrder::of(past.kernel()));
        }
    }

    fn is_open(&self) -> bool {
        self.modes.rows() > 0 || self.by_order.is_some()
    }

    /// ∂α/∂θ, P numbers.
    pub(crate) fn of_order(&self) -> &[f64] {
        &self.alpha
    }

    /// Number of parameters P.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// From now on [`Self::now`] is what was found by other means, P numbers: the derivative of [`Memory::tell`].
    pub fn tell(&mut self, delta: &[f64]) {
        self.told.get_or_insert_with(|| vec![0.0; delta.len()]).copy_from_slice(delta);
    }

    /// The derivative of [`Memory::now`], where those of x and x' are `delta_stroke` and `delta_rate`.
    pub fn now(&self, memory: &Memory, delta_stroke: &[f64], delta_rate: &[f64], out: &mut [f64]) {
        match &self.told {
            Some(told) => out.copy_from_slice(told),
            None if memory.is_fractional() => out.copy_from_slice(&self.now),
            None => self.limit(memory, delta_stroke, delta_rate, out),
        }
    }

    /// The derivative of D^α x at α = 0 and 1.
    fn limit(&self, memory: &Memory, delta_stroke: &[f64], delta_rate: &[f64], out: &mut [f64]) {
        if memory.alpha() == 1.0 {
            out.copy_from_slice(delta_rate);
            return;
        }
        out.copy_from_slice(delta_stroke);
        if memory.kind() == Kind::Caputo {
            add(out, -1.0, &self.origin);
        }
    }

    /// Adds what Σ_k w_k e^{−λ_k τ} z_k moves with its z, at Q lags, Q rows of P.
    fn add_histories<const Q: usize>(&self, past: &History, lags: [f64; Q], out: &mut [f64]) {
        if past.is_empty() && !self.is_recalled {
            return;
        }
        if let Some(ports) = &self.ports {
            for (row, lag) in out.chunks_exact_mut(self.parameters).zip(lags) {
                // Without room for it nothing of it is known.
                match ports.column(lag) {
                    Some(column) => row[column] += 1.0,
                    None => row.fill(f64::NAN),
                }
            }
            return;
        }
        let at = lags.map(|lag| past.lag(lag));
        let rows = rows::<Q>(out);
        dispatch!(Level::new(), simd => self.modes.contract(
            simd,
            #[inline(always)]
            |k| {
                let mut factors = [f64x8::splat(simd, 0.0); Q];
                for q in 0..Q {
                    factors[q] = at[q].weighted(simd, k);
                }
                factors
            },
            rows,
        ));
        for (q, lag) in lags.into_iter().enumerate() {
            if past.kernel().missing(lag) > 0 && !past.is_empty() {
                self.add_missing(past, lag, &mut out[q * self.parameters..][..self.parameters]);
            }
        }
    }

    /// The same of the modes in front of the kernel, which know the last piece alone.
    fn add_missing(&self, past: &History, lag: f64, out: &mut [f64]) {
        let mut factors = [0.0; SEXTIC];
        for k in 1..=past.kernel().missing(lag) {
            let (lambda, weight) = past.kernel().faster(k);
            let share = weight * (-lambda * lag).exp();
            factors
                .iter_mut()
                .zip(past.fast_moments(lambda, self.piece.rows()))
                .for_each(|(factor, moment)| *factor += share * moment);
        }
        (0..self.piece.rows()).for_each(|p| add(out, factors[p], self.piece.row(p)));
    }

    /// Puts the derivative of a past before the first step, after [`Memory`] was given that past: z of modes as a function of their λ,
    /// δz likewise, δu of the last piece, 4 rows of P, δD^α x at t = 0, and δ of what counts as unloaded at α = 0.
    pub fn recall(&mut self, memory: &Memory, past: &RecalledTangent) {
        if memory.alpha() == 0.0 {
            self.origin.copy_from_slice(past.delta_mean);
        }
        // What jumped is a past like any other.
        self.jumps.clear();
        let Some(history) = memory.past() else { return };
        for (k, lambda) in history.kernel().lambda.iter().enumerate() {
            (past.delta_mode)(*lambda, self.modes.row_mut(k));
        }
        self.piece = Columns::new(self.parameters, CUBIC);
        for p in 0..CUBIC {
            self.piece.row_mut(p).copy_from_slice(&past.delta_last[p * self.parameters..][..self.parameters]);
        }
        self.now.copy_from_slice(past.delta_derivative);
        self.is_recalled = true;
        if let Some(by_order) = &mut self.by_order {
            let (width, last) = history.last();
            by_order.slow.recall(past.mode, width, last);
        }
    }
}

/// The derivative of a past before t = 0.
pub struct RecalledTangent<'a> {
    /// z of a mode.
    pub mode: &'a dyn Fn(f64) -> f64,
    /// δz of a mode.
    pub delta_mode: &'a dyn Fn(f64, &mut [f64]),
    /// δu_p of the last piece, 4 rows of P.
    pub delta_last: &'a [f64],
    /// δD^α x at t = 0.
    pub delta_derivative: &'a [f64],
    /// δ of the mean of x.
    pub delta_mean: &'a [f64],
}
