//! Identities that tie the recursive algorithms to one another, on random trees, with elements and loads attached.

use crate::support::{Case, case, close, config, difference, largest, one_degree_case, time_difference};
use proptest::prelude::*;
use springpot::dynamics::{
    Kinematics, PairForce, aba, add_wrench, add_wrench_derivative, angular_jacobian, angular_jacobian_rate,
    cholesky_into, cholesky_solve_into, christoffel, com, com_jacobian, coriolis, crba, frame_jacobian,
    frame_jacobian_rate, gravity, mass_inverse, nonlinear_effects, point_jacobian, point_jacobian_rate,
    potential_energy, rnea,
};
use springpot::model::{Anchor, Model, Parent};
use springpot::spatial::{Force, Vec3};

fn times(matrix: &[f64], v: &[f64]) -> Vec<f64> {
    matrix.chunks(v.len()).map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum()).collect()
}

/// Two pairs: between the anchors, and from the second one to the world.
fn pairs(case: &Case, model: &Model, force: f64) -> [PairForce; 2] {
    let [from, to] = case.sites(model);
    let base = model.resolve(&Anchor { body: Parent::World, point: [2.0, -3.0, 4.0] }).unwrap();
    let pair = |from, to, force| PairForce { from, to, force, d_length: 0.0, d_rate: 0.0 };
    [pair(from, to, force), pair(to, base, 0.4 * force)]
}

fn apart(case: &Case, model: &Model) -> bool {
    let kinematics = Kinematics::at_position(model, &case.q);
    let [from, to] = case.sites(model).map(|site| kinematics.position(&site));
    (from - to).norm() > 0.15 && (to - Vec3([2.0, -3.0, 4.0])).norm() > 0.15
}

proptest! {
    #![proptest_config(config(0x5eed_0003))]

    #[test]
    fn forward_dynamics_undo_inverse_dynamics(case in case(), force in -100.0..100.0, with_pairs in any::<bool>()) {
        let model = case.model();
        prop_assume!(!with_pairs || apart(&case, &model));
        let pairs = pairs(&case, &model, force);
        let pairs = if with_pairs { &pairs[..] } else { &[] };
        let tau = rnea(&model, &case.q, &case.v, &case.a, pairs);
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        // The error of a is at most the condition of M times that of the forces.
        let (mass, inverse) = (crba(&model, &kinematics), mass_inverse(&model, &kinematics));
        let forces = largest(&tau).max(largest(&nonlinear_effects(&model, &case.q, &case.v, pairs)));
        let scale = largest(&inverse) * (forces + largest(&mass) * largest(&case.a));
        close("a", &aba(&model, &case.q, &case.v, &tau, pairs), &case.a, 1e-12, scale.max(largest(&case.a)));
    }

    #[test]
    fn factors_and_inverse_of_the_mass_matrix(case in case()) {
        let model = case.model();
        let n = model.nv();
        let kinematics = Kinematics::at_position(&model, &case.q);
        let (mass, inverse) = (crba(&model, &kinematics), mass_inverse(&model, &kinematics));
        let mut product = vec![0.0; n * n];
        let mut unit = vec![0.0; n * n];
        for r in 0..n {
            unit[r * n + r] = 1.0;
            for c in 0..n {
                product[r * n + c] = (0..n).map(|k| inverse[r * n + k] * mass[k * n + c]).sum();
            }
        }
        close("Minv M", &product, &unit, 1e-13, (largest(&inverse) * largest(&mass)).max(1.0));
        prop_assert!((0..n * n).all(|k| inverse[k] == inverse[(k % n) * n + k / n]));

        let mut factor = mass.clone();
        cholesky_into(&model, &mut factor);
        let l = |r: usize, c: usize| if r == c { 1.0 } else if r > c { factor[r * n + c] } else { 0.0 };
        let rebuilt: Vec<f64> = (0..n * n)
            .map(|k| (0..n).map(|i| l(i, k / n) * factor[i * n + i] * l(i, k % n)).sum())
            .collect();
        close("LT D L", &rebuilt, &mass, 1e-14 * n as f64, largest(&mass));
        let mut x = times(&mass, &case.a);
        cholesky_solve_into(&model, &factor, &mut x);
        close("x", &x, &case.a, 1e-13, (largest(&inverse) * largest(&mass)).max(1.0) * largest(&case.a));
    }

    #[test]
    fn the_coriolis_matrix_belongs_to_the_christoffel_symbols(case in one_degree_case()) {
        let model = case.model();
        let n = model.nv();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let (matrix, gamma) = (coriolis(&model, &kinematics), christoffel(&model, &kinematics));
        let expected: Vec<f64> = (0..n * n)
            .map(|k| (0..n).map(|b| gamma[((k % n) * n + b) * n + k / n] * case.v[b]).sum())
            .collect();
        let scale = largest(&expected).max(largest(&crba(&model, &kinematics)));
        close("C", &matrix, &expected, 1e-13, scale);
    }

    #[test]
    fn the_coriolis_matrix(case in case()) {
        let model = case.model();
        let n = model.nv();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let matrix = coriolis(&model, &kinematics);
        let mut forces = times(&matrix, &case.v);
        for (force, g) in forces.iter_mut().zip(gravity(&model, &kinematics)) {
            *force += g;
        }
        let scale = largest(&matrix).max(largest(&crba(&model, &kinematics)));
        close("C v + g", &nonlinear_effects(&model, &case.q, &case.v, &[]), &forces, 1e-12, largest(&forces).max(scale));

        // Mdot − 2 C is antisymmetric: Mdot = C + C transposed.
        let still = Case { a: vec![0.0; n], ..case.clone() };
        let rate = time_difference(&model, &still, |q, _| crba(&model, &Kinematics::at_position(&model, q)));
        let sum: Vec<f64> = (0..n * n).map(|k| matrix[k] + matrix[(k % n) * n + k / n]).collect();
        close("Mdot", &sum, &rate, 1e-7, scale);
    }

    #[test]
    fn the_centre_of_mass_and_its_jacobian(case in case()) {
        let model = case.model();
        let kinematics = Kinematics::at_position(&model, &case.q);
        let (centre, jacobian) = (com(&model, &kinematics), com_jacobian(&model, &kinematics));
        let mass: f64 = (0..model.joint_count()).map(|j| model.link_inertia(j).mass).sum();
        let weight = -mass * Vec3(model.gravity()).dot(centre);
        let potential = potential_energy(&model, &kinematics);
        close("V", &[weight], &[potential], 1e-12, potential.abs().max(mass));
        let place = |q: &[f64]| com(&model, &Kinematics::at_position(&model, q)).0.to_vec();
        for j in 0..model.nv() {
            let column: Vec<f64> = (0..3).map(|r| jacobian[r * model.nv() + j]).collect();
            close("J", &column, &difference(&model, &case.q, j, place), 1e-10, largest(&column).max(1.0));
        }
    }

    #[test]
    fn frames_have_the_jacobians_of_their_origins(case in case()) {
        let model = case.model();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        for anchor in case.anchors {
            let frame = model.frame(anchor.body).unwrap();
            let site = model.resolve(&Anchor { point: [0.0; 3], ..anchor }).unwrap();
            let (k, m) = (&kinematics, &model);
            let jacobian = [point_jacobian(m, k, &site), angular_jacobian(m, k, &site)].concat();
            close("J", &frame_jacobian(m, k, &frame), &jacobian, 1e-14, largest(&jacobian).max(1.0));
            let rate = [point_jacobian_rate(m, k, &site), angular_jacobian_rate(m, k, &site)].concat();
            close("dJ/dt", &frame_jacobian_rate(m, k, &frame), &rate, 1e-13, largest(&rate).max(1.0));
        }
    }

    #[test]
    fn wrenches(case in case(), f in proptest::array::uniform6(-3.0..3.0)) {
        let model = case.model();
        let n = model.nv();
        let wrench = Force { linear: Vec3([f[0], f[1], f[2]]), angular: Vec3([f[3], f[4], f[5]]) };
        let site = case.sites(&model)[0];
        let generalized = |q: &[f64]| {
            let mut force = vec![0.0; n];
            add_wrench(&model, &Kinematics::at_position(&model, q), &site, wrench, &mut force);
            force
        };
        // Power: f·ṙ + n·ω = Q·v.
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let power = wrench.linear.dot(kinematics.velocity(&site))
            + wrench.angular.dot(kinematics.link_velocity(site.link()).angular);
        let by_joints: f64 = generalized(&case.q).iter().zip(&case.v).map(|(q, v)| q * v).sum();
        prop_assert!((power - by_joints).abs() <= 1e-12 * (1.0 + power.abs()));

        let mut slope = vec![0.0; n * n];
        add_wrench_derivative(&model, &kinematics, &site, wrench, &mut slope);
        for c in 0..n {
            let column: Vec<f64> = (0..n).map(|b| slope[b * n + c]).collect();
            close("dQ", &column, &difference(&model, &case.q, c, generalized), 1e-9, largest(&slope).max(1.0));
        }
    }
}
