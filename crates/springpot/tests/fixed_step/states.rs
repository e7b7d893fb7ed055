//! Loops go on from states to the bit.

use crate::loops::*;
use springpot::methods::fixed::Loop;
use springpot::system::RunError;

/// All that a loop tells of where it is.
fn told(robot: &Loop) -> Vec<f64> {
    let elements = [robot.force(0), robot.length(0), robot.stroke(0), robot.rate(0), robot.stored_energy(0).unwrap()];
    let energies = [robot.t(), robot.kinetic_energy(), robot.potential_energy(), robot.correction()];
    [robot.q(), robot.v(), robot.a(), &elements, &energies].concat()
}

#[test]
fn what_goes_on_from_a_state_does_so_to_the_bit() {
    let strut = thermoviscoelastic(0.5, "caputo").replace("\"25 degC\"", "\"300 + 9*sin(t) + q.q2\"");
    let control = r#"
[motion.controller]
kind = "fractional-pid"
kp = 20
ki = 5
kd = 2
lambda = 0.6
mu = 0.7
sample = "4 ms"
delay = "4 ms"
limits = { q2 = 3 }
reference = { kind = "joints", q1 = 0.3, q2 = "0.2*sin(3*t)", q3 = 0 }
"#;
    let taken_off =
        control.replace("fractional-pid", "computed-torque").replace("ki = 5\n", "compensate_elements = true\n");
    let taken_off = taken_off.replace("lambda = 0.6\nmu = 0.7\n", "");
    let motion = |more: &str| arm(&(strut.clone() + &free("start = { v = { q1 = 1 } }") + more));
    let law = strut.find("law = ").unwrap();
    let law = format!(
        "{}law = \"filled-rubber\"\nparameters = {{ k = 20, c = 9, alpha = 0.3, k_f = [300, 100], F_f = [1, 2] }}\n",
        &strut[..law]
    );
    let rubber = arm(&(law + &free("start = { v = { q1 = 1 } }")));
    for text in [motion(""), motion(control), motion(&taken_off), rubber] {
        let system = system(&text);
        for method in METHODS {
            let mut robot = Loop::new(&system, method, 2e-3, MEMORY).unwrap();
            let go = |robot: &mut Loop, steps: u64| {
                for k in 0..steps {
                    robot.advance(&[0.1 * (k as f64).sin(), 0.0, 0.2]).unwrap();
                }
            };
            go(&mut robot, 31);
            let saved = robot.state();
            go(&mut robot, 40);
            let after = told(&robot);
            robot.set_state(&saved).unwrap();
            assert_eq!(robot.t(), 31.0 * 2e-3);
            go(&mut robot, 40);
            assert_eq!(told(&robot), after, "{method:?} {text}");
            let mut other = Loop::new(&system, method, 2e-3, MEMORY).unwrap();
            other.set_state(&saved).unwrap();
            go(&mut other, 40);
            assert_eq!(told(&other), after, "{method:?} {text}");
        }
    }
}

#[test]
fn a_state_of_another_system_is_refused() {
    let one = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(""))));
    let other = system(&arm(&free("")));
    let state = looped(&other, METHODS[0], 1e-3, 0.01).state();
    let mut robot = looped(&one, METHODS[0], 1e-3, 0.01);
    let before = told(&robot);
    assert!(matches!(robot.set_state(&state), Err(RunError::OtherRun)));
    assert_eq!(told(&robot), before);
}
