//! Designs, as a user asks for them.

use crate::support::{Place, ended, signal, worked};
use serde_json::Value;
use std::process::Stdio;
use std::time::Instant;

/// A mass on a springpot, thrown.
const THROWN: &str = r#"
robot.gravity = [0, 0, 0]
robot.body = [{ name = "mass", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }]
motion = { kind = "forward", start = { v = { x = 1 } } }
time = { end = 2, output_step = 0.02 }
[[element]]
name = "pad"
joint = "x"
law = "fractional-kelvin-voigt"
parameters = { k = "50 N/m", c = "20 N*s^alpha/m", alpha = 0.5 } # to be designed
[[metric]]
name = "ring"
of = "q.x"
kind = "rms"
[[metric]]
name = "effort"
of = "pad.force"
kind = "rms"
[[parameter]]
name = "c"
path = "element.pad.c"
bounds = [1, "60 N*s^alpha/m"]
"#;

const ORDER: &str = "[[parameter]]\nname = \"order\"\npath = \"element.pad.alpha\"\nbounds = [0.05, 0.9]\n";

fn design(place: &Place, text: &str, more: &[&str]) -> Value {
    place.write("arm.toml", text);
    place.done(&[&["design", "arm.toml", "--no-figures", "--out", "d", "--json"][..], more].concat());
    let found: Value = serde_json::from_str(&place.read("d/design.json")).unwrap();
    assert_eq!(found["status"], "converged");
    for start in found["starts"].as_array().unwrap() {
        assert!(start["runs"].as_u64().unwrap() < 40, "{start}");
        assert_eq!(start["status"], "converged", "{start}");
    }
    found
}

/// A metric of the plain run with these values.
fn metric(place: &Place, name: &str, values: &[(&str, f64)]) -> f64 {
    let set: Vec<String> =
        values.iter().flat_map(|(path, value)| ["--set".to_owned(), format!("{path}={value:?}")]).collect();
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    place.done(&[&["run", "arm.toml", "--quiet", "--no-figures", "--out", "trial"][..], &set].concat());
    let table = place.table("trial/metrics.csv");
    let at = table.texts("metric").iter().position(|own| *own == name).unwrap();
    table.numbers("value")[at]
}

#[test]
fn one_parameter_finds_its_minimum() {
    let place = Place::new();
    let found = design(&place, &format!("{THROWN}[design]\nminimise = \"effort\"\nstarts = 3\n"), &[]);
    let value = found["parameters"][0]["value"].as_f64().unwrap();
    // The vertex of a parabola through plain runs around it.
    let at = |c: f64| metric(&place, "effort", &[("element.pad.c", c)]);
    let step = 0.02 * value;
    let [a, b, c] = [value - step, value, value + step].map(at);
    let vertex = value + 0.5 * step * (a - c) / (a - 2.0 * b + c);
    assert!((value / vertex - 1.0).abs() < 5e-4, "{value} for {vertex}");
    assert!(found["objective"]["after"].as_f64().unwrap() < found["objective"]["before"].as_f64().unwrap());
    assert!((found["objective"]["after"].as_f64().unwrap() / b - 1.0).abs() < 1e-6);
    // The scenario that is written has the value, its comments, and the results beside it.
    let text = place.read("d/designed.toml");
    assert!(text.contains(&format!("c = {value:?}, alpha = 0.5 }} # to be designed")), "{text}");
    assert!((place.table("d/metrics.csv").numbers("value")[1] / b - 1.0).abs() < 1e-8);
    let steps = place.table("d/steps.csv");
    assert_eq!(steps.rows.len() as u64, found["runs"].as_u64().unwrap());
    // Bits do not depend on how many starts go at a time.
    let written = place.read("d/steps.csv");
    design(&place, &format!("{THROWN}[design]\nminimise = \"effort\"\nstarts = 3\n"), &["--jobs", "1"]);
    assert_eq!(written, place.read("d/steps.csv"));
}

#[test]
fn constraints_and_bounds_are_met() {
    let place = Place::new();
    let text = format!(
        "{THROWN}{ORDER}[design]\nminimise = \"ring\"\nconstraints = [{{ metric = \"effort\", max = \"4 N\" }}]\nstarts = 3\n"
    );
    let found = design(&place, &text, &[]);
    let [c, order] = [0, 1].map(|p| found["parameters"][p]["value"].as_f64().unwrap());
    assert_eq!((order, &found["parameters"][1]["at_bound"]), (0.9, &Value::from("upper")));
    let held = &found["constraints"][0];
    assert_eq!(held["active"], true);
    // With the order at its bound c is where the limit is met, which plain runs find as well.
    let effort = |c: f64| metric(&place, "effort", &[("element.pad.c", c), ("element.pad.alpha", 0.9)]) - 4.0;
    let (mut low, mut high) = (0.9 * c, 1.1 * c);
    assert!(effort(low) < 0.0 && effort(high) > 0.0);
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        if effort(middle) < 0.0 { low = middle } else { high = middle }
    }
    assert!((c / (0.5 * (low + high)) - 1.0).abs() < 5e-4, "{c} for {low} … {high}");
    // What the objective falls by for each newton more.
    let multiplier = held["multiplier"].as_f64().unwrap();
    let after = found["objective"]["after"].as_f64().unwrap();
    let wider = design(&place, &text.replace("4 N", "4.04 N"), &[]);
    let gained = (after - wider["objective"]["after"].as_f64().unwrap()) / 0.04;
    assert!((gained / multiplier - 1.0).abs() < 0.05, "{gained} for {multiplier}");
}

#[test]
fn swept_cases_count_by_their_mean_or_the_worst() {
    let place = Place::new();
    let sweep = "[[sweep]]\nparameter = \"robot.body.mass.mass\"\nvalues = [1.5, 3]\n";
    let of = |worst: bool| format!("{THROWN}{sweep}[design]\nminimise = \"effort\"\nworst = {worst}\nstarts = 2\n");
    let [mean, worst] = [false, true].map(|worst| design(&place, &of(worst), &[]));
    let objective = |c: &Value, worst: bool| {
        let c = c["parameters"][0]["value"].as_f64().unwrap();
        place.done(&[
            "run",
            "arm.toml",
            "--quiet",
            "--no-figures",
            "--out",
            "trial",
            "--set",
            &format!("element.pad.c={c:?}"),
        ]);
        let all = place.table("trial/metrics.csv").numbers("value");
        let (one, other) = (all[1], all[3]);
        if worst { one.max(other) } else { 0.5 * (one + other) }
    };
    for (found, by) in [(&mean, false), (&worst, true)] {
        let after = found["objective"]["after"].as_f64().unwrap();
        assert!((objective(found, by) / after - 1.0).abs() < 1e-6);
    }
    assert!(objective(&mean, false) < objective(&worst, false) && objective(&worst, true) < objective(&mean, true));
}

#[test]
fn what_cannot_be_designed_is_refused() {
    let place = Place::with(THROWN);
    place.springpot(&["design", "arm.toml"]).ends(2, &["there is no [design]"]);
    for (tables, words) in [
        ("[design]\nminimise = \"rings\"\n", "which is no metric"),
        ("[design]\n", "minimise"),
        ("[design]\nminimise = \"ring\"\nmaximise = \"effort\"\n", "stands beside `minimise`"),
        ("[design]\nminimise = \"ring\"\nconstraints = [{ metric = \"effort\" }]\n", "max"),
        ("[design]\nminimise = \"ring\"\nconstraints = [{ metric = \"effort\", max = \"4 m\" }]\n", "max"),
        ("[design]\nminimise = \"ring\"\n[[parameter]]\npath = \"element.pad.k\"\n", "has no bounds"),
        (
            "[[metric]]\nname = \"work\"\nof = \"energy.residual\"\nkind = \"final\"\n[design]\nminimise = \"work\"\n",
            "no gradient is known",
        ),
    ] {
        place.write("arm.toml", format!("{THROWN}{tables}"));
        place.springpot(&["design", "arm.toml", "--out", "none"]).ends(2, &[words]);
    }
    assert!(!place.path("none").exists());
    // Limits that cannot hold together are no mistake of the file.
    let far = "[design]\nminimise = \"ring\"\nstarts = 2\nconstraints = [{ metric = \"effort\", max = \"1 mN\" }]\n";
    place.write("arm.toml", format!("{THROWN}{far}"));
    place.springpot(&["design", "arm.toml", "--out", "none"]).ends(1, &["no start leads to a point"]);
    let found: Value = serde_json::from_str(&place.read("none/design.json")).unwrap();
    assert_eq!((&found["status"], found["objective"]["before"].is_f64()), (&"infeasible".into(), true));
    assert!(!place.path("none/designed.toml").exists());
}

#[test]
fn an_order_at_its_end_is_designed_from_where_it_starts() {
    let text = THROWN.replace("alpha = 0.5 }", "alpha = 1 }");
    let from = ORDER.replace("0.9]", "0.9]\nstart = 0.5");
    let goal = "[design]\nminimise = \"effort\"\nstarts = 1\n";
    let place = Place::new();
    let found = design(&place, &format!("{text}{from}{goal}"), &[]);
    let same = design(&place, &format!("{THROWN}{ORDER}{goal}"), &[]);
    assert_eq!((&found["parameters"][1], &found["objective"]), (&same["parameters"][1], &same["objective"]));
    place.write("arm.toml", format!("{text}{}{goal}", ORDER.replace("0.9]", "1]")));
    place.springpot(&["design", "arm.toml"]).ends(2, &["it is 1", "start at 0.01 or 0.99"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_the_best_so_far() {
    let place = Place::with(&format!("{THROWN}{ORDER}[design]\nminimise = \"effort\"\nstarts = 1000\n"));
    let begun = Instant::now();
    let mut command = place.command(&["design", "arm.toml", "--out", "d"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    crate::support::wait_for("work", || worked(&child, begun) > 1.0);
    signal(&child, "-INT");
    let told = ended(child);
    assert_eq!(told.code, Some(130), "{}", told.stderr);
    assert!(told.stderr.contains("interrupted: what was found is the best so far"), "{}", told.stderr);
    let found: Value = serde_json::from_str(&place.read("d/design.json")).unwrap();
    assert_eq!(found["status"], "interrupted");
    let [before, after] = ["before", "after"].map(|key| found["objective"][key].as_f64().unwrap());
    assert!(after < before, "{after} {before}");
    assert!(place.read("d/steps.csv").lines().count() > 5);
    let value = found["parameters"][0]["value"].as_f64().unwrap();
    assert!(place.read("d/designed.toml").contains(&format!("c = {value:?}")));
    // The folder takes results.
    place.done(&["design", "arm.toml", "--out", "d", "--starts", "1", "--no-figures"]);
}
