//! What is fitted: residuals and their derivatives, in blocks of rows.

use super::parameter::Parameter;

/// How residuals of a series add to the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// r².
    Squares,
    /// r² up to k standard deviations, 2·k·s·|r| − (k·s)² beyond, s = 1.4826 times the median of |r| (P. J. Huber, Robust Statistics,
    /// 1981).
    Huber(f64),
}

/// A column of residuals, whose rows follow one another.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// How it adds to the cost.
    pub loss: Loss,
    /// Whether residuals are in units of a standard deviation that is known.
    pub has_sd: bool,
}

impl Series {
    /// Squares, of a standard deviation that is estimated.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), loss: Loss::Squares, has_sd: false }
    }
}

/// A block of rows of one series.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// Its place among [`Problem::series`].
    pub series: usize,
    /// r.
    pub residuals: &'a [f64],
    /// ∂r/∂p, row by row, a column for each parameter; what was not wanted is not read. Empty where nothing was.
    pub jacobian: &'a [f64],
}

/// Why there are no residuals for some values: such a trial counts as one of infinite cost.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Failed(pub String);

/// Residuals and their exact derivatives by the parameters.
pub trait Problem: Sync {
    /// What is sought.
    fn parameters(&self) -> &[Parameter];

    /// The columns of residuals.
    fn series(&self) -> &[Series];

    /// How many linear unknowns were taken out of the residuals before they are handed over, such as what was before a record: they count as
    /// estimated.
    fn eliminated(&self) -> usize {
        0
    }

    /// Changes of the cost below this share of it are noise, such as that of the steps of a run.
    fn noise(&self) -> f64 {
        0.0
    }

    /// Hands over all rows at these values, those of each series in their order, in blocks of any size; the same rows at all values.
    /// `wanted` says of each parameter whether the derivatives by it are asked for.
    ///
    /// # Errors
    /// [`Failed`]: there are none.
    fn rows(&self, values: &[f64], wanted: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed>;
}
