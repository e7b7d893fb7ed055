//! `springpot sensitivity`: a run with its derivatives, and what of it matters.

mod compare;
mod told;

use self::compare::{Compared, compare};
use self::told::Told;
use crate::arguments::SensitivityOptions;
use crate::scenario::run::run_new;
use crate::{Ending, diagnostic, printed, signals, terminal};
use springpot::law::Catalog;
use springpot::system::{RunError, Stop};
use springpot_run::table::disk::Disk;
use springpot_run::trial::{Varied, rows};
use springpot_run::{Asked, Finished, NewRun, Planned};
use springpot_scenario::{Plan, RefusalKind, Refusals};

/// Why there is nothing to tell.
enum Untold {
    Refused(Refusals),
    Failed(String),
    Interrupted,
}

impl From<Refusals> for Untold {
    fn from(refusals: Refusals) -> Self {
        Self::Refused(refusals)
    }
}

impl From<RunError> for Untold {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Interrupted { .. } => Self::Interrupted,
            error => Self::Failed(error.to_string()),
        }
    }
}

pub(crate) fn sensitivity(options: &SensitivityOptions, catalog: &Catalog, disk: &Disk) -> Ending {
    let asked = match asked(options, catalog) {
        Ok(asked) => asked,
        Err(refused) => {
            diagnostic::refused(&refused);
            return Ending::Refused;
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores, usize::from);
    let new = NewRun { out: options.out.clone(), figures: !options.no_figures, ..NewRun::of(asked.clone()) };
    let then = |finished: &Finished| match tell(options, catalog, &asked, finished) {
        Ok(ending) => ending,
        Err(Untold::Refused(refused)) => {
            diagnostic::refused(&refused);
            Ending::Refused
        }
        Err(Untold::Failed(why)) => {
            diagnostic::error(why);
            Ending::Failed
        }
        Err(Untold::Interrupted) => Ending::Interrupted,
    };
    run_new(new, (jobs, options.json), (catalog, disk), then)
}

/// How derivatives are found.
const METHOD: &str = "sensitivity.method";

/// The scenario with its derivatives.
fn asked(options: &SensitivityOptions, catalog: &Catalog) -> Result<Asked, Refusals> {
    let mut asked = Asked { sweeps: options.sweeps.clone(), ..Asked::read(&options.file)? };
    asked.overrides.clone_from(&options.overrides);
    let is_set =
        |path: &str| options.overrides.iter().any(|own| own.split('=').next().is_some_and(|own| own.trim() == path));
    if !is_set(METHOD)
        && let Ok(planned) = Planned::of(&asked.scenario()?, catalog, &Stop::new(true), &mut |_| {})
        && planned.plan.sensitivity.is_some_and(|sensitivity| sensitivity.adjoint.is_some())
    {
        let message =
            "going back, as the file's method = \"adjoint\" says, has no columns to rank: this run goes forward";
        diagnostic::warning(message, Some("`springpot run` goes back".to_owned()));
    }
    let mut set = |key: &str, value: String| {
        let path = format!("sensitivity.{key}");
        if !is_set(&path) {
            asked.overrides.push(format!("{path}={value}"));
        }
    };
    // The table that `run` needs to differentiate at all.
    set("method", "\"forward\"".to_owned());
    if !options.of.is_empty() {
        set("of", format!("{:?}", options.of));
    }
    if !options.by.is_empty() {
        set("by", "[]".to_owned());
        asked.sensitivity.clone_from(&options.by);
    }
    let is_whole = |asked: &Asked| -> Result<bool, Refusals> {
        // Of gripper paths no more than their beginning is followed.
        let stop = Stop::new(true);
        Ok(Planned::of(&asked.scenario()?, catalog, &stop, &mut |_| {}).is_ok())
    };
    if options.check
        && let Ok(planned) = Planned::of(&asked.scenario()?, catalog, &Stop::new(true), &mut |_| {})
        && let Some(sensitivity) = planned.plan.sensitivity.filter(|sensitivity| sensitivity.adjoint.is_some())
    {
        let message = "--check compares columns of derivatives, which the adjoint does not have";
        let refusal = sensitivity.parameters[0].place.refuse(RefusalKind::Rule, message);
        return Err(refusal.help("take method = \"forward\"").into());
    }
    // Figures of the file may draw derivatives that are not asked for here.
    if (!options.by.is_empty() || !options.of.is_empty()) && !is_whole(&asked)? {
        let mut without = asked.clone();
        without.overrides.push("figure=".to_owned());
        if is_whole(&without)? {
            diagnostic::warning("no figures are drawn: those of the file do not go with --by and --of", None);
            return Ok(without);
        }
    }
    Ok(asked)
}

/// Prints what matters, and what `--check` finds.
fn tell(options: &SensitivityOptions, catalog: &Catalog, asked: &Asked, finished: &Finished) -> Result<Ending, Untold> {
    let stop = signals::stop();
    let scenario = asked.scenario()?;
    let plan = finished.cases.plan(0)?;
    let Some(sensitivity) = plan.sensitivity.clone() else { return Ok(Ending::Done) };
    let plain = Plan { sensitivity: None, ..plan.clone() };
    let (_, plain_steps) = rows(&plain, stop)?;
    let compared = match options.check {
        false => Vec::new(),
        true => {
            let varied = Varied { scenario: &scenario, catalog, parameters: &sensitivity.parameters };
            compare(&varied, &plan, stop)?
        }
    };
    let told = Told { finished, plan: &plan, sensitivity: &sensitivity, plain_steps, compared: &compared };
    let ending = match options.json {
        true => printed(terminal::try_print(&told.json())),
        false => printed(terminal::try_print(&told.text(terminal::stdout_width()))),
    };
    Ok(if compared.iter().all(Compared::is_close) { ending } else { Ending::Failed })
}
