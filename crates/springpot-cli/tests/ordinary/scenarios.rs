//! Every scenario that is shipped or stands beside the documents, all of its cases.

use crate::ran::{ROOT, Tried, ran_plan};
use springpot::law::Catalog;
use springpot_scenario::{Cases, Scenario};
use std::path::{Path, PathBuf};

/// The scenarios below a folder.
fn below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            below(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "toml") && !path.ends_with("book.toml") {
            found.push(path);
        }
    }
}

fn all() -> Vec<(PathBuf, Cases)> {
    let mut found = Vec::new();
    for folder in ["scenarios", "docs"] {
        below(&Path::new(ROOT).join(folder), &mut found);
    }
    found.sort();
    let read = |path: PathBuf| {
        let cases = Scenario::read(&path).and_then(|scenario| scenario.cases(&Catalog::standard()));
        let cases = cases.unwrap_or_else(|refusals| panic!("{refusals}"));
        (path, cases)
    };
    found.into_iter().map(read).collect()
}

fn run(which: impl Fn(usize) -> Vec<usize>) {
    let mut tried = Tried::default();
    for (path, cases) in all() {
        for case in which(cases.len()) {
            let plan = cases.plan(case).unwrap_or_else(|refusals| panic!("{refusals}"));
            tried.one(&format!("{}, case {case}", path.display()), ran_plan(&plan));
        }
    }
    tried.end(50);
}

#[test]
fn all_scenarios_are_planned() {
    let all = all();
    assert!(all.len() >= 50, "{}", all.len());
    for (path, cases) in all {
        for case in 0..cases.len() {
            cases.plan(case).unwrap_or_else(|refusals| panic!("{}, case {case}: {refusals}", path.display()));
        }
    }
}

#[test]
#[ignore = "some minutes"]
fn all_cases_of_all_scenarios_run() {
    run(|count| (0..count).collect());
}
