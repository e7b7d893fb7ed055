//! Where all orders are whole the eigenvalues are those of a matrix that the test builds by itself.

use crate::support::system;
use crate::{arm, linear, modes, on_joints, slider};
use num_complex::Complex64;
use springpot::dynamics::{Kinematics, crba, nonlinear_effects};
use springpot::system::System;

/// A law on a joint, as a table and as k beside c beside branches of (k, c) in series.
struct Law {
    table: String,
    spring: f64,
    dashpot: f64,
    branches: Vec<(f64, f64)>,
}

fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn law(state: &mut u64) -> Law {
    let mut value = |low: f64, high: f64| low * (high / low).powf(uniform(state));
    let (k, c, k_m, c_m) = (value(5.0, 500.0), value(0.1, 20.0), value(10.0, 300.0), value(0.5, 30.0));
    let kind = (value(1.0, 4.0) - 1.0) as usize;
    match kind {
        0 => Law {
            table: format!("law = \"kelvin-voigt\"\nparameters = {{ k = {k}, c = {c} }}"),
            spring: k,
            dashpot: c,
            branches: vec![],
        },
        1 => Law {
            table: format!("law = \"zener\"\nparameters = {{ k_e = {k}, k_m = {k_m}, c = {c_m} }}"),
            spring: k,
            dashpot: 0.0,
            branches: vec![(k_m, c_m)],
        },
        _ => Law {
            table: format!(
                "network = \"parallel(spring(k), dashpot(c), series(spring(k_m), dashpot(c_m)), series(dashpot(c), spring(k)))\"\n\
                 parameters = {{ k = {k}, c = {c}, k_m = {k_m}, c_m = {c_m} }}"
            ),
            spring: k,
            dashpot: c,
            branches: vec![(k_m, c_m), (k, c)],
        },
    }
}

/// The matrix of q, v and the forces of the branches; gravity's stiffness by differences.
fn matrix(system: &System, q: &[f64], laws: &[Law]) -> Vec<Vec<f64>> {
    let model = &system.model;
    let n = model.nv();
    let size = 2 * n + laws.iter().map(|law| law.branches.len()).sum::<usize>();
    let mass = crba(model, &Kinematics::at_position(model, q));
    let weight = |q: &[f64]| nonlinear_effects(model, q, &vec![0.0; n], &[]);
    // M a = −K q − C v − Σ branches.
    let mut force = vec![vec![0.0; size]; n];
    for c in 0..n {
        let moved = |h: f64| {
            let mut step = vec![0.0; n];
            step[c] = h;
            weight(&model.integrate(q, &step))
        };
        let h = 1e-3;
        let [a, b, d, e, f, g] = [3.0, 2.0, 1.0, -1.0, -2.0, -3.0].map(|k| moved(k * h));
        for r in 0..n {
            force[r][c] = -(45.0 * (d[r] - e[r]) - 9.0 * (b[r] - f[r]) + (a[r] - g[r])) / (60.0 * h);
        }
    }
    let mut rows = vec![vec![0.0; size]; size];
    let mut next = 2 * n;
    for (j, law) in laws.iter().enumerate() {
        force[j][j] -= law.spring;
        force[j][n + j] -= law.dashpot;
        for (k, c) in &law.branches {
            // F' = k x' − F k/c.
            force[j][next] -= 1.0;
            rows[next][n + j] = *k;
            rows[next][next] = -k / c;
            next += 1;
        }
    }
    for column in 0..size {
        let right: Vec<Complex64> = force.iter().map(|row| row[column].into()).collect();
        let matrix: Vec<Vec<Complex64>> = (0..n).map(|r| (0..n).map(|c| mass[r * n + c].into()).collect()).collect();
        let solved = solve(matrix, right);
        (0..n).for_each(|r| rows[n + r][column] = solved[r].re);
    }
    (0..n).for_each(|k| rows[k][n + k] = 1.0);
    rows
}

/// By elimination with partial pivoting.
fn solve(mut m: Vec<Vec<Complex64>>, mut b: Vec<Complex64>) -> Vec<Complex64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[i][k].norm().total_cmp(&m[j][k].norm())).unwrap();
        m.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = m[i][k] / m[k][k];
            for j in k..n {
                let entry = factor * m[k][j];
                m[i][j] -= entry;
            }
            let entry = factor * b[k];
            b[i] -= entry;
        }
    }
    for k in (0..n).rev() {
        let sum: Complex64 = (k + 1..n).map(|j| m[k][j] * b[j]).sum();
        b[k] = (b[k] - sum) / m[k][k];
    }
    b
}

/// Newton's correction of an eigenvalue, 1/tr (A − s)⁻¹: how far the nearest one is.
fn correction(a: &[Vec<f64>], s: Complex64) -> f64 {
    let n = a.len();
    let shifted = || -> Vec<Vec<Complex64>> {
        let entry = |r: usize, c: usize| Complex64::from(a[r][c]) - if r == c { s } else { Complex64::ZERO };
        (0..n).map(|r| (0..n).map(|c| entry(r, c)).collect()).collect()
    };
    let unit = |c: usize| (0..n).map(|r| if r == c { Complex64::ONE } else { Complex64::ZERO }).collect();
    let trace: Complex64 = (0..n).map(|c| solve(shifted(), unit(c))[c]).sum();
    trace.inv().norm()
}

#[test]
fn eigenvalues_of_random_robots_are_those_of_their_matrix() {
    let mut state = 7;
    for _ in 0..30 {
        let laws = [law(&mut state), law(&mut state), law(&mut state)];
        let [a, b, c] = [0, 1, 2].map(|k| laws[k].table.as_str());
        let [q1, q2, q3] = [0, 1, 2].map(|_| 2.0 * uniform(&mut state) - 1.0);
        let text = arm(&on_joints([a, b, c]), &format!("start = {{ q = {{ q1 = {q1}, q2 = {q2}, q3 = {q3} }} }}"));
        let system = system(&text);
        let expected = matrix(&system, &[q1, q2, q3], &laws);
        let modes = modes(&system);
        let mut trace = Complex64::ZERO;
        let mut count = 0;
        for mode in &modes.modes {
            let s = mode.eigenvalue;
            let off = correction(&expected, s);
            assert!(
                off < 1e-12 * s.norm().max(0.1 * modes.modes.last().unwrap().eigenvalue.norm()),
                "{s}: {off}\n{text}"
            );
            trace += if s.im > 0.0 { Complex64::from(2.0 * s.re) } else { s };
            count += if s.im > 0.0 { 2 } else { 1 };
        }
        let own: f64 = (0..expected.len()).map(|k| expected[k][k]).sum();
        assert_eq!(count, expected.len(), "{modes:?}\n{text}");
        assert!((trace.re - own).abs() < 1e-10 * own.abs(), "{trace} {own}");
        // The vector is one of the equations.
        let linear = linear(&system);
        assert!(modes.modes.iter().all(|mode| (mode.shape[mode.largest] - 1.0).norm() < 1e-12));
        assert_eq!(linear.free, [0, 1, 2]);
    }
}

#[test]
fn closed_forms() {
    let time = "[time]\nend = 1\noutput_step = 0.5";
    let one = |law: &str| modes(&system(&slider(2.0, law, "", time)));
    let near = |s: Complex64, re: f64, im: f64| (s - Complex64::new(re, im)).norm() < 1e-12 * s.norm();
    let spring = one("law = \"spring\"\nparameters = { k = 50 }");
    assert!(spring.modes.len() == 1 && near(spring.modes[0].eigenvalue, 0.0, 5.0), "{spring:?}");
    assert_eq!((spring.modes[0].time_constant().is_infinite(), spring.modes[0].is_unstable()), (true, false));
    let overdamped = one("law = \"kelvin-voigt\"\nparameters = { k = 32, c = 20 }");
    assert!(near(overdamped.modes[0].eigenvalue, -2.0, 0.0) && near(overdamped.modes[1].eigenvalue, -8.0, 0.0));
    assert!((overdamped.modes[0].damping_ratio() - 1.0).abs() < 1e-15);
    // The orders 0 and 1 of a springpot are a spring and a dashpot.
    let springpot = one("law = \"fractional-kelvin-voigt\"\nparameters = { k = 32, c = 20, alpha = 1 }");
    assert_eq!(springpot, overdamped);
    // Twice the same: semisimple; and critically damped, where half of the digits go.
    let critical = one("law = \"kelvin-voigt\"\nparameters = { k = 32, c = 16 }");
    assert!(critical.modes.iter().all(|mode| (mode.eigenvalue + 4.0).norm() < 1e-6), "{critical:?}");
    // Nothing holds it: only the dashpot slows it down.
    let free = one("law = \"dashpot\"\nparameters = { c = 6 }");
    assert!(free.free_motions == 1 && free.modes.len() == 1 && near(free.modes[0].eigenvalue, -3.0, 0.0), "{free:?}");
}

#[test]
fn what_falls_over_is_unstable() {
    let text = arm("", "start = { q = { q2 = \"-1.5\" } }\nlocked = [\"q1\", \"q3\"]");
    let modes = modes(&system(&text));
    let unstable: Vec<_> = modes.modes.iter().filter(|mode| mode.is_unstable()).collect();
    assert!(unstable.len() == 1 && unstable[0].eigenvalue.im == 0.0, "{modes:?}");
    assert!((modes.modes[0].eigenvalue + modes.modes[1].eigenvalue).norm() < 1e-12, "{modes:?}");
}
