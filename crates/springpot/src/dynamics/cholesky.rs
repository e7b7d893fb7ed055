//! The mass matrix factorised along the tree, and what follows from it.

use super::crba::lower_crba_into;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::Scalar;
use crate::spatial::columns::{ColumnWork, Columns};
use std::ops::Range;

/// Factors M = Lᵀ D L in place: L, unit lower triangular, is 0 wherever neither of two joints carries the other, so that
/// branches cause no fill-in.
///
/// `mass` is nv × nv, row-major, symmetric; afterwards its lower triangle holds L and its diagonal D, the upper triangle is as
/// it was. O(n d²) operations (d: depth of the tree). D_j is the inertia that joint j feels when all joints beyond it are
/// free; where the mass matrix is singular, infinities and NaN follow. Source: Featherstone, Rigid Body Dynamics Algorithms,
/// 2008, §6.5.
#[inline(always)]
pub fn cholesky_into<T: Scalar>(model: &Model, mass: &mut [T]) {
    let n = model.nv();
    assert_eq!(mass.len(), n * n, "the mass matrix is nv x nv");
    T::in_columns(Elimination { model, rows: mass });
}

/// Velocities for whose pivots there is room while rows are gathered.
const PIVOTS: usize = 64;

/// Row i less Σ_k (M_ki / D_k) row k over those that i carries, from the tips inwards, then all rows divided by their pivots.
struct Elimination<'a, T> {
    model: &'a Model,
    rows: &'a mut [T],
}

impl<T: Scalar> ColumnWork<T> for Elimination<'_, T> {
    #[inline(always)]
    fn run<C: Columns<T>>(self) {
        let Self { model, rows } = self;
        let n = model.nv();
        if C::WIDTH == 1 || n > PIVOTS || !model.is_deep() {
            return eliminate(model, rows);
        }
        let mut inverses = [T::ZERO; PIVOTS];
        for i in (0..n).rev() {
            let factors = Pivoted { column: i, width: n, inverses: &inverses };
            gather::<T, C>(rows, (n, i), 0..i + 1, None, model.carried(i), &factors);
            inverses[i] = T::ONE / rows[i * n + i];
        }
        for k in 0..n {
            for j in pivots(model, model.pivot(k)) {
                rows[k * n + j] = rows[k * n + j] * inverses[k];
            }
        }
    }
}

/// The same, row by row into those that carry it, whose entries alone are touched.
#[inline(always)]
fn eliminate<T: Scalar>(model: &Model, mass: &mut [T]) {
    let n = model.nv();
    for k in (0..n).rev() {
        let (above, rest) = mass.split_at_mut(k * n);
        let row = &mut rest[..n];
        let inverse = T::ONE / row[k];
        // Entries of row k inwards of i are still unscaled when i takes its turn.
        for i in pivots(model, model.pivot(k)) {
            let factor = row[i] * inverse;
            for j in pivots(model, i + 1) {
                above[i * n + j] -= factor * row[j];
            }
            row[i] = factor;
        }
    }
}

/// Solves M x = y, with the factors of [`cholesky_into`], in place: `x` (nv) holds y before and the solution after.
#[inline(always)]
pub fn cholesky_solve_into<T: Scalar>(model: &Model, factor: &[T], x: &mut [T]) {
    let n = model.nv();
    assert_eq!(factor.len(), n * n, "the factors are nv x nv");
    assert_eq!(x.len(), n, "the right-hand side is nv");
    for k in (0..n).rev() {
        let own = x[k];
        for j in pivots(model, model.pivot(k)) {
            x[j] -= factor[k * n + j] * own;
        }
        x[k] = own * (T::ONE / factor[k * n + k]);
    }
    for k in 0..n {
        let mut own = x[k];
        for j in pivots(model, model.pivot(k)) {
            own -= factor[k * n + j] * x[j];
        }
        x[k] = own;
    }
}

/// Solves M X = Y for the columns of an nv × nv matrix, in place.
#[inline(always)]
pub(super) fn solve_matrix<T: Scalar>(model: &Model, factor: &[T], x: &mut [T]) {
    let n = model.nv();
    assert_eq!(factor.len(), n * n, "the factors are nv x nv");
    assert_eq!(x.len(), n * n, "the right-hand side is nv x nv");
    T::in_columns(Sweeps { model, factor, rows: x, is_inverse: false });
}

/// The inverse M⁻¹ from the factors of [`cholesky_into`]: symmetric, both triangles written, nv × nv, row-major.
///
/// Only the upper triangle is computed: L⁻ᵀ has no lower one, and row k of M⁻¹ = L⁻¹ (D⁻¹ L⁻ᵀ) needs from the rows above it
/// the columns from k on.
#[inline(always)]
pub fn inverse_from_cholesky_into<T: Scalar>(model: &Model, factor: &[T], inverse: &mut [T]) {
    upper_inverse_from_cholesky_into(model, factor, inverse);
    mirror(model.nv(), inverse);
}

/// Writes the lower triangle of a symmetric n × n matrix from its upper one.
#[inline(always)]
fn mirror<T: Scalar>(n: usize, matrix: &mut [T]) {
    for k in 1..n {
        for j in 0..k {
            matrix[k * n + j] = matrix[j * n + k];
        }
    }
}

/// Its upper triangle; the lower one is left without meaning.
#[inline(always)]
pub(super) fn upper_inverse_from_cholesky_into<T: Scalar>(model: &Model, factor: &[T], inverse: &mut [T]) {
    let n = model.nv();
    assert_eq!(factor.len(), n * n, "the factors are nv x nv");
    assert_eq!(inverse.len(), n * n, "the inverse is nv x nv");
    // The first sweep reads zeros below the diagonal.
    inverse.fill(T::ZERO);
    for k in 0..n {
        inverse[k * n + k] = T::ONE;
    }
    T::in_columns(Sweeps { model, factor, rows: inverse, is_inverse: true });
}

/// Rows of X with M X = Y for Y in their place: L⁻ᵀ from the tips inwards, then L⁻¹ D⁻¹ outwards. Every row is gathered from those that it
/// needs, which all are final, while it stays in registers, and written once.
struct Sweeps<'a, T> {
    model: &'a Model,
    factor: &'a [T],
    rows: &'a mut [T],
    /// Y = 1, of which the upper triangle of X is asked for.
    is_inverse: bool,
}

impl<T: Scalar> ColumnWork<T> for Sweeps<'_, T> {
    #[inline(always)]
    fn run<C: Columns<T>>(self) {
        let Self { model, factor, rows, is_inverse } = self;
        let n = model.nv();
        for j in (0..n).rev() {
            let below = model.subtree_end(j);
            // Row j of L⁻ᵀ has nothing but the columns of what j carries.
            let columns = if is_inverse { j..below } else { 0..n };
            gather::<T, C>(rows, (n, j), columns, None, model.carried(j), &Given { factor, start: j, step: n });
        }
        for k in 0..n {
            let columns = if is_inverse { k..n } else { 0..n };
            let inverse = T::ONE / factor[k * n + k];
            let factors = Given { factor, start: k * n, step: 1 };
            gather::<T, C>(rows, (n, k), columns, Some(inverse), pivots(model, model.pivot(k)), &factors);
        }
    }
}

/// What multiplies row k where rows are gathered.
trait Factors<T> {
    fn of(&self, rows: &[T], k: usize) -> T;
}

/// Entry `start + k · step` of a matrix.
struct Given<'a, T> {
    factor: &'a [T],
    start: usize,
    step: usize,
}

impl<T: Scalar> Factors<T> for Given<'_, T> {
    #[inline(always)]
    fn of(&self, _: &[T], k: usize) -> T {
        self.factor[self.start + k * self.step]
    }
}

/// A column of the rows themselves, over their pivots.
struct Pivoted<'a, T> {
    column: usize,
    width: usize,
    inverses: &'a [T; PIVOTS],
}

impl<T: Scalar> Factors<T> for Pivoted<'_, T> {
    #[inline(always)]
    fn of(&self, rows: &[T], k: usize) -> T {
        rows[k * self.width + self.column] * self.inverses[k]
    }
}

/// row = row · scale − Σ_k factor_k row_k in some `columns`.
#[inline(always)]
fn gather<T: Scalar, C: Columns<T>>(
    rows: &mut [T],
    (n, row): (usize, usize),
    columns: Range<usize>,
    scale: Option<T>,
    terms: impl Iterator<Item = usize> + Clone,
    factors: &impl Factors<T>,
) {
    let mut from = columns.start;
    while from < columns.end {
        let left = columns.end - from;
        let registers = left.div_ceil(C::WIDTH).min(6);
        let block = from..from + left.min(registers * C::WIDTH);
        from = block.end;
        match registers {
            1 => gather_block::<T, C, 1>(rows, (n, row), block, scale, terms.clone(), factors),
            2 => gather_block::<T, C, 2>(rows, (n, row), block, scale, terms.clone(), factors),
            3 => gather_block::<T, C, 3>(rows, (n, row), block, scale, terms.clone(), factors),
            4 => gather_block::<T, C, 4>(rows, (n, row), block, scale, terms.clone(), factors),
            5 => gather_block::<T, C, 5>(rows, (n, row), block, scale, terms.clone(), factors),
            _ => gather_block::<T, C, 6>(rows, (n, row), block, scale, terms.clone(), factors),
        }
    }
}

/// [`gather`] in as many columns as `B` registers hold, the last of them perhaps not full.
#[inline(always)]
fn gather_block<T: Scalar, C: Columns<T>, const B: usize>(
    rows: &mut [T],
    (n, row): (usize, usize),
    columns: Range<usize>,
    scale: Option<T>,
    terms: impl Iterator<Item = usize>,
    factors: &impl Factors<T>,
) {
    let full = (B - 1) * C::WIDTH;
    let mut sums = [C::splat(T::ZERO); B];
    let own = &mut rows[row * n..][columns.clone()];
    for b in 0..B - 1 {
        sums[b] = C::load(&own[b * C::WIDTH..]);
    }
    sums[B - 1] = C::load_some(&own[full..]);
    if let Some(scale) = scale {
        let scale = C::splat(scale);
        for b in 0..B {
            sums[b] = sums[b].times(scale);
        }
    }
    for k in terms {
        let (factor, other) = (C::splat(factors.of(rows, k)), &rows[k * n..][columns.clone()]);
        for b in 0..B - 1 {
            sums[b] = sums[b].minus_product(factor, C::load(&other[b * C::WIDTH..]));
        }
        sums[B - 1] = sums[B - 1].minus_product(factor, C::load_some(&other[full..]));
    }
    let own = &mut rows[row * n..][columns];
    for b in 0..B - 1 {
        sums[b].store(&mut own[b * C::WIDTH..]);
    }
    sums[B - 1].store_some(&mut own[full..]);
}

/// Inverse of the mass matrix, M(q)⁻¹ = ∂a/∂τ; needs positions.
///
/// `factor` and `inverse` are nv × nv, row-major; the lower triangle of `factor` is left with the factors of
/// [`cholesky_into`], the upper one without meaning.
#[inline(always)]
pub fn mass_inverse_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    factor: &mut [T],
    inverse: &mut [T],
) {
    upper_mass_inverse_into(model, kinematics, workspace, factor, inverse);
    mirror(model.nv(), inverse);
}

/// [`mass_inverse_into`] of which the upper triangle is asked for.
#[inline(always)]
pub(super) fn upper_mass_inverse_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    factor: &mut [T],
    inverse: &mut [T],
) {
    lower_crba_into(model, kinematics, workspace, factor);
    cholesky_into(model, factor);
    upper_inverse_from_cholesky_into(model, factor, inverse);
}

/// [`mass_inverse_into`], allocating: the inverse alone.
pub fn mass_inverse<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let (mut factor, mut inverse) = (vec![T::ZERO; n * n], vec![T::ZERO; n * n]);
    mass_inverse_into(model, kinematics, &mut Workspace::new(model), &mut factor, &mut inverse);
    inverse
}

/// The velocities that the elimination touches, from the one before `start` on.
#[inline(always)]
fn pivots(model: &Model, start: usize) -> impl Iterator<Item = usize> + Clone + '_ {
    std::iter::successors(start.checked_sub(1), |&i| model.pivot(i).checked_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{BodySpec, JointSpec, ModelBuilder, Parent};

    /// Branches; joints in an order that is not depth first.
    fn tree() -> Model {
        robot(23, 2)
    }

    fn chain(joints: usize) -> Model {
        robot(joints, 1)
    }

    /// Joint k hangs on joint k − `apart`.
    fn robot(joints: usize, apart: usize) -> Model {
        let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
        for k in 0..joints {
            let joint = JointSpec::revolute(format!("q{k}"), [1.0, 0.3 * k as f64, -0.5], [0.2, -0.1, 0.3]);
            let body = BodySpec {
                name: format!("b{k}"),
                parent: k.checked_sub(apart).map_or(Parent::World, Parent::Body),
                joint,
                mass: 1.0,
                com: [0.1, 0.0, 0.0],
                inertia: [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2]],
            };
            builder.push(body).unwrap();
        }
        builder.finish().unwrap()
    }

    #[test]
    fn elimination_has_the_same_bits_by_rows_and_by_columns() {
        for model in [tree(), robot(45, 2), chain(17), chain(PIVOTS + 1)] {
            let n = model.nv();
            let kinematics = Kinematics::at_position(&model, &model.random(5));
            let mut factor = crate::dynamics::crba(&model, &kinematics);
            let mut alone = factor.clone();
            cholesky_into(&model, &mut factor);
            eliminate(&model, &mut alone);
            assert!(factor.iter().zip(&alone).all(|(a, b)| a.to_bits() == b.to_bits()), "{n} velocities");
            assert_eq!(model.is_deep(), n != 23);
        }
    }

    #[test]
    fn columns_have_the_bits_of_one_column() {
        let model = tree();
        let (n, q) = (model.nv(), model.random(7));
        let kinematics = Kinematics::at_position(&model, &q);
        let (mut factor, mut inverse) = (vec![f64::NAN; n * n], vec![f64::NAN; n * n]);
        mass_inverse_into(&model, &kinematics, &mut Workspace::new(&model), &mut factor, &mut inverse);
        let rows: Vec<f64> = (0..n * n).map(|k| (1.0 + 0.7 * k as f64).sin()).collect();
        let mut solved = rows.clone();
        solve_matrix(&model, &factor, &mut solved);
        let mut alone = rows.clone();
        Sweeps { model: &model, factor: &factor, rows: &mut alone, is_inverse: false }.run::<f64>();
        assert_eq!(solved, alone);
        for column in 0..n {
            let mut x: Vec<f64> = (0..n).map(|row| rows[row * n + column]).collect();
            cholesky_solve_into(&model, &factor, &mut x);
            assert!((0..n).all(|row| x[row].to_bits() == solved[row * n + column].to_bits()), "column {column}");
        }
        let mut upper = vec![0.0; n * n];
        (0..n).for_each(|k| upper[k * n + k] = 1.0);
        Sweeps { model: &model, factor: &factor, rows: &mut upper, is_inverse: true }.run::<f64>();
        for row in 0..n {
            assert_eq!(upper[row * n + row..][..n - row], inverse[row * n + row..][..n - row]);
        }
        let mass = crate::dynamics::crba(&model, &kinematics);
        for (row, column) in [(0, 1), (4, 3), (6, 2)] {
            let product: f64 = (0..n).map(|k| mass[row * n + k] * inverse[k * n + column]).sum();
            assert!(product.abs() < 1e-11, "{row} {column}: {product}");
        }
    }
}
