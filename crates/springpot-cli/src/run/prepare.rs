//! What must be right before anything is run, whether a run begins or goes on.

use crate::arguments::RunOptions;
use crate::{diagnostic, signals, terminal};
use springpot::law::Catalog;
use springpot::simulate::System;
use springpot_run::sweep::{CheckpointError, Checkpoints, Layout, Origin, Unfinished};
use springpot_run::table::Format;
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::{Folder, FolderError, Targets};
use springpot_scenario::units::parse_quantity;
use springpot_scenario::{Cases, Plan, Refusals, Scenario};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// All that a run needs.
pub(super) struct Prepared {
    pub(super) cases: Cases,
    /// The first case.
    pub(super) plan: Plan,
    pub(super) system: System,
    pub(super) layout: Layout,
    pub(super) folder: Folder,
    pub(super) checkpoints: Option<Checkpoints>,
    /// Whether figures are drawn.
    pub(super) figures: bool,
    /// The format of the rows at the end.
    pub(super) format: Format,
}

/// Why nothing is run.
pub(super) enum Unprepared {
    /// The scenario is refused.
    Refused(Refusals),
    /// What is wrong was said.
    Shown,
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

/// Reads everything and opens the folder of the results.
pub(super) fn prepare(options: &RunOptions, disk: &Disk) -> Result<Prepared, Unprepared> {
    // Before anything takes time.
    signals::stop();
    let every = options.checkpoint_every.as_deref().map(spacing).transpose()?;
    match (&options.resume, &options.file) {
        (Some(folder), _) => go_on(options, disk, folder, every).map_err(|error| show(folder, error)),
        (None, Some(file)) => begin(options, disk, file, every),
        (None, None) => unreachable!("one of them is required"),
    }
}

/// What a scenario says, its first case, and its columns.
struct Read {
    cases: Cases,
    plan: Plan,
    system: System,
    layout: Layout,
}

fn read(scenario: &Scenario) -> Result<Read, Refusals> {
    let cases = scenario.cases(&Catalog::standard())?;
    let plan = cases.plan(0)?;
    let system = plan.system_unless(signals::stop());
    diagnostic::robot_warnings(&cases);
    let layout = Layout::new(&cases, &system)?;
    Ok(Read { cases, plan, system, layout })
}

fn begin(options: &RunOptions, disk: &Disk, file: &Path, every: Option<f64>) -> Result<Prepared, Unprepared> {
    let out = options.out.clone().unwrap_or_else(|| default_folder(file));
    let scenario = diagnostic::scenario(file, &options.overrides)?;
    let Read { cases, plan, system, layout } = read(&scenario)?;
    let format = Format::named(&options.format).unwrap_or_default();
    let (figures, no_results) = (!options.no_figures, |error| Unprepared::Folder(out.clone(), error));
    let mut folder =
        Folder::open(&out, disk.clone(), &format!("springpot run {}", file.display())).map_err(no_results)?;
    warn_of_no_lock(&folder);
    let inputs = Inputs::of(&scenario, file);
    let (names, is_input) = (figure_files(&cases, figures), |file: &Path| inputs.holds(file));
    let targets = Targets { figures: &names, checkpoints: every.is_some(), is_input: &is_input };
    folder.begin(targets).map_err(no_results)?;
    let checkpoints = every.map(|every| {
        let origin = Origin::of(file, &scenario, &options.overrides, figures, every)?;
        Checkpoints::begin(&folder, Origin { format, ..origin }, &cases, &plan, &system)
    });
    let checkpoints = checkpoints.transpose().map_err(|error| no_results(error.into()))?;
    Ok(Prepared { cases, plan, system, layout, folder, checkpoints, figures, format })
}

fn go_on(options: &RunOptions, disk: &Disk, folder: &Path, every: Option<f64>) -> Result<Prepared, CheckpointError> {
    let holder = format!("springpot run --resume {}", folder.display());
    let unfinished = Unfinished::read(folder, disk.clone(), &holder)?;
    warn_of_no_lock(unfinished.folder());
    let origin = unfinished.origin().clone();
    let changed = || CheckpointError::OtherScenario { what: origin.typed.clone() };
    let scenario = origin.scenario()?.ok_or_else(changed)?;
    let Read { cases, plan, system, layout } = read(&scenario)?;
    let figures = origin.figures && !options.no_figures;
    let inputs = Inputs::of(&scenario, &origin.file);
    let (names, is_input) = (figure_files(&cases, figures), |file: &Path| inputs.holds(file));
    let targets = Targets { figures: &names, checkpoints: true, is_input: &is_input };
    let (checkpoints, folder) = unfinished.take_up(&cases, (&plan, &system), &layout, every, targets)?;
    let (checkpoints, format) = (Some(checkpoints), origin.format);
    Ok(Prepared { cases, plan, system, layout, folder, checkpoints, figures, format })
}

/// The names of the files that the figures are drawn into.
fn figure_files(cases: &Cases, drawn: bool) -> Vec<String> {
    let names = cases.figures().iter().filter(|_| drawn).map(|figure| &figure.name);
    names.flat_map(|name| ["svg", "png"].map(|ending| format!("{name}.{ending}"))).collect()
}

/// The files that a scenario reads, itself included; found when they are first asked for.
struct Inputs<'a> {
    scenario: &'a Scenario,
    file: &'a Path,
    found: OnceCell<Vec<PathBuf>>,
}

impl<'a> Inputs<'a> {
    fn of(scenario: &'a Scenario, file: &'a Path) -> Self {
        Self { scenario, file, found: OnceCell::new() }
    }

    fn holds(&self, file: &Path) -> bool {
        let found = self.found.get_or_init(|| {
            let own = self.file.canonicalize().ok();
            self.scenario.named_files().into_iter().chain(own).collect()
        });
        file.canonicalize().is_ok_and(|file| found.contains(&file))
    }
}

fn warn_of_no_lock(folder: &Folder) {
    if !folder.is_locked() {
        let folder = folder.path().display();
        diagnostic::warning(format!("{folder} cannot be locked: no second run must write to it"), None);
    }
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

/// `results/<file stem>` in the current folder.
fn default_folder(file: &Path) -> PathBuf {
    Path::new("results").join(file.file_stem().unwrap_or("run".as_ref()))
}
