//! Floating bases: what is conserved, the order of the method, and the same robot on six joints.

use crate::support::forward::{at, distance, every, largest};
use crate::support::{Run, run};
use springpot::dynamics::{Kinematics, crba};
use springpot::model::Model;
use springpot::observe::Quantity;
use springpot::spatial::{Quaternion, Rotation, Vec3};

/// Two bodies with an element between them, the first of which floats; `motion` is the rest of its motion.
fn pair(gravity: &str, motion: &str) -> String {
    format!(
        r#"
[robot]
gravity = {gravity}
[[robot.body]]
name = "hull"
joint = {{ name = "base", kind = "floating" }}
mass = 4
com = [0.05, -0.02, 0.1]
inertia = {{ xx = 0.3, yy = 0.4, zz = 0.5, xy = 0.02, xz = -0.01, yz = 0.03 }}
[[robot.body]]
name = "boom"
joint = {{ name = "hinge", kind = "revolute", axis = [1, 0.3, 0], origin = [0.3, 0, 0] }}
mass = 2
com = [0.1, 0.3, 0]
inertia = {{ xx = 0.05, yy = 0.04, zz = 0.06 }}
[[element]]
name = "e"
from = {{ body = "hull", point = [0, 0.2, 0.3] }}
to = {{ body = "boom", point = [0, 0.5, 0.1] }}
rest_length = 0.4
law = "fractional-kelvin-voigt"
parameters = {{ k = 80, c = 40, alpha = 0.5 }}
[motion]
kind = "forward"
{motion}
"#
    )
}

const SPIN: &str = "start = { q = { base = { x = 0.3, rpy = [0.4, -0.8, 2] }, hinge = 0.2 }, \
                    v = { base = { vx = 0.4, vz = -0.3, wx = 3, wy = 1, wz = -4 }, hinge = 1 } }";

fn model(text: &str) -> Model {
    let plan = crate::support::cases(text).plan(0).unwrap();
    Model::clone(&plan.model)
}

/// Momentum and angular momentum about the world's origin, in the world's axes.
fn momenta(model: &Model, q: &[f64], v: &[f64]) -> [f64; 6] {
    let kinematics = Kinematics::at_velocity(model, q, v);
    let (mass, n) = (crba(model, &kinematics), model.nv());
    let row = |k: usize| (0..n).map(|j| mass[k * n + j] * v[j]).sum::<f64>();
    let turned = |k: usize| {
        Rotation::from_quaternion(Quaternion::new([q[3], q[4], q[5], q[6]])) * Vec3([k, k + 1, k + 2].map(row))
    };
    let (linear, spin) = (turned(0), turned(3));
    let angular = spin + Vec3([q[0], q[1], q[2]]).cross(linear);
    let ([a, b, c], [d, e, f]) = (linear.0, angular.0);
    [a, b, c, d, e, f]
}

fn states(run: &Run, model: &Model) -> Vec<(Vec<f64>, Vec<f64>)> {
    let (nq, nv) = (model.nq(), model.nv());
    let of_row = |k: usize, quantity: fn(usize) -> Quantity, count: usize| -> Vec<f64> {
        (0..count).map(|i| run.table.value(k, quantity(i)).expect("a column")).collect()
    };
    (0..run.table.len()).map(|k| (of_row(k, Quantity::Coordinate, nq), of_row(k, Quantity::Velocity, nv))).collect()
}

#[test]
fn momenta_are_conserved_and_the_attitude_stays_a_unit_quaternion() {
    let text = pair("[0, 0, 0]", SPIN) + &every(10.0, 0.05, 1e-9);
    let (run, model) = (run(&text), model(&text));
    let states = states(&run, &model);
    let start = momenta(&model, &states[0].0, &states[0].1);
    assert!(largest(start) > 1.0);
    let mut worst = 0.0f64;
    for (q, v) in &states {
        worst = worst.max(distance(&start, &momenta(&model, q, v)));
        let norm: f64 = q[3..7].iter().map(|x| x * x).sum();
        assert!((norm - 1.0).abs() < 1e-14, "{norm}");
    }
    println!("momenta drift by {worst:.1e} of {:.1}, {:?}", largest(start), run.report);
    assert!(worst < 3e-8 * largest(start), "{worst:e}");
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
    assert!(largest(run.column("v.hinge")) > 0.5);
}

#[test]
fn a_body_alone_keeps_its_energy_and_a_steady_spin_is_exact() {
    let body = |w: &str| {
        format!(
            "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\njoint = {{ name = \"base\", kind = \"floating\" }}\nmass = 2\n\
             inertia = {{ xx = 0.1, yy = 0.2, zz = 0.25 }}\n[motion]\nkind = \"forward\"\nstart = {{ v = {{ base = {{ vx = 1, {w} }} }} }}\n"
        )
    };
    // About a principal axis: a helix, v turns in the body's axes.
    let steady = run(&(body("wz = 5") + &every(20.0, 0.5, 1e-8)));
    for (k, t) in steady.column("t").into_iter().enumerate() {
        let q = [steady.column("q.base.qz")[k], steady.column("q.base.qw")[k]];
        let (s, c) = (2.5 * t).sin_cos();
        // Both signs of a quaternion mean the same attitude.
        let error = (q[0] * c - q[1] * s).abs();
        let line = (steady.column("q.base.x")[k] - t).abs();
        assert!(error < 1e-12 && line < 3e-6, "t = {t}: {error:e}, {line:e}");
    }
    // About the middle axis: it tumbles, T and |L| stay.
    let tumbling = run(&(body("wx = 1e-3, wy = 5") + &every(20.0, 0.05, 1e-9)));
    let energy = tumbling.column("energy.kinetic");
    assert!(energy.iter().all(|x| (x / energy[0] - 1.0).abs() < 1e-7));
    let w = ["wx", "wy", "wz"].map(|name| tumbling.column(&format!("v.base.{name}")));
    assert!(w[1].iter().any(|w| *w < -4.0), "it turns over");
    let square = |k: usize| (0.1 * w[0][k]).powi(2) + (0.2 * w[1][k]).powi(2) + (0.25 * w[2][k]).powi(2);
    assert!((0..w[0].len()).all(|k| (square(k) / square(0) - 1.0).abs() < 1e-7));
}

#[test]
fn the_order_is_five_with_turning_tangents() {
    let text = pair("[0, 0, -9.81]", SPIN);
    let rows = |rtol: f64| run(&format!("{text}{}", at("2", "0.5, 1, 1.5, 2", rtol)));
    let best = rows(1e-13);
    let mut points = Vec::new();
    for rtol in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
        let run = rows(rtol);
        let states = run.names.iter().filter(|n| n.starts_with("q.") || n.starts_with("v."));
        let error = largest(states.map(|n| distance(&best.column(n), &run.column(n))));
        println!("rtol {rtol:e}: {error:.1e}, {} steps", run.report.steps);
        points.push(((run.report.steps as f64).ln(), error.ln()));
    }
    let (first, last) = (points[0], points[points.len() - 1]);
    let order = (first.1 - last.1) / (last.0 - first.0);
    println!("order {order:.2}");
    assert!(order >= 4.7, "{order}");
}

#[test]
fn a_floating_body_moves_as_on_six_joints() {
    let element = r#"
[robot.gripper]
body = "body"
point = [0.3, 0.2, -0.1]
[[element]]
name = "e"
from = { body = "world", point = [2, 1, 3] }
to = { body = "body", point = [0.2, -0.1, 0.3] }
rest_length = 3.5
law = "fractional-kelvin-voigt"
parameters = { k = 60, c = 30, alpha = 0.4 }
"#;
    let mass = "mass = 3\ncom = [0.05, -0.02, 0.1]\ninertia = { xx = 0.3, yy = 0.4, zz = 0.5, xy = 0.02 }\n";
    let joint = |name: &str, kind: &str, axis: [i32; 3]| {
        format!(
            "[[robot.body]]\nname = \"{name}\"\njoint = {{ name = \"j{name}\", kind = \"{kind}\", axis = {axis:?} }}\n"
        )
    };
    let chain: String = [
        ("x", "prismatic", [1, 0, 0]),
        ("y", "prismatic", [0, 1, 0]),
        ("z", "prismatic", [0, 0, 1]),
        ("yaw", "revolute", [0, 0, 1]),
        ("pitch", "revolute", [0, 1, 0]),
    ]
    .map(|(name, kind, axis)| joint(name, kind, axis) + "mass = 0\n")
    .concat();
    let start = "start = { q = { jx = 0.1, jyaw = 0.5, jpitch = 0.2, jbody = -0.3 } }\n";
    let on_joints =
        format!("{chain}{}{mass}{element}[motion]\nkind = \"forward\"\n{start}", joint("body", "revolute", [1, 0, 0]));
    let floating = format!(
        "[[robot.body]]\nname = \"body\"\njoint = {{ name = \"base\", kind = \"floating\" }}\n{mass}{element}[motion]\nkind = \"forward\"\n\
         start = {{ q = {{ base = {{ x = 0.1, rpy = [-0.3, 0.2, 0.5] }} }} }}\n"
    );
    let rows = every(1.5, 0.01, 1e-10);
    let (a, b) = (run(&(on_joints + &rows)), run(&(floating + &rows)));
    for name in ["gripper.x", "gripper.y", "gripper.z", "e.stroke", "e.rate", "energy.kinetic", "energy.potential"] {
        let error = distance(&a.column(name), &b.column(name));
        println!("{name}: {error:.1e}");
        assert!(error < 1e-7, "{name}: {error:e}");
    }
    assert!(distance(&a.column("e.force"), &b.column("e.force")) < 1e-5);
    assert!(largest(b.column("q.base.qx")) > 0.1);
}
