//! `springpot view`: the page that shows results in motion.

mod http;
mod serve;

use crate::arguments::ViewOptions;
use crate::results::{self, refused, write_page};
use crate::{Ending, printed, terminal};
use springpot_report::page::View;
use springpot_run::VIEW_PAGE;
use springpot_run::table::disk::Disk;
use std::path::{Path, PathBuf};

pub(crate) fn view(options: &ViewOptions, disk: &Disk) -> Ending {
    if options.serve {
        return serve::serve(options, disk);
    }
    let out = options.out.clone().unwrap_or_else(|| options.results.join(VIEW_PAGE));
    match page(&options.results, &options.cases, &out, disk) {
        Ok(()) => printed(terminal::try_print(&format!("{}\n", out.display()))),
        Err(ending) => ending,
    }
}

/// The page of a run that has just ended, in its folder.
pub(crate) fn after_run(results: &Path, disk: &Disk) -> Result<PathBuf, Ending> {
    let out = results.join(VIEW_PAGE);
    page(results, &[], &out, disk).map(|()| out)
}

fn page(results: &Path, cases: &[usize], out: &Path, disk: &Disk) -> Result<(), Ending> {
    write_page(out, &of_results(results, cases, disk)?.html())
}

fn of_results(folder: &Path, cases: &[usize], disk: &Disk) -> Result<View, Ending> {
    let results = results::open(folder, cases, disk)?;
    springpot_run::view(&results, cases).map_err(|error| refused(&error))
}
