//! The chapter of the laws says what `springpot laws` says, and the literature knows every source.

use crate::page::{Page, ROOT, summary};
use serde_json::Value;
use std::fs;
use std::process::Command;

fn springpot(arguments: &[&str]) -> String {
    let ended = Command::new(env!("CARGO_BIN_EXE_springpot")).args(arguments).output().unwrap();
    assert!(ended.status.success(), "{arguments:?}");
    String::from_utf8(ended.stdout).unwrap()
}

fn laws() -> Vec<Value> {
    let listed: Value = serde_json::from_str(&springpot(&["laws", "--json"])).unwrap();
    listed.as_array().unwrap().clone()
}

fn text<'v>(value: &'v Value, key: &str) -> &'v str {
    value[key].as_str().unwrap_or_else(|| panic!("{key} of {value}"))
}

/// The lines of a page between a heading that names the law and the next heading.
fn section(law: &str) -> Vec<String> {
    let mut found = Vec::new();
    for path in summary().iter().filter(|path| path.starts_with("laws/")) {
        let page = Page::open(&format!("docs/{path}"));
        let lines = fs::read_to_string(format!("{ROOT}/{}", page.name)).unwrap();
        let lines: Vec<&str> = lines.lines().collect();
        let ends = page.headings.iter().skip(1).map(|(line, _)| line - 1).chain([lines.len()]);
        for ((start, heading), end) in page.headings.iter().zip(ends) {
            if heading.replace(" and ", ", ").split(", ").any(|name| name == law) {
                found.push(lines[*start..end].iter().map(|line| (*line).to_owned()).collect());
            }
        }
    }
    assert_eq!(found.len(), 1, "sections of {law}");
    found.swap_remove(0)
}

/// What the page shows as text: force, parts and modulus.
fn shown(printed: &str) -> String {
    let lines = printed.lines().skip(1).take_while(|line| !line.starts_with("parameters"));
    lines.map(|line| line.strip_prefix("  ").unwrap_or(line)).collect::<Vec<_>>().join("\n").trim_end().to_owned()
}

/// The rows of the page's table: range and default as the command writes them, which JSON does not.
fn rows(law: &Value, printed: &str) -> Vec<String> {
    let cells = |name: &str| -> Vec<String> {
        let cells =
            |line: &str| line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).map(str::to_owned).collect();
        printed.lines().map(cells).find(|cells: &Vec<String>| cells.len() > 3 && cells[0] == name).unwrap()
    };
    let meaning = |value: &Value| text(value, "meaning").replace('|', "\\|");
    let mut rows = Vec::new();
    for param in law["parameters"].as_array().unwrap() {
        let (name, cells) = (text(param, "name"), cells(text(param, "name")));
        let unit = text(param, "unit");
        let unit = if unit.is_empty() { "—".to_owned() } else { format!("`{unit}`") };
        let default = if cells[3] == "required" { "" } else { &cells[3] };
        rows.push(format!("| `{name}` | {unit} | {} | {default} | {} |", cells[2], meaning(param)));
    }
    for input in law["inputs"].as_array().unwrap() {
        let (name, cells) = (text(input, "name"), cells(text(input, "name")));
        rows.push(format!("| input `{name}` | `{}` | {} | | {} |", text(input, "unit"), cells[2], meaning(input)));
    }
    rows
}

#[test]
fn every_law_is_shown_as_it_is() {
    let mut compared = 0;
    for law in laws() {
        let name = text(&law, "name");
        let (printed, section) = (springpot(&["laws", name]), section(name));
        let joined = section.join("\n");
        let block = format!("```text\n{}\n```", shown(&printed));
        assert!(joined.contains(&block), "{name}: the chapter of the laws has not\n{block}");
        // The sections of stacks with hysteresis have what the plain one has not.
        let plain = if name.starts_with("piezo-stack-") { self::section("piezo-stack") } else { Vec::new() };
        for row in rows(&law, &printed) {
            assert!(
                section.contains(&row) || plain.contains(&row),
                "{name}: the chapter of the laws has no row\n{row}"
            );
            compared += 1;
        }
        let source = text(&law, "source").replace("(docs/LITERATURE.md)", "([Literature](../LITERATURE.md))");
        assert!(
            section.contains(&format!("Source: {source}.")),
            "{name}: the chapter of the laws has no line\nSource: {source}."
        );
    }
    assert!(compared > 100, "{compared}");
}

/// What a source names: the names and the year of each reference, such as `Bouc 1967, Wen 1976`, and names without a year.
fn cited(source: &str) -> Vec<Vec<&str>> {
    let mut cited = Vec::new();
    for part in source.split(';').map(|part| part.split(" (docs/").next().unwrap_or_default().trim()) {
        let mut names = Vec::new();
        for word in part.split([' ', ',', '-', '&']).filter(|word| !word.is_empty()) {
            let year = word.len() == 4 && word.bytes().all(|byte| byte.is_ascii_digit());
            if year || word.starts_with(char::is_uppercase) {
                names.push(word);
            }
            if year {
                cited.push(std::mem::take(&mut names));
            }
        }
        cited.extend(Some(names).filter(|names| !names.is_empty()));
    }
    cited
}

#[test]
fn sources_are_taken_apart() {
    assert_eq!(cited("that of `x`; Bouc 1967, Wen 1976"), [["Bouc", "1967"], ["Wen", "1976"]]);
    assert_eq!(cited("IEEE Std 176-1987; Hooke"), [vec!["IEEE", "Std", "1987"], vec!["Hooke"]]);
    assert_eq!(cited("Stanway, Sproston & Stevens 1987, its sign")[0], ["Stanway", "Sproston", "Stevens", "1987"]);
    assert_eq!(cited("that of `x` with a springpot (docs/LITERATURE.md)"), Vec::<Vec<&str>>::new());
}

#[test]
fn sources_of_laws_are_in_the_literature() {
    let literature = fs::read_to_string(format!("{ROOT}/docs/LITERATURE.md")).unwrap();
    let keys: Vec<&str> = literature.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next()).collect();
    let mut found = 0;
    for law in laws() {
        for source in cited(text(&law, "source")) {
            let known = keys.iter().any(|key| source.iter().all(|word| key.contains(word)));
            assert!(known, "{}: docs/LITERATURE.md has no row whose key is {}", text(&law, "name"), source.join(" "));
            found += 1;
        }
    }
    assert!(found > 30, "{found}");
}
