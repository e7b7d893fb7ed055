//! Identities of rigid-body dynamics on random trees.

use crate::support::{
    Case, GRAVITY, build, case, close, config, difference, largest, one_degree_case, time_difference,
};
use proptest::prelude::*;
use springpot::dynamics::{
    Kinematics, angular_jacobian, angular_jacobian_rate, christoffel, crba, gravity, kinetic_energy, point_jacobian,
    point_jacobian_rate, potential_energy, rnea,
};
use springpot::model::{BodySpec, JointKind, JointSpec, Model, Parent};
use springpot::spatial::{Inertia, Placement, Rotation, Symmetric3, Vec3};
use std::f64::consts::TAU;

fn times(matrix: &[f64], v: &[f64]) -> Vec<f64> {
    matrix.chunks(v.len()).map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum()).collect()
}

fn sum(x: &[f64], y: &[f64]) -> Vec<f64> {
    x.iter().zip(y).map(|(x, y)| x + y).collect()
}

/// Γ_ab,c v^a v^b.
fn christoffel_forces(gamma: &[f64], v: &[f64]) -> Vec<f64> {
    let n = v.len();
    let mut forces = vec![0.0; n];
    for a in 0..n {
        for b in 0..n {
            for c in 0..n {
                forces[c] += gamma[(a * n + b) * n + c] * v[a] * v[b];
            }
        }
    }
    forces
}

fn unit(v: [f64; 3]) -> Vec3 {
    Vec3(v) * (1.0 / Vec3(v).norm())
}

/// What each coordinate of a joint does: an axis in the frame that is carried along so far, the turn about and the shift along it.
fn moves(joint: &JointSpec) -> Vec<(Vec3, [f64; 2])> {
    const TURN: [f64; 2] = [1.0, 0.0];
    const SHIFT: [f64; 2] = [0.0, 1.0];
    let axis = || unit(joint.axis);
    match joint.kind {
        JointKind::Fixed => Vec::new(),
        JointKind::Revolute | JointKind::Continuous => vec![(axis(), TURN)],
        JointKind::Prismatic => vec![(axis(), SHIFT)],
        JointKind::Helical => vec![(axis(), [1.0, joint.lead / TAU])],
        JointKind::Cylindrical => vec![(axis(), SHIFT), (axis(), TURN)],
        // The second axis stands in the joint frame as it is where both angles are 0, and turns with the first.
        JointKind::Universal => vec![(axis(), TURN), (unit(joint.axis2), TURN)],
        JointKind::Planar => {
            let up = Vec3([0.0, 0.0, 1.0]);
            let (about, angle) = (up.cross(axis()), up.dot(axis()).clamp(-1.0, 1.0).acos());
            let turned = match about.norm() {
                // Half a turn about x leads z to −z.
                0.0 => Rotation::from_rpy([angle, 0.0, 0.0]),
                length => Rotation::from_axis_angle(about * (1.0 / length), about.norm().atan2(up.dot(axis()))),
            };
            vec![(turned.column(0), SHIFT), (turned.column(1), SHIFT), (axis(), TURN)]
        }
        JointKind::Spherical | JointKind::Floating => unreachable!("these trees have joints of one degree"),
    }
}

/// The Rodrigues face as the papers state it: sums over bodies, in the described frames, nothing merged or turned.
struct Rodrigues {
    mass: Vec<f64>,
    gamma: Vec<f64>,
    gravity: Vec<f64>,
}

fn rodrigues(case: &Case) -> Rodrigues {
    let mut frames: Vec<Placement> = Vec::new();
    let mut carriers: Vec<Vec<usize>> = Vec::new();
    // Axis in the world, origin, and how it turns about and shifts along it, per joint of the model.
    let mut joints: Vec<(Vec3, Vec3, [f64; 2])> = Vec::new();
    let model = case.model();
    // A joint that follows another one moves with its coordinate, `ratio` times as fast.
    let own =
        |j: usize| (model.q_range(j).start, model.followed(j).map_or((1.0, 0.0), |(_, ratio, offset)| (ratio, offset)));
    for body in &case.bodies {
        let (parent, mut carrier) = match body.parent {
            Parent::World => (Placement::IDENTITY, Vec::new()),
            Parent::Body(p) => (frames[p], carriers[p].clone()),
        };
        let mut frame =
            parent * Placement { rotation: Rotation::from_rpy(body.joint.rpy), translation: Vec3(body.joint.origin) };
        for (axis, [turn, shift]) in moves(&body.joint) {
            let j = joints.len();
            let (index, (ratio, offset)) = own(j);
            let q = ratio * case.q[index] + offset;
            let along = frame.rotation * axis;
            joints.push((along, frame.translation, [turn, shift]));
            carrier.push(j);
            frame.translation += along * (shift * q);
            frame.rotation = frame.rotation * Rotation::from_axis_angle(axis, turn * q);
        }
        frames.push(frame);
        carriers.push(carrier);
    }

    let n = model.nv();
    let mut out = Rodrigues { mass: vec![0.0; n * n], gamma: vec![0.0; n * n * n], gravity: vec![0.0; n] };
    let at = |j: usize| own(j).0;
    // Each rotor turns with its own coordinate alone.
    let mut j = 0;
    for joint in case.bodies.iter().map(|body| &body.joint) {
        for armature in &joint.armature[..moves(joint).len()] {
            out.mass[at(j) * n + at(j)] += armature * own(j).1.0 * own(j).1.0;
            j += 1;
        }
    }
    for (body, (frame, carrier)) in case.bodies.iter().zip(frames.iter().zip(&carriers)) {
        let m = body.mass;
        let centre = frame.point(Vec3(body.com));
        let inertia = Symmetric3::from_upper(body.inertia).rotated(&frame.rotation);
        let t = |j: usize| {
            let (e, origin, [turn, shift]) = joints[j];
            (e * shift + e.cross(centre - origin) * turn) * own(j).1.0
        };
        let om = |j: usize| joints[j].0 * (joints[j].2[0] * own(j).1.0);
        for &a in carrier {
            out.gravity[at(a)] -= m * Vec3(GRAVITY).dot(t(a));
            for &b in carrier {
                out.mass[at(a) * n + at(b)] += m * t(a).dot(t(b)) + om(a).dot(inertia * om(b));
                let (lo, hi) = (a.min(b), a.max(b));
                for &c in carrier {
                    out.gamma[(at(a) * n + at(b)) * n + at(c)] +=
                        m * om(lo).cross(t(hi)).dot(t(c)) + om(lo).dot(inertia.second_moments() * om(hi).cross(om(c)));
                }
            }
        }
    }
    out
}

fn mass_at(model: &Model, q: &[f64]) -> Vec<f64> {
    crba(model, &Kinematics::at_position(model, q))
}

proptest! {
    #![proptest_config(config(0x5eed_0001))]

    #[test]
    fn equations_of_motion_equal_rnea(case in one_degree_case()) {
        let model = case.model();
        let kinematics = Kinematics::at_position(&model, &case.q);
        let inertial = times(&crba(&model, &kinematics), &case.a);
        let coriolis = christoffel_forces(&christoffel(&model, &kinematics), &case.v);
        let weight = gravity(&model, &kinematics);
        let scale = largest(&inertial).max(largest(&coriolis)).max(largest(&weight));
        let tau = rnea(&model, &case.q, &case.v, &case.a, &[]);
        close("tau", &sum(&sum(&inertial, &coriolis), &weight), &tau, 1e-12, scale);
    }

    #[test]
    fn closed_forms_equal_the_sums_over_bodies(case in one_degree_case()) {
        let model = case.model();
        let kinematics = Kinematics::at_position(&model, &case.q);
        let direct = rodrigues(&case);
        close("M", &crba(&model, &kinematics), &direct.mass, 1e-13, largest(&direct.mass));
        let scale = largest(&direct.gamma).max(largest(&direct.mass));
        close("Gamma", &christoffel(&model, &kinematics), &direct.gamma, 1e-13, scale);
        let scale = largest(&direct.gravity).max(largest(&direct.mass));
        close("g", &gravity(&model, &kinematics), &direct.gravity, 1e-13, scale);
    }

    #[test]
    fn christoffel_symbols_are_derivatives_of_the_mass_matrix(case in one_degree_case()) {
        let model = case.model();
        let n = model.nv();
        let gamma = christoffel(&model, &Kinematics::at_position(&model, &case.q));
        let slopes: Vec<Vec<f64>> = (0..n).map(|j| difference(&model, &case.q, j, |q| mass_at(&model, q))).collect();
        let mut expected = vec![0.0; n * n * n];
        for a in 0..n {
            for b in 0..n {
                for c in 0..n {
                    let sum = slopes[a][b * n + c] + slopes[b][a * n + c] - slopes[c][a * n + b];
                    expected[(a * n + b) * n + c] = 0.5 * sum;
                }
            }
        }
        close("Gamma", &gamma, &expected, 1e-9, largest(&mass_at(&model, &case.q)));
    }

    #[test]
    fn energies(case in case()) {
        let model = case.model();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let momentum = times(&crba(&model, &kinematics), &case.v);
        let from_matrix: f64 = 0.5 * momentum.iter().zip(&case.v).map(|(p, v)| p * v).sum::<f64>();
        let kinetic = kinetic_energy(&model, &kinematics);
        close("T", &[kinetic], &[from_matrix], 1e-12, kinetic);

        let potential = |q: &[f64]| vec![potential_energy(&model, &Kinematics::at_position(&model, q))];
        let slope: Vec<f64> = (0..model.nv()).map(|j| difference(&model, &case.q, j, potential)[0]).collect();
        let weight = gravity(&model, &kinematics);
        close("g", &weight, &slope, 1e-10, largest(&weight).max(potential(&case.q)[0].abs()).max(1.0));
        close("g", &weight, &rnea(&model, &case.q, &vec![0.0; model.nv()], &vec![0.0; model.nv()], &[]), 1e-12,
            largest(&weight).max(1.0));
    }

    #[test]
    fn potential_energy_is_the_sum_over_moving_bodies(case in case()) {
        let model = case.model();
        let kinematics = Kinematics::at_position(&model, &case.q);
        let mut sum = 0.0;
        for (k, body) in case.bodies.iter().enumerate() {
            let frame = model.frame(Parent::Body(k)).unwrap();
            if frame.link() > 0 {
                sum -= body.mass * Vec3(GRAVITY).dot(kinematics.frame(&frame).point(Vec3(body.com)));
            }
        }
        close("V", &[potential_energy(&model, &kinematics)], &[sum], 1e-12, sum.abs().max(1.0));
    }

    #[test]
    fn points_move_as_their_jacobians_say(case in case()) {
        let model = case.model();
        let kinematics = Kinematics::at_acceleration(&model, &case.q, &case.v, &case.a);
        for site in case.sites(&model) {
            let jacobian = point_jacobian(&model, &kinematics, &site);
            let rate = point_jacobian_rate(&model, &kinematics, &site);
            let velocity = kinematics.velocity(&site).0;
            close("J v", &times(&jacobian, &case.v), &velocity, 1e-13, largest(&velocity).max(1.0));
            let acceleration = kinematics.acceleration(&site).0;
            let sum = sum(&times(&jacobian, &case.a), &times(&rate, &case.v));
            close("J a + Jdot v", &sum, &acceleration, 1e-12, largest(&acceleration).max(1.0));

            let place = |q: &[f64], _: &[f64]| Kinematics::at_position(&model, q).position(&site).0.to_vec();
            close("dr/dt", &velocity, &time_difference(&model, &case, place), 1e-7, largest(&velocity).max(1.0));
            let jacobian_at = |q: &[f64], _: &[f64]| point_jacobian(&model, &Kinematics::at_position(&model, q), &site);
            close("dJ/dt", &rate, &time_difference(&model, &case, jacobian_at), 1e-7, largest(&rate).max(1.0));
            let velocity_at = |q: &[f64], v: &[f64]| Kinematics::at_velocity(&model, q, v).velocity(&site).0.to_vec();
            close("dv/dt", &acceleration, &time_difference(&model, &case, velocity_at), 1e-6, largest(&acceleration).max(1.0));
        }
    }

    #[test]
    fn bodies_turn_as_their_jacobians_say(case in case()) {
        let model = case.model();
        let kinematics = Kinematics::at_acceleration(&model, &case.q, &case.v, &case.a);
        for (anchor, site) in case.anchors.iter().zip(case.sites(&model)) {
            let jacobian = angular_jacobian(&model, &kinematics, &site);
            let rate = angular_jacobian_rate(&model, &kinematics, &site);
            let omega = kinematics.link_velocity(site.link()).angular;
            close("omega", &times(&jacobian, &case.v), &omega.0, 1e-13, largest(&omega.0).max(1.0));
            let alpha = kinematics.link_acceleration(site.link()).angular.0;
            close("alpha", &sum(&times(&jacobian, &case.a), &times(&rate, &case.v)), &alpha, 1e-12, largest(&alpha).max(1.0));
            let jacobian_at =
                |q: &[f64], _: &[f64]| angular_jacobian(&model, &Kinematics::at_position(&model, q), &site);
            close("dJ/dt", &rate, &time_difference(&model, &case, jacobian_at), 1e-7, largest(&rate).max(1.0));

            // dR/dt = ω × R, column by column.
            let frame = model.frame(anchor.body).unwrap();
            let rotation_at = |q: &[f64], _: &[f64]| {
                Kinematics::at_position(&model, q).frame(&frame).rotation.transpose().0.as_flattened().to_vec()
            };
            let columns = kinematics.frame(&frame).rotation.transpose().rows();
            let turned: Vec<f64> = columns.iter().flat_map(|&column| omega.cross(column).0).collect();
            close("dR/dt", &turned, &time_difference(&model, &case, rotation_at), 1e-7, largest(&omega.0).max(1.0));
        }
    }

    #[test]
    fn a_fixed_body_is_a_part_of_its_carrier(case in case(), origin in proptest::array::uniform3(-0.5..0.5), rpy in
        proptest::array::uniform3(-3.0..3.0), on in 0usize..8) {
        let on = on % case.bodies.len();
        let load = BodySpec {
            name: "load".into(),
            parent: Parent::Body(on),
            joint: JointSpec { rpy, ..JointSpec::fixed("weld", origin) },
            mass: 1.7,
            com: [0.1, -0.2, 0.05],
            inertia: [[0.04, 0.01, 0.0], [0.01, 0.05, -0.01], [0.0, -0.01, 0.06]],
        };
        let mut with_load = case.bodies.clone();
        with_load.push(load.clone());
        // By hand: the two bodies as one, about the common centre of mass, in the carrier's joint frame.
        let mut by_hand = case.bodies.clone();
        let placement = Placement { rotation: Rotation::from_rpy(rpy), translation: Vec3(origin) };
        let load_com = placement.point(Vec3(load.com));
        let body = &mut by_hand[on];
        let mass = body.mass + load.mass;
        let com = (Vec3(body.com) * body.mass + load_com * load.mass) * (1.0 / mass);
        let about = |m: f64, c: Vec3, j: Symmetric3| {
            let d = c - com;
            Inertia::from_central(m, d, j).rotational.to_matrix()
        };
        let own = about(body.mass, Vec3(body.com), Symmetric3::from_upper(body.inertia));
        let added = about(load.mass, load_com, Symmetric3::from_upper(load.inertia).rotated(&placement.rotation));
        for r in 0..3 {
            for c in 0..3 {
                body.inertia[r][c] = own[r][c] + added[r][c];
            }
        }
        (body.mass, body.com) = (mass, com.0);

        let (merged, composed) = (build(&with_load), build(&by_hand));
        let tau = rnea(&composed, &case.q, &case.v, &case.a, &[]);
        close("tau", &rnea(&merged, &case.q, &case.v, &case.a, &[]), &tau, 1e-12, largest(&tau).max(1.0));
        let mass = mass_at(&composed, &case.q);
        close("M", &mass_at(&merged, &case.q), &mass, 1e-13, largest(&mass));
        assert_eq!(merged.body_index("load"), Some(case.bodies.len()));
        assert_eq!(merged.nv(), composed.nv());
    }
}

#[test]
fn the_random_trees_are_worth_their_name() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::new(config(0x5eed_0001));
    let (mut branches, mut long, mut kinds) = (0, 0, [0; JointKind::ALL.len()]);
    for _ in 0..256 {
        let case = case().new_tree(&mut runner).unwrap().current();
        let parents: Vec<Parent> = case.bodies.iter().map(|body| body.parent).collect();
        let is_kind = |kind| case.bodies.iter().any(|body| body.joint.kind == kind);
        branches += usize::from((1..parents.len()).any(|k| parents[..k].contains(&parents[k])));
        long += usize::from(case.q.len() >= 6);
        for (count, kind) in kinds.iter_mut().zip(JointKind::ALL) {
            *count += usize::from(is_kind(kind));
        }
    }
    assert!(branches > 50 && long > 25, "{branches} {long}");
    let rare = |k: &usize| kinds[*k] <= 30 && JointKind::ALL[*k] != JointKind::Continuous;
    assert_eq!((0..kinds.len()).find(rare), None, "{kinds:?}");
    let mut followers = 0;
    for _ in 0..256 {
        let case = one_degree_case().new_tree(&mut runner).unwrap().current();
        followers += usize::from(case.bodies.iter().any(|body| body.joint.mimic.is_some()));
    }
    assert!(followers > 60, "{followers}");
}
