//! What a file must hold where no sweep can bring it.

use super::rules::{alternatives, joints, of_elements, required_of, where_kind};
use crate::keys::MOTION;
use crate::keys::{ELEMENT, JOINT, Keys, Need, Shape};
use crate::scenario::root::SCENARIO;
use serde_json::{Map, Value, json};
use springpot::law::heat::INPUT;
use springpot::law::{Catalog, Entry};

/// Required keys alone; types stand elsewhere.
pub(super) fn required(catalog: &Catalog) -> Value {
    of(&SCENARIO, catalog).unwrap_or_default()
}

/// What a table must hold, and the tables in it; `None` where that is nothing.
fn of(keys: &'static Keys, catalog: &Catalog) -> Option<Value> {
    let mut schema = Map::new();
    let must = |need: Need| matches!(need, Need::Written(_)) || need.is_required();
    let names: Vec<&str> =
        keys.keys.iter().filter(|key| key.only.is_empty() && must(key.need)).map(|key| key.name).collect();
    if names.iter().any(|name| keys.get(name).is_some_and(|key| key.need.is_required())) {
        schema.insert("required".to_owned(), names.into());
    }
    let within = keys.keys.iter().filter_map(|key| {
        let schema = match key.shape {
            Shape::Table(keys) => of(keys, catalog)?,
            Shape::Tables(keys, _) => {
                let mut schema = json!({ "items": of(keys, catalog)? });
                if matches!(key.need, Need::OneOf) {
                    schema["minItems"] = 1.into();
                }
                schema
            }
            _ => return None,
        };
        Some((key.name.to_owned(), schema))
    });
    let within: Map<String, Value> = within.collect();
    if !within.is_empty() {
        schema.insert("properties".to_owned(), within.into());
    }
    if std::ptr::eq(keys, &MOTION) {
        let kinds = MOTION.get("kind").map(|kind| kind.choices()).unwrap_or_default();
        let one = any_of(&MOTION);
        let of_kind = |kind: &str| match required_of(&MOTION, kind)[..] {
            [] if MOTION.of(kind).any(|key| matches!(key.need, Need::OneOf)) => Some(where_kind(&[kind], one.clone())),
            [] => None,
            ref needed => Some(where_kind(&[kind], json!({ "required": needed }))),
        };
        schema.insert("allOf".to_owned(), kinds.into_iter().filter_map(of_kind).collect());
    } else if std::ptr::eq(keys, &ELEMENT) {
        let one = any_of(&ELEMENT);
        let of_kind = |kind: &str| {
            let mut rule = json!({ "required": required_of(&ELEMENT, kind) });
            if ELEMENT.of(kind).any(|key| matches!(key.need, Need::OneOf)) {
                rule["anyOf"] = one["anyOf"].clone();
            }
            rule
        };
        let laws = catalog.entries().iter().flat_map(|law| of_law(law));
        schema.insert("allOf".to_owned(), laws.chain([of_elements(of_kind)]).collect());
    } else if let Value::Object(one) = any_of(keys) {
        schema.extend(one);
    }
    if std::ptr::eq(keys, &JOINT) {
        let needed = joints().into_iter().map(|(of, kinds)| (kinds, required_of(&JOINT, of)));
        let needed = needed.filter(|(_, needed)| !needed.is_empty());
        let rules = needed.map(|(kinds, needed)| where_kind(&kinds, json!({ "required": needed })));
        schema.insert("allOf".to_owned(), rules.collect());
    }
    (!schema.is_empty()).then_some(Value::Object(schema))
}

/// One of the alternatives of a table; nothing where there are none.
fn any_of(keys: &'static Keys) -> Value {
    match &alternatives(keys)[..] {
        [] => Value::Null,
        names => json!({ "anyOf": names.iter().map(|name| json!({ "required": [name] })).collect::<Vec<_>>() }),
    }
}

/// The parameters and inputs that a law cannot do without.
fn of_law(law: &Entry) -> Vec<Value> {
    let takes = law.inputs.iter().any(|input| input.name == INPUT);
    // A temperature of its own is no input.
    let kinds: &[bool] = if takes { &[false, true] } else { &[false] };
    kinds.iter().filter_map(|is_thermal| needed_by(law, takes, *is_thermal)).collect()
}

fn needed_by(law: &Entry, takes: bool, is_thermal: bool) -> Option<Value> {
    let params: Vec<&str> =
        law.params.iter().filter(|p| p.default.is_none() && !p.is_list).map(|param| &*param.name).collect();
    let inputs = law.inputs.iter().map(|input| &*input.name).filter(|name| !is_thermal || *name != INPUT);
    let inputs: Vec<&str> = inputs.collect();
    let tables = [("parameters", params), ("inputs", inputs)];
    let needed: Vec<_> = tables.into_iter().filter(|(_, names)| !names.is_empty()).collect();
    let sections: Vec<&str> = needed.iter().map(|(section, _)| *section).collect();
    let within: Map<String, Value> =
        needed.iter().map(|(section, names)| ((*section).to_owned(), json!({ "required": names }))).collect();
    (!sections.is_empty()).then(|| {
        let mut rule = json!({
            "if": { "properties": { "law": { "const": law.name } }, "required": ["law"] },
            "then": { "required": sections, "properties": within },
        });
        let thermal = json!({ "required": ["thermal"] });
        if takes {
            rule["if"]["allOf"] = json!([if is_thermal { thermal } else { json!({ "not": thermal }) }]);
        }
        rule
    })
}
