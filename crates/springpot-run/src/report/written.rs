//! Records as a reader wants them.

use crate::numbers::short;
use serde_json::Value;

/// Longest value that is shown whole, characters.
const LONGEST: usize = 2_000;
/// Rows of a table of keys.
const MOST_ROWS: usize = 400;

/// Keys with dots and their values; what is not set is left out.
pub(super) fn flat(value: &Value) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    visit(value, &mut String::new(), &mut |path, value| {
        if !value.is_null() && rows.len() < MOST_ROWS {
            rows.push(vec![path.to_owned(), plain(value)]);
        }
    });
    rows
}

/// Calls `take` with the path of every value that is no table; lists of tables are taken apart by the names in them.
pub(super) fn visit(value: &Value, path: &mut String, take: &mut dyn FnMut(&str, &Value)) {
    let inside = |path: &mut String, key: &str, value: &Value, take: &mut dyn FnMut(&str, &Value)| {
        let length = path.len();
        if length > 0 {
            path.push('.');
        }
        path.push_str(key);
        visit(value, path, take);
        path.truncate(length);
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| inside(path, key, value, take)),
        Value::Array(list) if list.iter().any(Value::is_object) => {
            for (at, value) in list.iter().enumerate() {
                let key = value.get("name").and_then(Value::as_str).map_or_else(|| at.to_string(), str::to_owned);
                inside(path, &key, value, take);
            }
        }
        value => take(path, value),
    }
}

/// A value without quotes; numbers with six digits, lists in brackets.
pub(super) fn plain(value: &Value) -> String {
    let text = match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), short),
        Value::Bool(true) => "yes".to_owned(),
        Value::Bool(false) => "no".to_owned(),
        Value::Array(list) => format!("[{}]", list.iter().map(plain).collect::<Vec<_>>().join(", ")),
        Value::Null => "–".to_owned(),
        object => object.to_string(),
    };
    cut(text)
}

/// A text that is not too long for a table.
pub(super) fn cut(text: String) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text,
    }
}

/// A limit that a joint passes, as run.json lists it.
pub(super) fn limit(value: &Value) -> String {
    let of = |key: &str| plain(&value[key]);
    let others = value["cases"].as_u64().filter(|cases| *cases > 1).map(|cases| format!(", in {cases} cases"));
    format!(
        "{} passes its {} limit of {} {unit} at t = {} s, and is at {} {unit} at t = {} s{}",
        of("joint"),
        of("kind"),
        of("limit"),
        of("first"),
        of("value"),
        of("farthest"),
        others.unwrap_or_default(),
        unit = of("unit"),
    )
}

/// A word as a shell takes it.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn tables_are_taken_apart_by_names() {
        let value = json!({ "a": { "b": 1.5, "none": null }, "list": [{ "name": "x", "k": [1, 2] }, { "k": "text" }] });
        let rows = flat(&value);
        let expected = [["a.b", "1.5"], ["list.x.name", "x"], ["list.x.k", "[1, 2]"], ["list.1.k", "text"]];
        let mut found: Vec<[&str; 2]> = rows.iter().map(|row| [&*row[0], &*row[1]]).collect();
        found.sort_unstable();
        let mut expected = expected.to_vec();
        expected.sort_unstable();
        assert_eq!(found, expected);
    }

    #[test]
    fn limits_are_sentences() {
        let passed = json!({
            "joint": "q1", "kind": "upper", "limit": 1.5, "unit": "rad", "first": 0.25, "farthest": 0.5, "value": 1.75, "case": 0, "cases": 2
        });
        let words = "q1 passes its upper limit of 1.5 rad at t = 0.25 s, and is at 1.75 rad at t = 0.5 s, in 2 cases";
        assert_eq!(limit(&passed), words);
    }

    #[test]
    fn words_of_a_shell_are_whole() {
        assert_eq!(quoted("scenarios/a.toml"), "scenarios/a.toml");
        assert_eq!(quoted("element.e.U=0 V,5 V"), "'element.e.U=0 V,5 V'");
        assert_eq!(quoted("it's $HOME"), "'it'\\''s $HOME'");
        assert_eq!(quoted(""), "''");
    }
}
