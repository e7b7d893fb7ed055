//! Sweeps of the command line: how they are written, what is said of them, and what takes them out again.

use crate::support::{ARM, Place};

const FORM: &str = "PATH=FROM:TO:COUNT[:log]";

/// What was said, its lines joined.
#[track_caller]
fn refused(place: &Place, arguments: &[&str], words: &[&str]) {
    let ended = place.springpot(&[&["check", "arm.toml"][..], arguments].concat());
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}: {}", ended.stderr);
    for words in words {
        assert!(ended.said().contains(words), "{arguments:?}: {words:?} is not in {}", ended.stderr);
    }
}

#[test]
fn every_refusal_of_a_sweep_says_how_one_is_written() {
    let place = Place::new();
    for (sweep, words) in [
        ("element.damper.alpha=0.1:0.9", "0.1:0.9 has two ends and no count"),
        ("element.damper.alpha=0.1:0.9:0.1", "0.1"),
        ("element.damper.alpha=0.1:0.9:2.5", "must be a whole number, not the number 2.5"),
        ("element.damper.alpha=0.1:0.9:1", "is 1, outside 2"),
        ("element.damper.alpha=0.1:0.9:0", "is 0, outside 2"),
        ("element.damper.alpha=0.1:0.9:-3", "is -3, outside 2"),
        ("element.damper.alpha=0.1:0.9:", "0.1:0.9: lacks a number"),
        ("element.damper.alpha=0.1::3", "0.1::3 lacks a number"),
        ("element.damper.alpha=0.1:0.9:3:lin", "is \"lin\", which is no scale"),
        ("element.damper.alpha=0.1:0.9:3:log:2", "has 5 parts"),
        ("element.damper.alpha=0.1..0.9", "colons stand between its ends"),
        ("element.damper.alpha=0:0.9:3:log", "has no logarithmic scale"),
        ("element.damper.alpha=", "has no value"),
        ("element.damper.alpha", "has no `=`"),
        ("element.damper.alpha=0.2,,0.3", "a value of --sweep is empty"),
        ("element.damper.alpha=0.2,1.5", "is 1.5"),
        ("element.damper.alhpa=0.2,0.5", "did you mean `alpha`?"),
        ("element.dumper.alpha=0.2,0.5", "did you mean `damper`?"),
        ("damper.alpha=0.2,0.5", "did you mean element.damper.alpha?"),
        ("alpha=0.2,0.5", "did you mean element.damper.alpha?"),
        ("title=a,b", "which cannot be swept"),
        ("constants.f=1,2", "there is no constant `f`"),
    ] {
        refused(&place, &["--sweep", sweep], &[words, FORM]);
    }
}

#[test]
fn a_constant_that_is_swept_must_be_there() {
    let place =
        Place::with(&ARM.replace("[robot.gripper]", "[constants]\nfreq = \"2 Hz\"\nA = \"5 mm\"\n\n[robot.gripper]"));
    refused(&place, &["--sweep", "constants.frq=1 Hz,2 Hz"], &["there is no constant `frq`", "did you mean `freq`?"]);
    let text = place.read("arm.toml");
    place.write("arm.toml", format!("{text}\n[[sweep]]\nparameter = \"constants.B\"\nvalues = [1, 2]\n"));
    refused(&place, &[], &["arm.toml:", "there is no constant `B`", "freq and A"]);
    place.write("arm.toml", text);
    // Swept constants have the unit of their values.
    let sweeps = ["--sweep", "constants.freq=1 Hz,2 Hz", "--sweep", "constants.A=1 mm,0.002 m"];
    place.done(&[&["run", "arm.toml", "--quiet", "--no-figures", "--out", "r"][..], &sweeps].concat());
    let record = place.record("r");
    let units: Vec<&str> = (0..2).map(|k| record["columns"][k]["unit"].as_str().unwrap()).collect();
    assert_eq!(units, ["Hz", "m"]);
    let mut values = place.table("r/results.csv").numbers("constants.A");
    values.dedup();
    assert_eq!(values, [0.001, 0.002, 0.001, 0.002]);
}

#[test]
fn three_numbers_that_may_be_from_step_and_end_are_told() {
    let place = Place::new();
    let warned = |sweep: &str| {
        let ended = place.done(&["check", "arm.toml", "--quiet", "--sweep", sweep]);
        ended.said().contains("FROM:TO:COUNT").then(|| ended.said())
    };
    let told = warned("element.damper.mu_0=30:10:60").expect("a warning");
    assert!(told.contains("is 60 values from 30 to 10: 30, 29.6610169491525, "), "{told}");
    assert!(
        told.contains(", …, 10") && told.contains("for 30, 40, 50, 60 write element.damper.mu_0=30:60:4"),
        "{told}"
    );
    for sweep in ["0:1:5", "1:2:9", "60:5:80", "0:5:10"] {
        let is_told = warned(&format!("element.damper.mu_0={sweep}"));
        // 0:1:5 would be six values of the five asked for.
        assert_eq!(is_told.is_some(), sweep != "0:1:5", "{sweep}: {is_told:?}");
    }
    for sweep in ["1:100:5", "1:100:5:log", "30.0:10:60", "0.1:0.9:9", "10:20:3", "0:0:3"] {
        if sweep == "0:0:3" {
            continue;
        }
        assert_eq!(warned(&format!("element.damper.mu_0={sweep}")), None, "{sweep}");
    }
}

#[test]
fn values_are_printed_before_a_run_and_equal_ones_are_told() {
    let place = Place::new();
    let ended = place.done(&["run", "arm.toml", "--no-figures", "--sweep", "element.damper.alpha=0.2:0.8:4"]);
    assert!(
        ended.stdout.starts_with("sweep    element.damper.alpha = 0.2, 0.4, 0.6, 0.8\n4 cases, "),
        "{}",
        ended.stdout
    );
    let twice = place.done(&["check", "arm.toml", "-q", "--sweep", "element.damper.rest_length=0.5,40 cm,50 cm"]);
    let told = "the sweep of element.damper.rest_length holds 0.5 and 50 cm, which are the same";
    assert!(twice.said().contains(told), "{}", twice.stderr);
    let once = place.done(&["check", "arm.toml", "-q", "--sweep", "element.damper.rest_length=0.45,46 cm,50 cm"]);
    assert!(!once.stderr.contains("same"), "{}", once.stderr);
}

#[test]
fn an_empty_value_takes_a_key_out() {
    let sweeps = "\n[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.4]\n\n[[sweep]]\nparameter = \"time.end\"\n\
                  values = [0.2, 0.3]\n\n[[figure]]\nname = \"force\"\ny = \"damper.force\"\n\n[[figure]]\nname = \"one\"\n\
                  y = \"damper.force\"\nwhere = { \"element.damper.alpha\" = 0.2 }\n\n[[figure]]\nname = \"sum\"\nkind = \"summary\"\n\
                  x = \"time.end\"\ny = \"max(damper.force)\"\n";
    let place = Place::with(&format!("{ARM}{sweeps}"));
    let all = place.done(&["run", "arm.toml", "--set", "sweep=", "--out", "all"]);
    assert!(all.stdout.contains("\n") && !all.stdout.contains("sweep "), "{}", all.stdout);
    assert!(
        all.said().contains("figures one and sum are not drawn: they speak of values that are no longer swept"),
        "{}",
        all.stderr
    );
    assert_eq!(place.record("all")["cases"].as_array().unwrap().len(), 1);
    assert!(place.files("all").contains(&"figures/force.svg".to_owned()));
    // What is swept anew is spoken of again.
    let anew =
        place.done(&["run", "arm.toml", "--set", "sweep=", "--sweep", "element.damper.alpha=0.2,0.7", "--out", "anew"]);
    assert!(anew.said().contains("figure sum is not drawn") && !anew.said().contains("one"), "{}", anew.stderr);
    // A key, an item by its name, a table.
    let controlled = ARM.replace("kind = \"prescribed\"\njoints = { q1 = \"0.3*sin(4*t)\", x = \"0.05 - 0.05*cos(6*t)\" }", "kind = \"forward\"\n\
        [motion.controller]\nkind = \"pid\"\nkp = 60\nki = 80\nkd = 6\nreference = { kind = \"joints\", q1 = \"0.1*sin(t)\", x = 0 }\n");
    assert_ne!(controlled, ARM);
    place.write("pid.toml", controlled);
    let refused_with = place.springpot(&["check", "pid.toml", "--set", "motion.controller.kind=\"pd-gravity\""]);
    assert!(refused_with.code == Some(2) && refused_with.stderr.contains("`ki`"), "{}", refused_with.stderr);
    place.done(&[
        "check",
        "pid.toml",
        "--set",
        "motion.controller.kind=\"pd-gravity\"",
        "--set",
        "motion.controller.ki=",
    ]);
    place.done(&["check", "pid.toml", "--set", "motion.controller=", "--set", "element.damper=", "--set", "title="]);
    let gone = place.done(&["check", "pid.toml", "--set", "element.damper="]);
    assert!(!gone.stdout.contains("damper"), "{}", gone.stdout);
    for (set, words) in [
        (
            "motion.controller.kj=",
            &["there is no motion.controller.kj to take out", "did you mean motion.controller.k"][..],
        ),
        ("element.strut=", &["no element is named \"strut\"", "there is damper"]),
        ("element.damper.law=", &["has no `law`"]),
        ("element.damper.to.point.1=", &["there is no element.damper.to.point.1 to take out"]),
        ("alpha=0.4", &["the scenario has no `alpha`", "did you mean element.damper.alpha?"]),
        ("rtol=1e-6", &["did you mean solver.rtol?"]),
        ("q1=0.2", &["did you mean "]),
        ("sweep.alpha=3", &["a [[sweep]] has no name"]),
    ] {
        let ended = place.springpot(&["check", "arm.toml", "--set", set]);
        let ended =
            if set.starts_with("motion") { place.springpot(&["check", "pid.toml", "--set", set]) } else { ended };
        assert_eq!(ended.code, Some(2), "{set}: {}", ended.stderr);
        words
            .iter()
            .for_each(|words| assert!(ended.said().contains(words), "{set}: {words:?} is not in {}", ended.stderr));
    }
}
