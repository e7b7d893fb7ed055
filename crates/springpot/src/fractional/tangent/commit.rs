//! How a step is taken into the derivative of a memory.

use super::columns::{Columns, add};
use super::{MemoryTangent, TangentStep};
use crate::fractional::exponentials::moments;
use crate::fractional::history::History;
use crate::fractional::memory::{Debt, Memory};
use crate::fractional::step::{CUBIC, SEXTIC};

/// Where a step of rates ends, as [`Memory::commit_rates`] is told.
#[derive(Debug, Clone, Copy)]
pub struct TangentEnd<'a> {
    /// x.
    pub stroke: f64,
    /// ∂x/∂θ, P numbers.
    pub delta_stroke: &'a [f64],
    /// To which x is known.
    pub resolution: f64,
}

impl MemoryTangent {
    /// Takes an accepted step into the past, before the memory does; `delta_u` is the derivative of the coefficients u_p of its polynomial,
    /// as many rows of P.
    ///
    /// With `end` what [`Memory::commit_rates`] does is differentiated, else [`Memory::commit`]. Of a debt the same share is paid as the
    /// memory pays of its own, none where it pays none.
    pub fn commit(&mut self, memory: &Memory, step: &TangentStep, delta_u: &[f64], end: Option<&TangentEnd>) {
        let Some(past) = memory.past() else { return };
        let (h, polynomial, parameters) = (step.polynomial.h, &step.polynomial, self.parameters);
        self.find_now(memory, past, step, delta_u);

        let shortest = memory.shortest_lag(h, step.places);
        let missing = past.kernel().missing(shortest);
        let front: Vec<f64> = (1..=missing).rev().map(|k| past.kernel().faster(k).0).collect();
        let mut fast = (missing > 0 && self.ports.is_none()).then(|| self.settled(past, &front, h));

        let (before, coefficients) = (self.piece.rows(), step.coefficients());
        if before != coefficients {
            self.piece = Columns::new(parameters, coefficients);
        }
        for p in 0..coefficients {
            self.piece.row_mut(p).copy_from_slice(&delta_u[p * parameters..][..parameters]);
        }
        let travel = |piece: &Columns, out: &mut [f64]| {
            (0..coefficients).for_each(|p| add(out, h / (p + 1) as f64, piece.row(p)));
        };
        travel(&self.piece, &mut self.travelled);
        let mut paid = *polynomial;
        if let Some(end) = end
            && let Some(Debt { owed, rate }) = memory.debt(polynomial, end.stroke, end.resolution)
        {
            paid.u[0] += rate;
            let share = rate * h / owed;
            let rows = self.piece.row_mut(0).iter_mut().zip(&mut self.travelled);
            for (((rate, travelled), stroke), origin) in rows.zip(end.delta_stroke).zip(&self.origin) {
                let payment = share * ((stroke - origin) - *travelled);
                *rate += payment / h;
                *travelled += payment;
            }
        }
        let surplus = if missing > 0 { 0 } else { past.surplus(shortest) };
        if let Some(ports) = &mut self.ports {
            ports.commit(past, h, [before, coefficients], [missing, surplus]);
        } else {
            if let Some(fast) = &mut fast {
                self.grow(fast, &front, h);
            }
            self.modes.advance(past.lag_of(h, coefficients), h, &self.piece);
            self.fold(memory, past, step.start.t + h, h);
            if let Some(fast) = fast {
                self.modes.put_in_front(fast);
            }
            self.modes.drop_front(surplus);
        }
        if let Some(by_order) = &mut self.by_order {
            by_order.slow.advance(h, paid.coefficients(), 0.0);
            by_order.follow(past.kernel(), &front, surplus);
        }
    }

    /// Behind [`Self::commit`] of a step that was differentiated at its lags: its end moves by `delta_h`, P numbers. `after` is the memory that the
    /// step was taken into.
    ///
    /// A mode goes on by dx/dt − λ z, and so does what only knows the last piece where that moves on beneath it.
    pub(crate) fn move_end(
        &mut self,
        [memory, after]: [&Memory; 2],
        step: &TangentStep,
        end: Option<&TangentEnd>,
        delta_h: &[f64],
    ) {
        let Some(past) = after.past() else { return };
        let (polynomial, h) = (&step.polynomial, step.polynomial.h);
        let rate = polynomial.rate(1.0);
        add(&mut self.now, memory.slopes(polynomial, 1.0).derivative, delta_h);
        add(&mut self.travelled, rate, delta_h);
        // What is paid of a debt stays, however long the step is.
        let debt = end.and_then(|end| memory.debt(polynomial, end.stroke, end.resolution));
        let paid = debt.map_or(0.0, |debt| debt.rate);
        let modes = past.kernel().lambda.iter().zip(past.modes()).map(|(lambda, z)| {
            let mut psi = [0.0; CUBIC];
            moments(lambda * h, &mut psi);
            (rate + paid - lambda * z) - paid * psi[0]
        });
        let mut bent = polynomial.bent();
        bent[0] -= paid / h;
        let bent = &bent[..self.piece.rows()];
        match &mut self.ports {
            Some(ports) => ports.move_end(modes.collect(), bent.to_vec(), delta_h),
            None => {
                modes.enumerate().for_each(|(k, share)| add(self.modes.row_mut(k), share, delta_h));
                bent.iter().enumerate().for_each(|(p, slope)| add(self.piece.row_mut(p), *slope, delta_h));
            }
        }
    }

    /// δD^α x at the end of the step.
    fn find_now(&mut self, memory: &Memory, past: &History, step: &TangentStep, delta_u: &[f64]) {
        let h = step.polynomial.h;
        let mut now = std::mem::take(&mut self.now);
        now.fill(0.0);
        let moments = super::order::local_moments(memory.local(), h, 1.0);
        moments
            .into_iter()
            .zip(delta_u.chunks_exact(self.parameters.max(1)))
            .for_each(|(moment, row)| add(&mut now, moment, row));
        self.add_histories(past, [h], &mut now);
        if let Some(by_order) = &self.by_order {
            let moved = by_order.local(memory.local(), &step.polynomial, 1.0) + by_order.history(past, h);
            add(&mut now, moved, &self.alpha);
        }
        self.now = now;
    }

    /// What modes of these rates have of the last piece, a step of h later.
    fn settled(&self, past: &History, rates: &[f64], h: f64) -> Columns {
        let mut modes = Columns::new(self.parameters, rates.len());
        for (k, lambda) in rates.iter().enumerate() {
            let share = (-lambda * h).exp();
            if !past.is_empty() {
                let coefficients = self.piece.rows();
                let factors = past.fast_moments(*lambda, coefficients);
                (0..coefficients).for_each(|p| add(modes.row_mut(k), share * factors[p], self.piece.row(p)));
            }
        }
        modes
    }

    /// Adds what such modes take in of the piece.
    fn grow(&self, modes: &mut Columns, rates: &[f64], h: f64) {
        for (k, lambda) in rates.iter().enumerate() {
            let mut psi = [0.0; SEXTIC];
            let psi = &mut psi[..self.piece.rows()];
            moments(lambda * h, psi);
            (0..psi.len()).for_each(|p| add(modes.row_mut(k), h * psi[p], self.piece.row(p)));
        }
    }
}
