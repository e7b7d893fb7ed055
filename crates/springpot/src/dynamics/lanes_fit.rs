//! Two states side by side give, lane by lane, the very bits that each gives alone.

use super::*;
use crate::model::{Anchor, BodySpec, JointSpec, Mimic, Model, ModelBuilder, Parent};
use crate::spatial::{Scalar, Two};

/// What the first and the last of five joints on two branches are, besides revolute and prismatic ones.
#[derive(Clone, Copy, PartialEq)]
enum Ends {
    Plain,
    Floating,
    Following,
    Screw,
}

fn model(ends: Ends) -> Model {
    let mut builder = ModelBuilder::new([0.1, -0.2, -9.81]);
    for k in 0..5usize {
        let kind = if k % 3 == 1 { JointSpec::prismatic } else { JointSpec::revolute };
        let mut joint = kind(format!("q{k}"), [0.3, k as f64, 1.0], [0.2, 0.1, 0.4]);
        match ends {
            Ends::Floating if k == 0 => joint = JointSpec::floating("q0", joint.origin),
            Ends::Screw if k == 0 => joint = JointSpec::spherical("q0", joint.origin),
            Ends::Screw if k == 4 => joint = JointSpec::helical("q4", joint.axis, 0.3, joint.origin),
            Ends::Following if k == 4 => {
                joint.mimic = Some(Mimic { joint: "q2".into(), multiplier: 0.7, offset: -0.2 });
            }
            _ => {}
        }
        builder
            .push(BodySpec {
                name: format!("b{k}"),
                parent: if k == 3 { Parent::Body(0) } else { k.checked_sub(1).map_or(Parent::World, Parent::Body) },
                joint,
                mass: 1.0 + k as f64,
                com: [0.1, 0.2, -0.1],
                inertia: [[0.2, 0.01, 0.0], [0.01, 0.25, 0.02], [0.0, 0.02, 0.3]],
            })
            .unwrap();
    }
    builder.finish().unwrap()
}

/// Everything the algorithms say about one state (or two), in a row.
fn everything<T: Scalar>(model: &Model, q: &[T], v: &[T], a: &[T]) -> Vec<T> {
    let [from, to, base] = [(Parent::Body(2), 0.3), (Parent::Body(4), -0.2), (Parent::World, 1.0)]
        .map(|(body, x)| model.resolve(&Anchor { body, point: [x, 0.1, 0.2] }).unwrap());
    let kinematics = Kinematics::at_acceleration(model, q, v, a);
    let (here, gradient) = pair(model, &kinematics, &from, &to);
    let force = |from, to| PairForce { from, to, force: here.length, d_length: T::ONE, d_rate: T::ZERO };
    let mut all =
        vec![here.length, here.rate, kinetic_energy(model, &kinematics), potential_energy(model, &kinematics)];
    all.extend(here.direction.0);
    all.extend(kinematics.acceleration(&to).0);
    all.extend(rnea(model, q, v, a, &[force(from, to), force(base, to)]));
    all.extend(crba(model, &kinematics));
    if model.is_one_degree() {
        all.extend(christoffel(model, &kinematics));
    }
    all.extend(gravity(model, &kinematics));
    all.extend(point_jacobian(model, &kinematics, &from));
    all.extend(point_jacobian_rate(model, &kinematics, &from));
    all.extend(angular_jacobian(model, &kinematics, &to));
    all.extend(angular_jacobian_rate(model, &kinematics, &to));
    all.extend(pair_hessian(model, &kinematics, &from, &to));
    all.extend(gradient);
    all.extend(aba(model, q, v, a, &[force(from, to), force(base, to)]));
    all.extend(nonlinear_effects(model, q, v, &[]));
    all.extend(mass_inverse(model, &kinematics));
    all.extend(coriolis(model, &kinematics));
    all.extend(com(model, &kinematics).0);
    all.extend(com_jacobian(model, &kinematics));
    let cable = [base, from, to];
    let (cable, mut workspace, n) = (CableLength(&cable), Workspace::new(model), model.nv());
    let [mut slopes, mut tau] = [(); 2].map(|()| vec![T::ZERO; n]);
    let [mut second, mut d_q, mut d_v] = [(); 3].map(|()| vec![T::ZERO; n * n]);
    all.push(gradient_into(model, &kinematics, &cable, &mut slopes));
    hessian_into(model, &kinematics, &cable, &mut workspace, &mut second);
    add_force(model, &kinematics, &cable, here.length, &mut tau);
    add_stiffness(model, &kinematics, &cable, [here.length; 3], &mut workspace, [&mut d_q, &mut d_v]);
    all.extend([slopes, tau, second, d_q, d_v].concat());
    let soft = [PairForce { d_rate: here.rate, ..force(from, to) }, force(base, to)];
    let inverse_slopes = rnea_derivatives(model, q, v, a, &soft);
    all.extend([inverse_slopes.d_q, inverse_slopes.d_v, inverse_slopes.d_a].concat());
    let forward_slopes = aba_derivatives(model, q, v, a, &soft);
    all.extend([forward_slopes.a, forward_slopes.d_q, forward_slopes.d_v, forward_slopes.d_tau].concat());
    let end = model.frame(Parent::Body(4)).unwrap();
    all.extend(frame_jacobian(model, &kinematics, &end));
    all.extend(frame_jacobian_rate(model, &kinematics, &end));
    all
}

#[test]
fn lanes_do_not_meet() {
    for ends in [Ends::Plain, Ends::Floating, Ends::Following, Ends::Screw] {
        let model = model(ends);
        let single = |seed: f64| -> [Vec<f64>; 3] {
            let numbers = |n: usize, seed: f64| (0..n).map(|j| (seed + 1.3 * j as f64).sin()).collect();
            [numbers(model.nq(), seed), numbers(model.nv(), seed + 0.1), numbers(model.nv(), seed - 7.6)]
        };
        let (first, second) = (single(0.1), single(5.4));
        let joined: [Vec<Two>; 3] =
            [0, 1, 2].map(|k| first[k].iter().zip(&second[k]).map(|(&x, &y)| Two([x, y])).collect());
        let alone = [&first, &second].map(|[q, v, a]| everything(&model, q, v, a));
        let together = everything(&model, &joined[0], &joined[1], &joined[2]);
        assert_eq!(together.len(), alone[0].len());
        for (k, both) in together.iter().enumerate() {
            assert_eq!(both.0, [alone[0][k], alone[1][k]], "entry {k}");
        }
        assert_ne!(alone[0], alone[1]);
    }
}
