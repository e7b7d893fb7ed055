//! Derivatives of runs, as a user asks for them.

use crate::support::Place;

const ARM: &str = r#"
[constants]
A = "2 N*m"
[robot]
[[robot.body]]
name = "upper"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 1], damping = 0.1 }
mass = 2
com = [0.25, 0, 0]
inertia = { xx = 0.01, yy = 0.05, zz = 0.05 }
[[robot.body]]
name = "fore"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0.5, 0, 0] }
mass = 1
com = [0.2, 0, 0]
inertia = { xx = 0.01, yy = 0.03, zz = 0.03 }
[[element]]
name = "strut"
from = { body = "upper", point = [0.1, 0, 0.05] }
to = { body = "fore", point = [0.15, 0, 0.05] }
rest_length = "start"
law = "kelvin-voigt"
parameters = { k = "2 kN/m", c = "40 N*s/m" }
[motion]
kind = "forward"
start = { q = { q1 = "20 deg", q2 = "30 deg" } }
torque = { q1 = "A*sin(3*t)" }
[time]
end = 0.2
output_step = 0.05
"#;

const TABLES: &str = r#"
[[parameter]]
name = "k"
path = "element.strut.k"
[sensitivity]
by = ["k", "constants.A"]
of = ["q.*", "strut.force"]
control = false
[[figure]]
name = "by-k"
y = ["d(q.*)/d(k)"]
"#;

/// The columns of the last row of results.csv.
fn last_row(place: &Place, folder: &str) -> Vec<(String, String)> {
    let text = place.read(format!("{folder}/results.csv"));
    let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let names = fields(text.lines().next().unwrap());
    names.into_iter().zip(fields(text.lines().last().unwrap())).collect()
}

#[test]
fn columns_stand_behind_all_others() {
    let place = Place::with(&format!("{ARM}{TABLES}"));
    place.done(&["run", "arm.toml", "--quiet", "--out", "r"]);
    let row = last_row(&place, "r");
    let names: Vec<&str> = row.iter().map(|(name, _)| name.as_str()).collect();
    let told = [
        "d(q.q1)/d(k)",
        "d(q.q1)/d(constants.A)",
        "d(q.q2)/d(k)",
        "d(q.q2)/d(constants.A)",
        "d(strut.force)/d(k)",
        "d(strut.force)/d(constants.A)",
    ];
    assert_eq!(names[names.len() - 6..], told);
    let record = place.record("r");
    let sensitivity = &record["sensitivity"];
    assert_eq!(sensitivity["parameters"][0]["name"], "k");
    assert_eq!(sensitivity["parameters"][0]["value"], 2000.0);
    assert_eq!(sensitivity["columns"][5]["unit"], "N/(N*m)");
    assert_eq!((&sensitivity["method"], &sensitivity["lost"]), (&"forward".into(), &serde_json::json!([])));
    let drawn = place.read("r/figures/by-k.svg");
    assert!(drawn.contains("\u{2202}q\u{2081}/\u{2202}k"), "{drawn}");
    // All else is that of the plain run, to the last bit.
    place.write("arm.toml", ARM);
    place.done(&["run", "arm.toml", "--quiet", "--no-figures", "--out", "plain"]);
    assert_eq!(last_row(&place, "plain"), row[..row.len() - 6]);
}

#[test]
fn the_command_line_asks_without_tables() {
    let place = Place::with(ARM);
    let by = "element.strut.to.point.0,motion.start.q.q2";
    let checked = place.done(&["check", "arm.toml", "--sensitivity", by]);
    assert!(checked.stdout.contains("element.strut.to.point.0 = 0.15 m"), "{}", checked.stdout);
    assert!(checked.stdout.contains("no derivative is known of"), "{}", checked.stdout);
    place.done(&["run", "arm.toml", "--quiet", "--no-figures", "--out", "r", "--sensitivity", by]);
    let row = last_row(&place, "r");
    let value = |name: &str| -> f64 {
        row.iter().find(|(own, _)| own == name).unwrap_or_else(|| panic!("{name}")).1.parse().unwrap()
    };
    // By differences of whole runs.
    for (path, value_now, step, column) in [
        ("element.strut.to.point.0", 0.15, 1e-3, "q.q1"),
        ("motion.start.q.q2", 30f64.to_radians(), 1e-3, "strut.force"),
    ] {
        let at = |steps: f64| -> f64 {
            let set = format!("{path}={:?}", value_now + steps * step);
            place.done(&["run", "arm.toml", "--quiet", "--no-figures", "--out", "moved", "--set", &set]);
            let row = last_row(&place, "moved");
            row.iter().find(|(own, _)| own == column).unwrap().1.parse().unwrap()
        };
        let truth = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
        let found = value(&format!("d({column})/d({path})"));
        assert!((found - truth).abs() < 1e-5 * truth.abs(), "{path}: {found} for {truth}");
    }
}

#[test]
fn what_cannot_be_differentiated_is_refused() {
    let place = Place::with(ARM);
    for (arguments, words) in [
        (&["--sensitivity", "time.end"][..], "time.end cannot be a parameter"),
        (&["--sensitivity", "motion.torque.q1"], "it follows from constants.A"),
        (&["--sensitivity", "element.strut.kk"], "`element.strut` has no `kk`"),
        (&["--sensitivity", "element.strut.k", "--sweep", "element.strut.k=1,2"], "it is swept"),
        (
            &[
                "--sensitivity",
                "element.strut.k",
                "--set",
                "motion.torque.q2={ expression = \"-strut.derivative\", unit = \"N*m\", sample = \"10 ms\" }",
            ],
            "the run cannot be differentiated",
        ),
    ] {
        for command in ["check", "run"] {
            let ended = place.springpot(&[&[command, "arm.toml"][..], arguments].concat());
            assert_eq!(ended.code, Some(2), "{command} {arguments:?}: {}", ended.stderr);
            assert!(ended.said().contains(words), "{arguments:?}: {words:?} is not in {}", ended.stderr);
        }
    }
}

/// A metric of each kind that the arm has, of columns that `of` does not name too.
const METRICS: &str = r#"
[[metric]]
name = "low"
of = "q.q2"
kind = "min"
[[metric]]
name = "peak"
of = "strut.force"
kind = "max"
window = [0.05, 1]
[[metric]]
name = "end"
of = "v.q2"
kind = "final"
[[metric]]
name = "span"
of = "q.q2"
kind = "peak-to-peak"
[[metric]]
name = "mean"
of = "strut.stored"
kind = "mean"
[[metric]]
name = "rms"
of = "strut.rate"
kind = "rms"
[[metric]]
name = "settle"
of = "q.q1"
kind = "settling-time"
band = "8 %"
[[metric]]
name = "past"
of = "q.q2"
kind = "overshoot"
target = 0.5
[[metric]]
name = "ringing"
of = "v.q2"
kind = "frequency"
band = 0.2
[[metric]]
name = "dying"
of = "v.q2"
kind = "log-decrement"
band = 0.2
[[metric]]
name = "rest"
of = "v.q2"
kind = "residual-vibration"
band = 0.2
[[metric]]
name = "work"
of = "energy.residual"
kind = "final"
"#;

#[test]
fn metrics_have_gradients() {
    let place = Place::with(&format!("{ARM}{METRICS}"));
    let by = ["element.strut.k", "constants.A", "robot.body.fore.mass"];
    let quick = [
        "--quiet",
        "--no-figures",
        "--set",
        "time.end=1",
        "--set",
        "time.output_step=0.01",
        "--set",
        "solver.rtol=1e-9",
    ];
    let run = |more: &[&str]| place.done(&[&["run", "arm.toml"][..], &quick, more].concat());
    run(&["--sensitivity", &by.join(","), "--set", "sensitivity.of=q.q1", "--out", "r"]);
    let rows = place.table("r/results.csv").at("d(q.q1)/d(constants.A)");
    assert_eq!(
        place.read("r/results.csv").lines().next().unwrap().split(',').count(),
        rows + 2,
        "what metrics need is not written"
    );
    let table = place.table("r/gradient.csv");
    let header = ["metric", "value", "unit", "parameter", "derivative", "derivative_unit", "elasticity"];
    assert_eq!(place.read("r/gradient.csv").lines().next().unwrap().split(',').collect::<Vec<_>>(), header);
    let (metrics, parameters) = (table.texts("metric"), table.texts("parameter"));
    assert_eq!(table.rows.len(), 12 * 3);
    let (found, values) = (table.numbers("derivative"), table.numbers("value"));
    assert_eq!((table.texts("derivative_unit")[5], table.texts("derivative_unit")[0]), ("N/kg", "rad/(N/m)"));
    let own = [2000.0, 2.0, 1.0];
    for (k, (path, value)) in by.iter().zip(own).enumerate() {
        let at = |steps: f64| {
            run(&["--set", &format!("{path}={:?}", value * (1.0 + 1e-3 * steps)), "--out", "moved"]);
            place.table("moved/metrics.csv").numbers("value")
        };
        let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
        for m in 0..11 {
            let row = 3 * m + k;
            assert_eq!(parameters[row], *path);
            let truth = (8.0 * (a[m] - b[m]) - (c[m] - d[m])) / (12.0 * 1e-3 * value);
            let size = truth.abs() + 1e-2 * values[row].abs() / value;
            assert!((found[row] - truth).abs() < 1e-5 * size, "{} by {path}: {} for {truth}", metrics[row], found[row]);
            let elasticity = table.numbers("elasticity")[row];
            assert!((elasticity - value * found[row] / values[row]).abs() <= 1e-12 * elasticity.abs());
        }
    }
    // No derivative is known of the work of actuators: nothing is made up, and it is said.
    assert!(table.texts("derivative")[33..].iter().all(|cell| cell.is_empty()));
    let checked = place.done(&["check", "arm.toml", "--sensitivity", "element.strut.k"]);
    assert!(checked.stdout.contains("no gradient is known of the metrics work"), "{}", checked.stdout);
}

#[test]
fn ranking_says_what_matters_most() {
    let place = Place::with(&format!("{ARM}{TABLES}"));
    place.done(&["run", "arm.toml", "--quiet", "--no-figures", "--out", "r", "--set", "output.columns=[\"q.q1\"]"]);
    let (rows, table) = (place.table("r/results.csv"), place.table("r/ranking.csv"));
    assert_eq!(table.rows.len(), 6);
    let share = table.numbers("share");
    assert!(share.windows(2).all(|pair| pair[0] >= pair[1]), "{share:?}");
    let rms = |column: &str| {
        let values = rows.numbers(column);
        (values.iter().map(|y| y * y).sum::<f64>() / values.len() as f64).sqrt()
    };
    for (line, (column, parameter)) in table.texts("column").into_iter().zip(table.texts("parameter")).enumerate() {
        let typical = if parameter == "k" { 2000.0 } else { 2.0 };
        let changed = typical * rms(&format!("d({column})/d({parameter})"));
        assert!((table.numbers("rms")[line] / changed - 1.0).abs() < 1e-12);
        // The others are not written; their size counts all the same.
        if column == "q.q1" {
            assert!((share[line] * rms("q.q1") / changed - 1.0).abs() < 1e-12);
        }
        assert!(share[line].is_finite());
    }
}

#[test]
fn parts_and_threads_give_the_same_bytes() {
    let sweep = "[[sweep]]\nparameter = \"element.strut.c\"\nvalues = [40, 60, 90]\n";
    let place = Place::with(&format!("{ARM}{TABLES}{METRICS}{sweep}"));
    place.done(&["run", "arm.toml", "--quiet", "--jobs", "1", "--out", "one"]);
    place.done(&["run", "arm.toml", "--quiet", "--jobs", "3", "--out", "three"]);
    for k in ["1", "2"] {
        place.done(&["run", "arm.toml", "--quiet", "--shard", &format!("{k}/2"), "--out", &format!("part-{k}")]);
    }
    place.done(&["merge", "part-1", "part-2", "--out", "merged", "--quiet"]);
    for name in ["results.csv", "summary.csv", "metrics.csv", "gradient.csv", "ranking.csv", "figures/by-k.svg"] {
        let one = place.read(format!("one/{name}"));
        assert!(one == place.read(format!("three/{name}")) && one == place.read(format!("merged/{name}")), "{name}");
    }
    assert_eq!(place.table("one/gradient.csv").texts("element.strut.c")[35..39], ["60"; 4]);
    assert_eq!(place.record("one")["sensitivity"], place.record("merged")["sensitivity"]);
    // A plain run into the same folder leaves none of them.
    place.done(&[
        "run",
        "arm.toml",
        "--quiet",
        "--no-figures",
        "--out",
        "one",
        "--set",
        "sensitivity=",
        "--set",
        "parameter=",
        "--set",
        "figure=",
    ]);
    assert!(!place.files("one").iter().any(|name| ["gradient.csv", "ranking.csv"].contains(&&**name)));
}

#[test]
fn the_command_says_what_matters_and_checks_it() {
    let place = Place::with(&format!("{ARM}{TABLES}{METRICS}"));
    let said = place.done(&["sensitivity", "arm.toml", "--check", "--no-figures", "--out", "r"]).stdout;
    let ranking = place.table("r/ranking.csv");
    assert!(said.contains(ranking.texts("column")[0]) && said.contains("strut.force  k"), "{said}");
    let steps: u64 = place.record("r")["steps"].as_u64().unwrap();
    // With control = false the steps are those of the plain run.
    assert!(said.contains(&format!("steps    {steps} steps, {steps} without derivatives")), "{said}");
    for parameter in ["k", "constants.A"] {
        assert!(said.contains(&format!("check    {parameter} agrees: ")), "{said}");
    }
    let by = [
        "sensitivity",
        "arm.toml",
        "--by",
        "robot.body.fore.mass,robot.body.upper.joint.friction",
        "--of",
        "q.*,v.q2",
        "--check",
        "--json",
        "--no-figures",
        "--set",
        "sensitivity.control=true",
    ];
    let told: serde_json::Value = serde_json::from_str(&place.done(&by).stdout).unwrap();
    assert_eq!(told["ranking"].as_array().unwrap().len(), 6);
    assert_eq!(told["gradient"].as_array().unwrap().len(), 24);
    // Friction is at 0, an end of its range: differences from one side.
    let check = told["check"].as_array().unwrap();
    assert!(check.iter().all(|one| one["agrees"] == true && one["off"].as_f64().unwrap() < 1e-5), "{check:?}");
    assert_eq!(check[1]["parameter"], "robot.body.upper.joint.friction");
    assert!(check[1]["off"].as_f64().unwrap() > 0.0);

    for (arguments, words) in [
        (&["--by", "element.strut.kk"][..], "has no `kk`"),
        (&["--of", "q.q9"], "matches no column"),
        (&["--by", "time.end"], "time.end cannot be a parameter"),
    ] {
        let ended = place.springpot(&[&["sensitivity", "arm.toml", "--out", "none"][..], arguments].concat());
        ended.ends(2, &[words]);
        assert!(!place.path("none/results.csv").exists());
    }
    place.write("arm.toml", ARM);
    place.springpot(&["sensitivity", "arm.toml"]).ends(2, &["no parameter"]);
}

#[test]
fn a_derivative_that_differs_is_an_error() {
    // At rest no step is refused for the sake of the run: by its steps alone derivatives are wrong, whatever the tolerance.
    let rest = r#"
robot = { gravity = [0, 0, 0], body = [{ name = "mass", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }] }
motion = { kind = "forward" }
time = { end = 2, output_step = 0.05 }
element = [{ name = "pad", joint = "x", law = "fractional-kelvin-voigt", parameters = { k = 50, c = 50, alpha = 0.5 } }]
"#;
    let place = Place::with(rest);
    let asked = ["sensitivity", "arm.toml", "--by", "motion.start.v.x", "--of", "q.*", "--check"];
    let said = place.done(&asked).stdout;
    assert!(said.contains("motion.start.v.x agrees: "), "{said}");
    let ended = place.springpot(&[&asked[..], &["--set", "sensitivity.control=false"]].concat());
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("motion.start.v.x DIFFERS: "), "{}", ended.stdout);
}

#[test]
fn gradients_back_through_the_run_are_those_beside_it() {
    let place = Place::with(&format!("{ARM}{METRICS}"));
    let by = "element.strut.k,constants.A,robot.body.fore.mass,element.strut.to.point.0,motion.start.q.q2";
    let quick = ["--quiet", "--no-figures", "--set", "time.end=1", "--set", "time.output_step=0.01"];
    let run = |more: &[&str]| place.done(&[&["run", "arm.toml"][..], &quick, more].concat());
    let differentiated = ["--sensitivity", by, "--set", "sensitivity.control=false"];
    run(&["--out", "plain"]);
    run(&[&differentiated[..], &["--out", "forward"]].concat());
    run(&[&differentiated[..], &["--set", "sensitivity.method=\"adjoint\"", "--out", "adjoint"]].concat());
    for file in ["results.csv", "metrics.csv", "summary.csv"] {
        assert_eq!(place.read(format!("adjoint/{file}")), place.read(format!("plain/{file}")), "{file}");
    }
    assert_eq!(place.record("adjoint")["sensitivity"]["method"], "adjoint");
    assert_eq!(place.read("adjoint/ranking.csv").lines().count(), 1);
    let [forward, adjoint] = ["forward", "adjoint"].map(|folder| place.table(format!("{folder}/gradient.csv")));
    assert_eq!(adjoint.texts("parameter"), forward.texts("parameter"));
    let (found, truth) = (adjoint.numbers("derivative"), forward.numbers("derivative"));
    assert_eq!(found.len(), 12 * 5);
    for ((found, truth), metric) in found.iter().zip(&truth).zip(adjoint.texts("metric")) {
        let agrees = (found - truth).abs() <= 1e-10 * truth.abs() || found.is_nan() && truth.is_nan();
        assert!(agrees, "{metric}: {found} for {truth}");
    }
    assert!(truth.iter().filter(|truth| truth.is_finite() && **truth != 0.0).count() > 40);
    let checked = ["sensitivity", "arm.toml", "--by", by, "--check", "--set", "sensitivity.method=\"adjoint\""];
    place.springpot(&checked).ends(2, &["--check compares columns", "method = \"forward\""]);
}

/// A torque that switches at t = 0, where one way is another than the other: both methods say so, of the parameter that moves it alone.
#[test]
fn what_ends_is_said_by_both_methods() {
    let text = r#"
constants.t_s = 0
robot = { gravity = [0, 0, 0], body = [{ name = "mass", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }] }
motion = { kind = "forward", torque = { x = "4*step(t - t_s)" } }
time = { end = 1, output_step = 0.05 }
element = [{ name = "pad", joint = "x", law = "fractional-kelvin-voigt", parameters = { k = 50, c = 50, alpha = 0.5 } }]
metric = [{ name = "swing", of = "q.x", kind = "rms" }]
sensitivity = { by = ["constants.t_s", "element.pad.k"], control = false }
"#;
    let place = Place::with(text);
    let run = |method: &str| {
        let method = format!("sensitivity.method=\"{method}\"");
        let told = place.springpot(&["run", "arm.toml", "--out", "r", "--no-figures", "--set", &method]);
        assert_eq!(told.code, Some(0), "{told:?}");
        assert!(told.stderr.contains("derivatives by constants.t_s end at t = 0 s: "), "{}", told.stderr);
        assert!(!told.stderr.contains("element.pad.k"), "{}", told.stderr);
        (place.record("r")["sensitivity"]["lost"].clone(), place.table("r/gradient.csv").numbers("derivative"))
    };
    let ((forward, truth), (adjoint, found)) = (run("forward"), run("adjoint"));
    assert_eq!(adjoint, forward);
    assert_eq!(adjoint[0]["parameter"], "constants.t_s");
    assert!(truth[0].is_nan() && found[0].is_nan() && (found[1] / truth[1] - 1.0).abs() < 1e-10);
}
