//! Joints of all kinds: against MuJoCo, against chains of two or three joints, and what is refused of them.

use crate::support::{GRAVITY, close, config, largest};
use proptest::prelude::*;
use serde_json::Value;
use springpot::dynamics::{
    Kinematics, aba, aba_derivatives, coriolis, crba, gravity, kinetic_energy, nonlinear_effects, potential_energy,
    rnea, rnea_derivatives,
};
use springpot::model::{BodySpec, Field, JointKind, JointSpec, Mimic, Model, ModelBuilder, ModelError, Parent};
use springpot::spatial::Rotation;
use std::f64::consts::TAU;

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|k| value[k].as_f64().unwrap())
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// Rows of a matrix, one after another.
fn flat(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().flat_map(list).collect()
}

#[test]
fn mixed_trees_with_rotors_are_those_of_mujoco() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/multibody/joints.json");
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut compared = 0;
    for tree in file["trees"].as_array().unwrap() {
        let mut builder = ModelBuilder::new(numbers(&file["gravity"]));
        for (k, body) in tree["bodies"].as_array().unwrap().iter().enumerate() {
            let joint = JointSpec {
                kind: JointKind::named(body["kind"].as_str().unwrap()).unwrap(),
                axis2: numbers(&body["axis2"]),
                rpy: numbers(&body["rpy"]),
                armature: numbers(&body["armature"]),
                ..JointSpec::revolute(format!("j{k}"), numbers(&body["axis"]), numbers(&body["origin"]))
            };
            let inertia = std::array::from_fn(|row| numbers(&body["inertia"][row]));
            let spec = BodySpec {
                name: format!("b{k}"),
                parent: body["parent"].as_u64().map_or(Parent::World, |parent| Parent::Body(parent as usize)),
                joint,
                mass: body["mass"].as_f64().unwrap(),
                com: numbers(&body["com"]),
                inertia,
            };
            builder.push(spec).unwrap();
        }
        let model = builder.finish().unwrap();
        for state in tree["states"].as_array().unwrap() {
            let [q, v, tau, bias, a] = ["q", "v", "tau", "bias", "a"].map(|key| list(&state[key]));
            let kinematics = Kinematics::at_velocity(&model, &q, &v);
            let mass = flat(&state["mass"]);
            close("M", &crba(&model, &kinematics), &mass, 1e-13, largest(&mass));
            close("C v + g", &nonlinear_effects(&model, &q, &v, &[]), &bias, 1e-13, largest(&bias).max(10.0));
            close("a", &aba(&model, &q, &v, &tau, &[]), &a, 1e-12, largest(&a));
            close("tau", &rnea(&model, &q, &v, &a, &[]), &tau, 1e-11, largest(&bias).max(largest(&tau)));
            let [potential, kinetic] = numbers(&state["energy"]);
            close("T", &[kinetic_energy(&model, &kinematics)], &[kinetic], 1e-13, kinetic);
            close("V", &[potential_energy(&model, &kinematics)], &[potential], 1e-13, potential.abs().max(10.0));
            compared += 1;
        }
    }
    assert_eq!(compared, 16);
}

fn body(name: &str, parent: Parent, joint: JointSpec) -> BodySpec {
    let inertia = [[0.3, 0.02, -0.01], [0.02, 0.35, 0.04], [-0.01, 0.04, 0.4]];
    BodySpec { name: name.into(), parent, joint, mass: 1.7, com: [0.2, -0.1, 0.3], inertia }
}

/// A body without mass, to carry the next joint of a chain.
fn carrier(name: &str, joint: JointSpec) -> BodySpec {
    BodySpec { mass: 0.0, com: [0.0; 3], inertia: [[0.0; 3]; 3], ..body(name, Parent::Body(0), joint) }
}

fn build(bodies: Vec<BodySpec>) -> Model {
    let mut builder = ModelBuilder::new(GRAVITY);
    for body in bodies {
        builder.push(body).unwrap();
    }
    builder.finish().unwrap()
}

/// Everything that the algorithms say of a model in a state.
fn everything(model: &Model, [q, v, a]: [&[f64]; 3]) -> Vec<(&'static str, Vec<f64>)> {
    let kinematics = Kinematics::at_velocity(model, q, v);
    let slopes = rnea_derivatives(model, q, v, a, &[]);
    let forward = aba_derivatives(model, q, v, a, &[]);
    vec![
        ("M", crba(model, &kinematics)),
        ("C", coriolis(model, &kinematics)),
        ("g", gravity(model, &kinematics)),
        ("tau", rnea(model, q, v, a, &[])),
        ("a", aba(model, q, v, a, &[])),
        ("dtau/dq", slopes.d_q),
        ("dtau/dv", slopes.d_v),
        ("da/dq", forward.d_q),
        ("da/dtau", forward.d_tau),
        ("T", vec![kinetic_energy(model, &kinematics)]),
        ("V", vec![potential_energy(model, &kinematics)]),
    ]
}

const RPY: [f64; 3] = [0.4, -1.1, 2.0];
const ORIGIN: [f64; 3] = [0.3, -0.2, 0.5];

/// A joint between a swinging arm and a wheel, and the same as a chain of joints.
fn between(joint: JointSpec, chain: Vec<JointSpec>) -> [Model; 2] {
    let arm = || body("arm", Parent::World, JointSpec::revolute("arm", [0.2, 1.0, -0.3], [0.1, 0.0, 0.4]));
    let wheel =
        |on: usize| body("wheel", Parent::Body(on), JointSpec::revolute("wheel", [1.0, 0.5, 0.0], [0.2, 0.3, 0.0]));
    let placed = |joint: JointSpec| JointSpec { rpy: RPY, origin: ORIGIN, ..joint };
    let one = build(vec![arm(), body("load", Parent::Body(0), placed(joint)), wheel(1)]);
    let mut bodies = vec![arm()];
    let count = chain.len();
    for (k, joint) in chain.into_iter().enumerate() {
        let joint = if k == 0 { placed(joint) } else { joint };
        let spec = if k + 1 == count { body("load", Parent::Body(k), joint) } else { carrier(&format!("c{k}"), joint) };
        bodies.push(BodySpec { parent: Parent::Body(k), ..spec });
    }
    bodies.push(wheel(count));
    [one, build(bodies)]
}

fn same(name: &str, [one, chain]: &[Model; 2], seed: f64) {
    assert_eq!((one.nq(), one.nv()), (chain.nq(), chain.nv()), "{name}");
    let n = one.nv();
    let [q, v, a] =
        [0.1, 0.7, 1.9].map(|phase| (0..n).map(|k| 2.0 * (seed + phase + 1.3 * k as f64).sin()).collect::<Vec<_>>());
    let (left, right) = (everything(one, [&q, &v, &a]), everything(chain, [&q, &v, &a]));
    for ((what, left), (_, right)) in left.iter().zip(&right) {
        close(&format!("{name} {what}"), left, right, 1e-12, largest(right).max(1.0));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..config(0x5eed_0029) })]

    #[test]
    fn joints_are_chains_of_their_coordinates(seed in -3.0..3.0f64) {
        let none = [0.0; 3];
        let (axis, axis2) = ([0.3, -0.5, 0.8], [1.0, 0.2, 0.1]);
        let lead = 0.35;
        // A screw is a turn, and a shift that follows it.
        let follows = Mimic { joint: "turn".into(), multiplier: lead / TAU, offset: 0.0 };
        let advance = JointSpec { mimic: Some(follows), ..JointSpec::prismatic("advance", axis, none) };
        let helical = JointSpec::helical("h", axis, lead, none);
        same("helical", &between(helical, vec![JointSpec::revolute("turn", axis, none), advance]), seed);
        let chain = vec![JointSpec::prismatic("z", axis, none), JointSpec::revolute("rz", axis, none)];
        same("cylindrical", &between(JointSpec::cylindrical("c", axis, none), chain), seed);
        let chain = vec![JointSpec::revolute("first", axis, none), JointSpec::revolute("second", axis2, none)];
        same("universal", &between(JointSpec::universal("u", [axis, axis2], none), chain), seed);
        for normal in [[0.0, 0.0, 1.0], axis, [0.4, 0.1, -2.0], [0.0, 0.0, -3.0]] {
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            let turned = Rotation::shortest_from_z(springpot::spatial::Vec3(normal.map(|x| x / length)));
            let [x, y] = [0, 1].map(|k| turned.column(k).0);
            let chain = vec![
                JointSpec::prismatic("x", x, none),
                JointSpec::prismatic("y", y, none),
                JointSpec::revolute("rz", normal, none),
            ];
            same("planar", &between(JointSpec::planar("p", normal, none), chain), seed);
        }
    }
}

#[test]
fn the_names_of_coordinates_and_velocities() {
    let joints = [
        JointSpec::cylindrical("c", [0.0, 0.0, 1.0], [0.0; 3]),
        JointSpec::universal("u", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.0; 3]),
        JointSpec::planar("p", [0.0, 0.0, 1.0], [0.0; 3]),
        JointSpec::helical("h", [0.0, 0.0, 1.0], 0.01, [0.0; 3]),
        JointSpec::spherical("s", [0.0; 3]),
    ];
    let model =
        build(joints.into_iter().enumerate().map(|(k, joint)| body(&format!("b{k}"), Parent::World, joint)).collect());
    let names =
        |labels: Vec<springpot::model::Label>| labels.into_iter().map(|label| label.name).collect::<Vec<_>>().join(" ");
    assert_eq!(names(model.q_labels()), "c.z c.rz u.first u.second p.x p.y p.rz h s.qx s.qy s.qz s.qw");
    assert_eq!(names(model.v_labels()), "c.vz c.wz u.first u.second p.vx p.vy p.wz h s.wx s.wy s.wz");
    let ranges: Vec<_> =
        model.described_joints().iter().map(|joint| (joint.name.as_str(), joint.joints.clone())).collect();
    assert_eq!(ranges, [("c", 0..2), ("u", 2..4), ("p", 4..7), ("h", 7..8), ("s", 8..9)]);
    assert!(model.has_joint("c") && model.has_joint("c.rz") && !model.has_joint("c.x"));
    assert_eq!((model.nq(), model.nv(), model.is_one_degree()), (12, 11, false));
}

#[test]
fn what_is_refused_of_joints() {
    let refused = |joint: JointSpec| {
        let mut builder = ModelBuilder::new(GRAVITY);
        let error = builder.push(body("load", Parent::World, joint)).unwrap_err();
        (error.to_string(), error.subject().unwrap().field)
    };
    let (z, none) = ([0.0, 0.0, 1.0], [0.0; 3]);
    let (said, field) = refused(JointSpec::helical("h", z, 0.0, none));
    assert!(said.contains("the lead of joint \"h\" is 0") && field == Field::Lead, "{said}");
    let (said, field) = refused(JointSpec::helical("h", z, f64::NAN, none));
    assert!(said.contains("joint.lead of body \"load\" holds NaN") && field == Field::Lead, "{said}");
    for axis2 in [[0.0, 0.0, 3.0], [0.0, 0.0, -1.0], [0.0, 1e-9, 1.0]] {
        let (said, field) = refused(JointSpec::universal("u", [z, axis2], none));
        assert!(said.contains("the axis2 of joint \"u\" is parallel to its axis") && field == Field::Axis2, "{said}");
    }
    let (said, field) = refused(JointSpec::universal("u", [z, none], none));
    assert!(said.contains("the axis2 of joint \"u\" is [0, 0, 0]") && field == Field::Axis2, "{said}");
    let (said, field) = refused(JointSpec { armature: [-1.0; 3], ..JointSpec::revolute("r", z, none) });
    assert!(
        said.contains("joint.armature of body \"load\" is -1; it must be 0 or more") && field == Field::Armature,
        "{said}"
    );
    let mut ends = JointSpec::revolute("r", z, none);
    (ends.limits[0].lower, ends.limits[0].upper) = (1.0, 0.5);
    let (said, field) = refused(ends);
    assert!(said.contains("lower = 1 and upper = 0.5") && field == Field::Lower, "{said}");
    let mut slow = JointSpec::revolute("r", z, none);
    slow.limits[0].velocity = 0.0;
    let (said, field) = refused(slow);
    assert!(
        said.contains("the velocity of joint \"r\" is 0; it must be positive") && field == Field::Velocity,
        "{said}"
    );
}

#[test]
fn followers_follow_one_coordinate() {
    let z = [0.0, 0.0, 1.0];
    let with = |follower: JointSpec, leader: &str| {
        let mut builder = ModelBuilder::new(GRAVITY);
        builder.push(body("a", Parent::World, JointSpec::cylindrical("c", z, [0.0; 3]))).unwrap();
        let mimic = Some(Mimic { joint: leader.into(), multiplier: 2.0, offset: 0.1 });
        builder.push(body("b", Parent::World, JointSpec { mimic, ..follower })).unwrap();
        builder.finish()
    };
    let model = with(JointSpec::revolute("r", z, [0.0; 3]), "c.rz").unwrap();
    assert_eq!((model.nq(), model.followed(2)), (2, Some((1, 2.0, 0.1))));
    let whole = with(JointSpec::revolute("r", z, [0.0; 3]), "c").unwrap_err();
    assert!(matches!(whole, ModelError::MimicTarget { exists: true, .. }), "{whole}");
    let none = with(JointSpec::revolute("r", z, [0.0; 3]), "d").unwrap_err();
    assert!(matches!(none, ModelError::MimicTarget { exists: false, .. }), "{none}");
    let several = with(JointSpec::universal("u", [z, [1.0, 0.0, 0.0]], [0.0; 3]), "c.rz").unwrap_err();
    assert!(several.to_string().contains("joint \"u\" is universal, so it cannot follow another joint"), "{several}");
}

/// A rotor is felt at its own coordinate alone; a joint with one may carry nothing else.
#[test]
fn rotors() {
    let z = [0.0, 0.0, 1.0];
    let pendulum = |armature: f64, ratio: Option<f64>| {
        let mut bodies = vec![body("a", Parent::World, JointSpec::revolute("q", [0.0, 1.0, 0.0], [0.0; 3]))];
        let mimic = ratio.map(|multiplier| Mimic { joint: "q".into(), multiplier, offset: 0.0 });
        let joint = JointSpec { armature: [armature; 3], mimic, ..JointSpec::revolute("rotor", z, [0.1, 0.0, 0.0]) };
        bodies.push(BodySpec { parent: Parent::Body(0), ..carrier("rotor", joint) });
        let mut builder = ModelBuilder::new(GRAVITY);
        for body in bodies {
            builder.push(body).unwrap();
        }
        builder.finish()
    };
    assert!(matches!(pendulum(0.0, None), Err(ModelError::SingularMassMatrix { .. })));
    let free = pendulum(0.2, None).unwrap();
    let mass = crba(&free, &Kinematics::at_position(&free, &[0.3, 0.4]));
    assert_eq!((mass[1], mass[2], mass[3]), (0.0, 0.0, 0.2));
    assert_eq!(rnea(&free, &[0.3, 0.4], &[1.0, 2.0], &[0.0, 3.0], &[])[1], 0.2 * 3.0);
    // A follower's rotor is felt by the square of its ratio.
    let (led, bare) = (pendulum(0.2, Some(-3.0)).unwrap(), pendulum(0.0, Some(-3.0)).unwrap());
    let of = |model: &Model| crba(model, &Kinematics::at_position(model, &[0.3]))[0];
    close("M", &[of(&led) - of(&bare)], &[0.2 * 9.0], 1e-14, 2.0);
}
