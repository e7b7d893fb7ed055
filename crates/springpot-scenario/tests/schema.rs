//! The JSON schema of scenario files: it takes every file that is shown or shipped, and refuses what the reader
//! refuses.

use regex::Regex;
use serde_json::{Map, Value, json};
use springpot::law::Catalog;
use springpot_scenario::{Scenario, json_schema};
use std::fs;
use toml::de::{DeTable, DeValue};

/// A TOML document as JSON.
fn document(text: &str) -> Value {
    table(DeTable::parse(text).unwrap().get_ref())
}

fn table(table: &DeTable<'_>) -> Value {
    let entries = table.iter().map(|(key, value)| (key.get_ref().to_string(), json(value.get_ref())));
    Value::Object(entries.collect::<Map<String, Value>>())
}

fn json(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::from(text.as_ref()),
        DeValue::Integer(number) => number.as_str().parse::<i64>().unwrap().into(),
        DeValue::Float(number) => number.as_str().parse::<f64>().unwrap().into(),
        DeValue::Boolean(value) => (*value).into(),
        DeValue::Array(items) => items.iter().map(|item| json(item.get_ref())).collect(),
        DeValue::Table(entries) => table(entries),
        DeValue::Datetime(_) => panic!("no scenario holds a date"),
    }
}

/// JSON Schema draft 7, as far as the schema uses it; another keyword is an error of the test.
struct Validator {
    root: Value,
}

impl Validator {
    fn new() -> Self {
        Self { root: json_schema(&Catalog::standard()) }
    }

    /// Where and why a value is refused.
    fn errors(&self, value: &Value) -> Vec<String> {
        let mut errors = Vec::new();
        self.check(&self.root, value, "", &mut errors);
        errors
    }

    fn takes(&self, schema: &Value, value: &Value) -> bool {
        let mut errors = Vec::new();
        self.check(schema, value, "", &mut errors);
        errors.is_empty()
    }

    fn check(&self, schema: &Value, value: &Value, at: &str, errors: &mut Vec<String>) {
        let Some(rules) = schema.as_object() else {
            assert_eq!(schema, &Value::Bool(true), "{at}");
            return;
        };
        for (keyword, rule) in rules {
            let holds = match keyword.as_str() {
                "$schema" | "title" | "description" | "definitions" | "then" | "else" => true,
                "$ref" => {
                    let pointer = rule.as_str().unwrap().strip_prefix('#').unwrap();
                    self.check(self.root.pointer(pointer).unwrap(), value, at, errors);
                    true
                }
                "type" => match rule {
                    Value::Array(types) => types.iter().any(|name| is_of(value, name.as_str().unwrap())),
                    name => is_of(value, name.as_str().unwrap()),
                },
                "enum" => rule.as_array().unwrap().contains(value),
                "const" => rule == value,
                "pattern" => {
                    value.as_str().is_none_or(|text| Regex::new(rule.as_str().unwrap()).unwrap().is_match(text))
                }
                "minimum" => value.as_f64().is_none_or(|number| number >= rule.as_f64().unwrap()),
                "maximum" => value.as_f64().is_none_or(|number| number <= rule.as_f64().unwrap()),
                "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > rule.as_f64().unwrap()),
                "minLength" => value.as_str().is_none_or(|text| text.chars().count() as u64 >= rule.as_u64().unwrap()),
                "maxLength" => value.as_str().is_none_or(|text| text.chars().count() as u64 <= rule.as_u64().unwrap()),
                "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= rule.as_u64().unwrap()),
                "maxItems" => value.as_array().is_none_or(|items| items.len() as u64 <= rule.as_u64().unwrap()),
                "items" => {
                    for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                        self.check(rule, item, &format!("{at}/{k}"), errors);
                    }
                    true
                }
                "properties" => {
                    for (key, rule) in rule.as_object().unwrap() {
                        if let Some(value) = value.get(key) {
                            self.check(rule, value, &format!("{at}/{key}"), errors);
                        }
                    }
                    true
                }
                "additionalProperties" => {
                    let known = |key: &str| rules.get("properties").is_some_and(|known| known.get(key).is_some());
                    for (key, value) in value.as_object().into_iter().flatten().filter(|(key, _)| !known(key)) {
                        match rule {
                            Value::Bool(false) => errors.push(format!("{at}/{key}: unknown key")),
                            rule => self.check(rule, value, &format!("{at}/{key}"), errors),
                        }
                    }
                    true
                }
                "propertyNames" => {
                    let mut keys = value.as_object().into_iter().flatten().map(|(key, _)| key);
                    keys.all(|key| self.takes(rule, &Value::from(key.as_str())))
                }
                "required" => {
                    let missing = |key: &Value| value.is_object() && value.get(key.as_str().unwrap()).is_none();
                    !rule.as_array().unwrap().iter().any(missing)
                }
                "dependencies" => {
                    let met = |(key, needs): (&String, &Value)| {
                        let has = |need: &Value| value.get(need.as_str().unwrap()).is_some();
                        let is_met =
                            || needs.as_array().map_or_else(|| self.takes(needs, value), |needs| needs.iter().all(has));
                        value.get(key).is_none() || is_met()
                    };
                    rule.as_object().unwrap().iter().all(met)
                }
                "allOf" => {
                    rule.as_array().unwrap().iter().for_each(|rule| self.check(rule, value, at, errors));
                    true
                }
                "anyOf" => rule.as_array().unwrap().iter().any(|rule| self.takes(rule, value)),
                "oneOf" => rule.as_array().unwrap().iter().filter(|rule| self.takes(rule, value)).count() == 1,
                "not" => !self.takes(rule, value),
                "if" => {
                    let branch = if self.takes(rule, value) { "then" } else { "else" };
                    if let Some(rule) = rules.get(branch) {
                        self.check(rule, value, at, errors);
                    }
                    true
                }
                other => panic!("keyword {other}"),
            };
            if !holds {
                errors.push(format!("{at}: {keyword} {rule}"));
            }
        }
    }
}

fn is_of(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("type {other}"),
    }
}

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Every scenario that is shipped.
fn scenarios() -> Vec<(String, String)> {
    let files = fs::read_dir(format!("{ROOT}/scenarios")).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.map(|path| (path.display().to_string(), fs::read_to_string(path).unwrap())).collect()
}

#[test]
fn every_scenario_is_taken() {
    let validator = Validator::new();
    let mut texts = scenarios();
    let starter = "crates/springpot-cli/src/scenario/init/starter.toml";
    texts.push((starter.to_owned(), fs::read_to_string(format!("{ROOT}/{starter}")).unwrap()));
    for document in ["README.md", "docs/SCENARIO.md"] {
        let text = fs::read_to_string(format!("{ROOT}/{document}")).unwrap();
        let blocks = text.split("\n```toml\n").skip(1).map(|rest| rest.split("\n```").next().unwrap().to_owned());
        texts.extend(blocks.map(|block| (document.to_owned(), block)));
    }
    for (name, text) in &texts {
        let errors = validator.errors(&document(text));
        assert!(errors.is_empty(), "{name}: {errors:#?}");
    }
    assert!(texts.len() >= 17, "{}", texts.len());

    // Parts of scenarios are taken too, but for what they leave out; a sweep lets them.
    let pages = fs::read_dir(format!("{ROOT}/docs/scenario")).unwrap().map(|entry| entry.unwrap().path());
    let text: String = pages.map(|path| fs::read_to_string(path).unwrap()).collect();
    let mut parts = 0;
    for part in text.split("\n```toml part\n").skip(1).map(|rest| rest.split("\n```").next().unwrap()) {
        let mut part = document(part);
        part.as_object_mut().unwrap().entry("sweep").or_insert_with(|| json!([]));
        assert_eq!(validator.errors(&part), Vec::<String>::new(), "{part:#}");
        parts += 1;
    }
    assert!(parts >= 20, "{parts}");
}

/// Every place of a document that holds a table.
fn tables(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(entries) => {
            found.push(at.to_owned());
            entries.iter().for_each(|(key, value)| tables(value, &format!("{at}/{}", key.replace('/', "~1")), found));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, item)| tables(item, &format!("{at}/{k}"), found));
        }
        _ => {}
    }
}

#[test]
fn a_key_that_does_not_exist_is_refused_wherever_it_stands() {
    let validator = Validator::new();
    let mut tried = 0;
    for (name, text) in scenarios() {
        let whole = document(&text);
        let mut places = Vec::new();
        tables(&whole, "", &mut places);
        // The keys of these are names and paths of the scenario's own.
        let own = |place: &String| {
            let mut keys = place.rsplit('/');
            let last = keys.next().unwrap_or_default();
            let of_controllers = ["kp", "kd", "ki", "lambda", "mu", "limits", "rate_limits", "to"];
            ["constants", "joints", "torque", "prescribed", "guess", "units", "where", "set"].contains(&last)
                || place.contains("/controller/") && of_controllers.contains(&last)
                || ["q", "v"].contains(&last) && keys.next() == Some("start")
                || place.strip_suffix("/parameters").is_some_and(|element| {
                    whole.pointer(element).is_some_and(|element| element.get("network").is_some())
                })
        };
        for place in places.iter().filter(|place| !own(place)) {
            let mut wrong = whole.clone();
            let table = wrong.pointer_mut(place).unwrap().as_object_mut().unwrap();
            table.insert("misspelt".to_owned(), 1.into());
            assert!(!validator.errors(&wrong).is_empty(), "{name}: misspelt key in {place}");
            tried += 1;
        }
    }
    assert!(tried > 200, "{tried}");
}

const ARM: &str = r#"
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
mass = "1 kg"
com = [0.2, 0, 0]
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, "-30 cm"] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "42 cm"
law = "magnetorheological"
parameters = { E_c = 1, mu_0 = "50 N*s^alpha/m", mu = 0, alpha = 0.4 }
inputs = { u = "1 + step(t - 2)" }
[motion]
kind = "prescribed"
joints = { q1 = "0.5*sin(2*pi*t)" }
[time]
end = "5 s"
output_step = "5 ms"
"#;

#[test]
fn schema_and_reader_agree() {
    let validator = Validator::new();
    assert_eq!(validator.errors(&document(ARM)), Vec::<String>::new());
    Scenario::parse(ARM, "arm.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
    let mut tried = 0;
    for (right, wrong) in [
        ("joint = {", "joints = {"),
        ("axis = [0, 1, 0]", "axis = [0, 1]"),
        ("axis = [0, 1, 0]", "axs = [0, 1, 0]"),
        ("kind = \"revolute\", axis = [0, 1, 0]", "kind = \"revolute\""),
        ("kind = \"revolute\"", "kind = \"hinge\""),
        ("kind = \"revolute\"", "kind = \"floating\""),
        ("mass = \"1 kg\"", "mass = -1"),
        ("mass = \"1 kg\"", "mass = \"heavy\""),
        ("mass = \"1 kg\"", "mass = true"),
        ("mass = \"1 kg\"", ""),
        ("name = \"arm\"", "name = \"1st\""),
        ("name = \"strut\"", "name = \"energy\""),
        ("rest_length = \"42 cm\"", "rest_lenght = \"42 cm\""),
        ("law = \"magnetorheological\"", "law = \"magnetoreological\""),
        ("law = \"magnetorheological\"", "law = \"springpot\""),
        ("alpha = 0.4", "alpha = 1.4"),
        ("alpha = 0.4", "alfa = 0.4"),
        (", alpha = 0.4", ""),
        ("E_c = 1", "E_c = -1"),
        ("inputs = { u =", "inputs = { U ="),
        ("inputs = { u = \"1 + step(t - 2)\" }", ""),
        ("\"1 + step(t - 2)\"", "[1]"),
        ("\"1 + step(t - 2)\"", "{ expresion = \"t\" }"),
        ("\"1 + step(t - 2)\"", "{ csv = \"u.csv\" }"),
        ("kind = \"prescribed\"", "kind = \"prescibed\""),
        ("kind = \"prescribed\"", "kind = \"forward\""),
        ("kind = \"prescribed\"\njoints", "kind = \"gripper-path\"\njoints"),
        ("joints = { q1 = \"0.5*sin(2*pi*t)\" }", ""),
        ("end = \"5 s\"", ""),
        ("end = \"5 s\"", "end = 0"),
        ("output_step = \"5 ms\"", "output_step = \"5 ms\"\noutput_times = [0]"),
        ("output_step = \"5 ms\"", ""),
        ("[time]", "[tim]"),
        ("[time]", "[solver]\nrtol = 1\n[time]"),
        ("[time]", "[solver]\nmethod = \"euler\"\n[time]"),
        ("[time]", "[[figure]]\nx = \"t\"\n[time]"),
        ("[time]", "[[figure]]\nkind = \"robot\"\ny = \"t\"\n[time]"),
        ("[time]", "[[sweep]]\nparameter = \"element.strut.alpha\"\n[time]"),
        ("[time]", "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = { from = 0, to = 1 }\n[time]"),
        ("[time]", "[output]\ncolums = [\"t\"]\n[time]"),
        ("body = \"world\", point", "bdy = \"world\", point"),
        ("from = { body = \"world\", point = [0, 0, \"-30 cm\"] }", "from = { body = \"world\" }"),
        ("[[element]]", "[robot.gripper]\nbody = \"arm\"\n[[element]]"),
        ("[[robot.body]]", "[robot]\nfloating_base = true\n[[robot.body]]"),
    ] {
        assert!(ARM.contains(right), "{right}");
        let text = ARM.replacen(right, wrong, 1);
        let read = Scenario::parse(&text, "arm.toml", "").unwrap().cases(&Catalog::standard());
        assert!(read.is_err(), "the reader takes {wrong}");
        assert!(!validator.errors(&document(&text)).is_empty(), "the schema takes {wrong}");
        tried += 1;
    }
    assert_eq!(tried, 44);
    // What a sweep brings may be left out.
    let swept = ARM.replace(", alpha = 0.4", "").replace("rest_length = \"42 cm\"\n", "")
        + "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.2, 0.4]\n\
           [[sweep]]\nparameter = \"element.strut.rest_length\"\nvalues = [\"40 cm\"]\n";
    assert_eq!(validator.errors(&document(&swept)), Vec::<String>::new());
    Scenario::parse(&swept, "arm.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
}
