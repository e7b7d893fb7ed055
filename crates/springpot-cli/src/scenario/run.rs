//! `springpot run`, and `springpot merge`, which ends as a run does.

mod finished;
mod prepare;
mod saturated;

use self::finished::Said;
use self::prepare::{Unprepared, prepare};
use crate::arguments::{MergeOptions, RunOptions};
use crate::results::view;
use crate::scenario::{failures, starts, swept};
use crate::{Ending, diagnostic, progress, signals, terminal};
use springpot::law::Catalog;
use springpot_run::sweep::{Progress, Status, SweepError};
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::FolderError;
use springpot_run::{Finished, NewRun, Prepared, Surroundings};
use std::path::Path;
use std::time::Instant;

/// Why there are no results of a run.
#[derive(Debug, thiserror::Error)]
enum Stopped {
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    Folder(#[from] FolderError),
}

pub(crate) fn run(options: &RunOptions, catalog: &Catalog, disk: &Disk) -> Ending {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores, usize::from);
    let prepare = || prepare(options, catalog, disk);
    carry_out(jobs, options.quiet, options.view.then_some(disk), prepare, |_| Ending::Done)
}

/// Runs what was asked for, on `jobs` cores; `then` says what comes of a run that is done.
pub(crate) fn run_new(
    new: NewRun,
    (jobs, quiet): (usize, bool),
    (catalog, disk): (&Catalog, &Disk),
    then: impl FnOnce(&Finished) -> Ending,
) -> Ending {
    let holder = format!("springpot on {}", new.asked.name);
    let with = Surroundings { catalog, disk, stop: signals::stop(), holder: &holder };
    carry_out(jobs, quiet, None, || Ok(Prepared::begin(new, with, &mut diagnostic::warn)?), then)
}

/// `springpot merge`.
pub(crate) fn merge(options: &MergeOptions, catalog: &Catalog, disk: &Disk) -> Ending {
    // One job reads the parts in order.
    carry_out(1, options.quiet, None, || prepare::merge(options, catalog, disk), |_| Ending::Done)
}

/// `view`: the disk on which a page is written beside the results.
fn carry_out(
    jobs: usize,
    quiet: bool,
    view: Option<&Disk>,
    prepare: impl FnOnce() -> Result<Prepared, Unprepared>,
    then: impl FnOnce(&Finished) -> Ending,
) -> Ending {
    let begun = Instant::now();
    let prepared = match prepare() {
        Ok(prepared) => prepared,
        Err(Unprepared::Refused(refused)) => {
            diagnostic::refused(&refused);
            return Ending::Refused;
        }
        Err(Unprepared::Hopeless(cases, survey)) => {
            starts::remarks(&survey, &cases).into_iter().for_each(diagnostic::remark);
            failures::tell(&survey, &cases);
            terminal::print_error("nothing was run, and earlier results are as they were\n");
            return Ending::Refused;
        }
        Err(Unprepared::Shown) => return Ending::Refused,
        Err(Unprepared::Interrupted) => {
            terminal::print_error("interrupted before anything was run; earlier results are as they were\n");
            return Ending::Interrupted;
        }
        Err(Unprepared::Settled(status)) => return if status == "done" { Ending::Done } else { Ending::Failed },
        Err(Unprepared::Folder(out, error)) => return no_results(&out, error, None),
    };
    if let Some(survey) = &prepared.survey {
        starts::remarks(survey, &prepared.planned.cases).into_iter().for_each(diagnostic::remark);
    }
    let (out, goes_on) = (prepared.folder.path().to_owned(), prepared.checkpoints.is_some());
    if !quiet {
        terminal::print(&swept::lines(&prepared.planned.cases, terminal::stdout_width()));
    }
    match execute(jobs, quiet, prepared) {
        Ok(finished) => {
            let (status, is_put) = (finished.outcome.status, finished.is_put);
            if is_put && status != Status::Interrupted {
                saturated::warn(&finished);
            }
            let finished = Said(finished);
            finished.warn();
            finished.complain();
            if goes_on && status == Status::Interrupted {
                terminal::print_error(&format!("to go on: {}\n", to_go_on(&out)));
            }
            if !quiet {
                terminal::print(&finished.summary(begun.elapsed()));
            }
            if let Some(disk) = view.filter(|_| is_put) {
                match view::after_run(&out, disk) {
                    Ok(page) if !quiet => terminal::print(&format!("view     {}\n", page.display())),
                    Ok(_) => {}
                    Err(ending) => return ending,
                }
            }
            match status {
                Status::Done => then(&finished.0),
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
        FolderError::File(_) if out.exists() && !out.is_dir() => {
            let help = "name a folder with --out: the files of a run are written into it";
            let what = if out.is_file() { "a file" } else { "no folder" };
            (format!("the results cannot be written to {folder}: it is {what}"), Some(help.to_owned()), Ending::Failed)
        }
        FolderError::File(_) if goes_on.is_some() && !out.is_dir() => {
            return no_results(out, FolderError::Removed(out.to_owned()), goes_on);
        }
        FolderError::Removed(_) => {
            let help = "its rows went with it; run it again, into a folder that stays";
            (error.to_string(), Some(help.to_owned()), Ending::Failed)
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
fn execute(jobs: usize, quiet: bool, mut prepared: Prepared) -> Result<Finished, Stopped> {
    let done = Progress::default();
    let (wanted, end) = (prepared.rows_wanted(), prepared.planned.plan.settings.end);
    let outcome = progress::show_while(wanted, end, &done, quiet, || prepared.sweep(jobs, signals::stop(), &done))?;
    Ok(prepared.finish(outcome, &done, &mut diagnostic::warn)?)
}
