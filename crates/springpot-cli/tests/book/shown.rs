//! What the documents show of the program's output is what it prints.

use crate::support::Ended;
use std::process::Command;

/// Runs every `$ springpot …` of a document, and asserts that the lines shown are printed in that order; `…` stands for any
/// lines, and a residual, which is rounding, for any numbers. Returns how many lines were found.
fn check(document: &str) -> usize {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let text = std::fs::read_to_string(format!("{root}/{document}")).unwrap();
    let mut found = 0;
    for block in text.split("\n```text\n$ springpot ").skip(1) {
        let (command, rest) = block.split_once('\n').unwrap();
        let shown = rest.split("\n```").next().unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_springpot"));
        let ended = Ended::from(program.current_dir(root).args(command.split(' ')).output().unwrap());
        assert_eq!(ended.code, Some(0), "{command}: {}", ended.stderr);
        let mut printed = ended.stdout.lines();
        let mut skips = false;
        for line in shown.lines() {
            if line == "…" {
                skips = true;
                continue;
            }
            let same =
                |printed: &str| printed == line || line.starts_with("residual ") && printed.starts_with("residual ");
            let here = if skips { printed.find(|printed| same(printed)) } else { printed.next().filter(|p| same(p)) };
            assert!(here.is_some(), "{document}: springpot {command} does not print\n{line}\nbut\n{}", ended.stdout);
            (skips, found) = (false, found + 1);
        }
    }
    found
}

#[test]
fn outputs_are_as_shown() {
    assert_eq!(check("docs/ROBOTS.md"), 11 + 11);
}
