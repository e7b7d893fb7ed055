//! `springpot export`: files of a run for other programs.

use crate::arguments::ExportOptions;
use crate::output::{self, Output};
use crate::{Ending, diagnostic, printed, results, terminal};
use springpot_run::table::disk::Disk;
use springpot_run::{ExportError, ExportFormat, Results, ResultsError};

pub(crate) fn export(options: &ExportOptions, disk: &Disk) -> Ending {
    let file = &options.file;
    let Some(format) = ExportFormat::of(file) else {
        let endings = ExportFormat::ENDINGS.map(|ending| format!(".{ending}"));
        diagnostic::error_with_help(
            format!("the ending of {} names no format", file.display()),
            format!("there are {}", endings.join(", ")),
        );
        return Ending::Refused;
    };
    let results = match results::open(&options.results, options.case.as_slice(), disk) {
        Ok(results) => results,
        Err(ending) => return ending,
    };
    let case = match chosen(&results, options) {
        Ok(case) => case,
        Err(ending) => return ending,
    };
    let mut out = match Output::open(file) {
        Ok(out) => out,
        Err(error) => return output::written(file, Err(error)),
    };
    let notes = match springpot_run::export(&results, case, format, &mut out) {
        Ok(notes) => notes,
        Err(ExportError::Results(error)) => return results::refused(&error),
        Err(ExportError::Write(error)) => return output::written(file, Err(error)),
    };
    notes.into_iter().for_each(diagnostic::note);
    let is_stream = out.is_stream();
    match output::written(file, out.finish()) {
        // Whoever reads a stream does not want a name in it.
        Ending::Done if is_stream => Ending::Done,
        Ending::Done => printed(terminal::try_print(&format!("{}\n", file.display()))),
        ending => ending,
    }
}

/// The case that was asked for, or the first with rows.
fn chosen(results: &Results, options: &ExportOptions) -> Result<usize, Ending> {
    match (options.case, &results.cases_with_rows()[..]) {
        (Some(case), _) => Ok(case),
        (None, []) => Err(results::refused(&ResultsError::NoRow(results.folder().to_owned()))),
        (None, [case]) => Ok(*case),
        (None, [first, rest @ ..]) => {
            let count = rest.len() + 1;
            diagnostic::note(format!("case {first} of {count} is written; --case K names another"));
            Ok(*first)
        }
    }
}
