//! How a run is carried out.

use super::error::RunError;
use super::fixed_step::FixedStep;
use super::row_times::RowTimes;
use std::sync::atomic::AtomicBool;

/// How a run is carried out.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// End of the motion, s; it starts at 0.
    pub end: f64,
    /// When rows are written.
    pub rows: RowTimes,
    /// Relative tolerance of every D^alpha x, in units of its largest value so far; of forward runs that of the motion, in units of its
    /// largest travel and speed so far.
    pub rtol: f64,
    /// Errors below this are not looked at: of D^alpha x, in forward runs of q and v. `None`: the relative tolerance alone.
    pub atol: Option<f64>,
    /// Relative tolerance of the kernels.
    pub memory_rtol: f64,
    /// First inner step, s.
    pub first_step: Option<f64>,
    /// Longest inner step, s.
    pub max_step: Option<f64>,
    /// Number of inner steps allowed; `None`: ten million, and a hundred more for every switch of the signals.
    pub max_steps: Option<u64>,
    /// Steps of one size, of forward dynamics; `None`: the run chooses its steps.
    pub fixed_step: Option<FixedStep>,
    /// Which method of forward dynamics chooses its steps, where they are not of one size.
    pub adaptive: Adaptive,
}

/// A method of forward dynamics that chooses its steps for a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Adaptive {
    /// The explicit one where no law keeps anything, no force has kinks and nothing is stiff, else the implicit one; it may change on the way.
    #[default]
    Either,
    /// Radau IIA(5), for whatever there is.
    Radau,
    /// Dormand and Prince's method of order 8, for what is smooth.
    Explicit,
}

impl Adaptive {
    /// Its name in scenario files; none where the run chooses.
    pub const fn name(self) -> Option<&'static str> {
        match self {
            Self::Either => None,
            Self::Radau => Some("radau"),
            Self::Explicit => Some("explicit"),
        }
    }
}

impl Settings {
    /// A run to `end`, s, with a tolerance of 1e-9 and kernels a hundred times as exact; whatever can be left out is.
    pub fn new(end: f64, rows: RowTimes) -> Self {
        Self {
            end,
            rows,
            rtol: 1e-9,
            atol: None,
            memory_rtol: 1e-11,
            first_step: None,
            max_step: None,
            max_steps: None,
            fixed_step: None,
            adaptive: Adaptive::default(),
        }
    }

    /// Whether steps can be taken with them.
    pub(crate) fn check(&self) -> Result<(), RunError> {
        let Self { end, rtol, atol, memory_rtol, first_step, max_step, fixed_step, .. } = self;
        let fixed = fixed_step.map(|by| by.step);
        let positive = [
            ("time.end", Some(*end)),
            ("solver.rtol", Some(*rtol)),
            ("solver.memory_rtol", Some(*memory_rtol)),
            ("solver.first_step", *first_step),
            ("solver.max_step", *max_step),
            ("solver.step", fixed),
        ];
        for (what, value) in positive.into_iter().filter_map(|(what, value)| Some((what, value?))) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RunError::Setting { what, value });
            }
        }
        match atol {
            Some(atol) if !(*atol >= 0.0 && atol.is_finite()) => {
                Err(RunError::Setting { what: "solver.atol", value: *atol })
            }
            _ => Ok(()),
        }
    }
}

/// A flag that interrupts runs from outside.
pub type Stop = AtomicBool;
