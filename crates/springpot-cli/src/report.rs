//! `springpot report`: what a run was and what came of it, or how two runs differ, as a page.

use crate::arguments::ReportOptions;
use crate::pages::{refused, written};
use crate::{Ending, printed, terminal};
use springpot_report::page::Report;
use springpot_run::table::disk::Disk;
use springpot_run::{COMPARISON_PAGE, REPORT_PAGE, Results, ResultsError};

pub(crate) fn report(options: &ReportOptions, disk: &Disk) -> Ending {
    let name = if options.other.is_some() { COMPARISON_PAGE } else { REPORT_PAGE };
    let out = options.out.clone().unwrap_or_else(|| options.results.join(name));
    let ending = match page(options, disk) {
        Ok(report) => written(&out, &report.html()).err(),
        Err(error) => Some(refused(&error)),
    };
    ending.unwrap_or_else(|| printed(terminal::try_print(&format!("{}\n", out.display()))))
}

fn page(options: &ReportOptions, disk: &Disk) -> Result<Report, ResultsError> {
    let results = Results::open(disk, &options.results)?;
    match &options.other {
        None => springpot_run::report(&results),
        Some(other) => springpot_run::comparison(&results, &Results::open(disk, other)?),
    }
}
