//! `springpot run`.

use crate::arguments::RunOptions;
use crate::{Ending, figures, progress, refusals};
use springpot::scenario::{Cases, Plan, Refusals};
use springpot::simulate::System;
use springpot::sweep::{self, Layout, Options, Outcome, Status, SweepError};
use springpot::table::folder::Folder;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;

/// Failed cases that are named one by one.
const NAMED: usize = 5;

pub(crate) fn run(options: &RunOptions) -> Ending {
    let begun = std::time::Instant::now();
    match execute(options) {
        Ok((outcome, folder)) => {
            report(options, &outcome, &folder, begun.elapsed().as_secs_f64());
            match outcome.status {
                Status::Done => Ending::Done,
                Status::Failed => Ending::Failed,
                Status::Interrupted => Ending::Interrupted,
            }
        }
        Err(SweepError::Refused(refused)) => {
            refusals::print(&refused);
            Ending::Refused
        }
        Err(SweepError::Output(error)) => {
            eprintln!("error: the results cannot be written: {error}");
            Ending::Failed
        }
    }
}

fn execute(options: &RunOptions) -> Result<(Outcome, PathBuf), SweepError> {
    let stop = progress::interrupt_flag();
    let cases = refusals::open(&options.scenario)?;
    let (plan, system) = first_case(&cases)?;
    let layout = Layout::new(&cases, &system)?;
    let out = options.out.clone().unwrap_or_else(|| default_folder(&options.scenario.file));
    let mut folder = Folder::prepare(&out)?;

    let rows = AtomicU64::new(0);
    let wanted = (cases.len() as u64).saturating_mul(plan.time.rows.count() as u64);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores, usize::from);
    let sweep_options = Options { jobs, stop, rows: &rows };
    let outcome =
        progress::show_while(wanted, &rows, options.quiet, || sweep::run(&cases, &layout, &mut folder, sweep_options))?;

    if !options.no_figures && outcome.status != Status::Interrupted {
        for warning in figures::draw(&cases, &system, &plan, &layout, &outcome, &mut folder)? {
            eprintln!("warning: {warning}");
        }
    }
    folder.write_run(outcome.record(&cases, &plan, &layout))?;
    Ok((outcome, folder.path().to_owned()))
}

fn first_case(cases: &Cases) -> Result<(Plan, System), Refusals> {
    let plan = cases.plan(0)?;
    let system = plan.system();
    Ok((plan, system))
}

/// `results/<file stem>` in the current folder.
fn default_folder(file: &Path) -> PathBuf {
    Path::new("results").join(file.file_stem().unwrap_or("run".as_ref()))
}

/// The lines after a run: what failed on stderr, what was done on stdout.
fn report(options: &RunOptions, outcome: &Outcome, folder: &Path, wall: f64) {
    let failed: Vec<_> = outcome.cases.iter().filter(|case| case.error.is_some() && !case.interrupted).collect();
    for case in failed.iter().take(NAMED) {
        let error = case.error.as_deref().unwrap_or_default();
        if outcome.done + outcome.failed > 1 {
            eprintln!("error: case {}: {error}", case.index);
        } else {
            eprintln!("error: {error}");
        }
    }
    if failed.len() > NAMED {
        eprintln!("error: … and {} more cases (run.json lists them)", failed.len() - NAMED);
    }
    let reached = outcome.t_reached.map_or("before the first row".into(), |t| format!("t = {t} s"));
    match outcome.status {
        Status::Done => {}
        Status::Failed => {
            eprintln!("failed: {} of {} cases; earliest end {reached}", outcome.failed, outcome.done + outcome.failed)
        }
        Status::Interrupted => {
            eprintln!(
                "interrupted: {} cases done, the others reached {reached}; all rows written are complete",
                outcome.done
            );
        }
    }
    if options.quiet {
        return;
    }
    let residual = match outcome.energy_residual {
        Some((residual, turned_over)) if turned_over > 0.0 => {
            format!("energy residual {:.1e} of {turned_over:.3} J", residual / turned_over)
        }
        Some(_) => "no energy turned over".into(),
        None => "energy ledger unknown".into(),
    };
    let cases = if outcome.cases.len() > 1 { format!("{} cases, ", outcome.done) } else { String::new() };
    println!(
        "{cases}{} steps ({} rejected), {residual}, {wall:.2} s\n{}",
        outcome.steps,
        outcome.rejected_steps,
        folder.display()
    );
}
