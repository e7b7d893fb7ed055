//! Derivatives where forces bend, where joints come to rest alone, where events set what is set already, and through constants in places of numbers.

use super::laws::slider;
use super::{ARM, COLUMNS, COLUMNS_OF_SLIDER, compare, compare_within, plan, said, scenario};
use springpot::Simulation;

/// A mass with a law of its own, whose derivatives take the steps of the plain run.
fn on_plain_steps(element: &str) -> String {
    format!("{}\n[[parameter]]\npath = \"robot.body.cart.com.0\"\n[sensitivity]\ncontrol = false\n", slider(element))
}

/// The step that ends where a part of a law bends belongs to the near side: what it takes over from the far side is an error of the size of the step, at
/// any tolerance.
#[test]
fn a_step_to_a_kink_has_the_slopes_of_the_near_side() {
    let lifted = r#"network = "parallel(spring(k), dashpot(c), compression(k_c))"
parameters = { k = 300, c = 2, k_c = 4000 }"#;
    let rubbed = r#"network = "parallel(spring(k), dashpot(c), jenkins(k_j, F_y))"
parameters = { k = 900, c = 1, k_j = 400, F_y = 6 }"#;
    let wound = r#"network = "parallel(spring(k), bouc-wen(a_h, A, beta, gamma, n))"
parameters = { k = 900, a_h = 300, A = 1, beta = 20, gamma = 30, n = 2 }"#;
    let columns = &COLUMNS_OF_SLIDER[..3];
    for (element, paths) in [
        (lifted, [("element.strut.k_c", 5.0), ("robot.body.cart.mass", 1e-3), ("motion.start.v.q1", 1e-3)]),
        (rubbed, [("element.strut.F_y", 5e-3), ("element.strut.k_j", 0.5), ("motion.start.v.q1", 1e-3)]),
        (wound, [("element.strut.a_h", 0.5), ("element.strut.gamma", 0.05), ("motion.start.v.q1", 1e-3)]),
    ] {
        compare_within(1e-6, &on_plain_steps(element), columns, &paths);
    }
}

/// One joint with friction that sticks, and nothing else that moves when it comes to rest.
#[test]
fn a_joint_that_sticks_alone_keeps_its_derivatives() {
    let text = slider("law = \"kelvin-voigt\"\nparameters = { k = 150, c = 2 }")
        .replace("axis = [1, 0, 0] }", "axis = [1, 0, 0], friction = { force = 8, stick = true } }")
        .replace("[time]", "torque = { q1 = \"A*step(t - 0.3)\" }\n[constants]\nA = 40\n[time]");
    let paths = [("element.strut.k", 0.2), ("robot.body.cart.mass", 1e-3), ("constants.A", 1e-2)];
    compare_within(1e-6, &text, &["q.q1", "v.q1", "strut.force"], &paths);
}

/// What friction takes bends where a joint comes to rest, and goes on with the other sign where it turns round.
#[test]
fn losses_bend_where_a_joint_comes_to_rest() {
    let rests = r#"robot.gravity = [0, 0, 0]
[[robot.body]]
name = "a"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0], friction = { force = 3, stick = true }, damping = 0.7 }
mass = 2
[motion]
kind = "forward"
start = { v = { x = 0.4 } }
torque = { x = "0.5 - 0.2*q.x - 0.3*v.x" }
[time]
end = 1.5
output_step = 0.1
"#;
    let turns = rests
        .replace("torque = { x = \"0.5 - 0.2*q.x - 0.3*v.x\" }", "torque = { x = \"-60*q.x\" }")
        .replace("x = 0.4 }", "x = 1.5 }");
    let joint = |key: &str| format!("robot.body.a.joint.{key}");
    for text in [rests, &turns] {
        for rtol in ["1e-7", "1e-9", "1e-10", "1e-12"] {
            let text = format!("{text}[solver]\nrtol = {rtol}\n");
            let paths = [
                ("motion.start.v.x", 1e-3),
                ("robot.body.a.mass", 1e-3),
                (&*joint("friction.force"), 1e-3),
                (&*joint("damping"), 1e-3),
            ];
            compare_within(1e-6, &text, &["energy.actuators", "energy.joints", "q.x"], &paths);
        }
    }
}

/// An event that sets a torque to what it is moves nothing, and what moves later is not moved by it.
#[test]
fn events_that_set_what_is_set_leave_nothing_behind() {
    let text = slider("law = \"kelvin-voigt\"\nparameters = { k = 900, c = 1 }").replace(
        "[[element]]",
        "[[robot.body]]\nname = \"other\"\njoint = { name = \"p\", kind = \"prismatic\", axis = [0, 1, 0] }\nmass = 1\n[[element]]",
    );
    let text = text.replace(
        "[motion]",
        "[[event]]\nname = \"up\"\nwhen = \"q.q1 - 0.04\"\ndirection = \"rising\"\naction = { set = { \"tau.q1\" = -12 } }\n[motion]",
    );
    let text = text.replace("[time]", "torque = { q1 = 5, p = \"3*step(t - 0.8)\" }\n[time]");
    let text = text.replace("end = 0.4", "end = 1");
    let mut asked = scenario(&text);
    asked.differentiate("element.strut.k").unwrap();
    let plan = plan(&asked).unwrap();
    let system = plan.system();
    let other = system.model.v_labels().iter().position(|label| label.name == "p").unwrap();
    let mut simulation = Simulation::new(system, plan.settings.clone()).unwrap();
    let mut acts = 0;
    while simulation.step().unwrap() {
        acts += simulation.passed().count();
    }
    assert!(acts >= 2, "the event acts {acts} times");
    assert_eq!(simulation.lost().count(), 0);
    let [_, v] = simulation.tangents().unwrap();
    assert_eq!(v[other], 0.0, "nothing ties the two");
    assert!(simulation.v()[other] > 0.1);
}

/// Constants reach every number through `{ expression = … }`, whatever becomes of them on the way.
#[test]
fn constants_through_expressions_in_places_of_numbers() {
    let text = ARM
        .replace("[constants]", "[constants]\na = 2\nb = 0.3")
        .replace(
            "parameters = { k = 40, c = 5 }",
            "parameters = { k = { expression = \"10*a^2\" }, c = { expression = \"10/a\" } }",
        )
        .replace("mass = 3\n", "mass = { expression = \"1.5*a\" }\n")
        .replace("rest = 0.05\n", "rest = { expression = \"0.1*a*sin(pi*b)\" }\n")
        .replace("start = { q = { q1 = 0.3,", "start = { q = { q1 = { expression = \"a*b/2\" },");
    compare(&text, &COLUMNS[..9], &[("constants.a", 2e-3), ("constants.b", 5e-4)]);
}

#[test]
fn constants_that_move_rows_or_metrics_are_refused() {
    let metric = |band: &str| {
        format!("{ARM}\n[[metric]]\nname = \"settled\"\nof = \"q.q1\"\nkind = \"settling-time\"\nband = {band}\n")
    };
    for (text, what) in [
        (ARM.replace("end = 0.4\n", "end = { expression = \"f\" }\n"), "time.end follows from it"),
        (metric("{ expression = \"0.3*f\" }"), "band follows from it"),
        (
            ARM.replace(
                "torque = { q1 = 0.4,",
                "torque = { q1 = { expression = \"-v.q1\", unit = \"N*m\", sample = { expression = \"0.01*f/f\" } },",
            ),
            "sample",
        ),
    ] {
        let mut asked = scenario(&text);
        asked.differentiate("constants.f").unwrap();
        let said = said(&asked);
        assert!(said.contains("constants.f cannot be a parameter") && said.contains(what), "{said}");
    }
}

/// A step at t = 0 that a parameter moves has no derivative there: it jumps in one way and not in the other.
#[test]
fn a_switch_at_the_start_has_no_derivative() {
    let text = slider("law = \"kelvin-voigt\"\nparameters = { k = 900, c = 1 }")
        .replace("[time]", "torque = { q1 = \"4*step(t - t_s)\" }\n[constants]\nt_s = 0\n[time]");
    let mut asked = scenario(&text);
    asked.differentiate("constants.t_s,element.strut.k").unwrap();
    let plan = plan(&asked).unwrap();
    let simulation = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    let lost: Vec<_> = simulation.lost().map(|lost| (lost.parameter, lost.t)).collect();
    assert_eq!(lost, [(0, 0.0)]);
}

/// t^f has no logarithm at t = 0 and a derivative all the same.
#[test]
fn powers_of_t_by_their_exponent() {
    let text = slider("law = \"kelvin-voigt\"\nparameters = { k = 900, c = 1 }")
        .replace("[time]", "torque = { q1 = \"30*t^f\" }\n[constants]\nf = 2\n[time]");
    compare(&text, &COLUMNS_OF_SLIDER, &[("constants.f", 1e-3)]);
}
