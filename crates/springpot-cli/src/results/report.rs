//! `springpot report`: what a run was and what came of it, or how two runs differ, as a page.

use crate::arguments::ReportOptions;
use crate::results::{self, refused, write_page};
use crate::{Ending, printed, terminal};
use springpot_report::page::Report;
use springpot_run::table::disk::Disk;
use springpot_run::{COMPARISON_PAGE, REPORT_PAGE};

pub(crate) fn report(options: &ReportOptions, disk: &Disk) -> Ending {
    let name = if options.other.is_some() { COMPARISON_PAGE } else { REPORT_PAGE };
    let out = options.out.clone().unwrap_or_else(|| options.results.join(name));
    let written = page(options, disk).and_then(|report| write_page(&out, &report.html()));
    written.err().unwrap_or_else(|| printed(terminal::try_print(&format!("{}\n", out.display()))))
}

fn page(options: &ReportOptions, disk: &Disk) -> Result<Report, Ending> {
    let results = results::open(&options.results, &[], disk)?;
    let report = match &options.other {
        None => springpot_run::report(&results),
        Some(other) => springpot_run::comparison(&results, &results::open(other, &[], disk)?),
    };
    report.map_err(|error| refused(&error))
}
