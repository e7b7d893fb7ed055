//! Feedback and controllers in scenario files: what is refused, and where.

use crate::support::{assert_all_refused, cases};
use springpot_scenario::RefusalKind::*;

const ROBOT: &str = r#"
[[robot.body]]
name = "boom"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
mass = 2
com = [0.2, 0, 0]
[[robot.body]]
name = "arm"
joint = { name = "q2", kind = "prismatic", axis = [1, 0, 0], origin = [0.4, 0, 0] }
mass = 1
com = [0.2, 0, 0]
[robot.gripper]
body = "arm"
point = [0.3, 0, 0]
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "42 cm"
law = "magnetorheological"
parameters = { E_c = 100, mu_0 = 5, mu = 20, alpha = 0.5 }
inputs = { u = 1 }
[time]
end = 1
output_step = 0.1
[motion]
kind = "forward"
"#;

fn with(rest: &str) -> String {
    format!("{ROBOT}{rest}\n")
}

fn controlled(table: &str) -> String {
    with(&format!("[motion.controller]\n{table}"))
}

const PD: &str =
    "kind = \"pd-gravity\"\nkp = 10\nkd = 1\nreference = { kind = \"move\", to = { q1 = 0.5 }, duration = 1 }\n";

#[test]
fn what_a_controller_sees_is_said_where_it_belongs() {
    let pd = controlled(PD);
    let gripper = controlled(
        "kind = \"impedance\"\nkp = 10\nreference = { kind = \"gripper-path\", x = \"0.6\", y = \"0\", z = \"0\" }\n",
    );
    for extra in [
        "filter = \"5 ms\"",
        "derivative_on = \"measurement\"",
        "set_point_weight = { q1 = 0.5 }",
        "feed_forward = { q2 = \"3*t\" }",
        "sample = 0.01\nnoise = { sd = { q1 = \"1 mrad\", q2 = \"1 mm\" }, seed = 3 }\nquantization = { q1 = 1e-4 }",
    ] {
        assert!(cases(&format!("{pd}{extra}\n")).unwrap().plan(0).is_ok(), "{extra}");
    }
    assert!(cases(&format!("{gripper}derivative_on = \"measurement\"\n")).unwrap().plan(0).is_ok());
    for (text, extra, kind, words) in [
        (&pd, "filter = ‸0", OutOfRange, "filter"),
        (&pd, "derivative_on = ‸\"state\"", UnknownName, "error"),
        (&pd, "set_point_weight = ‸-1", OutOfRange, "a weight is not negative"),
        (&pd, "feed_forward = { ‸q3 = 1 }", UnknownKey, "q3"),
        (&pd, "feed_forward = { q2 = \"3 ‸rad\" }", BadQuantity, "does not fit"),
        (&pd, "noise = ‸{ sd = 1 }", Rule, "needs a `sample`"),
        (&pd, "quantization = ‸1", Rule, "needs a `sample`"),
        (&pd, "sample = 0.01\nnoise = ‸{ seed = 1 }", Missing, "sd"),
        (&pd, "sample = 0.01\nnoise = { sd = \"1 ‸mrad\" }", BadQuantity, "does not fit"),
        (&pd, "sample = 0.01\nnoise = { sd = 1, ‸power = 1 }", UnknownKey, "power"),
        (&pd, "sample = 0.01\nquantization = ‸-1", OutOfRange, "a step is not negative"),
        (&gripper, "‸set_point_weight = 0.5", Rule, "belongs to kind"),
        (&gripper, "‸filter = 0.5", Rule, "belongs to kind"),
        (&gripper, "sample = 0.01\n‸noise = { sd = 1 }", Rule, "belongs to kind"),
    ] {
        let line = format!("{}\n", text.trim_end().lines().last().unwrap());
        assert_all_refused(text, &[(&[(&line, &format!("{line}{extra}\n"))], kind, words)]);
    }
}

#[test]
fn feedback_sees_what_is_known() {
    assert_all_refused(
        &with("torque = { q1 = 0 }"),
        &[
            (
                &[("torque = { q1 = 0 }", "torque = { q1 = \"-2*‸a.q1\" }")],
                Rule,
                "a.q1 follows from the forces, of which this is one\n  help: sample it",
            ),
            (
                &[("torque = { q1 = 0 }", "torque = { q1 = \"0.1*‸strut.force\" }")],
                Rule,
                "strut.force follows from the forces",
            ),
            (&[("u = 1 }", "u = \"‸strut.derivative\" }")], Rule, "strut.derivative follows from the forces"),
            (&[("torque = { q1 = 0 }", "torque = { q1 = \"‸strut.rat\" }")], BadQuantity, "did you mean `strut.rate`?"),
            (
                &[("torque = { q1 = 0 }", "torque = { q1 = \"-‸tau.q2\" }")],
                BadQuantity,
                "tau.q2 is a column of the results, but no part of the state\n  help: feedback may name q.q1, v.q1, q.q2, v.q2, strut.length",
            ),
            (&[("u = 1 }", "u = { expression = \"‸strut.u\", sample = 0.1 } }")], BadQuantity, "no part of the state"),
            (
                &[("u = 1 }", "u = { expression = \"‸strut.stored\", sample = 0.1 } }")],
                BadQuantity,
                "feedback may name q.q1, v.q1, a.q1",
            ),
            (&[("u = 1 }", "u = \"‸gripper.error\" }")], BadQuantity, "gripper.error is a column of the results"),
            // What would be refused next is said to need more.
            (
                &[("u = 1 }", "u = \"‸strut.forc\" }")],
                BadQuantity,
                "did you mean `strut.force`? it follows from the forces",
            ),
            (&[("torque = { q1 = 0 }", "torque = { q1 = \"-‸v.q3\" }")], BadQuantity, "v.q3"),
            (
                &[("torque = { q1 = 0 }", "torque = { q1 = { expression = \"-v.q1\", unit = ‸\"V\" } }")],
                BadQuantity,
                "another dimension than N*m",
            ),
            (
                &[("torque = { q1 = 0 }", "torque = { q1 = { expression = \"-v.q1\", sample = ‸0 } }")],
                OutOfRange,
                "must be positive",
            ),
            (
                &[("torque = { q1 = 0 }", "torque = { q1 = { expression = \"-v.q1\", column = ‸\"x\" } }")],
                UnknownKey,
                "stands beside feedback",
            ),
        ],
    );
    assert_all_refused(
        &with("").replace("kind = \"forward\"", "kind = \"prescribed\"\njoints = { q1 = 0, q2 = 0 }"),
        &[
            (
                &[("u = 1 }", "u = ‸\"strut.rate\" }")],
                Rule,
                "follows from the state, but the motion is given in advance",
            ),
            (&[("q1 = 0, q2", "q1 = { expression = \"t\", sample = ‸0.1 }, q2")], UnknownKey, "belongs to feedback"),
        ],
    );
}

#[test]
fn controllers_have_their_keys_and_joints() {
    assert_all_refused(
        &controlled(PD),
        &[
            (
                &[("\"pd-gravity\"", "‸\"pd\"")],
                UnknownName,
                "no kind of controller\n  help: did you mean `pd-gravity`?",
            ),
            (&[("kp = 10", "kp = ‸-10")], OutOfRange, "a gain is not negative"),
            (&[("kp = 10", "kp = { q1 = 10, ‸q3 = 2 }")], UnknownKey, "unknown key `q3`"),
            (
                &[("kp = 10", "‸ki = 2\nkp = 10")],
                Rule,
                "`ki` of [motion.controller] belongs to kind = \"pid\" or \"fractional-pid\"",
            ),
            (&[("kp = 10", "kp = \"10 ‸N/m\"")], BadQuantity, "N*m/rad"),
            (&[("kd = 1", "kd = 1\nlimits = { q1 = ‸-5 }")], OutOfRange, "a limit is positive"),
            (&[("kd = 1", "kd = 1\nlimits = { q1 = \"5 ‸N\" }")], BadQuantity, "N*m"),
            (&[("kd = 1", "kd = 1\nrate_limits = { q2 = ‸0 }")], OutOfRange, "a limit is positive"),
            (&[("kd = 1", "kd = 1\nsample = 0.01\ndelay = ‸0.015")], Rule, "is no multiple of `sample`"),
            (&[("kd = 1", "kd = 1\nsample = 0.01\ndelay = ‸\"-1 ms\"")], OutOfRange, "a delay is not negative"),
            (
                &[("kd = 1", "kd = 1\nsample = \"1 ms\"\ndelay = ‸\"1e9 s\"")],
                TooLarge,
                "is 1e9 s, 1e12 times `sample`; at most 1000000 are taken",
            ),
            (&[("kd = 1", "kd = 1\ndelay = ‸0.01")], Rule, "needs a `sample`"),
            (&[("to = { q1 = 0.5 }", "to = { ‸q5 = 0.5 }")], UnknownKey, "unknown key `q5`"),
            (&[("duration = 1", "duration = ‸-1")], OutOfRange, "must be positive"),
            (&[("kind = \"move\"", "kind = ‸\"hold\"")], UnknownName, "which is no kind of reference"),
            (
                &[("{ kind = \"move\", to = { q1 = 0.5 }, duration = 1 }", "‸{ kind = \"joints\", q1 = 0 }")],
                Missing,
                "has no signal for q2",
            ),
            (&[("duration = 1 }", "duration = 1, ‸x = 1 }")], Rule, "belongs to kind = \"gripper-path\""),
        ],
    );
    let locked = controlled(PD).replace("kind = \"forward\"", "kind = \"forward\"\nlocked = [\"q2\"]");
    assert_all_refused(
        &locked,
        &[
            (&[("kp = 10", "kp = { q1 = 10, ‸q2 = 2 }")], Rule, "joint \"q2\" is none that the controller drives"),
            (&[("to = { q1 = 0.5 }", "to = { q2 = ‸0.5 }")], Rule, "which the controller does not drive"),
        ],
    );
    let fractional = controlled(PD).replace("\"pd-gravity\"", "\"fractional-pid\"\nlambda = 0.5");
    assert_all_refused(
        &fractional,
        &[
            (&[("lambda = 0.5", "lambda = ‸0")], OutOfRange, "an order is above 0 and at most 1"),
            (&[("lambda = 0.5", "mu = { q1 = ‸1.5 }")], OutOfRange, "an order is above 0 and at most 1"),
            (&[("kd = 1", "mu = 0.5\nkd = \"1 ‸N*m*s/rad\"")], BadQuantity, "this place takes `N*m*s^mu/rad`"),
            (&[("kd = 1", "ki = \"1 ‸N*m\"")], BadQuantity, "this place takes `N*m/(rad*s^lambda)`"),
        ],
    );
    let impedance = controlled(PD).replace("\"pd-gravity\"", "\"impedance\"");
    assert_all_refused(
        &impedance,
        &[(&[("kp = 10", "kp = ‸{ q1 = 10 }")], WrongType, "impedance acts at the gripper")],
    );
    let gripperless = impedance.replace("[robot.gripper]\nbody = \"arm\"\npoint = [0.3, 0, 0]\n", "");
    assert_all_refused(
        &gripperless.replace("[motion.controller]", "‸[motion.controller]"),
        &[(&[("‸[motion", "‸[motion")], Missing, "needs a gripper")],
    );
}

#[test]
fn the_state_stands_in_inputs_and_torques_alone() {
    let reference = "reference = { kind = \"joints\", q1 = ‸\"q.q2\", q2 = 0 }";
    let event = "[[event]]\nname = \"e\"\nwhen = \"t - 0.1\"\naction = { set = { \"strut.u\" = ‸\"q.q1\" } }\n[time]";
    let words = "follows from the state, but has to be a signal of t";
    assert_all_refused(
        &controlled(PD),
        &[
            (&[("reference = { kind = \"move\", to = { q1 = 0.5 }, duration = 1 }", reference)], Rule, words),
            (&[("[time]", event)], Rule, words),
            (&[("\"forward\"", "\"forward\"\nprescribed = { q2 = { expression = ‸\"v.q1\" } }")], Rule, words),
        ],
    );
    let given = controlled(PD).replace("\"forward\"", "\"prescribed\"\njoints = { q1 = 0, q2 = 0 }");
    assert_all_refused(
        &given.replace("[motion.controller]", "[motion.‸controller]"),
        &[(
            &[("[motion.‸", "[motion.‸")],
            Rule,
            "`controller` of [motion] belongs to kind = \"forward\", and this is \"prescribed\"",
        )],
    );
    let floating = "[[robot.body]]\nname = \"b\"\njoint = { name = \"f\", kind = \"floating\" }\nmass = 1\ninertia = { xx = 1, yy = 1, zz = 1 }\n[time]\nend = 1\noutput_step = 0.1\n\
                    [motion]\nkind = \"forward\"\ntorque = { f = { vz = 0 } }\n[motion.controller]\nkind = \"pd-gravity\"\nkp = 1\n\
                    reference = { kind = \"move\", to = {}, duration = 1 }\n";
    let alone = &floating[..floating.find("[motion.controller]").unwrap()];
    assert_all_refused(alone, &[(&[("vz = 0", "vz = \"9.81 - ‸v.f.vv\"")], BadQuantity, "unknown name `v.f.vv`")]);
    assert_all_refused(
        floating,
        &[(
            &[("[motion.controller]", "‸[motion.controller]")],
            Rule,
            "drives no joint: of this robot none of one degree",
        )],
    );
}

#[test]
fn units_of_fractional_gains_have_their_orders() {
    let text = controlled(
        "kind = \"fractional-pid\"\nkp = { q1 = \"10 N*m/rad\", q2 = \"2 N/cm\" }\nki = { q1 = \"3 N*m/(rad*s^lambda)\" }\n\
         kd = { q1 = \"1 N*m*s^mu/rad\", q2 = \"4 N*s^0.6/m\" }\nlambda = 0.4\nmu = { q1 = 0.7, q2 = 0.6 }\n\
         reference = { kind = \"joints\", q1 = 0, q2 = \"1 cm\" }",
    );
    let plan = cases(&text).and_then(|cases| cases.plan(0)).unwrap_or_else(|refusals| panic!("{refusals}"));
    let law = format!("{:?}", plan.system().control.controller.as_ref().unwrap().law);
    assert!(
        law.contains("kp: [10.0, 200.0]") && law.contains("kd: [1.0, 4.0]") && law.contains("mu: [0.7, 0.6]"),
        "{law}"
    );
}
