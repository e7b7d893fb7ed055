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
    /// Rows in `kept`.
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

    /// What tells this case from others.
    pub(in crate::sweep) fn digest(&mut self, plan: &Plan, system: &System) -> u64 {
        *self.digest.get_or_insert_with(|| digest(plan, system))
    }

    /// Writes the state of the case; `sync` makes the shared rows safe.
    pub(in crate::sweep) fn keep(
        &mut self,
        state: &CaseState,
        kept: Option<&[Vec<f64>]>,
        sync: impl FnOnce() -> io::Result<()>,
    ) -> io::Result<()> {
        self.write_kept(kept)?;
        self.kept.iter().chain(&self.aside).try_for_each(File::sync_data)?;
        self.checkpoints.growing().journal.sync()?;
        sync()?;
        sealed::write(&self.checkpoints.file(self.index, ""), &bytes(state)?)?;
        self.plan_next(state.run.t());
        self.drop_outdated()
    }

    /// Writes down that the case has ended; `sync` makes the shared rows safe and tells before which case all are there.
    pub(in crate::sweep) fn end(
        mut self,
        done: &CaseDone,
        kept: Option<&[Vec<f64>]>,
        sync: impl FnOnce() -> io::Result<usize>,
    ) -> io::Result<()> {
        self.write_kept(kept)?;
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

    /// Adds the values of new rows, row by row.
    fn write_kept(&mut self, columns: Option<&[Vec<f64>]>) -> io::Result<()> {
        let Some(columns) = columns else { return Ok(()) };
        let rows = columns.first().map_or(0, Vec::len);
        let new = self.kept_rows..rows;
        let values = new.flat_map(|row| columns.iter().map(move |column| column[row]));
        let text: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
        if self.kept.is_none() {
            let path = self.checkpoints.file(self.index, ".kept");
            self.kept = Some(cut(&path, (8 * columns.len() * self.kept_rows) as u64)?);
        }
        self.kept_rows = rows;
        self.kept.as_mut().map_or(Ok(()), |file| file.write_all(&text))
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

    /// The values of `rows` rows that a case kept for figures, column by column.
    pub(in crate::sweep) fn kept(&self, case: usize, rows: u64, columns: usize) -> io::Result<Vec<Vec<f64>>> {
        let mut kept = vec![Vec::with_capacity(rows as usize); columns];
        if rows == 0 || columns == 0 {
            return Ok(kept);
        }
        let mut file = io::BufReader::new(File::open(self.file(case, ".kept"))?);
        let mut value = [0; 8];
        for _ in 0..rows {
            for column in &mut kept {
                file.read_exact(&mut value)?;
                column.push(f64::from_le_bytes(value));
            }
        }
        Ok(kept)
    }
}

/// A file that is to grow from its first `bytes` on.
fn cut(path: &std::path::Path, bytes: u64) -> io::Result<File> {
    let mut file = File::options().write(true).create(true).truncate(false).open(path)?;
    file.set_len(bytes)?;
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}
