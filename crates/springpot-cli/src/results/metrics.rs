//! `springpot metrics`: metrics of a finished run, from its rows.

use crate::arguments::MetricsOptions;
use crate::{Ending, diagnostic, output, printed, results, terminal};
use springpot_run::metrics::{LaterError, Recomputed, Source};
use springpot_run::table::cut_field;
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::Folder;
use springpot_scenario::{Metric, RefusalKind, Refusals};
use std::fs;
use std::path::Path;

pub(crate) fn metrics(options: &MetricsOptions, disk: &Disk) -> Ending {
    let recomputed = match recomputed(options, disk) {
        Ok(recomputed) => recomputed,
        Err(LaterError::Refused(refusals)) => {
            diagnostic::refused(&refusals);
            return Ending::Refused;
        }
        Err(error) => {
            match help(&error) {
                Some(help) => diagnostic::error_with_help(error.to_string(), help),
                None => diagnostic::error(error.to_string()),
            }
            return Ending::Refused;
        }
    };
    let Recomputed { text, is_own } = recomputed;
    if let Some(out) = &options.out {
        return output::written(out, output::write(out, text.as_bytes()));
    }
    if is_own && options.results.is_dir() {
        put_back(&options.results, disk, &text);
    }
    printed(terminal::try_print(&text))
}

fn recomputed(options: &MetricsOptions, disk: &Disk) -> Result<Recomputed, LaterError> {
    let source = Source::open(disk, &options.results)?;
    let (folder, version) = source.origin();
    results::say_version(folder, version);
    let mut asked: Vec<Metric> = Vec::with_capacity(options.metrics.len());
    for text in &options.metrics {
        let metric = Metric::parse(text, "--metric", source.columns())?;
        if asked.iter().any(|other| other.name == metric.name) {
            return Err(taken(text, &metric.name).into());
        }
        asked.push(metric);
    }
    source.metrics(&asked)
}

fn taken(text: &str, name: &str) -> Refusals {
    let help = "names are unique: write another one in front, as in 'NAME = KIND(COLUMN)'";
    let name = cut_field(name.as_bytes());
    Metric::refuse(text, "--metric", RefusalKind::BadName, &format!("the name {name} is taken")).help(help).into()
}

fn help(error: &LaterError) -> Option<String> {
    match error {
        LaterError::File { .. } => Some("name the folder of the results of a run".to_owned()),
        LaterError::NoRecord(_) | LaterError::NoneBeside(_) => {
            Some("name the folder of the results of a run, which run.json belongs to".to_owned())
        }
        LaterError::NoMetrics(_) => Some("ask for some, as in --metric 'rms(strut.force)'".to_owned()),
        LaterError::LeftOut { help, .. } => {
            Some(format!("{help}; `columns` of [output] left it out: the run's own metrics.csv has what it came to"))
        }
        LaterError::NoRow { help, .. } => Some(help.clone()),
        LaterError::Unlisted(_) => Some("the run's own metrics.csv has them".to_owned()),
        LaterError::Refused(_) => None,
    }
}

/// Writes metrics.csv among the results where it is missing, or is not what the rows say.
fn put_back(folder: &Path, disk: &Disk, text: &str) {
    let file = folder.join("metrics.csv");
    if fs::read(&file).is_ok_and(|bytes| bytes == text.as_bytes()) {
        return;
    }
    // No run must put other results there meanwhile.
    let put = Folder::open(folder, disk.clone(), "springpot metrics").map_err(|error| error.to_string());
    let put = put.and_then(|_held| output::write(&file, text.as_bytes()).map_err(|error| error.to_string()));
    if let Err(why) = put {
        diagnostic::warning(format!("{} is not written: {why}", file.display()), None);
    }
}
