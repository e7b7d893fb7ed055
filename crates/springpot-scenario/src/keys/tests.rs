//! The tables of keys beside those of docs/SCENARIO.md, and what must hold of any key.

mod reference;

use super::super::figures::{FIGURE, POINTS};
use super::super::motion::{MOTION, MotionKind};
use super::super::root::SCENARIO;
use super::*;
use std::fs;

/// What a key may hold in a table of its own, if anything.
fn inner(key: &Key) -> Option<&'static Keys> {
    match key.shape {
        Shape::Table(keys)
        | Shape::Tables(keys, _)
        | Shape::TableOrTables(keys)
        | Shape::ValuesOr(keys)
        | Shape::NumbersOr(_, keys)
        | Shape::WordsOr(_, keys)
        | Shape::TableWithJoints(keys)
        | Shape::JointNumberOr(_, _, keys) => Some(keys),
        Shape::ByJoint(Each::NumberOr(keys)) => Some(keys),
        _ => None,
    }
}

/// Every table, each once.
fn tables() -> Vec<&'static Keys> {
    let mut found: Vec<&'static Keys> = vec![&SCENARIO, &SIGNAL, &POSE, &FORCES];
    let mut at = 0;
    while at < found.len() {
        for keys in found[at].keys.iter().filter_map(inner) {
            if !found.iter().any(|known| std::ptr::eq(*known, keys)) {
                found.push(keys);
            }
        }
        at += 1;
    }
    found
}

#[test]
fn every_key_is_sound() {
    let mut count = 0;
    for keys in tables() {
        let mut names = keys.names();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), keys.keys.len(), "{}: a key stands twice", keys.words);
        for key in keys.keys {
            assert!(key.sentence().ends_with('.') && keys.words.ends_with('.'), "{}", key.name);
            if let (Need::Number(default), Shape::Number(_, bound) | Shape::JointNumber(_, bound)) =
                (key.need, key.shape)
            {
                let holds = match bound {
                    Bound::Any => default.is_finite(),
                    Bound::NotNegative | Bound::Length => default >= 0.0,
                    Bound::Positive => default > 0.0,
                    Bound::Within(low, high, _) => (low..=high).contains(&default),
                };
                assert!(holds, "{}: the default is out of range", key.name);
            }
            if let Need::Word(word) = key.need {
                let choices = key.choices();
                assert!(choices.is_empty() || choices.contains(&word), "{}: {word} is no choice", key.name);
            }
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
    assert_eq!(POSE.names(), START_POSE.names());
    assert_eq!(FORCES.names(), START_VELOCITIES.names());
    assert!(SOLVER_FIELDS.iter().all(|(name, _)| SOLVER.get(name).is_some()));
    assert!(ELEMENT_FIELDS.iter().all(|(name, _)| ELEMENT.get(name).is_some()));
}

/// A row of a table of keys: the keys in its first cell, what is said of them, and the last cell.
struct Row {
    names: Vec<String>,
    said: String,
    last: String,
}

/// The tables of keys of the section under `heading`, one behind the other.
fn documented(text: &str, heading: &str) -> Vec<Vec<Row>> {
    let (_, rest) = text.split_once(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("no section {heading}"));
    let level = heading.split(' ').next().unwrap_or_default();
    let ends = ["\n## ", "\n### "].map(|end| if level == "##" && end == "\n### " { "\n###" } else { end });
    let end = ends.iter().filter_map(|end| rest.find(end)).min().unwrap_or(rest.len());
    let (mut tables, mut within) = (Vec::new(), false);
    for line in rest[..end].lines() {
        match line {
            _ if line.starts_with("| key |") => {
                tables.push(Vec::new());
                within = true;
            }
            _ if !line.starts_with('|') => within = false,
            _ if !within || line.starts_with("|---") => {}
            _ => {
                let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
                let names = cells[0].split('`').skip(1).step_by(2);
                // `[[robot.body]]` and `[robot.gripper]` are the keys body and gripper.
                let names = names.map(|name| name.trim_matches(['[', ']']).rsplit('.').next().unwrap_or("").to_owned());
                let row =
                    Row { names: names.collect(), said: cells[1].to_owned(), last: cells[cells.len() - 1].to_owned() };
                tables.last_mut().expect("a head came before").push(row);
            }
        }
    }
    tables
}

/// A unit as the documents write it.
fn unit_of(key: &Key) -> String {
    let unit = match key.shape {
        Shape::Number(unit, _)
        | Shape::Vector(unit)
        | Shape::Pair(unit)
        | Shape::NumbersOr(unit, _)
        | Shape::Signal(unit) => unit,
        Shape::JointNumber([turning, _], _)
        | Shape::JointNumberOr([turning, _], ..)
        | Shape::JointNumberOrWord([turning, _], ..) => turning,
        _ => "",
    };
    unit.replace('*', "·").replace("^2", "²")
}

/// Whether the document's last cell says what the key's row says.
fn is_said(key: &Key, last: &str) -> bool {
    let plain = last.replace('`', "");
    match key.need {
        Need::Written(_) | Need::Required(_) | Need::Kind => plain.starts_with("required"),
        Need::OneOf => ["one of", "the two"].contains(&plain.as_str()),
        Need::Optional => !plain.starts_with("required"),
        _ => key.default().is_some_and(|default| plain == default),
    }
}

#[test]
fn the_document_has_the_same_keys() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/SCENARIO.md");
    let text = fs::read_to_string(path).unwrap();
    let of_motion = |kind: &str| -> Vec<&'static Key> { MOTION.of(kind).filter(|key| !key.only.is_empty()).collect() };
    let all = |keys: &'static Keys| -> Vec<&'static Key> { keys.keys.iter().collect() };
    // The two keys of prescribed joints stand in sentences.
    let with_tables = MotionKind::ALL.iter().filter(|kind| **kind != MotionKind::Prescribed);
    let sections = [
        ("## [robot]", vec![all(&ROBOT)]),
        ("### Bodies", vec![all(&BODY), all(&JOINT), all(&FRICTION)]),
        ("## [[element]]", vec![all(&ELEMENT)]),
        ("### Past", vec![all(&HELD)]),
        ("### Heat", vec![all(&SHIFT), all(&THERMAL), all(&EXPANSION)]),
        ("## [motion]", with_tables.map(|kind| of_motion(kind.name())).collect()),
        ("### Controllers", vec![all(&CONTROLLER)]),
        ("## [[event]]", vec![all(&EVENT)]),
        ("## [[metric]]", vec![all(&METRIC)]),
        ("## [time]", vec![all(&TIME)]),
        ("## [solver]", vec![all(&SOLVER)]),
        ("## [[sweep]]", vec![all(&SWEEP)]),
        ("## [[figure]]", vec![all(&FIGURE)]),
    ];
    let mut compared = 0;
    for (heading, wanted) in sections {
        let tables = documented(&text, heading);
        assert_eq!(tables.len(), wanted.len(), "{heading}: tables of keys");
        for (rows, keys) in tables.iter().zip(wanted) {
            let mut known: Vec<&str> = keys.iter().map(|key| key.name).collect();
            let mut names: Vec<&str> = rows.iter().flat_map(|row| &row.names).map(String::as_str).collect();
            known.sort_unstable();
            names.sort_unstable();
            assert_eq!(names, known, "{heading}");
            for row in rows {
                for key in keys.iter().filter(|key| row.names.iter().any(|name| name == key.name)) {
                    let (name, unit) = (key.name, unit_of(key));
                    assert!(row.said.contains(&unit), "{heading}: {name} is in {unit}: {}", row.said);
                    assert!(is_said(key, &row.last), "{heading}: {name}: {} is not {:?}", row.last, key.default());
                    for word in key.choices() {
                        assert!(
                            row.said.contains(&format!("`\"{word}\"`")),
                            "{heading}: {name} may be {word}: {}",
                            row.said
                        );
                    }
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 50, "{compared}");
    // Keys that stand in sentences.
    for keys in [
        &SIGNAL,
        &INERTIA,
        &ANCHOR,
        &SPAN,
        &TIMES,
        &POINTS,
        &POSE,
        &START_VELOCITIES,
        &OUTPUT,
        &ACTION,
        &END_STOPS,
        &REFERENCE,
    ] {
        for key in keys.keys {
            let named = [
                format!("`{}`", key.name),
                format!("{} =", key.name),
                format!(" {},", key.name),
                format!(" {} }}", key.name),
            ];
            assert!(named.iter().any(|name| text.contains(name)), "{}", key.name);
        }
    }
}

#[test]
fn the_document_says_which_keys_a_figure_cannot_have() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/SCENARIO.md");
    let text = fs::read_to_string(path).unwrap();
    let (_, section) = text.split_once("\n## [[figure]]\n").unwrap();
    let kinds = FIGURE.get("kind").unwrap().choices();
    assert!(kinds.len() >= 2);
    for kind in kinds {
        let keys: Vec<String> = FIGURE.not_of(kind).map(|key| format!("`{}`", key.name)).collect();
        let Some((last, others)) = keys.split_last() else { continue };
        let list = if others.is_empty() { last.clone() } else { format!("{} or {last}", others.join(", ")) };
        let said = section.split("`kind = ").find(|part| part.starts_with(&format!("\"{kind}\"`")));
        assert!(said.is_some_and(|said| said.contains(&format!("takes no {list}"))), "{kind} takes no {list}");
    }
}
