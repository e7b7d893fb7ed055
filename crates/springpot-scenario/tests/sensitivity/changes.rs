//! Derivatives across changes: joints that stick and slip, ends of joints, events, torques that are switched.

use super::control::SPRINGPOT;
use super::{ARM, compare, compare_within};

/// Two sliders one after the other, a spring between them and one to the world, friction that sticks, and a torque that swings.
pub(crate) const SLIDERS: &str = r#"
[robot]
gravity = [0.4, 0, -9.81]
[[robot.body]]
name = "one"
joint = { name = "q1", kind = "prismatic", axis = [1, 0, 0], friction = 4, damping = 0.2 }
mass = 1.2
[[robot.body]]
name = "two"
parent = "one"
joint = { name = "q2", kind = "prismatic", axis = [1, 0, 0.2], friction = 0.6 }
mass = 0.7
[[element]]
name = "rod"
joint = "q1"
law = "fractional-kelvin-voigt"
parameters = { k = 60, c = 4, alpha = 0.4 }
[[element]]
name = "coupling"
joint = "q2"
rest = 0.02
law = "kelvin-voigt"
parameters = { k = 90, c = 0.5 }
[motion]
kind = "forward"
start = { q = { q1 = 0.2, q2 = -0.05 }, v = { q1 = 0.4 } }
torque = { q2 = "3*sin(9*t)" }
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#;

#[test]
fn joints_stick_and_slip() {
    let columns = [
        "q.q1",
        "q.q2",
        "v.q1",
        "v.q2",
        "rod.force",
        "coupling.force",
        "rod.dissipated",
        "energy.joints",
        "energy.actuators",
    ];
    let paths = [
        ("element.rod.k", 0.2),
        ("element.rod.alpha", 4e-3),
        ("element.coupling.k", 0.2),
        ("element.coupling.rest", 1e-4),
        ("robot.body.one.joint.friction", 1e-2),
        ("robot.body.two.joint.friction", 2e-3),
        ("robot.body.one.joint.damping", 1e-3),
        ("robot.body.two.mass", 2e-3),
        ("motion.start.q.q1", 5e-4),
        ("motion.start.v.q1", 1e-3),
        ("robot.gravity.2", 3e-3),
    ];
    compare(SLIDERS, &columns, &paths);
}

/// A pendulum of two links with a springpot, a damper and ends of its joints.
const PENDULUM: &str = r#"
[constants]
t_s = 0.13
height = 2.0
width = 0.04
share = 0.1
last = 0.35
[robot]
gravity = [0, 0, -9.81]
limits = { stiffness = 40, damping = 0.6 }
[[robot.body]]
name = "one"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], damping = 0.05 }
mass = 1.1
com = [0.2, 0, 0.01]
inertia = { xx = 0.03, yy = 0.03, zz = 0.03 }
[[robot.body]]
name = "two"
parent = "one"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0.4, 0, 0], lower = -0.35, upper = 0.3 }
mass = 0.8
com = [0.15, 0, 0]
inertia = { xx = 0.02, yy = 0.02, zz = 0.02 }
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "one", point = [0.3, 0, 0] }
rest_length = 0.4
law = "springpot"
parameters = { c = 60, alpha = 0.4 }
[[element]]
name = "damper"
joint = "q1"
law = "magnetorheological"
parameters = { E_c = 3, mu_0 = 0.4, mu = 0.3, alpha = 0.7 }
inputs = { u = "1 + 0.5*step(t - 2*t_s)" }
[motion]
kind = "forward"
start = { q = { q1 = 0.3, q2 = 0.1 } }
torque = { q1 = "height*step(t - t_s)*step(t_s + width*5 - t)", q2 = "1.5*abs(sin(9*t_s*t)) + min(height*t, 0.5)" }
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#;

const EVENTS: &str = r#"
[[event]]
name = "low"
when = "strut.length - 0.43"
direction = "rising"
action = { set = { "tau.q1" = 1.5, "damper.u" = 0.4 } }
[[event]]
name = "turns"
when = "v.q2 + share*strut.force"
direction = "falling"
action = { set = { "tau.q2" = -0.7 } }
[[event]]
name = "late"
when = "t - last"
action = { set = { "damper.u" = 2 } }
[motion]
"#;

const COLUMNS: [&str; 9] =
    ["q.q1", "q.q2", "v.q1", "v.q2", "strut.force", "damper.force", "tau.q1", "damper.dissipated", "energy.joints"];

#[test]
fn ends_of_joints_push_and_let_go() {
    let paths = [
        ("robot.limits.stiffness", 0.1),
        ("robot.limits.damping", 2e-3),
        ("robot.body.two.joint.lower", 1e-3),
        ("robot.body.two.joint.upper", 1e-3),
        ("element.strut.c", 0.1),
        ("element.strut.alpha", 2e-3),
        ("robot.body.one.mass", 2e-3),
        ("motion.start.q.q2", 1e-3),
    ];
    compare(PENDULUM, &COLUMNS, &paths);
}

#[test]
fn functions_of_time_switch_and_bend() {
    compare(PENDULUM, &COLUMNS, &[("constants.t_s", 2e-4), ("constants.height", 2e-3), ("constants.width", 1e-4)]);
}

#[test]
fn events_set_torques_and_inputs() {
    let text = PENDULUM.replace("[motion]\n", EVENTS).replace("rtol = 1e-10", "rtol = 1e-11");
    let paths = [
        ("element.strut.c", 0.05),
        ("element.strut.alpha", 1e-3),
        ("element.strut.rest_length", 1e-3),
        ("robot.body.one.mass", 1e-3),
        ("motion.start.q.q1", 1e-3),
        ("event.low.action.set.\"tau.q1\"", 5e-3),
        ("event.low.action.set.\"damper.u\"", 2e-3),
        ("constants.t_s", 1e-4),
        ("constants.last", 1e-3),
    ];
    // Of the times of events the runs that are compared know no more.
    // The last row lies in the step behind a hit, where the balance itself has no more digits.
    let columns = &COLUMNS[..8];
    compare_within(3e-7, &text, columns, &paths);
    compare_within(1e-6, &text, columns, &[("constants.share", 1e-3)]);
}

#[test]
fn torques_that_events_set_follow_from_nothing_else() {
    let text = PENDULUM.replace("[motion]\n", EVENTS);
    let text = text
        .replace("\"height*step(t - t_s)*step(t_s + width*5 - t)\"", "\"height*step(t - t_s) - 4*q.q1 - 0.3*v.q1\"");
    let paths = [
        ("element.strut.c", 0.05),
        ("motion.start.q.q1", 1e-3),
        ("event.low.action.set.\"tau.q1\"", 5e-3),
        ("constants.height", 2e-3),
    ];
    compare_within(3e-7, &text, &COLUMNS[..8], &paths);
}

/// Where a joint that a signal moves jumps to another speed, those that forces move get their share of it.
#[test]
fn velocities_that_jump_with_a_prescribed_one() {
    let text = ARM.replace("torque = { q1 = 0.4,", "prescribed = { q1 = \"0.3 + 0.6*abs(t - 0.11)\" }\ntorque = {");
    let text = text.replace("start = { q = { q1 = 0.3, q2 = 0.4,", "start = { q = { q2 = 0.4,");
    let paths = [
        ("element.tendon.k", 0.1),
        ("robot.body.two.mass", 5e-3),
        ("robot.body.three.joint.origin.1", 1e-3),
        ("robot.body.two.joint.axis.2", 2e-3),
        ("motion.start.q.q2", 1e-3),
        ("motion.start.v.q3", 5e-3),
    ];
    let remembers = text.replace("law = \"kelvin-voigt\"\nparameters = { k = 40, c = 5 }", SPRINGPOT);
    for text in [text, remembers] {
        compare(&text, &["q.q2", "v.q2", "v.q3", "strut.force", "tendon.force", "gripper.y"], &paths);
    }
}
