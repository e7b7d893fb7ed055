//! Pairs of anchors: distance, derivatives and forces, on random trees.

use crate::support::{
    Case, build, case, close, config, difference, largest, one_degree_case, plain_case, time_difference,
};
use proptest::prelude::*;
use springpot::dynamics::{Kinematics, PairForce, add_generalized_force, pair, pair_hessian, rnea};
use springpot::model::{Anchor, BodySpec, JointSpec, Model, Parent};

/// Distances below this make differences inaccurate.
const SHORTEST: f64 = 0.15;

fn gradient_at(case: &Case, model: &Model, q: &[f64]) -> Vec<f64> {
    let [from, to] = case.sites(model);
    pair(model, &Kinematics::at_velocity(model, q, &case.v), &from, &to).1
}

proptest! {
    #![proptest_config(config(0x5eed_0002))]

    #[test]
    fn derivatives_of_the_length(case in case()) {
        let model = case.model();
        let [from, to] = case.sites(&model);
        let n = model.nv();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let (here, gradient) = pair(&model, &kinematics, &from, &to);
        prop_assume!(here.length > SHORTEST);
        let length = |q: &[f64]| vec![pair(&model, &Kinematics::at_velocity(&model, q, &case.v), &from, &to).0.length];

        let (start, end) = (kinematics.position(&from), kinematics.position(&to));
        prop_assert!((here.length - (end - start).norm()).abs() <= 1e-15 * (1.0 + here.length));
        let by_points = here.direction.dot(kinematics.velocity(&to) - kinematics.velocity(&from));
        prop_assert!((here.rate - by_points).abs() <= 1e-12 * (1.0 + here.rate.abs()));
        let by_time = time_difference(&model, &case, |q, _| length(q))[0];
        prop_assert!((here.rate - by_time).abs() <= 1e-5 * (1.0 + here.rate.abs()), "{} {}", here.rate, by_time);

        let slopes: Vec<f64> = (0..n).map(|j| difference(&model, &case.q, j, length)[0]).collect();
        close("dl", &gradient, &slopes, 1e-7, largest(&gradient).max(1.0));

        let hessian = pair_hessian(&model, &kinematics, &from, &to);
        for b in 0..n {
            let column: Vec<f64> = (0..n).map(|a| hessian[a * n + b]).collect();
            let curvature = difference(&model, &case.q, b, |q| gradient_at(&case, &model, q));
            close("d2l", &column, &curvature, 1e-6, largest(&hessian).max(1.0));
        }
    }

    #[test]
    fn second_derivatives_commute(case in one_degree_case()) {
        let model = case.model();
        let [from, to] = case.sites(&model);
        let n = model.nv();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let here = pair(&model, &kinematics, &from, &to).0;
        prop_assume!(here.length > SHORTEST);
        let hessian = pair_hessian(&model, &kinematics, &from, &to);
        let turned: Vec<f64> = (0..n * n).map(|k| hessian[(k % n) * n + k / n]).collect();
        close("d2l", &hessian, &turned, 1e-14, largest(&hessian));
    }

    #[test]
    fn joints_that_carry_both_ends_feel_exactly_nothing(case in plain_case()) {
        let model = case.model();
        let [from, to] = case.sites(&model);
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let gradient = pair(&model, &kinematics, &from, &to).1;
        let hessian = pair_hessian(&model, &kinematics, &from, &to);
        let carries = |j: usize, mut link: usize| {
            while link > j + 1 {
                link = model.parent_link(link - 1);
            }
            link == j + 1
        };
        for j in 0..model.nv() {
            if carries(j, from.link()) == carries(j, to.link()) {
                prop_assert_eq!(gradient[j], 0.0);
                prop_assert!((0..model.nv()).all(|k| hessian[j * model.nv() + k] == 0.0));
            }
        }
    }

    #[test]
    fn pair_forces_in_rnea(case in case(), force in -200.0..200.0) {
        let model = case.model();
        let [from, to] = case.sites(&model);
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let (first, gradient) = pair(&model, &kinematics, &from, &to);
        let world = model.resolve(&Anchor { body: Parent::World, point: [2.0, -3.0, 4.0] }).unwrap();
        let (second, second_gradient) = pair(&model, &kinematics, &to, &world);
        prop_assume!(first.length > SHORTEST && second.length > SHORTEST);
        let plain = |from, to, force| PairForce { from, to, force, d_length: 0.0, d_rate: 0.0 };
        let pairs = [plain(from, to, force), plain(to, world, 70.0)];

        let mut generalized = vec![0.0; model.nv()];
        add_generalized_force(force, &gradient, &mut generalized);
        let power: f64 = generalized.iter().zip(&case.v).map(|(q, v)| q * v).sum();
        prop_assert!((power + force * first.rate).abs() <= 1e-12 * force.abs() * (1.0 + first.rate.abs()));

        add_generalized_force(70.0, &second_gradient, &mut generalized);
        let free = rnea(&model, &case.q, &case.v, &case.a, &[]);
        let expected: Vec<f64> = free.iter().zip(&generalized).map(|(tau, q)| tau - q).collect();
        let scale = largest(&expected).max(force.abs()).max(70.0);
        close("tau", &rnea(&model, &case.q, &case.v, &case.a, &pairs), &expected, 1e-12, scale);
    }
}

fn slider() -> Model {
    build(&[BodySpec {
        name: "slider".into(),
        parent: Parent::World,
        joint: JointSpec::prismatic("q1", [1.0, 0.0, 0.0], [0.0; 3]),
        mass: 1.0,
        com: [0.0; 3],
        inertia: [[0.0; 3]; 3],
    }])
}

#[test]
fn tension_pulls_the_points_together() {
    let model = slider();
    let from = model.resolve(&Anchor { body: Parent::World, point: [0.0; 3] }).unwrap();
    let to = model.resolve(&Anchor { body: Parent::Body(0), point: [0.0; 3] }).unwrap();
    let (here, gradient) = pair(&model, &Kinematics::at_velocity(&model, &[2.0], &[-3.0]), &from, &to);
    assert_eq!((here.length, here.rate, gradient[0]), (2.0, -3.0, 1.0));
    let mut q = [0.0];
    add_generalized_force(5.0, &gradient, &mut q);
    assert_eq!(q, [-5.0]);
}

#[test]
fn coincident_anchors_are_told() {
    let model = slider();
    let from = model.resolve(&Anchor { body: Parent::World, point: [0.25, 0.3, 0.0] }).unwrap();
    let to = model.resolve(&Anchor { body: Parent::Body(0), point: [0.0, 0.3, 0.0] }).unwrap();
    let at = |q: f64| pair(&model, &Kinematics::at_velocity(&model, &[q], &[1.0]), &from, &to).0;
    let error = at(0.25).check().unwrap_err();
    assert_eq!(error.length, 0.0);
    assert_eq!(error.to_string(), "the two anchors coincide (length 0 m): there is no direction for the force");
    assert!(at(0.25).direction.0[0].is_nan());
    // Rounding of the positions, about 1e-16 m, is no direction either; a nanometre is one.
    assert!(at(0.25 + 1e-16 * 3.0).check().is_err());
    assert!(at(0.25 + 1e-9).check().is_ok());
    assert!(at(f64::NAN).check().is_err());
}
