//! Putting a run's files in the place of the last run's: all of them, or none.
//!
//! New files wait in `.unfinished`, the rows in `results.csv.part`, all of them safe from the loss of power. Then `.unfinished/commit` is
//! written, whole or not at all: it names them and the last run's, and from then on the new ones are the valid ones. What follows
//! may be broken off anywhere and done again: run.json of the last run goes first, so that nothing claims to be a whole that is not; then
//! its other files and the pages made of them, unless the new ones replace them; the new ones get their names, run.json last; the commit is taken away.

use super::FolderError;
use super::owned::{
    COMMIT, FIGURES, PART, RESULTS, RUN, UNFINISHED, clear_unfinished, is_figure, remove_checkpoint, remove_pages,
};
use crate::table::disk::{Disk, Entry};
use crate::table::sealed::{self, SealError};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// The first line of a commit; its format does not depend on the build.
const TAG: &str = "springpot 1 commit 1\n";

/// The files of a run that are to be put in place.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Commit {
    /// Names in the folder; run.json is the last.
    pub(super) files: Vec<String>,
    /// The files of the last run.
    pub(super) last: Vec<String>,
    /// Whether nothing is left to go on with.
    pub(super) drop_checkpoint: bool,
}

/// Where a file waits until it gets its name.
pub(super) fn waiting(folder: &Path, name: &str) -> PathBuf {
    if name == RESULTS { folder.join(PART) } else { folder.join(UNFINISHED).join(name) }
}

impl Commit {
    /// Waits until all files are safe from the loss of power, and makes them the valid ones.
    pub(super) fn write(&self, disk: &Disk, folder: &Path) -> io::Result<()> {
        for name in &self.files {
            disk.edit(&waiting(folder, name))?.sync()?;
        }
        if self.files.iter().any(|name| is_figure(name)) {
            disk.sync_folder(&folder.join(UNFINISHED).join(FIGURES))?;
        }
        disk.sync_folder(folder)?;
        let bytes = serde_json::to_vec(self).map_err(io::Error::other)?;
        sealed::write(disk, &folder.join(UNFINISHED).join(COMMIT), TAG, &bytes)
    }

    /// The commit in a folder; `None` where there is none.
    pub(super) fn read(disk: &Disk, folder: &Path) -> Result<Option<Self>, FolderError> {
        let path = folder.join(UNFINISHED).join(COMMIT);
        if disk.look(&path)?.is_none() {
            return Ok(None);
        }
        match sealed::read(disk, &path, TAG) {
            Ok(bytes) => serde_json::from_slice(&bytes).map(Some).map_err(|_| FolderError::Damaged(path)),
            Err(SealError::File(error)) => Err(error.into()),
            Err(SealError::OtherVersion(_) | SealError::Damaged) => Err(FolderError::Damaged(path)),
        }
    }

    /// Puts the files in place, from wherever that was left.
    pub(super) fn carry_out(&self, disk: &Disk, folder: &Path) -> Result<(), FolderError> {
        let mut left = Vec::new();
        for name in &self.files {
            let (from, to) = (waiting(folder, name), folder.join(name));
            if disk.look(&from)?.is_none() {
                continue;
            }
            match disk.look(&to)? {
                None => {}
                Some(Entry::File(_) | Entry::Other) if self.last.contains(name) => {}
                Some(_) => return Err(FolderError::Foreign(to)),
            }
            left.push((name, from, to));
        }
        let figures = folder.join(FIGURES);
        if left.iter().any(|(name, ..)| is_figure(name)) {
            if !matches!(disk.look(&figures)?, None | Some(Entry::Folder)) {
                return Err(FolderError::Foreign(figures));
            }
            disk.create_folder(&figures)?;
        }
        if left.iter().any(|(name, ..)| *name == RUN) && self.last.iter().any(|name| name == RUN) {
            disk.remove(&folder.join(RUN))?;
        }
        for name in self.last.iter().filter(|name| !self.files.contains(name)) {
            disk.remove(&folder.join(name))?;
        }
        remove_pages(disk, folder)?;
        for (_, from, to) in &left {
            disk.rename(from, to)?;
        }
        if !self.files.iter().any(|name| name == RESULTS) {
            disk.remove(&folder.join(PART))?;
        }
        let had_figures = self.last.iter().any(|name| is_figure(name));
        if self.files.iter().any(|name| is_figure(name)) {
            disk.sync_folder(&figures)?;
        } else if had_figures {
            disk.remove_folder(&figures)?;
        }
        disk.sync_folder(folder)?;
        if self.drop_checkpoint {
            remove_checkpoint(disk, folder)?;
        }
        let unfinished = folder.join(UNFINISHED);
        disk.remove(&unfinished.join(COMMIT))?;
        disk.sync_folder(&unfinished)?;
        Ok(clear_unfinished(disk, folder)?)
    }
}
