//! What parameters change of a term: the derivative of its memory, of its gain and of its order.

use super::{Integrand, Term};
use crate::collocation::{Nodes, STAGES};
use crate::fractional::{
    Form, KernelError, MemoryTangent, Singular, StepStart, TangentPoint, TangentSeeds, TangentStep,
};
use serde::{Deserialize, Serialize};

/// Of one [`Term`], in blocks of one number for each parameter.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::equations::control) struct TermVariation {
    /// Of its gain.
    gain: Vec<f64>,
    pub(in crate::equations::control) tangent: MemoryTangent,
    /// Of ∫e of an integral, where the step starts.
    pub(in crate::equations::control) integral: Vec<f64>,
    /// Of the error and its rate at the start and at the nodes.
    errors: [Vec<f64>; 2],
    /// Of the stroke and its rate there.
    stroke: Vec<f64>,
    rate: Vec<f64>,
    /// Of D^order e at the nodes where strokes and rates there stay.
    explicit: Vec<f64>,
}

impl TermVariation {
    /// Of a term at t = 0, where `gain` and `order` change so, and its error by `error`.
    pub(in crate::equations::control) fn begin(
        term: &Term,
        gain: Vec<f64>,
        order: &[f64],
        error: &[f64],
    ) -> Result<Self, KernelError> {
        let count = gain.len();
        let none = vec![0.0; count];
        let origin = if term.is_integral() { &none } else { error };
        // D^{1 + order} of ∫e, or D^order of e.
        let seeds = TangentSeeds { alpha: order, origin, jump: &none };
        let nodes = || vec![0.0; (STAGES + 1) * count];
        Ok(Self {
            gain,
            tangent: MemoryTangent::new(&term.kept.memory, &seeds)?,
            integral: none.clone(),
            errors: [nodes(), nodes()],
            stroke: nodes(),
            rate: nodes(),
            explicit: vec![0.0; STAGES * count],
        })
    }

    fn count(&self) -> usize {
        self.gain.len()
    }

    /// Block `i` of some.
    fn block<'a>(&self, blocks: &'a [f64], i: usize) -> &'a [f64] {
        &blocks[i * self.count()..(i + 1) * self.count()]
    }

    /// What changes of the error and its rate at the start (0) or at a node, by parameter `p`.
    pub(in crate::equations::control) fn set_error(&mut self, i: usize, p: usize, [error, rate]: [f64; 2]) {
        let place = i * self.count() + p;
        let [errors, rates] = &mut self.errors;
        (errors[place], rates[place]) = (error, rate);
    }

    /// Works out what changes of strokes and rates.
    pub(in crate::equations::control) fn follow(&mut self, term: &Term, integrand: Integrand) {
        let (count, h) = (self.count(), term.start.h);
        let Self { integral, errors: [errors, rates], stroke, rate, .. } = self;
        if !term.is_integral() {
            stroke.copy_from_slice(errors);
            rate.copy_from_slice(rates);
            return;
        }
        for i in 0..=STAGES {
            for p in 0..count {
                let place = i * count + p;
                (stroke[place], rate[place]) = (integral[p], 0.0);
                if integrand == Integrand::Runs {
                    rate[place] = errors[place];
                    if i > 0 {
                        let row = &term.nodes.matrix()[i - 1];
                        stroke[place] += h * (0..STAGES).map(|j| row[j] * errors[(j + 1) * count + p]).sum::<f64>();
                    }
                }
            }
        }
    }

    /// ∫e takes less by `jump` from a time on that moves so.
    pub(in crate::equations::control) fn jump(&mut self, jump: f64, moved: &[f64]) {
        self.integral.iter_mut().zip(moved).for_each(|(own, moved)| *own += jump * moved);
    }

    /// ∫e itself changes so at the start (0) or at a node that gain·∫e changes by `wanted`.
    pub(in crate::equations::control) fn slide(&mut self, i: usize, term: &Term, wanted: &[f64]) {
        let (count, gain) = (self.count(), term.law.gain);
        let integral = if i == 0 { term.kept.integral } else { term.stroke[i] };
        for (p, wanted) in wanted.iter().enumerate() {
            let change = (wanted - self.gain[p] * integral) / gain;
            self.stroke[i * count + p] = change;
            if i == 0 {
                self.integral[p] = change;
            }
        }
    }

    fn step(term: &Term) -> TangentStep<'static> {
        let Term { start, nodes, form, .. } = *term;
        TangentStep { start, nodes, places: None, form, polynomial: term.polynomial() }
    }

    /// Asks the memory what changes where strokes and rates at the nodes stay.
    pub(in crate::equations::control) fn ask(&mut self, term: &Term) {
        let start = TangentPoint {
            stroke: term.stroke[0],
            rate: term.rate[0],
            delta_stroke: self.block(&self.stroke, 0),
            delta_rate: self.block(&self.rate, 0),
        };
        let mut explicit = std::mem::take(&mut self.explicit);
        self.tangent.explicit(&term.kept.memory, &Self::step(term), Singular::Apart, &start, &mut explicit);
        self.explicit = explicit;
    }

    /// What changes of gain·D^order e at node `i` (from 1) by parameter `p`.
    pub(in crate::equations::control) fn force(&self, term: &Term, i: usize, p: usize) -> f64 {
        let count = self.count();
        let affine = &term.affine;
        let mut value = self.explicit[(i - 1) * count + p];
        for j in 0..STAGES {
            let place = (j + 1) * count + p;
            value += affine.stroke[i - 1][j] * self.stroke[place] + affine.rate[i - 1][j] * self.rate[place];
        }
        term.law.gain * value + self.gain[p] * term.value[i]
    }

    /// Adds what changes of gain·D^order e between two steps, where error and rate are `now` and change by blocks.
    pub(in crate::equations::control) fn add_now(
        &self,
        term: &Term,
        now: [f64; 2],
        changes: [&[f64]; 2],
        integrand: Integrand,
        out: &mut [f64],
    ) {
        let runs = !term.is_integral() || integrand == Integrand::Runs;
        let none = vec![0.0; self.count()];
        let (stroke, rate) = match term.is_integral() {
            true => (&self.integral[..], if runs { changes[0] } else { &none }),
            false => (changes[0], changes[1]),
        };
        let mut found = vec![0.0; self.count()];
        self.tangent.now(&term.kept.memory, stroke, rate, &mut found);
        let value = if term.law.gain == 0.0 { 0.0 } else { term.now(now, integrand) / term.law.gain };
        self.add(term.law.gain, value, &found, out);
    }

    fn add(&self, gain: f64, value: f64, found: &[f64], out: &mut [f64]) {
        for ((out, found), own) in out.iter_mut().zip(found).zip(&self.gain) {
            *out += gain * found + own * value;
        }
    }

    /// The same at θ of the step.
    pub(in crate::equations::control) fn add_at(
        &self,
        term: &Term,
        theta: f64,
        now: [f64; 2],
        changes: [&[f64]; 2],
        integrand: Integrand,
        out: &mut [f64],
    ) {
        let (count, step) = (self.count(), Self::step(term));
        let mut u = vec![0.0; 4 * count];
        step.delta_polynomial(&self.stroke, &self.rate, &mut u);
        let polynomial = &step.polynomial;
        let (mut stroke, mut rate) = (changes[0].to_vec(), changes[1].to_vec());
        let (mut at, mut shown) = ((now[0], now[1]), step);
        if term.is_integral() {
            let runs = integrand == Integrand::Runs;
            let travel = term.stroke[0] + polynomial.travel_until(theta);
            at = (travel, if runs { now[0] } else { polynomial.rate(theta) });
            for p in 0..count {
                let powers = (0..4).map(|k| (k, u[k * count + p]));
                let travelled: f64 = powers.clone().map(|(k, u)| u * theta.powi(k as i32 + 1) / (k + 1) as f64).sum();
                stroke[p] = self.stroke[p] + step.start.h * travelled;
                rate[p] = if runs { changes[0][p] } else { powers.map(|(k, u)| u * theta.powi(k as i32)).sum() };
            }
            // Its rows do not correct the polynomial.
            shown.form = Form::Strokes;
        }
        let point = TangentPoint { stroke: at.0, rate: at.1, delta_stroke: &stroke, delta_rate: &rate };
        let mut found = vec![0.0; count];
        self.tangent.at(&term.kept.memory, &shown, theta, &point, &u, &mut found);
        let value = if term.law.gain == 0.0 { 0.0 } else { term.at(theta, now, integrand) / term.law.gain };
        self.add(term.law.gain, value, &found, out);
    }

    /// Takes the step into the past; the term has not taken it yet.
    pub(in crate::equations::control) fn commit(&mut self, term: &Term) {
        let (count, step) = (self.count(), Self::step(term));
        let mut u = vec![0.0; 4 * count];
        step.delta_polynomial(&self.stroke, &self.rate, &mut u);
        self.tangent.commit(&term.kept.memory, &step, &u, None);
        if term.is_integral() {
            let end = self.block(&self.stroke, STAGES).to_vec();
            self.integral.copy_from_slice(&end);
        }
        for blocks in &mut self.errors {
            blocks.copy_within(STAGES * count.., 0);
        }
    }

    /// The same of a step of which the ends alone are known: its size, the error and its rate there and what an integral does, and what changes of those.
    pub(in crate::equations::control) fn commit_ends(
        &mut self,
        term: &Term,
        (h, ends, integrand): (f64, [[f64; 2]; 2], Integrand),
        changes: &[(Vec<f64>, Vec<f64>)],
    ) {
        let count = self.count();
        let polynomial = term.polynomial_of_ends(h, ends, integrand);
        let mut u = vec![0.0; 4 * count];
        for p in 0..count {
            let [from, to] = [0, 1].map(|end| [changes[end].0[p], changes[end].1[p]]);
            let own = term.polynomial_of_ends(h, [from, to], integrand);
            own.coefficients().iter().enumerate().for_each(|(k, change)| u[k * count + p] = *change);
            if term.is_integral() {
                self.integral[p] += own.travel();
            }
        }
        let [stroke, rate] = if term.is_integral() { [term.kept.integral, 0.0] } else { ends[0] };
        // What it takes in hangs on no time: nothing of it jumps.
        let start = StepStart { t: 0.0, h, stroke, rate };
        let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
        self.tangent.commit(&term.kept.memory, &step, &u, None);
    }
}
