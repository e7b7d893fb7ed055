//! Laws with memories behind others, whose files say how they began.

use crate::{COLUMNS_OF_SLIDER, compare, compare_within};

/// A mass on a rail, held by one element.
pub(crate) fn slider(element: &str) -> String {
    format!(
        r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "cart"
joint = {{ name = "q1", kind = "prismatic", axis = [1, 0, 0] }}
mass = 2
inertia = {{ xx = 0.01, yy = 0.01, zz = 0.01 }}
[[element]]
name = "strut"
joint = "q1"
rest = 0.03
{element}
[motion]
kind = "forward"
start = {{ q = {{ q1 = 0.1 }}, v = {{ q1 = 1 }} }}
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#
    )
}

#[test]
fn springpots_in_series() {
    let zener = slider("law = \"fractional-zener\"\nparameters = { k_e = 20, k_m = 50, c = 30, alpha = 0.5 }");
    let paths = [("element.strut.k_m", 0.2), ("element.strut.alpha", 1e-3), ("motion.start.q.q1", 1e-3)];
    compare(&zener, &COLUMNS_OF_SLIDER, &paths);
    let two = slider(
        "network = \"series(springpot(c_1, a_1), springpot(c_2, a_2))\"\n\
         parameters = { c_1 = 50, a_1 = 0.2, c_2 = 30, a_2 = 0.7 }",
    );
    let paths = [("element.strut.c_1", 0.2), ("element.strut.a_1", 1e-3), ("element.strut.a_2", 1e-3)];
    compare(&two, &COLUMNS_OF_SLIDER, &paths);
}

/// Parts that let go, and springs that slip, behind others.
#[test]
fn what_lets_go_in_series() {
    let behind = |leaf: &str, numbers: &str, other: &str| {
        slider(&format!(
            "network = \"parallel(series({leaf}, {other}), spring(k))\"\nparameters = {{ {numbers}, c = 30, k = 20{} }}",
            if other.contains("(c, a)") { ", a = 0.5" } else { "" }
        ))
    };
    let columns = ["q.q1", "v.q1", "strut.force", "strut.stored", "strut.dissipated"];
    let slips = ("jenkins(k_j, F_y)", "k_j = 300, F_y = 3");
    let paths = [("element.strut.k_j", 0.5), ("element.strut.F_y", 5e-3), ("element.strut.c", 0.05)];
    for other in ["springpot(c, a)", "dashpot(c)"] {
        compare_within(1e-6, &behind(slips.0, slips.1, other), &columns, &paths);
    }
    let rubs = behind("friction(F, v_0)", "F = 3, v_0 = 0.2", "dashpot(c)");
    let paths = [("element.strut.F", 1e-2), ("element.strut.c", 0.1), ("motion.start.q.q1", 1e-3)];
    compare(&rubs, &columns, &paths);
    let pulls = behind("tension(k_t)", "k_t = 300", "springpot(c, a)");
    // It is taut again between two rows: differences must not reach there.
    compare_within(1e-6, &pulls, &columns, &[("element.strut.k_t", 1.0), ("element.strut.a", 1e-5)]);
}

/// What each leaf of a law is.
#[test]
fn leaves() {
    let columns = |leaves: &[&str]| -> Vec<String> {
        let of = |leaf: &&str| ["stroke", "rate", "force", "derivative"].map(|key| format!("strut.{leaf}.{key}"));
        leaves.iter().flat_map(of).collect()
    };
    let told = |element: &str| format!("{}\n[output]\nleaves = true\n", slider(element));
    let two = told(
        "network = \"parallel(series(springpot(c_1, a_1), springpot(c_2, a_2)), spring(k), dashpot(d))\"\n\
         parameters = { c_1 = 50, a_1 = 0.2, c_2 = 30, a_2 = 0.7, k = 20, d = 2 }",
    );
    let paths = [("element.strut.c_1", 0.2), ("element.strut.a_2", 1e-3), ("motion.start.q.q1", 1e-3)];
    let names = columns(&["springpot1", "springpot2", "spring1", "dashpot1"]);
    compare(&two, &names.iter().map(String::as_str).collect::<Vec<_>>(), &paths);
    let slips =
        told("network = \"parallel(jenkins(k_j, F_y), spring(k))\"\nparameters = { k_j = 300, F_y = 3, k = 20 }");
    let names = columns(&["jenkins1", "spring1"]);
    let paths = [("element.strut.k_j", 0.5), ("element.strut.F_y", 5e-3)];
    compare_within(1e-5, &slips, &names.iter().map(String::as_str).collect::<Vec<_>>(), &paths);
}

#[test]
fn starts_that_are_singular() {
    // From x(0) = 0.07 m, and from 0, where only changes of it are singular.
    for (order, start) in [(0.3, 0.1), (0.9, 0.1), (0.5, 0.03)] {
        let text = slider(&format!(
            "law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 50, c = 40, alpha = {order} }}\npast = \"unloaded\""
        ));
        let text = text.replace("q1 = 0.1", &format!("q1 = {start}"));
        let paths = [
            ("element.strut.c", 0.2),
            ("element.strut.alpha", 1e-3),
            ("element.strut.rest", 1e-3),
            ("motion.start.q.q1", 1e-3),
            ("robot.body.cart.mass", 1e-2),
        ];
        compare(&text, &["q.q1", "v.q1", "a.q1", "strut.force", "strut.derivative"], &paths);
    }
}

#[test]
fn heat() {
    let told = slider(
        "law = \"fractional-zener\"\nparameters = { k_e = 20, k_m = 50, c = 30, alpha = 0.5 }\n\
         shift = { kind = \"wlf\", C1 = 8.86, C2 = \"101.6 K\", T_ref = \"293.15 K\" }\n\
         inputs = { T = \"T_m + 8*sin(9*t)\" }",
    );
    let told = format!("[constants]\nT_m = 295\n{told}");
    let paths = [("element.strut.shift.C1", 1e-2), ("constants.T_m", 2e-2), ("element.strut.alpha", 1e-3)];
    compare(&told, &COLUMNS_OF_SLIDER, &paths);
    let warms = slider(
        "law = \"fractional-kelvin-voigt\"\nparameters = { k = 50, c = 50, alpha = 0.5 }\n\
         shift = { kind = \"arrhenius\", energy = 80000, T_ref = \"293.15 K\" }\n\
         thermal = { capacity = \"0.5 J/K\", conductance = \"0.2 W/K\", ambient = \"295.15 K\" }\n\
         expansion = { coefficient = \"2 mm/K\", T_ref = \"295.15 K\" }",
    );
    let paths = [
        ("element.strut.shift.energy", 100.0),
        ("element.strut.thermal.capacity", 1e-3),
        ("element.strut.thermal.ambient", 2e-2),
        ("element.strut.expansion.coefficient", 1e-5),
        ("element.strut.c", 0.1),
    ];
    compare(&warms, &["q.q1", "v.q1", "strut.force", "strut.stored", "strut.T", "strut.heat", "strut.input"], &paths);
}

/// Inner variables change with parameters where no joint shows it: their changes choose the steps too.
#[test]
fn inner_variables_along_a_given_motion() {
    let moved = |law: &str, inputs: &str, parameters: &str| {
        slider(&format!("law = \"{law}\"\ninputs = {{ {inputs} = 1.5 }}\nparameters = {{ {parameters} }}"))
            .replace(
                "kind = \"forward\"\nstart = { q = { q1 = 0.1 }, v = { q1 = 1 } }",
                "kind = \"prescribed\"\njoints = { q1 = \"0.05*sin(15*t)\" }",
            )
            .replace("rtol = 1e-10", "rtol = 1e-9")
    };
    let spencer = moved(
        "spencer",
        "u",
        "c_0a = 200, c_0b = 35, c_1a = 2830, c_1b = 30, k_0 = 470, k_1 = 50, x_0 = 0.01, alpha_a = 1400, alpha_b = 690, A = 30, \
         beta = 2e4, gamma = 3e4, n = 2, eta = 190",
    );
    let paths = [("element.strut.c_0a", 4.0), ("element.strut.gamma", 500.0), ("element.strut.k_0", 8.0)];
    compare(&spencer, &["strut.force", "strut.stored", "strut.dissipated", "energy.actuators"], &paths);
    let stack = moved(
        "piezo-stack-bouc-wen",
        "U",
        "F_block = 10, x_0 = 0.1, V_max = 100, V_min = -100, C = 1e-4, R = 50, c = 20, alpha = 0.4, alpha_h = 0.3, A = 1, beta = 1e-3, gamma = 2e-3, n = 2",
    );
    let paths = [("element.strut.C", 2e-6), ("element.strut.R", 1.0), ("element.strut.gamma", 1.5e-5)];
    compare(&stack, &["strut.force", "strut.stored", "strut.voltage", "strut.charge", "strut.current"], &paths);
}

/// A first step that is tried again begins at the rate that it began with.
#[test]
fn hysteresis_from_a_moving_start() {
    let law = "network = \"parallel(spring(k), bouc-wen(a_h, A, beta, gamma, n))\"\nparameters = { k = 60, a_h = 100, A = 1.2, beta = 20, gamma = 30, n = 1.5 }";
    compare(&slider(law), &COLUMNS_OF_SLIDER[..3], &[("element.strut.A", 2e-3), ("element.strut.beta", 5e-2)]);
}
