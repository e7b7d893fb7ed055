//! `springpot check`: what it prints, and what it warns of.

use crate::support::{ARM, Place};

#[test]
fn check_prints_the_plan_and_every_element_at_its_start() {
    let place = Place::new();
    let ended = place.done(&["check", "arm.toml", "--set", "motion.joints.x=0.03"]);
    assert_eq!(ended.stderr, "");
    assert_eq!(
        ended.stdout,
        "\
title     Damped arm
robot     2 bodies; 2 joints: q1, x
motion    prescribed, 0 to 0.35 s
rows      5, every 0.1 s
accuracy  rtol 1e-9, memory_rtol 1e-11
element   damper: magnetorheological, caputo
          F = E_c·x + (mu_0 + u·mu)·D^alpha x
          E_c = 20 N/m, mu_0 = 10 N*s^alpha/m, mu = 4 N*s^alpha/(m*V),
          alpha = 0.5, u = 1 + 0.5*sin(20*t)
          l(0) = 0.500899 m, l0 = 0.5 m
          x(0) = 8.99191e-4 m
          dl/dq = q1: -0.0299461, x: 0.0598923
"
    );
    assert!(!place.path("results").exists(), "check writes nothing");
}

#[test]
fn the_printed_start_is_the_first_row() {
    let place = Place::new();
    let arguments = ["--set", "motion.joints.x=0.03", "--set", "element.damper.alpha=0"];
    place.done(&[&["run", "arm.toml"], &arguments[..]].concat());
    let results = place.table("results/arm/results.csv");
    assert!((results.numbers("damper.length")[0] - 0.500899).abs() < 5e-7);
    assert!((results.numbers("damper.stroke")[0] - 0.000899191).abs() < 5e-10);
    // Q_b = −F·∂l/∂q_b.
    let force = results.numbers("damper.force")[0];
    for (joint, gradient) in [("q1", -0.0299461), ("x", 0.0598923)] {
        let expected: f64 = -force * gradient;
        assert!((results.numbers(&format!("damper.Q.{joint}"))[0] / expected - 1.0).abs() < 1e-5);
    }
}

#[test]
fn large_strokes_and_singular_starts_are_warned_of() {
    let place = Place::new();
    let warnings = |arguments: &[&str]| place.done(&[&["check", "arm.toml"], arguments].concat()).stderr;
    // l(0) is 0.5 m: 20 % of the rest length are exceeded below 0.41667 m and above 0.625 m.
    for (rest_length, expected) in [("0.42", ""), ("0.62", ""), ("0.41", "0.09 m"), ("0.63", "-0.13 m")] {
        let said = warnings(&["--set", &format!("element.damper.rest_length={rest_length}")]);
        assert_eq!(said.is_empty(), expected.is_empty(), "{rest_length}: {said}");
        if !expected.is_empty() {
            let line = format!(
                "warning: element \"damper\" starts with a stroke of {expected}, more than 20 % of its rest length {rest_length} m\n"
            );
            assert!(said.starts_with(&line), "{said}");
        }
    }
    let singular = "warning: element \"damper\" starts with x(0) = 0.01 m and the Riemann-Liouville derivative: its \
                    force is infinite at t = 0 and its energy is not known\n";
    let rl = ["--set", "element.damper.derivative=riemann-liouville"];
    let off = ["--set", "element.damper.rest_length=0.49"];
    assert_eq!(warnings(&rl), "");
    assert_eq!(warnings(&off), "");
    assert!(warnings(&[rl, off].concat()).starts_with(singular));
    for alpha in ["0", "1"] {
        let whole = format!("element.damper.alpha={alpha}");
        assert_eq!(warnings(&[&rl[..], &off, &["--set", &whole]].concat()), "");
    }
}

#[test]
fn warnings_cover_every_swept_value() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [1, 0.5, 0.7]\n\
                 [[sweep]]\nparameter = \"element.damper.rest_length\"\nvalues = [0.5, 0.6, 0.7]\n";
    let text = ARM.replace("[motion]", "derivative = \"riemann-liouville\"\n\n[motion]");
    let place = Place::with(&format!("{text}{sweep}"));
    let ended = place.done(&["check", "arm.toml"]);
    let warnings: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    let large = "warning: element.damper.alpha = 1, element.damper.rest_length = 0.7: element \"damper\" starts with a \
                 stroke of -0.2 m, more than 20 % of its rest length 0.7 m";
    assert_eq!(warnings, [large]);
    for line in [
        "cases     9\n          element.damper.alpha = 1, 0.5, 0.7\n          element.damper.rest_length = 0.5, 0.6, 0.7\n",
        "          x(0) = 0 m (-0.2 to 0 m over the cases)\n",
    ] {
        assert!(ended.stdout.contains(line), "{}", ended.stdout);
    }

    let starts = "[[sweep]]\nparameter = \"element.damper.rest_length\"\nvalues = [0.5, 0.48, 0.49, 0.51]\n";
    place.write("starts.toml", format!("{text}{starts}"));
    let ended = place.done(&["check", "starts.toml"]);
    let singular =
        "warning: element.damper.rest_length = 0.48 and 2 other cases: element \"damper\" starts with x(0) = 0.02 m";
    assert!(ended.stderr.starts_with(singular), "{}", ended.stderr);
    assert_eq!(ended.stderr.matches("warning: ").count(), 1);
}

#[test]
fn long_sweeps_are_looked_at_in_part() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.mu\"\nvalues = { from = 1, to = 2, count = 1000000 }\n";
    let place = Place::with(&format!("{ARM}{sweep}"));
    let ended = place.done(&["check", "arm.toml"]);
    let line = "element.damper.mu = 1, 1.000001000001, 1.000002000002, …, 2 (1000000\n          values)\n";
    assert!(ended.stdout.contains(line), "{}", ended.stdout);
}

#[test]
fn what_cannot_start_is_an_error() {
    let place =
        Place::with(&ARM.replace("point = [0, 0.3, 0]", "point = [0, 0.3, 0.5]").replace("0.05 - 0.05*cos(6*t)", "t"));
    let ended = place.springpot(&["check", "arm.toml"]);
    assert_eq!(ended.code, Some(1));
    assert!(
        ended.stderr.starts_with("error: arm.toml:22:8: t = 0 s: element \"damper\" has no direction"),
        "{}",
        ended.stderr
    );
    assert!(ended.stdout.contains("element   damper"), "{}", ended.stdout);
}
