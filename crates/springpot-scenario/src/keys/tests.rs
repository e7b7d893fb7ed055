//! The tables of keys beside those of docs/scenario/, and what must hold of any key.

mod reference;

use super::*;
use crate::figures::{FIGURE, POINTS};
use crate::scenario::root::SCENARIO;
use springpot::model::JointKind;
use std::fs;

/// What a key may hold in a table of its own, if anything.
fn inner(key: &Key) -> Option<&'static Keys> {
    match key.shape {
        Shape::Table(keys)
        | Shape::Tables(keys, _)
        | Shape::TableOrTables(keys)
        | Shape::ColumnsByName(keys)
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
fn kinds_of_joint_take_the_keys_that_they_have() {
    for kind in JointKind::ALL {
        let numbers: Vec<_> = kind.numbers().collect();
        let ends = !numbers.is_empty() && kind != JointKind::Continuous;
        let expected = [
            ("axis", kind.has_axis()),
            ("axis2", kind.has_axis2()),
            ("lead", kind.has_lead()),
            ("damping", !numbers.is_empty()),
            ("friction", !numbers.is_empty()),
            ("armature", !numbers.is_empty()),
            ("velocity", !numbers.is_empty()),
            ("effort", !numbers.is_empty()),
            ("lower", ends),
            ("upper", ends),
            ("mimic", kind.dimension().is_some()),
        ];
        for keys in [&JOINT, &CHANGED_JOINT] {
            let taken = keys.names_for(kind.name());
            for (key, has) in expected.into_iter().filter(|(key, _)| keys.get(key).is_some()) {
                assert_eq!(taken.contains(&key), has, "{key} of {} joints", kind.name());
            }
        }
        assert!(JOINT.keys.iter().all(|key| key.only.is_empty() || expected.iter().any(|(name, _)| *name == key.name)));
        // What stands behind a dot tells the coordinate.
        let mut names: Vec<&str> = numbers.iter().map(|(name, _)| *name).collect();
        names.dedup();
        assert_eq!(names.len(), numbers.len(), "{}", kind.name());
        assert!(numbers.len() < 2 || names.iter().all(|name| !name.is_empty()), "{}", kind.name());
    }
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/how-to/joints.md")).unwrap();
    for kind in JointKind::ALL {
        let row = page.lines().find(|line| line.starts_with('|') && line.contains(&format!("`{}`", kind.name())));
        let row = row.unwrap_or_else(|| panic!("no row for {} joints", kind.name()));
        for (name, _) in kind.numbers().filter(|(name, _)| !name.is_empty()) {
            assert!(row.contains(&format!("`.{name}`")), "{}: {name}", kind.name());
        }
    }
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
            if let (
                Need::Number(default),
                Shape::Number(_, bound) | Shape::JointNumber(_, bound) | Shape::JointNumbers(_, bound),
            ) = (key.need, key.shape)
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

/// A page of the chapter about scenarios.
fn page(name: &str) -> String {
    let path = format!("{}/../../docs/scenario/{name}.md", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// All of them, one behind the other.
fn chapter() -> String {
    let folder = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenario")).unwrap();
    folder.map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap()).collect()
}

/// The rows of the table of keys under a heading.
fn documented(text: &str, heading: &str) -> Vec<Row> {
    let (_, rest) = text.split_once(&format!("\n## {heading}\n")).unwrap_or_else(|| panic!("no section {heading}"));
    let section = rest.split("\n## ").next().unwrap_or_default();
    assert_eq!(section.matches("\n| key |").count(), 1, "{heading}: tables of keys");
    let lines = section.lines().skip_while(|line| !line.starts_with("| key |")).skip(2);
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let names = cells[0].split('`').skip(1).step_by(2);
        // `[[robot.body]]` and `[robot.gripper]` are the keys body and gripper.
        let names = names.map(|name| name.trim_matches(['[', ']']).rsplit('.').next().unwrap_or("").to_owned());
        Row { names: names.collect(), said: cells[1].to_owned(), last: cells[cells.len() - 1].to_owned() }
    };
    lines.take_while(|line| line.starts_with('|')).map(row).collect()
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
        | Shape::JointNumbers([turning, _], _)
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

/// The pages, with their headings, whose tables hold the keys of one.
type Places = &'static [(&'static str, &'static str)];

#[test]
fn the_pages_have_the_same_keys() {
    let of_motion =
        |kind: MotionKind| -> Vec<&'static Key> { MOTION.of(kind.name()).filter(|key| !key.only.is_empty()).collect() };
    let all = |keys: &'static Keys| -> Vec<&'static Key> { keys.keys.iter().collect() };
    // The two keys of prescribed joints stand in sentences.
    let sections: [(Places, Vec<&'static Key>); 24] = [
        (&[("robot", "[robot]"), ("urdf", "Keys"), ("mjcf", "Keys")], all(&ROBOT)),
        (&[("robot", "Bodies")], all(&BODY)),
        (&[("robot", "Joints")], all(&JOINT)),
        (&[("robot", "Friction")], all(&FRICTION)),
        (&[("element", "[[element]]")], all(&ELEMENT)),
        (&[("past", "past")], all(&HELD)),
        (&[("heat", "shift")], all(&SHIFT)),
        (&[("heat", "thermal")], all(&THERMAL)),
        (&[("heat", "expansion")], all(&EXPANSION)),
        (&[("prescribed", "A path of the gripper")], of_motion(MotionKind::GripperPath)),
        (&[("forward", "Keys")], of_motion(MotionKind::Forward)),
        (&[("controller", "Keys")], all(&CONTROLLER)),
        (&[("events", "[[event]]")], all(&EVENT)),
        (&[("metrics", "[[metric]]")], all(&METRIC)),
        (&[("time", "[time]")], all(&TIME)),
        (&[("time", "[solver]")], all(&SOLVER)),
        (&[("sweep", "[[sweep]]")], all(&SWEEP)),
        (&[("sensitivity", "[[parameter]]")], all(&PARAMETER)),
        (&[("sensitivity", "[sensitivity]")], all(&SENSITIVITY)),
        (&[("fit", "[[data]]")], all(&DATA)),
        (&[("fit", "[fit]")], all(&FIT)),
        (&[("design", "[design]")], all(&DESIGN)),
        (&[("design", "Constraints")], all(&CONSTRAINT)),
        (&[("figures", "[[figure]]")], all(&FIGURE)),
    ];
    let mut compared = 0;
    for (places, keys) in sections {
        let rows: Vec<(&str, String, Row)> = places
            .iter()
            .flat_map(|(name, heading)| {
                let text = page(name);
                documented(&text, heading).into_iter().map(move |row| (*name, text.clone(), row))
            })
            .collect();
        let mut known: Vec<&str> = keys.iter().map(|key| key.name).collect();
        let mut names: Vec<&str> = rows.iter().flat_map(|(_, _, row)| &row.names).map(String::as_str).collect();
        known.sort_unstable();
        names.sort_unstable();
        assert_eq!(names, known, "{places:?}");
        for (place, text, row) in &rows {
            for key in keys.iter().filter(|key| row.names.iter().any(|name| name == key.name)) {
                let (name, unit) = (key.name, unit_of(key));
                assert!(row.said.contains(&unit), "{place}: {name} is in {unit}: {}", row.said);
                assert!(is_said(key, &row.last), "{place}: {name}: {} is not {:?}", row.last, key.default());
                // A long list of words stands in a table of its own.
                let said = if row.said.contains("[below]") { text } else { &row.said };
                for word in key.choices() {
                    assert!(said.contains(&format!("`\"{word}\"`")), "{place}: {name} may be {word}: {}", row.said);
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 50, "{compared}");
    // Keys that stand in sentences.
    let text = chapter();
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
        &PRIOR,
        &DATA_COLUMN,
        &HUBER,
        &DESIGN,
        &CONSTRAINT,
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

/// docs/SCENARIO.md leads to every key, under the heading of its section.
#[test]
fn the_index_leads_to_every_key() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/SCENARIO.md");
    let text = fs::read_to_string(path).unwrap();
    let section = |heading: &str| {
        let (_, rest) = text.split_once(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("no section {heading}"));
        rest.split("\n#").next().unwrap_or_default()
    };
    let mut found = 0;
    for (heading, tables) in [
        ("## Values", &[&SIGNAL] as &[&'static Keys]),
        ("## [robot]", &[]),
        ("### Bodies", &[&BODY, &INERTIA, &JOINT, &FRICTION]),
        ("### URDF files", &[&END_STOPS]),
        ("## [[element]]", &[&ELEMENT, &ANCHOR]),
        ("### Past", &[&HELD]),
        ("### Heat", &[&SHIFT, &THERMAL, &EXPANSION]),
        ("## [motion]", &[&MOTION, &POSE, &START_VELOCITIES]),
        ("### Controllers", &[&CONTROLLER, &NOISE, &REFERENCE]),
        ("## [[event]]", &[&EVENT, &ACTION]),
        ("## [[metric]]", &[&METRIC]),
        ("## [time]", &[&TIME, &TIMES]),
        ("## [solver]", &[&SOLVER]),
        ("## [[sweep]]", &[&SWEEP, &SPAN]),
        ("## [[parameter]]", &[&PARAMETER, &PRIOR]),
        ("## [sensitivity]", &[&SENSITIVITY]),
        ("## [[data]]", &[&DATA, &DATA_COLUMN, &HUBER]),
        ("## [fit]", &[&FIT]),
        ("## [design]", &[&DESIGN, &CONSTRAINT]),
        ("## [[figure]]", &[&FIGURE, &POINTS]),
        ("## [output]", &[&OUTPUT]),
    ] {
        let section = section(heading);
        for key in tables.iter().flat_map(|keys| keys.keys) {
            assert!(section.contains(&format!("[`{}`](scenario/", key.name)), "{heading}: no link to {}", key.name);
            found += 1;
        }
    }
    for key in tables().iter().flat_map(|keys| keys.keys) {
        assert!(text.contains(&format!("[`{}`](", key.name)), "no link to {}", key.name);
    }
    for law in springpot::law::Catalog::standard().entries() {
        assert!(text.contains(&format!("[`{}`](laws/", law.name)), "no link to {}", law.name);
    }
    assert!(found > 150, "{found}");
}

#[test]
fn the_page_says_which_keys_a_figure_cannot_have() {
    let section = page("figures");
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
