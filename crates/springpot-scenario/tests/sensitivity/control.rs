//! Robots that are controlled: derivatives by gains, orders, references and limits, and by all else through them.

use super::{ARM, compare, compare_within, goes_on_to_the_bit, plan, rows, said, scenario};

/// The arm with a springpot across its second joint under this controller.
pub(crate) fn arm(controller: &str) -> String {
    let text = ARM.replace("torque = { q1 = 0.4, q2 = \"0.5*cos(2*pi*f*t)\" }", controller);
    text.replace("law = \"kelvin-voigt\"\nparameters = { k = 40, c = 5 }", SPRINGPOT)
}

pub(crate) const SPRINGPOT: &str = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 40, c = 5, alpha = 0.4 }";

const COLUMNS: [&str; 9] = ["q.q1", "q.q2", "q.q3", "v.q3", "tau.q1", "tau.q2", "tau.q3", "gripper.y", "gripper.error"];

const PLANT: [(&str, f64); 9] = [
    ("robot.body.two.mass", 5e-3),
    ("robot.body.link.com.2", 1e-3),
    ("robot.gravity.0", 1e-2),
    ("element.tendon.alpha", 3e-3),
    ("element.strut.to.point.1", 1e-3),
    ("robot.body.three.joint.origin.1", 1e-3),
    ("robot.body.two.joint.axis.2", 2e-3),
    ("motion.start.q.q2", 2e-3),
    ("motion.start.v.q3", 5e-3),
];

/// The numbers of a controller with all that is not its own, or with some of that.
fn with_plant<'a>(own: &[(&'a str, f64)]) -> Vec<(&'a str, f64)> {
    [own, &PLANT].concat()
}

fn with_some<'a>(own: &[(&'a str, f64)]) -> Vec<(&'a str, f64)> {
    [own, &[PLANT[0], PLANT[3], PLANT[5], PLANT[8]]].concat()
}

const MOVE: &str = "reference = { kind = \"move\", to = { q1 = 0.6, q2 = 0.1, q3 = 0.1 }, duration = 0.3 }";

#[test]
fn proportional_derivative_with_gravity() {
    let text = arm(&format!(
        "controller = {{ kind = \"pd-gravity\", kp = {{ q1 = 60, q2 = 70, q3 = 300 }}, kd = 6, {MOVE} }}"
    ));
    let own = [
        ("motion.controller.kp.q2", 0.1),
        ("motion.controller.kd", 0.02),
        ("motion.controller.reference.to.q1", 2e-3),
        ("motion.controller.reference.duration", 1e-3),
    ];
    compare(&text, &COLUMNS, &with_plant(&own));
}

#[test]
fn a_move_of_thirds() {
    let text = arm(&format!(
        "controller = {{ kind = \"pd-gravity\", kp = 60, kd = 6, {} }}",
        MOVE.replace("0.3 }", "0.3, profile = \"trapezoid\" }")
    ));
    compare(&text, &COLUMNS, &[("motion.controller.reference.duration", 1e-3), ("motion.start.q.q1", 2e-3)]);
}

#[test]
fn signals_of_joints_through_constants() {
    let reference =
        "reference = { kind = \"joints\", q1 = \"0.3 + 0.2*sin(2*pi*f*t)\", q2 = 0.2, q3 = \"0.05*cos(f*t)\" }";
    let text = arm(&format!(
        "controller = {{ kind = \"pd-gravity\", kp = {{ q1 = 60, q2 = {{ expression = \"k_0\" }}, q3 = 300 }}, kd = 6, {reference} }}"
    ));
    compare(
        &text,
        &COLUMNS,
        &[("constants.f", 2e-3), ("constants.k_0", 0.1), ("motion.controller.reference.q2", 2e-3)],
    );
}

// The gripper is so near to where it should be that differences of its distance know less.
#[test]
fn inverse_dynamics() {
    for compensates in [false, true] {
        let text = arm(&format!(
            "controller = {{ kind = \"computed-torque\", kp = 60, kd = 9, compensate_elements = {compensates}, {MOVE} }}"
        ));
        let own = [
            ("motion.controller.kp", 0.1),
            ("motion.controller.kd.q3", 0.02),
            ("motion.controller.reference.to.q2", 2e-3),
            ("motion.controller.reference.duration", 1e-3),
        ];
        let own = if compensates { &own[..1] } else { &own[..] };
        let text = text.replace("kd = 9", "kd = { q1 = 9, q2 = 8, q3 = 7 }");
        compare(&text, &COLUMNS[..8], &with_some(own));
    }
}

#[test]
fn proportional_integral_derivative() {
    let text = arm(&format!("controller = {{ kind = \"pid\", kp = 60, ki = {{ q1 = 30, q2 = 40 }}, kd = 6, {MOVE} }}"));
    let own = [
        ("motion.controller.kp.q1", 0.1),
        ("motion.controller.ki.q2", 0.1),
        ("motion.controller.ki.q3", 0.1),
        ("motion.controller.kd", 0.02),
        ("motion.controller.reference.to.q3", 1e-3),
        ("motion.controller.reference.duration", 1e-3),
    ];
    let text =
        text.replace("kp = 60,", "kp = { q1 = 60, q2 = 60, q3 = 80 },").replace("q2 = 40 }", "q2 = 40, q3 = 20 }");
    compare(&text, &COLUMNS, &with_some(&own));
}

#[test]
fn orders_of_errors() {
    let text = arm(&format!(
        "controller = {{ kind = \"fractional-pid\", kp = 60, ki = {{ q1 = 30, q2 = 40, q3 = 20 }}, kd = 6, lambda = {{ q1 = 0.8, q2 = 0.5, q3 = 1 }}, mu = {{ q1 = 0.7, q2 = 0.4, q3 = 1 }}, {MOVE} }}"
    ));
    let own = [
        ("motion.controller.lambda.q1", 2e-3),
        ("motion.controller.lambda.q2", 2e-3),
        ("motion.controller.mu.q1", 2e-3),
        ("motion.controller.mu.q2", 2e-3),
        ("motion.controller.ki.q2", 0.1),
        ("motion.controller.kd", 0.02),
        ("motion.controller.reference.to.q1", 1e-3),
        ("motion.controller.reference.duration", 1e-3),
    ];
    compare(&text, &COLUMNS, &with_plant(&own));
}

#[test]
fn a_spring_at_the_gripper() {
    for reference in
        [MOVE, "reference = { kind = \"gripper-path\", x = \"0.2 + 0.1*sin(f*t)\", y = 0.9, z = \"0.4*exp(-t)\" }"]
    {
        let text = arm(&format!("controller = {{ kind = \"impedance\", kp = 80, kd = 9, {reference} }}"));
        let own = [("motion.controller.kp", 0.1), ("motion.controller.kd", 0.02)];
        let of_reference = if reference == MOVE {
            [("motion.controller.reference.to.q2", 2e-3), ("motion.controller.reference.duration", 1e-3)]
        } else {
            [("motion.controller.reference.y", 2e-3), ("constants.f", 2e-3)]
        };
        let more = [("robot.gripper.point.0", 1e-3), ("element.strut.to.point.1", 1e-3)];
        compare(&text, &COLUMNS, &with_some(&[&own[..], &of_reference, &more].concat()));
    }
}

/// The arm with a damper whose input follows from the state, and with torques that do so.
fn fed_back(input: &str, torque: &str) -> String {
    let motion = "torque = { q1 = 0.4, q2 = \"0.5*cos(2*pi*f*t)\" }";
    let text = ARM.replace(motion, &format!("torque = {{ {torque} }}"));
    let law = "law = \"magnetorheological\"\nparameters = { E_c = 40, mu_0 = 5, mu = 6, alpha = 0.4 }";
    let text = text.replace("law = \"kelvin-voigt\"\nparameters = { k = 40, c = 5 }", law);
    let text = text.replace("rest_length = 0.2\n", &format!("rest_length = 0.2\ninputs = {{ u = \"{input}\" }}\n"));
    text.replace("k_0 = 80", "k_0 = 80\ngain = 0.9\nlevel = 0.33")
}

const STATE: [(&str, f64); 7] = [
    ("constants.gain", 3e-3),
    ("constants.level", 2e-3),
    ("element.tendon.alpha", 3e-3),
    ("element.tendon.rest_length", 5e-4),
    ("robot.body.two.mass", 5e-3),
    ("robot.gripper.point.0", 1e-3),
    ("motion.start.q.q2", 2e-3),
];

const SEEN: [&str; 8] = ["q.q1", "q.q2", "q.q3", "v.q3", "tau.q2", "tendon.force", "tendon.u", "gripper.y"];

#[test]
fn feedback_that_is_smooth() {
    let input = "1 + gain*tanh(3*tendon.rate*v.q2) + level*tendon.stroke + 0.1*sin(2*pi*f*t)";
    let torque = "q1 = \"-gain*v.q1 - level*q.q2*gripper.vx\", q2 = \"0.3*cos(tendon.length) + gripper.z*gain\"";
    compare(&fed_back(input, torque), &SEEN, &STATE);
}

#[test]
fn feedback_with_kinks() {
    // A skyhook damper, and a spring with a dead zone.
    let input = "min(1.5, max(0.1, gain*v.q2*tendon.rate + level))";
    let torque = "q1 = \"-gain*abs(v.q1)\", q2 = \"-5*max(0, q.q2 - level) - 5*min(0, q.q2 + 0.1)\"";
    compare(&fed_back(input, torque), &SEEN, &STATE);
}

#[test]
fn forces_that_jump() {
    // A damper that is switched on where it brakes the second joint, and a relay.
    let input = "0.2 + gain*step(v.q2*tendon.rate - 0.01*level)";
    let torque = "q1 = \"-gain*sign(q.q1 - level)\", q2 = \"-2*step(gripper.z - 0.2*level)\"";
    compare(&fed_back(input, torque), &SEEN, &STATE);
}

#[test]
fn inputs_that_jump_before_laws_that_remember() {
    let spencer = "c_0a = 2, c_0b = 1.5, c_1a = 20, c_1b = 12, k_0 = 30, k_1 = 5, x_0 = 0.01, alpha_a = 20, alpha_b = 30, A = 1, beta = 60, gamma = 60, n = 2";
    let bouc_wen =
        "c_0a = 3, c_0b = 2, k_0 = 9, x_0 = 0.01, alpha_a = 20, alpha_b = 30, A = 1, beta = 60, gamma = 60, n = 2";
    for (law, parameters) in [("spencer", spencer), ("bouc-wen-damper", bouc_wen)] {
        let text = fed_back("0.2 + gain*step(v.q2*tendon.rate)", "q1 = 0.4").replace(
            "law = \"magnetorheological\"\nparameters = { E_c = 40, mu_0 = 5, mu = 6, alpha = 0.4 }",
            &format!("law = \"{law}\"\nparameters = {{ {parameters}, eta = 40 }}"),
        );
        let paths = [
            ("constants.gain", 1e-2),
            ("element.tendon.alpha_b", 0.2),
            ("element.tendon.k_0", 0.1),
            ("robot.body.two.mass", 2e-3),
            ("motion.start.q.q2", 1e-3),
        ];
        // Hysteresis bends where its rate turns: behind that its derivatives are known to 2.5e-7.
        compare_within(1e-6, &text.replace("rtol = 1e-10", "rtol = 1e-11"), &SEEN[..4], &paths);
    }
}

#[test]
fn forces_at_their_limits() {
    for more in ["limits = { q1 = 9, q2 = 12 }", "limits = { q1 = 9 }, rate_limits = { q1 = 60, q2 = 50, q3 = 200 }"] {
        let text = arm(&format!("controller = {{ kind = \"pd-gravity\", kp = 60, kd = 6, {MOVE}, {more} }}"));
        let limit = if more.contains("rate") {
            ("motion.controller.rate_limits.q2", 0.05)
        } else {
            ("motion.controller.limits.q2", 0.02)
        };
        let own = [("motion.controller.kp", 0.1), ("motion.controller.limits.q1", 0.02), limit];
        compare(&text, &COLUMNS, &with_some(&own));
    }
}

#[test]
fn integrals_at_limits() {
    for rule in ["conditional", "none"] {
        let text = arm(&format!(
            "controller = {{ kind = \"pid\", kp = 60, ki = 400, kd = 6, {MOVE}, limits = {{ q1 = 7, q2 = 9, q3 = 14 }}, anti_windup = \"{rule}\" }}"
        ));
        let own = [
            ("motion.controller.kp", 0.1),
            ("motion.controller.ki", 0.3),
            ("motion.controller.limits.q1", 0.02),
            ("motion.controller.limits.q2", 0.02),
        ];
        compare(&text, &COLUMNS, &with_some(&own));
    }
}

#[test]
fn what_is_sampled() {
    let controller = |more: &str| {
        arm(&format!(
            "controller = {{ kind = \"pid\", kp = 60, ki = 90, kd = 6, {MOVE}, limits = {{ q1 = 8, q2 = 11 }}, rate_limits = {{ q3 = 60 }}, {more} }}"
        ))
    };
    let own = [
        ("motion.controller.kp", 0.1),
        ("motion.controller.ki", 0.1),
        ("motion.controller.limits.q2", 1e-3),
        ("motion.controller.rate_limits.q3", 1e-2),
        ("motion.controller.reference.to.q1", 1e-3),
    ];
    for more in ["sample = \"20 ms\"", "sample = \"20 ms\", delay = \"40 ms\""] {
        // So little that no sample goes to the other side of a limit.
        let little = with_some(&own).into_iter().map(|(path, step)| (path, 0.04 * step));
        compare(&controller(more), &COLUMNS[..8], &little.collect::<Vec<_>>());
    }
    let text = arm(&format!(
        "controller = {{ kind = \"computed-torque\", kp = 60, kd = 9, compensate_elements = true, {MOVE}, sample = \"15 ms\" }}"
    ));
    compare(&text, &COLUMNS[..8], &with_some(&own[..1]));
}

#[test]
fn feedback_that_is_sampled() {
    let input =
        "{ expression = \\\"0.4 + gain*tanh(tendon.force) + 0.01*a.q2\\\", unit = \\\"V\\\", sample = \\\"20 ms\\\" }";
    let input = input.replace("\\\"", "\"");
    let torque = "q1 = { expression = \"-gain*v.q1 - level*tendon.stroke + 0.1*strut.force\", unit = \"N*m\", sample = \"10 ms\" }, q2 = \"-level*v.q2\"";
    let text = fed_back("INPUT", torque).replace("\"INPUT\"", &input);
    compare(&text, &SEEN, &STATE);
}

#[test]
fn states_take_what_control_changes_with_them() {
    let pid = "kind = \"fractional-pid\", kp = 60, ki = 90, kd = 6, lambda = 0.8, mu = 0.6";
    for controller in [
        format!("{{ {pid}, {MOVE}, rate_limits = {{ q1 = 60, q2 = 50, q3 = 200 }} }}"),
        format!("{{ {pid}, {MOVE}, sample = \"20 ms\", delay = \"20 ms\" }}"),
    ] {
        let text = arm(&format!("controller = {controller}"));
        goes_on_to_the_bit(&text, "motion.controller.kp,motion.controller.mu,element.strut.c", 0.15, &[0.35]);
    }
}

#[test]
fn what_controllers_do_not_know_is_refused() {
    let path = "reference = { kind = \"gripper-path\", x = \"0.2 + 0.1*t\", y = 0.9, z = 0.4 }";
    let joints = "kind = \"fractional-pid\", kp = 60, ki = 9, kd = 6, lambda = 1, mu = 0.6";
    for (controller, path, words) in [
        (format!("{{ {joints}, {MOVE} }}"), "motion.controller.lambda", "start at 0.99"),
        (format!("{{ {joints}, {MOVE} }}"), "motion.controller.sample", "cannot be a parameter"),
        (format!("{{ {joints}, {MOVE} }}"), "motion.controller.reference.profile", "cannot be a parameter"),
        (format!("{{ {joints}, {MOVE} }}"), "motion.controller.limits.q1", "the file does not say it"),
        (format!("{{ {joints}, {path} }}"), "motion.controller.reference.y", "solved for the joints"),
        (format!("{{ {joints}, {path} }}"), "motion.start.q.q1", "solved for the joints"),
        (format!("{{ {joints}, {path} }}"), "robot.body.two.joint.origin.1", "solved for the joints"),
    ] {
        let mut asked = scenario(&arm(&format!("controller = {controller}")));
        asked.differentiate(path).unwrap();
        let said = said(&asked);
        assert!(said.contains(words), "{path}: {said}");
    }
    let mut asked = scenario(&fed_back("0.2*step(t - level)*abs(v.q2)", "q1 = 0.1"));
    asked.differentiate("constants.level").unwrap();
    let said = said(&asked);
    assert!(said.contains("`step` jumps where the constant has it"), "{said}");
}

#[test]
fn a_gain_of_0_has_a_derivative_and_changes_nothing() {
    let text = arm(&format!(
        "controller = {{ kind = \"fractional-pid\", kp = 60, ki = {{ q1 = 30 }}, lambda = 0.7, mu = 0.6, {MOVE} }}"
    ));
    let names: Vec<String> = COLUMNS.map(str::to_owned).to_vec();
    let by = "by = [\"motion.controller.ki.q2\", \"motion.controller.kd\"]";
    let asked = format!("{text}\n[sensitivity]\n{by}\ncontrol = false\n");
    assert_eq!(rows(&plan(&scenario(&asked)).unwrap(), &names), rows(&plan(&scenario(&text)).unwrap(), &names));
    // From inside: a second difference from 0 on.
    let paths = ["motion.controller.ki.q2", "motion.controller.kd"];
    let told: Vec<String> = paths.iter().map(|path| format!("d(q.q2)/d({path})")).collect();
    let found = rows(&plan(&scenario(&asked)).unwrap(), &told);
    for (p, path) in paths.iter().enumerate() {
        let step = 2e-3;
        let at = |steps: f64| {
            let mut moved = scenario(&text);
            moved.set(&format!("{path}={:?}", steps * step)).unwrap();
            moved.set("solver.rtol=1e-12").unwrap();
            rows(&plan(&moved).unwrap(), &names[1..2])
        };
        let [none, one, two, three] = [0.0, 1.0, 2.0, 3.0].map(at);
        for r in 0..none.len() {
            let slope = -11.0 / 6.0 * none[r][0] + 3.0 * one[r][0] - 1.5 * two[r][0] + three[r][0] / 3.0;
            let (found, truth) = (found[r][p], slope / step);
            assert!((found - truth).abs() < 1e-6 * truth.abs() + 1e-9, "{path}: {found} for {truth}");
        }
    }
}
