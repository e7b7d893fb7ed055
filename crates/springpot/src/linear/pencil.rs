//! M s² + D s + K + Σ c s^alpha b bᵀ: the equations of small motions with the strokes inside series as unknowns of their own, so that
//! their determinant has zeros and no poles.

use super::assembly::{Assembly, Parts, Springpot};
use super::linearisation::{LinearElement, Linearisation};
use crate::law::{Tangent, Term};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The equations, scaled: s in units of `omega`, unknowns in units of `scales`.
#[derive(Debug, Clone)]
pub(super) struct Pencil {
    /// All unknowns; the first `free` are tangent coordinates.
    pub(super) size: usize,
    pub(super) free: usize,
    pub(super) mass: Vec<f64>,
    pub(super) damping: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    pub(super) springpots: Vec<OfSpringpot>,
    pub(super) omega: f64,
    pub(super) scales: Vec<f64>,
}

/// push ⊗ stroke·c s^alpha.
#[derive(Debug, Clone)]
pub(super) struct OfSpringpot {
    pub(super) term: Term,
    pub(super) push: Vec<f64>,
    pub(super) stroke: Vec<f64>,
}

impl Pencil {
    /// The equations over the free velocities; `None` where the mass matrix is not positive, or something is not finite.
    pub(super) fn new(linear: &Linearisation) -> Option<Self> {
        let assembly = Assembly::new(linear, &[], Parts::Reduced, None);
        let size = assembly.unknowns.len();
        let whole = |power: usize| assembly.rows.iter().flat_map(|row| row.by[power].iter().copied()).collect();
        let of_springpot = |(j, springpot): (usize, &Springpot)| OfSpringpot {
            term: Term { coefficient: 1.0, order: springpot.order },
            push: assembly.rows.iter().map(|row| row.springpots.get(j).copied().unwrap_or(0.0)).collect(),
            stroke: springpot.stroke.clone(),
        };
        let mut pencil = Self {
            size,
            free: linear.free.len(),
            mass: whole(2),
            damping: whole(1),
            stiffness: whole(0),
            springpots: assembly.springpots.iter().enumerate().map(of_springpot).collect(),
            omega: 1.0,
            scales: vec![1.0; size],
        };
        pencil.scale(linear)?;
        Some(pencil)
    }

    /// Whether no power of s is broken.
    pub(super) fn is_rational(&self) -> bool {
        self.springpots.is_empty()
    }

    /// Brings the unknowns and s to sizes about 1.
    fn scale(&mut self, linear: &Linearisation) -> Option<()> {
        for k in 0..self.free {
            let mass = self.mass[k * (self.size + 1)];
            if !(mass > 0.0 && mass.is_finite()) {
                return None;
            }
            self.scales[k] = mass.sqrt().recip();
        }
        self.omega = self.fastest(linear);
        for k in self.free..self.size {
            let at = k * (self.size + 1);
            let own = |of: &OfSpringpot| (of.term.stiffness(self.omega) * of.push[k] * of.stroke[k]).abs();
            let of_springpots = self.springpots.iter().map(own);
            let stiffness = self.stiffness[at].abs() + self.omega * self.damping[at].abs() + of_springpots.sum::<f64>();
            self.scales[k] = if stiffness > 0.0 { self.omega / stiffness.sqrt() } else { 1.0 };
        }
        let (scales, omega, size) = (&self.scales, self.omega, self.size);
        for (matrix, power) in [(&mut self.mass, 2), (&mut self.damping, 1), (&mut self.stiffness, 0)] {
            for (k, entry) in matrix.iter_mut().enumerate() {
                *entry *= scales[k / size] * scales[k % size] * omega.powi(power - 2);
            }
        }
        for OfSpringpot { term, push, stroke } in &mut self.springpots {
            term.coefficient *= omega.powf(term.order - 2.0);
            for row in [push, stroke] {
                row.iter_mut().zip(scales).for_each(|(entry, scale)| *entry *= scale);
            }
        }
        let finite = |matrix: &[f64]| matrix.iter().all(|entry| entry.is_finite());
        (finite(&self.mass) && finite(&self.damping) && finite(&self.stiffness) && omega > 0.0).then_some(())
    }

    /// About the fastest rate at which the masses answer, rad/s: ω² = |D ω + K + Σ K_e(ω) g gᵀ| in units of the masses.
    fn fastest(&self, linear: &Linearisation) -> f64 {
        let tangents: Vec<Tangent> = linear.elements.iter().map(|element| element.tangent.reduced()).collect();
        let control = &linear.control;
        let slope = |matrix: &[f64], at: usize| matrix.get(at).copied().unwrap_or(0.0);
        let norm = |omega: f64| {
            let moduli: Vec<f64> = {
                let own = |tangent: &Tangent| tangent.modulus(omega.into()).re;
                tangents.iter().map(own).map(|k| if k.is_finite() { k } else { 0.0 }).collect()
            };
            let of_terms = |k: usize| -> f64 {
                let own = control.terms.iter().filter(|term| term.velocity == k);
                own.map(|term| term.gain * omega.powf(term.order)).sum()
            };
            let mut sum = 0.0;
            for r in 0..self.free {
                for c in 0..self.free {
                    let [row, column] = [r, c].map(|k| linear.free[k]);
                    let of = |(e, k): (&LinearElement, &f64)| k * e.gradient[row] * e.gradient[column];
                    let of_elements: f64 = linear.elements.iter().zip(&moduli).map(of).sum();
                    let at = row * linear.left_over.len() + column;
                    let of_control = slope(&control.by_q, at) + omega * slope(&control.by_v, at);
                    let of_terms = if row == column { of_terms(row) } else { 0.0 };
                    let of_robot = linear.stiffness[at] + omega * linear.damping[at] + of_elements;
                    let all = of_robot - of_control + of_terms;
                    let entry = all * self.scales[r] * self.scales[c];
                    sum += entry * entry;
                }
            }
            sum.sqrt()
        };
        let (mut low, mut high) = (-60.0f64, 60.0f64);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let omega = middle.exp();
            if norm(omega) > omega * omega { low = middle } else { high = middle }
        }
        if high < -59.0 { 1.0 } else { high.exp() }
    }

    /// T(s) and dT/ds; of s^alpha the branch that goes on from the upper half of the plane across the negative axis.
    pub(super) fn at(&self, s: Complex64) -> [Vec<Complex64>; 2] {
        let count = self.size * self.size;
        let mut value: Vec<Complex64> =
            (0..count).map(|k| s * (s * self.mass[k] + self.damping[k]) + self.stiffness[k]).collect();
        let mut slope: Vec<Complex64> = (0..count).map(|k| s * (2.0 * self.mass[k]) + self.damping[k]).collect();
        for OfSpringpot { term, push, stroke } in &self.springpots {
            let modulus = term.coefficient * continued_power(s, term.order);
            let rate = modulus * term.order / s;
            for (r, row) in push.iter().enumerate().filter(|(_, row)| **row != 0.0) {
                for (c, column) in stroke.iter().enumerate() {
                    value[r * self.size + c] += modulus * (row * column);
                    slope[r * self.size + c] += rate * (row * column);
                }
            }
        }
        [value, slope]
    }

    /// The share of broken powers in T(s) x, and the size of all terms of T(s) x.
    pub(super) fn shares(&self, s: Complex64, x: &[Complex64]) -> [f64; 2] {
        let n = self.size;
        let size = |vector: &[Complex64]| vector.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
        let times = |matrix: &[f64]| -> Vec<Complex64> {
            matrix.chunks_exact(n).map(|row| row.iter().zip(x).map(|(m, x)| x * *m).sum()).collect()
        };
        let mut broken = vec![Complex64::ZERO; n];
        for OfSpringpot { term, push, stroke } in &self.springpots {
            let along: Complex64 = stroke.iter().zip(x).map(|(b, x)| x * *b).sum();
            let force = term.coefficient * continued_power(s, term.order) * along;
            broken.iter_mut().zip(push).for_each(|(sum, b)| *sum += force * *b);
        }
        let r = s.norm();
        let whole = size(&times(&self.mass)) * r * r + size(&times(&self.damping)) * r + size(&times(&self.stiffness));
        [size(&broken), whole + size(&broken)]
    }
}

/// s^order with −π/2 < arg s ≤ 3π/2.
fn continued_power(s: Complex64, order: f64) -> Complex64 {
    let arg = s.arg();
    let arg = if arg <= -FRAC_PI_2 { arg + TAU } else { arg };
    Complex64::from_polar(s.norm().powf(order), order * arg)
}
