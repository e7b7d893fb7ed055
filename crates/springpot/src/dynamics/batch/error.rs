//! Why a batch has no results, or not all of them.

/// Why a batch has no results, or not all of them.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// An argument holds no whole number of rows.
    #[error("{name} holds {found} numbers, which are no whole rows of {width}")]
    NoWholeRows {
        /// Which argument.
        name: &'static str,
        /// Its numbers.
        found: usize,
        /// Numbers of one row.
        width: usize,
    },
    /// An argument has another number of rows than the first.
    #[error("{name} holds {found} rows of {width}, and {first} holds {rows}; they must hold as many")]
    OtherRows {
        /// Which argument.
        name: &'static str,
        /// Its rows.
        found: usize,
        /// Numbers of one row.
        width: usize,
        /// The first argument.
        first: &'static str,
        /// Its rows.
        rows: usize,
    },
    /// The results of a row hold a number that is not finite. All rows are worked out, and no row feels another.
    #[error(
        "row {row}: the result holds {value}: the state is not finite, its numbers are too large, its mass matrix has no \
         inverse, or two points coincide"
    )]
    NotFinite {
        /// The first such row.
        row: usize,
        /// That number.
        value: f64,
    },
}
