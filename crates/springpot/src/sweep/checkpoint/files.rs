//! The files of one case.

use super::record::{bytes, digest};
use super::rows::copy_aside;
use super::{CaseDone, CaseState, Checkpoints};
use crate::scenario::Plan;
use crate::simulate::System;
use crate::table::folder;
use crate::table::sealed;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// What a case keeps while it is under way.
#[derive(Debug)]
pub(in crate::sweep) struct CaseFiles<'a> {
    checkpoints: &'a Checkpoints,
    index: usize,
    /// Its rows, where its turn had not come when it began.
    aside: Option<File>,
    /// Whether rows that an earlier run kept aside are still there.
    outdated: bool,
    kept: Option<File>,
    /// Rows that an earlier run left in `kept`.
    kept_rows: usize,
    /// Time of the next checkpoint, s.
    next: f64,
    digest: Option<u64>,
}

impl<'a> CaseFiles<'a> {
    /// The files of a case that begins, in the first file of all rows or aside.
    pub(in crate::sweep) fn begin(checkpoints: &'a Checkpoints, index: usize, aside: bool) -> io::Result<Self> {
        let aside = aside.then(|| File::create(checkpoints.file(index, ".rows"))).transpose()?;
        let next = checkpoints.head.origin.every;
        Ok(Self { checkpoints, index, aside, outdated: false, kept: None, kept_rows: 0, next, digest: None })
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
        files.kept_rows = state.written.kept as usize;
        files.plan_next(state.run.t());
        if checkpoints.first() == Some(state.index) {
            files.outdated = state.written.aside;
            return Ok(files);
        }
        let path = checkpoints.file(state.index, ".rows");
        copy_aside(&path, state.written.bytes, take)?;
        files.aside = Some(cut(&path, state.written.bytes)?);
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
        self.aside.as_mut().map_or(Ok(()), |file| file.write_all(text))
    }

    /// Takes the values of whole rows for figures, `columns` of each.
    pub(in crate::sweep) fn take_kept(&mut self, values: &[f64], columns: usize) -> io::Result<()> {
        if values.is_empty() {
            return Ok(());
        }
        if self.kept.is_none() {
            let path = self.checkpoints.file(self.index, ".kept");
            self.kept = Some(cut(&path, (8 * columns * self.kept_rows) as u64)?);
        }
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.kept.as_mut().map_or(Ok(()), |file| file.write_all(&bytes))
    }

    /// What tells this case from others.
    pub(in crate::sweep) fn digest(&mut self, plan: &Plan, system: &System) -> u64 {
        *self.digest.get_or_insert_with(|| digest(plan, system))
    }

    /// Writes the state of the case; `sync` makes the shared rows safe.
    pub(in crate::sweep) fn keep(
        &mut self,
        state: &CaseState,
        sync: impl FnOnce() -> io::Result<()>,
    ) -> io::Result<()> {
        self.kept.iter().chain(&self.aside).try_for_each(File::sync_data)?;
        self.checkpoints.growing().journal.sync()?;
        sync()?;
        sealed::write(&self.checkpoints.file(self.index, ""), &bytes(state)?)?;
        self.plan_next(state.run.t());
        self.drop_outdated()
    }

    /// Writes down that the case has ended; `sync` makes the shared rows safe and tells before which case all are there.
    pub(in crate::sweep) fn end(mut self, done: &CaseDone, sync: impl FnOnce() -> io::Result<usize>) -> io::Result<()> {
        self.kept.iter().try_for_each(File::sync_data)?;
        self.checkpoints.add(done, sync)?;
        self.drop_outdated()?;
        folder::remove_if_there(&self.checkpoints.file(self.index, ""))
    }

    /// The first multiple of the spacing after t.
    fn plan_next(&mut self, t: f64) {
        let every = self.checkpoints.head.origin.every;
        self.next = ((t / every).floor() + 1.0) * every;
    }

    fn drop_outdated(&mut self) -> io::Result<()> {
        if std::mem::take(&mut self.outdated) {
            folder::remove_if_there(&self.checkpoints.file(self.index, ".rows"))?;
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
        copy_aside(&self.file(done.index, ".rows"), done.written.bytes, take)
    }

    /// Hands over the values that a case kept for figures, `columns` of each of its `rows` rows, row by row.
    pub(in crate::sweep) fn kept(
        &self,
        case: usize,
        rows: u64,
        columns: usize,
        take: &mut dyn FnMut(&[f64]),
    ) -> io::Result<()> {
        if rows == 0 || columns == 0 {
            return Ok(());
        }
        let mut file = io::BufReader::new(File::open(self.file(case, ".kept"))?);
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
}

/// A file that is to grow from its first `bytes` on.
fn cut(path: &std::path::Path, bytes: u64) -> io::Result<File> {
    let mut file = File::options().write(true).create(true).truncate(false).open(path)?;
    file.set_len(bytes)?;
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}
