//! `springpot run`.

mod finished;
mod prepare;

use self::finished::Finished;
use self::prepare::{Prepared, Unprepared, prepare};
use crate::arguments::RunOptions;
use crate::numbers::count;
use crate::{Ending, diagnostic, figures, progress, signals, terminal};
use springpot_run::sweep::{self, Options, Progress, Status, SweepError};
use springpot_run::table::Format;
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::FolderError;
use springpot_scenario::Cases;
use std::io;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Limits of joints that are named one by one.
pub(crate) const NAMED_LIMITS: usize = 10;

/// Why there are no results of a run.
#[derive(Debug, thiserror::Error)]
enum Stopped {
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    Folder(#[from] FolderError),
}

impl From<io::Error> for Stopped {
    fn from(error: io::Error) -> Self {
        Self::Folder(error.into())
    }
}

pub(crate) fn run(options: &RunOptions, disk: &Disk) -> Ending {
    let begun = Instant::now();
    let prepared = match prepare(options, disk) {
        Ok(prepared) => prepared,
        Err(Unprepared::Refused(refused)) => {
            diagnostic::refused(&refused);
            return Ending::Refused;
        }
        Err(Unprepared::Shown) => return Ending::Refused,
        Err(Unprepared::Settled(status)) => return if status == "done" { Ending::Done } else { Ending::Failed },
        Err(Unprepared::Folder(out, error)) => return no_results(&out, error, None),
    };
    let (out, goes_on) = (prepared.folder.path().to_owned(), prepared.checkpoints.is_some());
    match execute(options, prepared) {
        Ok(finished) => {
            finished.warn();
            finished.complain();
            if goes_on && finished.outcome.status == Status::Interrupted {
                terminal::print_error(&format!("to go on: {}\n", to_go_on(&out)));
            }
            if !options.quiet {
                terminal::print(&finished.summary(begun.elapsed()));
            }
            match finished.outcome.status {
                Status::Done => Ending::Done,
                Status::Failed => Ending::Failed,
                Status::Interrupted => Ending::Interrupted,
            }
        }
        Err(Stopped::Sweep(SweepError::Refused(refused))) => {
            diagnostic::refused(&refused);
            Ending::Refused
        }
        Err(Stopped::Sweep(SweepError::Output(error))) => no_results(&out, error.into(), Some(goes_on)),
        Err(Stopped::Folder(error)) => no_results(&out, error, Some(goes_on)),
    }
}

/// Says why there are no results, and what can be done; a run that was under way can be gone on with or not.
fn no_results(out: &Path, error: FolderError, goes_on: Option<bool>) -> Ending {
    let folder = out.display();
    let (message, help, ending) = match error {
        FolderError::Held { .. } => {
            (error.to_string(), Some("wait for it, stop it, or name another folder with --out".into()), Ending::Failed)
        }
        FolderError::Foreign(_) | FolderError::Input(_) => {
            let help = "nothing was changed; name another folder with --out, or move the file away";
            (error.to_string(), Some(help.to_owned()), Ending::Refused)
        }
        FolderError::Damaged(ref file) => {
            let help = format!("nothing was changed; look at {folder}, and then move {} away", file.display());
            (error.to_string(), Some(help), Ending::Failed)
        }
        FolderError::Pending { .. } => {
            (error.to_string(), Some(format!("to put them there once that can be: {}", to_go_on(out))), Ending::Failed)
        }
        FolderError::File(error) => {
            let help = goes_on.map(|goes_on| match goes_on {
                true => format!("to go on once they can: {}", to_go_on(out)),
                false => format!("{folder}/results.csv.part holds its rows so far; earlier results are as they were"),
            });
            (format!("the results cannot be written to {folder}: {error}"), help, Ending::Failed)
        }
    };
    match help {
        Some(help) => diagnostic::error_with_help(message, help),
        None => diagnostic::error(message),
    }
    ending
}

/// The command that goes on with a run.
fn to_go_on(out: &Path) -> String {
    format!("springpot run --resume {}", out.display())
}

/// Runs all cases, draws the figures, writes the record, and puts all of it in place.
fn execute(options: &RunOptions, prepared: Prepared) -> Result<Finished, Stopped> {
    let Prepared { cases, plan, system, layout, mut folder, checkpoints, figures, format } = prepared;
    let done = Progress::default();
    let wanted = (cases.len() as u64).saturating_mul(plan.time.rows.count() as u64);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores, usize::from);
    let sweep_options = Options { jobs, stop: signals::stop(), progress: &done, checkpoints: checkpoints.as_ref() };
    let outcome = progress::show_while(wanted, plan.time.end, &done, options.quiet, || {
        sweep::run(&cases, &layout, &mut folder, sweep_options)
    })?;
    let (rows, end) = (done.rows.load(Ordering::Relaxed), plan.time.end);

    let goes_on = checkpoints.is_some() && outcome.status == Status::Interrupted;
    let is_put = match outcome.status {
        Status::Done => true,
        Status::Failed => rows > 0,
        // Less than one row is no reason to lose an earlier result.
        Status::Interrupted => rows > 0 || !folder.has_earlier(),
    };
    if !is_put {
        // What a checkpoint goes on with stays beside the earlier results.
        if !goes_on {
            folder.discard()?;
        }
        return Ok(Finished { cases, outcome, folder, rows, end, is_put });
    }
    if figures && outcome.status != Status::Interrupted {
        for warning in figures::draw(&cases, &system, &plan, &layout, &outcome, &mut folder)? {
            diagnostic::warning(warning, None);
        }
    }
    // What is gone on with goes on as text.
    let written = if goes_on { Format::Csv } else { format };
    folder.convert_rows(written, layout.written(), layout.swept())?;
    let mut record = outcome.record(&cases, &plan, &layout);
    record.insert("format".to_owned(), written.name().into());
    folder.put(record, goes_on)?;
    Ok(Finished { cases, outcome, folder, rows, end, is_put })
}

/// `message` with the swept values of its case in front, where anything is swept.
pub(crate) fn in_case(cases: &Cases, index: usize, message: &str) -> String {
    let name = case_name(cases, index);
    if name.is_empty() { message.to_owned() } else { format!("{name}: {message}") }
}

/// `message` about the case `first` with its swept values in front, and how many others it holds for; as it is where
/// it holds for all that were looked at.
pub(crate) fn in_cases(cases: &Cases, looked_at: usize, first: usize, found: usize, message: &str) -> String {
    if found >= looked_at {
        message.to_owned()
    } else if found == 1 {
        in_case(cases, first, message)
    } else {
        let others = count(found - 1, "other case", "other cases");
        format!("{} and {others}: {message}", case_name(cases, first))
    }
}

/// The swept values of a case; empty where nothing is swept.
pub(crate) fn case_name(cases: &Cases, index: usize) -> String {
    let labels = cases.labels(index);
    let named = cases.parameters().iter().zip(labels).map(|(parameter, label)| format!("{parameter} = {label}"));
    named.collect::<Vec<_>>().join(", ")
}
