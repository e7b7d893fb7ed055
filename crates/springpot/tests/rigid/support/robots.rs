//! The robots of `testdata/multibody`, built from the joints listed there.

use serde_json::Value;
use springpot::model::{Anchor, BodySpec, Frame, JointKind, JointSpec, Mimic, Model, ModelBuilder, Parent, Site};
use springpot::spatial::Rotation;

/// Names of the files, and how many states each holds.
pub(crate) const ROBOTS: [(&str, usize); 8] = [
    ("double_pendulum", 5),
    ("ur5", 5),
    ("panda", 5),
    ("panda_mimic", 3),
    ("simple_humanoid", 5),
    ("simple_humanoid_ff", 2),
    ("solo12_ff", 3),
    ("anymal_b_ff", 3),
];

/// A robot of the reference files, with its named frame and its states.
pub(crate) struct Robot {
    pub(crate) model: Model,
    pub(crate) end: Frame,
    pub(crate) end_site: Site,
    pub(crate) states: Vec<Value>,
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    match value.as_array() {
        Some(items) => items.iter().flat_map(numbers).collect(),
        None => vec![value.as_f64().expect("a number")],
    }
}

fn vector(value: &Value) -> [f64; 3] {
    numbers(value).try_into().expect("three numbers")
}

fn matrix(value: &Value) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|k| vector(&value[k]))
}

/// Roll, pitch and yaw of a rotation matrix, checked by building it again.
fn rpy(r: [[f64; 3]; 3]) -> [f64; 3] {
    let angles = [r[2][1].atan2(r[2][2]), (-r[2][0]).atan2(r[0][0].hypot(r[1][0])), r[1][0].atan2(r[0][0])];
    for (built, given) in Rotation::from_rpy(angles).0.as_flattened().iter().zip(r.as_flattened()) {
        assert!((built - given).abs() < 4e-16, "{built} instead of {given}");
    }
    angles
}

pub(crate) fn load(name: &str) -> Robot {
    let path = format!("{}/../../testdata/multibody/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let described = &file["model"];
    let mut builder = ModelBuilder::new(vector(&described["gravity"]));
    for (k, joint) in described["joints"].as_array().unwrap().iter().enumerate() {
        let kind = match joint["type"].as_str() {
            Some("R") => JointKind::Revolute,
            Some("P") => JointKind::Prismatic,
            Some("FF") => JointKind::Floating,
            other => panic!("{other:?}"),
        };
        let axis = if kind == JointKind::Floating { [0.0; 3] } else { vector(&joint["axis"]) };
        let plain = JointSpec::revolute(joint["name"].as_str().unwrap(), axis, vector(&joint["placement_p"]));
        let mimic = joint["mimic"].as_object().map(|mimic| Mimic {
            joint: mimic["joint"].as_str().unwrap().into(),
            multiplier: mimic["multiplier"].as_f64().unwrap(),
            offset: mimic["offset"].as_f64().unwrap(),
        });
        builder
            .push(BodySpec {
                name: format!("body{k}"),
                parent: joint["parent"].as_u64().map_or(Parent::World, |p| Parent::Body(p as usize)),
                joint: JointSpec { kind, rpy: rpy(matrix(&joint["placement_R"])), mimic, ..plain },
                mass: joint["mass"].as_f64().unwrap(),
                com: vector(&joint["com"]),
                inertia: matrix(&joint["inertia_com"]),
            })
            .unwrap();
    }
    let end = &described["ee"];
    let origin = vector(&end["p"]);
    let body = end["joint"].as_u64().unwrap() as usize;
    let end_body = builder
        .push(BodySpec {
            name: "end".into(),
            parent: Parent::Body(body),
            joint: JointSpec { rpy: rpy(matrix(&end["R"])), ..JointSpec::fixed("end_joint", origin) },
            mass: 0.0,
            com: [0.0; 3],
            inertia: [[0.0; 3]; 3],
        })
        .unwrap();
    let model = builder.finish().unwrap();
    for (k, joint) in described["joints"].as_array().unwrap().iter().enumerate() {
        let indices = (model.q_range(k).start as u64, model.v_range(k).start as u64);
        assert_eq!((joint["idx_q"].as_u64(), joint["idx_v"].as_u64()), (Some(indices.0), Some(indices.1)), "{name}");
    }
    let end_site = model.resolve(&Anchor { body: Parent::Body(end_body), point: [0.0; 3] }).unwrap();
    let states = file["states"].as_array().unwrap().clone();
    Robot { end: model.frame(Parent::Body(end_body)).unwrap(), end_site, model, states }
}
