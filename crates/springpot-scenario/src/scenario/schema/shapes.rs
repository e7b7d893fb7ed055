//! A key's shape as a schema.

use crate::keys::{Bound, COMPONENT, Each, FORCES, Key, Keys, Need, POSE, SCALAR, SIGNAL, Shape};
use serde_json::{Map, Value, json};
use springpot::fractional::scheme::Scheme;
use springpot::law::Catalog;
use springpot::model::JointKind;

/// A table with its keys and no others.
pub(super) fn object(description: &str, keys: &Keys, catalog: &Catalog) -> Value {
    let properties: Map<String, Value> =
        keys.keys.iter().map(|key| (key.name.to_owned(), property(key, catalog))).collect();
    let mut schema = json!({
        "type": "object", "description": description, "properties": properties, "additionalProperties": false,
    });
    let written: Vec<&str> =
        keys.keys.iter().filter(|key| matches!(key.need, Need::Written(_))).map(|key| key.name).collect();
    if !written.is_empty() {
        schema["required"] = written.into();
    }
    super::rules::add(&mut schema, keys, catalog);
    schema
}

/// What may stand under a key: its words, its default and, of numbers, their unit are the description.
fn property(key: &Key, catalog: &Catalog) -> Value {
    let kinds = if key.only.is_empty() { String::new() } else { format!("{}: ", key.only.join(", ")) };
    let default = key.default().map_or_else(String::new, |default| {
        let stop = if default.ends_with('…') { "" } else { "." };
        format!(" Default: {default}{stop}")
    });
    let words = format!("{kinds}{}{default}", key.sentence());
    match key.shape {
        Shape::Text => described(text(), &words),
        Shape::Name(reserved) => {
            let mut schema = json!({ "type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_-]*$", "description": words });
            if !reserved.is_empty() {
                schema["not"] = json!({ "enum": reserved });
            }
            schema
        }
        Shape::FileName => json!({
            "type": "string", "pattern": "^[A-Za-z0-9_][A-Za-z0-9_.-]*$", "maxLength": 100, "description": words,
        }),
        Shape::Words(_) | Shape::Kinds(_) => described(one_of(&key.choices()), &words),
        Shape::WordsOr(_, keys) => {
            json!({ "description": words, "anyOf": [one_of(&key.choices()), object(keys.words, keys, catalog)] })
        }
        Shape::Flag => json!({ "type": "boolean", "description": words }),
        Shape::Number(unit, bound) => bounded(quantity(unit, &words), bound),
        Shape::NumberOrWord(unit, bound, word) => {
            let number = bounded(quantity(unit, "A number."), bound);
            json!({ "description": words, "anyOf": [number, { "const": word }] })
        }
        Shape::JointNumber(units, bound) => joint_number(units, bound, &words),
        Shape::JointNumbers(units, bound) => {
            let number = joint_number(units, bound, "A number.");
            json!({ "description": words, "anyOf": [number, by_part(&number)] })
        }
        Shape::JointNumberOrWord(units, bound, word) => {
            let number = joint_number(units, bound, "A number.");
            json!({ "description": words, "anyOf": [number, { "const": word }] })
        }
        Shape::JointNumberOr(units, bound, keys) => {
            let force = keys.keys.first().map_or(words.as_str(), |key| key.words);
            let table = object(keys.words, keys, catalog);
            let number = joint_number(units, bound, force);
            let each = by_part(&json!({ "anyOf": [number, table] }));
            json!({ "description": words, "anyOf": [number, table, each] })
        }
        Shape::Whole(low, high) => {
            let or_scalar = json!([{ "anyOf": [{ "type": "integer" }, { "$ref": "#/definitions/scalar" }] }]);
            let mut schema = json!({ "allOf": or_scalar, "minimum": low, "description": words });
            if let Some(high) = high {
                schema["maximum"] = high.into();
            }
            schema
        }
        Shape::Vector(unit) => several(3, unit, &words),
        Shape::Pair(unit) => several(2, unit, &words),
        Shape::Range => several(2, "the unit that is drawn", &words),
        Shape::NumbersOr(unit, keys) => {
            let items = bounded(quantity(unit, "A number."), Bound::NotNegative);
            let array = json!({ "type": "array", "items": items, "minItems": 1 });
            json!({ "description": words, "anyOf": [array, object(keys.words, keys, catalog)] })
        }
        Shape::SweptNumber => quantity("the unit of the parameter", &words),
        Shape::SweptNumbers(least, most) => {
            let one = quantity("the unit of the parameter", "A value.");
            let several = json!({ "type": "array", "items": one, "minItems": least, "maxItems": most });
            match least {
                1 => json!({ "description": words, "anyOf": [one, several] }),
                _ => json!({ "description": words, "allOf": [several] }),
            }
        }
        Shape::OfColumn => quantity("the unit of the column", &words),
        Shape::Signal(unit) => signal(unit, &words),
        Shape::Signals(unit) => {
            let items = signal(unit, "A component.");
            json!({ "type": "array", "items": items, "minItems": 3, "maxItems": 3, "description": words })
        }
        Shape::Texts => json!({ "type": ["string", "array"], "items": text(), "description": words }),
        Shape::Paths(most) => json!({
            "type": ["string", "array"], "items": text(), "minItems": 1, "maxItems": most, "description": words,
        }),
        Shape::TextList => json!({ "type": "array", "items": text(), "description": words }),
        Shape::Column => json!({ "type": "string", "minLength": 1, "description": words }),
        Shape::Columns => json!({
            "type": ["string", "array"], "items": { "type": "string", "minLength": 1 }, "minItems": 1, "minLength": 1,
            "description": words,
        }),
        Shape::Table(keys) if std::ptr::eq(keys, &COMPONENT) => {
            json!({ "description": words, "allOf": [{ "$ref": "#/definitions/component" }] })
        }
        Shape::Table(keys) => object(&words, keys, catalog),
        Shape::TableOrTables(keys) => {
            let table = object(keys.words, keys, catalog);
            let tables = json!({ "type": "array", "items": table, "minItems": 1 });
            json!({ "description": words, "anyOf": [table, tables] })
        }
        Shape::Tables(keys, most) => {
            let items = object(keys.words, keys, catalog);
            let mut schema = json!({ "type": "array", "items": items, "description": words });
            if let Some(most) = most {
                schema["maxItems"] = most.into();
            }
            schema
        }
        Shape::ValuesOr(keys) => {
            let table = object(keys.words, keys, catalog);
            json!({ "description": words, "anyOf": [{ "type": "array", "minItems": 1 }, table] })
        }
        Shape::ByJoint(each) => {
            let each = match each {
                Each::Path => json!({ "$ref": "#/definitions/path" }),
                Each::Force => json!({ "$ref": "#/definitions/force" }),
                Each::Number => or_by_part(&json!({ "$ref": "#/definitions/quantity" })),
                Each::Coordinate => or_by_part(&joint_number(["rad", "m"], Bound::Any, "Coordinate.")),
                Each::NumberOr(keys) => {
                    let number = json!({ "$ref": "#/definitions/quantity" });
                    json!({ "anyOf": [number, object(keys.words, keys, catalog), by_part(&number)] })
                }
            };
            json!({ "type": "object", "additionalProperties": each, "description": words })
        }
        Shape::ByJointOrNumber => {
            let number = json!({ "$ref": "#/definitions/quantity" });
            let table = json!({ "type": "object", "additionalProperties": or_by_part(&number) });
            json!({ "description": words, "anyOf": [number, table] })
        }
        Shape::TableWithJoints(keys) => {
            let mut schema = object(&words, keys, catalog);
            schema["additionalProperties"] = json!({ "$ref": "#/definitions/path" });
            // Kinds with keys of their own have no joints beside them.
            let kinds = keys.get("kind").map(Key::choices).unwrap_or_default().into_iter();
            let with_keys = kinds.filter(|kind| keys.keys.iter().any(|key| key.only.contains(kind)));
            let rules = with_keys.map(|kind| {
                super::rules::where_kind(&[kind], json!({ "propertyNames": { "enum": keys.names_for(kind) } }))
            });
            schema["allOf"] = rules.collect();
            schema
        }
        Shape::Scalars => {
            json!({ "type": "object", "additionalProperties": { "$ref": "#/definitions/quantity" }, "description": words })
        }
        Shape::UnitOrByName => {
            json!({ "type": ["string", "object"], "additionalProperties": text(), "description": words })
        }
        Shape::WordList(_) => json!({
            "type": "array", "items": one_of(&key.choices()), "minItems": 1, "description": words,
        }),
        Shape::TextOrFalse => json!({ "anyOf": [text(), { "const": false }], "description": words }),
        Shape::TextsByNameOrFalse => json!({
            "anyOf": [{ "type": "object", "additionalProperties": text() }, { "const": false }], "description": words,
        }),
        Shape::TextsByName => json!({ "type": "object", "additionalProperties": text(), "description": words }),
        Shape::ColumnsByName(keys) => {
            let one = json!({ "anyOf": [text(), object(keys.words, keys, catalog)] });
            json!({ "type": "object", "additionalProperties": one, "description": words })
        }
        Shape::ByName => json!({ "type": "object", "description": words }),
        Shape::Law => {
            let laws: Vec<&str> = catalog.entries().iter().map(|law| &*law.name).collect();
            described(one_of(&laws), &words)
        }
        Shape::Scheme => described(scheme(), &words),
    }
}

/// What several places share: signals, how a joint moves, what its actuator gives.
pub(super) fn definitions(catalog: &Catalog) -> Value {
    let or_table = |keys: &Keys| {
        let table = object(keys.words, keys, catalog);
        let signal = json!({ "$ref": "#/definitions/signal" });
        json!({ "anyOf": [signal, table, by_part(&signal)] })
    };
    let table = object(SIGNAL.words, &SIGNAL, catalog);
    json!({
        "signal": { "anyOf": [{ "type": "number" }, { "type": "string", "minLength": 1 }, table] },
        "quantity": {
            "anyOf": [{ "type": "number" }, { "type": "string", "pattern": QUANTITY }, { "$ref": "#/definitions/scalar" }],
        },
        "component": object(COMPONENT.words, &COMPONENT, catalog),
        "scalar": object(SCALAR.words, &SCALAR, catalog),
        "path": or_table(&POSE),
        "force": or_table(&FORCES),
    })
}

/// One for each coordinate of a joint of several.
fn by_part(each: &Value) -> Value {
    let numbers = JointKind::ALL.into_iter().flat_map(JointKind::numbers).map(|(name, _)| name);
    let rates = JointKind::ALL.into_iter().flat_map(JointKind::rates);
    let mut names: Vec<&str> = numbers.chain(rates).filter(|name| !name.is_empty()).collect();
    names.sort_unstable();
    names.dedup();
    json!({ "type": "object", "additionalProperties": each, "propertyNames": { "enum": names } })
}

fn or_by_part(each: &Value) -> Value {
    json!({ "anyOf": [each, by_part(each)] })
}

fn scheme() -> Value {
    // Names with a number of terms are patterns, all others are completed.
    let (with_terms, plain): (Vec<&str>, Vec<&str>) = Scheme::NAMES.into_iter().partition(|name| name.contains("(N)"));
    let plain: Vec<&str> = ["exact"].into_iter().chain(plain).collect();
    let pattern: Vec<String> = with_terms.iter().map(|name| name.replace("(N)", r"\([0-9]+\)")).collect();
    json!({ "anyOf": [one_of(&plain), { "type": "string", "pattern": format!("^({})$", pattern.join("|")) }] })
}

fn described(mut schema: Value, description: &str) -> Value {
    schema["description"] = description.into();
    schema
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn one_of(names: &[&str]) -> Value {
    json!({ "type": "string", "enum": names })
}

/// `1 N/m` may stand where `N/m` is the unit; a text that is only a number counts as one.
const QUANTITY: &str = r"^\s*[+\-−]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?(\s*[A-Za-zµμΩ°%(_].*|\s+1.*)?\s*$";

/// A number in `unit`, or a quantity.
pub(super) fn quantity(unit: &str, description: &str) -> Value {
    let unit = if unit.is_empty() { "a pure number".to_owned() } else { format!("{unit}, or \"NUMBER UNIT\"") };
    let quantity = json!([{ "$ref": "#/definitions/quantity" }]);
    json!({ "allOf": quantity, "description": format!("{description} In {unit}.") })
}

fn bounded(mut schema: Value, bound: Bound) -> Value {
    match bound {
        Bound::Any => {}
        Bound::NotNegative | Bound::Length => schema["minimum"] = 0.0.into(),
        Bound::Positive => schema["exclusiveMinimum"] = 0.0.into(),
        Bound::Within(low, high, _) => {
            schema["minimum"] = low.into();
            schema["maximum"] = high.into();
        }
    }
    schema
}

fn joint_number([turning, sliding]: [&str; 2], bound: Bound, description: &str) -> Value {
    bounded(quantity(&format!("{turning} (prismatic: {sliding})"), description), bound)
}

/// So many numbers or quantities.
fn several(count: usize, unit: &str, description: &str) -> Value {
    let items = quantity(unit, "A component.");
    let description = if unit.is_empty() { description.to_owned() } else { format!("{description} In {unit}.") };
    json!({ "type": "array", "items": items, "minItems": count, "maxItems": count, "description": description })
}

/// A function of time in `unit`.
pub(super) fn signal(unit: &str, description: &str) -> Value {
    let unit = if unit.is_empty() { "a pure number".to_owned() } else { unit.to_owned() };
    let description = format!(
        "{description} A number or quantity in {unit}, an expression of t, or a table with `expression` or `csv`."
    );
    json!({ "description": description, "allOf": [{ "$ref": "#/definitions/signal" }] })
}
