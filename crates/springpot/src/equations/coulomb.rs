//! Coulomb's law at several joints at once: which of them hold and which slide.
//!
//! Joints at rest whose accelerations would be a⁰ without their friction have a = a⁰ − W f with f_k ∈ F_k·Sgn(a_k): f_k = ±F_k where
//! a joint slides off in that direction, |f_k| ≤ F_k where it stays. W is a part of the inverse of a mass matrix, so that there is
//! one answer. It is found by principal pivoting: all joints that break their condition change together as long as they become
//! fewer, else the first of them alone, which ends (Júdice & Pires, Computers & Operations Research 21, 1994). In
//! fixed steps velocities at the end of the step take the place of accelerations.

use super::solve::Solve;
use crate::linalg::Lu;

/// Pivots after which there is no answer: far more than any robot has needed.
const MOST_PIVOTS: usize = 2_000;

/// How often all change together without becoming fewer.
const PATIENCE: usize = 10;

/// A joint at rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    /// Its place among the unknowns of the system of equations.
    pub(crate) place: usize,
    /// F, positive.
    pub(crate) limit: f64,
    /// By how much a force may exceed its limit and still hold: its rounding.
    pub(crate) slack: f64,
    /// What is added to the unknown: 0 for accelerations.
    pub(crate) offset: f64,
}

/// The problem and its answer.
#[derive(Debug, Clone, Default)]
pub(crate) struct Coulomb {
    /// The joints.
    pub(crate) candidates: Vec<Candidate>,
    /// Of each −1, 0 (held) or 1: the direction in which it slides.
    pub(crate) directions: Vec<i8>,
    /// Column by column what a force at each joint does to all unknowns.
    columns: Vec<f64>,
    /// W, row by row, and a⁰.
    mobility: Vec<f64>,
    pushed: Vec<f64>,
    forces: Vec<f64>,
    held: Vec<usize>,
    part: Vec<f64>,
    next: Vec<i8>,
    lu: Lu,
}

impl Coulomb {
    /// Room for `n` joints among `unknowns`, so that nothing is allocated later.
    pub(crate) fn reserve(&mut self, n: usize, unknowns: usize) {
        self.candidates.reserve(n);
        self.columns.reserve(n * unknowns);
        self.mobility.reserve(n * n);
        self.held.reserve(n);
        for vector in [&mut self.pushed, &mut self.forces, &mut self.part] {
            vector.reserve(n);
        }
        self.directions.reserve(n);
        self.next.reserve(n);
        self.lu.factor(n, |matrix| (0..n).for_each(|k| matrix[k * n + k] = 1.0));
    }

    /// Takes the friction of the candidates off `a`, which solves a system with the factors `solve` without it, and tells their
    /// directions.
    ///
    /// # Errors
    /// A candidate that finds no friction; numbers that are not finite are the cause.
    pub(crate) fn solve(&mut self, solve: &mut Solve, a: &mut [f64]) -> Result<(), usize> {
        let (n, unknowns) = (self.candidates.len(), a.len());
        self.columns.clear();
        self.columns.resize(n * unknowns, 0.0);
        self.mobility.clear();
        self.mobility.resize(n * n, 0.0);
        self.pushed.clear();
        for (c, column) in self.columns.chunks_exact_mut(unknowns.max(1)).enumerate() {
            column[self.candidates[c].place] = 1.0;
            solve.solve(column);
            for (r, candidate) in self.candidates.iter().enumerate() {
                self.mobility[r * n + c] = column[candidate.place];
            }
        }
        self.pushed.extend(self.candidates.iter().map(|candidate| a[candidate.place] + candidate.offset));
        self.forces.clear();
        self.forces.resize(n, 0.0);
        self.directions.clear();
        self.directions.resize(n, 0);
        self.pivot()?;
        for (column, force) in self.columns.chunks_exact(unknowns.max(1)).zip(&self.forces) {
            for (a, column) in a.iter_mut().zip(column) {
                *a -= column * force;
            }
        }
        // To the bit, where it is known.
        for (candidate, direction) in self.candidates.iter().zip(&self.directions) {
            if *direction == 0 {
                a[candidate.place] = 0.0 - candidate.offset;
            }
        }
        Ok(())
    }

    fn pivot(&mut self) -> Result<(), usize> {
        let n = self.candidates.len();
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..MOST_PIVOTS {
            self.balance()?;
            self.next.clear();
            for k in 0..n {
                self.next.push(self.right_direction(k));
            }
            let changes = |k: &usize| self.next[*k] != self.directions[*k];
            let Some(first) = (0..n).find(changes) else { return Ok(()) };
            let count = (first..n).filter(changes).count();
            if count < fewest {
                (fewest, patience) = (count, PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            let last = if patience > 0 { n } else { first + 1 };
            self.directions[first..last].copy_from_slice(&self.next[first..last]);
        }
        Err((0..n).find(|&k| self.next[k] != self.directions[k]).unwrap_or(0))
    }

    /// The direction that goes with the force and the acceleration of joint `k`.
    fn right_direction(&self, k: usize) -> i8 {
        let (direction, Candidate { limit, slack, .. }) = (self.directions[k], self.candidates[k]);
        if direction == 0 {
            let force = self.forces[k];
            return if force.abs() > limit + slack { force.signum() as i8 } else { 0 };
        }
        if f64::from(direction) * self.acceleration(k) > 0.0 { direction } else { 0 }
    }

    /// a_k.
    fn acceleration(&self, k: usize) -> f64 {
        let n = self.candidates.len();
        let row = &self.mobility[k * n..(k + 1) * n];
        self.pushed[k] - row.iter().zip(&self.forces).map(|(w, f)| w * f).sum::<f64>()
    }

    /// The forces for the present directions: ±F of those that slide, and what keeps the others at rest.
    fn balance(&mut self) -> Result<(), usize> {
        let n = self.candidates.len();
        self.held.clear();
        for k in 0..n {
            self.forces[k] = f64::from(self.directions[k]) * self.candidates[k].limit;
            if self.directions[k] == 0 {
                self.held.push(k);
            }
        }
        self.part.clear();
        for at in 0..self.held.len() {
            let needed = self.acceleration(self.held[at]);
            self.part.push(needed);
        }
        if !self.lu.factor_part(n, &self.mobility, &self.held) {
            return Err(self.held.first().copied().unwrap_or(0));
        }
        self.lu.solve(&mut self.part);
        for (&k, force) in self.held.iter().zip(&self.part) {
            if !force.is_finite() {
                return Err(k);
            }
            self.forces[k] = *force;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Candidate, Coulomb, Solve};

    /// Masses with coupled random numbers: every answer meets the conditions, whatever holds.
    #[test]
    fn answers_meet_the_law() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut held = [0; 2];
        for round in 0..400 {
            let (n, ranks) = (1 + round % 12, 14);
            let b: Vec<f64> = (0..n * ranks).map(|_| random()).collect();
            let mass = |r: usize, c: usize| -> f64 {
                let sum: f64 = (0..ranks).map(|k| b[r * ranks + k] * b[c * ranks + k]).sum();
                sum + if r == c { 1e-3 } else { 0.0 }
            };
            let push: Vec<f64> = (0..n).map(|_| 3.0 * random()).collect();
            let mut lu = Solve::default();
            assert!(lu.factor(n, |m| (0..n * n).for_each(|k| m[k] = mass(k / n, k % n))));
            let mut a = push.clone();
            lu.solve(&mut a);
            let mut coulomb = Coulomb::default();
            coulomb.candidates.extend((0..n).map(|place| {
                let limit = 0.1 + random().abs();
                Candidate { place, limit, slack: 1e-12, offset: 0.0 }
            }));
            coulomb.solve(&mut lu, &mut a).unwrap();
            for k in 0..n {
                let friction = push[k] - (0..n).map(|c| mass(k, c) * a[c]).sum::<f64>();
                let limit = coulomb.candidates[k].limit;
                match coulomb.directions[k] {
                    0 => assert!(a[k] == 0.0 && friction.abs() <= limit + 1e-9),
                    d => assert!(f64::from(d) * a[k] > 0.0 && (friction - f64::from(d) * limit).abs() < 1e-9),
                }
                held[usize::from(coulomb.directions[k] == 0)] += 1;
            }
        }
        assert!(held.iter().all(|count| *count > 300), "{held:?}");
    }

    #[test]
    fn what_is_not_finite_finds_no_friction() {
        let mut lu = Solve::default();
        assert!(lu.factor(1, |m| m[0] = 1.0));
        let mut coulomb = Coulomb::default();
        coulomb.candidates.push(Candidate { place: 0, limit: 1.0, slack: 0.0, offset: 0.0 });
        assert_eq!(coulomb.solve(&mut lu, &mut [f64::NAN]), Err(0));
        // At its limit a joint holds, a bit above it slides.
        for (push, direction) in [(1.0, 0), (-1.0, 0), (1.0f64.next_up(), 1), (-1.0f64.next_up(), -1)] {
            coulomb.solve(&mut lu, &mut [push]).unwrap();
            assert_eq!(coulomb.directions, [direction], "{push}");
        }
    }
}
