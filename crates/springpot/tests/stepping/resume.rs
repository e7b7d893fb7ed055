//! From every state of runs of all kinds a run goes on as the one that was never stopped: every shipped scenario, laws of control, what changes on the way.

use super::{bits, cases};
use crate::support::robots::{ARM, strut};
use springpot::Simulation;
use springpot_scenario::Plan;

/// So many steps are looked at behind each state: what a step leaves to the next but one shows.
const AHEAD: usize = 3;

/// The steps of a run that are looked at.
const MOST: usize = 600;

/// Goes on from every state, in a simulation that was elsewhere before and, here and there, in a new one.
fn goes_on(name: &str, plan: &Plan) {
    let system = plan.system();
    let begin = || Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    let mut whole = begin();
    let mut steps = Vec::new();
    while steps.len() < MOST && whole.step().unwrap() {
        steps.push(bits(&system, &whole.snapshot().unwrap()));
    }
    let (mut stopped, mut used) = (begin(), begin());
    for k in 0..=steps.len() {
        let state = stopped.state().unwrap();
        let mut new = (k % 8 == 1).then(begin);
        for other in new.iter_mut().chain([&mut used]) {
            other.set_state(&state).unwrap();
            for (m, expected) in steps.iter().enumerate().skip(k).take(AHEAD) {
                other.step().unwrap();
                let found = bits(&system, &other.snapshot().unwrap());
                assert!(found == *expected, "{name}: from step {k}, t = {}, apart at step {}", state.t(), m + 1);
            }
        }
        let Some(expected) = steps.get(k) else { break };
        stopped.step().unwrap();
        assert!(bits(&system, &stopped.snapshot().unwrap()) == *expected, "{name}: {k}");
    }
}

#[test]
fn shipped_scenarios_go_on_to_the_bit_from_every_state() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    files.sort();
    let mut count = 0;
    for path in files {
        let plan = cases(&std::fs::read_to_string(&path).unwrap()).plan(0).unwrap();
        // Schemes work on complete motions alone.
        if plan.system().elements.iter().all(|element| element.scheme.is_none()) {
            goes_on(&path.display().to_string(), &plan);
            count += 1;
        }
    }
    assert!(count > 25, "{count}");
}

/// The arm under this motion, with a damper whose law, inputs and the like are `law`; `more` are tables of their own.
fn arm(law: &str, motion: &str, more: &str) -> String {
    let time = "[time]\nend = 0.4\noutput_step = 0.0317\n[solver]\nrtol = 1e-6\n";
    format!(
        "{ARM}{}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.4, q3 = 0.3 }}, v = {{ q2 = -0.3 }} }}\n{motion}\n{more}\n{time}",
        strut(law)
    )
}

fn damper(input: &str) -> String {
    format!(
        "law = \"magnetorheological\"\nparameters = {{ E_c = 40, mu_0 = 5, mu = 6, alpha = 0.4 }}\ninputs = {{ u = {input} }}"
    )
}

#[test]
fn control_goes_on_to_the_bit_from_every_state() {
    let reference = "reference = { kind = \"move\", to = { q1 = 0.6, q2 = 0.1, q3 = 0.1 }, duration = 0.3 }";
    let law = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 40, c = 5, alpha = 0.4 }";
    for controller in [
        "kind = \"pd-gravity\", kp = 60, kd = 6",
        "kind = \"pd-gravity\", kp = 60, kd = 6, limits = { q1 = 4, q2 = 12 }, rate_limits = { q1 = 60, q2 = 50 }",
        "kind = \"computed-torque\", kp = 60, kd = 9, compensate_elements = true",
        "kind = \"pid\", kp = 60, ki = 400, kd = 6, limits = { q1 = 4, q2 = 14 }, anti_windup = \"conditional\"",
        "kind = \"fractional-pid\", kp = 60, ki = 90, kd = 6, lambda = 0.8, mu = 0.6, rate_limits = { q1 = 60 }",
        "kind = \"fractional-pid\", kp = 60, ki = 90, lambda = 0.8, sample = \"20 ms\", delay = \"20 ms\"",
        "kind = \"impedance\", kp = 80, kd = 9",
    ] {
        goes_on(
            controller,
            &cases(&arm(law, &format!("controller = {{ {controller}, {reference} }}"), "")).plan(0).unwrap(),
        );
    }
    for (input, torque) in [
        (
            "\"1 + tanh(3*strut.rate*v.q2) + strut.stroke\"",
            "q1 = \"-v.q1 - q.q2*gripper.vx\", q2 = \"0.3*cos(strut.length)\"",
        ),
        ("\"min(1.5, max(0.1, 9*v.q2*strut.rate + 0.3))\"", "q1 = \"-abs(v.q1)\", q2 = \"-5*max(0, q.q2 - 0.3)\""),
        ("\"0.2 + 0.9*step(v.q2*strut.rate)\"", "q1 = \"0.4 - sign(q.q1 - 0.001)\""),
        ("{ expression = \"0.4 + tanh(strut.force)\", unit = \"V\", sample = \"20 ms\" }", "q2 = \"-v.q2\""),
        ("\"0.5 + 0.3*sin(40*t)\"", "q1 = \"sign(sin(50*t))\""),
    ] {
        goes_on(input, &cases(&arm(&damper(input), &format!("torque = {{ {torque} }}"), "")).plan(0).unwrap());
    }
    let dahl = "law = \"bouc-wen-damper\"\nparameters = { c_0a = 3, c_0b = 2, k_0 = 9, x_0 = 0.01, alpha_a = 20, alpha_b = 30, A = 1, beta = 60, gamma = 60, n = 2, eta = 40 }\ninputs = { u = \"0.2 + 0.9*step(v.q2*strut.rate)\" }";
    goes_on("bouc-wen-damper", &cases(&arm(dahl, "", "")).plan(0).unwrap());
}

#[test]
fn what_changes_on_the_way_goes_on_to_the_bit_from_every_state() {
    let plain = arm(&damper("\"1 V\""), "torque = { q1 = \"2*sin(30*t)\", q2 = \"4*sin(25*t)\" }", "");
    let event = "[[event]]\nname = \"contact\"\nwhen = \"q.q2 - 0.38\"\naction = { set = { \"tau.q1\" = 2 } }\n\
                 [[event]]\nname = \"turn\"\nwhen = \"v.q3\"\n";
    let stops = "[robot.limits]\nstiffness = 900\ndamping = 3\n";
    let joint = "name = \"q3\",";
    let warm = strut(
        "law = \"fractional-zener\"\nparameters = { k_e = 30, k_m = 200, c = 50, alpha = 0.5 }\n\
         shift = { kind = \"wlf\", C1 = 17.44, C2 = 51.6, T_ref = 290 }\n\
         thermal = { capacity = 0.1, conductance = 0.02, ambient = 295 }",
    );
    for (name, text) in [
        ("events", format!("{plain}{event}")),
        ("friction", plain.replace(joint, &format!("{joint} friction = {{ force = 1.4, stick = true }},"))),
        ("stops", format!("{}{stops}", plain.replace(joint, &format!("{joint} lower = -0.4, upper = 0.301,")))),
        ("from infinite forces", plain.replace("inputs =", "derivative = \"riemann-liouville\"\ninputs =")),
        (
            "prescribed",
            plain
                .replace("q1 = \"2*sin(30*t)\",", "")
                .replace("torque =", "prescribed = { q1 = \"abs(sin(12*t))\" }\ntorque ="),
        ),
        ("steps of one size", plain.replace("rtol = 1e-6", "method = \"midpoint\"\nstep = \"2 ms\"")),
        ("heat", plain.replace(&strut(&damper("\"1 V\"")), &warm)),
    ] {
        assert!(name == "events" || text != plain, "{name}");
        goes_on(name, &cases(&text).plan(0).unwrap());
    }
}
