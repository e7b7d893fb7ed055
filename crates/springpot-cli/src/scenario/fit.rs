//! `springpot fit`, and what `springpot check` says of measurements.

use crate::arguments::FitOptions;
use crate::{Ending, diagnostic, output, printed, signals, terminal};
use springpot::law::Catalog;
use springpot_run::fit::{FitError, Outcome, Status, fit, json, look, save, told};
use springpot_run::numbers::{count, rough, short};
use springpot_scenario::{DataKind, Fitting, Refusals, Scenario};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

pub(crate) fn fit_command(options: &FitOptions, catalog: &Catalog) -> Ending {
    match read(options, catalog) {
        Ok(fitting) => carry_out(options, fitting),
        Err(refused) => {
            diagnostic::refused(&refused);
            Ending::Refused
        }
    }
}

fn read(options: &FitOptions, catalog: &Catalog) -> Result<Fitting, Refusals> {
    let mut scenario = diagnostic::scenario(&options.file, &options.overrides)?;
    if let Some(starts) = options.starts {
        scenario.set_anew(&format!("fit.starts={starts}"))?;
    }
    if let Some(intervals) = &options.intervals {
        scenario.set_anew(&format!("fit.intervals={intervals:?}"))?;
    }
    if let Some(laws) = &options.laws {
        scenario.set_anew(&format!("fit.laws={:?}", apart(laws)))?;
    }
    scenario.fit(catalog)
}

/// Laws between commas, those inside networks not among these.
fn apart(laws: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    laws.split(|letter| {
        match letter {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        letter == ',' && depth == 0
    })
    .map(str::trim)
    .collect()
}

fn carry_out(options: &FitOptions, fitting: Fitting) -> Ending {
    fitting.remarks().iter().cloned().for_each(diagnostic::remark);
    let folder = options.out.clone().unwrap_or_else(|| default_folder(&options.file));
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let outcome = match fit(fitting, jobs, signals::stop()) {
        Ok(outcome) => outcome,
        Err(FitError::Refused(refused)) => {
            diagnostic::refused(&refused);
            return Ending::Refused;
        }
        Err(FitError::Unfit(why)) => {
            diagnostic::error(why);
            return Ending::Refused;
        }
        Err(error @ FitError::Unstartable(_)) => {
            diagnostic::error_with_help(
                error.to_string(),
                "look at `start` of the parameters, or at the scenario at its own values".to_owned(),
            );
            return failed(&folder, &error.to_string());
        }
    };
    match save(&outcome, &folder) {
        Ok(remarks) => remarks.into_iter().for_each(|remark| diagnostic::warning(remark, None)),
        Err(error) => return output::written(&folder, Err(error)),
    }
    outcome.warnings.iter().for_each(|warning| diagnostic::warning(warning.clone(), None));
    let text = match options.json {
        true => format!("{:#}\n", json(&outcome)),
        false => format!("{}\nresults  {}\n", told(&outcome), folder.display()),
    };
    let shown = printed(terminal::try_print(&text));
    if shown != Ending::Done {
        return shown;
    }
    ending(&outcome, options.strict)
}

fn ending(outcome: &Outcome, strict: bool) -> Ending {
    match outcome.status {
        Status::Interrupted => {
            terminal::print_error("interrupted: what was found is the best so far\n");
            Ending::Interrupted
        }
        Status::NotConverged => {
            diagnostic::error("the fit has not converged: what was found is the best so far".to_owned());
            Ending::Failed
        }
        Status::Converged if strict && !outcome.fit.undetermined.is_empty() => {
            diagnostic::error("not all parameters are determined, and --strict asks for that".to_owned());
            Ending::Failed
        }
        Status::Converged => Ending::Done,
    }
}

/// Where no start could be evaluated the record says so.
fn failed(folder: &Path, why: &str) -> Ending {
    let text = format!("{:#}\n", serde_json::json!({ "status": "failed", "error": why }));
    let written =
        std::fs::create_dir_all(folder).and_then(|()| output::write(&folder.join("fit.json"), text.as_bytes()));
    match output::written(folder, written) {
        Ending::Done => Ending::Failed,
        other => other,
    }
}

fn default_folder(file: &Path) -> PathBuf {
    let stem = file.file_stem().map_or_else(|| "fit".into(), |stem| stem.to_os_string());
    Path::new("results").join(stem)
}

/// Lines, as leads and words, and what deserves a warning.
pub(super) type Ahead = (Vec<(String, String)>, Vec<String>);

/// What `check` says of measurements.
///
/// # Errors
/// The refusals of a fit.
pub(super) fn ahead(scenario: &Scenario, catalog: &Catalog) -> Result<Ahead, Refusals> {
    let fitting = scenario.fit(catalog)?;
    let plan = fitting.plan();
    let (mut lines, mut warnings) = (Vec::new(), Vec::new());
    let looked = match look(&fitting) {
        Ok(looked) => looked,
        Err(why) => {
            warnings.push(why);
            return Ok((lines, warnings));
        }
    };
    for (data, (rows, [from, to])) in plan.data.iter().zip(&looked.rows) {
        let (scale, unit) = if matches!(data.kind, DataKind::Dma { .. }) { (TAU, "Hz") } else { (1.0, "s") };
        let columns: Vec<String> = data
            .columns
            .iter()
            .map(|column| {
                if column.unit.is_empty() { column.name.clone() } else { format!("{} [{}]", column.name, column.unit) }
            })
            .collect();
        let of = data.element.as_ref().map_or_else(String::new, |element| format!(" of {element}"));
        let skipped =
            if data.skipped > 0 { format!(", {} without all cells left out", data.skipped) } else { String::new() };
        let used = if data.is_fitted { "" } else { ", for validation alone" };
        let words = format!(
            "{}: {}{of}, {}{skipped}, {} {unit} to {} {unit}, {}{used}",
            data.name,
            data.kind.name(),
            count(*rows, "row", "rows"),
            short(from / scale),
            short(to / scale),
            columns.join(", ")
        );
        lines.push(("data".to_owned(), words));
    }
    for (j, own) in plan.parameters.iter().enumerate() {
        let value = own.sought.start[0];
        let unit = if own.unit.is_empty() { String::new() } else { format!(" {}", own.unit) };
        let expected = match looked.sd.get(j) {
            _ if looked.unseen.contains(&j) => ", which no data depend on".to_owned(),
            Some(sd) if sd.is_finite() => format!(", expected sd {}{unit}", rough(*sd)),
            Some(_) => ", not determined".to_owned(),
            None => String::new(),
        };
        let [low, high] = own.sought.bounds;
        lines.push((
            "fit".to_owned(),
            format!("{} from {}{unit}, in {} … {}{expected}", own.sought.name, short(value), short(low), short(high)),
        ));
    }
    if let Some(why) = &looked.failure {
        warnings.push(format!("at the start values there is no model: {why}"));
    }
    for open in &looked.undetermined {
        warnings.push(format!("at the start values the data do not determine all parameters: {open}"));
    }
    Ok((lines, warnings))
}
