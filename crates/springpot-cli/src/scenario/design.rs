//! `springpot design`.

use crate::arguments::DesignOptions;
use crate::grid::{Grid, Set};
use crate::scenario::run::run_new;
use crate::{Ending, diagnostic, output, signals, terminal};
use springpot::law::Catalog;
use springpot_run::design::{Designed, design as designed};
use springpot_run::numbers::{count, rough, short};
use springpot_run::table::disk::Disk;
use springpot_run::{Asked, Finished, NewRun};
use springpot_scenario::Refusals;
use std::path::Path;

pub(crate) fn design(options: &DesignOptions, catalog: &Catalog, disk: &Disk) -> Ending {
    match searched(options, catalog) {
        Ok((asked, found)) => told(options, (catalog, disk), &asked, &found),
        Err(refused) => {
            diagnostic::refused(&refused);
            Ending::Refused
        }
    }
}

fn searched(options: &DesignOptions, catalog: &Catalog) -> Result<(Asked, Designed), Refusals> {
    let asked = Asked { overrides: options.overrides.clone(), ..Asked::read(&options.file)? };
    let scenario = asked.scenario()?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores, usize::from);
    let found = designed(&scenario, catalog, (options.starts.map(usize::from), jobs), signals::stop())?;
    Ok((asked, found))
}

/// Runs the scenario that was found, and writes and prints what there is.
fn told(options: &DesignOptions, (catalog, disk): (&Catalog, &Disk), asked: &Asked, found: &Designed) -> Ending {
    let text = if options.json { found.json() } else { page(found, terminal::stdout_width()) };
    let ending = match found.status {
        "converged" => Ending::Done,
        "interrupted" => Ending::Interrupted,
        _ => Ending::Failed,
    };
    complain(found);
    let stem = Path::new(&asked.name).file_stem().unwrap_or("run".as_ref()).to_owned();
    let out = options.out.clone().unwrap_or_else(|| Path::new("results").join(stem));
    if !found.is_admissible() || ending == Ending::Interrupted {
        // No run belongs to it.
        terminal::print(&text);
        if ending == Ending::Interrupted {
            terminal::print_error("interrupted: what was found is the best so far\n");
        }
        return match output::written(&out, put(&out, found)) {
            Ending::Done => ending,
            other => other,
        };
    }
    // What the command line set stands in the text by now.
    let best = Asked { text: found.text.clone(), overrides: Vec::new(), file: None, ..asked.clone() };
    let new = NewRun { out: Some(out.clone()), figures: !options.no_figures, ..NewRun::of(best) };
    let jobs = options.jobs.map_or(1, usize::from);
    let ran = run_new(new, (jobs, options.json), (catalog, disk), |_: &Finished| Ending::Done);
    if ran != Ending::Done {
        return ran;
    }
    match output::written(&out, put(&out, found)) {
        Ending::Done => {}
        other => return other,
    }
    terminal::print(&text);
    ending
}

/// Writes what was found; the designed scenario where there is one.
fn put(out: &Path, found: &Designed) -> std::io::Result<()> {
    std::fs::create_dir_all(out)?;
    let designed = found.is_admissible().then(|| ("designed.toml", found.text.clone()));
    let files = [("design.json", found.json()), ("steps.csv", found.steps())].into_iter().chain(designed);
    files.into_iter().try_for_each(|(name, text)| output::write(&out.join(name), text.as_bytes()))
}

/// Why it is no minimum, where it is none.
fn complain(found: &Designed) {
    let help = |words: &str| Some(words.to_owned());
    match found.status {
        "stalled" => diagnostic::warning(
            "the search ends where no step leads further down although one should: at a kink of a metric, or where its numbers are rough",
            help(
                "min, max, settling times and swings bend; rms, mean and final do not; more output rows and a smaller solver.rtol are smoother",
            ),
        ),
        "not-converged" => {
            diagnostic::warning("the search took as many runs as it may", help("begin nearer, or with other bounds"))
        }
        "infeasible" => diagnostic::error_with_help(
            "no start leads to a point at which all constraints hold",
            "widen the bounds or the limits, or take more starts".to_owned(),
        ),
        "failed" => diagnostic::error_with_help(
            "no start could be run, or a metric has no value or no gradient there",
            "run the scenario with its derivatives first: springpot sensitivity FILE".to_owned(),
        ),
        _ => {}
    }
}

/// For the terminal.
fn page(found: &Designed, width: Option<usize>) -> String {
    let (metric, unit, maximise) = &found.metric;
    let goal = if *maximise { "largest" } else { "smallest" };
    let line = format!("{metric} {} -> {} {unit}, {goal}: {}", short(found.before), short(found.after), found.status);
    let mut text = format!("\n{}", terminal::hanging("design   ", line.trim_end(), width));
    let runs = count(found.tried.len(), "run", "runs");
    let reached = found
        .starts
        .iter()
        .filter(|start| start.is_admissible && (start.objective - found.after).abs() <= 1e-6 * found.after.abs());
    let starts = format!(
        "{runs} from {}, {} of which lead there",
        count(found.starts.len(), "start", "starts"),
        reached.count()
    );
    text.push_str(&terminal::hanging("search   ", &starts, width));
    let mut grid = Grid::new([
        ("parameter", Set::Name),
        ("before", Set::Number),
        ("after", Set::Number),
        ("", Set::Text),
        ("at bound", Set::Text),
        ("gradient", Set::Number),
    ]);
    for (p, own) in found.parameters.iter().enumerate() {
        grid.row(vec![
            own.name.clone(),
            short(own.value),
            short(found.values[p]),
            own.unit.clone(),
            found.at_bound(p).unwrap_or("").to_owned(),
            rough(found.gradient[p]),
        ]);
    }
    text.push_str(&format!("\n{}", grid.text(width)));
    if !found.constraints.is_empty() {
        let mut grid = Grid::new([
            ("constraint", Set::Name),
            ("value", Set::Number),
            ("limit", Set::Number),
            ("active", Set::Text),
            ("multiplier", Set::Number),
        ]);
        for (metric, value, limit, active, multiplier) in &found.constraints {
            let active = if *active { "active" } else { "" };
            grid.row(vec![metric.clone(), short(*value), short(*limit), active.to_owned(), rough(*multiplier)]);
        }
        text.push_str(&format!("\n{}", grid.text(width)));
    }
    text
}
