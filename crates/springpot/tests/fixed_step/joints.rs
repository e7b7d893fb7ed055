//! Joints that are prescribed, locked, driven, that follow others, that float: against runs with error control.

use crate::loops::*;
use springpot::methods::fixed::{Loop, Method};

fn check(text: &str, end: f64, largest: f64) {
    let system = system(text);
    let truth = truth(&system, end);
    let error = |n: f64| distance(&truth, &state(&looped(&system, Method::Midpoint, 1.0 / n, end)));
    let errors = [200.0, 400.0, 800.0].map(error);
    assert!(errors[2] < largest, "{errors:?}");
    for pair in errors.windows(2) {
        let found = (pair[0] / pair[1]).log2();
        assert!((found - 2.0).abs() < 0.1, "{found} {errors:?}");
    }
    let rough = distance(&truth, &state(&looped(&system, Method::BackwardEuler, 1.0 / 800.0, end)));
    let finer = distance(&truth, &state(&looped(&system, Method::BackwardEuler, 1.0 / 1600.0, end)));
    assert!(((rough / finer).log2() - 1.0).abs() < 0.15, "{rough:e} {finer:e}");
}

#[test]
fn prescribed_locked_and_driven_joints() {
    let motion = r#"
prescribed = { q2 = "0.3*sin(4*t)" }
locked = ["q1"]
torque = { q3 = "2*cos(3*t)" }
start = { q = { q1 = 0.4, q3 = 0.2 }, v = { q1 = 3 } }"#;
    let text = arm(&(thermoviscoelastic(0.5, "caputo") + &free(motion)));
    check(&text, 0.5, 1e-4);
    let system = system(&text);
    let robot = looped(&system, Method::Midpoint, 1e-3, 0.5);
    // A prescribed joint is where its signal says at the end of every step; a locked one has not moved.
    assert_eq!(robot.q()[0], 0.4);
    assert_eq!(robot.v()[0], 0.0);
    assert!((robot.q()[1] - 0.3 * 2.0f64.sin()).abs() < 1e-15 && (robot.v()[1] - 1.2 * 2.0f64.cos()).abs() < 1e-14);
}

#[test]
fn followers_damping_and_friction() {
    let urdf = r#"<robot name="gripper">
  <link name="palm"/>
  <link name="left"><inertial><mass value="1"/><origin xyz="0.1 0 0.2"/><inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="right"><inertial><mass value="0.5"/><origin xyz="0.1 0 -0.2"/><inertia ixx="0.01" iyy="0.01" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="a" type="revolute"><parent link="palm"/><child link="left"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/><dynamics damping="0.2" friction="0.05"/></joint>
  <joint name="b" type="revolute"><parent link="palm"/><child link="right"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/><mimic joint="a" multiplier="-0.7" offset="0.1"/></joint>
</robot>"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gripper.urdf");
    std::fs::write(&path, urdf).unwrap();
    let element = r#"
[[element]]
name = "band"
from = { body = "left", point = [0.2, 0.1, 0] }
to = { body = "right", point = [0.1, 0, 0.1] }
rest_length = 0.1
law = "fractional-kelvin-voigt"
parameters = { k = 20, c = 3, alpha = 0.4 }
"#;
    let robot = format!("[robot]\nurdf = {:?}\n", path.to_str().unwrap());
    check(&(robot + element + &free("start = { q = { a = 0.3 }, v = { a = 3 } }")), 0.4, 1e-4);
}

#[test]
fn torques_of_the_loop_are_those_of_the_signals() {
    let by_signal = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free("torque = { q2 = -12, q3 = 1.5 }"))));
    let by_hand = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(""))));
    for method in METHODS {
        let expected = looped(&by_signal, method, 1e-3, 0.3);
        let mut robot = Loop::new(&by_hand, method, 1e-3, MEMORY).unwrap();
        for _ in 0..300 {
            robot.advance(&[0.0, -12.0, 1.5]).unwrap();
        }
        assert_eq!(state(&robot), state(&expected));
    }
}

#[test]
fn inputs_are_held() {
    let text = |celsius: f64| {
        arm(&(thermoviscoelastic(0.5, "caputo").replace("25 degC", &format!("{celsius} degC")) + &free("")))
    };
    let (cold, hot) = (system(&text(0.0)), system(&text(60.0)));
    let expected = looped(&hot, Method::Midpoint, 1e-3, 0.2);
    let mut robot = Loop::new(&cold, Method::Midpoint, 1e-3, MEMORY).unwrap();
    robot.hold_input(0, 0, Some(333.15)).unwrap();
    for _ in 0..200 {
        robot.advance(&[0.0; 3]).unwrap();
    }
    assert_eq!(state(&robot), state(&expected));
    // Out of the range of the law: refused, and nothing has moved.
    robot.hold_input(0, 0, Some(20.0)).unwrap();
    let before = state(&robot);
    let message = robot.advance(&[0.0; 3]).unwrap_err().to_string();
    assert!(message.contains("input T = 20 lies outside 150 … 1500"), "{message}");
    assert_eq!(state(&robot), before);
    robot.hold_input(0, 0, None).unwrap();
    robot.advance(&[0.0; 3]).unwrap();
}
