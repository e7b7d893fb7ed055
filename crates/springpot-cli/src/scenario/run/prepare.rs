//! What must be right before anything is run, whether a run begins or goes on.

use crate::arguments::{MergeOptions, RunOptions};
use crate::{diagnostic, signals, terminal};
use springpot::law::Catalog;
use springpot_run::sweep::{CheckpointError, MergeError};
use springpot_run::table::Format;
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::FolderError;
use springpot_run::{Asked, BeginError, NewRun, Prepared, Surroundings, Survey};
use springpot_scenario::units::parse_quantity;
use springpot_scenario::{Cases, Refusals};
use std::path::{Path, PathBuf};

/// Why nothing is run.
pub(super) enum Unprepared {
    /// The scenario is refused.
    Refused(Refusals),
    /// What is wrong was said.
    Shown,
    /// Interrupted by the user.
    Interrupted,
    /// No case can run to its end.
    Hopeless(Box<Cases>, Box<Survey>),
    /// The folder of the results takes none.
    Folder(PathBuf, FolderError),
    /// The results of an earlier run were put in their place, and nothing is left to do; how it ended.
    Settled(String),
}

impl From<Refusals> for Unprepared {
    fn from(refusals: Refusals) -> Self {
        Self::Refused(refusals)
    }
}

impl From<BeginError> for Unprepared {
    fn from(error: BeginError) -> Self {
        match error {
            BeginError::Refused(refusals) => Self::Refused(refusals),
            BeginError::Hopeless { cases, survey } => Self::Hopeless(cases, survey),
            BeginError::Interrupted => Self::Interrupted,
            BeginError::Folder { folder, error } => Self::Folder(folder, error),
        }
    }
}

/// Reads everything and opens the folder of the results.
pub(super) fn prepare(options: &RunOptions, catalog: &Catalog, disk: &Disk) -> Result<Prepared, Unprepared> {
    // Before anything takes time.
    let stop = signals::stop();
    let every = options.checkpoint_every.as_deref().map(spacing).transpose()?;
    let (figures, mut warn) = (!options.no_figures, diagnostic::warn);
    match (&options.resume, &options.file) {
        (Some(folder), _) => {
            let holder = format!("springpot run --resume {}", folder.display());
            let with = Surroundings { catalog, disk, stop, holder: &holder };
            Prepared::resume(folder, every, figures, with, &mut warn).map_err(|error| show(folder, error))
        }
        (None, Some(file)) => {
            let holder = format!("springpot run {}", file.display());
            let with = Surroundings { catalog, disk, stop, holder: &holder };
            let (overrides, sweeps) = (options.overrides.clone(), options.sweeps.clone());
            let sensitivity = options.sensitivity.clone();
            let asked = Asked { overrides, sweeps, sensitivity, ..Asked::read(file)? };
            let new = NewRun {
                asked,
                out: options.out.clone(),
                format: Format::named(&options.format).unwrap_or_default(),
                figures,
                checkpoint_every: every,
                shard: options.shard,
            };
            Ok(Prepared::begin(new, with, &mut warn)?)
        }
        (None, None) => unreachable!("one of them is required"),
    }
}

/// Opens the parts of a run and the folder of the whole.
pub(super) fn merge(options: &MergeOptions, catalog: &Catalog, disk: &Disk) -> Result<Prepared, Unprepared> {
    let with = Surroundings { catalog, disk, stop: signals::stop(), holder: "springpot merge" };
    let format = options.format.as_deref().and_then(Format::named);
    let (out, figures) = (options.out.clone(), !options.no_figures);
    let merged = Prepared::merge(&options.parts, out, (format, figures), with, &mut diagnostic::warn);
    merged.map_err(|error| {
        let message = error.to_string();
        let help = match error {
            MergeError::Folder { folder, error } => return Unprepared::Folder(folder, error),
            MergeError::Refused(refusals) => return Unprepared::Refused(refusals),
            MergeError::Part(CheckpointError::Folder(error)) => return Unprepared::Folder(PathBuf::new(), error),
            MergeError::Part(error) => return show(Path::new(""), error),
            MergeError::NoPart(_) => "name the folders of all parts, and nothing else".to_owned(),
            MergeError::Twice(_) => "name every part once".to_owned(),
            MergeError::Different { .. } => "name the parts of one run".to_owned(),
            MergeError::Missing { unfinished: Some(part), .. } => {
                format!("one part has not come to its end: springpot run --resume {}", part.display())
            }
            MergeError::Missing { .. } => "name the folders of all parts".to_owned(),
            MergeError::IntoPart(_) => "name another folder with --out".to_owned(),
        };
        diagnostic::error_with_help(message, help);
        Unprepared::Shown
    })
}

/// Says why a run cannot go on, and what can be done.
fn show(folder: &Path, error: CheckpointError) -> Unprepared {
    let error = match error {
        CheckpointError::Folder(error) => return Unprepared::Folder(folder.to_owned(), error),
        error => error,
    };
    let help = match &error {
        CheckpointError::Missing(_) => {
            "name the folder of the results of a run with --checkpoint-every; other runs start anew"
        }
        CheckpointError::Finished(_) => "its results are complete; to run it again, name its scenario",
        CheckpointError::Damaged(_) | CheckpointError::Rows(_) => {
            "nothing was changed; put the files back as they were, or run the scenario anew"
        }
        CheckpointError::OtherVersion { .. } => "go on with the program that wrote it, or run the scenario anew",
        CheckpointError::OtherScenario { .. } => "put it back as it was, or run the scenario anew",
        CheckpointError::Refused(refusals) => {
            diagnostic::refused(refusals);
            return Unprepared::Shown;
        }
        CheckpointError::Settled { status, .. } => {
            terminal::print_error(&format!("{error}\n"));
            return Unprepared::Settled(status.clone());
        }
        CheckpointError::Folder(_) | CheckpointError::File { .. } => "nothing was run",
    };
    diagnostic::error_with_help(error.to_string(), help.to_owned());
    Unprepared::Shown
}

/// The simulated time between two checkpoints, s.
fn spacing(text: &str) -> Result<f64, Unprepared> {
    let why = match parse_quantity(text, "s", &|_| None) {
        Ok(every) if every.is_finite() && every > 0.0 => return Ok(every),
        Ok(_) => "not a positive time".to_owned(),
        Err(error) => error.to_string(),
    };
    let help = "write a simulated time such as 10 or \"500 ms\"".to_owned();
    diagnostic::error_with_help(format!("--checkpoint-every {text}: {why}"), help);
    Err(Unprepared::Shown)
}
