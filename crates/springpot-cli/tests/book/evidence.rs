//! What the pages of evidence name is there: tests, benchmarks, files of reference values.

use crate::page::{ROOT, summary};
use std::fs;
use std::path::Path;

/// Words of a text, without the marks about them.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split([' ', '\n', '`', '(', ')', ',', ';', ':', '|']).filter(|word| !word.is_empty())
}

#[test]
fn tests_and_benchmarks_that_pages_name_exist() {
    let mut found = 0;
    for path in summary() {
        let text = fs::read_to_string(format!("{ROOT}/docs/{path}")).unwrap();
        for command in text.split("cargo ").skip(1).map(|rest| rest.split('`').next().unwrap_or_default()) {
            let words: Vec<&str> = words(command).collect();
            let Some([_, package]) = words.windows(2).find(|pair| pair[0] == "-p") else { continue };
            for pair in words.windows(2) {
                let folder = match pair[0] {
                    "--test" => "tests",
                    "--bench" => "benches",
                    _ => continue,
                };
                // Words behind the name of a test choose among its parts.
                let file = format!("{ROOT}/crates/{package}/{folder}/{}", pair[1]);
                let is_there =
                    Path::new(&format!("{file}.rs")).exists() || Path::new(&format!("{file}/main.rs")).exists();
                assert!(is_there, "docs/{path}: cargo {command}: there is no {} of {package}", pair[1]);
                found += 1;
            }
        }
    }
    assert!(found > 30, "{found}");
}

#[test]
fn reference_values_have_a_source() {
    let page = fs::read_to_string(format!("{ROOT}/docs/VALIDATION.md")).unwrap();
    let sources = fs::read_to_string(format!("{ROOT}/testdata/README.md")).unwrap();
    let folders: Vec<String> = fs::read_dir(format!("{ROOT}/testdata"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let mut found = 0;
    for word in words(&page) {
        let path = word.trim_start_matches("testdata/");
        let Some((folder, name)) = path.split_once('/') else { continue };
        if !folders.iter().any(|known| known == folder) || name.is_empty() || name.contains('*') {
            continue;
        }
        assert!(
            Path::new(&format!("{ROOT}/testdata/{path}")).exists(),
            "docs/VALIDATION.md: there is no testdata/{path}"
        );
        assert!(sources.contains(&format!("`{name}`")), "testdata/README.md does not say where {path} comes from");
        found += 1;
    }
    assert!(found > 15, "{found}");
}

/// Every work that the paper cites is in its bibliography, and there as Literature has it.
#[test]
fn the_paper_cites_what_literature_lists() {
    let read = |name: &str| fs::read_to_string(format!("{ROOT}/{name}")).unwrap();
    let (paper, works, literature) = (read("paper/paper.md"), read("paper/paper.bib"), read("docs/LITERATURE.md"));
    let keys: Vec<&str> = works.split("\n@").filter_map(|work| work.split(['{', ',']).nth(1)).collect();
    assert!(keys.len() >= 10);
    for key in &keys {
        assert!(paper.contains(&format!("@{key}")), "nothing cites {key}");
    }
    for cited in paper.split('@').skip(1) {
        let key: String = cited.chars().take_while(|c| c.is_ascii_alphanumeric()).collect();
        assert!(keys.contains(&&*key), "{key} is not in paper.bib");
    }
    for title in works.lines().filter_map(|line| line.trim().strip_prefix("title")) {
        let plain: String = title.chars().filter(|c| !"={},".contains(*c)).collect();
        // Formulas are written otherwise.
        let words = plain.split('$').next().unwrap().trim();
        assert!(literature.contains(words), "Literature has no {words:?}");
    }
}
