//! What parameters change at one time, where no law keeps anything: what explicit methods ask.

use super::Variation;
use crate::equations::assembly::Equations;
use crate::law::Point;
use crate::law::variation::ObservationVariation;

impl Variation {
    /// Works out what changes of the accelerations at node `i`, which was seen and whose q and v change as it has them, where elements are told these
    /// points: over the velocities `free` of the extended robot, the others' go on as signals say. No numbers, and false, where the mass matrix is
    /// singular.
    pub(crate) fn accelerate_at<'p>(
        &mut self,
        equations: &Equations,
        i: usize,
        free: &[usize],
        at: impl Fn(usize) -> Point<'p>,
    ) -> bool {
        self.feed_back(i);
        for e in 0..self.elements.len() {
            self.measure(e, i);
            self.pull(equations, (e, i), &at(e));
        }
        self.solve_node(i, free)
    }

    /// What changes of the force of element `e` at node `i`, where it is told `at` and keeps nothing of a step.
    pub(super) fn pull(&mut self, equations: &Equations, (e, i): (usize, usize), at: &Point) {
        let count = self.count();
        let (mut spare, mut told) = ([vec![0.0; count], vec![0.0; count]], Vec::new());
        let [stored, derivative] = &mut spare;
        let mut row = std::mem::take(&mut self.elements[e].row);
        let [force, ..] = &mut row;
        force.fill(0.0);
        let mut sum = ObservationVariation { force, stored, derivative, told: &mut told, leaves: None };
        let own = &self.elements[e];
        equations.bank.vary_now(e, (at, false), &own.told(count, i, None), &own.law, &mut sum);
        self.elements[e].row = row;
    }

    /// Solves M δa = −(K δq + D δv + explicit + Σ g δF) at node `i`, which was seen, over the velocities `free`, where the forces of the elements change
    /// as was worked out last; no numbers, and false, where M is singular.
    pub(super) fn solve_node(&mut self, i: usize, free: &[usize]) -> bool {
        let (count, n) = (self.count(), self.nv());
        self.nodes[i].a.fill(0.0);
        if free.is_empty() {
            return true;
        }
        let mut solve = std::mem::take(&mut self.room.solve);
        let is_regular = solve.factor_part(&self.nodes[i].slopes.d_a, n, free);
        if is_regular {
            let mut right = vec![0.0; free.len() * count];
            for (sum, &row) in right.chunks_exact_mut(count.max(1)).zip(free) {
                self.add_unbalanced(i, row, sum);
                self.add_pulled(i, row, |e| &self.elements[e].row[0], sum);
            }
            solve.solve_rows(&mut right, count);
            for (own, &k) in right.chunks_exact(count.max(1)).zip(free) {
                self.nodes[i].a[k * count..][..count].iter_mut().zip(own).for_each(|(a, own)| *a = -own);
            }
        } else {
            self.nodes[i].a.fill(f64::NAN);
        }
        self.room.solve = solve;
        is_regular
    }
}
