//! Files that are no scenarios: what they are, and what to type for them.

use crate::text::names;
use springpot::names::nearest;
use std::path::Path;

/// So much of a text tells what it is.
const BEGINNING: usize = 4096;

/// So many of the scenarios in a folder are named.
const MOST_NAMED: usize = 8;

/// What a `text` is that is no scenario, and what to do with it; `None` where it does not look like anything else.
pub(crate) fn instead(path: &Path, text: &str) -> Option<(&'static str, String)> {
    let name = path.display();
    let beginning: String = text.trim_start().chars().take(BEGINNING).collect();
    if beginning.starts_with('<') {
        return Some(match beginning.contains("<robot") {
            true => (
                "a robot in URDF, not a scenario",
                format!("`springpot init {name}` writes a scenario with it, `springpot info {name}` describes it"),
            ),
            false => ("XML, not a scenario", "a scenario is a TOML file; `springpot init` writes one".to_owned()),
        });
    }
    if beginning.starts_with('{') {
        let help = "a scenario is a TOML file; `springpot init` writes one".to_owned();
        return Some(("JSON, not a scenario", help));
    }
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")).then(|| {
        let draws = "`springpot plot FOLDER COLUMN` draws the results of a run";
        let help = format!("{draws}, `springpot derivative {name} --column NAME --order 0.5` differentiates a column");
        ("a table, not a scenario", help)
    })
}

/// Which file or files were meant by the path of none.
pub(crate) fn meant(path: &Path) -> Option<String> {
    let with_ending = path.with_extension("toml");
    if path.extension().is_none() && with_ending.is_file() {
        return Some(format!("did you mean {}?", with_ending.display()));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.exists()) {
        return Some(format!("there is no folder {}", folder.display()));
    }
    let scenarios = scenarios(folder.unwrap_or(Path::new(".")));
    let within = |name: &str| folder.map_or(Path::new(name).to_owned(), |folder| folder.join(name));
    if let Some(right) = nearest(path.file_name()?.to_str()?, scenarios.iter().map(String::as_str)) {
        return Some(format!("did you mean {}?", within(right).display()));
    }
    let here = folder.map_or_else(|| "the current folder".to_owned(), |folder| folder.display().to_string());
    let first = scenarios.iter().take(MOST_NAMED).map(String::as_str);
    Some(match scenarios.len() {
        0 => format!("{here} holds no .toml file; `springpot init` writes a scenario to start from"),
        1..=MOST_NAMED => format!("{here} holds {}", names::list(first)),
        more => format!("{here} holds {} and {} more", first.collect::<Vec<_>>().join(", "), more - MOST_NAMED),
    })
}

/// What a folder is that stands where a scenario should.
pub(crate) fn folder(path: &Path) -> String {
    let name = path.display();
    if path.join("run.json").is_file() {
        let draws = format!("it holds the results of a run: `springpot plot {name} COLUMN` draws them");
        return format!("{draws}, `springpot run --resume {name}` goes on with one that was interrupted");
    }
    let scenarios = scenarios(path);
    match scenarios.is_empty() {
        true => "a scenario is read from a file, which paths in it are relative to".to_owned(),
        false => format!("it holds {}", names::list(scenarios.iter().map(String::as_str))),
    }
}

/// The names of the TOML files in a folder.
fn scenarios(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".toml")).collect();
    names.sort();
    names
}
