//! Formulas of the book are such that docs/theme/math.js typesets them.

use crate::page::{Page, ROOT, summary};
use std::fs;

/// The formulas of a page with their lines: blocks, and spans between `$` and backticks.
fn formulas(page: &Page, text: &str) -> Vec<(usize, String)> {
    let blocks = page.blocks.iter().filter(|block| block.info == "math");
    let mut found: Vec<(usize, String)> = blocks.map(|block| (block.line, block.lines.join("\n"))).collect();
    for (number, line) in text.lines().enumerate() {
        for span in line.split("$`").skip(1) {
            let (formula, _) = span.split_once("`$").unwrap_or_else(|| panic!("{}:{}: {span}", page.name, number + 1));
            found.push((number + 1, formula.to_owned()));
        }
    }
    found
}

/// Why a formula would stay as it is written.
fn unknown(formula: &str, script: &str) -> Option<String> {
    let mut open = 0i32;
    let mut rest = formula.chars().peekable();
    while let Some(letter) = rest.next() {
        match letter {
            '{' => open += 1,
            '}' => open -= 1,
            // A cell of a table ends there.
            '|' => return Some("| is \\lvert and \\rvert".to_owned()),
            '\\' => {
                let mut word = String::new();
                while let Some(letter) = rest.next_if(char::is_ascii_alphabetic) {
                    word.push(letter);
                }
                let known = [format!(" {word}: "), format!("'{word}'"), format!("'\\\\{word}'")];
                if word.is_empty() {
                    let mark = rest.next();
                    if !matches!(mark, Some(',' | ';')) {
                        return Some(format!("\\{mark:?}"));
                    }
                } else if !known.iter().any(|known| script.contains(known)) {
                    return Some(format!("\\{word}"));
                }
            }
            _ => {}
        }
        if open < 0 {
            break;
        }
    }
    if formula.matches(r"\left").count() != formula.matches(r"\right").count() {
        return Some(r"\left and \right".to_owned());
    }
    (open != 0).then(|| "braces".to_owned())
}

#[test]
fn every_formula_is_typeset() {
    let script = fs::read_to_string(format!("{ROOT}/docs/theme/math.js")).unwrap();
    let mut found = 0;
    for path in summary() {
        let page = Page::open(&format!("docs/{path}"));
        let text = fs::read_to_string(format!("{ROOT}/{}", page.name)).unwrap();
        for (line, formula) in formulas(&page, &text) {
            assert_eq!(unknown(&formula, &script), None, "{}:{line}: {formula}", page.name);
            found += 1;
        }
    }
    assert!(found > 150, "{found}");
    for (wrong, word) in
        [(r"\farc{1}{2}", r"\farc"), (r"\frac{1}{2", "braces"), ("|x|", r"\lvert"), (r"\left( x", "right")]
    {
        assert!(unknown(wrong, &script).unwrap().contains(word), "{wrong}");
    }
    // Nothing that the script says is fetched.
    assert!(!script.replace("http://www.w3.org/1998/Math/MathML", "").contains("http"));
}
