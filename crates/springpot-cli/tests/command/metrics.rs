//! Metrics, as a user meets them: metrics.csv, the terminal, `springpot metrics`, figures, refusals.

use crate::support::{ARM, Place};
use std::fs;

/// A mass on a spring and a damper: x'' + 2ζω x' + ω²(x − 0.1) = 0 from x = 0 and rest.
const SWING: &str = r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "mass"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 2
[[element]]
name = "pad"
joint = "x"
law = "kelvin-voigt"
parameters = { k = 200, c = 4 }
[motion]
kind = "forward"
torque = { x = "20 N" }
[time]
end = "6 s"
output_step = "1 ms"
[[metric]]
name = "settle"
of = "q.x"
kind = "settling-time"
band = "2 %"
target = "10 cm"
[[metric]]
name = "overshoot"
of = "q.x"
kind = "overshoot"
target = 0.1
[[metric]]
name = "frequency"
of = "q.x"
kind = "frequency"
[[metric]]
name = "decrement"
of = "q.x"
kind = "log-decrement"
[[metric]]
name = "ringing"
of = "q.x"
kind = "residual-vibration"
window = [2, "6 s"]
band = "0.1 mm"
[[metric]]
name = "energy"
of = "energy.actuators"
kind = "final"
[[metric]]
name = "never"
of = "q.x"
kind = "settling-time"
band = "1 mm"
target = "2 m"
"#;

/// ω, ζ and ω_d of it.
fn rates() -> (f64, f64, f64) {
    let (omega, zeta) = (10.0, 4.0 / (2.0 * 2.0 * 10.0));
    (omega, zeta, omega * f64::sqrt(1.0 - zeta * zeta))
}

#[test]
fn an_oscillator_has_the_metrics_of_its_closed_form() {
    let place = Place::with(SWING);
    let ended = place.done(&["run", "arm.toml", "--out", "o"]);
    assert!(ended.stdout.contains("results.csv, metrics.csv, summary.csv, run.json"), "{}", ended.stdout);
    assert!(ended.stdout.contains("\nmetrics  settle     "), "{}", ended.stdout);
    assert!(ended.stdout.contains("\n         frequency  1.58") && ended.stdout.contains(" Hz\n"), "{}", ended.stdout);
    assert!(ended.stdout.contains("\n         never      none\n"), "{}", ended.stdout);
    assert_eq!(place.files("o"), ["metrics.csv", "results.csv", "run.json", "summary.csv"]);
    let table = place.table("o/metrics.csv");
    assert_eq!(table.header, ["metric", "column", "value", "unit"]);
    assert_eq!(table.texts("unit"), ["s", "", "Hz", "", "m", "J", "s"]);
    assert_eq!(table.texts("column")[4..6], ["q.x", "energy.actuators"]);
    let values = table.numbers("value");
    let (omega, zeta, damped) = rates();
    let near =
        |value: f64, wanted: f64, rtol: f64| assert!((value / wanted - 1.0).abs() < rtol, "{value} for {wanted}");
    near(values[1], (-std::f64::consts::PI * zeta / f64::sqrt(1.0 - zeta * zeta)).exp(), 1e-6);
    near(values[2], damped / std::f64::consts::TAU, 1e-5);
    near(values[3], std::f64::consts::TAU * zeta * omega / damped, 1e-4);
    // The torque's work is 20 N times the way, which has come to rest but for e^−6.
    near(values[5], 2.0, 5e-3);
    assert!(values[6].is_nan());
    // The last time at which the envelope's swing leaves 2 %: looked for in the closed form itself.
    let x = |t: f64| {
        let decay = (-zeta * omega * t).exp();
        1.0 - decay * ((damped * t).cos() + zeta * omega / damped * (damped * t).sin())
    };
    let outside = (0..600_000).map(|k| f64::from(k) * 1e-5).filter(|t| (x(*t) - 1.0).abs() > 0.02);
    near(values[0], outside.fold(0.0, f64::max), 1e-5);
    let record = place.record("o");
    assert_eq!(record["plan"]["metrics"][4]["window"], serde_json::json!([2.0, 6.0]));
    assert_eq!(record["plan"]["metrics"][0]["band"], serde_json::json!({ "share": 0.02 }));
}

/// A sweep of everything about a metric, and of the law.
const SWEEP: &str = r#"
[[metric]]
name = "peak"
of = "damper.force"
kind = "peak-to-peak"
[[metric]]
name = "part"
of = "q.q1"
kind = "rms"
window = ["50 ms", "0.2 s"]
[[metric]]
name = "settle"
of = "v.x"
kind = "settling-time"
band = "5 %"
target = 0
[[sweep]]
parameter = "element.damper.mu"
values = [1, 5]
[[sweep]]
parameter = ["metric.part.window.0", "metric.settle.band"]
values = [["0 s", "2 %"], ["100 ms", 0.01]]
[output]
columns = ["t", "q.*", "v.*", "damper.force"]
"#;

#[test]
fn later_is_the_same_in_every_format() {
    let place = Place::with(&format!("{ARM}{SWEEP}"));
    let step = ["--set", "time.output_step=1 ms"];
    let mut texts = Vec::new();
    for format in ["csv", "parquet", "npz"] {
        place.done(&[&["run", "arm.toml", "--out", format, "--format", format], &step[..]].concat());
        let name = format!("{format}/metrics.csv");
        let text = place.read(&name);
        assert_eq!(place.done(&["metrics", format]).stdout, text, "{format}");
        let file = format!("{format}/results.{format}");
        assert_eq!(place.done(&["metrics", &file]).stdout, text, "{file}");
        // Taken away, or changed, it is written again.
        fs::remove_file(place.path(&name)).unwrap();
        assert_eq!(place.done(&["metrics", format]).stdout, text);
        assert_eq!(place.read(&name), text);
        place.write(&name, "metric\n");
        place.done(&["metrics", format, "--out", "m.csv"]);
        assert_eq!((place.read("m.csv"), place.read(&name)), (text.clone(), "metric\n".to_owned()));
        place.done(&["metrics", format]);
        assert_eq!(place.read(&name), text);
        texts.push(text);
        // It is the run's own: the next one replaces it.
        place.done(&[&["run", "arm.toml", "--out", format], &step[..]].concat());
    }
    assert!(texts.iter().all(|text| *text == texts[0]));
    let table = place.table("csv/metrics.csv");
    assert_eq!(table.header[..4], ["element.damper.mu", "metric.part.window.0", "metric.settle.band", "metric"]);
    assert_eq!(table.rows.len(), 12);
    assert_eq!(table.texts("unit")[..3], ["N", "rad", "s"]);
    // The mean square of 0.3 sin 4t from a to 0.2.
    let rms = |a: f64| {
        let whole = |t: f64| 0.09 * (t / 2.0 - (8.0 * t).sin() / 16.0);
        ((whole(0.2) - whole(a)) / (0.2 - a)).sqrt()
    };
    let values = table.numbers("value");
    assert!((values[1] / rms(0.0) - 1.0).abs() < 1e-4 && (values[4] / rms(0.1) - 1.0).abs() < 1e-4, "{values:?}");
    assert!(values[0] != values[6] && values[1] == values[7]);
}

#[test]
fn other_metrics_are_asked_for_on_the_command_line() {
    let place = Place::with(&format!("{ARM}{SWEEP}"));
    place.done(&["run", "arm.toml", "--out", "o", "--set", "time.output_step=1 ms"]);
    let ended = place.done(&[
        "metrics",
        "o",
        "--metric",
        "peak-to-peak(damper.force)",
        "--metric",
        "late = rms(q.q1), window = [\"100 ms\", 0.2]",
    ]);
    let table = crate::support::Csv::new(&ended.stdout);
    assert_eq!(table.texts("metric")[..2], ["peak-to-peak(damper.force)", "late"]);
    let own = place.table("o/metrics.csv");
    assert_eq!(table.texts("value")[0], own.texts("value")[0]);
    // Of the second case the run's own window is the same.
    assert_eq!(table.texts("value")[3], own.texts("value")[4]);
    for (metric, said, at) in [
        ("rms(damper.forse)", "did you mean `damper.force`?", "--metric:1:5"),
        ("rmse(q.q1)", "did you mean `rms`?", "--metric:1:1"),
        ("rms q.q1", "there is no parenthesis", "--metric:1:1"),
        ("rms(q.q1", "the parenthesis is never closed", "--metric:1:1"),
        ("rms(q.q1) 5", "there is something behind the parenthesis", "--metric:1:1"),
        ("rms(q.q1), window", "KEY = VALUE", "--metric:1:1"),
        ("rms(q.q1), window = [2, 1]", "write the earlier time first", "--metric:1:21"),
        ("rms(q.q1), windows = [1, 2]", "did you mean `window`?", "--metric:1:12"),
        ("overshoot(q.q1), band = \"1 mm\"", "rad", "--metric:1:28"),
        ("my rms = rms(q.q1)", "which is not a name", "--metric:1:1"),
        // What is shown is what was written, and what else a metric has stands in front.
        ("rms(q.q1), window = [3, 2]", "rms(q.q1), window = [3, 2]\n", "--metric:1:21"),
        ("rms(q.q1), of = \"v.x\"", "there is window, band, target and levels", "--metric:1:12"),
        (
            "rms(q.q1), window = [100, 200]",
            "the rows go from 0 s to 0.35 s; choose a window that holds some",
            "100 s to 200 s",
        ),
    ] {
        let ended = place.springpot(&["metrics", "o", "--metric", metric]);
        assert_eq!(ended.code, Some(2), "{metric}: {}", ended.stderr);
        assert!(ended.stderr.contains(said) && ended.stderr.contains(at), "{metric}: {}", ended.stderr);
        assert!(ended.stdout.is_empty());
    }
    let twice = place.springpot(&["metrics", "o", "--metric", "a = max(t)", "--metric", "a = min(t)"]);
    assert!(twice.code == Some(2) && twice.stderr.contains("the name \"a\" is taken"), "{}", twice.stderr);
}

#[test]
fn what_is_not_there_is_said() {
    let place = Place::with(&format!(
        "{ARM}[output]\ncolumns = [\"t\", \"q.*\"]\n[[metric]]\nname = \"f\"\nof = \"damper.force\"\nkind = \"max\"\n"
    ));
    // The run has what its file leaves out.
    place.done(&["run", "arm.toml", "--out", "o"]);
    assert!(place.table("o/metrics.csv").numbers("value")[0].is_finite());
    let refused = |arguments: &[&str], said: &str| {
        let ended = place.springpot(arguments);
        assert!(ended.code == Some(2) && ended.stderr.contains(said), "{arguments:?}: {}", ended.stderr);
    };
    refused(&["metrics", "o"], "metric \"f\" is of damper.force, which is not among the columns of o/results.csv");
    refused(&["metrics", "nothing"], "error: nothing: there is no such file or folder");
    fs::create_dir(place.path("bare")).unwrap();
    refused(&["metrics", "bare"], "error: bare has no run.json");
    refused(&["metrics", "arm.toml"], "no run.json stands beside arm.toml");
    place.write("plain.toml", ARM);
    place.done(&["run", "plain.toml", "--out", "p"]);
    assert!(!place.files("p").contains(&"metrics.csv".to_owned()));
    refused(&["metrics", "p"], "the run in p has no metrics");
    fs::remove_file(place.path("p/results.csv")).unwrap();
    refused(&["metrics", "p", "--metric", "max(t)"], "p/results.csv");
    // Somebody's own file is not replaced.
    fs::create_dir(place.path("mine")).unwrap();
    place.write("mine/metrics.csv", "mine\n");
    refused(&["run", "arm.toml", "--out", "mine"], "metrics.csv was not written by a run");
    assert_eq!(place.read("mine/metrics.csv"), "mine\n");
}

#[test]
fn cases_without_rows_have_no_lines_and_failed_ones_those_of_their_rows() {
    let text = format!("{ARM}{SWEEP}[[sweep]]\nparameter = \"element.damper.u\"\nvalues = [1, \"1 - 20*t\", -5]\n");
    let place = Place::with(&text);
    let ended = place.springpot(&["run", "arm.toml", "--out", "o", "--set", "time.output_step=1 ms"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let table = place.table("o/metrics.csv");
    // Where mu = 5, mu_0 + u mu becomes negative on the way, or is from the start.
    let failed =
        place.record("o")["cases"].as_array().unwrap().iter().filter(|case| case["status"] == "failed").count();
    assert_eq!(failed, 4);
    assert_eq!(table.rows.len(), 30);
    assert_eq!(place.done(&["metrics", "o"]).stdout, place.read("o/metrics.csv"));
}

#[test]
fn a_summary_draws_metrics() {
    let text = format!(
        "{ARM}{SWEEP}[[figure]]\nname = \"m\"\nkind = \"summary\"\nx = \"element.damper.mu\"\ny = [\"metric(peak)\", \"metric(settle)\"]\nunits = {{ \"metric(settle)\" = \"ms\" }}\n"
    );
    let place = Place::with(&text);
    place.done(&["run", "arm.toml", "--out", "o", "--set", "time.output_step=1 ms"]);
    let drawn = place.read("o/figures/m.svg");
    assert!(drawn.contains("peak") && drawn.contains("settle") && drawn.contains("ms"), "{drawn}");
    let y = &place.record("o")["plan"]["figures"][0]["y"];
    assert_eq!(*y, serde_json::json!(["metric(peak)", "metric(settle)"]));
    place.write("arm.toml", text.replace("metric(peak)", "metric(peek)"));
    let ended = place.springpot(&["check", "arm.toml"]);
    assert!(ended.code == Some(2) && ended.stderr.contains("did you mean `peak`?"), "{}", ended.stderr);
}

#[test]
fn mistakes_are_refused_with_their_place() {
    let metric = |rest: &str| format!("{ARM}[[metric]]\nname = \"m\"\n{rest}\n");
    for (rest, said, line) in [
        ("of = \"damper.forse\"\nkind = \"max\"", "did you mean `damper.force`?", "38:6"),
        ("of = \"q.q1\"\nkind = \"settlingtime\"", "did you mean `settling-time`?", "39:8"),
        ("kind = \"max\"", "has no `of`", "36:1"),
        ("of = \"q.q1\"", "has no `kind`", "36:1"),
        ("of = \"q.q1\"\nkind = \"max\"\nband = \"1 deg\"", "has no meaning where kind = \"max\"", "40:8"),
        ("of = \"q.q1\"\nkind = \"mean\"\ntarget = 1", "has no meaning where kind = \"mean\"", "40:10"),
        ("of = \"q.q1\"\nkind = \"frequency\"\ntarget = 1", "the band is not in %", "40:10"),
        ("of = \"q.q1\"\nkind = \"overshoot\"\nband = \"1 mm\"", "rad", "40:11"),
        ("of = \"q.q1\"\nkind = \"overshoot\"\nband = \"-1 %\"", "must be positive", "40:8"),
        ("of = \"q.q1\"\nkind = \"overshoot\"\nband = 0", "must be positive", "40:8"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindow = [0.2, 0.1]", "write the earlier time first", "40:10"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindow = [0.2, 0.2]", "no stretch of time", "40:10"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindow = [1, 2]", "where there is no row", "40:10"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindow = [0.11, 0.19]", "where there is no row", "40:10"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindow = [1]", "two times", "40:10"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindow = [\"1 m\", 2]", "write", "40:14"),
        ("of = \"q.q1\"\nkind = \"max\"\nwindows = [0, 1]", "did you mean `window`?", "40:1"),
        (
            "of = \"q.q1\"\nkind = \"max\"\n[[metric]]\nname = \"m\"\nof = \"t\"\nkind = \"max\"",
            "taken on line 37",
            "41:8",
        ),
        ("of = \"energy.joints\"\nkind = \"max\"", "this run has no column \"energy.joints\"", "38:6"),
    ] {
        let place = Place::with(&metric(rest));
        for command in ["check", "run"] {
            let ended = place.springpot(&[command, "arm.toml"]);
            assert_eq!(ended.code, Some(2), "{rest}: {}", ended.stderr);
            assert!(
                ended.stderr.contains(said) && ended.stderr.contains(&format!("arm.toml:{line}")),
                "{rest}: {}",
                ended.stderr
            );
        }
    }
    let place = Place::with(&metric("of = \"q.q1\"\nkind = \"max\""));
    for (path, said) in [
        ("metric.m.name=a,b", "cannot be swept"),
        ("metric.m.kind=max,rms", "has other metrics"),
        ("metric.n.of=t", "m"),
    ] {
        let ended = place.springpot(&["check", "arm.toml", "--sweep", path]);
        assert!(ended.code == Some(2) && ended.stderr.contains(said), "{path}: {}", ended.stderr);
    }
    place.done(&["check", "arm.toml", "--set", "metric.m.window=[\"0 s\", \"100 ms\"]"]);
}
