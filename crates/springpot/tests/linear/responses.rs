//! Answers to sines against long forced runs.

use crate::support::{run, system};
use crate::{arm, linear, on_joints, slider};
use num_complex::Complex64;
use springpot::linear::{Excitation, NoResponse};
use springpot::observe::{Axis, ElementQuantity, EnergyQuantity, Quantity};
use std::f64::consts::TAU;

/// The complex amplitude of the last period of a column that answers cos ωt, by least squares over equal steps.
fn amplitude(t: &[f64], values: &[f64], omega: f64, steps: usize) -> Complex64 {
    let from = t.len() - steps;
    let mut sum = Complex64::ZERO;
    for (t, value) in t[from..].iter().zip(&values[from..]) {
        sum += Complex64::from_polar(*value, -omega * t);
    }
    2.0 * sum / steps as f64
}

#[test]
fn a_forced_mass_answers_as_a_long_run_does() {
    let law = "law = \"fractional-zener\"\nparameters = { k_e = 40, k_m = 200, c = 25, alpha = 0.6 }";
    let (periods, steps) = (60, 64);
    for hertz in [0.3, 1.0, 2.5] {
        let omega = TAU * hertz;
        let torque = format!("torque = {{ x = \"cos({omega:?}*t)\" }}");
        let end = f64::from(periods) / hertz;
        let step = 1.0 / hertz / f64::from(steps);
        let time = format!("[time]\nend = {end:?}\noutput_step = {step:?}\n[solver]\nrtol = 1e-8");
        let text = slider(1.5, law, &torque, &time);
        let run = run(&text);
        let linear = linear(&system(&text));
        for (column, quantity) in [
            ("q.x", Quantity::Coordinate(0)),
            ("v.x", Quantity::Velocity(0)),
            ("a.x", Quantity::Acceleration(0)),
            ("tau.x", Quantity::Torque(0)),
            ("e.stroke", Quantity::Element(0, ElementQuantity::Stroke)),
            ("e.rate", Quantity::Element(0, ElementQuantity::Rate)),
            ("e.derivative", Quantity::Element(0, ElementQuantity::Derivative)),
            ("e.force", Quantity::Element(0, ElementQuantity::Force)),
            ("e.Q.x", Quantity::Element(0, ElementQuantity::GeneralizedForce(0))),
        ] {
            let own = linear.frequency_response(Excitation::Torque(0), quantity, omega).unwrap();
            let measured = amplitude(&run.t(), &run.column(column), omega, steps as usize);
            assert!((own - measured).norm() < 2e-4 * own.norm(), "{hertz} Hz {column}: {own} {measured}");
        }
    }
}

#[test]
fn shaken_and_commanded_robots_answer_as_long_runs_do() {
    let strut = "\n[[element]]\nname = \"strut\"\nfrom = { body = \"column\", point = [0.14, -0.1, 0.08] }\n\
         to = { body = \"forearm\", point = [-0.06, 0.1, 0.08] }\nrest_length = \"70 cm\"\nlaw = \"piezo-kelvin-voigt\"\n\
         parameters = { E_c = 300, E_pz = 900, E_d = 40, alpha = 0.5, alpha_pz = 1e-3 }\n";
    let joints = on_joints([
        "law = \"kelvin-voigt\"\nparameters = { k = 20, c = 30 }",
        "law = \"kelvin-voigt\"\nparameters = { k = 200, c = 8 }",
        "law = \"fractional-kelvin-voigt\"\nparameters = { k = 60, c = 12, alpha = 0.5 }",
    ]);
    let (omega, amp) = (TAU, 1e-4);
    let shaken = format!("prescribed = {{ q2 = \"0.3 + {amp:?}*cos({omega:?}*t)\" }}");
    let commanded = "locked = [\"q2\"]";
    for (motion, u, excitation, scale) in [
        (shaken.as_str(), "0".to_owned(), Excitation::Motion(1), amp),
        (commanded, format!("0.1*cos({omega:?}*t)"), Excitation::Input(3, 0), 0.1),
    ] {
        let elements = format!("{joints}{strut}inputs = {{ U = \"{u}\" }}\n");
        // From where it rests without the excitation.
        let text = |q1: f64, q3: f64| {
            arm(&elements, &format!("start = {{ q = {{ q1 = {q1:?}, q2 = 0.3, q3 = {q3:?} }} }}\n{motion}"))
        };
        let quiet = |text: String| text.replace(&format!("+ {amp:?}*cos"), "+ 0*cos").replace("0.1*cos", "0*cos");
        let rest = system(&quiet(text(0.0, 0.2))).equilibrium(&[0.0, 0.3, 0.2], 0.0).unwrap().q;
        let started = text(rest[0], rest[2]);
        let linear = system(&quiet(started.clone())).linearised(&rest, 0.0).unwrap();
        let long = started.replace(
            "[time]\nend = 1\noutput_step = 0.5\n",
            "[time]\nend = 40\noutput_step = 0.03125\n[solver]\nrtol = 1e-8\n",
        );
        let run = run(&long);
        for (column, quantity) in [
            ("q.q3", Quantity::Coordinate(2)),
            ("tau.q2", Quantity::Torque(1)),
            ("strut.length", Quantity::Element(3, ElementQuantity::Length)),
            ("strut.force", Quantity::Element(3, ElementQuantity::Force)),
            ("strut.Q.q3", Quantity::Element(3, ElementQuantity::GeneralizedForce(2))),
            ("gripper.x", Quantity::Gripper(Axis::X)),
            ("gripper.z", Quantity::Gripper(Axis::Z)),
        ] {
            let own = linear.frequency_response(excitation, quantity, omega).unwrap();
            let measured = amplitude(&run.t(), &run.column(column), omega, 32) / scale;
            assert!((own - measured).norm() < 5e-3 * own.norm(), "{column}: {own} {measured}");
        }
    }
}

#[test]
fn energies_do_not_answer() {
    let law = "law = \"spring\"\nparameters = { k = 40 }";
    let linear = linear(&system(&slider(1.5, law, "", "[time]\nend = 1\noutput_step = 1")));
    let of = |quantity| linear.frequency_response(Excitation::Torque(0), quantity, 1.0);
    assert_eq!(of(Quantity::Energy(EnergyQuantity::Kinetic)), Err(NoResponse::Energy));
    assert_eq!(of(Quantity::Element(0, ElementQuantity::Stored)), Err(NoResponse::Energy));
    assert_eq!(of(Quantity::Time), Err(NoResponse::NotLinear));
    assert_eq!(of(Quantity::Gripper(Axis::X)), Err(NoResponse::None));
    assert!((of(Quantity::Coordinate(0)).unwrap() - (40.0f64 - 1.5).recip()).norm() < 1e-15);
}
