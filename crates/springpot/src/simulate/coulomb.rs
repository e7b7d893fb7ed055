//! Coulomb's law at several joints at once: which of them hold and which slide.
//!
//! Joints at rest whose accelerations would be a⁰ without their friction have a = a⁰ − W f with f_k ∈ F_k·Sgn(a_k): f_k = ±F_k where
//! a joint slides off in that direction, |f_k| ≤ F_k where it stays. W is a principal part of an inverse mass matrix, so that there is
//! one answer. It is found by principal pivoting: all joints that break their condition change together as long as they become
//! fewer, else the first of them alone, which ends (Júdice & Pires, Computers & Operations Research 21, 1994). In
//! fixed steps velocities at the end of the step take the place of accelerations.

use super::lu::Lu;

/// Pivots after which there is no answer: far more than any robot has needed.
const MOST_PIVOTS: usize = 2_000;

/// How often all change together without becoming fewer.
const PATIENCE: usize = 10;

/// The problem and its answer; the vectors have an entry for each joint.
#[derive(Debug, Clone, Default)]
pub(super) struct Coulomb {
    /// W, row by row.
    pub(super) mobility: Vec<f64>,
    /// a⁰.
    pub(super) pushed: Vec<f64>,
    /// F, positive.
    pub(super) limits: Vec<f64>,
    /// By how much a force may exceed its limit and still hold: its rounding.
    pub(super) slack: Vec<f64>,
    /// −1, 0 (held) or 1: directions of sliding. A guess before, the answer after.
    pub(super) directions: Vec<i8>,
    /// f.
    pub(super) forces: Vec<f64>,
    held: Vec<usize>,
    part: Vec<f64>,
    lu: Lu,
}

impl Coulomb {
    /// Room for `n` joints.
    pub(super) fn resize(&mut self, n: usize) {
        self.mobility.resize(n * n, 0.0);
        for vector in [&mut self.pushed, &mut self.limits, &mut self.slack, &mut self.forces] {
            vector.resize(n, 0.0);
        }
        self.directions.resize(n, 0);
        self.held.reserve(n);
        self.part.reserve(n);
    }

    /// Finds the directions and the forces.
    ///
    /// # Errors
    /// A joint that finds none; numbers that are not finite are the cause.
    pub(super) fn solve(&mut self) -> Result<(), usize> {
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..MOST_PIVOTS {
            self.balance()?;
            let n = self.limits.len();
            let broken = (0..n).filter(|&k| self.better(k).is_some());
            let (mut count, mut first) = (0, n);
            for k in broken {
                count += 1;
                first = first.min(k);
            }
            if count == 0 {
                return Ok(());
            }
            if count < fewest {
                (fewest, patience) = (count, PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            let last = if patience > 0 { n } else { first + 1 };
            // Judged by one balance, changed together.
            for k in first..last {
                if let Some(direction) = self.better(k) {
                    self.part[k] = f64::from(direction);
                } else {
                    self.part[k] = f64::from(self.directions[k]);
                }
            }
            for k in first..last {
                self.directions[k] = self.part[k] as i8;
            }
        }
        Err((0..self.limits.len()).find(|&k| self.better(k).is_some()).unwrap_or(0))
    }

    /// The direction that joint `k` should have instead of its own.
    fn better(&self, k: usize) -> Option<i8> {
        let direction = f64::from(self.directions[k]);
        if direction == 0.0 {
            let force = self.forces[k];
            return (force.abs() > self.limits[k] + self.slack[k]).then(|| if force > 0.0 { 1 } else { -1 });
        }
        (direction * self.acceleration(k) <= 0.0).then_some(0)
    }

    /// a_k.
    pub(super) fn acceleration(&self, k: usize) -> f64 {
        let row = &self.mobility[k * self.limits.len()..][..self.limits.len()];
        self.pushed[k] - row.iter().zip(&self.forces).map(|(w, f)| w * f).sum::<f64>()
    }

    /// The forces for the present directions: ±F of those that slide, and what keeps the others at rest.
    fn balance(&mut self) -> Result<(), usize> {
        let n = self.limits.len();
        self.held.clear();
        for k in 0..n {
            self.forces[k] = f64::from(self.directions[k]) * self.limits[k];
            if self.directions[k] == 0 {
                self.held.push(k);
            }
        }
        self.part.clear();
        for &k in &self.held {
            self.part.push(self.acceleration(k));
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
        self.part.resize(n, 0.0);
        Ok(())
    }
}
