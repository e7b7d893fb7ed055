//! How samples become a function of time.

use super::hermite::Form;
use crate::fractional::scheme::{Scheme, SchemeNameError};
use std::fmt;
use std::str::FromStr;

/// What stands for x between the samples, and how the past is summed.
///
/// Orders of convergence are those in the step for smooth x at 0 ≤ a ≤ 2; integrals gain until rounding ends it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Method {
    /// `spline`: quintic Hermite spline, with x' and x'' of the samples from seven of them; the default. Order 7 − a,
    /// until rounding takes over (in the limit 6 − a, by a term 10⁴ times smaller).
    ///
    /// Exact for polynomials up to degree 5. Equal steps take exact moments of the kernel and O(N log N) by FFT, other
    /// steps exponentials.
    #[default]
    Spline,
    /// `hermite`: cubic Hermite spline, with the rates x' that are given, else from five samples; order 4 − a.
    ///
    /// Exact for cubics. It follows noise and kinks over fewer samples than `spline`.
    Hermite,
    /// `exponential`, also called `exact` as in scenario files: the spline, its past through a sum of exponentials on any
    /// steps: O(log N) per sample, and the same numbers as [`Stream`](super::Stream).
    Exponential,
    /// A scheme of the literature by its name.
    Scheme(Scheme),
}

impl Method {
    /// All names, for lists and suggestions; N stands for a number of terms.
    pub const NAMES: [&str; 3 + Scheme::NAMES.len()] = {
        let mut names = ["spline"; 3 + Scheme::NAMES.len()];
        (names[1], names[2]) = ("hermite", "exponential");
        let mut k = 0;
        while k < Scheme::NAMES.len() {
            names[3 + k] = Scheme::NAMES[k];
            k += 1;
        }
        names
    };

    /// Fewest rows the method can work on at this order.
    pub fn min_rows(self, order: f64) -> usize {
        match self {
            Self::Spline | Self::Hermite | Self::Exponential => 2,
            Self::Scheme(scheme) => scheme.min_rows(order),
        }
    }

    /// The piecewise polynomial, where there is one.
    pub(super) fn form(self) -> Result<Form, Scheme> {
        match self {
            Self::Spline | Self::Exponential => Ok(Form::Quintic),
            Self::Hermite => Ok(Form::Cubic),
            Self::Scheme(scheme) => Err(scheme),
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Spline => f.pad("spline"),
            Self::Hermite => f.pad("hermite"),
            Self::Exponential => f.pad("exponential"),
            Self::Scheme(scheme) => scheme.fmt(f),
        }
    }
}

/// A method of this name does not exist, or its number is out of range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MethodNameError {
    /// No method has this name.
    #[error("unknown method \"{0}\": right are {names}", names = Method::NAMES.join(", "))]
    Unknown(String),
    /// The number in the name of a scheme is out of range.
    #[error(transparent)]
    Scheme(SchemeNameError),
}

impl FromStr for Method {
    type Err = MethodNameError;

    fn from_str(name: &str) -> Result<Self, MethodNameError> {
        Ok(match name {
            "spline" => Self::Spline,
            "hermite" => Self::Hermite,
            "exponential" | "exact" => Self::Exponential,
            _ => Self::Scheme(name.parse().map_err(|error| match error {
                SchemeNameError::Unknown(name) => MethodNameError::Unknown(name),
                error => MethodNameError::Scheme(error),
            })?),
        })
    }
}
