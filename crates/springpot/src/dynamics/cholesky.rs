//! The mass matrix factorised along the tree, and what follows from it.

use super::crba::crba_into;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::Scalar;

/// Factors M = Lᵀ D L in place: L, unit lower triangular, is 0 wherever neither of two joints carries the other, so that
/// branches cause no fill-in.
///
/// `mass` is nv × nv, row-major, symmetric; afterwards its lower triangle holds L and its diagonal D, the upper triangle is as
/// it was. O(n d²) operations (d: depth of the tree). D_j is the inertia that joint j feels when all joints beyond it are
/// free; where the mass matrix is singular, infinities and NaN follow. Source: Featherstone, Rigid Body Dynamics Algorithms,
/// 2008, §6.5.
pub fn cholesky_into<T: Scalar>(model: &Model, mass: &mut [T]) {
    let n = model.nv();
    assert_eq!(mass.len(), n * n, "the mass matrix is nv x nv");
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
pub fn cholesky_solve_into<T: Scalar>(model: &Model, factor: &[T], x: &mut [T]) {
    solve_rows(model, factor, 1, x);
}

/// Solves M X = Y for the columns of an nv × nv matrix, in place.
pub(super) fn solve_matrix<T: Scalar>(model: &Model, factor: &[T], x: &mut [T]) {
    solve_rows(model, factor, model.nv(), x);
}

fn solve_rows<T: Scalar>(model: &Model, factor: &[T], width: usize, x: &mut [T]) {
    let n = model.nv();
    assert_eq!(factor.len(), n * n, "the factors are nv x nv");
    assert_eq!(x.len(), n * width, "the right-hand side has nv rows");
    for k in (0..n).rev() {
        let (before, rest) = x.split_at_mut(k * width);
        let row = &mut rest[..width];
        for j in pivots(model, model.pivot(k)) {
            subtract(&mut before[j * width..][..width], factor[k * n + j], row);
        }
        let inverse = T::ONE / factor[k * n + k];
        for entry in row {
            *entry = *entry * inverse;
        }
    }
    for k in 0..n {
        let (before, rest) = x.split_at_mut(k * width);
        let row = &mut rest[..width];
        for j in pivots(model, model.pivot(k)) {
            subtract(row, factor[k * n + j], &before[j * width..][..width]);
        }
    }
}

/// The inverse M⁻¹ from the factors of [`cholesky_into`]: symmetric, both triangles written, nv × nv, row-major.
///
/// Only the upper triangle is computed: L⁻ᵀ has no lower one, and row k of M⁻¹ = L⁻¹ (D⁻¹ L⁻ᵀ) needs from the rows above it
/// the columns from k on.
pub fn inverse_from_cholesky_into<T: Scalar>(model: &Model, factor: &[T], inverse: &mut [T]) {
    let n = model.nv();
    assert_eq!(factor.len(), n * n, "the factors are nv x nv");
    assert_eq!(inverse.len(), n * n, "the inverse is nv x nv");
    inverse.fill(T::ZERO);
    for k in (0..n).rev() {
        let (before, rest) = inverse.split_at_mut(k * n);
        let row = &mut rest[k..n];
        row[0] = T::ONE;
        for j in pivots(model, model.pivot(k)) {
            subtract(&mut before[j * n + k..][..n - k], factor[k * n + j], row);
        }
        let pivot = T::ONE / factor[k * n + k];
        for entry in row {
            *entry = *entry * pivot;
        }
    }
    for k in 0..n {
        let (before, rest) = inverse.split_at_mut(k * n);
        let row = &mut rest[k..n];
        for j in pivots(model, model.pivot(k)) {
            subtract(row, factor[k * n + j], &before[j * n + k..][..n - k]);
        }
    }
    for k in 1..n {
        for j in 0..k {
            inverse[k * n + j] = inverse[j * n + k];
        }
    }
}

/// Inverse of the mass matrix, M(q)⁻¹ = ∂a/∂τ; needs positions.
///
/// `factor` and `inverse` are nv × nv, row-major; `factor` is left with the factors of [`cholesky_into`].
pub fn mass_inverse_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    factor: &mut [T],
    inverse: &mut [T],
) {
    crba_into(model, kinematics, workspace, factor);
    cholesky_into(model, factor);
    inverse_from_cholesky_into(model, factor, inverse);
}

/// [`mass_inverse_into`], allocating: the inverse alone.
pub fn mass_inverse<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let (mut factor, mut inverse) = (vec![T::ZERO; n * n], vec![T::ZERO; n * n]);
    mass_inverse_into(model, kinematics, &mut Workspace::new(model), &mut factor, &mut inverse);
    inverse
}

/// The velocities that the elimination touches, from the one before `start` on.
#[inline]
fn pivots(model: &Model, start: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(start.checked_sub(1), |&i| model.pivot(i).checked_sub(1))
}

/// row −= factor · other.
#[inline]
fn subtract<T: Scalar>(row: &mut [T], factor: T, other: &[T]) {
    for (entry, &o) in row.iter_mut().zip(other) {
        *entry -= factor * o;
    }
}
