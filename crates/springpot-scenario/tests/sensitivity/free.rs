//! Robots that float or turn freely: twists inside, derivatives of the components of quaternions in the columns.

use super::steps::stepped;
use super::{compare, compare_within, goes_on_to_the_bit, plan, said, scenario};
use springpot::Simulation;
use springpot::observe::Quantity;

/// A top on a tip, with a strut to it.
const TOP: &str = r#"
[robot]
gripper = { body = "top", point = [0.05, 0.02, 0.2] }
[[robot.body]]
name = "top"
joint = { name = "turn", kind = "spherical", origin = [0, 0, 0.1] }
mass = 0.6
com = [0.01, 0, 0.15]
inertia = { xx = 0.004, yy = 0.005, zz = 0.002, xy = 0.0003 }
[[element]]
name = "strut"
from = { body = "world", point = [0.3, 0.1, 0.2] }
to = { body = "top", point = [0.02, 0.03, 0.2] }
rest_length = "start"
law = "fractional-kelvin-voigt"
parameters = { k = 20, c = 2, alpha = 0.4 }
[motion]
kind = "forward"
start = { q = { turn = { rpy = [0.3, -0.2, 0.5] } }, v = { turn = { wx = 1, wy = -2, wz = 15 } } }
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#;

/// A base that floats, with an arm.
const FLOAT: &str = r#"
[robot]
gravity = [0.3, 0, -9.81]
[[robot.body]]
name = "base"
joint = { name = "base", kind = "floating" }
mass = 3
com = [0.02, 0.01, -0.03]
inertia = { xx = 0.04, yy = 0.05, zz = 0.03, xy = 0.003 }
[[robot.body]]
name = "arm"
parent = "base"
joint = { name = "q1", kind = "revolute", axis = [0.2, 1, 0.1], origin = [0.1, 0, 0.05], damping = 0.02 }
mass = 0.8
com = [0.01, 0, 0.15]
inertia = { xx = 0.004, yy = 0.005, zz = 0.002 }
[[element]]
name = "rope"
from = { body = "world", point = [0.3, 0.1, 0.9] }
to = { body = "base", point = [0.02, 0.03, 0.1] }
rest_length = 0.7
law = "fractional-kelvin-voigt"
parameters = { k = 60, c = 6, alpha = 0.6 }
[[element]]
name = "tendon"
from = { body = "base", point = [-0.1, 0, 0.1] }
to = { body = "arm", point = [0, 0, 0.2] }
rest_length = "start"
law = "fractional-zener"
parameters = { k_e = 20, k_m = 50, c = 3, alpha = 0.5 }
[motion]
kind = "forward"
start = { q = { base = { x = 0.1, y = 0.05, z = 0.1, rpy = [0.3, -0.2, 0.5] }, q1 = 0.2 }, v = { base = { vx = 0.3, wy = 2, wz = -3 }, q1 = 1 } }
torque = { base = { vx = 0.3, wz = "0.1*sin(9*t)" } }
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#;

const OF_TOP: [&str; 10] = [
    "q.turn.qx",
    "q.turn.qw",
    "v.turn.wx",
    "v.turn.wz",
    "strut.length",
    "strut.force",
    "strut.Q.turn.wy",
    "gripper.y",
    "energy.kinetic",
    "energy.potential",
];

const BY_OF_TOP: [(&str, f64); 8] = [
    ("element.strut.alpha", 1e-3),
    ("element.strut.to.point.1", 1e-4),
    ("robot.body.top.mass", 1e-3),
    ("robot.body.top.joint.origin.2", 1e-4),
    ("motion.start.v.turn.wx", 2e-3),
    ("motion.start.q.turn.rpy.0", 1e-3),
    ("motion.start.q.turn.rpy.1", 1e-3),
    ("motion.start.q.turn.rpy.2", 1e-3),
];

const OF_FLOAT: [&str; 9] = [
    "q.base.x",
    "q.base.qz",
    "v.base.vy",
    "v.base.wx",
    "q.q1",
    "rope.force",
    "tendon.force",
    "rope.Q.base.wz",
    "energy.kinetic",
];

const BY_OF_FLOAT: [(&str, f64); 9] = [
    ("element.rope.alpha", 1e-3),
    ("element.tendon.k_m", 0.1),
    ("robot.body.base.inertia.xy", 1e-5),
    ("robot.body.arm.joint.axis.0", 1e-3),
    ("motion.start.q.base.z", 1e-3),
    ("motion.start.q.base.rpy.1", 1e-3),
    ("motion.start.v.base.wz", 1e-3),
    ("motion.start.q.q1", 1e-3),
    ("motion.torque.base.vx", 1e-2),
];

#[test]
fn a_top() {
    compare(TOP, &OF_TOP, &BY_OF_TOP);
}

#[test]
fn a_base_that_floats() {
    compare(FLOAT, &OF_FLOAT, &BY_OF_FLOAT);
}

#[test]
fn starts_that_are_singular() {
    let unloaded =
        |text: &str| text.replace("alpha = 0.4 }", "alpha = 0.4 }\npast = \"unloaded\"").replace("\"start\"", "0.3");
    compare(&unloaded(TOP), &OF_TOP, &BY_OF_TOP);
}

#[test]
fn steps_of_one_size() {
    for method in ["midpoint", "backward-euler"] {
        compare_within(1e-8, &stepped(TOP, method), &OF_TOP, &BY_OF_TOP);
        compare_within(2e-8, &stepped(FLOAT, method), &OF_FLOAT, &BY_OF_FLOAT);
    }
}

#[test]
fn signals_move_one_and_forces_the_other() {
    let base = "base = { x = 0.1, z = \"0.1 + 0.05*sin(6*t)\", rpy = [0.3, \"0.2*t\", 0.5] }";
    let start = FLOAT.find("start = ").unwrap();
    let time = FLOAT.find("[time]").unwrap();
    let text =
        format!("{}start = {{ q = {{ q1 = 0.2 }} }}\nprescribed = {{ {base} }}\n{}", &FLOAT[..start], &FLOAT[time..]);
    let paths = [("element.tendon.alpha", 1e-3), ("robot.body.arm.mass", 1e-3), ("motion.start.q.q1", 1e-3)];
    compare(&text, &["q.base.qz", "q.q1", "v.q1", "tendon.force", "tau.base.wy", "energy.kinetic"], &paths);
}

/// q·δq = 0: the columns keep the length of the quaternion.
#[test]
fn quaternions_keep_their_length() {
    for text in [TOP.to_owned(), stepped(TOP, "midpoint")] {
        let mut asked = scenario(&text);
        asked.differentiate("robot.body.top.mass,motion.start.q.turn.rpy.1,element.strut.k").unwrap();
        let plan = plan(&asked).unwrap();
        let mut simulation = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
        while simulation.t() < 0.3 {
            simulation.step().unwrap();
        }
        let t = simulation.t();
        let q: Vec<f64> = (0..4).map(|k| simulation.interpolate(t).unwrap().value(Quantity::Coordinate(k))).collect();
        let all: Vec<Vec<f64>> = (0..4).map(|k| simulation.derivatives(t, Quantity::Coordinate(k)).unwrap()).collect();
        let [of_q, _] = simulation.tangents().unwrap();
        assert_eq!(of_q, all.concat());
        for p in 0..3 {
            let (sum, size) =
                (0..4).fold((0.0, 0.0f64), |(sum, size), k| (sum + q[k] * all[k][p], size.max(all[k][p].abs())));
            assert!(size > 0.0 && sum.abs() < 1e-14 * size.max(1.0), "{p}: {sum} of {size}");
        }
    }
}

/// The robots of files, with a rope to the world and a tendon of their own.
#[test]
fn robots_of_files() {
    for (name, base, leg) in [
        ("solo12", "base_link", "FL_LOWER_LEG"),
        ("anymal_b", "base", "LF_SHANK"),
        ("simple_humanoid", "BODY", "LARM_LINK5"),
    ] {
        let text = format!(
            r#"
[robot]
urdf = "../testdata/multibody/{name}.urdf"
floating_base = true
[[element]]
name = "rope"
from = {{ body = "world", point = [0.3, 0.1, 0.9] }}
to = {{ body = "{base}", point = [0.02, 0.03, 0.1] }}
rest_length = 0.7
law = "fractional-kelvin-voigt"
parameters = {{ k = 200, c = 20, alpha = 0.6 }}
[[element]]
name = "tendon"
from = {{ body = "{base}", point = [-0.1, 0, 0.1] }}
to = {{ body = "{leg}", point = [0, 0, 0] }}
rest_length = "start"
law = "kelvin-voigt"
parameters = {{ k = 50, c = 1 }}
[motion]
kind = "forward"
[motion.start.q]
floating_base = {{ x = 0.1, z = 0.1, rpy = [0.3, -0.2, 0.5] }}
[motion.start.v]
floating_base = {{ vx = 0.3, wy = 2, wz = -3 }}
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#
        );
        let columns = ["q.floating_base.x", "q.floating_base.qy", "v.floating_base.wz", "rope.force", "tendon.length"];
        let paths = [
            ("element.rope.alpha", 1e-3),
            ("motion.start.q.floating_base.rpy.1", 1e-3),
            ("motion.start.v.floating_base.wz", 1e-3),
        ];
        compare(&text, &columns, &paths);
    }
}

#[test]
fn states_go_on_to_the_bit() {
    goes_on_to_the_bit(FLOAT, "element.rope.alpha,motion.start.q.base.rpy.1", 0.15, &[0.3]);
}

#[test]
fn angles_that_are_one_are_not_told_apart() {
    let mut asked = scenario(&TOP.replace("rpy = [0.3, -0.2, 0.5]", "rpy = [0.3, \"90 deg\", 0.5]"));
    asked.differentiate("motion.start.q.turn.rpy.1").unwrap();
    let words = said(&asked);
    assert!(words.contains("at a pitch of 90 deg roll and yaw are one angle"), "{words}");
}
