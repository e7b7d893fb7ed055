//! Links and images of the book and of the README lead somewhere, and every page can be reached.

use crate::page::{Link, Page, ROOT, summary};
use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Pages that are not part of the book, but lead to it.
const BESIDE: [&str; 2] = ["README.md", "scenarios/README.md"];

/// Pages below docs/ that are not part of the book.
const OUTSIDE: [&str; 1] = ["docs/SUMMARY.md"];

/// Every page below docs/, by its path from the root.
fn pages() -> Vec<String> {
    fn below(folder: &str, found: &mut Vec<String>) {
        for entry in fs::read_dir(format!("{ROOT}/{folder}")).unwrap().map(Result::unwrap) {
            let name = format!("{folder}/{}", entry.file_name().to_str().unwrap());
            // What mdBook has built is no source.
            if entry.path().is_dir() && name != "docs/book" {
                below(&name, found);
            } else if name.ends_with(".md") {
                found.push(name);
            }
        }
    }
    let mut found = Vec::new();
    below("docs", &mut found);
    found.sort();
    found
}

/// A path without `.` and `..`; `None` if it leads out of the repository.
fn plain(path: &Path) -> Option<PathBuf> {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if !plain.pop() => return None,
            Component::ParentDir => {}
            component => plain.push(component),
        }
    }
    Some(plain)
}

/// Why a link of a page leads nowhere.
fn broken(page: &str, link: &Link, anchors: &HashMap<String, Vec<String>>) -> Option<String> {
    let target = link.target.as_str();
    if ["https://", "http://", "mailto:"].iter().any(|scheme| target.starts_with(scheme)) {
        return None;
    }
    let say = |words: &str| Some(format!("{page}:{}: {target} {words}", link.line));
    let (path, anchor) = target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor)));
    let there = if path.is_empty() { PathBuf::from(page) } else { Path::new(page).with_file_name("").join(path) };
    let Some(there) = plain(&there) else { return say("leads out of the repository") };
    if !Path::new(ROOT).join(&there).exists() {
        return say("does not exist");
    }
    if page.starts_with("docs/") && !there.starts_with("docs") {
        return say("is not in the book");
    }
    let name = there.components().map(|part| part.as_os_str().to_str().unwrap()).collect::<Vec<_>>().join("/");
    match (anchor, anchors.get(&name)) {
        (Some(anchor), Some(anchors)) if !anchors.iter().any(|known| known == anchor) => say("names no heading"),
        (Some(_), None) => say("names a heading of what is no page"),
        _ => None,
    }
}

#[test]
fn links_lead_somewhere() {
    let pages: Vec<Page> = pages().iter().map(String::as_str).chain(BESIDE).map(Page::open).collect();
    let anchors = pages.iter().map(|page| (page.name.clone(), page.anchors())).collect();
    let links = pages.iter().flat_map(|page| page.links.iter().map(move |link| (page, link)));
    let broken: Vec<String> = links.clone().filter_map(|(page, link)| broken(&page.name, link, &anchors)).collect();
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
    assert!(links.count() > 700);
}

/// Headings of docs/SCENARIO.md to which other pages of the world lead.
#[test]
fn the_headings_of_scenario_files_stay() {
    let anchors = Page::open("docs/SCENARIO.md").anchors();
    for heading in [
        "values",
        "constants",
        "robot",
        "bodies",
        "urdf-files",
        "element",
        "past",
        "heat",
        "schemes",
        "motion",
        "feedback",
        "controllers",
        "event",
        "metric",
        "time",
        "solver",
        "sweep",
        "figure",
        "output",
        "what-is-not-there-yet",
        "in-an-editor",
        "the-command-line",
        "going-on-with-a-run",
        "results",
    ] {
        assert!(anchors.iter().any(|anchor| anchor == heading), "{heading}");
    }
}

#[test]
fn every_page_is_in_the_summary_once() {
    let mut listed: Vec<String> = summary().into_iter().map(|path| format!("docs/{path}")).collect();
    listed.extend(OUTSIDE.map(str::to_owned));
    listed.sort();
    assert_eq!(listed, pages());
}

#[test]
fn every_picture_is_shown_somewhere() {
    let pages: Vec<Page> = pages().iter().map(String::as_str).chain(BESIDE).map(Page::open).collect();
    let shown = |picture: &str| {
        pages.iter().flat_map(|page| &page.links).any(|link| link.target.rsplit('/').next() == Some(picture))
    };
    for folder in ["docs/images", "docs/laws/figures", "scenarios/pictures"] {
        for entry in fs::read_dir(format!("{ROOT}/{folder}")).unwrap().map(Result::unwrap) {
            let name = entry.file_name();
            let picture = name.to_str().unwrap();
            assert!(shown(picture), "{folder}/{picture} is shown nowhere");
        }
    }
}

#[test]
fn broken_links_are_found() {
    let anchors: HashMap<String, Vec<String>> =
        [("docs/SUMMARY.md".to_owned(), vec!["summary".to_owned()]), ("README.md".to_owned(), vec![])].into();
    let said = |page: &str, target: &str| {
        broken(page, &Link { line: 1, target: target.to_owned() }, &anchors).unwrap_or_default()
    };
    for right in
        ["SUMMARY.md", "SUMMARY.md#summary", "laws/../SUMMARY.md#summary", "https://x.org/#y", "images/order.png"]
    {
        assert_eq!(said("docs/a.md", right), "");
    }
    for (wrong, words) in [
        ("SUMMARY.md#sumary", "names no heading"),
        ("SUMARY.md", "does not exist"),
        ("../README.md", "is not in the book"),
        ("../../x.md", "leads out"),
        ("images/order.png#x", "no page"),
    ] {
        assert!(said("docs/a.md", wrong).contains(words), "{wrong}");
    }
    assert_eq!(said("README.md", "docs/SUMMARY.md#summary"), "");
}

/// A package index shows it beside no repository.
#[test]
fn the_readme_of_the_package_reads_anywhere() {
    let page = Page::open("crates/springpot-py/README.md");
    let near: Vec<&str> =
        page.links.iter().map(|link| &*link.target).filter(|target| !target.starts_with("https://")).collect();
    assert!(near.is_empty(), "{near:?}");
    // The wheel carries the licences of what is in it.
    for (own, of) in [
        ("LICENSE-MIT", "LICENSE-MIT"),
        ("LICENSE-APACHE", "LICENSE-APACHE"),
        ("LICENSE-DejaVu.txt", "crates/springpot-report/fonts/LICENSE-DejaVu.txt"),
        ("LICENSE-three.txt", "crates/springpot-report/assets/THREE-LICENSE.txt"),
    ] {
        let read = |file: String| fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert_eq!(read(format!("{ROOT}/crates/springpot-py/licenses/{own}")), read(format!("{ROOT}/{of}")), "{own}");
    }
}
