//! The folder of a run's results.
//!
//! One run at a time writes into a folder. What it writes waits beside the last run's files and takes their place when it has come to its
//! end, all of it or nothing; files that no run wrote are never touched.

mod lock;
mod owned;
mod settle;

pub(crate) use lock::is_held;
pub(crate) use owned::{
    CASE, EVENTS, GRADIENT, HEAD, JOURNAL, METRICS, PART, RANKING, RUNNING, UNFINISHED, checkpoint_folder,
};
pub use owned::{COMPARISON_LATEX, COMPARISON_PAGE, REPORT_LATEX, REPORT_PAGE, VIEW_PAGE, latex_figures};

use super::disk::{Disk, DiskFile, Entry};
use super::format::{self, Format};
use lock::{Lock, Taken};
use owned::{Checkpoint, Claims, FIGURES, FIXED, RESULTS, RUN, SUMMARY};
use settle::{Commit, waiting};
use springpot::table::Column;
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

/// Why a folder takes no results.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// Another run writes to it.
    #[error("another run writes to {}: {holder}", folder.display())]
    Held {
        /// The folder.
        folder: PathBuf,
        /// Its command, process, and beginning.
        holder: String,
    },
    /// A file that no run wrote stands where one of the results is to be.
    #[error("{} was not written by a run that is known here: it would be replaced, or taken for a result", .0.display())]
    Foreign(PathBuf),
    /// The scenario reads one of the files that its results would replace.
    #[error("the scenario reads {}, which its results would replace", .0.display())]
    Input(PathBuf),
    /// What tells how to put an earlier run's files in place is not what was written.
    #[error("{} is damaged: the results of the last run cannot be put in their place", .0.display())]
    Damaged(PathBuf),
    /// The results are complete and safe, and not in their place.
    #[error("the results in {} are complete, but cannot be put in their place: {source}", folder.display())]
    Pending {
        /// The folder.
        folder: PathBuf,
        /// What is in the way.
        source: Box<FolderError>,
    },
    /// It is not there any more, or another one has its name.
    #[error("{} was removed while the run wrote to it", .0.display())]
    Removed(PathBuf),
    /// The file system's reason.
    #[error(transparent)]
    File(#[from] io::Error),
}

/// What a run is going to write into a folder, beside its rows and what is always there.
#[derive(Clone, Copy)]
pub struct Targets<'a> {
    /// The names of the files in `figures/`.
    pub figures: &'a [String],
    /// Whether there will be checkpoints.
    pub checkpoints: bool,
    /// Whether the scenario reads a file.
    pub is_input: &'a dyn Fn(&Path) -> bool,
}

/// A folder into which one run writes, and no other while this is held.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    disk: Disk,
    lock: Option<Lock>,
    /// How a run ended whose files were put in place when the folder was opened.
    settled: Option<String>,
    /// The last run's files.
    last: Vec<String>,
    /// The files of this run, as names in the folder.
    files: Vec<String>,
    checkpoints: bool,
}

impl Folder {
    /// Makes the folder, locks it for `holder` (a few words about the run), and puts the last run's files in place where that was
    /// broken off.
    ///
    /// # Errors
    /// [`FolderError`]; nothing was changed then, but for [`FolderError::Pending`].
    pub fn open(path: &Path, disk: Disk, holder: &str) -> Result<Self, FolderError> {
        disk.create_folders(path)?;
        let lock = match lock::take(&disk, path, holder)? {
            Taken::Lock(lock) => Some(lock),
            Taken::Unknown => None,
            Taken::Held(holder) => return Err(FolderError::Held { folder: path.to_owned(), holder }),
            Taken::Foreign(file) => return Err(FolderError::Foreign(file)),
        };
        let mut folder = Self {
            path: path.to_owned(),
            disk,
            lock,
            settled: None,
            last: Vec::new(),
            files: Vec::new(),
            checkpoints: false,
        };
        if let Some(commit) = Commit::read(&folder.disk, path)? {
            folder.carry_out(&commit)?;
            folder.settled = folder.status()?;
        }
        folder.last = owned::listed(&folder.disk, path)?;
        Ok(folder)
    }

    /// Begins a run: forgets an earlier one that has not come to its end; its results, where it has, stay until there are new ones.
    ///
    /// # Errors
    /// [`FolderError::Foreign`] and [`FolderError::Input`], where nothing was changed; the file system's.
    pub fn begin(&mut self, targets: Targets<'_>) -> Result<(), FolderError> {
        let claims = Claims::read(&self.disk, &self.path)?;
        let checkpoint = Checkpoint::of(&self.disk, &self.path, claims)?;
        // Rows that a checkpoint goes on with are a run's, too.
        let claims = Claims { rows: claims.rows || checkpoint == Checkpoint::Ours, ..claims };
        self.refuse_foreign(targets, claims, checkpoint)?;
        if checkpoint == Checkpoint::Ours {
            owned::remove_checkpoint(&self.disk, &self.path)?;
        }
        self.disk.remove(&self.path.join(PART))?;
        owned::clear_unfinished(&self.disk, &self.path)?;
        self.claim(targets.checkpoints)
    }

    /// Goes on with a run whose checkpoint is sound; its rows are in results.csv.part, or in results.csv where it was interrupted.
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub(crate) fn go_on(&mut self, targets: Targets<'_>) -> Result<(), FolderError> {
        let claims = Claims { rows: true, checkpoint: true };
        self.refuse_foreign(targets, claims, Checkpoint::Ours)?;
        owned::clear_unfinished(&self.disk, &self.path)?;
        self.claim(true)
    }

    /// Notes what the run is about to write, so that the next one knows whose it is.
    fn claim(&mut self, checkpoints: bool) -> Result<(), FolderError> {
        (self.files, self.checkpoints) = (vec![RESULTS.to_owned()], checkpoints);
        Ok(Claims { rows: true, checkpoint: checkpoints }.write(&self.disk, &self.path)?)
    }

    fn refuse_foreign(&self, targets: Targets<'_>, claims: Claims, checkpoint: Checkpoint) -> Result<(), FolderError> {
        let figures = targets.figures.iter().map(|name| format!("{FIGURES}/{name}"));
        let names: Vec<String> = FIXED.iter().map(|name| (*name).to_owned()).chain(figures).collect();
        for name in &names {
            let path = self.path.join(name);
            match self.disk.look(&path)? {
                None => {}
                Some(Entry::File(_) | Entry::Other) if self.last.contains(name) => {}
                Some(_) => return Err(FolderError::Foreign(path)),
            }
        }
        let folder = self.path.join(FIGURES);
        let has_figures = self.last.iter().chain(&names).any(|name| owned::is_figure(name));
        if has_figures && !matches!(self.disk.look(&folder)?, None | Some(Entry::Folder)) {
            return Err(FolderError::Foreign(folder));
        }
        for name in self.last.iter().chain(names.iter().filter(|name| !self.last.contains(name))) {
            let path = self.path.join(name);
            if self.disk.look(&path)?.is_some() && (targets.is_input)(&path) {
                return Err(FolderError::Input(path));
            }
        }
        let part = self.path.join(PART);
        match self.disk.look(&part)? {
            Some(_) if (targets.is_input)(&part) => return Err(FolderError::Input(part)),
            None => {}
            Some(Entry::File(_)) if claims.rows => {}
            Some(_) => return Err(FolderError::Foreign(part)),
        }
        if owned::is_foreign_unfinished(&self.disk, &self.path)? {
            return Err(FolderError::Foreign(self.path.join(UNFINISHED)));
        }
        if targets.checkpoints && checkpoint == Checkpoint::Foreign {
            return Err(FolderError::Foreign(checkpoint_folder(&self.path)));
        }
        Ok(())
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file system that it is on.
    pub fn disk(&self) -> &Disk {
        &self.disk
    }

    /// Whether another run is kept out: false where the file system knows no locks.
    pub fn is_locked(&self) -> bool {
        self.lock.is_some()
    }

    /// The files of this run, as names in the folder.
    pub fn files(&self) -> &[String] {
        &self.files
    }

    /// Whether the results of an earlier run are there.
    pub fn has_earlier(&self) -> bool {
        !self.last.is_empty()
    }

    /// How the run ended, as its run.json says, whose files were put in place when the folder was opened; `None` where none waited.
    pub fn settled(&self) -> Option<&str> {
        self.settled.as_deref()
    }

    /// How the last run ended, as its run.json says; `None` where none has.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn status(&self) -> io::Result<Option<String>> {
        Ok(owned::record(&self.disk, &self.path)?.map(|record| record.status))
    }

    /// Makes the file that the rows stream to.
    pub(crate) fn create_rows(&self) -> io::Result<DiskFile> {
        self.disk.create(&self.path.join(PART))
    }

    /// Opens the file of the rows to go on with it.
    pub(crate) fn reopen_rows(&self) -> io::Result<DiskFile> {
        self.disk.edit(&self.path.join(PART))
    }

    /// Where rows may stand that were written so far: in the file that they stream to, or in that of an interrupted run.
    pub(crate) fn rows(&self) -> [PathBuf; 2] {
        [PART, RESULTS].map(|name| self.path.join(name))
    }

    /// Cuts off what stands behind the last complete row.
    pub(crate) fn cut_rows(&self) -> io::Result<()> {
        let mut file = self.reopen_rows()?;
        let mut end = file.seek(io::SeekFrom::End(0))?;
        let mut piece = [0; 1 << 14];
        while end > 0 {
            let from = end.saturating_sub(piece.len() as u64);
            let piece = &mut piece[..(end - from) as usize];
            file.seek(io::SeekFrom::Start(from))?;
            file.read_exact(piece)?;
            if let Some(newline) = piece.iter().rposition(|byte| *byte == b'\n') {
                end = from + newline as u64 + 1;
                break;
            }
            end = from;
        }
        file.set_length(end)
    }

    /// Writes the rows, which are complete, in another format; their first `swept` columns may hold texts.
    ///
    /// # Errors
    /// The file system's.
    pub fn convert_rows(&mut self, format: Format, columns: &[Column], swept: usize) -> io::Result<()> {
        if format == Format::Csv {
            return Ok(());
        }
        let name = format!("results.{}", format.name());
        let (rows, new) = (self.path.join(PART), waiting(&self.path, &name));
        format::convert(&self.disk, &rows, &new, format, columns, swept)?;
        self.files.iter_mut().filter(|file| *file == RESULTS).for_each(|file| file.clone_from(&name));
        Ok(())
    }

    /// Says what the run is to those who watch it while it is under way.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn tell(&self, running: &serde_json::Map<String, serde_json::Value>) -> io::Result<()> {
        let mut file = self.disk.create(&self.path.join(UNFINISHED).join(RUNNING))?;
        file.write_all(&serde_json::to_vec(running).map_err(io::Error::other)?)
    }

    /// Makes the file of the statistics.
    pub(crate) fn create_summary(&mut self) -> io::Result<DiskFile> {
        self.create(SUMMARY)
    }

    /// Makes another of the files that every case has lines in.
    pub(crate) fn create_beside(&mut self, name: &str) -> io::Result<DiskFile> {
        self.create(name)
    }

    /// Writes a figure's file for `figures/`.
    ///
    /// # Errors
    /// The file system's.
    pub fn write_figure(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.disk.create_folder(&self.path.join(UNFINISHED).join(FIGURES))?;
        self.create(&format!("{FIGURES}/{name}"))?.write_all(bytes)
    }

    /// Writes run.json, made by `run` from the list of all files, and puts the files in the place of the last run's, all or none; with `goes_on` the
    /// checkpoint stays.
    ///
    /// # Errors
    /// [`FolderError::Pending`] where that was begun and cannot be finished: [`Self::open`] does it later. The file system's, where
    /// the last run's files are as they were.
    pub fn put(
        &mut self,
        run: impl FnOnce(&[String]) -> serde_json::Map<String, serde_json::Value>,
        goes_on: bool,
    ) -> Result<(), FolderError> {
        let mut file = self.create(RUN)?;
        let mut text = serde_json::to_string_pretty(&run(&self.files)).map_err(io::Error::other)?;
        text.push('\n');
        file.write_all(text.as_bytes())?;
        let (files, last) = (self.files.clone(), self.last.clone());
        let commit = Commit { files, last, drop_checkpoint: self.checkpoints && !goes_on };
        if let Err(error) = commit.write(&self.disk, &self.path) {
            // Its last call may have failed where it is there all the same.
            return match Commit::read(&self.disk, &self.path) {
                Ok(None) => Err(error.into()),
                _ => Err(self.pending(error.into())),
            };
        }
        self.carry_out(&commit)
    }

    fn carry_out(&self, commit: &Commit) -> Result<(), FolderError> {
        commit.carry_out(&self.disk, &self.path).map_err(|error| self.pending(error))
    }

    fn pending(&self, source: FolderError) -> FolderError {
        FolderError::Pending { folder: self.path.clone(), source: Box::new(source) }
    }

    /// Takes away what the run wrote; the last run's results stay.
    ///
    /// # Errors
    /// The file system's.
    pub fn discard(&mut self) -> io::Result<()> {
        self.files.clear();
        if self.checkpoints {
            owned::remove_checkpoint(&self.disk, &self.path)?;
        }
        self.disk.remove(&self.path.join(PART))?;
        owned::clear_unfinished(&self.disk, &self.path)
    }

    /// Whether it is still the one that was opened: what belongs to another run by now is not written to.
    pub(crate) fn is_in_place(&self) -> bool {
        let is_there = || matches!(self.disk.look(&self.path), Ok(Some(Entry::Folder)));
        self.lock.as_ref().map_or_else(is_there, |lock| lock.is_in_place().unwrap_or(true))
    }

    /// Makes a file that waits for its place.
    fn create(&mut self, name: &str) -> io::Result<DiskFile> {
        let file = self.disk.create(&waiting(&self.path, name))?;
        if !self.files.iter().any(|file| file == name) {
            self.files.push(name.to_owned());
        }
        Ok(file)
    }
}

#[cfg(test)]
mod tests;
