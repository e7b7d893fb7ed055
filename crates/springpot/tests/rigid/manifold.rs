//! The configuration manifold: steps, differences, and free bodies.

use crate::support::{build, case, close, config, largest};
use proptest::prelude::*;
use springpot::dynamics::{Kinematics, aba, kinetic_energy, potential_energy};
use springpot::model::{BodySpec, JointKind, JointSpec, Limits, Model, ModelBuilder, Parent, Space, StateError};
use springpot::spatial::{Motion, Rotation, Vec3};
use std::f64::consts::{PI, TAU};

proptest! {
    #![proptest_config(config(0x5eed_0005))]

    #[test]
    fn differences_undo_steps(case in case(), size in 0.0..0.8f64) {
        let model = case.model();
        // Turns of less than half a turn come back as they were.
        let step: Vec<f64> = case.v.iter().map(|v| size * v).collect();
        let there = model.integrate(&case.q, &step);
        close("step", &model.difference(&case.q, &there), &step, 1e-13, 10.0);
        prop_assert_eq!(model.integrate(&case.q, &vec![0.0; model.nv()]).len(), model.nq());
        let back = model.integrate(&there, &step.iter().map(|v| -v).collect::<Vec<_>>());
        close("and back", &model.difference(&case.q, &back), &vec![0.0; model.nv()], 1e-13, 10.0);
    }

    #[test]
    fn half_steps_along_one_twist_add_up(case in case()) {
        let model = case.model();
        let half: Vec<f64> = case.v.iter().map(|v| 0.5 * v).collect();
        let twice = model.integrate(&model.integrate(&case.q, &half), &half);
        let once = model.integrate(&case.q, &case.v);
        close("twist", &model.difference(&once, &twice), &vec![0.0; model.nv()], 1e-13, 10.0);
    }

    #[test]
    fn normalising_changes_no_place(case in case(), stretch in 0.2..5.0f64) {
        let model = case.model();
        let mut q = case.q.clone();
        for j in 0..model.joint_count() {
            match model.joint_space(j) {
                Space::Pose => model.q_range(j).skip(3).for_each(|k| q[k] *= -stretch),
                Space::Attitude => model.q_range(j).for_each(|k| q[k] *= -stretch),
                Space::Circle if model.followed(j).is_none() => q[model.q_range(j).start] += TAU,
                Space::Circle | Space::Line(_) => {}
            }
        }
        // Followers turn by their ratio of the full turn, so that only their leaders' links stay where they were.
        prop_assume!(model.is_free_of_followers());
        let before = Kinematics::at_position(&model, &q);
        model.normalise(&mut q);
        let after = Kinematics::at_position(&model, &q);
        for link in 1..=model.joint_count() {
            let (x, y) = (before.link(link), after.link(link));
            close("place", &x.translation.0, &y.translation.0, 1e-13, largest(&y.translation.0).max(1.0));
            close("turn", x.rotation.0.as_flattened(), y.rotation.0.as_flattened(), 1e-13, 1.0);
        }
        let again = q.clone();
        model.normalise(&mut q);
        close("q", &q, &again, 1e-15, 4.0);
    }
}

#[test]
fn the_shorter_way_round() {
    let mut builder = ModelBuilder::new([0.0; 3]);
    for (k, kind) in [JointKind::Revolute, JointKind::Continuous].into_iter().enumerate() {
        let joint = JointSpec { kind, ..JointSpec::revolute(format!("q{k}"), [0.0, 0.0, 1.0], [0.0; 3]) };
        builder.push(rod(format!("b{k}"), joint)).unwrap();
    }
    let model = builder.finish().unwrap();
    close("turns", &model.difference(&[-3.0, -3.0], &[3.0, 3.0]), &[6.0, 6.0 - TAU], 1e-15, 6.0);
    let mut q = [7.0, 7.0];
    model.normalise(&mut q);
    close("q", &q, &[7.0, 7.0 - TAU], 1e-15, 7.0);
    let mut half = [0.0, -PI];
    model.normalise(&mut half);
    assert_eq!(half[1], PI);
}

#[test]
fn random_configurations_are_within_limits_and_the_same_for_a_seed() {
    let mut builder = ModelBuilder::new([0.0; 3]);
    let limits = Limits { lower: 0.2, upper: 0.3, ..Limits::NONE };
    let joint = JointSpec { limits: [limits; 3], ..JointSpec::prismatic("q1", [1.0, 0.0, 0.0], [0.0; 3]) };
    builder.push(rod("slider".into(), joint)).unwrap();
    builder.push(rod("body".into(), JointSpec::floating("base", [0.0; 3]))).unwrap();
    let model = builder.finish().unwrap();
    let all: Vec<Vec<f64>> = (0..200).map(|seed| model.random(seed)).collect();
    assert_eq!(all[7], model.random(7));
    let mean = |k: usize| all.iter().map(|q| q[k]).sum::<f64>() / 200.0;
    for q in &all {
        assert!((0.2..=0.3).contains(&q[0]), "{}", q[0]);
        assert!((q[4..].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
    }
    assert!((mean(0) - 0.25).abs() < 0.01 && (1..8).all(|k| mean(k).abs() < 0.2));
    assert_eq!(model.neutral(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn what_is_no_state_is_told() {
    let mut builder = ModelBuilder::new([0.0; 3]);
    builder.push(rod("hull".into(), JointSpec::floating("base", [0.0; 3]))).unwrap();
    builder.push(rod("arm".into(), JointSpec::revolute("shoulder", [0.0, 0.0, 1.0], [0.0; 3]))).unwrap();
    let model = builder.finish().unwrap();
    let told = |error: StateError| error.to_string();
    assert_eq!((model.check_q(&model.neutral()), model.check_v("v", &[0.0; 7])), (Ok(()), Ok(())));
    assert_eq!(told(model.check_q(&[0.0; 7]).unwrap_err()), "q has 7 numbers; this robot's q has 8");
    assert_eq!(told(model.check_v("tau", &[0.0; 8]).unwrap_err()), "tau has 8 numbers; this robot's tau has 7");
    let mut q = model.neutral();
    q[1] = f64::NAN;
    assert_eq!(told(model.check_q(&q).unwrap_err()), "q.base.y is NaN; it must be finite");
    let mut v = vec![0.0; 7];
    v[6] = f64::INFINITY;
    assert_eq!(told(model.check_v("a", &v).unwrap_err()), "a.shoulder is inf; it must be finite");
    let message = "the quaternion of joint \"base\" has the length 0; it must have one, such as [0, 0, 0, 1]";
    assert_eq!(told(model.check_q(&[0.0; 8]).unwrap_err()), message);
    // What the algorithms make of NaN is NaN, and no panic.
    assert!(aba(&model, &[f64::NAN; 8], &[f64::NAN; 7], &[0.0; 7], &[]).iter().all(|a| a.is_nan()));
}

fn rod(name: String, joint: JointSpec) -> BodySpec {
    let inertia = [[0.3, 0.02, 0.0], [0.02, 0.5, -0.04], [0.0, -0.04, 0.4]];
    BodySpec { name, parent: Parent::World, joint, mass: 2.0, com: [0.1, -0.2, 0.3], inertia }
}

/// Linear and angular momentum about the world's origin.
fn momentum(model: &Model, kinematics: &Kinematics) -> [f64; 6] {
    let mut total = [0.0; 6];
    for j in 0..model.joint_count() {
        let (link, velocity) = (kinematics.link(j + 1), kinematics.link_velocity(j + 1));
        let inertia = model.link_inertia(j).rotated(&link.rotation);
        let own = inertia * velocity;
        let moment = own.angular + link.translation.cross(own.linear);
        for k in 0..3 {
            total[k] += own.linear.0[k];
            total[3 + k] += moment.0[k];
        }
    }
    total
}

/// A free body with an arm, stepped through half a second on its manifold: momentum, energy and attitude stay what they are.
#[test]
fn a_free_robot_keeps_its_momentum() {
    let arm = BodySpec {
        parent: Parent::Body(0),
        ..rod("arm".into(), JointSpec::revolute("shoulder", [0.3, 1.0, -0.2], [0.4, 0.1, 0.2]))
    };
    let mut builder = ModelBuilder::new([0.0; 3]);
    builder.push(rod("hull".into(), JointSpec::floating("floating_base", [0.0; 3]))).unwrap();
    builder.push(arm).unwrap();
    let model = builder.finish().unwrap();
    let mut q = model.random(3);
    let mut v: Vec<f64> = (0..7).map(|k| (1.0 + 2.3 * k as f64).sin()).collect();
    let at = |q: &[f64], v: &[f64]| {
        let kinematics = Kinematics::at_velocity(&model, q, v);
        (momentum(&model, &kinematics), kinetic_energy(&model, &kinematics))
    };
    let (start, energy) = at(&q, &v);
    let accelerate = |q: &[f64], v: &[f64]| aba(&model, q, v, &[0.0; 7], &[]);
    let moved = |v: &[f64], a: &[f64], h: f64| -> Vec<f64> { v.iter().zip(a).map(|(v, a)| v + h * a).collect() };
    let scaled = |v: &[f64], h: f64| -> Vec<f64> { v.iter().map(|v| h * v).collect() };
    const STEP: f64 = 1e-3;
    for _ in 0..500 {
        // The midpoint rule: error of order h³ a step.
        let a = accelerate(&q, &v);
        let (middle, speed) = (model.integrate(&q, &scaled(&v, 0.5 * STEP)), moved(&v, &a, 0.5 * STEP));
        let a = accelerate(&middle, &speed);
        q = model.integrate(&q, &scaled(&speed, STEP));
        v = moved(&v, &a, STEP);
    }
    model.normalise(&mut q);
    let (end, energy_at_end) = at(&q, &v);
    close("momentum", &end, &start, 2e-6, largest(&start));
    close("energy", &[energy_at_end], &[energy], 2e-6, energy);
}

/// Gravity alone lets every point of a body at rest fall alike, whatever its attitude.
#[test]
fn a_free_body_falls() {
    let model = build(&[rod("hull".into(), JointSpec::floating("floating_base", [1.0, 0.0, 0.0]))]);
    let q = model.random(11);
    let a = aba(&model, &q, &[0.0; 6], &[0.0; 6], &[]);
    let attitude = Rotation::from_quaternion_components([q[3], q[4], q[5], q[6]]);
    let g = attitude.unrotate(Vec3(model.gravity()));
    close("a", &a, &[g.0, [0.0; 3]].concat(), 1e-13, 10.0);
    let kinematics = Kinematics::at_position(&model, &q);
    assert_eq!(kinematics.link(1).translation.0[0], 1.0 + q[0]);
    let spin = Kinematics::at_velocity(&model, &q, &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
    assert_eq!(spin.link_velocity(1), Motion { angular: attitude.column(2) * 2.0, linear: Vec3([0.0; 3]) });
    let weight = -2.0 * Vec3(model.gravity()).dot(kinematics.link(1).point(Vec3([0.1, -0.2, 0.3])));
    close("V", &[potential_energy(&model, &kinematics)], &[weight], 1e-14, 40.0);
}
