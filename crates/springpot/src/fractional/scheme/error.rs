//! What a scheme can refuse.

use super::Scheme;

/// A scheme's name or number that does not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SchemeNameError {
    /// No scheme has this name.
    #[error(
        "unknown scheme \"{0}\": right are grunwald-letnikov, grunwald-letnikov(N) with N ≥ {memory}, l1, l1-2, \
         fbdf-1 to fbdf-6, expansion-2004(N) with N from {min_2004} to {max} and expansion-2008(N) with N from \
         {min_2008} to {max}",
        memory = Scheme::MEMORY.start(),
        min_2004 = Scheme::TERMS_2004.start(), min_2008 = Scheme::TERMS_2008.start(), max = Scheme::TERMS_2008.end()
    )]
    Unknown(String),
    /// Fractional backward differences have order 1 to 6.
    #[error("fbdf-{0} does not exist: the order of the fractional backward difference is 1 to 6")]
    Order(u32),
    /// The short memory's number of samples is out of range.
    #[error(
        "grunwald-letnikov({0}): the memory must have {min} to {max} samples",
        min = Scheme::MEMORY.start(), max = Scheme::MEMORY.end()
    )]
    Memory(u32),
    /// The expansion's number of terms is out of range.
    #[error("expansion-{form}({terms}): the number of terms must lie between {min} and {max}")]
    Terms {
        /// Year of the form: 2004 or 2008.
        form: u16,
        /// What was asked for.
        terms: u32,
        /// Fewest terms.
        min: u32,
        /// Most terms.
        max: u32,
    },
}

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
