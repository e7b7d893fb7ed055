//! What `check` and `run` warn of though it may be run: numbers that their author hardly meant. Nothing of it is said of scenarios that are right.

use crate::support::{ARM, Place, edited};
use std::fs;

const FORWARD: (&str, &str) = (
    "kind = \"prescribed\"\njoints = { q1 = \"0.3*sin(4*t)\", x = \"0.05 - 0.05*cos(6*t)\" }",
    "kind = \"forward\"\nstart = { q = { x = 0.02 } }",
);

/// The motion under a controller.
fn controlled(controller: &str) -> String {
    let motion = "kind = \"forward\"\nstart = { q = { x = 0.02 } }\n\n[motion.controller]\n";
    let reference = "reference = { kind = \"joints\", q1 = \"0.1*sin(t)\", x = 0.02 }\n";
    edited(&[(FORWARD.0, &format!("{motion}{controller}\n{reference}"))])
}

#[test]
fn what_is_hardly_meant_is_told_with_its_place() {
    let start = "start = { q = { x = 0.02 } }";
    let far = |from: &str, to: &str| edited(&[(from, to), ("\"50 cm\"", "\"start\"")]);
    let on_axis = edited(&[
        ("from = { body = \"world\", point = [0, 0.3, 0] }", "from = { body = \"world\", point = [0, 0.3, 0.5] }"),
        ("to = { body = \"slide\", point = [-0.4, 0.3, 0] }", "to = { body = \"arm\", point = [0, -0.2, 0] }"),
        ("\"50 cm\"", "\"start\""),
    ]);
    let on_axis_forward = on_axis.replace(FORWARD.0, FORWARD.1);
    for (text, place, words) in [
        (far("[0, 0.3, 0]", "[0, 300, 0]"), "arm.toml:22:8", "300 m away from a robot that is 0.5 m across"),
        (far("[-0.4, 0.3, 0]", "[-400, 0.3, 0]"), "arm.toml:23:6", "away from a robot"),
        (on_axis, "arm.toml:23:6", "no joint stretches element \"damper\": dl/dq is 0"),
        (on_axis_forward, "arm.toml:23:6", "no joint stretches element \"damper\": dl/dq is 0"),
        (
            edited(&[("\"0.3*sin(4*t)\"", "30")]),
            "arm.toml:31:",
            "`q1` of `joints` of [motion] is 30 without a unit: rad, and so 4.8 turns",
        ),
        (
            edited(&[FORWARD]).replace(start, "start = { q = { q1 = 30 } }"),
            "arm.toml:31:",
            "is 30 without a unit: rad, and so 4.8 turns",
        ),
        (edited(&[("E_c = \"20 N/m\"", "E_c = 1e300")]), "arm.toml:26:14", "E_c is 1e300 N/m"),
        (
            controlled("kind = \"pid\"\nkp = 60\nsample = \"3 s\""),
            "arm.toml:36:10",
            "is sampled every 3 s, and the run ends at 0.35 s",
        ),
        (
            controlled("kind = \"pid\"\nkp = 0"),
            "arm.toml:35:6",
            "all gains of [motion.controller] are 0: it gives no force at all",
        ),
        (controlled("kind = \"pd-gravity\"\nkp = 0"), "arm.toml:35:6", "it carries the weight and follows nothing"),
    ] {
        let scenario = Place::with(&text);
        let checked = scenario.springpot(&["check", "arm.toml", "-q"]);
        assert!(checked.said().contains(words), "{words:?} is not in {}\n{text}", checked.stderr);
        assert!(checked.stderr.contains(&format!("warning: {place}")), "{place} is not in {}", checked.stderr);
        assert!(checked.said().contains("help: "), "{}", checked.stderr);
        if !text.contains("1e300") {
            let ran = scenario.springpot(&["run", "arm.toml", "-q", "--no-figures"]);
            assert!(ran.said().contains(words), "{words:?} is not in {}", ran.stderr);
        }
    }
}

#[test]
fn what_is_meant_is_not_doubted() {
    let quiet = |text: &str, arguments: &[&str]| {
        let place = Place::with(text);
        let checked = place.done(&[&["check", "arm.toml", "-q"][..], arguments].concat());
        assert_eq!(checked.stderr, "", "{text}");
    };
    quiet(ARM, &[]);
    quiet(&edited(&[("\"0.3*sin(4*t)\"", "\"30 deg\"")]), &["--set", "element.damper.rest_length=start"]);
    quiet(&edited(&[("\"0.3*sin(4*t)\"", "\"30 rad\"")]), &["--set", "element.damper.rest_length=start"]);
    quiet(&edited(&[("\"0.3*sin(4*t)\"", "12")]), &["--set", "element.damper.rest_length=start"]);
    quiet(
        &controlled("kind = \"pid\"\nkp = 0\nkd = 5\nsample = \"350 ms\""),
        &["--set", "element.damper.rest_length=start"],
    );
    // A strut that is stretched by one joint alone, and at one time not at all.
    quiet(ARM, &["--set", "motion.joints.x=0", "--set", "element.damper.rest_length=start"]);
}

#[test]
fn no_shipped_scenario_is_doubted() {
    let folder = format!("{}/../../scenarios", env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    assert!(files.len() >= 30, "{files:?}");
    let (place, mut told) = (Place::new(), 0);
    for file in files {
        let checked = place.done(&["check", file.to_str().unwrap(), "-q"]);
        // Two of the papers' dampers do start with an infinite force.
        let is_known =
            |warning: &str| warning.contains("the Riemann-Liouville derivative: its force is infinite at t = 0");
        let warnings = checked.stderr.lines().filter(|line| !line.starts_with("  help: "));
        assert!(warnings.clone().all(is_known), "{}: {}", file.display(), checked.stderr);
        told += warnings.count();
    }
    assert_eq!(told, 2);
}

#[test]
fn a_controller_at_its_limit_all_along_is_told() {
    let text = controlled("kind = \"pid\"\nkp = 60\nlimits = { q1 = \"1 mN*m\" }").replace("\"0.1*sin(t)\"", "-0.1");
    let place = Place::with(&text);
    let ran = place.done(&["run", "arm.toml", "-q", "--no-figures", "--set", "element.damper.rest_length=start"]);
    assert!(ran.said().contains("tau.q1 is at its limit, 0.001 N*m, in every row"), "{}", ran.stderr);
    assert!(ran.said().contains("arm.toml:36:"), "{}", ran.stderr);
    let free = place.done(&[
        "run",
        "arm.toml",
        "-q",
        "--no-figures",
        "--set",
        "element.damper.rest_length=start",
        "--set",
        "motion.controller.limits.q1=100",
    ]);
    assert!(!free.stderr.contains("limit"), "{}", free.stderr);
}

#[test]
fn an_amplitude_beyond_the_element_is_told() {
    let place = Place::new();
    let told = place.done(&["modulus", "arm.toml", "damper", "--amplitude", "2"]);
    assert!(told.said().contains("--amplitude 2 m of element \"damper\": its rest length is 0.5 m"), "{}", told.stderr);
    assert_eq!(place.done(&["modulus", "arm.toml", "damper", "--amplitude", "2 mm"]).stderr, "");
}
