//! From what was prepared to results that are in place.

use crate::figures;
use crate::planned::Planned;
use crate::prepare::Prepared;
use crate::scene::Drawn;
use crate::sweep::{self, Options, Outcome, Progress, Status, SweepError};
use crate::table::Format;
use crate::table::folder::{Folder, FolderError};
use crate::warning::{Warn, Warning};
use springpot::system::Stop;
use springpot_scenario::Cases;
use std::sync::atomic::Ordering;

/// What a run that came to an end left behind.
#[derive(Debug)]
pub struct Finished {
    /// Its cases.
    pub cases: Cases,
    /// What they did.
    pub outcome: Outcome,
    /// The folder of the results.
    pub folder: Folder,
    /// Names of its events.
    pub events: Vec<String>,
    /// Names of its metrics, and the units of their values.
    pub metrics: Vec<[String; 2]>,
    /// Rows written, over all cases.
    pub rows: u64,
    /// End of the first case, s.
    pub end: f64,
    /// Whether its results were put in place.
    pub is_put: bool,
}

impl Prepared {
    /// Rows of all cases that are run, where each has as many as the first.
    pub fn rows_wanted(&self) -> u64 {
        let Planned { cases, plan, .. } = &self.planned;
        let run = self.shard.map_or(cases.len(), |shard| shard.cases(cases.len()).len());
        (run as u64).saturating_mul(plan.settings.rows.count() as u64)
    }

    /// Runs all cases, `jobs` at a time, until `stop` is set; `progress` can be watched meanwhile.
    ///
    /// # Errors
    /// As [`sweep::run`].
    pub fn sweep(&mut self, jobs: usize, stop: &Stop, progress: &Progress) -> Result<Outcome, SweepError> {
        let Planned { cases, plan, system, layout } = &self.planned;
        let drawn = Drawn::of(cases, (plan, system));
        let range = self.shard.map_or(0..cases.len(), |shard| shard.cases(cases.len()));
        let mut begun = sweep::begun(cases, plan, layout, range);
        drawn.record(&mut begun, self.folder.path());
        begun.insert("id".to_owned(), self.id.clone().into());
        // Who watches may see less; the run goes on.
        let _ = self.folder.tell(&begun);
        // Of many elements it is large.
        drop(begun);
        self.drawn = Some(drawn);
        let (checkpoints, source) = (self.checkpoints.as_ref(), self.source.as_deref());
        let options = Options { jobs, stop, progress, checkpoints, source, shard: self.shard };
        sweep::run(&self.planned.cases, &self.planned.layout, &mut self.folder, options)
    }

    /// Draws the figures, writes run.json, and puts all of it in place; `progress` is that of the sweep. Figures that cannot be
    /// drawn are warnings.
    ///
    /// A run without a row leaves the results of an earlier one as they were.
    ///
    /// # Errors
    /// The folder cannot be written, or is not there any more.
    pub fn finish(self, outcome: Outcome, progress: &Progress, warn: Warn<'_>) -> Result<Finished, FolderError> {
        let Self { asked, planned, mut folder, checkpoints, shard, figures, format, drawn, .. } = self;
        let Planned { cases, plan, system, layout } = planned;
        if !folder.is_in_place() {
            return Err(FolderError::Removed(folder.path().to_owned()));
        }
        let (rows, end) = (progress.rows.load(Ordering::Relaxed), plan.settings.end);
        let (events, metrics) = (layout.events().to_vec(), layout.metric_units());
        // A part goes on where the parts are put together.
        let goes_on = checkpoints.is_some() && (outcome.status == Status::Interrupted || shard.is_some());
        let is_put = match outcome.status {
            Status::Done => true,
            // A part without a row is a part: what failed in it belongs to the whole.
            Status::Failed => rows > 0 || shard.is_some(),
            // Less than one row is no reason to lose an earlier result.
            Status::Interrupted => rows > 0 || !folder.has_earlier(),
        };
        if !is_put {
            // What a checkpoint goes on with stays beside the earlier results.
            if !goes_on {
                folder.discard()?;
            }
            return Ok(Finished { cases, outcome, folder, events, metrics, rows, end, is_put });
        }
        if figures && outcome.status != Status::Interrupted {
            figures::draw(&cases, &system, &plan, &layout, &outcome, &mut folder)?
                .into_iter()
                .map(Warning::from)
                .for_each(warn);
        }
        // What is gone on with goes on as text.
        let written = if goes_on { Format::Csv } else { format };
        folder.convert_rows(written, layout.written(), layout.swept())?;
        let results = folder.path().to_owned();
        let record = |files: &[String]| {
            let mut record = outcome.record(&cases, &plan, &layout, written, files);
            record.insert("scenario".to_owned(), asked.record());
            record.insert("rows".to_owned(), rows.into());
            drawn.unwrap_or_else(|| Drawn::of(&cases, (&plan, &system))).record(&mut record, &results);
            record
        };
        folder.put(record, goes_on)?;
        Ok(Finished { cases, outcome, folder, events, metrics, rows, end, is_put })
    }
}
