//! Stiff elements, elements that cannot make energy, friction.

use crate::loops::*;
use springpot::methods::fixed::{Loop, Method};
use springpot::system::System;

/// The swinging arm, its strut unloaded at the start.
fn unloaded(law: &str) -> System {
    let start = "start = { q = { q2 = 0.3, q3 = -0.9 }, v = { q1 = 2.5, q2 = 1 } }";
    let mut system = system(&arm(&(strut(law) + &free(start))));
    let length = Loop::new(&system, Method::BackwardEuler, 1e-3, MEMORY).unwrap().length(0);
    system.elements[0].rest = length;
    system
}

#[test]
fn stiff_elements_stay_bounded() {
    let laws = [
        "law = \"spring\"\nparameters = { k = 1e9 }",
        "law = \"kelvin-voigt\"\nparameters = { k = 1e9, c = 1e6 }",
        "law = \"springpot\"\nparameters = { c = 1e9, alpha = 0.1 }",
        "law = \"springpot\"\nparameters = { c = 1e9, alpha = 0.5 }",
        "law = \"springpot\"\nparameters = { c = 1e9, alpha = 0.9 }",
    ];
    for (law, methods) in laws.iter().zip([2, 2, 2, 1, 1]) {
        let system = unloaded(law);
        for method in &METHODS[..methods] {
            let mut robot = Loop::new(&system, *method, 1e-3, MEMORY).unwrap();
            let energy =
                |robot: &Loop| robot.kinetic_energy() + robot.potential_energy() + robot.stored_energy(0).unwrap();
            let start = energy(&robot);
            for _ in 0..5000 {
                robot.advance(&[0.0; 3]).unwrap_or_else(|e| panic!("{law} {method:?}: {e}"));
                let (now, stroke) = (energy(&robot), robot.stroke(0));
                assert!(stroke.abs() < 2e-5 && now < start * 1.03, "{law} {method:?}: {stroke} m, {now} of {start} J");
                assert!(robot.correction() < 0.1, "{law} {method:?}: {} rad/s", robot.correction());
            }
        }
    }
}

/// A slider of 1 kg pulled by an element along its axis: a linear system, whose stroke is q.
fn slider(element: &str, joint: &str) -> System {
    system(&format!(
        r#"
[[robot.body]]
name = "slider"
joint = {{ name = "q", kind = "prismatic", axis = [1, 0, 0], origin = [1, 0, 0] {joint} }}
mass = 1
{element}
{}"#,
        free("start = { q = { q = 0 }, v = { q = 1 } }")
    ))
}

/// Mean forces of strokes of straight pieces do the work of such strokes, which is never negative, however long the step.
#[test]
fn midpoint_makes_no_energy_at_any_order_and_stiffness() {
    for alpha in [0.02, 0.2, 0.5, 0.8, 0.98] {
        for c in [1.0, 1e3, 1e6, 1e9] {
            let system = slider(
                &format!(
                    r#"[[element]]
name = "e"
from = {{ body = "world", point = [0, 0, 0] }}
to = {{ body = "slider", point = [0, 0, 0] }}
rest_length = 1
law = "springpot"
parameters = {{ c = {c}, alpha = {alpha} }}"#
                ),
                "",
            );
            for step in [1e-3, 0.1] {
                let mut robot = Loop::new(&system, Method::Midpoint, step, MEMORY).unwrap();
                for _ in 0..2000 {
                    robot.advance(&[0.0]).unwrap();
                    assert!(robot.kinetic_energy() <= 0.5 * (1.0 + 1e-9), "alpha {alpha}, c {c}, step {step}");
                }
            }
        }
    }
}

#[test]
fn friction_brings_to_rest_without_chatter() {
    // 1 m/s against 5 N and 1 kg: rest after 0.2 s and 0.1 m.
    let system = slider("", ", friction = 5");
    let mut robot = Loop::new(&system, Method::BackwardEuler, 1e-3, MEMORY).unwrap();
    for k in 0..1000 {
        let before = robot.v()[0];
        robot.advance(&[0.0]).unwrap();
        let v = robot.v()[0];
        assert!(v >= 0.0 && v <= before, "step {k}: {before} then {v} m/s");
    }
    assert!(robot.v()[0] < 1e-12 && (robot.q()[0] - 0.1).abs() < 2e-3, "{} m/s at {} m", robot.v()[0], robot.q()[0]);
    // Less than friction holds it all but still, more moves it.
    for _ in 0..1000 {
        robot.advance(&[4.0]).unwrap();
    }
    assert!((robot.v()[0] - 1e-3 * 0.8f64.atanh()).abs() < 1e-9, "{} m/s", robot.v()[0]);
    let before = robot.v()[0];
    for _ in 0..1000 {
        robot.advance(&[6.0]).unwrap();
    }
    assert!((robot.v()[0] - before - 1.0).abs() < 5e-3, "{} m/s", robot.v()[0]);
}
