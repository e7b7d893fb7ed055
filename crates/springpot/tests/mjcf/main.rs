//! Robots from MJCF files: their equations of motion beside MuJoCo's, what is listed, what is refused.

mod refusals;

use serde_json::Value;
use springpot::dynamics::{Kinematics, crba, rnea};
use springpot::model::description::{DescriptionOptions, DescriptionWarningKind, RobotDescription};
use std::path::PathBuf;

fn testdata(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/mjcf")).join(name)
}

fn read(name: &str) -> RobotDescription {
    RobotDescription::read(&testdata(name), &DescriptionOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

/// testdata/mjcf/reference.py: mass matrices within 1e-13 of √(M_ii M_jj), bias forces of their largest; springs and dampers.
#[test]
fn equations_of_motion_are_those_of_mujoco() {
    let text = std::fs::read_to_string(testdata("reference.json")).unwrap();
    let reference: Value = serde_json::from_str(&text).unwrap();
    for of in reference["robots"].as_array().unwrap() {
        let robot = read(of["file"].as_str().unwrap());
        let model = robot.model(robot.gravity.unwrap()).unwrap();
        let n = model.nv();
        for state in of["states"].as_array().unwrap() {
            let [q, v, mass, bias] = ["q", "v", "M", "bias"].map(|key| numbers(&state[key]));
            let mut kinematics = Kinematics::new(&model);
            kinematics.update_velocity(&model, &q, &v);
            let found = crba(&model, &kinematics);
            for (at, (own, wanted)) in found.iter().zip(&mass).enumerate() {
                let size = (mass[at / n * (n + 1)] * mass[at % n * (n + 1)]).sqrt();
                assert!((own - wanted).abs() < 1e-13 * size, "{} M {at}: {own} {wanted}", of["file"]);
            }
            let largest = bias.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            let found = rnea(&model, &q, &v, &vec![0.0; n], &[]);
            let off = found.iter().zip(&bias).map(|(own, wanted)| (own - wanted).abs()).fold(0.0, f64::max);
            assert!(off < 1e-13 * largest, "{} bias: {off:e} of {largest}", of["file"]);
        }
        let joints = robot.bodies.iter().map(|body| &body.joint).filter(|joint| joint.kind.nv() == 1);
        for (joint, wanted) in joints.zip(of["springs"].as_array().unwrap()) {
            let [stiffness, damping, slack] = <[f64; 3]>::try_from(numbers(wanted)).unwrap();
            let own = robot.springs.iter().find(|spring| spring.joint == joint.name);
            let near = |own: f64, wanted: f64| (own - wanted).abs() <= 1e-12 * wanted.abs();
            assert!(near(own.map_or(0.0, |spring| spring.stiffness), stiffness), "{}: {own:?}", joint.name);
            assert!(near(joint.damping[0], damping), "{}: {:?}", joint.name, joint.damping);
            assert!(own.is_none_or(|spring| near(spring.slack, slack)), "{}: {own:?} {slack}", joint.name);
        }
    }
}

#[test]
fn names_places_and_looks_are_the_files() {
    let robot = read("arm.xml");
    let model = robot.model([0.0; 3]).unwrap();
    assert_eq!(
        model.joint_names(),
        ["turn", "lift", "upper_arm_joint", "upper_arm_joint_2", "body3_joint", "wrist", "ball", "brick"]
    );
    for name in ["base", "upper_arm", "body3", "hand", "nail", "ball", "world"] {
        assert!(model.find_body(name).is_some(), "{name}");
    }
    let start: Vec<&str> = robot.start.iter().map(|(joint, _)| joint.as_str()).collect();
    assert_eq!(start, ["lift", "upper_arm_joint_2", "ball", "brick"]);
    assert_eq!(robot.start[2].1[..3], [1.0, 0.0, 0.4]);
    let limits = |name: &str| model.limits(model.joint_index(name).unwrap());
    assert_eq!((limits("lift").upper, limits("turn").upper), (120f64.to_radians(), f64::INFINITY));
    // A capsule is three shapes, what is in group 4 and the ground are none.
    let count = |name: &str| {
        let index = robot.bodies.iter().position(|body| body.name == name).unwrap();
        robot.visuals[index].len()
    };
    assert_eq!(["base", "upper_arm", "hand", "nail", "ball"].map(count), [2, 4, 1, 1, 2]);
    assert!(robot.root.visuals.is_empty());
    let kinds: Vec<(DescriptionWarningKind, String)> =
        robot.warnings.iter().map(|warning| (warning.kind, warning.to_string())).collect();
    assert_eq!(kinds.len(), 1, "{kinds:?}");
    assert!(kinds[0].1.contains("<actuator>") && kinds[0].1.contains("<light>"), "{kinds:?}");
    assert_eq!(read("bounds.xml").model([0.0; 3]).unwrap().joint_names()[..2], ["body1_joint", "body1_joint_2"]);
}
