//! What must be right before anything is run, whether a run begins or goes on.

use crate::asked::Asked;
use crate::figures;
use crate::planned::Planned;
use crate::scene::Drawn;
use crate::survey::{Depth, Survey};
use crate::sweep::{CheckpointError, Checkpoints, MergeError, Origin, Shard, Shards, Source, Unfinished};
use crate::table::Format;
use crate::table::disk::Disk;
use crate::table::folder::{Folder, FolderError, Targets};
use crate::warning::Warn;
use springpot::law::Catalog;
use springpot::system::Stop;
use springpot_scenario::{Cases, FigurePlan, Refusals, Scenario};
use std::cell::OnceCell;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// What is asked of a new run.
#[derive(Debug, Clone)]
pub struct NewRun {
    /// The scenario, and what is set and swept.
    pub asked: Asked,
    /// The folder of the results; `None`: `results/<file stem>` in the current folder, with the shard behind it.
    pub out: Option<PathBuf>,
    /// The format of the rows at the end.
    pub format: Format,
    /// Whether figures are drawn.
    pub figures: bool,
    /// Simulated time from one checkpoint to the next, s; `None`: there are none.
    pub checkpoint_every: Option<f64>,
    /// The part of the cases that is run; `None`: all. A part draws no figures, and keeps its checkpoint for [`Prepared::merge`].
    pub shard: Option<Shard>,
}

impl NewRun {
    /// A run with nothing special.
    pub fn of(asked: Asked) -> Self {
        let format = Format::default();
        Self { asked, out: None, format, figures: true, checkpoint_every: None, shard: None }
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
pub struct Prepared {
    /// What was asked for.
    pub asked: Asked,
    /// What is run.
    pub planned: Planned,
    /// The folder of the results.
    pub folder: Folder,
    /// What it takes to go on later, where that is kept.
    pub checkpoints: Option<Checkpoints>,
    /// Has cases that came to their end elsewhere.
    pub source: Option<Box<dyn Source>>,
    /// The part of the cases that is run; `None`: all.
    pub shard: Option<Shard>,
    /// Whether figures are drawn.
    pub figures: bool,
    /// The format of the rows at the end.
    pub format: Format,
    /// What was seen before the run; `None` where one goes on.
    pub survey: Option<Survey>,
    /// What is drawn of it, from its beginning on.
    pub(crate) drawn: Option<Drawn>,
    /// What tells it from other runs in its folder.
    pub(crate) id: String,
}

impl fmt::Debug for Prepared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { planned, folder, shard, .. } = self;
        f.debug_struct("Prepared").field("planned", planned).field("folder", folder).field("shard", shard).finish()
    }
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
    /// Interrupted while the scenario was looked through.
    #[error("interrupted before anything was run")]
    Interrupted,
    /// The folder of the results takes none.
    #[error("{}: {error}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        error: FolderError,
    },
}

impl Prepared {
    /// Reads everything, and opens the folder of the results for a new run.
    ///
    /// # Errors
    /// The scenario is refused, or the folder takes no results of it.
    pub fn begin(new: NewRun, with: Surroundings<'_>, warn: Warn<'_>) -> Result<Self, BeginError> {
        let NewRun { asked, out, format, figures, checkpoint_every: every, shard } = new;
        let out = out.unwrap_or_else(|| default_folder(&asked, shard));
        let scenario = asked.scenario()?;
        let planned = Planned::of(&scenario, with.catalog, with.stop, warn)?;
        let Planned { cases, plan, system, .. } = &planned;
        let survey = Survey::of(cases, plan, system, Depth::Starts, with.stop)?;
        if survey.interrupted {
            return Err(BeginError::Interrupted);
        }
        if survey.is_hopeless(cases) {
            return Err(BeginError::Hopeless { cases: planned.cases.into(), survey: survey.into() });
        }
        let figures = figures && shard.is_none();
        // The journal of a part is what it is merged from.
        let every = every.or(shard.map(|_| f64::INFINITY));
        let no_results = |error| BeginError::Folder { folder: out.clone(), error };
        let folder = open(&out, (&scenario, &asked), (cases, figures, every.is_some()), with, warn);
        let folder = folder.map_err(no_results)?;
        let checkpoints = every.map(|every| {
            let origin = Origin { asked: asked.clone(), figures, every, format, shard };
            Checkpoints::begin(&folder, origin, cases, plan, system)
        });
        let checkpoints = checkpoints.transpose().map_err(|error| no_results(error.into()))?;
        let survey = Some(survey);
        Ok(Self {
            asked,
            planned,
            folder,
            checkpoints,
            source: None,
            shard,
            figures,
            format,
            survey,
            drawn: None,
            id: id(),
        })
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
        let Origin { asked, figures: drawn, format, shard, .. } = unfinished.origin().clone();
        if asked.has_changed() {
            return Err(CheckpointError::OtherScenario { what: asked.name });
        }
        let scenario = asked.scenario()?;
        let planned = Planned::of(&scenario, with.catalog, with.stop, warn)?;
        let figures = drawn && figures;
        let Planned { cases, plan, system, layout } = &planned;
        let inputs = Inputs::of(&scenario, &asked);
        let (names, is_input) = (figure_files(cases, figures), |file: &Path| inputs.holds(file));
        let targets = Targets { figures: &names, checkpoints: true, is_input: &is_input };
        let (checkpoints, folder) = unfinished.take_up(cases, (plan, system), layout, every, targets)?;
        let checkpoints = Some(checkpoints);
        let (source, survey, drawn) = (None, None, None);
        Ok(Self { asked, planned, folder, checkpoints, source, shard, figures, format, survey, drawn, id: id() })
    }

    /// Puts the parts of one run together that stand in `parts`, in any order: what is then swept comes from them, and nothing is run. The
    /// results are those of the whole run on one machine; without `out` they go to `results/<file stem>`, without `format` they have that of
    /// the parts.
    ///
    /// # Errors
    /// A part is missing, not at its end, damaged, or of another run.
    pub fn merge(
        parts: &[PathBuf],
        out: Option<PathBuf>,
        (format, figures): (Option<Format>, bool),
        with: Surroundings<'_>,
        warn: Warn<'_>,
    ) -> Result<Self, MergeError> {
        let shards = Shards::read(parts, with.disk, with.holder)?;
        let origin = shards.origin().clone();
        // The files that it names may have changed; the parts know what they were computed from.
        let scenario = origin.asked.scenario()?;
        let planned = Planned::of(&scenario, with.catalog, with.stop, warn)?;
        let Planned { cases, plan, system, layout } = &planned;
        let shards = shards.of_run(cases, (plan, system), layout)?;
        let out = out.unwrap_or_else(|| default_folder(&origin.asked, None));
        if let Some(part) = shards.folders().find(|part| is_same(part, &out)) {
            return Err(MergeError::IntoPart(part.to_owned()));
        }
        let folder = open(&out, (&scenario, &origin.asked), (cases, figures, false), with, warn)
            .map_err(|error| MergeError::Folder { folder: out.clone(), error })?;
        let (source, format) = (Some(Box::new(shards) as Box<dyn Source>), format.unwrap_or(origin.format));
        let (asked, checkpoints, shard, survey, drawn) = (origin.asked, None, None, None, None);
        Ok(Self { asked, planned, folder, checkpoints, source, shard, figures, format, survey, drawn, id: id() })
    }
}

/// The process and the time.
fn id() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    format!("{}-{}", std::process::id(), since.as_nanos())
}

/// Opens the folder of the results of a new run.
fn open(
    out: &Path,
    (scenario, asked): (&Scenario, &Asked),
    (cases, figures, checkpoints): (&Cases, bool, bool),
    with: Surroundings<'_>,
    warn: Warn<'_>,
) -> Result<Folder, FolderError> {
    let mut folder = Folder::open(out, with.disk.clone(), with.holder)?;
    warn_of_no_lock(&folder, warn);
    let inputs = Inputs::of(scenario, asked);
    let (names, is_input) = (figure_files(cases, figures), |file: &Path| inputs.holds(file));
    folder.begin(Targets { figures: &names, checkpoints, is_input: &is_input })?;
    Ok(folder)
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
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
    asked: &'a Asked,
    found: OnceCell<Vec<PathBuf>>,
}

impl<'a> Inputs<'a> {
    fn of(scenario: &'a Scenario, asked: &'a Asked) -> Self {
        Self { scenario, asked, found: OnceCell::new() }
    }

    fn holds(&self, file: &Path) -> bool {
        let found = self.found.get_or_init(|| {
            let own = self.asked.file.as_ref().and_then(|file| file.canonicalize().ok());
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

/// `results/<file stem>` in the current folder, with the shard behind it.
fn default_folder(asked: &Asked, shard: Option<Shard>) -> PathBuf {
    let mut name = Path::new(&asked.name).file_stem().unwrap_or("run".as_ref()).to_owned();
    if let Some(shard) = shard {
        name.push(format!("-{}-of-{}", shard.number(), shard.count()));
    }
    Path::new("results").join(name)
}
