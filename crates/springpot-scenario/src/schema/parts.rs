//! `[[element]]`, `[time]`, `[solver]`, `[[sweep]]`, `[[figure]]`, `[output]`.

use super::super::figures::{self, OUTPUT_KEYS};
use super::super::sweep::{self, MAX_CASES, MAX_TOGETHER, SCALES, SPAN_KEYS};
use super::super::time::{self, ADAPTIVE, FIXED, SMALLEST_MEMORY_RTOL, SOLVER_KEYS, TOLERANCES};
use super::super::{elements, names};
use super::robot::{anchor, name};
use super::{described, merge, not_negative, object, one_of, positive, quantity, signal, text, unknown};
use serde_json::{Map, Value, json};
use springpot::fractional::scheme::Scheme;
use springpot::law::{Catalog, Entry, Input, Param, Range};

pub(super) fn element(catalog: &Catalog) -> Value {
    let laws: Vec<&str> = catalog.entries().iter().map(|law| law.name).collect();
    let mut schema = object("A material between two points of two bodies.", &elements::KEYS, |key| match key {
        "name" => {
            let mut schema = name("Name of the element; begins the names of its columns.");
            schema["not"] = json!({ "enum": names::RESERVED_ELEMENT_NAMES });
            schema
        }
        "from" => anchor("First end."),
        "to" => anchor("Second end."),
        "rest_length" => not_negative("m", "Length at which the stroke is 0."),
        "law" => described(one_of(&laws), "Name of the law: `springpot laws` lists them."),
        "parameters" => json!({ "type": "object", "description": "Parameters, as the law says." }),
        "inputs" => json!({ "type": "object", "description": "Inputs, as the law says: functions of time." }),
        "derivative" => {
            let kinds = one_of(&["caputo", "riemann-liouville"]);
            described(kinds, "What happened before t = 0: held at x(0), or unloaded. Default: \"caputo\".")
        }
        "scheme" => scheme(),
        _ => unknown(),
    });
    let rules: Vec<Value> = catalog.entries().iter().map(of_law).collect();
    merge(&mut schema, json!({ "required": ["name"], "allOf": rules }));
    schema
}

/// A law's own parameters and inputs.
fn of_law(law: &Entry) -> Value {
    let table = |what: &str, properties: Map<String, Value>| {
        let description = format!("{what} of {}: {}", law.name, law.equation);
        json!({ "type": "object", "description": description, "properties": properties, "additionalProperties": false })
    };
    let params = law.params.iter().map(|param| (param.name.to_owned(), parameter(param)));
    let inputs = law.inputs.iter().map(|Input { name, unit, meaning, .. }| {
        let schema = signal(unit, &format!("{}.", capitalised(meaning)));
        ((*name).to_owned(), schema)
    });
    json!({
        "if": { "properties": { "law": { "const": law.name } }, "required": ["law"] },
        "then": { "properties": {
            "parameters": table("Parameters", params.collect()),
            "inputs": table("Inputs", inputs.collect()),
        } },
    })
}

fn parameter(&Param { unit, meaning, range, default, .. }: &Param) -> Value {
    let mut description = format!("{}.", capitalised(meaning));
    if let Some(default) = default {
        description.push_str(&format!(" Default: {default}{}{unit}.", if unit.is_empty() { "" } else { " " }));
    }
    let mut schema = quantity(unit, &description);
    let Range { low, high } = range;
    if low > f64::MIN {
        schema["minimum"] = low.into();
    }
    if high < f64::MAX {
        schema["maximum"] = high.into();
    }
    schema
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

fn scheme() -> Value {
    // Names with a number of terms are patterns, all others are completed.
    let (with_terms, plain): (Vec<&str>, Vec<&str>) = Scheme::NAMES.into_iter().partition(|name| name.contains("(N)"));
    let plain: Vec<&str> = ["exact"].into_iter().chain(plain).collect();
    let pattern: Vec<String> = with_terms.iter().map(|name| name.replace("(N)", r"\([0-9]+\)")).collect();
    json!({
        "description": "The exact memory, or a named scheme on the grid of the rows. Default: \"exact\".",
        "anyOf": [one_of(&plain), { "type": "string", "pattern": format!("^({})$", pattern.join("|")) }],
    })
}

pub(super) fn time() -> Value {
    let mut schema = object("Duration and rows.", &time::KEYS, |key| match key {
        "end" => positive("s", "Duration; the motion starts at t = 0."),
        "output_step" => positive("s", "Rows at its multiples, and one at the end."),
        "output_times" => json!({
            "type": "array", "items": not_negative("s", "A time."), "minItems": 1,
            "description": "Rows at these increasing times, s, and nowhere else.",
        }),
        _ => unknown(),
    });
    merge(&mut schema, json!({ "not": { "required": ["output_step", "output_times"] } }));
    schema
}

pub(super) fn solver() -> Value {
    let tolerance = |low: f64, description: &str| {
        let mut schema = quantity("", description);
        merge(&mut schema, json!({ "minimum": low, "maximum": TOLERANCES.1 }));
        schema
    };
    let methods: Vec<&str> = [ADAPTIVE].into_iter().chain(FIXED.map(|method| method.name())).collect();
    object("Accuracy and steps.", &SOLVER_KEYS, |key| match key {
        "rtol" => tolerance(TOLERANCES.0, "Relative error of every D^alpha x; forward: of q and v. Default: 1e-9."),
        "memory_rtol" => tolerance(SMALLEST_MEMORY_RTOL, "Relative error of the memory's kernel. Default: rtol/100."),
        "atol" => positive("", "Absolute error, added to rtol. Default: none; forward: rtol."),
        "first_step" => positive("s", "First inner step."),
        "max_step" => positive("s", "Largest inner step."),
        "max_steps" => {
            json!({ "type": "integer", "minimum": 1, "description": "Most inner steps of one case. Default: 10 000 000, and 100 more for every switch of its signals." })
        }
        "method" => described(one_of(&methods), "forward: how it steps. Default: \"radau\", which chooses its steps."),
        "step" => positive("s", "forward: the step of \"backward-euler\" and \"midpoint\"."),
        _ => unknown(),
    })
}

pub(super) fn sweep() -> Value {
    let end = |which: &str| quantity("the unit of the parameter", &format!("{which} value."));
    let mut span = object("Values from one number to another.", &SPAN_KEYS, |key| match key {
        "from" => end("First"),
        "to" => end("Last"),
        "count" => json!({ "type": "integer", "minimum": 2, "maximum": MAX_CASES, "description": "Number of values." }),
        "scale" => described(one_of(&SCALES), "Equal differences or equal ratios. Default: \"linear\"."),
        _ => unknown(),
    });
    merge(&mut span, json!({ "required": ["from", "to", "count"] }));
    let mut schema = object("Parameters that move together, and their values.", &sweep::KEYS, |key| match key {
        "parameter" => json!({
            "description": "A path such as \"element.NAME.alpha\", or paths that take the same value.",
            "type": ["string", "array"], "items": { "type": "string" }, "minItems": 1, "maxItems": MAX_TOGETHER,
        }),
        "values" => json!({
            "description": "An array of values, or a table with from, to and count.",
            "anyOf": [{ "type": "array", "minItems": 1 }, span],
        }),
        _ => unknown(),
    });
    merge(&mut schema, json!({ "required": sweep::KEYS }));
    schema
}

fn columns(description: &str) -> Value {
    json!({
        "type": ["string", "array"], "items": { "type": "string", "minLength": 1 }, "minItems": 1, "minLength": 1,
        "description": description,
    })
}

pub(super) fn figure() -> Value {
    let mut schema = object("A figure of curves, or of the robot.", &figures::KEYS, |key| match key {
        "name" => json!({
            "type": "string", "pattern": "^[A-Za-z0-9_][A-Za-z0-9_.-]*$", "maxLength": 100,
            "description": "Name of its files without an ending. Default: figure-1, …",
        }),
        "title" => described(text(), "Title."),
        "kind" => described(one_of(&figures::KINDS), "What is drawn. Default: \"curves\"."),
        "x" => json!({ "type": "string", "minLength": 1, "description": "Column of the abscissa. Default: \"t\"." }),
        "y" => columns("A column, a glob such as \"strut.Q.*\", or an array of them."),
        "units" => json!({
            "type": "object", "additionalProperties": { "type": "string" },
            "description": "Units to draw columns in, by column or glob.",
        }),
        "where" => json!({ "type": "object", "description": "Only the cases with these values, by swept path." }),
        _ => unknown(),
    });
    let of_robot = json!({
        "if": { "properties": { "kind": { "const": "robot" } }, "required": ["kind"] },
        "then": { "propertyNames": { "not": { "enum": ["x", "y", "units"] } } },
        "else": { "required": ["y"] },
    });
    merge(&mut schema, of_robot);
    schema
}

pub(super) fn output() -> Value {
    object("What is written.", &OUTPUT_KEYS, |key| match key {
        "columns" => {
            columns("Columns of results.csv and summary.csv: a name, a glob, or an array of them. Default: all.")
        }
        _ => unknown(),
    })
}
