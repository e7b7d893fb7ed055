//! Closed loops: eigenvalues against closed forms, answers against long runs, and where they come to rest.

use crate::support::{run, system};
use crate::{arm, linear, modes, on_joints, slider};
use num_complex::Complex64;
use springpot::linear::Excitation;
use springpot::observe::{ElementQuantity, Quantity};
use springpot::system::System;
use std::f64::consts::TAU;

const TIME: &str = "[time]\nend = 1\noutput_step = 0.5";
const SPRING: &str = "law = \"spring\"\nparameters = { k = 30 }";

fn controlled(law: &str, controller: &str) -> System {
    system(&slider(2.0, law, &format!("[motion.controller]\n{controller}"), TIME))
}

/// Every eigenvalue makes these terms of one equation vanish.
fn vanishes(system: &System, count: usize, terms: &dyn Fn(Complex64) -> Vec<Complex64>) {
    let modes = modes(system);
    let found: usize = modes.modes.iter().map(|mode| if mode.eigenvalue.im > 0.0 { 2 } else { 1 }).sum();
    assert_eq!(found, count, "{modes:?}");
    for mode in &modes.modes {
        let all = terms(mode.eigenvalue);
        let [sum, size] = [all.iter().sum::<Complex64>().norm(), all.iter().map(|term| term.norm()).sum()];
        assert!(sum < 1e-12 * size, "{}: {sum} of {size}", mode.eigenvalue);
    }
}

#[test]
fn controllers_of_one_mass_have_the_roots_of_their_equation() {
    let reference = "reference = { kind = \"joints\", x = 0.1 }";
    vanishes(&controlled(SPRING, &format!("kind = \"pid\"\nkp = 20\nki = 15\nkd = 4\n{reference}")), 3, &|s| {
        vec![2.0 * s * s, 4.0 * s, 50.0.into(), 15.0 / s]
    });
    vanishes(&controlled(SPRING, &format!("kind = \"pd-gravity\"\nkp = 20\nkd = 4\n{reference}")), 2, &|s| {
        vec![2.0 * s * s, 4.0 * s, 50.0.into()]
    });
    for [lambda, mu] in [[0.5, 0.8], [0.9, 0.3], [0.25, 0.5]] {
        let law =
            format!("kind = \"fractional-pid\"\nkp = 20\nki = 15\nkd = 6\nlambda = {lambda}\nmu = {mu}\n{reference}");
        let system = controlled(SPRING, &law);
        let modes = modes(&system);
        assert!(modes.is_complete() && modes.free_motions == 0 && !modes.modes.is_empty(), "{modes:?}");
        vanishes(&system, modes.found, &|s| vec![2.0 * s * s, 50.0.into(), 15.0 * s.powf(-lambda), 6.0 * s.powf(mu)]);
    }
    // Behind a filter, of the error and of the measurement.
    for on in ["error", "measurement"] {
        let shaped = format!("filter = 0.05\nderivative_on = \"{on}\"\nset_point_weight = 0.6\n{reference}");
        vanishes(&controlled(SPRING, &format!("kind = \"pid\"\nkp = 20\nki = 15\nkd = 4\n{shaped}")), 4, &|s| {
            vec![2.0 * s * s, 4.0 * s / (1.0 + 0.05 * s), 50.0.into(), 15.0 / s]
        });
        let law = format!("kind = \"fractional-pid\"\nkp = 20\nkd = 6\nmu = 0.6\n{shaped}");
        let system = controlled(SPRING, &law);
        vanishes(&system, modes(&system).found, &|s| {
            vec![2.0 * s * s, 50.0.into(), 6.0 * s.powf(0.6) / (1.0 + 0.05 * s)]
        });
        // Its answer to the reference, of which the parts see what they are to see.
        let linear = linear(&system);
        let column = Quantity::Coordinate(0);
        for omega in [0.5, 4.0, 30.0] {
            let s = Complex64::new(0.0, omega);
            let filtered = 6.0 * s.powf(0.6) / (1.0 + 0.05 * s);
            let seen = 0.6 * 20.0 + if on == "error" { filtered } else { Complex64::ZERO };
            let wanted = seen / (2.0 * s * s + 50.0 + filtered);
            let found = linear.frequency_response(Excitation::Reference(0), column, omega).unwrap();
            assert!((found - wanted).norm() < 1e-12 * wanted.norm(), "{on} at {omega}: {found} {wanted}");
        }
    }
    // At its limit a force does not follow, and the integral neither.
    let bound = format!("kind = \"pid\"\nkp = 20\nki = 15\nkd = 4\nlimits = {{ x = 1 }}\n{reference}");
    vanishes(&controlled("law = \"spring\"\nparameters = { k = 30 }\nrest = 0.4", &bound), 2, &|s| {
        vec![2.0 * s * s, 30.0.into()]
    });
}

#[test]
fn feedback_by_expressions_is_in_torques_and_inputs() {
    let torque = |expression: &str| system(&slider(2.0, SPRING, &format!("torque = {{ x = \"{expression}\" }}"), TIME));
    vanishes(&torque("-5*sin(2*q.x) - 3*v.x - 2*abs(q.x - 1) + 2*e.rate"), 2, &|s| {
        vec![2.0 * s * s, s, (30.0 + 10.0 - 2.0).into()]
    });
    // F = (E_c + E_pz) x + E_d D^½ x − alpha_pz·E_pz·U.
    let piezo = "law = \"piezo-kelvin-voigt\"\nparameters = { E_c = 30, E_pz = 90, E_d = 4, alpha = 0.5, alpha_pz = 0.01 }\n\
                 inputs = { U = \"-20*q.x - 3*v.x\" }";
    vanishes(&system(&slider(2.0, piezo, "", TIME)), 2, &|s| {
        vec![2.0 * s * s, 120.0.into(), 4.0 * s.powf(0.5), (0.9 * (20.0 + 3.0 * s))]
    });
}

#[test]
fn a_robot_whose_dynamics_are_computed_is_as_many_masses() {
    let laws = on_joints([
        "law = \"fractional-kelvin-voigt\"\nparameters = { k = 20, c = 5, alpha = 0.4 }",
        "law = \"maxwell\"\nparameters = { k = 100, c = 8 }",
        "law = \"kelvin-voigt\"\nparameters = { k = 60, c = 2 }",
    ]);
    let controller = "[motion.controller]\nkind = \"computed-torque\"\nkp = 100\nkd = 12\ncompensate_elements = true\n\
                      reference = { kind = \"joints\", q1 = 0.2, q2 = 0.4, q3 = -0.3 }";
    let system = system(&arm(&laws, &format!("start = {{ q = {{ q1 = 0.2, q2 = 0.4, q3 = -0.3 }} }}\n{controller}")));
    let about = linear(&system);
    assert_eq!(about.largest_left_over(), None);
    for omega in [0.5, 10.0, 80.0] {
        let s = Complex64::new(0.0, omega);
        for k in 0..3 {
            let own = about.frequency_response(Excitation::Reference(k), Quantity::Coordinate(k), omega).unwrap();
            // The reference asks for its acceleration too.
            assert!((own - 1.0).norm() < 1e-9, "{omega} {k}: {own}");
            let torque = about.frequency_response(Excitation::Torque(k), Quantity::Velocity(k), omega).unwrap();
            let inverse = inverse_mass(&about.mass, 3, k);
            let expected = s * inverse / (s * s + 12.0 * s + 100.0);
            assert!((torque - expected).norm() < 1e-9 * expected.norm(), "{omega} {k}: {torque} {expected}");
        }
    }
    let all = about.modes().unwrap();
    let closed = Complex64::new(-6.0, 8.0);
    let near = all.modes.iter().filter(|mode| (mode.eigenvalue - closed).norm() < 1e-6).count();
    assert_eq!(near, 3, "{all:?}");
}

/// Entry (k, k) of the inverse of an n × n matrix.
fn inverse_mass(mass: &[f64], n: usize, k: usize) -> f64 {
    let minor = |row: usize| -> f64 {
        let left: Vec<usize> = (0..n).filter(|&r| r != row).collect();
        let [a, b] = [left[0], left[1]];
        mass[a * n + a] * mass[b * n + b] - mass[a * n + b] * mass[b * n + a]
    };
    let m = |r: usize, c: usize| mass[r * n + c];
    let determinant = m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1))
        - m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0))
        + m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0));
    minor(k) / determinant
}

#[test]
fn a_controlled_mass_answers_as_a_long_run_does() {
    let law = "law = \"fractional-zener\"\nparameters = { k_e = 40, k_m = 200, c = 25, alpha = 0.6 }";
    let (hertz, periods, steps) = (1.0, 60, 64);
    let omega = TAU * hertz;
    let motion = format!(
        "torque = {{ x = \"cos({omega:?}*t)\" }}\n[motion.controller]\nkind = \"fractional-pid\"\nkp = 30\nki = 20\nkd = 12\n\
         lambda = 1\nmu = 0.6\nreference = {{ kind = \"joints\", x = 0 }}"
    );
    let time =
        format!("[time]\nend = {periods}\noutput_step = {:?}\n[solver]\nrtol = 1e-8", hertz.recip() / f64::from(steps));
    let text = slider(1.5, law, &motion, &time);
    let run = run(&text);
    let about = linear(&system(&text));
    for (column, quantity) in [
        ("q.x", Quantity::Coordinate(0)),
        ("v.x", Quantity::Velocity(0)),
        ("tau.x", Quantity::Torque(0)),
        ("e.force", Quantity::Element(0, ElementQuantity::Force)),
    ] {
        let own = about.frequency_response(Excitation::Torque(0), quantity, omega).unwrap();
        let (t, values) = (run.t(), run.column(column));
        let from = t.len() - steps as usize;
        let pairs = t[from..].iter().zip(&values[from..]);
        let sum: Complex64 = pairs.map(|(t, value)| Complex64::from_polar(*value, -omega * t)).sum();
        let measured = 2.0 * sum / f64::from(steps);
        assert!((own - measured).norm() < 2e-4 * own.norm(), "{column}: {own} {measured}");
    }
}

#[test]
fn controlled_robots_rest_where_their_controllers_hold_them() {
    let arm = |controller: &str| system(&arm("", &format!("[motion.controller]\n{controller}")));
    // What the integral does not hold sags: kp (q_d − q) = the torque of gravity.
    let reference = "reference = { kind = \"joints\", q1 = 0.1, q2 = 0.3, q3 = -0.2 }";
    let held = arm(&format!("kind = \"pid\"\nkp = 500\nki = {{ q1 = 3, q2 = 3, q3 = 3 }}\nkd = 20\n{reference}"));
    let rest = held.equilibrium(&[0.0; 3], 0.0).unwrap();
    assert_eq!(rest.q, [0.1, 0.3, -0.2]);
    let sagging = arm(&format!("kind = \"pid\"\nkp = 500\nki = 0\nkd = 20\n{reference}"));
    let rest = sagging.equilibrium(&[0.0; 3], 0.0).unwrap();
    let about = sagging.linearised(&rest.q, 0.0).unwrap();
    assert_eq!(about.largest_left_over(), None);
    assert!(rest.q[1] > 0.31 && rest.q[1] < 0.4 && (rest.q[0] - 0.1).abs() < 1e-12, "{rest:?}");
    // Gravity is taken off.
    let exact =
        arm(&format!("kind = \"pd-gravity\"\nkp = 500\nkd = 20\n{reference}")).equilibrium(&[0.0; 3], 0.0).unwrap();
    assert!(exact.q.iter().zip([0.1, 0.3, -0.2]).all(|(q, wanted)| (q - wanted).abs() < 1e-9), "{exact:?}");
}
