//! Derivatives across changes: joints that stick and slip, ends of joints, events, torques that are switched.

use super::compare;

/// Two sliders one after the other, a spring between them and one to the world, friction that sticks, and a torque that swings.
const SLIDERS: &str = r#"
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
    let columns = ["q.q1", "q.q2", "v.q1", "v.q2", "rod.force", "coupling.force"];
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
