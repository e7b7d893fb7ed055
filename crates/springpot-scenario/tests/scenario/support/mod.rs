//! What the tests of scenario files share: the example of the format, edits with marked places.

#![allow(dead_code, reason = "each test uses its share")]

use springpot::law::Catalog;
use springpot::motion::{JointPath, PosePath, Trajectory};
use springpot::signal::Signal;
use springpot::system::Motion;
use springpot_scenario::{Cases, Plan, RefusalKind, Refusals, Scenario};

/// The example of the format, as the documentation shows it.
pub(crate) const EXAMPLE: &str = include_str!("thermoviscoelastic.toml");

pub(crate) fn catalog() -> Catalog {
    Catalog::standard()
}

pub(crate) fn parse(text: &str) -> Result<Scenario, Refusals> {
    Scenario::parse(text, "arm.toml", "")
}

pub(crate) fn cases(text: &str) -> Result<Cases, Refusals> {
    parse(text)?.cases(&catalog())
}

/// The example without its sweep.
pub(crate) fn single() -> String {
    let start = EXAMPLE.find("[[sweep]]").unwrap();
    let end = EXAMPLE.find("[[figure]]").unwrap();
    format!("{}{}", &EXAMPLE[..start], &EXAMPLE[end..])
}

/// The text with every edit made; each must hit exactly once.
pub(crate) fn edited(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from:?} does not stand exactly once");
        text.replacen(from, to, 1)
    })
}

/// Takes the mark `‸` out of a text: the text, line and column (from 1, in characters) of the mark.
pub(crate) fn marked(text: &str) -> (String, usize, usize) {
    assert_eq!(text.matches('‸').count(), 1, "one mark is needed");
    for (i, line) in text.split('\n').enumerate() {
        if let Some(column) = line.chars().position(|c| c == '‸') {
            return (text.replace('‸', ""), i + 1, column + 1);
        }
    }
    unreachable!()
}

/// What is edited, what sort of refusal is wanted, and what its message or help must hold.
pub(crate) type Case<'a> = (&'a [(&'a str, &'a str)], RefusalKind, &'a str);

pub(crate) fn refusals(text: &str) -> Refusals {
    cases(text).map(|cases| cases.len()).expect_err("this text must be refused")
}

/// Asserts that one refusal points at the mark and says what it should.
pub(crate) fn assert_refused(base: &str, (edits, kind, words): &Case<'_>) {
    let (text, line, column) = marked(&edited(base, edits));
    let refusals = refusals(&text);
    let shown = refusals.to_string();
    let found = refusals.iter().find(|refusal| (refusal.line, refusal.column) == (line, column));
    let refusal = found.unwrap_or_else(|| panic!("{edits:?}: nothing at {line}:{column} but\n{shown}"));
    assert_eq!(refusal.kind, *kind, "{edits:?}:\n{shown}");
    assert!(refusal.to_string().contains(words), "{edits:?}: no {words:?} in\n{shown}");
    assert!(refusal.to_string().starts_with(&format!("arm.toml:{line}:{column}: ")), "{shown}");
    assert!(text.get(refusal.span.clone()).is_some(), "{edits:?}: the span splits a character");
    assert_eq!(&*refusal.text, text.as_str());
}

pub(crate) fn assert_all_refused(base: &str, cases: &[Case<'_>]) {
    for case in cases {
        assert_refused(base, case);
    }
}

/// A parameter of the first element by name, SI.
pub(crate) fn parameter(plan: &Plan, name: &str) -> f64 {
    let element = &plan.elements[0];
    let at = element.element.entry.params.iter().position(|param| param.name == name).expect("a parameter of the law");
    element.parameters[at]
}

/// How the joints of a prescribed motion move.
pub(crate) fn paths(plan: &Plan) -> Vec<JointPath> {
    let Motion::Given(trajectory) = plan.system().motion else { panic!("given") };
    let Trajectory::Prescribed(paths) = &*trajectory else { panic!("prescribed") };
    paths.clone()
}

/// The signals of a prescribed motion of joints of one degree.
pub(crate) fn coordinates(plan: &Plan) -> Vec<Signal> {
    fn of_one_degree(path: JointPath) -> Signal {
        match path {
            JointPath::Coordinate(signal) => signal,
            JointPath::Attitude(_) | JointPath::Pose(_) => panic!("a floating joint"),
        }
    }
    paths(plan).into_iter().map(of_one_degree).collect()
}

/// How the first joint of a prescribed motion moves, which floats.
pub(crate) fn pose(plan: &Plan) -> PosePath {
    match paths(plan).swap_remove(0) {
        JointPath::Pose(pose) => *pose,
        JointPath::Coordinate(_) | JointPath::Attitude(_) => panic!("a joint of one degree"),
    }
}
