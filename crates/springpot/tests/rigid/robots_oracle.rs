//! Eight robots, three of them on floating bases and one with a joint that follows another, against the reference values of `testdata/multibody`, whole files.

use crate::support::robots::{ROBOTS, Robot, load, numbers};
use serde_json::Value;
use springpot::dynamics::{
    Kinematics, aba, aba_derivatives, angular_jacobian, christoffel, com, coriolis, crba, frame_jacobian,
    frame_jacobian_rate, gravity, kinetic_energy, mass_inverse, nonlinear_effects, point_jacobian, potential_energy,
    rnea, rnea_derivatives,
};

/// Keys of a state that are no results: the state itself, and how well the reference agrees with itself.
const NOT_COMPARED: [&str; 6] = ["q", "qd", "qdd", "tau", "christoffel_vs_C_matrix", "self_consistency_max"];

/// Compares one state; returns how many numbers were compared.
struct Comparison<'a> {
    robot: &'a str,
    state: &'a Value,
    seen: Vec<String>,
    count: usize,
}

impl Comparison<'_> {
    /// Compares to `tolerance` of the largest reference value.
    fn close(&mut self, key: &str, computed: &[f64], tolerance: f64) {
        let reference = numbers(&self.state[key]);
        let largest = reference.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        assert_eq!(computed.len(), reference.len(), "{} {key}", self.robot);
        for (k, (c, r)) in computed.iter().zip(&reference).enumerate() {
            assert!((c - r).abs() <= tolerance * largest, "{} {key}[{k}]: {c} instead of {r}", self.robot);
        }
        self.count += reference.len();
        self.seen.push(key.into());
    }

    fn finish(self) -> usize {
        for (key, value) in self.state.as_object().unwrap() {
            let compared = self.seen.contains(key) || NOT_COMPARED.contains(&key.as_str());
            assert!(compared || value.is_null(), "{} {key} is not compared", self.robot);
        }
        self.count
    }
}

fn times(matrix: &[f64], v: &[f64]) -> Vec<f64> {
    matrix.chunks(v.len()).map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum()).collect()
}

fn compare(name: &str, robot: &Robot, state: &Value) -> usize {
    let model = &robot.model;
    let n = model.nv();
    let [q, v, a, tau] = ["q", "qd", "qdd", "tau"].map(|key| numbers(&state[key]));
    let kinematics = Kinematics::at_velocity(model, &q, &v);
    let mut check = Comparison { robot: name, state, seen: Vec::new(), count: 0 };

    check.close("M", &crba(model, &kinematics), 1e-12);
    let coriolis = coriolis(model, &kinematics);
    check.close("C_matrix", &coriolis, 1e-12);
    check.close("Cqd", &times(&coriolis, &v), 1e-12);
    if !state["christoffel1"].is_null() {
        let gamma = christoffel(model, &kinematics);
        // The reference has the force index first.
        let moved: Vec<f64> = (0..n * n * n).map(|k| gamma[(k % (n * n)) * n + k / (n * n)]).collect();
        check.close("christoffel1", &moved, 1e-12);
    }
    check.close("g", &gravity(model, &kinematics), 1e-12);
    check.close("nle", &nonlinear_effects(model, &q, &v, &[]), 1e-12);
    check.close("rnea", &rnea(model, &q, &v, &a, &[]), 1e-12);
    check.close("aba", &aba(model, &q, &v, &tau, &[]), 1e-12);
    check.close("daba_dtau", &mass_inverse(model, &kinematics), 1e-12);

    let slopes = rnea_derivatives(model, &q, &v, &a, &[]);
    check.close("drnea_dq", &slopes.d_q, 1e-10);
    check.close("drnea_dqd", &slopes.d_v, 1e-10);
    let slopes = aba_derivatives(model, &q, &v, &tau, &[]);
    check.close("daba_dq", &slopes.d_q, 1e-10);
    check.close("daba_dqd", &slopes.d_v, 1e-10);

    let pose = kinematics.frame(&robot.end);
    check.close("ee_R", pose.rotation.0.as_flattened(), 1e-12);
    check.close("ee_p", &pose.translation.0, 1e-12);
    let jacobian = frame_jacobian(model, &kinematics, &robot.end);
    check.close("ee_J_lwa", &jacobian, 1e-12);
    check.close("ee_Jdot_lwa", &frame_jacobian_rate(model, &kinematics, &robot.end), 1e-12);
    let by_parts =
        [point_jacobian(model, &kinematics, &robot.end_site), angular_jacobian(model, &kinematics, &robot.end_site)];
    check.close("ee_J_lwa", &by_parts.concat(), 1e-12);

    check.close("kinetic", &[kinetic_energy(model, &kinematics)], 1e-12);
    check.close("potential", &[potential_energy(model, &kinematics)], 1e-12);
    check.close("com", &com(model, &kinematics).0, 1e-12);
    check.finish()
}

#[test]
fn all_robots_in_all_states() {
    let mut compared = 0;
    for (name, states) in ROBOTS {
        let robot = load(name);
        assert_eq!(robot.states.len(), states, "{name}");
        let n = robot.model.nv();
        let christoffel = if n <= 9 { n * n * n } else { 0 };
        for state in &robot.states {
            let count = compare(name, &robot, state);
            assert_eq!(count, 7 * n * n + christoffel + 5 * n + 9 + 3 + 3 * 6 * n + 1 + 1 + 3, "{name}");
            compared += count;
        }
    }
    assert_eq!(compared, 82_536);
}
