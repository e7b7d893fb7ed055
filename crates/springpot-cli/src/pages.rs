//! What commands have in common that make pages of results.

use crate::{Ending, diagnostic, output};
use springpot_run::ResultsError;
use std::path::Path;

/// Writes a page, whole or not at all.
pub(crate) fn written(out: &Path, html: &str) -> Result<(), Ending> {
    match output::written(out, output::write(out, html.as_bytes())) {
        Ending::Done => Ok(()),
        ending => Err(ending),
    }
}

/// Says why there are no results to make a page of.
pub(crate) fn refused(error: &ResultsError) -> Ending {
    diagnostic::error_with_help(error.to_string(), help(error).to_owned());
    Ending::Refused
}

fn help(error: &ResultsError) -> &'static str {
    match error {
        ResultsError::File { .. } | ResultsError::NoRecord(_) => "name the folder of the results of a run",
        ResultsError::NoScene(_) => "run the scenario again",
        ResultsError::NoCase(_) => "cases are counted from 0, as run.json lists them",
    }
}
