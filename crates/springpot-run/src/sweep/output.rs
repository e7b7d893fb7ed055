//! What one case writes: rows, statistics, values for figures, and what it takes to go on.

use super::Sweep;
use super::checkpoint::{CaseFiles, CaseState, Written};
use super::metrics::CaseMetrics;
use super::simulate::{Back, Resumed, Sink};
use super::taken::{Taken, lead, push_row};
use crate::table::disk::DiskFile;
use crate::table::ordered::Section;
use crate::table::{Statistics, push_fields, push_text};
use springpot::system::{RunError, System};
use springpot_scenario::Plan;
use std::io;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Text is handed over at this size, or after this time.
const CHUNK: usize = 1 << 15;
const PATIENCE: Duration = Duration::from_millis(200);

/// The output of one case.
#[derive(Debug)]
pub(super) struct Output<'a> {
    sweep: &'a Sweep<'a>,
    index: usize,
    pub(super) taken: Taken<'a>,
    /// Values for figures that are not handed over yet, where a checkpoint wants them.
    values: Vec<f64>,
    text: String,
    handed_over: Instant,
    rows: Section<'a, DiskFile>,
    pub(super) files: Option<CaseFiles<'a>>,
    begun: Instant,
    earlier_wall: Duration,
}

impl<'a> Output<'a> {
    /// The output of case `index`; it goes on where an earlier run left it in `state`.
    pub(super) fn open(
        sweep: &'a Sweep<'a>,
        index: usize,
        rows: Section<'a, DiskFile>,
        state: Option<&CaseState>,
    ) -> io::Result<Self> {
        let mut output = Self {
            sweep,
            index,
            taken: Taken::of(sweep.cases, sweep.layout, index),
            values: Vec::new(),
            text: String::with_capacity(2 * CHUNK),
            handed_over: Instant::now(),
            rows,
            files: None,
            begun: Instant::now(),
            earlier_wall: Duration::ZERO,
        };
        let Some(checkpoints) = sweep.options.checkpoints else { return Ok(output) };
        let Some(state) = state else {
            let aside = sweep.rows.turn() != index;
            output.files = Some(CaseFiles::begin(checkpoints, index, aside)?);
            return Ok(output);
        };
        let section = &output.rows;
        output.files = Some(CaseFiles::go_on(checkpoints, state, &mut |text| section.write(text))?);
        let Written { kept, ref statistics, ref events, wall, .. } = state.written;
        output.earlier_wall = wall;
        output.taken.statistics.clone_from(statistics);
        output.taken.events.clone_from(events);
        if let Some(curves) = &mut output.taken.kept {
            checkpoints.kept(index, kept, curves.width(), &mut |values| curves.again(values))?;
        }
        sweep.options.progress.rows.fetch_add(state.run.rows() as u64, Ordering::Relaxed);
        Ok(output)
    }

    fn hand_over(&mut self) -> io::Result<()> {
        let text = self.text.as_bytes();
        if let Some(files) = &mut self.files {
            files.take(text)?;
            files.take_kept(&self.values)?;
            self.values.clear();
        }
        self.rows.write(text)?;
        self.text.clear();
        self.handed_over = Instant::now();
        Ok(())
    }

    /// How far the case has written; all its rows are handed over, and its values for figures are written.
    pub(super) fn written(&self) -> Written {
        let (rows, kept) = self.files.as_ref().map_or_else(Default::default, CaseFiles::written);
        Written {
            rows,
            aside: self.files.as_ref().is_some_and(CaseFiles::is_aside),
            kept,
            statistics: self.taken.statistics.clone(),
            events: self.taken.events.clone(),
            wall: self.wall(),
            wall_of_run: self.sweep.wall(),
        }
    }

    /// Wall time of the case.
    pub(super) fn wall(&self) -> Duration {
        self.earlier_wall + self.begun.elapsed()
    }

    /// Hands over the last rows, writes down how the case ended, and lets the next case write.
    pub(super) fn close(mut self, end: impl FnOnce(&mut Self) -> io::Result<()>) -> io::Result<Taken<'a>> {
        self.hand_over()?;
        end(&mut self)?;
        self.rows.finish()?;
        Ok(self.taken)
    }
}

impl Sink for Output<'_> {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        let values = self.taken.row(row);
        if self.files.is_some() {
            self.values.extend_from_slice(values);
        }
        push_row(&mut self.text, &self.taken.lead, self.taken.selected.iter().map(|&k| row[k]));
        if self.text.len() >= CHUNK || self.handed_over.elapsed() > PATIENCE {
            self.hand_over()?;
        }
        Ok(())
    }

    fn event(&mut self, system: &System, event: usize, row: &[f64]) {
        self.taken.event(system, event, row);
    }

    fn ended(&mut self, row: &[f64], later: &[f64]) {
        self.taken.ended(row, later);
    }

    fn is_due(&self, t: f64, last: bool) -> bool {
        self.files.as_ref().is_some_and(|files| last || files.is_due(t))
    }

    fn keep(&mut self, plan: &Plan, system: &System, Resumed { run, watch, lost }: Resumed) -> io::Result<()> {
        self.hand_over()?;
        let written = self.written();
        let Self { sweep, index, files: Some(files), .. } = self else { return Ok(()) };
        let state = CaseState { index: *index, digest: files.digest(plan, system), written, watch, lost, run };
        files.keep(&state, || sweep.file.sync())
    }

    fn metrics(&self, plan: &Plan, back: Option<Back>) -> Result<CaseMetrics, RunError> {
        self.taken.metrics(plan, back)
    }
}

/// The lines of a case in summary.csv.
pub(super) fn summary(sweep: &Sweep, index: usize, statistics: &[Statistics]) -> String {
    let (lead, mut summary) = (lead(sweep.cases, index), String::new());
    for ((_, column), statistics) in sweep.layout.selected().zip(statistics) {
        summary.push_str(&lead);
        push_text(&mut summary, &column.name);
        summary.push(',');
        push_text(&mut summary, &column.unit);
        push_fields(&mut summary, [statistics.min, statistics.max, statistics.rms()].into_iter());
        summary.push('\n');
    }
    summary
}
