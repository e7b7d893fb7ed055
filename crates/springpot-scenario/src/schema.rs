//! The JSON schema of scenario files, for editors that complete and check them.
//!
//! Keys come from the tables of the readers and laws from the catalog, so that the schema knows what the reader knows.
//! It is weaker than the reader: units, names and physics are checked by `springpot check` alone.

mod motion;
mod parts;
mod robot;
mod whole;

use super::cases::ROOT_KEYS;
use super::sweep::MAX_BLOCKS;
use serde_json::{Map, Value, json};
use springpot::law::Catalog;

/// The schema (JSON Schema draft 7) of scenario files whose laws are those of `catalog`.
///
/// It refuses keys that the reader does not know, values of another type, and, where nothing is swept, the absence of
/// what is required; a sweep may bring what the file leaves out.
///
/// ```
/// use springpot::law::Catalog;
/// let schema = springpot_scenario::json_schema(&Catalog::standard());
/// assert_eq!(schema["properties"]["time"]["properties"]["end"]["exclusiveMinimum"], 0.0);
/// ```
pub fn json_schema(catalog: &Catalog) -> Value {
    let section = |key: &str| match key {
        "title" => described(text(), "Title, shown by check and in run.json."),
        "robot" => robot::section(),
        "element" => array_of("Materials between two points.", parts::element(catalog)),
        "motion" => motion::section(),
        "time" => parts::time(),
        "solver" => parts::solver(),
        "sweep" => {
            let mut schema = array_of("Parameters to vary; several blocks make a grid.", parts::sweep());
            schema["maxItems"] = MAX_BLOCKS.into();
            schema
        }
        "figure" => array_of("Figures to draw.", parts::figure()),
        "output" => parts::output(),
        _ => unknown(),
    };
    let mut schema = object("A Springpot scenario.", &ROOT_KEYS, section);
    let rest = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Springpot scenario",
        "definitions": motion::definitions(),
        "if": { "not": { "required": ["sweep"] } },
        "then": whole::required(catalog),
    });
    merge(&mut schema, rest);
    schema
}

/// What stands for a key that the schema forgot; a test looks for it.
fn unknown() -> Value {
    Value::Bool(true)
}

/// A table with the keys of its reader and no others.
fn object(description: &str, keys: &[&str], property: impl Fn(&str) -> Value) -> Value {
    let properties: Map<String, Value> = keys.iter().map(|key| ((*key).to_owned(), property(key))).collect();
    json!({ "type": "object", "description": description, "properties": properties, "additionalProperties": false })
}

fn array_of(description: &str, items: Value) -> Value {
    json!({ "type": "array", "description": description, "items": items })
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

/// Adds the keys of `more`.
fn merge(schema: &mut Value, more: Value) {
    if let (Value::Object(schema), Value::Object(more)) = (schema, more) {
        schema.extend(more);
    }
}

/// `1 N/m` may stand where `N/m` is the unit; a text that is only a number counts as one.
const QUANTITY: &str = r"^\s*[+\-−]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?(\s*[A-Za-zµμΩ°%(_].*|\s+1.*)?\s*$";

/// A number in `unit`, or a quantity.
fn quantity(unit: &str, description: &str) -> Value {
    let unit = if unit.is_empty() { "a pure number".to_owned() } else { format!("{unit}, or \"NUMBER UNIT\"") };
    json!({ "type": ["number", "string"], "pattern": QUANTITY, "description": format!("{description} In {unit}.") })
}

/// A number above zero, or a quantity.
fn positive(unit: &str, description: &str) -> Value {
    let mut schema = quantity(unit, description);
    schema["exclusiveMinimum"] = 0.0.into();
    schema
}

/// A number of zero and above, or a quantity.
fn not_negative(unit: &str, description: &str) -> Value {
    let mut schema = quantity(unit, description);
    schema["minimum"] = 0.0.into();
    schema
}

/// Three numbers or quantities.
fn vector(unit: &str, description: &str) -> Value {
    let items = quantity(unit, "A component.");
    json!({ "type": "array", "items": items, "minItems": 3, "maxItems": 3, "description": description })
}

/// A function of time in `unit`.
fn signal(unit: &str, description: &str) -> Value {
    let unit = if unit.is_empty() { "a pure number".to_owned() } else { unit.to_owned() };
    let description = format!(
        "{description} A number or quantity in {unit}, an expression of t, or a table with `expression` or `csv`."
    );
    json!({ "description": description, "allOf": [{ "$ref": "#/definitions/signal" }] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls `visit` with the path of every schema of a property.
    fn properties(schema: &Value, path: &str, visit: &mut dyn FnMut(&str, &Value)) {
        match schema {
            Value::Object(map) => {
                for (key, value) in map {
                    if key == "properties" {
                        for (name, property) in value.as_object().unwrap() {
                            visit(&format!("{path}/{name}"), property);
                        }
                    }
                    properties(value, &format!("{path}/{key}"), visit);
                }
            }
            Value::Array(items) => items.iter().for_each(|item| properties(item, path, visit)),
            _ => {}
        }
    }

    #[test]
    fn no_key_of_the_reader_is_forgotten() {
        let mut count = 0;
        let mut schema = json_schema(&Catalog::standard());
        // What is only required is described elsewhere.
        schema.as_object_mut().unwrap().remove("then");
        properties(&schema, "", &mut |path, property| {
            assert_ne!(*property, unknown(), "{path}");
            // Conditions look at a value and describe none.
            let is_condition = path.contains("/if/") || property.get("const").is_some();
            let has_words = property.get("description").and_then(Value::as_str).is_some_and(|text| text.len() > 4);
            assert!(is_condition || has_words || path.contains("/allOf/properties/"), "{path}: {property}");
            count += 1;
        });
        assert!(count > 120, "{count}");
    }
}
