//! What the midpoint rule keeps: energies without loss, momenta of robots that float.

use crate::loops::*;
use springpot::dynamics::{Kinematics, crba};
use springpot::methods::fixed::{Loop, Method};
use springpot::spatial::{Quaternion, Rotation, Vec3};
use springpot::system::System;

/// Largest departure of kinetic + potential energy from the start in the first and in the last tenth of 10⁵ steps, in units of `scale`.
fn drift(system: &System, method: Method, step: f64, scale: f64) -> [f64; 2] {
    let mut robot = Loop::new(system, method, step, MEMORY).unwrap();
    let still = vec![0.0; system.model.nv()];
    let energy = |robot: &Loop| robot.kinetic_energy() + robot.potential_energy();
    let start = energy(&robot);
    let mut largest = [0.0f64; 2];
    for k in 0..100_000 {
        robot.advance(&still).unwrap();
        let off = (energy(&robot) - start).abs() / scale;
        if k < 10_000 {
            largest[0] = largest[0].max(off);
        } else if k >= 90_000 {
            largest[1] = largest[1].max(off);
        }
    }
    largest
}

#[test]
fn the_energy_of_a_pendulum_does_not_drift() {
    let pendulum = system(&format!(
        r#"
robot.body = [{{ name = "arm", joint = {{ name = "q", kind = "revolute", axis = [0, 1, 0] }}, mass = 1, com = [0.5, 0, 0] }}]
{}"#,
        free("start = { q = { q = 0.2 } }")
    ));
    let scale = 9.81 * 0.5 * 0.8;
    let [first, last] = drift(&pendulum, Method::Midpoint, 1e-3, scale);
    println!("pendulum, midpoint, 10^5 steps of 1 ms: {first:.2e} in the first tenth, {last:.2e} in the last");
    assert!(first < 1e-5 && last < 1.01 * first, "{first:e} {last:e}");
    // Backward Euler's method damps it: the bound above is no matter of course.
    let [_, lost] = drift(&pendulum, Method::BackwardEuler, 1e-3, scale);
    assert!(lost > 0.1, "{lost:e}");
}

#[test]
fn the_energy_of_the_swinging_arm_stays_near() {
    let system = system(&arm(&free("start = { q = { q2 = 1.2, q3 = 0.4 }, v = { q1 = 1 } }")));
    let [first, last] = drift(&system, Method::Midpoint, 1e-3, 20.0);
    println!("arm, midpoint, 10^5 steps of 1 ms: {first:.2e} in the first tenth, {last:.2e} in the last");
    assert!(first < 1e-3 && last < 1e-2, "{first:e} {last:e}");
}

/// Momentum and angular momentum about the origin, world axes, of a robot whose first joint floats.
fn momenta(system: &System, robot: &Loop) -> [f64; 6] {
    let (model, q, v) = (&system.model, robot.q(), robot.v());
    let mass = crba(model, &Kinematics::at_velocity(model, q, v));
    let own: Vec<f64> = (0..6).map(|r| (0..model.nv()).map(|c| mass[r * model.nv() + c] * v[c]).sum()).collect();
    let turn = Rotation::from_quaternion(Quaternion::new([q[3], q[4], q[5], q[6]]));
    let push = turn * Vec3([own[0], own[1], own[2]]);
    let spin = turn * Vec3([own[3], own[4], own[5]]) + Vec3([q[0], q[1], q[2]]).cross(push);
    [push.0, spin.0].concat().try_into().unwrap()
}

#[test]
fn momenta_of_a_floating_robot_are_kept_to_order_two() {
    let text = r#"
robot.gravity = [0, 0, 0]
[[robot.body]]
name = "hull"
joint = { name = "base", kind = "floating" }
mass = 5
com = [0.02, 0.01, -0.03]
inertia = { xx = 0.2, yy = 0.3, zz = 0.25, xy = 0.01 }
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0.3, 0, 0] }
mass = 1
com = [0.3, 0, 0.05]
inertia = { xx = 0.01, yy = 0.03, zz = 0.03 }
[[element]]
name = "strut"
from = { body = "hull", point = [0, 0, 0.3] }
to = { body = "arm", point = [0.4, 0, 0] }
rest_length = 0.6
law = "fractional-kelvin-voigt"
parameters = { k = 40, c = 5, alpha = 0.5 }
"#;
    let start = "start = { v = { base = { vx = 0.3, vy = -0.2, vz = 0.1, wx = 0.5, wy = -0.8, wz = 1.2 }, q1 = -2 } }";
    let system = system(&format!("{text}{}", free(start)));
    let lost = |method: Method, step: f64| {
        let begin = momenta(&system, &Loop::new(&system, method, step, MEMORY).unwrap());
        let end = looped(&system, method, step, 2.0);
        distance(&begin, &momenta(&system, &end)) / begin.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
    };
    for (method, order, largest) in [(Method::Midpoint, 2.0, 2e-6), (Method::BackwardEuler, 1.0, 1e-2)] {
        let off = [4e-3, 2e-3, 1e-3].map(|step| lost(method, step));
        println!("momenta of a floating robot, {method:?}, 4, 2, 1 ms: {:.1e} {:.1e} {:.1e}", off[0], off[1], off[2]);
        assert!(off[2] < largest, "{method:?}: {off:?}");
        for pair in off.windows(2) {
            let found = (pair[0] / pair[1]).log2();
            assert!((found - order).abs() < 0.15, "{method:?}: {found} {off:?}");
        }
    }
}
