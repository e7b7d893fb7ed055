//! What can be wrong with a CSV file, and where.

use std::path::PathBuf;

/// Why a CSV file cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {problem}", file.display(), place(problem))]
pub struct CsvError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it.
    pub problem: CsvProblem,
}

/// What is wrong with a CSV file. Lines and columns count from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CsvProblem {
    /// The operating system refused.
    #[error("cannot be read: {source}")]
    Unreadable {
        /// Why.
        source: std::io::Error,
    },
    /// A folder, a pipe or a device.
    #[error("not a regular file")]
    NotAFile,
    /// Nothing in it.
    #[error("the file is empty; a header row and rows of numbers are needed")]
    Empty,
    /// The first row holds numbers.
    #[error("the first row must name the columns, but it starts with the number {first}")]
    NoHeader {
        /// Its line.
        line: u64,
        /// Its first cell.
        first: String,
    },
    /// A column without name.
    #[error("column {column} has no name in the header")]
    NoName {
        /// The header's line.
        line: u64,
        /// The column.
        column: usize,
    },
    /// Two columns of one name.
    #[error("columns {first} and {second} are both called `{name}`")]
    DuplicateName {
        /// The header's line.
        line: u64,
        /// The name.
        name: String,
        /// The first column.
        first: usize,
        /// The second column.
        second: usize,
    },
    /// Cells separated by something else than commas.
    #[error("columns must be separated by {}, but the header has {separator:?} as character {at}", separated(*own))]
    OtherSeparator {
        /// The header's line.
        line: u64,
        /// What the header has.
        separator: char,
        /// What was asked for.
        own: char,
        /// Where it stands in the header, in characters from 1.
        at: usize,
    },
    /// No column of that name.
    #[error("no column `{name}`{}; the columns are {}", meant(suggestion), headers.join(", "))]
    MissingColumn {
        /// The header's line.
        line: u64,
        /// The name.
        name: String,
        /// What was probably meant.
        suggestion: Option<String>,
        /// The names there are, the first twenty.
        headers: Vec<String>,
    },
    /// A cell that is no number.
    #[error("`{text}` in column {column} (`{name}`) is not a number")]
    NotANumber {
        /// The cell.
        text: String,
        /// Its line.
        line: u64,
        /// Its column.
        column: usize,
        /// The column's name.
        name: String,
    },
    /// An empty cell where a number should be.
    #[error("column {column} (`{name}`) is empty")]
    NoNumber {
        /// Its line.
        line: u64,
        /// Its column.
        column: usize,
        /// The column's name.
        name: String,
    },
    /// NaN, infinity, or beyond the range of numbers.
    #[error("`{text}` in column {column} (`{name}`) is not a finite number")]
    NotFinite {
        /// The cell.
        text: String,
        /// Its line.
        line: u64,
        /// Its column.
        column: usize,
        /// The column's name.
        name: String,
    },
    /// A time that is not later than the one before.
    #[error("times must increase, but {time} follows {before}")]
    TimeNotIncreasing {
        /// The line of the later row.
        line: u64,
        /// Its time.
        time: f64,
        /// Time of the row before.
        before: f64,
    },
    /// A row with more or fewer cells than the header.
    #[error("{given} cells, but the header has {wanted}")]
    Ragged {
        /// The row's line.
        line: u64,
        /// Its cells.
        given: usize,
        /// Cells of the header.
        wanted: usize,
    },
    /// Fewer than two rows of numbers.
    #[error("{given} rows of numbers; at least two are needed")]
    TooFewRows {
        /// The last line that is not blank.
        line: u64,
        /// How many there are.
        given: usize,
    },
    /// Bytes that are not UTF-8.
    #[error("column {column} is not UTF-8 text; save the file as UTF-8")]
    NotUtf8 {
        /// The line.
        line: u64,
        /// The column.
        column: usize,
    },
    /// A line that no table has.
    #[error("the line is longer than {limit} bytes; this is not a table of numbers")]
    LongLine {
        /// The line.
        line: u64,
        /// The limit.
        limit: u64,
    },
    /// More than fits into memory with reason.
    #[error("more than {limit} {what}")]
    TooLarge {
        /// The limit.
        limit: u64,
        /// Of what.
        what: &'static str,
    },
}

impl CsvProblem {
    /// The line it is about, from 1.
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::NoHeader { line, .. }
            | Self::NoName { line, .. }
            | Self::DuplicateName { line, .. }
            | Self::OtherSeparator { line, .. }
            | Self::MissingColumn { line, .. }
            | Self::TooFewRows { line, .. }
            | Self::LongLine { line, .. }
            | Self::NotANumber { line, .. }
            | Self::NoNumber { line, .. }
            | Self::NotFinite { line, .. }
            | Self::TimeNotIncreasing { line, .. }
            | Self::Ragged { line, .. }
            | Self::NotUtf8 { line, .. } => Some(*line),
            _ => None,
        }
    }

    /// The column it is about, from 1.
    pub fn column(&self) -> Option<usize> {
        match self {
            Self::NotANumber { column, .. }
            | Self::NoNumber { column, .. }
            | Self::NotFinite { column, .. }
            | Self::NotUtf8 { column, .. }
            | Self::NoName { column, .. } => Some(*column),
            Self::DuplicateName { second, .. } => Some(*second),
            Self::OtherSeparator { .. } => Some(1),
            _ => None,
        }
    }
}

fn place(problem: &CsvProblem) -> String {
    problem.line().map_or_else(String::new, |line| format!(":{line}"))
}

fn separated(own: char) -> String {
    if own == ',' { "commas".to_owned() } else { format!("{own:?}") }
}

fn meant(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}
