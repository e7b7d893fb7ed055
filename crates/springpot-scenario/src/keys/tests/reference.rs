//! docs/reference/keys.md is made of the tables of keys.

use super::*;
use springpot::fractional::scheme::Scheme;
use springpot::law::Catalog;
use std::fmt::Write;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference/keys.md");
const AGAIN: &str = "UPDATE=1 cargo test -p springpot-scenario reference";

const HEAD: &str = "# Keys of a scenario

Every key that a scenario may hold, made of the tables by which the program reads, checks and completes it. [Scenario files](../SCENARIO.md) leads to where each is explained, with examples.

A number stands in the unit that is named, or is a quantity with its unit in quotes, such as `\"5 ms\"`. Where two units stand, the first is that of joints that turn, the second that of
joints that slide. The column *of* names the kinds that alone take a key.
";

/// What stands in several places, and what it is called there.
const SHARED: [(&str, &Keys); 4] = [
    ("A signal", &SIGNAL),
    ("How a joint that turns freely moves", &POSE),
    ("What acts on a joint that turns freely", &FORCES),
    ("A number made of constants", &SCALAR),
];

/// A table of the file: its heading, where else it stands, its keys.
struct Section {
    heading: String,
    path: String,
    depth: usize,
    also: Vec<String>,
    keys: &'static Keys,
    /// Which section holds it.
    within: Option<usize>,
}

/// All tables, each behind the one that holds it, named by the shortest of its paths.
fn sections() -> Vec<Section> {
    let top = |heading: &str, keys| Section {
        heading: heading.to_owned(),
        path: String::new(),
        depth: 0,
        also: Vec::new(),
        keys,
        within: None,
    };
    let mut found = vec![top("The file", &SCENARIO)];
    let mut at = 0;
    while at < found.len() {
        for key in found[at].keys.keys {
            let Some(keys) = inner(key) else { continue };
            let path = if at == 0 { key.name.to_owned() } else { format!("{}.{}", found[at].path, key.name) };
            if let Some(known) = found.iter_mut().find(|known| std::ptr::eq(known.keys, keys)) {
                known.also.push(path);
                continue;
            }
            // Tables that files write below a head of their own are named by it.
            let heading = match key.shape {
                Shape::Tables(..) => format!("[[{path}]]"),
                _ if at == 0 => format!("[{path}]"),
                _ => path.clone(),
            };
            let (depth, within) = (path.matches('.').count(), Some(at));
            found.push(Section { heading, path, depth, also: Vec::new(), keys, within });
        }
        at += 1;
    }
    let mut order = Vec::new();
    let mut next = vec![0];
    while let Some(at) = next.pop() {
        order.push(at);
        next.extend((0..found.len()).rev().filter(|k| found[*k].within == Some(at)));
    }
    let mut found: Vec<Option<Section>> = found.into_iter().map(Some).collect();
    let sections = order.into_iter().filter_map(|k| found[k].take());
    sections.chain(SHARED.map(|(heading, keys)| top(heading, keys))).collect()
}

/// The name of a heading in links.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

fn words(words: impl IntoIterator<Item = &'static str>) -> String {
    words.into_iter().map(|word| format!("`{word:?}`")).collect::<Vec<_>>().join(", ")
}

fn unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {}", unit.replace('*', "·").replace("^2", "²")) }
}

fn range(bound: Bound) -> String {
    match bound {
        Bound::Any => String::new(),
        Bound::NotNegative | Bound::Length => ", ≥ 0".to_owned(),
        Bound::Positive => ", > 0".to_owned(),
        Bound::Within(low, high, _) => {
            let number = |number: f64| if number < 0.01 { format!("{number:e}") } else { number.to_string() };
            format!(", {} … {}", number(low), number(high))
        }
    }
}

/// Digits in groups of three.
fn grouped(number: i64) -> String {
    let digits = number.to_string();
    let groups: Vec<&[u8]> = digits.as_bytes().rchunks(3).rev().collect();
    String::from_utf8(groups.join(&b' ')).expect("digits")
}

fn of_joint([turning, sliding]: [&str; 2], bound: Bound) -> String {
    format!("number{} or {}{}", unit(turning), &unit(sliding)[4..], range(bound))
}

/// What a key takes.
fn takes(key: &Key, sections: &[Section]) -> String {
    let link = |words: &str, keys: &Keys| {
        let section =
            sections.iter().find(|section| std::ptr::eq(section.keys, keys)).expect("every table has a section");
        format!("[{words}](#{})", anchor(&section.heading))
    };
    match key.shape {
        Shape::Text => "text".to_owned(),
        Shape::Name(_) => "name".to_owned(),
        Shape::FileName => "name of a file, without ending".to_owned(),
        Shape::Words(_) | Shape::Kinds(_) => words(key.choices()),
        Shape::Flag => "`true` or `false`".to_owned(),
        Shape::Number(of, bound) => format!("number{}{}", unit(of), range(bound)),
        Shape::NumberOrWord(of, bound, word) => format!("number{}{}, or `{word:?}`", unit(of), range(bound)),
        Shape::JointNumber(of, bound) => of_joint(of, bound),
        Shape::JointNumbers(of, bound) => format!("{}, or such by coordinate", of_joint(of, bound)),
        Shape::JointNumberOrWord(of, bound, word) => format!("{}, or `{word:?}`", of_joint(of, bound)),
        Shape::JointNumberOr(of, bound, keys) => {
            format!("{}, or {}, or such by coordinate", of_joint(of, bound), link("table", keys))
        }
        Shape::Whole(low, None) => format!("whole number, ≥ {low}"),
        Shape::Whole(low, Some(high)) => format!("whole number, {low} … {}", grouped(high)),
        Shape::Vector(of) => format!("three numbers{}", unit(of)),
        Shape::Pair(of) => format!("two numbers{}", unit(of)),
        Shape::Range => "two numbers in the unit that is drawn".to_owned(),
        Shape::NumbersOr(of, keys) => format!("array of numbers{}, ≥ 0, or {}", unit(of), link("table", keys)),
        Shape::SweptNumber => "number in the unit of the parameter".to_owned(),
        Shape::SweptNumbers(1, most) => format!("number in the unit of the parameter, or array of {most} at most"),
        Shape::SweptNumbers(..) => "two numbers in the unit of the parameter".to_owned(),
        Shape::OfColumn => "number in the unit of the column".to_owned(),
        Shape::Signal(of) => format!("{}{}", link("signal", &SIGNAL), unit(of)),
        Shape::Signals(of) => format!("three {}{}", link("signals", &SIGNAL), unit(of)),
        Shape::Texts => "text, or array of texts".to_owned(),
        Shape::Paths(most) => format!("path, or array of {most} at most"),
        Shape::TextList => "array of texts".to_owned(),
        Shape::Column => "column".to_owned(),
        Shape::Columns => "column or glob, or array of them".to_owned(),
        Shape::Table(keys) => link("table", keys),
        Shape::TableWithJoints(keys) => {
            format!("{}, of the kind `\"joints\"` with a {} by joint", link("table", keys), link("signal", &SIGNAL))
        }
        Shape::TableOrTables(keys) => format!("{}, or array of them", link("table", keys)),
        Shape::Tables(keys, None) => link("tables", keys),
        Shape::Tables(keys, Some(most)) => format!("{}, {most} at most", link("tables", keys)),
        Shape::WordsOr(_, keys) => format!("{}, or {}", words(key.choices()), link("table", keys)),
        Shape::ValuesOr(keys) => format!("array, or {}", link("table", keys)),
        Shape::ByJoint(each) => {
            let each = match each {
                Each::Path => format!("{} or {}", link("signal", &SIGNAL), link("pose", &POSE)),
                Each::Force => {
                    format!("{} or, of joints that turn freely, {}", link("signal", &SIGNAL), link("several", &FORCES))
                }
                Each::Coordinate => "number in rad or m".to_owned(),
                Each::Number => "number, ≥ 0".to_owned(),
                Each::NumberOr(keys) => format!("number or, of joints that turn freely, {}", link("table", keys)),
            };
            format!("by joint: {each}")
        }
        Shape::ByJointOrNumber => "number, or numbers by joint".to_owned(),
        Shape::TextsByName => "texts by name".to_owned(),
        Shape::TextsByNameOrFalse => "texts by name, or `false`".to_owned(),
        Shape::TextOrFalse => "text, or `false`".to_owned(),
        Shape::WordList(_) => format!("array of {}", words(key.choices())),
        Shape::ColumnsByName(keys) => format!("columns by name: text or {}", link("table", keys)),
        Shape::ByName => "values by name".to_owned(),
        Shape::Scalars => "numbers by name, in any units".to_owned(),
        Shape::UnitOrByName => "unit, or units by column".to_owned(),
        Shape::Law => "name of a [law](#parameters-of-laws)".to_owned(),
        Shape::Scheme => words(["exact"].into_iter().chain(Scheme::NAMES)),
    }
}

/// What stands for a key that is left out.
fn default(key: &Key, keys: &Keys) -> String {
    match key.need {
        Need::Written(_) | Need::Required(_) | Need::Kind => "required".to_owned(),
        Need::OneOf => {
            let others = keys.keys.iter().filter(|other| matches!(other.need, Need::OneOf) && other.name != key.name);
            format!("this or {}", others.map(|other| format!("`{}`", other.name)).collect::<Vec<_>>().join(" or "))
        }
        Need::Optional => String::new(),
        Need::Said(said) => said.to_owned(),
        _ => format!("`{}`", key.default().expect("a value stands for it")),
    }
}

fn page() -> String {
    let sections = sections();
    let mut page = HEAD.to_owned();
    for section in &sections {
        let (hashes, keys) = ("#".repeat(section.depth.min(2) + 2), section.keys);
        let also: Vec<String> = section.also.iter().map(|path| format!("`{path}`")).collect();
        let also = if also.is_empty() { String::new() } else { format!(" Also {}.", also.join(", ")) };
        let _ = write!(page, "\n{hashes} {}\n\n{}{also}\n\n", section.heading, keys.words);
        let of_kinds = keys.keys.iter().any(|key| !key.only.is_empty());
        page += if of_kinds {
            "| key | of | takes | default | meaning |\n|---|---|---|---|---|\n"
        } else {
            "| key | takes | default | meaning |\n|---|---|---|---|\n"
        };
        for key in keys.keys {
            let of = if of_kinds { format!("{} | ", key.only.join(", ")) } else { String::new() };
            let cells = [takes(key, &sections), default(key, keys), key.sentence().into_owned()];
            let cells = cells.map(|cell| cell.replace('|', "\\|")).join(" | ");
            let _ = writeln!(page, "| `{}` | {of}{cells} |", key.name);
        }
    }
    page += "\n## Parameters of laws\n\nUnder `parameters` and `inputs` of an element, with SI units on joints that slide and between points; where a joint turns, N reads N·m and m reads rad. \
             [The laws](../laws/index.md) have equations, ranges and meanings.\n\n| law | parameters | inputs |\n|---|---|---|\n";
    for law in Catalog::standard().entries() {
        let named = |name: &str, of: &str| format!("`{name}`{}", unit(of));
        let params: Vec<String> = law.params.iter().map(|param| named(&param.name, &param.unit)).collect();
        let inputs: Vec<String> = law.inputs.iter().map(|input| named(&input.name, &input.unit)).collect();
        let _ = writeln!(page, "| `{}` | {} | {} |", law.name, params.join(", "), inputs.join(", "));
    }
    page
}

#[test]
fn the_page_of_keys_is_that_of_the_tables() {
    let page = page();
    if std::env::var_os("UPDATE").is_some() {
        fs::write(PATH, &page).unwrap();
    }
    let written = fs::read_to_string(PATH).unwrap_or_default();
    let differing = page.lines().zip(written.lines()).find(|(made, written)| made != written);
    assert!(page == written, "docs/reference/keys.md differs, make it anew: {AGAIN}\n{differing:#?}");
}
