//! What a file must hold where no sweep can bring it.

use super::super::bodies::INERTIA_KEYS;
use super::super::robot::ANCHOR_KEYS;
use serde_json::{Value, json};
use springpot::law::{Catalog, Entry};
use springpot::model::JointKind;

/// Required keys alone; types stand elsewhere.
pub(super) fn required(catalog: &Catalog) -> Value {
    let moving: Vec<&str> = JointKind::ALL.into_iter().filter(|kind| kind.has_axis()).map(JointKind::name).collect();
    let joint = json!({
        "required": ["name", "kind"],
        "allOf": [{
            "if": { "properties": { "kind": { "enum": moving } }, "required": ["kind"] },
            "then": { "required": ["axis"] },
        }],
    });
    let body = json!({
        "required": ["name", "joint", "mass"],
        "properties": { "joint": joint, "inertia": { "required": &INERTIA_KEYS[..3] } },
    });
    let anchor = json!({ "required": ANCHOR_KEYS });
    let laws: Vec<Value> = catalog.entries().iter().filter_map(of_law).collect();
    let element = json!({
        "required": ["name", "from", "to", "rest_length", "law"],
        "properties": { "from": anchor, "to": anchor },
        "allOf": laws,
    });
    let of_motion = |kind: &str, needs: Value| json!({ "if": { "properties": { "kind": { "const": kind } }, "required": ["kind"] }, "then": needs });
    json!({
        "required": ["robot", "motion", "time"],
        "properties": {
            "robot": {
                "anyOf": [{ "required": ["urdf"] }, { "required": ["body"] }],
                "properties": { "body": { "items": body, "minItems": 1 }, "gripper": anchor },
            },
            "element": { "items": element },
            "motion": {
                "required": ["kind"],
                "allOf": [
                    of_motion("prescribed", json!({ "anyOf": [{ "required": ["joints"] }, { "required": ["csv"] }] })),
                    of_motion("gripper-path", json!({ "required": ["x", "y", "z"] })),
                ],
            },
            "time": {
                "required": ["end"],
                "anyOf": [{ "required": ["output_step"] }, { "required": ["output_times"] }],
            },
        },
    })
}

/// The parameters and inputs that a law cannot do without.
fn of_law(law: &Entry) -> Option<Value> {
    let params: Vec<&str> = law.params.iter().filter(|p| p.default.is_none()).map(|param| param.name).collect();
    let inputs: Vec<&str> = law.inputs.iter().map(|input| input.name).collect();
    let tables = [("parameters", params), ("inputs", inputs)];
    let needed: Vec<_> = tables.into_iter().filter(|(_, names)| !names.is_empty()).collect();
    let sections: Vec<&str> = needed.iter().map(|(section, _)| *section).collect();
    let within: serde_json::Map<String, Value> =
        needed.iter().map(|(section, names)| ((*section).to_owned(), json!({ "required": names }))).collect();
    (!sections.is_empty()).then(|| {
        json!({
            "if": { "properties": { "law": { "const": law.name } }, "required": ["law"] },
            "then": { "required": sections, "properties": within },
        })
    })
}
