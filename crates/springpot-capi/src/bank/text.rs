//! Texts of elements: those of scenarios, or JSON of the same keys.

use crate::status::{Problem, Status};
use serde_json::Value;
use springpot::law::Catalog;
use springpot_scenario::{LoneElement, Scenario, toml_key};

/// What refusals call the text.
const NAME: &str = "elements";

/// Deepest nesting of JSON.
const DEEPEST: usize = 16;

/// The elements of a text with the laws of `catalog`.
pub(super) fn elements(text: &str, catalog: &Catalog) -> Result<Vec<LoneElement>, Problem> {
    let refused = |message: String| Problem::new(Status::Text, message);
    let is_json = text.trim_start().starts_with(['{', '[']) && !is_toml_table(text);
    let toml = match is_json {
        true => Some(toml_of(text).map_err(refused)?),
        false => None,
    };
    let scenario = Scenario::parse(toml.as_deref().unwrap_or(text), NAME, "");
    let read = scenario.and_then(|scenario| scenario.lone_elements(catalog));
    read.map_err(|refusals| match is_json {
        false => refused(refusals.to_string()),
        // Lines and columns are those of another text.
        true => {
            let told = refusals.iter().map(|refusal| match &refusal.help {
                Some(help) => format!("{NAME}: {}\n  help: {help}", refusal.message),
                None => format!("{NAME}: {}", refusal.message),
            });
            refused(told.collect::<Vec<_>>().join("\n"))
        }
    })
}

/// Whether a text begins with the head of a table, `[name]` or `[[name]]`, which no JSON does.
fn is_toml_table(text: &str) -> bool {
    let rest = text.trim_start().trim_start_matches('[').trim_start();
    text.trim_start().starts_with('[') && rest.starts_with(|c: char| c.is_ascii_alphabetic())
}

/// JSON of one element, of a list of them, or of `{ "element": [...] }` as a scenario writes them.
fn toml_of(text: &str) -> Result<String, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| format!("{NAME}: not JSON: {error}"))?;
    let whole = match &value {
        Value::Array(_) => format!("element = {}", written(&value, 0)?),
        Value::Object(fields) => {
            let lines = fields.iter().map(|(key, value)| Ok(format!("{} = {}\n", toml_key(key), written(value, 0)?)));
            lines.collect::<Result<String, String>>()?
        }
        _ => return Err(format!("{NAME}: JSON of an element is an object, of several an array of them")),
    };
    Ok(whole)
}

fn written(value: &Value, depth: usize) -> Result<String, String> {
    if depth > DEEPEST {
        return Err(format!("{NAME}: nested more than {DEEPEST} levels deep"));
    }
    Ok(match value {
        Value::Null => return Err(format!("{NAME}: null is no value; leave the key out")),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => number.to_string(),
        // A text that is a key in quotes, whatever it holds.
        Value::String(text) => quoted(text),
        Value::Array(items) => {
            let items = items.iter().map(|item| written(item, depth + 1)).collect::<Result<Vec<_>, _>>()?;
            format!("[{}]", items.join(", "))
        }
        Value::Object(fields) => {
            let fields =
                fields.iter().map(|(key, value)| Ok(format!("{} = {}", toml_key(key), written(value, depth + 1)?)));
            format!("{{ {} }}", fields.collect::<Result<Vec<_>, String>>()?.join(", "))
        }
    })
}

fn quoted(text: &str) -> String {
    let key = toml_key(text);
    if key.starts_with('"') { key } else { format!("\"{key}\"") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_and_toml_say_the_same() {
        let json = r#"[{ "name": "a\"b", "law": "springpot" }]"#;
        assert_eq!(toml_of(json).unwrap(), r#"element = [{ law = "springpot", name = "a\"b" }]"#);
        let json = r#"[{ "law": "springpot", "parameters": { "c": "50 N*s^alpha/m", "alpha": 0.4 } }]"#;
        let toml = "[[element]]\nlaw = \"springpot\"\nparameters = { c = \"50 N*s^alpha/m\", alpha = 0.4 }";
        let read = |text: &str| elements(text, &Catalog::standard()).unwrap()[0].parameters.clone();
        assert_eq!(read(json), [50.0, 0.4]);
        assert_eq!(read(toml), read(json));
        assert_eq!(read(r#"{ "element": [{ "law": "spring", "parameters": { "k": 1e3 } }] }"#), [1000.0]);
    }

    #[test]
    fn what_is_neither_is_refused() {
        for (text, wanted) in [
            ("{", "elements: not JSON"),
            ("[1, 2]", "elements: "),
            ("[3, null]", "elements: null is no value"),
            ("law = ", "elements:1:"),
            ("", "elements:1:1: there is no element"),
            (r#"{ "law": "sprin", "parameters": { "k": 1 } }"#, "elements: `law` of element \"element1\" is \"sprin\""),
        ] {
            let problem = elements(text, &Catalog::standard()).map(|_| ()).unwrap_err();
            assert!(problem.status == Status::Text && problem.message.starts_with(wanted), "{text}: {problem}");
        }
    }
}
