//! The files of one case.

use super::record::{Stretch, bytes, digest};
use super::rows::copy_aside;
use super::{CaseDone, CaseState, Checkpoints};
use crate::table::disk::{Disk, DiskFile};
use crate::table::sealed::{self, CHECKPOINT};
use springpot::system::System;
use springpot_scenario::Plan;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// What a case keeps while it is under way.
#[derive(Debug)]
pub(in crate::sweep) struct CaseFiles<'a> {
    checkpoints: &'a Checkpoints,
    index: usize,
    /// All its rows.
    rows: Stretch,
    /// Its rows, where its turn had not come when it began.
    aside: Option<DiskFile>,
    /// Whether rows that an earlier run kept aside are still there.
    outdated: bool,
    kept_file: Option<DiskFile>,
    kept: Stretch,
    /// Time of the next checkpoint, s.
    next: f64,
    digest: Option<u32>,
}

impl<'a> CaseFiles<'a> {
    /// The files of a case that begins, in the first file of all rows or aside.
    pub(in crate::sweep) fn begin(checkpoints: &'a Checkpoints, index: usize, aside: bool) -> io::Result<Self> {
        let aside = aside.then(|| checkpoints.disk.create(&checkpoints.file(index, ".rows"))).transpose()?;
        let (rows, kept, next) = (Stretch::default(), Stretch::default(), checkpoints.head.origin.every);
        Ok(Self { checkpoints, index, rows, aside, outdated: false, kept_file: None, kept, next, digest: None })
    }

    /// The files of a case that goes on from `state`; rows that were kept aside go to `take`, but for the first case, whose rows
    /// stand where they belong.
    pub(in crate::sweep) fn go_on(
        checkpoints: &'a Checkpoints,
        state: &CaseState,
        take: &mut dyn FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<Self> {
        let mut files = Self::begin(checkpoints, state.index, false)?;
        files.digest = Some(state.digest);
        (files.rows, files.kept) = (state.written.rows, state.written.kept);
        files.plan_next(state.run.t());
        if checkpoints.first() == Some(state.index) {
            files.outdated = state.written.aside;
            return Ok(files);
        }
        let path = checkpoints.file(state.index, ".rows");
        copy_aside(&checkpoints.disk, &path, state.written.rows, take)?;
        files.aside = Some(cut(&checkpoints.disk, &path, state.written.rows.bytes)?);
        Ok(files)
    }

    /// Whether its rows are kept aside.
    pub(in crate::sweep) fn is_aside(&self) -> bool {
        self.aside.is_some()
    }

    /// Whether a checkpoint is due.
    pub(in crate::sweep) fn is_due(&self, t: f64) -> bool {
        t >= self.next
    }

    /// Takes whole rows.
    pub(in crate::sweep) fn take(&mut self, text: &[u8]) -> io::Result<()> {
        self.rows.take(text);
        self.aside.as_mut().map_or(Ok(()), |file| file.write_all(text))
    }

    /// Takes the values of whole rows for figures.
    pub(in crate::sweep) fn take_kept(&mut self, values: &[f64]) -> io::Result<()> {
        if values.is_empty() {
            return Ok(());
        }
        if self.kept_file.is_none() {
            let path = self.checkpoints.file(self.index, ".kept");
            self.kept_file = Some(cut(&self.checkpoints.disk, &path, self.kept.bytes)?);
        }
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.kept.take(&bytes);
        self.kept_file.as_mut().map_or(Ok(()), |file| file.write_all(&bytes))
    }

    /// What tells this case from others.
    pub(in crate::sweep) fn digest(&mut self, plan: &Plan, system: &System) -> u32 {
        *self.digest.get_or_insert_with(|| digest(plan, system))
    }

    /// How far rows and values for figures are written.
    pub(in crate::sweep) fn written(&self) -> (Stretch, Stretch) {
        (self.rows, self.kept)
    }

    /// Writes the state of the case, once all that it speaks of is safe; `sync` makes the shared rows so.
    pub(in crate::sweep) fn keep(
        &mut self,
        state: &CaseState,
        sync: impl FnOnce() -> io::Result<()>,
    ) -> io::Result<()> {
        self.kept_file.iter().chain(&self.aside).try_for_each(DiskFile::sync)?;
        sync()?;
        self.checkpoints.growing().journal.sync()?;
        let path = self.checkpoints.file(self.index, "");
        sealed::write(&self.checkpoints.disk, &path, CHECKPOINT, &bytes(state)?)?;
        self.plan_next(state.run.t());
        self.drop_outdated()
    }

    /// Writes down that the case has ended; `sync` makes the shared rows safe and tells before which case all are there.
    pub(in crate::sweep) fn end(mut self, done: &CaseDone, sync: impl FnOnce() -> io::Result<usize>) -> io::Result<()> {
        self.kept_file.iter().try_for_each(DiskFile::sync)?;
        self.checkpoints.add(done, sync)?;
        self.drop_outdated()?;
        self.checkpoints.disk.remove(&self.checkpoints.file(self.index, ""))
    }

    /// The first multiple of the spacing after t.
    fn plan_next(&mut self, t: f64) {
        let every = self.checkpoints.head.origin.every;
        self.next = ((t / every).floor() + 1.0) * every;
    }

    fn drop_outdated(&mut self) -> io::Result<()> {
        if std::mem::take(&mut self.outdated) {
            self.checkpoints.disk.remove(&self.checkpoints.file(self.index, ".rows"))?;
        }
        Ok(())
    }
}

impl Checkpoints {
    /// Hands over the rows of a case that were kept aside.
    pub(in crate::sweep) fn copy_rows(
        &self,
        done: &CaseDone,
        take: &mut dyn FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        copy_aside(&self.disk, &self.file(done.index, ".rows"), done.written.rows, take)
    }

    /// Hands over the values that a case kept for figures, `columns` of each row, row by row.
    pub(in crate::sweep) fn kept(
        &self,
        case: usize,
        kept: Stretch,
        columns: usize,
        take: &mut dyn FnMut(&[f64]),
    ) -> io::Result<()> {
        read_kept(&self.disk, &self.file(case, ".kept"), kept, columns, take)
    }
}

/// Hands over the values at the beginning of a file of kept ones, `columns` of each row, row by row.
pub(super) fn read_kept(
    disk: &Disk,
    file: &Path,
    kept: Stretch,
    columns: usize,
    take: &mut dyn FnMut(&[f64]),
) -> io::Result<()> {
    let rows = if columns == 0 { 0 } else { kept.bytes / (8 * columns as u64) };
    if rows == 0 {
        return Ok(());
    }
    let mut file = io::BufReader::new(disk.open(file)?);
    let (mut bytes, mut values) = (vec![0; 8 * columns], vec![0.0; columns]);
    for _ in 0..rows {
        file.read_exact(&mut bytes)?;
        for (value, bytes) in values.iter_mut().zip(bytes.as_chunks().0) {
            *value = f64::from_le_bytes(*bytes);
        }
        take(&values);
    }
    Ok(())
}

/// A file that is to grow from its first `bytes` on.
fn cut(disk: &Disk, path: &Path, bytes: u64) -> io::Result<DiskFile> {
    if bytes == 0 {
        return disk.create(path);
    }
    let mut file = disk.edit(path)?;
    file.set_length(bytes)?;
    file.seek(SeekFrom::Start(bytes))?;
    Ok(file)
}
