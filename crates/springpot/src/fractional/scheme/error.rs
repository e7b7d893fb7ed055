//! What a scheme can refuse.

use super::named::{Scheme, SchemeNameError};

/// Why samples were not differentiated. Rows count from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SchemeError {
    /// The order of the derivative is NaN or outside [−2, 2].
    #[error("the order {0} must lie in [-2, 2]")]
    Order(f64),
    /// The scheme does not have this order.
    #[error(
        "{scheme} has orders from {min} to {max}, not {order}: \
         grunwald-letnikov, l1-2 and fbdf-1 to fbdf-6 have all from -2 to 2"
    )]
    OrderOfScheme {
        /// The scheme.
        scheme: Scheme,
        /// What was asked for.
        order: f64,
        /// Lowest order of the scheme.
        min: f64,
        /// Highest order of the scheme.
        max: f64,
    },
    /// The scheme itself does not exist.
    #[error(transparent)]
    Scheme(#[from] SchemeNameError),
    /// A column has another length than `t`.
    #[error("{column} has {found} rows, t has {expected}")]
    Length {
        /// Name of the column: x or rate.
        column: &'static str,
        /// Rows of `t`.
        expected: usize,
        /// Rows of the column.
        found: usize,
    },
    /// Fewer rows than the scheme's stencil.
    #[error("{scheme} needs at least {needed} rows, there are {found}")]
    TooShort {
        /// The scheme.
        scheme: Scheme,
        /// Fewest rows.
        needed: usize,
        /// Rows given.
        found: usize,
    },
    /// A sample is NaN or infinite.
    #[error("{column} is {value} in row {row}: not a finite number")]
    NotFinite {
        /// Name of the column: t, x or rate.
        column: &'static str,
        /// Row.
        row: usize,
        /// What stands there.
        value: f64,
    },
    /// The memory starts at t = 0, and so must the samples.
    #[error("the first row is at t = {0}, not at 0")]
    Start(f64),
    /// Times must increase strictly.
    #[error("t = {t} in row {row} does not follow t = {previous} in the row before")]
    NotIncreasing {
        /// Row.
        row: usize,
        /// Its time.
        t: f64,
        /// The time before.
        previous: f64,
    },
    /// The scheme wants equal steps.
    #[error(
        "{scheme} needs equal steps of {step} s, but row {row} is at t = {t} s, not {expected} s; \
         l1, l1-2 and the expansions take any steps"
    )]
    NotUniform {
        /// The scheme.
        scheme: Scheme,
        /// First row off the grid.
        row: usize,
        /// Its time.
        t: f64,
        /// Where the grid of the rows before would have it.
        expected: f64,
        /// Step of the rows before.
        step: f64,
    },
    /// Rows off the uniform grid are summed directly, and that sum would be too long.
    #[error(
        "the {rows} rows after the last equal step need a direct sum of {terms} terms, above the limit of {limit}: \
         give equal steps (a shorter last one is fine) or fewer rows"
    )]
    TooManyIrregularRows {
        /// Rows off the uniform grid.
        rows: usize,
        /// Terms of their direct sums.
        terms: u64,
        /// The limit.
        limit: u64,
    },
}
