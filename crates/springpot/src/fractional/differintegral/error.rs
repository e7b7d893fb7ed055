//! What can be wrong with an order, samples or a closure.

use super::method::Method;
use crate::fractional::kernel::KernelError;
use crate::fractional::scheme::SchemeError;

/// Why nothing was differentiated. Rows count from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DerivativeError {
    /// The order is NaN or outside [−2, 2].
    #[error("the order {0} must lie between -2 and 2")]
    Order(f64),
    /// Fewer rows than the method needs.
    #[error("{method} needs at least {needed} rows, there are {found}")]
    TooShort {
        /// The method.
        method: Method,
        /// Fewest rows.
        needed: usize,
        /// Rows given.
        found: usize,
    },
    /// The samples, or what a named scheme asks of them.
    #[error(transparent)]
    Samples(#[from] SchemeError),
    /// A sample of a stream is NaN or infinite.
    #[error("{column} is {value} in row {row}: not a finite number")]
    NotFinite {
        /// What is not finite: t, x or rate.
        column: &'static str,
        /// Row.
        row: usize,
        /// What stands there.
        value: f64,
    },
    /// The times of a stream start at 0 and increase strictly.
    #[error(
        "t = {t} in row {row} is out of order: the first is 0, and every other follows the one before, here {previous}"
    )]
    OutOfOrder {
        /// Row.
        row: usize,
        /// Its time.
        t: f64,
        /// The time before; −0 in the first row.
        previous: f64,
    },
    /// A stream went on for longer than its memory was built for.
    #[error("t = {t} lies beyond the horizon of {horizon} s that the stream was made for")]
    Horizon {
        /// Time of the sample.
        t: f64,
        /// Longest time that the memory holds.
        horizon: f64,
    },
    /// The memory could not be built.
    #[error(transparent)]
    Kernel(#[from] KernelError),
}

/// Why a closure is not a function that can be differentiated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FunctionError {
    /// The interval is empty, does not start at a finite time, or the next piece does not start where this one ends.
    #[error("from t = {start} to t = {end} there is no interval")]
    Interval {
        /// Start, s.
        start: f64,
        /// End, s.
        end: f64,
    },
    /// The tolerance is outside [1e-15, 0.1].
    #[error("the relative tolerance must lie between 1e-15 and 0.1, not {0}")]
    Tolerance(f64),
    /// NaN or infinity.
    #[error("the function is {value} at t = {t}")]
    NotFinite {
        /// Where.
        t: f64,
        /// What it is there.
        value: f64,
    },
    /// The function is too rough to be followed to this tolerance.
    #[error("after {pieces} pieces the function is still not met to {rtol:e} near t = {t}; a larger rtol may help")]
    Unresolved {
        /// Number of pieces made.
        pieces: usize,
        /// Where the next one would be.
        t: f64,
        /// The relative tolerance.
        rtol: f64,
    },
    /// The samples that a spline should go through.
    #[error(transparent)]
    Samples(#[from] SchemeError),
}
