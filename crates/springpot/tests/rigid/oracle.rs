//! The metric tensor, Christoffel symbols, gravity forces and pair of the reference file, whole.

use serde_json::Value;
use springpot::dynamics::{Kinematics, christoffel, crba, gravity, pair, rnea};
use springpot::model::{Anchor, BodySpec, JointSpec, ModelBuilder, Parent};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/papers/metric_and_christoffel.json");

/// A number, or the decimal text of one.
fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.parse().ok()).expect("a number")
}

fn numbers(value: &Value) -> Vec<f64> {
    match value.as_array() {
        Some(items) => items.iter().flat_map(numbers).collect(),
        None => vec![number(value)],
    }
}

fn vector(value: &Value) -> [f64; 3] {
    numbers(value).try_into().expect("three numbers")
}

/// Compares to 1e-12 of the largest reference value and returns how many numbers were compared.
fn compare(what: &str, computed: &[f64], reference: &Value) -> usize {
    let reference = numbers(reference);
    assert_eq!(computed.len(), reference.len(), "{what}");
    let largest = reference.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for (c, r) in computed.iter().zip(&reference) {
        assert!((c - r).abs() <= 1e-12 * largest, "{what}: {c} instead of {r}");
    }
    reference.len()
}

#[test]
fn reference_state() {
    let file: Value = serde_json::from_str(&std::fs::read_to_string(FILE).unwrap()).unwrap();
    let mut compared = 0;
    for (name, state) in file.as_object().unwrap().iter().filter(|(name, _)| *name != "meta") {
        let spec = &state["spec"];
        let mut builder = ModelBuilder::new(vector(&spec["gravity"]));
        let (mut parent, mut origin) = (Parent::World, vector(&spec["rho_00"]));
        for (k, body) in spec["bodies"].as_array().unwrap().iter().enumerate() {
            let joint = if number(&body["xi"]) == 0.0 { JointSpec::revolute } else { JointSpec::prismatic };
            let inertia = body["J"].as_array().unwrap();
            let index = builder
                .push(BodySpec {
                    name: format!("body{k}"),
                    parent,
                    joint: joint(format!("q{k}"), vector(&body["e"]), origin),
                    mass: number(&body["m"]),
                    com: vector(&body["rho_i"]),
                    inertia: [vector(&inertia[0]), vector(&inertia[1]), vector(&inertia[2])],
                })
                .unwrap();
            (parent, origin) = (Parent::Body(index), vector(&body["rho_ii"]));
        }
        let model = builder.finish().unwrap();
        let (q, v, a) = (numbers(&state["q"]), numbers(&state["qd"]), numbers(&state["qdd"]));
        let kinematics = Kinematics::at_velocity(&model, &q, &v);

        compared += compare(name, &crba(&model, &kinematics), &state["a"]);
        compared += compare(name, &christoffel(&model, &kinematics), &state["Gamma"]);
        let q_gravity: Vec<f64> = gravity(&model, &kinematics).iter().map(|g| -g).collect();
        compared += compare(name, &q_gravity, &state["Qg"]);
        compared += compare(name, &rnea(&model, &q, &v, &a, &[]), &state["lhs_minus_Qg"]);

        let element = &spec["element"];
        let site = |body: &str, point: &str| {
            // Bodies are numbered from 1, the base is 0.
            let body = match number(&element[body]) as usize {
                0 => Parent::World,
                number => Parent::Body(number - 1),
            };
            model.resolve(&Anchor { body, point: vector(&element[point]) }).unwrap()
        };
        let (pair, gradient) = pair(&model, &kinematics, &site("body_i", "D_i"), &site("body_j", "D_j"));
        compared += compare(name, &[pair.length], &state["l"]);
        compared += compare(name, &gradient, &state["dl"]);
        assert_eq!(gradient[0], 0.0, "joint 1 carries both ends");
    }
    assert_eq!(compared, 9 + 27 + 3 + 3 + 1 + 3);
}
