//! Linear systems over the velocities that forces move: the one door by which unknowns are fewer than velocities.

use crate::linalg::Lu;

/// The factors of such a system.
#[derive(Debug, Clone, Default)]
pub(crate) struct Solve {
    lu: Lu,
}

impl Solve {
    /// Factors the rows and columns `free` of an nv × nv matrix, such as that of the masses; `false` where that part is singular or not finite.
    pub(crate) fn factor_part(&mut self, full: &[f64], nv: usize, free: &[usize]) -> bool {
        self.lu.factor_part(nv, full, free)
    }

    /// Factors a system of as many unknowns as `fill` writes rows for, into zeros; `false` as for [`Self::factor_part`].
    pub(crate) fn factor(&mut self, unknowns: usize, fill: impl FnOnce(&mut [f64])) -> bool {
        self.lu.factor(unknowns, fill)
    }

    /// Room for so many unknowns, so that nothing is allocated later.
    pub(crate) fn reserve(&mut self, unknowns: usize) {
        self.lu.factor(unknowns, |matrix| (0..unknowns).for_each(|k| matrix[k * unknowns + k] = 1.0));
    }

    /// Solves in place: `x` holds the right-hand side before and the solution after.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        self.lu.solve(x);
    }

    /// Solves for `count` right-hand sides at once, which stand side by side in the rows of `x`.
    pub(crate) fn solve_rows(&mut self, x: &mut [f64], count: usize) {
        self.lu.solve_rows(x, count);
    }
}
