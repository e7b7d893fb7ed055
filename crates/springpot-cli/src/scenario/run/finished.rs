//! What is said of a run that came to an end.

use crate::grid::{Grid, Set};
use crate::scenario::failures;
use crate::scenario::swept::{NAMED_LIMITS, in_cases};
use crate::{diagnostic, plain, terminal};
use springpot_run::Finished;
use springpot_run::numbers::{brief, count, rough, short};
use springpot_run::sweep::{CaseResult, CasesPassing, ForwardWork, Status};
use std::time::Duration;

/// So many events are counted on the terminal.
const NAMED_EVENTS: usize = 12;
/// So many metrics of a single case are told on the terminal.
const NAMED_METRICS: usize = 12;
/// Of several cases so many are told, with so many metrics.
const NAMED_CASES: usize = 12;
const NAMED_COLUMNS: usize = 4;

/// What is said of it.
pub(super) struct Said(pub(super) Finished);

impl Said {
    /// Which joints pass their limits, and where.
    pub(super) fn warn(&self) {
        let Finished { cases, outcome, .. } = &self.0;
        let ran = outcome.done + outcome.failed;
        let passing = &outcome.limits;
        for CasesPassing { passed, case, cases: found } in passing.iter().take(NAMED_LIMITS) {
            diagnostic::warning(in_cases(cases, ran, *case, *found, &passed.to_string()), None);
        }
        if let Some(more @ 1..) = passing.len().checked_sub(NAMED_LIMITS) {
            let more = count(more, "more limit of a joint is", "more limits of joints are");
            diagnostic::warning(format!("{more} passed; run.json says which"), None);
        }
        self.warn_of_lost(ran);
        // Runs that choose their steps fail where they are off by more than they warn of.
        let unbalanced = || outcome.cases.iter().filter(|case| case.error.is_none() && !case.report.is_balanced());
        if let Some(case) = unbalanced().next() {
            let (residual, of) =
                (case.report.energy_residual.unwrap_or(0.0), case.report.energy_turned_over.unwrap_or(0.0));
            let (residual, of) = (rough(residual), rough(of));
            let message = format!("the energy balance is off by {residual} J of {of} J turned over");
            let message = in_cases(cases, ran, case.index, unbalanced().count(), &message);
            let has_steps_of_one_size = cases.plan(case.index).is_ok_and(|plan| plan.settings.fixed_step.is_some());
            let help = if has_steps_of_one_size { "take a shorter solver.step" } else { "take a smaller solver.rtol" };
            diagnostic::warning(message, Some(help.to_owned()));
        }
    }

    /// Where derivatives end before the run does.
    fn warn_of_lost(&self, ran: usize) {
        let Finished { cases, outcome, .. } = &self.0;
        let lost = || {
            outcome
                .cases
                .iter()
                .flat_map(|case| case.metrics.derivatives.lost.iter().map(move |lost| (case.index, lost)))
        };
        let Some(first) = lost().next() else { return };
        let Some(plan) = cases.plan(first.0).ok().and_then(|plan| plan.sensitivity) else { return };
        for (p, parameter) in plan.parameters.iter().enumerate() {
            let of = || lost().filter(|(_, lost)| lost.parameter == p);
            let Some((index, lost)) = of().next() else { continue };
            let name = plain::title(&parameter.name);
            let message = format!("derivatives by {name} end at t = {} s: {}", short(lost.t), lost.why);
            let message = in_cases(cases, ran, index, of().count(), &message);
            diagnostic::warning(
                message,
                Some("their cells are empty from there on; run.json has them under sensitivity.lost".to_owned()),
            );
        }
    }

    /// What failed, and how far an interrupted run came.
    pub(super) fn complain(&self) {
        let Finished { cases, outcome, .. } = &self.0;
        let failed: Vec<&CaseResult> = outcome.cases.iter().filter(|c| c.error.is_some() && !c.interrupted).collect();
        let failed: Vec<_> = failed.iter().filter_map(|case| Some((case.index, case.error.as_ref()?))).collect();
        failures::tell_all(&failed, outcome.done + outcome.failed, cases);
        match outcome.status {
            Status::Done => {}
            Status::Failed => self.tell_how_far("failed"),
            Status::Interrupted => self.tell_how_far("interrupted"),
        }
    }

    fn tell_how_far(&self, what: &str) {
        let line = format!("{what}{}", self.how_far());
        terminal::print_error(&terminal::hanging("", &line, terminal::stderr_width()));
    }

    /// How far a run came that did not come to its end; goes on after "failed" or "interrupted".
    fn how_far(&self) -> String {
        let Finished { cases, outcome, end, .. } = &self.0;
        let stopped = outcome.cases.iter().filter(|case| case.error.is_some());
        let reached = stopped.clone().map(|case| case.report.t_reached.unwrap_or(-1.0)).fold(f64::INFINITY, f64::min);
        let rows = match reached {
            t if t < 0.0 => "before the first row".to_owned(),
            t => format!("after the row at t = {} s", short(t)),
        };
        let all = outcome.shard.map_or(cases.len(), |shard| shard.cases(cases.len()).len());
        if all == 1 {
            return match outcome.cases.len() {
                0 => " before anything was run".to_owned(),
                _ => format!(" {rows} of {} s; all rows are complete", short(*end)),
            };
        }
        let interrupted = stopped.filter(|case| case.interrupted).count();
        let mut parts = vec![format!("{} of {} done", outcome.done, count(all, "case", "cases"))];
        if outcome.failed > 0 {
            parts.push(format!("{} failed", outcome.failed));
        }
        if interrupted > 0 {
            parts.push(format!("{interrupted} stopped"));
        }
        if outcome.failed + interrupted > 0 {
            parts.push(format!("the earliest {rows}"));
        }
        format!(": {}; all rows are complete", parts.join(", "))
    }

    /// The lines after a run: how much was done, how well the energy balance closes, where the results are.
    pub(super) fn summary(&self, wall: Duration) -> String {
        let Finished { cases, outcome, folder, rows, events: cases_events, .. } = &self.0;
        let mut work = Vec::new();
        if cases.len() > 1 {
            work.push(count(outcome.done + outcome.failed, "case", "cases"));
        }
        work.push(count(*rows, "row", "rows"));
        if outcome.forward.is_none() {
            work.push(count(outcome.steps, "step", "steps"));
        }
        let work = format!("{} in {:.2} s", work.join(", "), wall.as_secs_f64());
        let width = terminal::stdout_width();
        let mut lines = terminal::hanging("", &work, width);
        lines.push_str(&terminal::hanging("energy   ", &self.balance(), width));
        if !cases_events.is_empty() {
            lines.push_str(&terminal::hanging("events   ", &self.events(cases_events), width));
        }
        lines.push_str(&self.metrics(width));
        let endings = ["svg", "png", "pdf"];
        let drawn = |name: &String| {
            name.rsplit_once('.').filter(|(_, ending)| endings.contains(ending)).map(|(figure, _)| figure.to_owned())
        };
        let figures = folder.files().iter().filter_map(drawn).collect::<std::collections::BTreeSet<_>>().len();
        let has = |ending: &&str| folder.files().iter().any(|name| name.ends_with(&format!(".{ending}")));
        let formats: Vec<String> =
            endings.iter().filter(|ending| has(ending)).map(|ending| ending.to_uppercase()).collect();
        let rows =
            folder.files().iter().find(|name| name.starts_with("results.")).map_or("results.csv", String::as_str);
        let beside = ["events.csv", "metrics.csv", "gradient.csv", "ranking.csv"];
        let beside = beside.iter().filter(|name| folder.files().iter().any(|file| file == *name));
        let beside: String = beside.map(|name| format!("{name}, ")).collect();
        let mut files = format!("{rows}, {beside}summary.csv, run.json");
        if figures > 0 {
            let figures = count(figures, "figure", "figures").replace(' ', terminal::NO_BREAK);
            files.push_str(&format!(", {figures} ({})", formats.join(" and ")));
        }
        let path = folder.path().display();
        let results = match (self.0.is_put, folder.has_earlier()) {
            (true, _) => format!("{path}: {files}"),
            (false, true) => format!("{path}: no row was written; the earlier ones are as they were"),
            (false, false) => format!("{path}: no row was written, and nothing else"),
        };
        lines.push_str(&terminal::hanging("results  ", &results, width));
        if let Some(forward) = &outcome.forward {
            lines.push_str(&terminal::hanging("forward  ", &self.effort(forward), width));
        }
        lines
    }

    /// How often events happened, and which of them ended cases.
    fn events(&self, names: &[String]) -> String {
        let outcome = &self.0.outcome;
        let happened = outcome.events.counts.iter().copied().chain(std::iter::repeat(0));
        let each =
            names.iter().zip(happened).map(|(name, happened)| format!("{name} {}", count(happened, "time", "times")));
        let mut said = each.take(NAMED_EVENTS).collect::<Vec<_>>().join(", ");
        if let Some(more @ 1..) = names.len().checked_sub(NAMED_EVENTS) {
            said.push_str(&format!(" and {}; run.json counts all", count(more, "more event", "more events")));
        }
        let stopped = || outcome.cases.iter().filter_map(|case| Some((case, case.events.stopped_by?)));
        match (self.0.cases.len(), stopped().next()) {
            (_, None) => {}
            (1, Some((case, event))) => {
                let t = short(case.report.t_reached.unwrap_or(0.0));
                said.push_str(&format!("; {} ended the run at t = {t} s", names[event]));
            }
            _ => said.push_str(&format!("; {} ended by one", count(stopped().count(), "case was", "cases were"))),
        }
        said
    }

    /// The metrics, a line each where the run is one case, else a table of the first cases.
    fn metrics(&self, width: Option<usize>) -> String {
        let Finished { cases, outcome, metrics, .. } = &self.0;
        let names: Vec<String> = metrics.iter().map(|[name, _]| plain::title(name)).collect();
        let Some(longest) = names.iter().map(|name| name.chars().count()).max() else { return String::new() };
        let value = |value: &f64| if value.is_finite() { short(*value) } else { "none".to_owned() };
        let lead = |k: usize| if k == 0 { "metrics  " } else { "         " };
        if cases.len() > 1 {
            let first: Vec<_> = outcome.cases.iter().take(NAMED_CASES).collect();
            let units = metrics.iter().map(|[_, unit]| unit.as_str());
            let title = |(name, unit): (&String, &str)| match unit {
                "" => name.clone(),
                unit => format!("{name}, {unit}"),
            };
            let titles = names.iter().zip(units).map(title).take(NAMED_COLUMNS);
            let last = |path: &String| path.rsplit('.').next().unwrap_or(path).trim_matches('"').to_owned();
            let mut brief: Vec<String> = cases.parameters().iter().map(last).collect();
            let all = brief.len();
            brief.sort();
            brief.dedup();
            let is_told = brief.len() == all;
            let called = |path: &String| if is_told { last(path) } else { path.clone() };
            // Values that have names are told by these, under all that they move.
            let columns = (0..cases.axis_count()).flat_map(|axis| {
                let paths: Vec<String> = cases.axis_parameters(axis).map(|path| called(&path.to_owned())).collect();
                match cases.axis_names(axis) {
                    Some(_) => vec![(paths.join(", "), Set::Name)],
                    None => paths.into_iter().map(|path| (path, Set::Name)).collect(),
                }
            });
            let mut grid = Grid::new(columns.chain(titles.map(|title| (title, Set::Number))));
            for case in &first {
                // A case without rows has none.
                let values = (0..metrics.len().min(NAMED_COLUMNS))
                    .map(|k| case.metrics.values.get(k).map_or_else(String::new, value));
                let at = cases.position(case.index);
                let swept = (0..cases.axis_count()).flat_map(|axis| match cases.axis_names(axis) {
                    Some(names) => vec![names[at[axis]].clone()],
                    None => {
                        let paths = cases.axis_parameters(axis);
                        paths.map(|path| cases.axis_label_of(axis, path, at[axis])).collect()
                    }
                });
                grid.row(swept.chain(values).collect());
            }
            let mut left = Vec::new();
            if let Some(more @ 1..) = outcome.cases.len().checked_sub(first.len()) {
                left.push(count(more, "more case", "more cases"));
            }
            if let Some(more @ 1..) = metrics.len().checked_sub(NAMED_COLUMNS) {
                left.push(count(more, "more metric", "more metrics"));
            }
            let room = width.map(|width| width.saturating_sub(9));
            let told = grid.text(room);
            let mut text: String = told.lines().enumerate().map(|(k, line)| format!("{}{line}\n", lead(k))).collect();
            if !left.is_empty() {
                let said = format!("{} in metrics.csv", left.join(" and "));
                text.push_str(&terminal::hanging(lead(1), &said, width));
            }
            return text;
        }
        match outcome.cases.first().filter(|_| metrics.len() <= NAMED_METRICS) {
            Some(case) => {
                let line = |(k, ((name, [_, unit]), number)): (usize, ((&String, &[String; 2]), &f64))| {
                    let told = if number.is_finite() { format!("{} {unit}", value(number)) } else { value(number) };
                    format!("{}{name:longest$}  {}\n", lead(k), told.trim_end())
                };
                names.iter().zip(metrics).zip(&case.metrics.values).enumerate().map(line).collect()
            }
            None => terminal::hanging(lead(0), &format!("{}, in metrics.csv", metrics.len()), width),
        }
    }

    /// What robots that move by themselves took: work, wall time, how much faster than life, and how well the energy balance closes.
    fn effort(&self, forward: &ForwardWork) -> String {
        let outcome = &self.0.outcome;
        let wall = outcome.wall.as_secs_f64();
        let residual = match outcome.energy_residual {
            // Of a robot at rest hardly any energy is turned over.
            Some((residual, turned_over)) if outcome.is_rounding && residual > 1e-6 * turned_over => {
                "rounding".to_owned()
            }
            Some((residual, turned_over)) if turned_over > 0.0 => rough(residual / turned_over),
            Some(_) => "0".to_owned(),
            None => "unknown".to_owned(),
        };
        let ForwardWork { newton_iterations: iterations, evaluations, .. } = *forward;
        let mut took = Vec::new();
        if evaluations > 0 {
            took.push(count(evaluations, "evaluation", "evaluations"));
        }
        if iterations > 0 || evaluations == 0 {
            took.push(count(iterations, "Newton iteration", "Newton iterations"));
        }
        format!(
            "{}, {} rejected, {}, {} s, {} times real time, energy residual {residual}",
            count(outcome.steps, "step", "steps"),
            outcome.rejected_steps,
            took.join(", "),
            brief(wall),
            brief(if wall > 0.0 { outcome.simulated / wall } else { 0.0 }),
        )
    }

    /// How well the energy balance closes, and where it is not known.
    fn balance(&self) -> String {
        let outcome = &self.0.outcome;
        let known = match outcome.energy_residual {
            Some((_, turned_over)) if turned_over > 0.0 && outcome.is_rounding => {
                format!("balance closes to rounding, {} J turned over", rough(turned_over))
            }
            Some((residual, turned_over)) if turned_over > 0.0 => {
                format!("balance closes to {} of {} J turned over", rough(residual / turned_over), rough(turned_over))
            }
            Some(_) => "no energy was turned over".into(),
            None => String::new(),
        };
        match &outcome.no_ledger {
            None if known.is_empty() => "balance unknown: nothing was run".into(),
            None => known,
            Some((_, why)) if known.is_empty() => format!("balance unknown: {why}"),
            Some((1, why)) => format!("{known}; unknown in 1 case: {why}"),
            Some((unknown, why)) => format!("{known}; unknown in {unknown} cases: {why}"),
        }
    }
}
