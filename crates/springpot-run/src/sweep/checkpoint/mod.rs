//! What a sweep keeps beside its results so that it can go on after an interrupt, a kill, or a loss of power.
//!
//! In the folder `checkpoint/` of the results: `run`, where the run comes from; `done`, a journal of the cases that have ended; and
//! for each case under way `case-N`, its state, with `case-N.kept`, its values for figures, and `case-N.rows`, its rows where it began
//! before its turn in results.csv had come. `run` and `case-N` are replaced as a whole; the others only grow, and states and journal say
//! how much of them, and of the rows, belongs to them, and its hash. Numbers keep their bits, and everything carries a hash. Rows and kept
//! values are safe from the loss of power before a state speaks of them.

mod error;
mod files;
mod merge;
mod record;
mod rows;

pub use error::CheckpointError;
pub use merge::{MergeError, Shards};
pub use record::Origin;

pub(super) use files::CaseFiles;
pub(super) use record::{CaseDone, CaseState, Stretch, Written, bytes, value};

use super::layout::Layout;
use crate::table::disk::Disk;
use crate::table::folder::{CASE, Folder, HEAD, JOURNAL, Targets, checkpoint_folder};
use crate::table::sealed::{self, CHECKPOINT, Journal, Recorded, SealError};
use error::at;
use record::{Head, digest, digest_of};
use springpot::system::System;
use springpot_scenario::{Cases, Plan};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How often, at most, the end of a case waits for the disk.
const PATIENCE: Duration = Duration::from_secs(1);

/// The checkpoint of a run.
#[derive(Debug)]
pub struct Checkpoints {
    disk: Disk,
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

impl Earlier {
    /// Reads the journal of the cases that have ended.
    fn read(disk: &Disk, results: &Path) -> Result<(Self, Recorded), CheckpointError> {
        let (mut earlier, file) = (Self::default(), checkpoint_folder(results).join(JOURNAL));
        let journal = Recorded::read(disk, &file, &mut |at, record| {
            let CaseDone { index, written, .. } = value(record)?;
            earlier.wall = earlier.wall.max(written.wall_of_run);
            let Written { rows, aside, kept, .. } = written;
            earlier.done.insert(index, Ended { at, rows, aside, kept });
            Ok(())
        });
        let journal = journal.map_err(|error| CheckpointError::of(&file, error))?;
        Ok((earlier, journal))
    }
}

/// Where to find the record of a case, and how far it has written.
#[derive(Debug, Clone, Copy)]
struct Ended {
    at: u64,
    rows: Stretch,
    aside: bool,
    kept: Stretch,
}

/// A run that has not come to its end.
#[derive(Debug)]
pub struct Unfinished {
    folder: Folder,
    head: Head,
}

impl Unfinished {
    /// Looks for a checkpoint among the results in a folder, which is locked for `holder` as [`Folder::open`] does.
    ///
    /// # Errors
    /// [`CheckpointError`] where there is none that this build can read.
    pub fn read(results: &Path, disk: Disk, holder: &str) -> Result<Self, CheckpointError> {
        if !disk.is_folder(results) {
            return Err(CheckpointError::Missing(results.to_owned()));
        }
        let folder = Folder::open(results, disk, holder)?;
        let file = checkpoint_folder(results).join(HEAD);
        match sealed::read(folder.disk(), &file, CHECKPOINT).and_then(|bytes| value(&bytes)) {
            Ok(head) => Ok(Self { folder, head }),
            Err(SealError::File(error)) if error.kind() == io::ErrorKind::NotFound => {
                if let Some(status) = folder.settled() {
                    return Err(CheckpointError::Settled { results: results.to_owned(), status: status.to_owned() });
                }
                let ended = folder.status().map_err(at(results))?.is_some_and(|status| status != "interrupted");
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

    /// The folder of the results.
    pub fn folder(&self) -> &Folder {
        &self.folder
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
        targets: Targets<'_>,
    ) -> Result<(Checkpoints, Folder), CheckpointError> {
        let Self { mut folder, mut head } = self;
        let (disk, results) = (folder.disk().clone(), folder.path().to_owned());
        if head.cases != cases.len() || head.digest != digest(plan, system) {
            return Err(changed(&head));
        }
        let (mut earlier, journal) = Earlier::read(&disk, &results)?;
        let file = checkpoint_folder(&results).join(JOURNAL);
        let (mut states, outdated) = under_way(&disk, &results, &head, cases, &mut earlier)?;
        let start = head.origin.cases(cases.len()).start;
        let sound = rows::survey(&folder, &mut earlier, &mut states, (start, layout))?;

        folder.go_on(targets)?;
        rows::restore(&folder, &sound, layout).map_err(at(&results))?;
        let journal = journal.go_on(&disk).map_err(at(&file))?;
        for index in outdated.into_iter().filter(|index| !states.contains_key(index)) {
            let file = file_of(&results, index, "");
            disk.remove(&file).map_err(at(&file))?;
        }
        if let Some(every) = every.filter(|every| *every != head.origin.every) {
            head.origin.every = every;
            let file = checkpoint_folder(&results).join(HEAD);
            let written = bytes(&head).and_then(|bytes| sealed::write(&disk, &file, CHECKPOINT, &bytes));
            written.map_err(at(&file))?;
        }
        Ok((Checkpoints::new(disk, results, head, journal, earlier, states), folder))
    }
}

/// The states of cases under way, and all cases that have the file of one.
type UnderWay = (BTreeMap<usize, CaseState>, Vec<usize>);

fn under_way(
    disk: &Disk,
    results: &Path,
    head: &Head,
    cases: &Cases,
    earlier: &mut Earlier,
) -> Result<UnderWay, CheckpointError> {
    let folder = checkpoint_folder(results);
    let (mut states, mut found) = (BTreeMap::new(), Vec::new());
    for name in disk.list(&folder).map_err(at(&folder))? {
        let Some(index) = name.strip_prefix(CASE).and_then(|digits| digits.parse::<usize>().ok()) else { continue };
        let file = folder.join(&name);
        found.push(index);
        if earlier.done.contains_key(&index) {
            continue;
        }
        let state = sealed::read(disk, &file, CHECKPOINT).and_then(|bytes| value::<CaseState>(&bytes));
        let state = state.map_err(|error| CheckpointError::of(&file, error))?;
        if state.index != index || index >= head.cases {
            return Err(CheckpointError::Damaged(file));
        }
        let digest = if index == 0 { Some(head.digest) } else { digest_of(cases, index) };
        if digest != Some(state.digest) {
            return Err(changed(head));
        }
        earlier.wall = earlier.wall.max(state.written.wall_of_run);
        states.insert(index, state);
    }
    Ok((states, found))
}

fn changed(head: &Head) -> CheckpointError {
    CheckpointError::OtherScenario { what: format!("a file that {} names", head.origin.asked.name) }
}

impl Checkpoints {
    /// Begins the checkpoint of a new run into a folder of results; `plan` and `system` are those of the first case.
    ///
    /// # Errors
    /// The file system's.
    pub fn begin(folder: &Folder, origin: Origin, cases: &Cases, plan: &Plan, system: &System) -> io::Result<Self> {
        let (disk, results) = (folder.disk().clone(), folder.path().to_owned());
        let folder = checkpoint_folder(&results);
        disk.create_folder(&folder)?;
        let journal = Journal::create(&disk, &folder.join(JOURNAL))?;
        let head = Head { origin, cases: cases.len(), digest: digest(plan, system) };
        // Last, since it is what makes the others a checkpoint.
        sealed::write(&disk, &folder.join(HEAD), CHECKPOINT, &bytes(&head)?)?;
        disk.sync_folder(&results)?;
        Ok(Self::new(disk, results, head, journal, Earlier::default(), BTreeMap::new()))
    }

    fn new(
        disk: Disk,
        results: PathBuf,
        head: Head,
        journal: Journal,
        earlier: Earlier,
        states: BTreeMap<usize, CaseState>,
    ) -> Self {
        let journal = Growing { journal, synced: Instant::now(), cleared: 0 };
        Self { disk, results, head, journal: Mutex::new(journal), states: Mutex::new(states), earlier }
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
        (cleared..safe).try_for_each(|case| self.disk.remove(&self.file(case, ".rows")))
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
