//! What the tests of scenario files share: the example of the format, a small catalog, edits with marked places.

#![allow(dead_code, reason = "each test uses its share")]

use springpot::law::{Catalog, Derivative, Entry, Input, Law, Param, Range, RuleError};
use springpot::scenario::{Cases, Plan, RefusalKind, Refusals, Scenario};
use std::sync::Arc;

/// The example of the format, as the documentation shows it.
pub(crate) const EXAMPLE: &str = include_str!("thermoviscoelastic.toml");

#[derive(Debug)]
struct Dummy;

impl Law for Dummy {}

fn param(name: &'static str, unit: &'static str, range: Range) -> Param {
    Param { name, unit, meaning: "a parameter", range, default: None }
}

/// Rows like those of the library, whose laws do nothing.
pub(crate) fn catalog() -> Catalog {
    const TEMPERATURE: Range = Range { low: 150.0, high: 1500.0 };
    let params: Vec<Param> = vec![
        param("E_c", "N/m", Range::NOT_NEGATIVE),
        param("E_kv", "N/m", Range::NOT_NEGATIVE),
        param("E_d", "N*s^alpha/m", Range::NOT_NEGATIVE),
        param("alpha", "", Range::UNIT),
        param("a_kv", "m/K", Range::ANY),
        Param { default: Some(273.15), ..param("T_ref", "K", TEMPERATURE) },
    ];
    let inputs = vec![Input { name: "T", unit: "K", meaning: "temperature", range: TEMPERATURE }];
    let row = |name, params: Vec<Param>, inputs: Vec<Input>| Entry {
        name,
        equation: "",
        params: params.leak(),
        inputs: inputs.leak(),
        source: "",
        build,
    };
    Catalog::standard()
        .with(row("thermoviscoelastic", params, inputs))
        .with(row(
            "magnetorheological",
            vec![
                param("E_c", "N/m", Range::NOT_NEGATIVE),
                param("mu_0", "N*s^alpha/m", Range::ANY),
                param("mu", "N*s^alpha/(m*V)", Range::ANY),
                param("alpha", "", Range::UNIT),
            ],
            vec![Input { name: "u", unit: "V", meaning: "voltage", range: Range::ANY }],
        ))
        .with(row("spring", vec![param("k", "N/m", Range::ANY)], Vec::new()))
        .with(row(
            "kelvin-voigt",
            vec![param("k", "N/m", Range::NOT_NEGATIVE), param("c", "N*s/m", Range::NOT_NEGATIVE)],
            Vec::new(),
        ))
}

fn build(values: &[f64], _: Derivative) -> Result<Arc<dyn Law>, RuleError> {
    if values[0] < 0.0 {
        return Err(RuleError { rule: "k >= 0".to_owned(), parameter: "k" });
    }
    Ok(Arc::new(Dummy))
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
    let at = element.law.params.iter().position(|param| param.name == name).expect("a parameter of the law");
    element.parameters[at]
}
