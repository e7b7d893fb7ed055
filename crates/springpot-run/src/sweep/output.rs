//! What one case writes: rows, statistics, values for figures, and what it takes to go on.

use super::Sweep;
use super::checkpoint::{CaseFiles, CaseState, Written};
use super::events::CaseEvents;
use super::kept::{CaseCurves, Kept};
use super::metrics::CaseMetrics;
use crate::table::disk::DiskFile;
use crate::table::ordered::Section;
use crate::table::{Statistics, push_fields, push_number, push_text};
use springpot::integrate::{Checkpoint, LimitWatch, Rows, System};
use springpot_scenario::{MetricPlan, Plan, SweptValue};
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
    /// The swept values, which begin every row.
    lead: String,
    selected: Vec<usize>,
    pub(super) statistics: Vec<Statistics>,
    pub(super) events: CaseEvents,
    kept: Option<Kept<'a>>,
    /// Values for figures that are not handed over yet, where a checkpoint wants them.
    values: Vec<f64>,
    text: String,
    handed_over: Instant,
    rows: Section<'a, DiskFile>,
    pub(super) files: Option<CaseFiles<'a>>,
    begun: Instant,
    earlier_wall: Duration,
}

/// The rows of a case whose plan is known.
#[derive(Debug)]
pub(super) struct CaseRows<'a, 'b> {
    pub(super) output: &'b mut Output<'a>,
    pub(super) watch: LimitWatch,
    pub(super) plan: &'b Plan,
    pub(super) system: &'b System,
}

impl<'a> Output<'a> {
    /// The output of case `index`; it goes on where an earlier run left it in `state`.
    pub(super) fn open(
        sweep: &'a Sweep<'a>,
        index: usize,
        rows: Section<'a, DiskFile>,
        state: Option<&CaseState>,
    ) -> io::Result<Self> {
        let selected: Vec<usize> = sweep.layout.selected().map(|(k, _)| k).collect();
        let mut output = Self {
            sweep,
            index,
            lead: lead(sweep, index),
            statistics: vec![Statistics::default(); selected.len()],
            events: CaseEvents::default(),
            selected,
            kept: Kept::of(sweep.layout, index),
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
        output.statistics.clone_from(statistics);
        output.events.clone_from(events);
        if let Some(curves) = &mut output.kept {
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
            statistics: self.statistics.clone(),
            events: self.events.clone(),
            wall: self.wall(),
            wall_of_run: self.sweep.wall(),
        }
    }

    /// What the metrics are of the rows so far.
    pub(super) fn metrics(&self, plans: &[MetricPlan]) -> CaseMetrics {
        let kept = self.kept.as_ref();
        kept.map_or_else(CaseMetrics::default, |kept| kept.metrics(self.sweep.layout, plans, &self.lead))
    }

    /// Wall time of the case.
    pub(super) fn wall(&self) -> Duration {
        self.earlier_wall + self.begun.elapsed()
    }

    /// Hands over the last rows, writes down how the case ended, and lets the next case write.
    pub(super) fn close(mut self, end: impl FnOnce(&mut Self) -> io::Result<()>) -> io::Result<Option<CaseCurves>> {
        self.hand_over()?;
        end(&mut self)?;
        self.rows.finish()?;
        Ok(self.kept.and_then(Kept::into_curves))
    }
}

impl Rows for CaseRows<'_, '_> {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        let Output { lead, selected, statistics, kept, values: for_files, files, text, .. } = &mut *self.output;
        text.push_str(lead);
        let mut values = selected.iter().map(|&k| row[k]);
        push_number(text, values.next().unwrap_or(f64::NAN));
        push_fields(text, values);
        text.push('\n');
        for (statistics, &k) in statistics.iter_mut().zip(&*selected) {
            statistics.add(row[k]);
        }
        if let Some(kept) = kept {
            let values = kept.row(row);
            if files.is_some() {
                for_files.extend_from_slice(values);
            }
        }
        self.watch.see(row);
        self.output.sweep.options.progress.rows.fetch_add(1, Ordering::Relaxed);
        if self.output.text.len() >= CHUNK || self.output.handed_over.elapsed() > PATIENCE {
            self.output.hand_over()?;
        }
        Ok(())
    }

    fn event(&mut self, event: usize, row: &[f64]) -> io::Result<()> {
        let Output { lead, events, .. } = &mut *self.output;
        events.take(self.system, lead, event, row);
        Ok(())
    }

    fn looked_ahead(&mut self, switches: u64) {
        self.output.sweep.options.progress.switches.fetch_max(switches, Ordering::Relaxed);
    }

    fn wants_checkpoint(&mut self, t: f64, last: bool) -> bool {
        self.output.sweep.options.progress.reach(t);
        self.output.files.as_ref().is_some_and(|files| last || files.is_due(t))
    }

    fn checkpoint(&mut self, run: Checkpoint) -> io::Result<()> {
        self.output.hand_over()?;
        let written = self.output.written();
        let Output { sweep, index, files: Some(files), .. } = &mut *self.output else { return Ok(()) };
        let digest = files.digest(self.plan, self.system);
        let state = CaseState { index: *index, digest, written, watch: self.watch.seen(), run };
        files.keep(&state, || sweep.file.sync())
    }
}

/// The swept values of a case, each with its comma.
pub(super) fn lead(sweep: &Sweep, index: usize) -> String {
    let mut lead = String::new();
    for value in sweep.cases.values(index) {
        match value {
            SweptValue::Number(number) => push_number(&mut lead, number),
            SweptValue::Text(text) => push_text(&mut lead, &text),
        }
        lead.push(',');
    }
    lead
}

/// The lines of a case in summary.csv.
pub(super) fn summary(sweep: &Sweep, index: usize, statistics: &[Statistics]) -> String {
    let (lead, mut summary) = (lead(sweep, index), String::new());
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
