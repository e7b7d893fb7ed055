//! Why a run cannot go on.

use crate::table::folder::FolderError;
use crate::table::sealed::SealError;
use springpot_scenario::Refusals;
use std::io;
use std::path::{Path, PathBuf};

/// Why a run cannot go on from what is in its folder.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// There is none.
    #[error("{} holds no checkpoint", .0.display())]
    Missing(PathBuf),
    /// The run came to its end.
    #[error("the run in {} has come to its end: nothing is left to do", .0.display())]
    Finished(PathBuf),
    /// The run had come to its end, and its results were put in their place just now.
    #[error("the results in {} were complete, and are in their place now: nothing is left to do", results.display())]
    Settled {
        /// The folder.
        results: PathBuf,
        /// How it ended, as run.json says.
        status: String,
    },
    /// The folder takes no results.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A file of the checkpoint is not what was written.
    #[error("the checkpoint is damaged: {}", .0.display())]
    Damaged(PathBuf),
    /// The rows end before the checkpoint, or are not those that were written.
    #[error("the rows do not belong to the checkpoint: {}", .0.display())]
    Rows(PathBuf),
    /// Another version or build wrote it.
    #[error("the checkpoint was written by another version or build ({found}): {}", file.display())]
    OtherVersion {
        /// Its file.
        file: PathBuf,
        /// What it says of its version.
        found: String,
    },
    /// The scenario, or a file that it names, has changed.
    #[error("{what} has changed since the run began")]
    OtherScenario {
        /// The scenario's file, or what it names.
        what: String,
    },
    /// The scenario is refused.
    #[error(transparent)]
    Refused(#[from] Refusals),
    /// A file of the checkpoint cannot be read.
    #[error("{}: {source}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The file system's reason.
        source: io::Error,
    },
}

impl CheckpointError {
    /// What is wrong with `file`.
    pub(super) fn of(file: &Path, error: SealError) -> Self {
        let file = file.to_owned();
        match error {
            SealError::File(source) => Self::File { file, source },
            SealError::OtherVersion(found) => Self::OtherVersion { file, found },
            SealError::Damaged => Self::Damaged(file),
        }
    }
}

/// The file system's reason why `file` cannot be read or written.
pub(super) fn at(file: &Path) -> impl FnOnce(io::Error) -> CheckpointError {
    move |source| CheckpointError::File { file: file.to_owned(), source }
}
