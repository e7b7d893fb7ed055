//! Broken scenarios: never a panic, never a hang, and a refusal always has its place.

use crate::support::{EXAMPLE, catalog};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use springpot_scenario::{Refusals, Scenario};

/// What a mutation writes into the text.
const PIECES: &[&str] = &[
    "",
    " ",
    "\n",
    "\"",
    "'",
    "[",
    "]",
    "{",
    "}",
    "=",
    ",",
    ".",
    "#",
    "-",
    "0",
    "1",
    "1e9",
    "1e-9",
    "1e308",
    "nan",
    "inf",
    "-inf",
    "true",
    "1979-05-27",
    "\"\"",
    "[]",
    "{}",
    "[[element]]",
    "[[robot.body]]",
    "[robot]",
    "[[sweep]]",
    "[[figure]]",
    "[time]",
    "[output]",
    "name",
    "name = \"strut\"",
    "\"strut\"",
    "\"world\"",
    "parent = \"forearm\"",
    "q1",
    "element.strut.alpha",
    "alpha",
    "\"50 N*s^alpha/m\"",
    "\"25 degC\"",
    "\"sin(t)\"",
    "\"1/t\"",
    "\\u00e9",
    "é",
    "\u{0}",
    "\u{feff}",
    "\"\"\"",
    "9999999999999999999999",
    "count = 1000000000",
    "values = { from = 0, to = 1, count = 100 }",
    "parameter = [\"element.strut.E_c\"]",
    "kind = \"fixed\"",
    "kind = \"gripper-path\"\nx = 0\ny = 0\nz = 0",
    "kind = \"robot\"",
    "where = { \"element.strut.alpha\" = 0.5 }",
    "output_times = [0, 1]",
    "scheme = \"fbdf-3\"",
    "csv = \"none.csv\"",
    "a.b.c.d",
    "law = \"spring\"",
];

#[derive(Debug, Clone)]
enum Edit {
    Insert(usize, usize),
    Replace(usize, usize, usize),
    Delete(usize, usize),
    Copy(usize, usize, usize),
}

fn edit() -> impl Strategy<Value = Edit> {
    let at = 0..EXAMPLE.len();
    let piece = 0..PIECES.len();
    prop_oneof![
        (at.clone(), piece.clone()).prop_map(|(at, piece)| Edit::Insert(at, piece)),
        (at.clone(), 1..30usize, piece).prop_map(|(at, n, piece)| Edit::Replace(at, n, piece)),
        (at.clone(), 1..60usize).prop_map(|(at, n)| Edit::Delete(at, n)),
        (at.clone(), 1..200usize, at).prop_map(|(from, n, to)| Edit::Copy(from, n, to)),
    ]
}

fn boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

fn mutate(text: &mut String, edit: &Edit) {
    let span = |text: &str, at: usize, n: usize| boundary(text, at)..boundary(text, at + n);
    match *edit {
        Edit::Insert(at, piece) => text.insert_str(boundary(text, at), PIECES[piece]),
        Edit::Replace(at, n, piece) => text.replace_range(span(text, at, n), PIECES[piece]),
        Edit::Delete(at, n) => text.replace_range(span(text, at, n), ""),
        Edit::Copy(from, n, to) => {
            let piece = text[span(text, from, n)].to_owned();
            text.insert_str(boundary(text, to), &piece);
        }
    }
}

fn check(refusals: &Refusals) {
    assert!(!refusals.is_empty());
    for refusal in refusals.iter() {
        assert!(refusal.line >= 1 && refusal.column >= 1);
        assert!(refusal.span.start <= refusal.span.end && refusal.span.end <= refusal.text.len());
        assert!(refusal.text.get(refusal.span.clone()).is_some(), "{refusal:?}");
        assert!(!refusal.message.is_empty() && refusal.message.len() < 2000, "{}", refusal.message);
    }
}

/// Plans a text; true if it was accepted.
fn try_text(text: &str, set: Option<&str>) -> bool {
    let planned = Scenario::parse(text, "fuzz.toml", "/nonexistent").and_then(|mut scenario| {
        if let Some(assignment) = set {
            scenario.set(assignment)?;
        }
        let cases = scenario.cases(&catalog())?;
        let last = cases.plan(cases.len() - 1);
        cases.values(cases.len() - 1);
        last.map(|plan| plan.resolved())
    });
    planned.inspect_err(check).is_ok()
}

fn run(cases: u32) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let strategy = (proptest::collection::vec(edit(), 1..6), proptest::option::of(0..PIECES.len()), 0..6usize);
    let accepted = std::cell::Cell::new(0u32);
    let outcome = runner.run(&strategy, |(edits, piece, path)| {
        let mut text = EXAMPLE.to_owned();
        edits.iter().for_each(|edit| mutate(&mut text, edit));
        let path = ["element.strut.T", "solver.rtol", "time", "sweep.values", "robot.body.forearm.com", "a.\"b"][path];
        let set = piece.map(|piece| format!("{path}={}", PIECES[piece]));
        accepted.set(accepted.get() + u32::from(try_text(&text, set.as_deref())));
        Ok(())
    });
    outcome.unwrap();
    // Edits inside comments and texts leave the scenario whole: both outcomes must have been seen.
    assert!(accepted.get() > cases / 100 && accepted.get() < cases, "{} of {cases} accepted", accepted.get());
}

#[test]
fn mutated_scenarios_never_panic() {
    run(10_000);
}

#[test]
#[ignore = "a million cases"]
fn a_million_mutated_scenarios_never_panic() {
    run(1_000_000);
}

#[test]
fn any_text_is_answered() {
    let config = Config { cases: 2_000, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[9; 32]);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let pieces = proptest::collection::vec(0..PIECES.len(), 0..40);
    runner
        .run(&(pieces, ".{0,40}"), |(pieces, text)| {
            let soup: String = pieces.iter().map(|&piece| PIECES[piece]).collect();
            try_text(&format!("{soup}{text}"), None);
            try_text(&format!("{text}{soup}"), Some(&text));
            Ok(())
        })
        .unwrap();
}
