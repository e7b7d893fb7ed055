//! Momenta, regressors and second derivatives, against differences and against one another, on random trees of all joints.

use crate::support::{Case, case, close, config, difference, largest, plain_case, plain_difference, time_difference};
use proptest::prelude::*;
use springpot::dynamics::{
    BODY_NUMBERS, Kinematics, body_numbers, centroidal_matrix, centroidal_matrix_rate, christoffel, com, com_jacobian,
    crba, joint_torque_regressor, mass_derivative, rnea, rnea_derivatives, rnea_second_derivatives,
};
use springpot::model::Model;

/// A matrix of `rows` × n times x.
fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(x.len()).map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

/// Central differences along the tangent vectors of q, the index of the direction last.
fn by_q(model: &Model, q: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    last((0..model.nv()).map(|c| difference(model, q, c, &f)).collect())
}

fn last(columns: Vec<Vec<f64>>) -> Vec<f64> {
    (0..columns[0].len()).flat_map(|k| columns.iter().map(move |column| column[k])).collect()
}

proptest! {
    #![proptest_config(config(0x5eed_0031))]

    #[test]
    fn centroidal_momentum(case in case()) {
        let model = case.model();
        let (q, v, a) = (&case.q[..], &case.v[..], &case.a[..]);
        let kinematics = Kinematics::at_velocity(&model, q, v);
        let matrix = centroidal_matrix(&model, &kinematics);
        let n = model.nv();
        prop_assume!(com(&model, &kinematics).0.iter().all(|x| x.is_finite()));
        // Linear momentum is mass times the velocity of the centre.
        let total: f64 = (0..model.joint_count()).map(|j| model.link_inertia(j).mass).sum();
        let linear: Vec<f64> = com_jacobian(&model, &kinematics).iter().map(|x| total * x).collect();
        close("linear", &matrix[..3 * n], &linear, 1e-12, largest(&matrix).max(1.0));
        let rate = centroidal_matrix_rate(&model, &kinematics);
        let coasting = Case { a: vec![0.0; n], ..case.clone() };
        let differences = time_difference(&model, &coasting, |q, _| centroidal_matrix(&model, &Kinematics::at_position(&model, q)));
        let scale = largest(&rate).max(largest(&matrix) * largest(v)).max(1.0);
        close("rate", &rate, &differences, 1e-8, scale);
        let momentum = |q: &[f64], v: &[f64]| times(&centroidal_matrix(&model, &Kinematics::at_position(&model, q)), v);
        let found: Vec<f64> = times(&matrix, a).iter().zip(times(&rate, v)).map(|(x, y)| x + y).collect();
        close("rate of the momentum", &found, &time_difference(&model, &case, momentum), 1e-8, scale * largest(v).max(largest(a)).max(1.0));
    }

    #[test]
    fn torques_are_linear_in_the_numbers_of_bodies(case in case()) {
        let model = case.model();
        let (q, v, a) = (&case.q[..], &case.v[..], &case.a[..]);
        let kinematics = Kinematics::at_velocity(&model, q, v);
        let regressor = joint_torque_regressor(&model, &kinematics, a);
        prop_assert_eq!(regressor.len(), model.nv() * BODY_NUMBERS * model.body_names().len());
        let mut bodies = model.body_inertias().to_vec();
        for _ in 0..2 {
            let other = model.with_inertias(&bodies, &vec![0.0; model.joint_count()]);
            let tau = rnea(&other, q, v, a, &[]);
            close("Y π", &times(&regressor, &body_numbers(&other)), &tau, 1e-12, largest(&tau).max(1.0));
            bodies.reverse();
        }
    }

    #[test]
    fn the_derivative_of_the_mass_matrix(case in case()) {
        let model = case.model();
        let at = |q: &[f64]| Kinematics::at_position(&model, q);
        let found = mass_derivative(&model, &at(&case.q));
        let expected = by_q(&model, &case.q, |q| crba(&model, &at(q)));
        close("dM/dq", &found, &expected, 1e-8, largest(&expected).max(largest(&crba(&model, &at(&case.q)))));
    }

    #[test]
    fn the_derivative_of_the_mass_matrix_by_christoffel_symbols(case in plain_case()) {
        let model = case.model();
        let kinematics = Kinematics::at_position(&model, &case.q);
        let (n, gamma) = (model.nv(), christoffel(&model, &kinematics));
        let at = |a: usize, b: usize, c: usize| gamma[(a * n + b) * n + c];
        let expected: Vec<f64> = (0..n.pow(3))
            .map(|k| [k / (n * n), k / n % n, k % n])
            .map(|[a, b, c]| at(b, c, a) + at(a, c, b))
            .collect();
        close("dM/dq", &mass_derivative(&model, &kinematics), &expected, 1e-12, largest(&gamma).max(1.0));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..config(0x5eed_0032) })]

    #[test]
    fn second_derivatives_of_inverse_dynamics(case in case()) {
        let model = case.model();
        let (q, v, a) = (&case.q[..], &case.v[..], &case.a[..]);
        let found = rnea_second_derivatives(&model, q, v, a);
        let first = |q: &[f64], v: &[f64]| rnea_derivatives(&model, q, v, a, &[]);
        let slopes = first(q, v);
        let scale = [&slopes.d_q, &slopes.d_v, &slopes.d_a, &found.d_q_q, &found.d_v_q, &found.d_v_v]
            .iter().map(|x| largest(x)).fold(1.0, f64::max);
        close("by q, q", &found.d_q_q, &by_q(&model, q, |q| first(q, v).d_q), 1e-7, scale);
        close("by v, q", &found.d_v_q, &by_q(&model, q, |q| first(q, v).d_v), 1e-7, scale);
        let by_v: Vec<Vec<f64>> = (0..v.len()).map(|e| plain_difference(v, e, |v| first(q, v).d_v)).collect();
        close("by v, v", &found.d_v_v, &last(by_v), 1e-9, scale);
        let mass = mass_derivative(&model, &Kinematics::at_position(&model, q));
        close("by a, q", &found.d_a_q, &mass, 1e-12, largest(&mass).max(largest(&slopes.d_a)));
    }
}
