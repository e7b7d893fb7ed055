//! What must be right before anything is run, whether a run begins or goes on.

use crate::figures;
use crate::survey::{Depth, Survey};
use crate::sweep::{CheckpointError, Checkpoints, Layout, Origin, Unfinished};
use crate::table::Format;
use crate::table::disk::Disk;
use crate::table::folder::{Folder, FolderError, Targets};
use crate::warning::{Warn, robot_warnings};
use springpot::integrate::{Stop, System};
use springpot::law::Catalog;
use springpot_scenario::{Cases, FigurePlan, Plan, Refusals, Scenario};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// What is asked of a new run.
#[derive(Debug, Clone)]
pub struct NewRun {
    /// The scenario's file.
    pub file: PathBuf,
    /// Values that are set, `PATH=VALUE`.
    pub overrides: Vec<String>,
    /// Parameters that are swept, `PATH=v1,v2,…` ([`Scenario::sweep`]).
    pub sweeps: Vec<String>,
    /// The folder of the results; `None`: `results/<file stem>` in the current folder.
    pub out: Option<PathBuf>,
    /// The format of the rows at the end.
    pub format: Format,
    /// Whether figures are drawn.
    pub figures: bool,
    /// Simulated time from one checkpoint to the next, s; `None`: there are none.
    pub checkpoint_every: Option<f64>,
}

impl NewRun {
    /// A run of a scenario's file with nothing changed.
    pub fn of(file: impl Into<PathBuf>) -> Self {
        let format = Format::default();
        let (overrides, sweeps) = (Vec::new(), Vec::new());
        Self { file: file.into(), overrides, sweeps, out: None, format, figures: true, checkpoint_every: None }
    }
}

/// What a run is carried out with.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// The laws.
    pub catalog: &'a Catalog,
    /// Takes the results.
    pub disk: &'a Disk,
    /// Set from outside to interrupt; a gripper path is followed no further then.
    pub stop: &'a Stop,
    /// A few words about who holds the folder of the results, for others who want it.
    pub holder: &'a str,
}

/// All that a run needs, checked.
#[derive(Debug)]
pub struct Prepared {
    /// The cases.
    pub cases: Cases,
    /// The first of them.
    pub plan: Plan,
    /// Its system.
    pub system: System,
    /// The columns.
    pub layout: Layout,
    /// The folder of the results.
    pub folder: Folder,
    /// What it takes to go on later, where that is kept.
    pub checkpoints: Option<Checkpoints>,
    /// Whether figures are drawn.
    pub figures: bool,
    /// The format of the rows at the end.
    pub format: Format,
    /// What was seen before the run; `None` where one goes on.
    pub survey: Option<Survey>,
}

/// Why a new run cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    /// The scenario is refused.
    #[error(transparent)]
    Refused(#[from] Refusals),
    /// No case can run to its end.
    #[error("none of the cases can run: {}", survey.failures.first().map_or("", |(_, why)| &why.message))]
    Hopeless {
        /// The cases.
        cases: Box<Cases>,
        /// What is wrong with them.
        survey: Box<Survey>,
    },
    /// The folder of the results takes none.
    #[error("{}: {error}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        error: FolderError,
    },
}

/// What a scenario says, its first case, and its columns.
struct Read {
    cases: Cases,
    plan: Plan,
    system: System,
    layout: Layout,
}

fn read(scenario: &Scenario, with: Surroundings<'_>, warn: Warn<'_>) -> Result<Read, Refusals> {
    let cases = scenario.cases(with.catalog)?;
    let plan = cases.plan(0)?;
    let system = plan.system_unless(with.stop);
    robot_warnings(&cases).into_iter().for_each(warn);
    let layout = Layout::new(&cases, &system)?;
    Ok(Read { cases, plan, system, layout })
}

impl Prepared {
    /// Reads everything, and opens the folder of the results for a new run.
    ///
    /// # Errors
    /// The scenario is refused, or the folder takes no results of it.
    pub fn begin(asked: NewRun, with: Surroundings<'_>, warn: Warn<'_>) -> Result<Self, BeginError> {
        let NewRun { file, overrides, sweeps, out, format, figures, checkpoint_every: every } = asked;
        let out = out.unwrap_or_else(|| default_folder(&file));
        let mut scenario = Scenario::read(&file)?;
        overrides.iter().try_for_each(|assignment| scenario.set(assignment))?;
        sweeps.iter().try_for_each(|assignment| scenario.sweep(assignment))?;
        let Read { cases, plan, system, layout } = read(&scenario, with, warn)?;
        let survey = Survey::of(&cases, &plan, &system, Depth::Starts, with.stop)?;
        if survey.is_hopeless(&cases) {
            return Err(BeginError::Hopeless { cases: cases.into(), survey: survey.into() });
        }
        let no_results = |error| BeginError::Folder { folder: out.clone(), error };
        let mut folder = Folder::open(&out, with.disk.clone(), with.holder).map_err(no_results)?;
        warn_of_no_lock(&folder, warn);
        let inputs = Inputs::of(&scenario, &file);
        let (names, is_input) = (figure_files(&cases, figures), |file: &Path| inputs.holds(file));
        let targets = Targets { figures: &names, checkpoints: every.is_some(), is_input: &is_input };
        folder.begin(targets).map_err(no_results)?;
        let checkpoints = every.map(|every| {
            let origin = Origin::of(&file, &scenario, figures, every)?;
            Checkpoints::begin(&folder, Origin { format, overrides, sweeps, ..origin }, &cases, &plan, &system)
        });
        let checkpoints = checkpoints.transpose().map_err(|error| no_results(error.into()))?;
        Ok(Self { cases, plan, system, layout, folder, checkpoints, figures, format, survey: Some(survey) })
    }

    /// Goes on with the run whose checkpoint is in `folder`. With `every`, s, checkpoints are written at other times from now on;
    /// without `figures`, none are drawn.
    ///
    /// # Errors
    /// There is nothing to go on with, or what is there is damaged, or belongs to something else: nothing was changed then.
    pub fn resume(
        folder: &Path,
        every: Option<f64>,
        figures: bool,
        with: Surroundings<'_>,
        warn: Warn<'_>,
    ) -> Result<Self, CheckpointError> {
        let unfinished = Unfinished::read(folder, with.disk.clone(), with.holder)?;
        warn_of_no_lock(unfinished.folder(), warn);
        let origin = unfinished.origin().clone();
        let changed = || CheckpointError::OtherScenario { what: origin.typed.clone() };
        let scenario = origin.scenario()?.ok_or_else(changed)?;
        let Read { cases, plan, system, layout } = read(&scenario, with, warn)?;
        let figures = origin.figures && figures;
        let inputs = Inputs::of(&scenario, &origin.file);
        let (names, is_input) = (figure_files(&cases, figures), |file: &Path| inputs.holds(file));
        let targets = Targets { figures: &names, checkpoints: true, is_input: &is_input };
        let (checkpoints, folder) = unfinished.take_up(&cases, (&plan, &system), &layout, every, targets)?;
        let (checkpoints, format) = (Some(checkpoints), origin.format);
        Ok(Self { cases, plan, system, layout, folder, checkpoints, figures, format, survey: None })
    }
}

/// The names of the files that the figures are drawn into.
fn figure_files(cases: &Cases, drawn: bool) -> Vec<String> {
    let figures = cases.figures().iter().filter(|_| drawn);
    let files = |figure: &FigurePlan| -> Vec<String> {
        figure.look.formats.iter().map(|format| figures::file_name(&figure.name, *format)).collect()
    };
    figures.flat_map(files).collect()
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

fn warn_of_no_lock(folder: &Folder, warn: Warn<'_>) {
    if !folder.is_locked() {
        warn(format!("{} cannot be locked: no second run must write to it", folder.path().display()).into());
    }
}

/// `results/<file stem>` in the current folder.
fn default_folder(file: &Path) -> PathBuf {
    Path::new("results").join(file.file_stem().unwrap_or("run".as_ref()))
}
