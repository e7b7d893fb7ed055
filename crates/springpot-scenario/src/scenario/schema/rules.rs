//! What keys have to do with one another.

use super::shapes::{quantity, signal};
use crate::elements::material::TABLE;
use crate::figures::FIGURE;
use crate::keys::MOTION;
use crate::keys::{
    BETWEEN, BUSHING, COMPONENT, ELEMENT, FROM_MJCF, FROM_URDF, JOINT, Key, Keys, Need, ON_JOINT, ROBOT, SHIFT, SIGNAL,
    TIME,
};
use serde_json::{Map, Value, json};
use springpot::law::heat::INPUT;
use springpot::law::{Catalog, Entry, Input, Param, Range};
use springpot::model::JointKind;

/// Adds the rules of the tables that have some.
pub(super) fn add(schema: &mut Value, keys: &Keys, catalog: &Catalog) {
    let is = |table: &Keys| std::ptr::eq(keys, table);
    let rules = if is(&ROBOT) {
        of_robot()
    } else if is(&JOINT) {
        of_joint()
    } else if is(&ELEMENT) {
        let kinds = of_elements(|kind| json!({ "propertyNames": { "enum": ELEMENT.names_for(kind) } }));
        json!({ "allOf": laws(catalog).chain([kinds]).collect::<Vec<_>>() })
    } else if is(&COMPONENT) {
        json!({ "allOf": laws(catalog).collect::<Vec<_>>() })
    } else if is(&MOTION) {
        of_motion()
    } else if is(&TIME) {
        json!({ "not": { "required": alternatives(&TIME) } })
    } else if is(&SIGNAL) {
        json!({
            "oneOf": alternatives(&SIGNAL).iter().map(|key| json!({ "required": [key] })).collect::<Vec<_>>(),
            "dependencies": { "csv": ["column"], "column": ["csv"] },
        })
    } else if is(&FIGURE) {
        by_kind(&FIGURE)
    } else if is(&SHIFT) {
        by_kind(&SHIFT)
    } else {
        return;
    };
    if let (Value::Object(schema), Value::Object(rules)) = (schema, rules) {
        schema.extend(rules);
    }
}

/// The parameters and inputs of every law.
fn laws(catalog: &Catalog) -> impl Iterator<Item = Value> {
    catalog.entries().iter().map(|law| of_law(law)).chain([of_networks(), of_temperature()])
}

/// Networks have no input but the temperature.
fn of_networks() -> Value {
    let inputs = json!({
        "description": "Inputs of a network: the temperature, under heat.",
        "properties": { INPUT: temperature() },
        "additionalProperties": false,
    });
    json!({ "if": { "required": ["network"] }, "then": { "properties": { "inputs": inputs } } })
}

/// A temperature of its own is no input.
fn of_temperature() -> Value {
    let told = json!({ "required": ["thermal", "inputs"], "properties": { "inputs": { "required": [INPUT] } } });
    json!({ "if": told, "then": false })
}

/// The input that an element under heat has.
fn temperature() -> Value {
    signal("K", "Temperature.")
}

/// What holds for each kind of element.
pub(super) fn of_elements(rule: impl Fn(&str) -> Value) -> Value {
    json!({
        "if": { "required": ["joint"] },
        "then": rule(ON_JOINT),
        "else": { "if": { "required": ["bushing"] }, "then": rule(BUSHING), "else": rule(BETWEEN) },
    })
}

/// Keys of which one must be there.
pub(super) fn alternatives(keys: &'static Keys) -> Vec<&'static str> {
    keys.keys.iter().filter(|key| matches!(key.need, Need::OneOf)).map(|key| key.name).collect()
}

/// What must be there of the keys that belong to `kind` alone.
pub(super) fn required_of(keys: &'static Keys, kind: &str) -> Vec<&'static str> {
    let required = |key: &&&Key| !key.only.is_empty() && key.need.is_required();
    keys.of(kind).collect::<Vec<_>>().iter().filter(required).map(|key| key.name).collect()
}

/// `then` where `kind` is one of `kinds`.
pub(super) fn where_kind(kinds: &[&str], then: Value) -> Value {
    let kinds = if let [only] = kinds { json!({ "const": only }) } else { json!({ "enum": kinds }) };
    json!({ "if": { "properties": { "kind": kinds }, "required": ["kind"] }, "then": then })
}

fn of_robot() -> Value {
    let files = [(FROM_URDF, "urdf"), (FROM_MJCF, "mjcf")];
    let of_files = ROBOT.keys.iter().filter(|key| !key.only.is_empty());
    let needs = of_files.map(|key| {
        let of =
            files.iter().filter(|(kind, _)| key.only.contains(kind)).map(|(_, file)| json!({ "required": [file] }));
        (key.name.to_owned(), json!({ "anyOf": of.collect::<Vec<_>>() }))
    });
    let needs: Map<String, Value> = needs.collect();
    let all = alternatives(&ROBOT);
    let pairs = all.iter().enumerate().flat_map(|(k, one)| all[k + 1..].iter().map(move |other| [one, other]));
    let pairs: Vec<Value> = pairs.map(|pair| json!({ "required": pair })).collect();
    json!({ "dependencies": needs, "not": { "anyOf": pairs } })
}

/// The kinds of joint that take the same keys, by the first of them.
pub(super) fn joints() -> Vec<(&'static str, Vec<&'static str>)> {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    for kind in JointKind::ALL.map(JointKind::name) {
        let of = JOINT.names_for(kind);
        match groups.iter_mut().find(|(group, _)| JOINT.names_for(group) == of) {
            Some((_, kinds)) => kinds.push(kind),
            None => groups.push((kind, vec![kind])),
        }
    }
    groups
}

fn of_joint() -> Value {
    let some = |of: &str| JOINT.names_for(of).len() < JOINT.keys.len();
    let rules = joints()
        .into_iter()
        .filter(|(of, _)| some(of))
        .map(|(of, kinds)| where_kind(&kinds, json!({ "propertyNames": { "enum": JOINT.names_for(of) } })));
    json!({ "allOf": rules.collect::<Vec<_>>() })
}

fn of_motion() -> Value {
    let kinds = MOTION.get("kind").map(Key::choices).unwrap_or_default();
    let of_kind = |kind: &&str| where_kind(&[kind], json!({ "propertyNames": { "enum": MOTION.names_for(kind) } }));
    let not_both = json!({ "not": { "required": alternatives(&MOTION) } });
    json!({ "allOf": kinds.iter().map(of_kind).chain([not_both]).collect::<Vec<_>>() })
}

/// Which keys may and which must stand beside each kind; where `kind` is left out, the rules of what stands for it hold.
fn by_kind(keys: &'static Keys) -> Value {
    let rule = |kind: &str| {
        let mut rule = Map::new();
        let others: Vec<&str> = keys.not_of(kind).map(|key| key.name).collect();
        if !others.is_empty() {
            rule.insert("propertyNames".to_owned(), json!({ "not": { "enum": others } }));
        }
        let required = required_of(keys, kind);
        if !required.is_empty() {
            rule.insert("required".to_owned(), required.into());
        }
        Value::Object(rule)
    };
    let row = keys.get("kind");
    let default = match row.map(|key| key.need) {
        Some(Need::Word(word)) => word,
        _ => "",
    };
    let written = row.map(Key::choices).unwrap_or_default().into_iter().filter(|kind| *kind != default);
    written.rev().fold(rule(default), |otherwise, kind| {
        let mut rule = where_kind(&[kind], rule(kind));
        rule["else"] = otherwise;
        rule
    })
}

/// A law's own parameters and inputs.
fn of_law(law: &Entry) -> Value {
    let table = |what: &str, properties: Map<String, Value>| {
        let description = format!("{what} of {}: {}", law.name, law.equation);
        json!({ "type": "object", "description": description, "properties": properties, "additionalProperties": false })
    };
    let params = law.params.iter().map(|param| (param.name.to_string(), parameter(param)));
    let params = params.chain(law.has_lists().then(|| (TABLE.to_owned(), columns(law))));
    let inputs = law.inputs.iter().map(|Input { name, unit, meaning, .. }| {
        let schema = signal(unit, &format!("{}.", capitalised(meaning)));
        (name.to_string(), schema)
    });
    let inputs: Map<String, Value> = inputs.collect();
    let mut told = inputs.clone();
    told.entry(INPUT.to_owned()).or_insert_with(temperature);
    let with = |inputs| json!({ "properties": { "inputs": table("Inputs", inputs) } });
    json!({
        "if": { "properties": { "law": { "const": law.name } }, "required": ["law"] },
        "then": {
            "properties": { "parameters": table("Parameters", params.collect()) },
            "if": { "anyOf": [{ "required": ["shift"] }, { "required": ["expansion"] }] },
            "then": with(told),
            "else": with(inputs),
        },
    })
}

fn parameter(Param { unit, meaning, range, default, is_list, .. }: &Param) -> Value {
    let mut description = format!("{}.", capitalised(meaning));
    if let Some(default) = default {
        description.push_str(&format!(" Default: {default}{}{unit}.", if unit.is_empty() { "" } else { " " }));
    }
    let mut schema = quantity(unit, &description);
    let Range { low, high } = *range;
    if low > f64::MIN {
        schema["minimum"] = low.into();
    }
    if high < f64::MAX {
        schema["maximum"] = high.into();
    }
    if *is_list {
        return json!({ "type": "array", "items": schema, "minItems": 1, "description": description });
    }
    schema
}

/// The file that has the lists of a law as columns.
fn columns(law: &Entry) -> Value {
    let lists = law.params.iter().filter(|param| param.is_list);
    let lists = lists.map(|param| (param.name.to_string(), format!("Name of the column of the {}.", param.meaning)));
    let file = ("csv".to_owned(), "Name of the file, relative to the scenario.".to_owned());
    let keys: Vec<(String, String)> = [file].into_iter().chain(lists).collect();
    let text = |words: &String| json!({ "type": "string", "description": words });
    let properties: Map<String, Value> = keys.iter().map(|(name, words)| (name.clone(), text(words))).collect();
    let required: Vec<&String> = keys.iter().map(|(name, _)| name).collect();
    json!({
        "type": "object", "description": "A CSV file and the names of its columns, SI.", "properties": properties,
        "required": required, "additionalProperties": false,
    })
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}
