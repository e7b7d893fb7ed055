//! `springpot view`: the page that shows results in motion.

use crate::arguments::ViewOptions;
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot_run::table::disk::Disk;
use springpot_run::{Results, ResultsError};
use std::path::{Path, PathBuf};

/// What the page is called in the folder of its results.
const PAGE: &str = "view.html";

pub(crate) fn view(options: &ViewOptions, disk: &Disk) -> Ending {
    let out = options.out.clone().unwrap_or_else(|| options.results.join(PAGE));
    match page(&options.results, &options.cases, &out, disk) {
        Ok(()) => printed(terminal::try_print(&format!("{}\n", out.display()))),
        Err(ending) => ending,
    }
}

/// The page of a run that has just ended, in its folder.
pub(crate) fn after_run(results: &Path, disk: &Disk) -> Result<PathBuf, Ending> {
    let out = results.join(PAGE);
    page(results, &[], &out, disk).map(|()| out)
}

fn page(results: &Path, cases: &[usize], out: &Path, disk: &Disk) -> Result<(), Ending> {
    let html = Results::open(disk, results).and_then(|results| {
        let missing = cases.iter().find(|case| !results.has_rows(**case)).copied();
        missing.map_or(Ok(()), |case| Err(ResultsError::NoCase(case)))?;
        springpot_run::view(&results, cases)
    });
    match html {
        Ok(view) => match output::written(out, output::write(out, view.html().as_bytes())) {
            Ending::Done => Ok(()),
            ending => Err(ending),
        },
        Err(error) => {
            diagnostic::error_with_help(error.to_string(), help(&error));
            Err(Ending::Refused)
        }
    }
}

fn help(error: &ResultsError) -> String {
    match error {
        ResultsError::File { .. } | ResultsError::NoRecord(_) => "name the folder of the results of a run".to_owned(),
        ResultsError::NoScene(_) => "run the scenario again".to_owned(),
        ResultsError::NoCase(_) => "cases are counted from 0, as run.json lists them".to_owned(),
    }
}
