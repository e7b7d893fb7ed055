//! Robots as scenario texts.

/// The robot of the papers' scenarios with its gripper.
pub(crate) const ARM: &str = r#"
[[robot.body]]
name = "column"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0] }
mass = 6.0
com = [0.02, 0.0, 0.3]
inertia = { xx = 0.20, yy = 0.20, zz = 0.06, xz = 0.01 }
[[robot.body]]
name = "upper_arm"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.6] }
mass = 3.0
com = [0.25, 0.01, 0.02]
inertia = { xx = 0.01, yy = 0.07, zz = 0.07, xy = 0.001, yz = 0.0005 }
[[robot.body]]
name = "forearm"
joint = { name = "q3", kind = "revolute", axis = [0, 1, 0], origin = [0.5, 0, 0] }
mass = 2.0
com = [0.18, -0.01, 0.01]
inertia = { xx = 0.006, yy = 0.03, zz = 0.03, xz = -0.001, yz = 0.0004 }
[robot.gripper]
body = "forearm"
point = [0.4, 0, 0]
"#;

/// An element named strut between column and forearm; `law` is the rest of its table.
pub(crate) fn strut(law: &str) -> String {
    format!(
        r#"
[[element]]
name = "strut"
from = {{ body = "column", point = [0.14, -0.1, 0.08] }}
to = {{ body = "forearm", point = [-0.06, 0.1, 0.08] }}
rest_length = "70 cm"
{law}
"#
    )
}

/// Thermoviscoelastic, the numbers of the first paper.
pub(crate) fn thermoviscoelastic(alpha: f64, celsius: f64, derivative: &str) -> String {
    strut(&format!(
        r#"law = "thermoviscoelastic"
parameters = {{ E_c = "30 N/m", E_kv = "20 N/m", E_d = "50 N*s^alpha/m", alpha = {alpha}, a_kv = "0.0007 m/K" }}
inputs = {{ T = "{celsius} degC" }}
derivative = "{derivative}""#
    ))
}

/// Magnetorheological at 1 V, the numbers of the second paper.
pub(crate) fn magnetorheological(alpha: f64, derivative: &str) -> String {
    strut(&format!(
        r#"law = "magnetorheological"
parameters = {{ E_c = "25 N/cm", mu_0 = "50 N*s^alpha/cm", mu = "10 N*s^alpha/(cm*V)", alpha = {alpha} }}
inputs = {{ u = "1 V" }}
derivative = "{derivative}""#
    ))
}

/// Springpot of unit coefficient.
pub(crate) fn springpot(alpha: f64, derivative: &str) -> String {
    strut(&format!("law = \"springpot\"\nparameters = {{ c = 1, alpha = {alpha} }}\nderivative = \"{derivative}\""))
}

/// The motion of the first paper.
pub(crate) const SWING: &str = r#"
[motion]
kind = "prescribed"
joints = { q1 = 0, q2 = "0.1*sin(8*t)", q3 = "0.1*t" }
"#;

/// The gripper path of the second paper.
pub(crate) const PATH: &str = r#"
[motion]
kind = "gripper-path"
x = 0.8
y = "0.1*sin(2*pi*0.2*t)"
z = "0.3 + 0.01*sin(2*pi*0.2*t)"
guess = { q3 = 1.0 }
"#;

/// A prescribed motion of the arm with q1 at rest.
pub(crate) fn prescribed(q2: &str, q3: &str) -> String {
    format!("\n[motion]\nkind = \"prescribed\"\njoints = {{ q1 = 0, q2 = \"{q2}\", q3 = \"{q3}\" }}\n")
}

/// Rows every `step` seconds.
pub(crate) fn every(end: f64, step: f64) -> String {
    format!("\n[time]\nend = {end}\noutput_step = {step}\n")
}

/// Rows at the given times.
pub(crate) fn at(end: f64, times: &[f64]) -> String {
    format!("\n[time]\nend = {end}\noutput_times = {times:?}\n")
}
