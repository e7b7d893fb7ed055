//! Events of forward runs, as a user meets them: events.csv, run.json, what the terminal says, refusals.

use crate::support::{ARM, Place};

/// A mass of 2 kg under 4 N: x = t².
const MASS: &str = r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "mass"
joint = { name = "q-1", kind = "prismatic", axis = [1, 0, 0] }
mass = 2
[[element]]
name = "pad"
joint = "q-1"
law = "piezo-kelvin-voigt"
parameters = { E_c = 0, E_pz = 1e-20, E_d = 0, alpha = 0.5, alpha_pz = 1 }
inputs = { U = "0 V" }
[motion]
kind = "forward"
torque = { q-1 = "4 N" }
[time]
end = "2 s"
output_step = "0.5 s"
[[event]]
name = "half"
when = "q.q-1-0.25"
[[event]]
name = "brake"
when = "q.q-1 - x0"
direction = "rising"
action = { set = { "tau.q-1" = "-4 N" } }
[constants]
x0 = "1 m"
"#;

fn near(found: &[f64], wanted: &[f64]) {
    assert_eq!(found.len(), wanted.len(), "{found:?} {wanted:?}");
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-8), "{found:?} {wanted:?}");
}

#[test]
fn events_are_rows_counts_and_a_line() {
    let place = Place::with(MASS);
    let ended = place.done(&["run", "arm.toml", "--out", "o"]);
    assert!(ended.stdout.contains("\nevents   half 1 time, brake 1 time\n"), "{}", ended.stdout);
    assert!(ended.stdout.contains("results.csv, events.csv, summary.csv, run.json"), "{}", ended.stdout);
    assert_eq!(place.files("o"), ["events.csv", "results.csv", "run.json", "summary.csv"]);
    let (events, results) = (place.table("o/events.csv"), place.table("o/results.csv"));
    assert_eq!(events.header[..2], ["event", "t"]);
    assert_eq!(events.header[1..], results.header);
    assert_eq!(events.texts("event"), ["half", "brake"]);
    near(&events.numbers("t"), &[0.5, 1.0]);
    near(&events.numbers("tau.q-1"), &[4.0, 4.0]);
    near(&results.numbers("q.q-1"), &[0.0, 0.25, 1.0, 1.75, 2.0]);
    let record = place.record("o");
    assert_eq!(record["events"], serde_json::json!({ "half": 1, "brake": 1 }));
    assert_eq!(record["cases"][0]["stopped_by"], serde_json::Value::Null);
    assert_eq!(record["plan"]["events"][1]["action"], serde_json::json!({ "set": { "tau.q-1": -4.0 } }));

    // All columns, whatever results.csv holds; CSV, whatever its format.
    place.done(&["run", "arm.toml", "--out", "p", "--format", "parquet", "--set", "output.columns=t"]);
    assert_eq!(place.read("p/events.csv"), place.read("o/events.csv"));
    // The next run has none of them, and takes the file away.
    let without = &MASS[..MASS.find("[[event]]").unwrap()];
    place.write("arm.toml", without);
    place.done(&["run", "arm.toml", "--out", "o"]);
    assert_eq!(place.files("o"), ["results.csv", "run.json", "summary.csv"]);
    place.write("events.csv", "mine");
    place.write("arm.toml", MASS);
    assert_eq!(place.springpot(&["run", "arm.toml", "--out", "."]).code, Some(2));
}

#[test]
fn a_stop_is_a_run_that_is_done() {
    let place = Place::with(MASS);
    let ended = place.done(&["run", "arm.toml", "--out", "o", "--set", "event.brake.action=stop"]);
    assert!(ended.stderr.is_empty(), "{}", ended.stderr);
    assert!(
        ended.stdout.contains("events   half 1 time, brake 1 time; brake ended the run at t = 1 s\n"),
        "{}",
        ended.stdout
    );
    let record = place.record("o");
    assert_eq!((&record["status"], &record["cases"][0]["stopped_by"]), (&"done".into(), &"brake".into()));
    let t = place.table("o/results.csv").numbers("t");
    assert_eq!(record["t_reached"].as_f64(), t.last().copied());
    near(&t, &[0.0, 0.5, 1.0]);
}

#[test]
fn cases_of_a_sweep_have_their_own() {
    let sweep = "[[sweep]]\nparameter = \"constants.x0\"\nvalues = [\"1 m\", \"25 cm\", \"100 m\"]\n\
                 [[sweep]]\nparameter = \"event.brake.action\"\nvalues = [\"stop\", \"record\"]\n";
    let place = Place::with(&format!("{MASS}{sweep}"));
    let ended = place.done(&["run", "arm.toml", "--out", "o", "--jobs", "3"]);
    assert!(ended.stdout.contains("half 6 times, brake 4 times; 2 cases were ended by one"), "{}", ended.stdout);
    let events = place.table("o/events.csv");
    assert_eq!(events.header[..4], ["constants.x0", "event.brake.action", "event", "t"]);
    assert_eq!(events.numbers("constants.x0"), [1.0, 1.0, 1.0, 1.0, 0.25, 0.25, 0.25, 0.25, 100.0, 100.0]);
    let names = events.texts("event");
    assert_eq!(names, ["half", "brake", "half", "brake", "half", "brake", "half", "brake", "half", "half"]);
    let record = place.record("o");
    assert_eq!(record["cases"][5]["events"], serde_json::json!({ "half": 1, "brake": 0 }));
    place.done(&["run", "arm.toml", "--out", "one", "--jobs", "1"]);
    for file in ["events.csv", "results.csv", "summary.csv"] {
        assert_eq!(place.read(format!("one/{file}")), place.read(format!("o/{file}")));
    }
}

#[test]
fn leaves_and_inputs() {
    let leaf = "[[event]]\nname = \"leaf\"\nwhen = \"pad.spring1.force + pad.spring1.stroke - 1\"\n\
                action = { set = { \"pad.U\" = \"-3 V\", \"tau.q-1\" = 0 } }\n";
    let place = Place::with(&format!("{MASS}{leaf}"));
    place.done(&["run", "arm.toml", "--out", "o"]);
    let events = place.table("o/events.csv");
    assert_eq!(events.texts("event"), ["half", "brake", "leaf"]);
    near(&[*place.table("o/results.csv").numbers("pad.U").last().unwrap()], &[-3.0]);
}

#[test]
fn what_is_refused() {
    let place = Place::with(MASS);
    for (set, words) in [
        ("event.brake.when=\"gripper.z - 1\"", "unknown name `gripper.z`"),
        ("event.brake.when=\"v.q-2 - 1\"", "did you mean `v.q-1`"),
        ("event.brake.when=\"1 - x0\"", "is 0 all the time"),
        ("event.brake.when=\"v.q-1 + a.q-1\"", "accelerations jump"),
        ("event.brake.when=\"q.q-1 -\"", "the expression ends where"),
        ("event.brake.when=3", "must be a text"),
        ("event.brake.direction=up", "is \"up\", which is no direction"),
        ("event.brake.action=halt", "is \"halt\", which is no action"),
        ("event.brake.action={ set = {} }", "sets nothing"),
        ("event.brake.action={ put = { \"tau.q-1\" = 1 } }", "unknown key `put`"),
        ("event.brake.action={ set = { \"tau.q-2\" = 1 } }", "did you mean `tau.q-1`"),
        ("event.brake.action={ set = { \"pad.force\" = 1 } }", "is no input of an element and no torque"),
        ("event.brake.action={ set = { pad = { U = 1 } } }", "a column is written in quotes"),
        ("event.brake.action={ set = { \"tau.q-1\" = \"1 N*m\" } }", "this place takes `N`"),
        ("event.brake.action={ set = { \"pad.U\" = \"3 s\" } }", "this place takes `V`"),
        ("event.brake.action={ set = { \"pad.U\" = \"2*t\" } }", "varies with t"),
        ("event.half.name=brake", "taken on line"),
        ("event.half.name=\"a b\"", "is not a name"),
        ("event.half.where=3", "unknown key `where`"),
        ("motion.locked=[\"q-1\"]", "moves joint \"q-1\" in more than one way"),
    ] {
        let refused = place.springpot(&["check", "arm.toml", "--set", set]);
        assert_eq!(refused.code, Some(2), "{set}: {}", refused.stdout);
        assert!(refused.stderr.contains(words), "{set}: {}", refused.stderr);
    }
    let locked = MASS.replace("torque = { q-1 = \"4 N\" }", "locked = [\"q-1\"]");
    place.write("arm.toml", &locked);
    let refused = place.springpot(&["check", "arm.toml"]);
    assert!(refused.stderr.contains("`tau.q-1` of") && refused.code == Some(2), "{}", refused.stderr);

    place.write("arm.toml", format!("{ARM}[[event]]\nname = \"e\"\nwhen = \"q.q1\"\n"));
    let refused = place.springpot(&["check", "arm.toml"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("a motion that is given in advance"), "{}", refused.stderr);
}
