//! What a sweep keeps beside its results so that it can go on after an interrupt, a kill, or a loss of power.
//!
//! In the folder `checkpoint/` of the results: `run`, where the run comes from; `done`, a journal of the cases that have ended; and
//! for each case under way `case-N`, its state, with `case-N.kept`, its values for figures, and `case-N.rows`, its rows where it began
//! before its turn in results.csv had come. `run` and `case-N` are replaced as a whole; the others only grow, and the state says how
//! much of them belongs to it. Numbers keep their bits, and everything but rows and kept values carries a hash.

mod error;
mod files;
mod record;
mod rows;

pub use error::CheckpointError;
pub use record::Origin;

pub(super) use files::CaseFiles;
pub(super) use record::{CaseDone, CaseState, Written};

use super::layout::Layout;
use crate::scenario::{Cases, Plan};
use crate::simulate::System;
use crate::table::folder::{self, CASE, Folder, HEAD, JOURNAL, checkpoint_folder};
use crate::table::sealed::{self, Journal, SealError};
use error::at;
use record::{Head, bytes, digest, digest_of, value};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How often, at most, the end of a case waits for the disk.
const PATIENCE: Duration = Duration::from_secs(1);

/// The checkpoint of a run.
#[derive(Debug)]
pub struct Checkpoints {
    /// The folder of the results.
    results: PathBuf,
    head: Head,
    journal: Mutex<Growing>,
    /// Cases under way in an earlier run.
    states: Mutex<BTreeMap<usize, CaseState>>,
    earlier: Earlier,
}

#[derive(Debug)]
struct Growing {
    journal: Journal,
    synced: Instant,
    /// Rows of cases before this one are no longer kept aside.
    cleared: usize,
}

/// What an earlier run did.
#[derive(Debug, Default)]
struct Earlier {
    /// The first case that has not ended; `None` where nothing went before.
    first: Option<usize>,
    done: BTreeMap<usize, Ended>,
    wall: Duration,
}

/// Where to find the record of a case, and how far it has written.
#[derive(Debug, Clone, Copy)]
struct Ended {
    at: u64,
    bytes: u64,
    aside: bool,
    kept: u64,
}

/// A run that has not come to its end.
#[derive(Debug)]
pub struct Unfinished {
    results: PathBuf,
    head: Head,
}

impl Unfinished {
    /// Looks for a checkpoint among the results in a folder.
    ///
    /// # Errors
    /// [`CheckpointError`] where there is none that this version can read.
    pub fn read(results: &Path) -> Result<Self, CheckpointError> {
        let file = checkpoint_folder(results).join(HEAD);
        match sealed::read(&file).and_then(|bytes| value(&bytes)) {
            Ok(head) => Ok(Self { results: results.to_owned(), head }),
            Err(SealError::File(error)) if error.kind() == io::ErrorKind::NotFound => {
                let ended = folder::last_status(results).is_some_and(|status| status != "interrupted");
                let why = if ended { CheckpointError::Finished } else { CheckpointError::Missing };
                Err(why(results.to_owned()))
            }
            Err(error) => Err(CheckpointError::of(&file, error)),
        }
    }

    /// Where it comes from.
    pub fn origin(&self) -> &Origin {
        &self.head.origin
    }

    /// Reads how far it came, and cuts its rows back to there; `cases` are those of its origin, `first` plan and system of the first
    /// of them. With `every`, checkpoints are written at other times from now on.
    ///
    /// # Errors
    /// [`CheckpointError`] where the checkpoint is damaged, or belongs to something else: nothing was changed then.
    pub fn take_up(
        self,
        cases: &Cases,
        (plan, system): (&Plan, &System),
        layout: &Layout,
        every: Option<f64>,
    ) -> Result<(Checkpoints, Folder), CheckpointError> {
        let Self { results, mut head } = self;
        let changed = |what: String| CheckpointError::OtherScenario { what };
        let files = || format!("a file that {} names", head.origin.typed);
        if head.cases != cases.len() || head.digest != digest(plan, system) {
            return Err(changed(files()));
        }
        let folder = checkpoint_folder(&results);
        let mut earlier = Earlier::default();
        let file = folder.join(JOURNAL);
        let journal = Journal::open(&file, &mut |at, record| {
            let CaseDone { index, written, .. } = value(record)?;
            earlier.wall = earlier.wall.max(written.wall_of_run);
            let Written { bytes, aside, kept, .. } = written;
            earlier.done.insert(index, Ended { at, bytes, aside, kept });
            Ok(())
        });
        let journal = journal.map_err(|error| CheckpointError::of(&file, error))?;
        let (mut found, mut states) = (Vec::new(), BTreeMap::new());
        for entry in fs::read_dir(&folder).map_err(at(&folder))? {
            let file = entry.map_err(at(&folder))?.path();
            let name = file.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_prefix(CASE));
            let Some(index) = name.and_then(|digits| digits.parse::<usize>().ok()) else { continue };
            found.push((index, file.clone()));
            if earlier.done.contains_key(&index) {
                continue;
            }
            let state = sealed::read(&file).and_then(|bytes| value::<CaseState>(&bytes));
            let state = state.map_err(|error| CheckpointError::of(&file, error))?;
            if state.index != index || index >= head.cases {
                return Err(CheckpointError::Damaged(file));
            }
            let digest = if index == 0 { Some(head.digest) } else { digest_of(cases, index) };
            if digest != Some(state.digest) {
                return Err(changed(files()));
            }
            earlier.wall = earlier.wall.max(state.written.wall_of_run);
            states.insert(index, state);
        }
        let restored = rows::restore(&results, &mut earlier, &mut states, layout)?;
        for (index, file) in found {
            if !states.contains_key(&index) {
                folder::remove_if_there(&file).map_err(at(&file))?;
            }
        }
        if let Some(every) = every.filter(|every| *every != head.origin.every) {
            head.origin.every = every;
            let file = folder.join(HEAD);
            let written = bytes(&head).and_then(|bytes| sealed::write(&file, &bytes));
            written.map_err(at(&file))?;
        }
        Ok((Checkpoints::new(results, head, journal, earlier, states), restored))
    }
}

impl Checkpoints {
    /// Begins the checkpoint of a new run into a folder of results; `plan` and `system` are those of the first case.
    ///
    /// # Errors
    /// The file system's.
    pub fn begin(folder: &Folder, origin: Origin, cases: &Cases, plan: &Plan, system: &System) -> io::Result<Self> {
        let results = folder.path();
        let folder = checkpoint_folder(results);
        fs::create_dir_all(&folder)?;
        let journal = Journal::create(&folder.join(JOURNAL))?;
        let head = Head { origin, cases: cases.len(), digest: digest(plan, system) };
        // Last, since it is what makes the others a checkpoint.
        sealed::write(&folder.join(HEAD), &bytes(&head)?)?;
        Ok(Self::new(results.to_owned(), head, journal, Earlier::default(), BTreeMap::new()))
    }

    fn new(
        results: PathBuf,
        head: Head,
        journal: Journal,
        earlier: Earlier,
        states: BTreeMap<usize, CaseState>,
    ) -> Self {
        let journal = Growing { journal, synced: Instant::now(), cleared: 0 };
        Self { results, head, journal: Mutex::new(journal), states: Mutex::new(states), earlier }
    }

    /// Removes the checkpoint, once the run has come to its end and its results are written.
    ///
    /// # Errors
    /// The file system's.
    pub fn remove(self) -> io::Result<()> {
        folder::remove_checkpoint(&self.results)
    }

    /// The first case that has not ended, where an earlier run goes on: results.csv ends with its rows.
    pub(super) fn first(&self) -> Option<usize> {
        self.earlier.first
    }

    /// Wall time of the earlier run.
    pub(super) fn earlier_wall(&self) -> Duration {
        self.earlier.wall
    }

    /// The record of a case that had ended.
    pub(super) fn done(&self, index: usize) -> io::Result<Option<CaseDone>> {
        let Some(ended) = self.earlier.done.get(&index) else { return Ok(None) };
        let record = self.growing().journal.record(ended.at).and_then(|bytes| value(&bytes));
        record.map(Some).map_err(io::Error::other)
    }

    /// The state of a case that was under way; it is handed over once.
    pub(super) fn take_state(&self, index: usize) -> Option<CaseState> {
        self.states.lock().unwrap_or_else(PoisonError::into_inner).remove(&index)
    }

    /// Adds a case that has ended to the journal. Every now and then `sync` is called, which makes the shared rows safe from the
    /// loss of power and tells before which case all of them are: what was kept aside of these is no longer needed.
    fn add(&self, done: &CaseDone, sync: impl FnOnce() -> io::Result<usize>) -> io::Result<()> {
        let record = bytes(done)?;
        let mut growing = self.growing();
        if growing.synced.elapsed() < PATIENCE {
            return growing.journal.append(&record);
        }
        let safe = sync()?;
        growing.journal.append(&record)?;
        growing.journal.sync()?;
        growing.synced = Instant::now();
        let cleared = growing.cleared;
        growing.cleared = cleared.max(safe);
        drop(growing);
        (cleared..safe).try_for_each(|case| folder::remove_if_there(&self.file(case, ".rows")))
    }

    fn file(&self, case: usize, ending: &str) -> PathBuf {
        file_of(&self.results, case, ending)
    }

    fn growing(&self) -> MutexGuard<'_, Growing> {
        self.journal.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A file of one case.
fn file_of(results: &Path, case: usize, ending: &str) -> PathBuf {
    checkpoint_folder(results).join(format!("{CASE}{case}{ending}"))
}

/// Its length; 0 where it is not there.
fn length(file: &Path) -> u64 {
    fs::metadata(file).map_or(0, |file| file.len())
}
