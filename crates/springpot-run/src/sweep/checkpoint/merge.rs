//! The parts of one run, as several machines computed them, as a source of all its cases.

use super::error::{CheckpointError, at};
use super::files::read_kept;
use super::record::{CaseDone, Head, Origin, digest, value};
use super::rows::{copy, survey};
use super::{Earlier, Ended, Unfinished, file_of};
use crate::sweep::layout::Layout;
use crate::table::disk::Disk;
use crate::table::folder::{Folder, FolderError, JOURNAL, checkpoint_folder};
use crate::table::sealed;
use springpot::system::System;
use springpot_scenario::{Cases, Plan, Refusals};
use std::collections::BTreeMap;
use std::io::{self, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A case of a part: its end, the text of its rows, and its values that are kept for figures.
pub(in crate::sweep) type EndedCase = (CaseDone, Vec<u8>, Vec<f64>);

/// Why the parts of a run cannot be put together.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A folder holds no part.
    #[error("{} holds no part of a run: run --shard writes one", .0.display())]
    NoPart(PathBuf),
    /// A folder is named twice.
    #[error("{} is named twice", .0.display())]
    Twice(PathBuf),
    /// Two folders hold parts of different runs.
    #[error("{} and {} hold parts of different runs: {what} is not the same", first.display(), other.display())]
    Different {
        /// One folder.
        first: PathBuf,
        /// The other.
        other: PathBuf,
        /// What differs.
        what: &'static str,
    },
    /// Cases that no part has.
    #[error("{} of {all} cases are in none of these folders, the first of them case {}", missing.len(), missing.first().copied().unwrap_or(0))]
    Missing {
        /// Their indices, from 0.
        missing: Vec<usize>,
        /// All cases of the run.
        all: usize,
        /// A part that has not come to its end, where that is why.
        unfinished: Option<PathBuf>,
    },
    /// The results would replace those of a part.
    #[error("the results of the whole run cannot go into {}, which holds a part of it", .0.display())]
    IntoPart(PathBuf),
    /// The folder of the results takes none.
    #[error("{}: {error}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        error: FolderError,
    },
    /// A part is damaged, or belongs to something else.
    #[error(transparent)]
    Part(#[from] CheckpointError),
    /// The scenario is refused.
    #[error(transparent)]
    Refused(#[from] Refusals),
}

/// The parts of one run.
#[derive(Debug)]
pub struct Shards {
    disk: Disk,
    parts: Vec<Part>,
    /// The part that has a case.
    of_case: BTreeMap<usize, usize>,
    /// Values of each row that every case keeps for figures.
    widths: Vec<usize>,
}

/// A part.
#[derive(Debug)]
struct Part {
    folder: Folder,
    head: Head,
    done: BTreeMap<usize, Ended>,
    /// Where the rows of each case begin in `rows`.
    begins: BTreeMap<usize, u64>,
    rows: Option<PathBuf>,
    wall: Duration,
}

impl Shards {
    /// Looks for a part in every folder, which is locked for `holder`.
    ///
    /// # Errors
    /// [`MergeError`].
    pub fn read(folders: &[PathBuf], disk: &Disk, holder: &str) -> Result<Self, MergeError> {
        let mut parts: Vec<Part> = Vec::new();
        let place = |path: &PathBuf| path.canonicalize().unwrap_or_else(|_| path.clone());
        for (k, path) in folders.iter().enumerate() {
            if folders[..k].iter().any(|earlier| place(earlier) == place(path)) {
                return Err(MergeError::Twice(path.clone()));
            }
            let Unfinished { folder, head } = match Unfinished::read(path, disk.clone(), holder) {
                Ok(part) if part.head.origin.shard.is_some() => part,
                Ok(_) | Err(CheckpointError::Missing(_) | CheckpointError::Finished(_)) => {
                    return Err(MergeError::NoPart(path.clone()));
                }
                Err(CheckpointError::Settled { .. }) => Unfinished::read(path, disk.clone(), holder)?,
                Err(error) => return Err(error.into()),
            };
            if let Some(first) = parts.first()
                && let Some(what) = difference(&first.head, &head)
            {
                let (first, other) = (first.folder.path().to_owned(), path.clone());
                return Err(MergeError::Different { first, other, what });
            }
            let (done, begins, wall) = Default::default();
            parts.push(Part { folder, head, done, begins, rows: None, wall });
        }
        if parts.is_empty() {
            return Err(MergeError::NoPart(PathBuf::new()));
        }
        Ok(Self { disk: disk.clone(), parts, of_case: BTreeMap::new(), widths: Vec::new() })
    }

    /// Where the run comes from.
    pub fn origin(&self) -> &Origin {
        &self.parts[0].head.origin
    }

    /// The cases that a run under way has brought to their end, up to the first that has not ended.
    ///
    /// # Errors
    /// As [`Unfinished::read`].
    pub(in crate::sweep) fn under_way(
        results: &Path,
        disk: &Disk,
        holder: &str,
        layout: &Layout,
    ) -> Result<Vec<EndedCase>, CheckpointError> {
        let Unfinished { folder, head } = Unfinished::read(results, disk.clone(), holder)?;
        let start = head.origin.cases(head.cases).start;
        let (done, begins, wall) = Default::default();
        let mut part = Part { folder, head, done, begins, rows: None, wall };
        let first = part.look(layout, start)?;
        let width = |case: usize| layout.kept(case).map_or(0, <[usize]>::len);
        (start..first).map(|case| part.case(disk, case, width(case))).collect()
    }

    /// A case, where a part has it.
    pub(in crate::sweep) fn ended(&self, index: usize) -> Result<Option<EndedCase>, CheckpointError> {
        let Some(&part) = self.of_case.get(&index) else { return Ok(None) };
        let width = self.widths.get(index).copied().unwrap_or(0);
        self.parts[part].case(&self.disk, index, width).map(Some)
    }

    /// Wall time that was spent on the parts.
    pub(in crate::sweep) fn wall_of_parts(&self) -> Duration {
        self.parts.iter().map(|part| part.wall).sum()
    }

    /// The folders of the parts.
    pub fn folders(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(|part| part.folder.path())
    }

    /// Looks through all rows of all parts; `cases` are those of the origin, `first` plan and system of the first of them.
    ///
    /// # Errors
    /// A part is damaged, was computed from other files, or has not come to its end; parts that are missing.
    pub fn of_run(
        mut self,
        cases: &Cases,
        (plan, system): (&Plan, &System),
        layout: &Layout,
    ) -> Result<Self, MergeError> {
        let Head { origin, cases: count, digest: theirs } = &self.parts[0].head;
        if *count != cases.len() || *theirs != digest(plan, system) {
            let what = format!("{}, or a file that it names,", origin.asked.name);
            return Err(CheckpointError::OtherScenario { what }.into());
        }
        let mut unfinished = None;
        for (k, part) in self.parts.iter_mut().enumerate() {
            let Range { start, end } = part.head.origin.cases(cases.len());
            let first = part.look(layout, start)?;
            if first < end {
                unfinished.get_or_insert_with(|| part.folder.path().to_owned());
            }
            for case in start..first {
                self.of_case.entry(case).or_insert(k);
            }
        }
        let missing: Vec<usize> = (0..cases.len()).filter(|case| !self.of_case.contains_key(case)).collect();
        if !missing.is_empty() {
            return Err(MergeError::Missing { missing, all: cases.len(), unfinished });
        }
        self.widths = (0..cases.len()).map(|case| layout.kept(case).map_or(0, <[usize]>::len)).collect();
        Ok(self)
    }
}

/// What is not the same of two runs.
fn difference(a: &Head, b: &Head) -> Option<&'static str> {
    let (one, other) = (&a.origin.asked, &b.origin.asked);
    if one.text != other.text {
        return Some("the scenario");
    }
    if one.overrides != other.overrides {
        return Some("what was set");
    }
    if one.sweeps != other.sweeps {
        return Some("what was swept");
    }
    (a.cases != b.cases || a.digest != b.digest).then_some("a file that the scenario names")
}

impl Part {
    /// Checks all rows, and notes where those of each case begin; returns the first case that has not ended.
    fn look(&mut self, layout: &Layout, start: usize) -> Result<usize, CheckpointError> {
        let results = self.folder.path();
        let (mut earlier, _) = Earlier::read(self.folder.disk(), results)?;
        self.wall = earlier.wall;
        let sound = survey(&self.folder, &mut earlier, &mut BTreeMap::new(), (start, layout))?;
        let mut begin = crate::sweep::header(layout.written()).len() as u64;
        for case in start..sound.first {
            if sound.missing.iter().any(|(missing, _)| *missing == case) {
                continue;
            }
            self.begins.insert(case, begin);
            begin += earlier.done[&case].rows.bytes;
        }
        (self.rows, self.done) = (sound.file, earlier.done);
        Ok(sound.first)
    }

    fn case(&self, disk: &Disk, case: usize, width: usize) -> Result<EndedCase, CheckpointError> {
        let (results, ended) = (self.folder.path(), self.done[&case]);
        let journal = checkpoint_folder(results).join(JOURNAL);
        let record = sealed::record(disk, &journal, ended.at).and_then(|bytes| value::<CaseDone>(&bytes));
        let done = record.map_err(|error| CheckpointError::of(&journal, error))?;
        let (mut rows, mut kept) = (Vec::new(), Vec::new());
        let (path, begin) = match (&self.rows, self.begins.get(&case)) {
            (Some(file), Some(begin)) => (file.clone(), *begin),
            _ => (file_of(results, case, ".rows"), 0),
        };
        if ended.rows.bytes > 0 {
            let mut file = disk.open(&path).map_err(at(&path))?;
            file.seek(SeekFrom::Start(begin)).map_err(at(&path))?;
            let mut take = |piece: &[u8]| -> io::Result<()> {
                rows.extend_from_slice(piece);
                Ok(())
            };
            copy(file, ended.rows.bytes, &mut take).map_err(at(&path))?;
        }
        let path = file_of(results, case, ".kept");
        read_kept(disk, &path, ended.kept, width, &mut |values| kept.extend_from_slice(values)).map_err(at(&path))?;
        Ok((done, rows, kept))
    }
}
