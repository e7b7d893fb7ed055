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
            &["--sensitivity", "element.strut.k", "--set", "solver={ method = \"midpoint\", step = 0.01 }"],
            "the run cannot be differentiated",
        ),
    ] {
        for command in ["check", "run"] {
            let ended = place.springpot(&[&[command, "arm.toml"][..], arguments].concat());
            assert_eq!(ended.code, Some(2), "{command} {arguments:?}: {}", ended.stderr);
            assert!(ended.said().contains(words), "{arguments:?}: {words:?} is not in {}", ended.stderr);
        }
    }
    let kept = ["run", "arm.toml", "--sensitivity", "element.strut.k", "--checkpoint-every", "0.1"];
    let ended = place.springpot(&kept);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.said().contains("a checkpoint keeps no derivatives"), "{}", ended.stderr);
}
