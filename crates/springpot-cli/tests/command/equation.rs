//! `springpot dynamics SCENARIO --at TIME`: against the rows of a run and the reference file, and that the equation closes.

use crate::support::{ARM, Place, numbers, testdata};
use serde_json::Value;

fn at(place: &Place, file: &str, time: &str, more: &[&str]) -> Value {
    let ended = place.done(&[&["dynamics", file, "--json", "--at", time], more].concat());
    serde_json::from_str(&ended.stdout).unwrap()
}

/// Asserts that every number of `equation` that a row has is the same to the bit; returns how many there are.
fn same_as_row(place: &Place, equation: &Value, row: usize) -> usize {
    let results = place.table("results/arm/results.csv");
    let mut compared = 0;
    let mut same = |column: &str, value: &Value| {
        assert_eq!(value.as_f64().unwrap().to_bits(), results.numbers(column)[row].to_bits(), "{column} in row {row}");
        compared += 1;
    };
    same("t", &equation["t"]);
    for (k, joint) in ["q1", "x"].into_iter().enumerate() {
        for symbol in ["q", "v", "a"] {
            same(&format!("{symbol}.{joint}"), &equation[symbol][k]);
        }
        same(&format!("tau.{joint}"), &equation["equation"]["tau"][k]);
        same(&format!("damper.Q.{joint}"), &equation["elements"][0]["Q"][k]);
    }
    for key in ["length", "stroke", "rate", "derivative", "force"] {
        same(&format!("damper.{key}"), &equation["elements"][0][key]);
    }
    same("damper.u", &equation["elements"][0]["inputs"]["u"]);
    compared
}

/// The largest residual as a share of the largest term.
fn defect(equation: &Value) -> f64 {
    let largest = |value: &Value| numbers(value).into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let terms = &equation["equation"];
    let scale = ["inertia", "velocity", "gravity", "elements", "joints", "tau"].map(|term| largest(&terms[term]));
    largest(&terms["residual"]) / scale.into_iter().fold(0.0, f64::max)
}

#[test]
fn the_numbers_are_those_of_the_run() {
    let place = Place::new();
    place.done(&["run", "arm.toml"]);
    let mut compared = 0;
    for (row, time) in ["0", "100 ms", "0.2", "0.3 s", "350 ms"].into_iter().enumerate() {
        let equation = at(&place, "arm.toml", time, &[]);
        compared += same_as_row(&place, &equation, row);
        assert!(defect(&equation) < 1e-14, "{time}: {}", equation["equation"]);
    }
    assert_eq!(compared, 5 * 17);
    // Rows of another run: none of their times is one of the first.
    place.done(&["run", "arm.toml", "--set", "time.output_step=0.07"]);
    compared = same_as_row(&place, &at(&place, "arm.toml", "0.14", &[]), 2);
    assert_eq!(compared, 17);
}

#[test]
fn cases_and_overrides_are_those_of_the_run() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.9]\n";
    let place = Place::with(&format!("{ARM}{sweep}"));
    let more = ["--set", "element.damper.mu=7"];
    place.done(&[&["run", "arm.toml"], &more[..]].concat());
    for (case, alpha, first) in [("0", 0.2, 0), ("1", 0.9, 5)] {
        let equation = at(&place, "arm.toml", "0.3", &[&more[..], &["--case", case]].concat());
        assert_eq!(equation["parameters"]["element.damper.alpha"], alpha);
        assert_eq!(equation["case"], case.parse::<u64>().unwrap());
        assert_eq!(same_as_row(&place, &equation, first + 3), 17);
    }
    let first = at(&place, "arm.toml", "0.3", &[]);
    assert_eq!(first, at(&place, "arm.toml", "0.3", &["--case", "0"]));
    assert_ne!(first, at(&place, "arm.toml", "0.3", &["--case", "1"]));
}

/// The scenario of the reference state: its q, q̇ and q̈ at t = 0, and a spring of k = 1 N/m between its anchors.
fn reference_scenario(state: &Value) -> String {
    let spec = &state["spec"];
    let list = |value: &Value| format!("{:?}", numbers(value));
    let mut text = format!("[robot]\ngravity = {}\n", list(&spec["gravity"]));
    let mut origin = list(&spec["rho_00"]);
    let bodies = spec["bodies"].as_array().unwrap();
    for (k, body) in bodies.iter().enumerate() {
        let kind = if numbers(&body["xi"].clone()) == [0.0] { "revolute" } else { "prismatic" };
        let j = numbers(&body["J"]);
        text.push_str(&format!(
            "[[robot.body]]\nname = \"body{k}\"\njoint = {{ name = \"q{k}\", kind = {kind:?}, axis = {}, origin = {origin} }}\n\
             mass = {}\ncom = {}\ninertia = {{ xx = {}, yy = {}, zz = {}, xy = {}, xz = {}, yz = {} }}\n",
            list(&body["e"]), numbers(&body["m"])[0], list(&body["rho_i"]), j[0], j[4], j[8], j[1], j[2], j[5],
        ));
        origin = list(&body["rho_ii"]);
    }
    let element = &spec["element"];
    let anchor = |body: &str, point: &str| {
        let name = match numbers(&element[body])[0] as usize {
            0 => "world".to_owned(),
            number => format!("body{}", number - 1),
        };
        format!("{{ body = \"{name}\", point = {} }}", list(&element[point]))
    };
    text.push_str(&format!(
        "[[element]]\nname = \"spring\"\nfrom = {}\nto = {}\nrest_length = 0.1\nlaw = \"spring\"\nparameters = {{ k = 1 }}\n",
        anchor("body_i", "D_i"),
        anchor("body_j", "D_j")
    ));
    let [q, v, a] = ["q", "qd", "qdd"].map(|key| numbers(&state[key]));
    let joint = |k: usize| format!("q{k} = \"({}) + ({})*t + 0.5*({})*t^2\"", q[k], v[k], a[k]);
    let joints: Vec<String> = (0..bodies.len()).map(joint).collect();
    format!(
        "{text}[motion]\nkind = \"prescribed\"\njoints = {{ {} }}\n[time]\nend = 1\noutput_step = 1\n",
        joints.join(", ")
    )
}

#[test]
fn the_reference_state_is_met_term_by_term() {
    let file: Value =
        serde_json::from_str(&std::fs::read_to_string(testdata("papers/metric_and_christoffel.json")).unwrap())
            .unwrap();
    let mut compared = 0;
    let mut close = |what: &str, computed: &[f64], reference: &Value| {
        let reference = numbers(reference);
        let largest = reference.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        assert_eq!(computed.len(), reference.len(), "{what}");
        for (c, r) in computed.iter().zip(&reference) {
            assert!((c - r).abs() <= 1e-12 * largest, "{what}: {c} instead of {r}");
        }
        compared += reference.len();
    };
    for (name, state) in file.as_object().unwrap().iter().filter(|(name, _)| *name != "meta") {
        let place = Place::with(&reference_scenario(state));
        let equation = at(&place, "arm.toml", "0", &[]);
        let terms = &equation["equation"];
        close("M", &numbers(&equation["M"]), &state["a"]);
        close("christoffel", &numbers(&equation["christoffel"]), &state["Gamma"]);
        close("gravity", &numbers(&terms["gravity"]), &state["Qg"]);
        let [inertia, velocity, gravity] = ["inertia", "velocity", "gravity"].map(|term| numbers(&terms[term]));
        let left: Vec<f64> = (0..inertia.len()).map(|c| inertia[c] + velocity[c] - gravity[c]).collect();
        close("left-hand side less gravity", &left, &state["lhs_minus_Qg"]);
        let spring = &equation["elements"][0];
        let length = spring["length"].as_f64().unwrap();
        close("length", &[length], &state["l"]);
        let gradient: Vec<f64> = numbers(&spring["Q"]).iter().map(|q| -q / (length - 0.1)).collect();
        close("gradient", &gradient, &state["dl"]);
        assert!(defect(&equation) < 1e-14, "{name}");
    }
    assert_eq!(compared, 9 + 27 + 3 + 3 + 1 + 3);
}

#[test]
fn joint_losses_are_a_term() {
    let text = ARM.replace("axis = [0, 1, 0], origin", "damping = 2, friction = 0.25, axis = [0, 1, 0], origin");
    let place = Place::with(&text);
    let equation = at(&place, "arm.toml", "0.2", &[]);
    let v = equation["v"][0].as_f64().unwrap();
    assert!(v.abs() > 0.1);
    // Far above the width of the smooth sign.
    let expected = -2.0 * v - 0.25 * v.signum();
    let loss = equation["equation"]["joints"][0].as_f64().unwrap();
    assert!((loss / expected - 1.0).abs() < 1e-12, "{loss} instead of {expected}");
    assert_eq!(equation["equation"]["joints"][1], 0.0);
    assert!(defect(&equation) < 1e-14, "{}", equation["equation"]);
    assert!(place.done(&["dynamics", "arm.toml", "--at", "0.2"]).stdout.contains("\nQ joints "));
}

#[test]
fn a_singular_start_is_null_and_said() {
    let text = ARM.replace("rest_length = \"50 cm\"", "rest_length = \"49 cm\"\nderivative = \"riemann-liouville\"");
    let place = Place::with(&text);
    let equation = at(&place, "arm.toml", "0", &[]);
    for value in
        [&equation["elements"][0]["force"], &equation["equation"]["tau"][0], &equation["equation"]["residual"][1]]
    {
        assert!(value.is_null(), "{equation}");
    }
    assert!(equation["equation"]["gravity"][0].is_number() && equation["elements"][0]["stroke"].is_number());
    let said = place.done(&["dynamics", "arm.toml", "--at", "0"]).stdout;
    assert!(said.contains("the force of damper is infinite at t = 0"), "{said}");
    assert!(defect(&at(&place, "arm.toml", "0.001", &[])) < 1e-14);
}

#[test]
fn named_schemes_live_on_their_rows() {
    let place = Place::with(&ARM.replace("inputs = ", "scheme = \"l1\"\ninputs = "));
    place.done(&["run", "arm.toml"]);
    assert_eq!(same_as_row(&place, &at(&place, "arm.toml", "0.3", &[]), 3), 17);
    let ended = place.springpot(&["dynamics", "arm.toml", "--at", "0.31"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    assert!(ended.stderr.contains("t = 0.31 s is none, t = 0.3 s is"), "{}", ended.stderr);
}

#[test]
fn the_text_holds_every_term() {
    let place = Place::new();
    let text = place.done(&["dynamics", "arm.toml", "--at", "0.2"]).stdout;
    for line in [
        "title     Damped arm",
        "t         0.2 s",
        "in SI units: rad or m, N·m or N",
        "joint         q        q\u{307}         q\u{308}",
        "q1     0.21521   0.83605  -3.4433",
        "a_ab       q1    x",
        "Γ_ab,c   c = q1     c = x",
        "damper: u = 0.621599 V",
        "Q gravity        6.1426     1.0475",
        "Q damper",
        "tau",
        "residual",
    ] {
        assert!(text.lines().any(|found| found.starts_with(line)), "{line:?} in\n{text}");
    }
    assert!(text.contains("a_ac q\u{308}_a + Γ_ab,c q\u{307}_a q\u{307}_b - ΣQ - tau = 0 "), "{text}");
    let still =
        place.done(&["dynamics", "arm.toml", "--at", "0", "--set", "motion.joints.q1=0", "--set", "motion.joints.x=0"]);
    assert!(still.stdout.contains("= 0 "), "{}", still.stdout);
}

#[test]
fn large_and_floating_robots_fall_back_to_what_fits() {
    let place = Place::new();
    place.write("humanoid.urdf", std::fs::read(testdata("multibody/simple_humanoid.urdf")).unwrap());
    let humanoid: Value =
        serde_json::from_str(&std::fs::read_to_string(testdata("multibody/simple_humanoid.json")).unwrap()).unwrap();
    let joints: String = humanoid["model"]["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|joint| format!("{} = \"0.1*sin(t)\"\n", joint["name"].as_str().unwrap()))
        .collect();
    place.write(
        "humanoid.toml",
        format!(
            "robot = {{ urdf = \"humanoid.urdf\", floating_base = true }}\ntime = {{ end = 1, output_step = 1 }}\n\
             [motion]\nkind = \"prescribed\"\n[motion.joints]\n\
             floating_base = {{ x = \"t\", y = 0, z = 1, rpy = [0, \"0.2*t\", 0] }}\n{joints}"
        ),
    );
    let equation = at(&place, "humanoid.toml", "0.5", &[]);
    assert!(equation["christoffel"].is_null());
    let lengths = ["q", "v", "M", "coriolis", "joints", "q_names"].map(|key| equation[key].as_array().unwrap().len());
    assert_eq!(lengths, [36, 35, 35, 35, 35, 36]);
    assert!(defect(&equation) < 1e-14);
    let text = place.done(&["dynamics", "humanoid.toml", "--at", "0.5"]).stdout;
    assert!(text.contains("--json prints a_ab and the Coriolis matrix C too") && text.contains("C q\u{307}"), "{text}");
    assert!(text.contains("\n35  LARM_WRIST_R") && text.lines().all(|line| line.chars().count() <= 84), "{text}");
}

#[test]
fn what_has_no_equation_is_refused_or_fails() {
    let place = Place::new();
    place.write("arm.urdf", std::fs::read(testdata("multibody/double_pendulum.urdf")).unwrap());
    for (arguments, code, words) in [
        (
            &["arm.toml", "--at", "0.36"][..],
            2,
            "--at 0.36: t = 0.36 s is outside the motion, which lasts from 0 to 0.35 s",
        ),
        (&["arm.toml", "--at", "-1e-9"], 2, "is outside the motion"),
        (&["arm.toml", "--at", "1 m"], 2, "--at 1 m: `m` does not fit"),
        (&["arm.toml", "--at", "soon"], 2, "write a time such as 0.5 or \"500 ms\""),
        (&["arm.toml", "--at", "nan"], 2, "write a time such as"),
        (&["arm.toml", "--at", "0", "--case", "1"], 2, "--case 1: the last case of arm.toml is 0"),
        (&["arm.toml", "--at", "0", "--floating-base"], 2, "--floating-base is for files of robots"),
        (&["arm.toml", "--at", "0", "--set", "element.damper.alpha=2"], 2, "--set:1:22"),
        (&["arm.urdf", "--at", "0"], 2, "--at wants a scenario (.toml)"),
        (&["arm.toml", "--at", "0.3", "--set", "element.damper.u=1 - 20*t"], 1, "error: t = 0.17"),
    ] {
        let ended = place.springpot(&[&["dynamics"], arguments].concat());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(code), ""), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
    // Before it fails, the motion has its equation.
    at(&place, "arm.toml", "0.1", &["--set", "element.damper.u=1 - 20*t"]);
}
