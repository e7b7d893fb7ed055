//! Derivatives of runs in steps of one size: those of the steps that were taken.

use super::changes::SLIDERS;
use super::control::arm;
use super::laws::slider;
use super::{ARM, COLUMNS, COLUMNS_OF_SLIDER, compare, compare_within, goes_on_to_the_bit, plan, said, scenario};
use springpot::Simulation;

const METHODS: [&str; 2] = ["backward-euler", "midpoint"];

/// The same in steps of one size.
pub(crate) fn stepped(text: &str, method: &str) -> String {
    let steps = format!("method = \"{method}\"\nstep = \"2 ms\"");
    text.replace("rtol = 1e-10\nmemory_rtol", &format!("{steps}\nmemory_rtol"))
}

/// Differences of runs whose steps are the same know more than those of runs that are only near.
const SHARE: f64 = 2e-9;

#[test]
fn robots() {
    for method in METHODS {
        let paths = [
            ("constants.k_0", 0.1),
            ("constants.f", 1e-3),
            ("element.tendon.rest_length", 1e-4),
            ("element.tendon.via.0.point.1", 1e-4),
            ("element.mount.from.rpy.2", 1e-4),
            ("robot.body.two.mass", 1e-3),
            ("robot.body.two.joint.origin.2", 1e-4),
            ("robot.body.one.joint.damping", 1e-3),
            ("motion.start.q.q2", 1e-3),
            ("motion.start.v.q2", 1e-3),
            ("robot.gravity.2", 1e-2),
        ];
        let columns = [&COLUMNS[..9], &["a.q1", "a.q3", "mount.x.stored", "energy.kinetic"]].concat();
        compare_within(1e-8, &stepped(ARM, method), &columns, &paths);
    }
}

#[test]
fn laws() {
    for method in METHODS {
        for order in [0.3, 0.9] {
            for past in ["held", "unloaded"] {
                let text = slider(&format!(
                    "law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 50, c = 40, alpha = {order} }}\npast = \"{past}\""
                ));
                let text = text.replace("past = \"held\"\n", "");
                let paths = [
                    ("element.strut.c", 0.05),
                    ("element.strut.alpha", 1e-3),
                    ("element.strut.rest", 1e-4),
                    ("motion.start.q.q1", 1e-4),
                    ("robot.body.cart.mass", 1e-3),
                ];
                compare_within(SHARE, &stepped(&text, method), &["q.q1", "v.q1", "a.q1", "strut.force"], &paths);
            }
        }
        let zener = slider("law = \"fractional-zener\"\nparameters = { k_e = 20, k_m = 50, c = 30, alpha = 0.5 }");
        let paths = [("element.strut.k_m", 0.1), ("element.strut.alpha", 1e-3), ("motion.start.q.q1", 1e-4)];
        compare_within(SHARE, &stepped(&zener, method), &COLUMNS_OF_SLIDER, &paths);
        let heated = slider(
            "law = \"fractional-zener\"\nparameters = { k_e = 20, k_m = 50, c = 30, alpha = 0.5 }\n\
             shift = { kind = \"wlf\", C1 = 8.86, C2 = \"101.6 K\", T_ref = \"293.15 K\" }\n\
             inputs = { T = \"T_m + 8*sin(9*t)\" }",
        );
        let heated = format!("[constants]\nT_m = 295\n{heated}");
        let paths = [("element.strut.shift.C1", 1e-2), ("constants.T_m", 2e-2), ("element.strut.alpha", 1e-3)];
        compare_within(1e-8, &stepped(&heated, method), &COLUMNS_OF_SLIDER, &paths);
    }
}

/// The iterations of a step find temperatures, which follow from losses, to 1e-7 of what they change.
#[test]
fn temperatures() {
    for method in METHODS {
        let warms = slider(
            "law = \"fractional-kelvin-voigt\"\nparameters = { k = 50, c = 50, alpha = 0.5 }\n\
             shift = { kind = \"arrhenius\", energy = 80000, T_ref = \"293.15 K\" }\n\
             thermal = { capacity = \"0.5 J/K\", conductance = \"0.2 W/K\", ambient = \"295.15 K\" }\n\
             expansion = { coefficient = \"2 mm/K\", T_ref = \"295.15 K\" }",
        );
        let paths = [("element.strut.thermal.capacity", 1e-3), ("element.strut.shift.energy", 100.0)];
        compare_within(1e-6, &stepped(&warms, method), &COLUMNS_OF_SLIDER, &paths);
    }
}

/// Which joints are held at the ends of steps, and which slide, is found with the steps.
#[test]
fn joints_stick_and_slip() {
    for method in METHODS {
        let text = stepped(SLIDERS, method);
        let sticks = |text: &str, force: &str| {
            text.replace(&format!("friction = {force}"), &format!("friction = {{ force = {force}, stick = true }}"))
        };
        let text = sticks(&sticks(&text, "4"), "0.6");
        let columns = ["q.q1", "q.q2", "v.q1", "v.q2", "a.q2", "rod.force", "coupling.force"];
        let paths = [
            ("element.rod.k", 0.02),
            ("element.rod.alpha", 4e-4),
            ("robot.body.one.joint.friction.force", 1e-3),
            ("robot.body.two.joint.friction.force", 2e-4),
            ("robot.body.two.mass", 2e-4),
            ("motion.start.v.q1", 1e-4),
        ];
        compare_within(1e-8, &text, &columns, &paths);
    }
}

/// Smooth friction that bends within a step is not found by its iterations: derivatives end there, and are not those of something else.
#[test]
fn what_iterations_do_not_find_has_no_derivatives() {
    let mut asked = scenario(&stepped(SLIDERS, "midpoint"));
    asked.differentiate("element.rod.k").unwrap();
    let plan = plan(&asked).unwrap();
    let mut simulation = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    simulation.step().unwrap();
    let lost: Vec<_> = simulation.lost().cloned().collect();
    assert!(lost.len() == 1 && lost[0].t == 0.0 && lost[0].why.contains("friction bends within it"), "{lost:?}");
}

#[test]
fn controllers() {
    let held = "reference = { kind = \"move\", to = { q1 = 0.6, q2 = 0.1, q3 = 0.1 }, duration = 0.3 }";
    let pid = "kp = 60, ki = 90, kd = 6";
    for method in METHODS {
        for kind in [
            format!("kind = \"pid\", {pid}, limits = {{ q1 = 8, q2 = 11 }}"),
            format!("kind = \"fractional-pid\", {pid}, lambda = 0.8, mu = 0.6"),
            "kind = \"computed-torque\", kp = 60, kd = 9, compensate_elements = true".to_owned(),
        ] {
            let text = stepped(&arm(&format!("controller = {{ {kind}, {held} }}")), method);
            let mut paths = vec![
                ("motion.controller.kp", 0.02),
                ("motion.controller.kd", 0.002),
                ("motion.controller.reference.to.q1", 1e-4),
                ("element.tendon.alpha", 1e-3),
                ("robot.body.two.mass", 1e-3),
            ];
            if kind.contains("lambda") {
                paths.extend([("motion.controller.lambda", 1e-3), ("motion.controller.mu", 1e-3)]);
            }
            // So little that no sample goes to the other side of a limit.
            let little = if kind.contains("limits") { 0.01 } else { 1.0 };
            let paths: Vec<(&str, f64)> = paths.into_iter().map(|(path, step)| (path, little * step)).collect();
            compare_within(1e-7, &text, &["q.q1", "q.q2", "v.q3", "tau.q1", "tau.q3"], &paths);
        }
    }
}

#[test]
fn joints_that_signals_move() {
    for method in METHODS {
        let text = stepped(ARM, method)
            .replace("torque = { q1 = 0.4,", "prescribed = { q1 = \"0.3 + 0.2*sin(5*t)\" }\ntorque = {");
        let text = text.replace("start = { q = { q1 = 0.3, q2 = 0.4,", "start = { q = { q2 = 0.4,");
        let paths = [("element.strut.c", 0.05), ("robot.body.two.mass", 1e-3), ("motion.start.q.q2", 1e-3)];
        compare(&text, &["q.q2", "v.q3", "tau.q1", "strut.force"], &paths);
    }
}

#[test]
fn states_go_on_to_the_bit() {
    let text = stepped(
        &arm(
            "controller = { kind = \"fractional-pid\", kp = 60, ki = 90, kd = 6, lambda = 0.8, mu = 0.6, reference = { kind = \"move\", to = { q1 = 0.6 }, duration = 0.3 } }",
        ),
        "midpoint",
    );
    goes_on_to_the_bit(&text, "motion.controller.kp,element.tendon.alpha", 0.1511, &[0.1573, 0.3519]);
}

#[test]
fn what_such_steps_go_over_is_refused() {
    let text = stepped(ARM, "midpoint").replace("q1 = 0.4,", "q1 = \"0.4*step(t - f)\",");
    let mut asked = scenario(&text);
    asked.differentiate("constants.f").unwrap();
    let words = said(&asked);
    assert!(words.contains("the time at which a function jumps in steps of one size"), "{words}");
    let event = "[[event]]\nname = \"late\"\nwhen = \"t - 0.2\"\naction = { set = { \"tau.q1\" = 1 } }\n[motion]";
    let mut asked = scenario(&stepped(ARM, "midpoint").replace("[motion]", event));
    asked.differentiate("element.tendon.k").unwrap();
    let words = said(&asked);
    assert!(words.contains("events that set something in steps of one size"), "{words}");
}
