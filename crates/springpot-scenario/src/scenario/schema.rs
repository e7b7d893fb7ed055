//! The JSON schema of scenario files, for editors that complete and check them.
//!
//! Keys come from the one table of keys and laws from the catalog, so that the schema knows what the reader knows.
//! It is weaker than the reader: units, names and physics are checked by `springpot check` alone.

mod required;
mod rules;
mod shapes;

use super::root::SCENARIO;
use crate::keys::{CREEP, DMA, RELAXATION, STROKE};
use serde_json::{Value, json};
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
    let mut schema = shapes::object(SCENARIO.words, &SCENARIO, catalog);
    // Measurements of elements alone take neither robot nor motion.
    let of_element =
        json!({ "required": ["kind"], "properties": { "kind": { "enum": [STROKE, DMA, RELAXATION, CREEP] } } });
    let of_elements = json!({ "required": ["data"], "properties": { "data": { "items": of_element } } });
    let rest = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Springpot scenario",
        "definitions": shapes::definitions(catalog),
        "if": { "not": { "anyOf": [{ "required": ["sweep"] }, of_elements] } },
        "then": required::required(catalog),
    });
    if let (Value::Object(schema), Value::Object(rest)) = (&mut schema, rest) {
        schema.extend(rest);
    }
    schema
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
    fn every_key_is_described() {
        let mut count = 0;
        let mut schema = json_schema(&Catalog::standard());
        // What is only required is described elsewhere.
        schema.as_object_mut().unwrap().remove("then");
        properties(&schema, "", &mut |path, property| {
            // Conditions look at a value and describe none.
            let is_condition = path.contains("/if/") || property.get("const").is_some();
            let has_words = property.get("description").and_then(Value::as_str).is_some_and(|text| text.len() > 4);
            assert!(is_condition || has_words || path.contains("/allOf/properties/"), "{path}: {property}");
            count += 1;
        });
        assert!(count > 120, "{count}");
    }
}
