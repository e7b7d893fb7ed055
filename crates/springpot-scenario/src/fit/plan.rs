//! What a fit is made of, as it is read.

use crate::text::refusal::Place;
use springpot::identification::Parameter;
use std::path::PathBuf;

/// What is fitted to what, and how.
#[derive(Debug, Clone)]
pub struct FitPlan {
    /// Title of the scenario.
    pub title: Option<String>,
    /// What is sought: those of `[[parameter]]`, then those of each record.
    pub parameters: Vec<FitParameter>,
    /// The records, in their order.
    pub data: Vec<DataPlan>,
    /// How it is fitted.
    pub settings: FitSettings,
}

/// `[fit]`.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSettings {
    /// Starts.
    pub starts: usize,
    /// Of random numbers.
    pub seed: u64,
    /// Of the intervals.
    pub confidence: f64,
    /// How intervals are found.
    pub intervals: Intervals,
    /// Laws that are fitted one after the other.
    pub laws: Vec<String>,
    /// The element that they are of.
    pub element: Option<String>,
}

/// How intervals are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Intervals {
    /// Value ± t·sd in the variable of the scale.
    Wald,
    /// Where the cost of the others' best has risen.
    Profile,
    /// From so many fits of residuals that are drawn anew.
    Bootstrap(usize),
}

impl Intervals {
    /// `wald`, `profile` or `bootstrap(COUNT)`.
    pub fn named(text: &str) -> Option<Self> {
        match text.trim() {
            "wald" => Some(Self::Wald),
            "profile" => Some(Self::Profile),
            other => {
                let count = other.strip_prefix("bootstrap(")?.strip_suffix(')')?.trim().parse().ok()?;
                (20..=100_000).contains(&count).then_some(Self::Bootstrap(count))
            }
        }
    }
}

/// A parameter of a fit.
#[derive(Debug, Clone)]
pub struct FitParameter {
    /// Name, starts, bounds, scale, SI.
    pub sought: Parameter,
    /// What it is in the file; nothing where the file has no number of it.
    pub paths: Vec<String>,
    /// Its value in the file, SI.
    pub value: f64,
    /// Its unit, SI; empty for pure numbers.
    pub unit: String,
    /// What it is.
    pub role: Role,
    /// Where it stands.
    pub place: Place,
}

/// What a parameter of a fit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A number of the file, of one record alone or of all.
    Number {
        /// The record.
        record: Option<usize>,
    },
    /// The unknown zero of a column.
    Offset {
        /// The record.
        record: usize,
        /// The column.
        column: usize,
    },
    /// By how much a column is late, s.
    Delay {
        /// The record.
        record: usize,
        /// The column.
        column: usize,
    },
}

/// What a record is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DataKind {
    /// Columns of a run.
    Run,
    /// Force along a stroke.
    Stroke,
    /// Storage and loss, or modulus and tan δ, over the frequency.
    Dma {
        /// Whether modulus and tan δ are given.
        is_polar: bool,
    },
    /// G(t).
    Relaxation,
    /// J(t).
    Creep,
}

impl DataKind {
    /// Its word in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run => crate::keys::RUN,
            Self::Stroke => crate::keys::STROKE,
            Self::Dma { .. } => crate::keys::DMA,
            Self::Relaxation => crate::keys::RELAXATION,
            Self::Creep => crate::keys::CREEP,
        }
    }

    /// Whether residuals are relative.
    pub fn is_relative(self) -> bool {
        !matches!(self, Self::Run | Self::Stroke)
    }
}

/// What was before a stroke was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PastOfStroke {
    /// Held at its first value.
    Held,
    /// Unloaded.
    Unloaded,
    /// Unknown.
    Free,
}

/// A record.
#[derive(Debug, Clone)]
pub struct DataPlan {
    /// Its name.
    pub name: String,
    /// What it is of.
    pub kind: DataKind,
    /// The element, of kinds that have one.
    pub element: Option<String>,
    /// The file.
    pub file: PathBuf,
    /// Line in the file of each row.
    pub lines: Vec<u64>,
    /// Rows without all their cells.
    pub skipped: usize,
    /// t, s, or ω, rad/s, of each row.
    pub at: Vec<f64>,
    /// What was measured.
    pub columns: Vec<DataColumn>,
    /// What else is told row by row: the stroke, inputs, the amplitude; SI.
    pub told: Vec<(String, Vec<f64>)>,
    /// Standard deviation of both columns, as a share.
    pub relative_sd: Option<f64>,
    /// Whether it is fitted; else it is predicted.
    pub is_fitted: bool,
    /// The multiple beyond which Huber's loss bends.
    pub huber: Option<f64>,
    /// Where rows count, s: those of a stroke outside are its past.
    pub window: Option<[f64; 2]>,
    /// What was before.
    pub past: PastOfStroke,
    /// Of the low-pass, Hz.
    pub low_pass: Option<f64>,
    /// The parameters that its model follows from, offsets and delays not among them.
    pub parameters: Vec<usize>,
    /// Where it stands.
    pub place: Place,
}

/// A column of a record.
#[derive(Debug, Clone)]
pub struct DataColumn {
    /// What was measured: the column of the run, or what the kind calls it.
    pub name: String,
    /// Its unit, SI.
    pub unit: String,
    /// The numbers, SI.
    pub measured: Vec<f64>,
    /// The standard deviation of each number, SI; nothing where it is estimated.
    pub sd: Option<Vec<f64>>,
    /// The parameter that is its zero.
    pub offset: Option<usize>,
    /// The parameter that says how late it is.
    pub delay: Option<usize>,
}

impl DataPlan {
    /// How many rows count.
    pub fn rows(&self) -> usize {
        self.counted().count()
    }

    /// The rows that count.
    pub fn counted(&self) -> impl Iterator<Item = usize> + '_ {
        let inside = |t: f64| self.window.is_none_or(|[from, to]| (from..=to).contains(&t));
        (0..self.at.len()).filter(move |row| inside(self.at[*row]))
    }

    /// What else is told of the rows under that name.
    pub fn told(&self, name: &str) -> Option<&[f64]> {
        self.told.iter().find(|(own, _)| own == name).map(|(_, values)| values.as_slice())
    }
}
