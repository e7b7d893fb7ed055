//! Small dense linear algebra. Matrices are row-major; the joint-space mass matrix has its own factors in `dynamics`.

pub(crate) mod columns;
mod complex;
mod eigen;
mod gauss;
mod hessenberg;
mod independence;
mod least_norm;
mod lu;
mod row_lu;
mod svd;
mod triangle;

pub(crate) use complex::ComplexLu;
pub(crate) use eigen::symmetric_eigenvalues;
#[cfg(feature = "urdf")]
pub(crate) use eigen::symmetric_eigenvectors;
pub(crate) use gauss::{gauss_rule, gauss_rules};
pub(crate) use hessenberg::eigenvalues;
pub(crate) use independence::{are_independent, cholesky_solve};
pub(crate) use least_norm::LeastNorm;
pub(crate) use lu::Lu;
pub(crate) use row_lu::RowLu;
pub(crate) use svd::column_singular_values;
pub(crate) use triangle::Triangle;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
