//! Results of a run that has ended, as commands open them, and the pages that are made of them.

use crate::{Ending, diagnostic, output};
use springpot_run::table::disk::Disk;
use springpot_run::{Results, ResultsError, of_other_version};
use std::path::Path;

/// The results in a folder; the cases that are asked for have rows.
pub(crate) fn open(folder: &Path, cases: &[usize], disk: &Disk) -> Result<Results, Ending> {
    let results = Results::open(disk, folder).and_then(|results| {
        let missing = cases.iter().find(|case| !results.has_rows(**case)).copied();
        missing.map_or(Ok(results), |case| Err(ResultsError::NoCase(case)))
    });
    let results = results.map_err(|error| refused(&error))?;
    say_version(folder, results.version());
    Ok(results)
}

/// Says where results are of another version of Springpot: names and meanings may have changed since.
pub(crate) fn say_version(folder: &Path, version: &str) {
    if let Some(warning) = of_other_version(folder, version) {
        diagnostic::warning(warning.message, warning.help);
    }
}

/// Writes a page, whole or not at all.
pub(crate) fn write_page(out: &Path, html: &str) -> Result<(), Ending> {
    match output::written(out, output::write(out, html.as_bytes())) {
        Ending::Done => Ok(()),
        ending => Err(ending),
    }
}

/// Says why results cannot be read, and what to do.
pub(crate) fn refused(error: &ResultsError) -> Ending {
    diagnostic::error_with_help(error.to_string(), help(error));
    Ending::Refused
}

fn help(error: &ResultsError) -> String {
    match error {
        ResultsError::File { .. } | ResultsError::NoRecord(_) => "name the folder of the results of a run".to_owned(),
        ResultsError::Damaged { .. } => {
            "what a run wrote was changed or damaged since: take it from a copy, or run the scenario again".to_owned()
        }
        ResultsError::NoScene(_) => "run the scenario again".to_owned(),
        ResultsError::Part(_) => "write springpot merge DIR DIR ... --out DIR".to_owned(),
        ResultsError::NoCase(_) => "cases are counted from 0, as run.json lists them".to_owned(),
        ResultsError::NoRow(_) => "run.json says why each case ended".to_owned(),
        ResultsError::NoColumn { column, .. } => {
            format!("run the scenario again with {column} among the columns of [output]")
        }
    }
}
