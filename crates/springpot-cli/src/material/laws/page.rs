//! One law: equation, parameters, inputs, source, and an element to start from.

use crate::grid::{Grid, Set};
use crate::terminal;
use serde_json::{Value, json};
use springpot::law::{Entry, Input, Param, Range};
use springpot_run::numbers::short;
use springpot_run::parts::Part;

/// The page of a law.
pub(super) fn text(law: &Entry) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let mut text = format!("{}\n", law.name);
    text.push_str(&terminal::hanging("  ", &law.equation, width));
    text.push_str(&parts(law, width));
    text.push_str("\nparameters\n");
    let mut grid = Grid::new(["name", "unit", "range", "default", "meaning"].map(|title| (title, Set::Text)));
    for Param { name, unit, meaning, range, default, .. } in &law.params {
        let default = default.map_or_else(|| "required".to_owned(), |value| format!("{value}"));
        grid.row([&**name, unit_or_one(unit), &interval(*range), &default, meaning].map(str::to_owned).to_vec());
    }
    text.push_str(&indented(&grid));
    if !law.inputs.is_empty() {
        text.push_str("\ninputs, functions of time\n");
        let mut grid = Grid::new(["name", "unit", "range", "meaning"].map(|title| (title, Set::Text)));
        for Input { name, unit, meaning, range } in &law.inputs {
            grid.row([&**name, unit_or_one(unit), &interval(*range), meaning].map(str::to_owned).to_vec());
        }
        text.push_str(&indented(&grid));
    }
    text.push('\n');
    text.push_str(&terminal::hanging("source  ", &law.source, width));
    text.push_str("\nan element of this law in a scenario\n\n");
    text.push_str(&example(law));
    text
}

/// The law as parts in series and beside one another, and what follows from them where it is linear.
fn parts(law: &Entry, width: Option<usize>) -> String {
    let Some(part) = Part::of(law) else { return String::new() };
    let mut text = part.drawing().map_or_else(String::new, |drawing| format!("\nparts\n{drawing}"));
    let formulas = [("K*(ω) = ", part.modulus()), ("G(t)  = ", part.relaxation())];
    let told = formulas.iter().filter_map(|(lead, formula)| formula.as_ref().map(|formula| (lead, formula)));
    for (k, (lead, formula)) in told.enumerate() {
        if k == 0 {
            text.push_str("\ncomplex modulus and relaxation\n");
        }
        text.push_str(&terminal::hanging(&format!("  {lead}"), formula, width));
    }
    if text.contains("·E_alpha(") {
        text.push_str("  E_alpha is the Mittag-Leffler function.\n");
    }
    text
}

/// The catalog's row.
pub(super) fn json(law: &Entry) -> Value {
    let bound = |value: f64| (value.abs() < f64::MAX).then_some(value);
    let params = law.params.iter().map(|param| {
        json!({
            "name": param.name, "unit": param.unit, "meaning": param.meaning,
            "minimum": bound(param.range.low), "maximum": bound(param.range.high), "default": param.default,
        })
    });
    let inputs = law.inputs.iter().map(|input| {
        json!({
            "name": input.name, "unit": input.unit, "meaning": input.meaning,
            "minimum": bound(input.range.low), "maximum": bound(input.range.high),
        })
    });
    json!({
        "name": law.name, "equation": law.equation, "source": law.source,
        "parameters": params.collect::<Vec<_>>(), "inputs": inputs.collect::<Vec<_>>(), "example": example(law),
    })
}

/// What differs of a piezo stack: it moves by tens of micrometres under 150 V, so that its rest is its start.
const STACK: [(&str, &str); 14] = [
    ("F_block", "\"1 kN\""),
    ("x_0", "\"50 um\""),
    ("V_max", "\"150 V\""),
    ("C", "\"5 uF\""),
    ("creep", "0.015"),
    ("alpha_creep", "0.1"),
    ("a", "[0.2, 0.1]"),
    ("r", "[\"10 V\", \"25 V\"]"),
    ("alpha_h", "0.2"),
    ("A", "1"),
    ("beta", "\"0.02 1/V^n\""),
    ("gamma", "\"0.02 1/V^n\""),
    ("n", "1"),
    ("U", "\"50 + 40*sin(6*t)\""),
];

/// Of springs that slip at 2 and at 20 mm.
const FILLED: [(&str, &str); 2] = [("k_f", "[\"5 N/cm\", \"2 N/cm\"]"), ("F_f", "[\"1 N\", \"4 N\"]")];

/// An element of the law with parameters of a usual size.
fn example(law: &Entry) -> String {
    let has = |name: &str| law.params.iter().any(|param| param.name == name);
    let is_stack = has("F_block");
    let table: &[(&str, &str)] = match (is_stack, has("F_f")) {
        (true, _) => &STACK,
        (_, true) => &FILLED,
        _ => &[],
    };
    let own = |name: &str| table.iter().find(|(own, _)| *own == name).map(|(_, value)| (*value).to_owned());
    let value = |param: &Param| match (usual(&param.unit, param.range), param.is_list) {
        (value, false) => value,
        (value, true) => format!("[{value}, {}]", twice(&value)),
    };
    let value = |param: &Param| own(&param.name).unwrap_or_else(|| value(param));
    let params: Vec<String> = law.params.iter().map(|param| format!("{} = {}", param.name, value(param))).collect();
    let input = |input: &Input| own(&input.name).unwrap_or_else(|| usual(&input.unit, input.range));
    let inputs: Vec<String> = law.inputs.iter().map(|one| format!("{} = {}", one.name, input(one))).collect();
    let rest = if is_stack { "start" } else { REST };
    element(&law.name, rest, &params, &inputs)
}

/// A quantity twice as large, so that lists rise; a pure number as it is.
fn twice(value: &str) -> String {
    let Some((number, unit)) = value.trim_matches('"').split_once(' ') else { return value.to_owned() };
    number.parse::<f64>().map_or_else(|_| value.to_owned(), |number| format!("\"{} {unit}\"", 2.0 * number))
}

/// Rest length of most.
const REST: &str = "42 cm";

/// Tables that make a longer line are written with a line for each value.
const LONGEST_LINE: usize = 80;

/// An element of the law with parameters that were found: name, unit, value.
pub(super) fn found(law: &str, params: &[(&str, &str, f64)]) -> String {
    let written = |(name, unit, value): &(&str, &str, f64)| match *unit {
        "" => format!("{name} = {}", short(*value)),
        unit => format!("{name} = \"{} {unit}\"", short(*value)),
    };
    element(law, REST, &params.iter().map(written).collect::<Vec<_>>(), &[])
}

/// An `[[element]]` between the world and a body; parameters and inputs are written as `name = value`.
fn element(law: &str, rest: &str, params: &[String], inputs: &[String]) -> String {
    let mut text = format!(
        "[[element]]\n\
         name = \"strut\"\n\
         from = {{ body = \"world\", point = [0, 0, \"-30 cm\"] }}\n\
         to = {{ body = \"arm\", point = [\"30 cm\", 0, 0] }}\n\
         rest_length = \"{rest}\"\n\
         law = \"{law}\"\n"
    );
    let sections = [("parameters", params), ("inputs", inputs)].into_iter().filter(|(_, values)| !values.is_empty());
    let lines: Vec<_> =
        sections.map(|(name, values)| (name, values, format!("{name} = {{ {} }}\n", values.join(", ")))).collect();
    // What stands behind the head of a table belongs to it, so that either all are lines or none.
    let fits = lines.iter().all(|(.., line)| line.chars().count() <= LONGEST_LINE);
    for (name, values, line) in lines {
        match fits {
            true => text.push_str(&line),
            false => text.push_str(&format!("\n[element.{name}]\n{}\n", values.join("\n"))),
        }
    }
    text
}

/// A value of a usual size, as TOML.
fn usual(unit: &str, range: Range) -> String {
    let written = match unit {
        "" => return if range.contains(0.4) { "0.4".to_owned() } else { format!("{}", range.low.max(0.0)) },
        "N/m" => "5 N/cm",
        "N*s/m" => "20 N*s/m",
        "N*s^alpha/m" => "50 N*s^alpha/m",
        "m/K" => "0.7 mm/degC",
        "K" => "25 degC",
        "m/V" => "10 um/V",
        "V" if range.high <= 0.0 => "0 V",
        "V" => "5 V",
        "N" => "100 N",
        "m" => "10 mm",
        "m/s" => "10 mm/s",
        "F" => "1 uF",
        "ohm" => "50 ohm",
        "1/s" => "100 1/s",
        other => return format!("\"1 {other}\""),
    };
    format!("\"{written}\"")
}

pub(super) fn unit_or_one(unit: &str) -> &str {
    if unit.is_empty() { "1" } else { unit }
}

pub(super) fn interval(range: Range) -> String {
    match (range.low > f64::MIN, range.high < f64::MAX) {
        (true, true) => format!("{} … {}", range.low, range.high),
        (true, false) if range.low == f64::MIN_POSITIVE => "> 0".to_owned(),
        (true, false) => format!("≥ {}", range.low),
        (false, true) => format!("≤ {}", range.high),
        (false, false) => "any".to_owned(),
    }
}

/// The lines of a table, indented; the last column is broken rather than cut.
fn indented(grid: &Grid) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let lines = grid.text(None);
    let meaning = lines.lines().next().and_then(|head| head.find("meaning")).unwrap_or(0);
    let split = |line: &str| {
        let at = line.char_indices().nth(meaning).map_or(line.len(), |(at, _)| at);
        let (lead, words) = line.split_at(at);
        terminal::hanging(&format!("  {lead}"), words, width)
    };
    lines.lines().map(split).collect()
}
