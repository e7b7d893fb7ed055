//! A load that friction holds, as a user meets it.

use crate::support::Place;

/// A load of half the friction, for an hour.
const LOAD: &str = r#"[[robot.body]]
name = "b"
joint = { name = "q", kind = "prismatic", axis = [0, 0, 1], friction = 10 }
mass = 1
[motion]
kind = "forward"
torque = { q = 4.81 }
[time]
end = "1 h"
output_step = "10 min"
"#;

fn last_place(place: &Place, folder: &str) -> f64 {
    let rows = place.read(format!("{folder}/results.csv"));
    rows.lines().last().unwrap().split(',').nth(1).unwrap().parse().unwrap()
}

#[test]
fn a_load_creeps_or_is_held_as_the_file_says() {
    let place = Place::with(LOAD);
    place.done(&["run", "arm.toml", "--out", "smooth"]);
    assert!((last_place(&place, "smooth") + 1.978).abs() < 1e-3);
    let stick = "robot.body.b.joint.friction={ force = \"10 N\", stick = true }";
    place.done(&["run", "arm.toml", "--set", stick, "--out", "held"]);
    assert_eq!(last_place(&place, "held"), 0.0);
    assert!(place.read("held/run.json").contains("\"stick\": true"));

    // One key of a table that stands in the file.
    place.write("arm.toml", LOAD.replace("friction = 10", "friction = { force = 10 }"));
    place.done(&["run", "arm.toml", "--set", "robot.body.b.joint.friction.stick=true", "--out", "set"]);
    assert_eq!(place.read("set/results.csv"), place.read("held/results.csv"));

    let wrong = place.springpot(&["check", "arm.toml", "--set", "robot.body.b.joint.friction={ force = \"10 N*m\" }"]);
    assert_eq!(wrong.code, Some(2), "{}", wrong.stderr);
    assert!(wrong.stderr.contains("`force` of `friction` of the joint of body \"b\""), "{}", wrong.stderr);
    assert!(wrong.stderr.contains("this place takes `N`"), "{}", wrong.stderr);
}
