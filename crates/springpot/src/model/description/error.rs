//! Where something is wrong with a URDF file, and whose it is.

use std::fmt;
use std::path::{Path, PathBuf};

use super::problem::DescriptionProblem;

/// Why a URDF file is no robot; `Display` is `file:line:column: what is wrong and what would be right`.
#[derive(Debug)]
pub struct DescriptionError {
    /// The file, as it was given; `None` for text that came without one.
    pub file: Option<PathBuf>,
    /// Line and column, from 1; the column counts characters.
    pub place: Option<(usize, usize)>,
    /// What is wrong.
    pub problem: Box<DescriptionProblem>,
}

impl DescriptionError {
    pub(super) fn new(file: Option<&Path>, place: Option<(usize, usize)>, problem: DescriptionProblem) -> Self {
        Self { file: file.map(Path::to_path_buf), place, problem: Box::new(problem) }
    }

    /// The line it is about, from 1; `None` where the whole file is meant.
    pub fn line(&self) -> Option<usize> {
        self.place.map(|(line, _)| line)
    }
}

impl fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.file, self.place) {
            (Some(file), Some((line, column))) => write!(f, "{}:{line}:{column}: ", file.display())?,
            (Some(file), None) => write!(f, "{}: ", file.display())?,
            (None, Some((line, column))) => write!(f, "line {line}, column {column}: ")?,
            (None, None) => {}
        }
        self.problem.fmt(f)
    }
}

impl std::error::Error for DescriptionError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.problem.source()
    }
}
