//! What laws of control say of their derivatives, against differences of their forces.

use crate::support::cases;
use springpot::control::{
    Aim, At, ComputedTorque, Controller, ControllerNumber, Impedance, PdGravity, Pid, RobotChange, Scratch, Shaping,
    TorqueSlopes,
};
use springpot::dynamics::Kinematics;
use springpot::system::System;
use std::sync::Arc;

fn robot(masses: [f64; 2], gravity: f64) -> System {
    let text = format!(
        r#"
[robot]
gravity = [0.4, 0, {gravity:?}]
gripper = {{ body = "three", point = [0.1, 0.3, 0.05] }}
[[robot.body]]
name = "one"
joint = {{ name = "q1", kind = "revolute", axis = [0.1, 0.2, 1], origin = [0, 0, 0.3] }}
mass = 3
com = [0.02, 0.1, 0.05]
inertia = {{ xx = 0.03, yy = 0.02, zz = 0.04 }}
[[robot.body]]
name = "two"
joint = {{ name = "q2", kind = "prismatic", axis = [1, 0.3, 0], origin = [0, 0.1, 0.2] }}
mass = {:?}
com = [0, 0.2, 0.03]
inertia = {{ xx = 0.02, yy = 0.01, zz = 0.02 }}
[[robot.body]]
name = "three"
joint = {{ name = "q3", kind = "revolute", axis = [1, 0, 0.1], origin = [0, 0.4, 0] }}
mass = {:?}
com = [0.01, 0.15, 0]
inertia = {{ xx = 0.01, yy = 0.004, zz = 0.01 }}
[motion]
kind = "forward"
[time]
end = 1
output_step = 0.5
"#,
        masses[0], masses[1]
    );
    cases(&text).plan(0).unwrap().system()
}

const Q: [f64; 3] = [0.4, 0.1, -0.7];
const V: [f64; 3] = [0.9, -0.5, 0.6];
/// q_d, v_d, a_d, H_d and its velocity.
const AIM: [f64; 15] = [0.7, 0.2, -0.2, 0.3, 0.5, -0.4, 0.8, -0.6, 1.1, 0.2, 0.6, 0.4, 0.1, -0.3, 0.7];

fn aim(numbers: &[f64]) -> Aim {
    let three = |k: usize| numbers[3 * k..3 * k + 3].to_vec();
    let point = |k: usize| three(k).try_into().unwrap();
    Aim { q: three(0), v: three(1), a: three(2), gripper: [point(3), point(4)] }
}

/// τ of a law where the robot is so, and aims there.
fn torque(law: &dyn Controller, system: &System, q: &[f64], v: &[f64], wanted: &[f64]) -> Vec<f64> {
    let (model, aim) = (&system.model, aim(wanted));
    let kinematics = Kinematics::at_velocity(model, q, v);
    let (gripper, shaping) = (system.gripper.as_ref(), &Shaping::default());
    let at = At { model, gripper, t: 0.0, q, v, kinematics: &kinematics, aim: &aim, shaping };
    let mut tau = vec![0.0; 3];
    law.torque(&at, &mut Scratch::new(model), &mut tau);
    tau
}

/// The fourth-order difference of a force at `value`.
fn difference(value: f64, tau: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let d = 1e-3;
    let [a, b, c, e] = [1.0, -1.0, 2.0, -2.0].map(|steps| tau(value + steps * d));
    (0..a.len()).map(|k| (8.0 * (a[k] - b[k]) - (c[k] - e[k])) / (12.0 * d)).collect()
}

fn same(what: &str, found: &[f64], truth: &[f64]) {
    let size = truth.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
    let off = found.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9 * size, "{what}: {found:?} for {truth:?}");
}

/// A law of gains kp and kd.
type Make = fn([f64; 3], [f64; 3]) -> Arc<dyn Controller>;

/// Every kind.
fn kinds() -> Vec<(&'static str, Make)> {
    vec![
        ("pd-gravity", |kp, kd| Arc::new(PdGravity { kp: kp.to_vec(), kd: kd.to_vec() })),
        ("computed-torque", |kp, kd| {
            Arc::new(ComputedTorque { kp: kp.to_vec(), kd: kd.to_vec(), compensate_elements: false })
        }),
        ("pid", |kp, kd| {
            let [ki, lambda] = [vec![3.0; 3], vec![0.7; 3]];
            Arc::new(Pid { kp: kp.to_vec(), ki, kd: kd.to_vec(), lambda, mu: vec![1.0, 0.6, 1.0] })
        }),
        ("impedance", |kp, kd| Arc::new(Impedance { kp: kp[0], kd: kd[0] })),
    ]
}

const KP: [f64; 3] = [30.0, 20.0, 50.0];
const KD: [f64; 3] = [3.0, 4.0, 2.0];

#[test]
fn every_law_knows_its_derivatives() {
    let system = robot([2.0, 1.0], -9.81);
    let model = &system.model;
    let kinematics = Kinematics::at_velocity(model, &Q, &V);
    let wanted = aim(&AIM);
    let site = system.gripper.as_ref();
    let shaping = &Shaping::default();
    let at = At { model, gripper: site, t: 0.0, q: &Q, v: &V, kinematics: &kinematics, aim: &wanted, shaping };
    let mut scratch = Scratch::new(model);
    let moved = |values: &[f64], k: usize, value: f64| {
        let mut values = values.to_vec();
        values[k] = value;
        values
    };
    for (name, make) in kinds() {
        let law = make(KP, KD);
        let variation = law.variation().unwrap();
        let mut slopes = TorqueSlopes { d_q: vec![0.0; 9], d_v: vec![0.0; 9] };
        variation.slopes(&at, &mut scratch, &mut slopes);
        let column = |slopes: &[f64], k: usize| (0..3).map(|row| slopes[3 * row + k]).collect::<Vec<_>>();
        for k in 0..3 {
            let by_q = difference(Q[k], |q| torque(&*law, &system, &moved(&Q, k, q), &V, &AIM));
            same(&format!("{name} by q{k}"), &column(&slopes.d_q, k), &by_q);
            let by_v = difference(V[k], |v| torque(&*law, &system, &Q, &moved(&V, k, v), &AIM));
            same(&format!("{name} by v{k}"), &column(&slopes.d_v, k), &by_v);
        }
        for k in 0..AIM.len() {
            let truth = difference(AIM[k], |value| torque(&*law, &system, &Q, &V, &moved(&AIM, k, value)));
            let mut found = vec![0.0; 3];
            variation.add_by_aim(&at, &aim(&moved(&[0.0; 15], k, 1.0)), &mut scratch, &mut found);
            same(&format!("{name} by aim {k}"), &found, &truth);
        }
        for (number, which) in [("kp", 0), ("kd", 1)] {
            for k in 0..3 {
                let velocity = (name != "impedance").then_some(k);
                let number = ControllerNumber { name: number.to_owned(), velocity };
                assert!(variation.has(&number));
                let truth = difference([KP, KD][which][k], |value| {
                    let mut gains = [KP, KD];
                    gains[which][k] = value;
                    torque(&*make(gains[0], gains[1]), &system, &Q, &V, &AIM)
                });
                let mut found = vec![0.0; 3];
                if name != "impedance" || k == 0 {
                    variation.add_by_number(&number, 1.0, &at, &mut scratch, &mut found);
                }
                same(&format!("{name} by {number:?}"), &found, &truth);
            }
        }
        assert!(!variation.has(&ControllerNumber { name: "k".to_owned(), velocity: Some(0) }));
        let truth = difference(-9.81, |g| torque(&*law, &robot([2.0, 1.0], g), &Q, &V, &AIM));
        let unit = model.with_gravity([0.0, 0.0, 1.0]);
        let mut found = vec![0.0; 3];
        variation.add_by_robot(&at, RobotChange::Gravity(&unit), &mut scratch, &mut found);
        same(&format!("{name} by gravity"), &found, &truth);
        // The same law of a robot that has one more velocity in front.
        let other = variation.on(&[1, 2, 3], 4);
        let number = ControllerNumber { name: "kp".to_owned(), velocity: (name != "impedance").then_some(3) };
        assert!(other.has(&number), "{name}");
    }
}
