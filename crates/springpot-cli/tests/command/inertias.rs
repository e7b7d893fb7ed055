//! Inertias that no body has: refused with the cure, taken where they are accepted, and watched while the robot moves.

use crate::support::{Ended, Place};

/// A cross that rolls about x and carries a blade that turns about z, with these moments about its x and z axes; 1 about y.
fn robot(xx: &str, zz: &str) -> String {
    let link = |name: &str, moments: [&str; 3]| {
        let [xx, yy, zz] = moments;
        format!(
            "<link name=\"{name}\">\n<inertial><mass value=\"1\"/>\n\
             <inertia ixx=\"{xx}\" iyy=\"{yy}\" izz=\"{zz}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
        )
    };
    let joint = |name: &str, [parent, child]: [&str; 2], axis: &str| {
        format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <axis xyz=\"{axis}\"/></joint>\n"
        )
    };
    format!(
        "<robot name=\"mixer\">\n<link name=\"stand\"/>\n{}{}{}{}</robot>\n",
        link("cross", ["0.005"; 3]),
        link("blade", [xx, "1", zz]),
        joint("roll", ["stand", "cross"], "1 0 0"),
        joint("spin", ["cross", "blade"], "0 0 1"),
    )
}

/// A place with that robot and a scenario in which it moves from `start` on.
fn place(xx: &str, zz: &str, start: &str) -> Place {
    let place = Place::new();
    place.write("mixer.urdf", robot(xx, zz));
    place.write(
        "mixer.toml",
        format!(
            "[robot]\nurdf = \"mixer.urdf\"\naccept_inertia = true\n[motion]\nkind = \"forward\"\n{start}\n\
             [time]\nend = 3\noutput_step = 0.1\n"
        ),
    );
    place
}

#[track_caller]
fn refused(ended: &Ended, words: &[&str]) {
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    ended.says(words);
}

const HELP: &str = "take it as it is: --accept-inertia, in a scenario accept_inertia = true in [robot]";

#[test]
fn a_broken_triangle_is_refused_with_the_cure_and_can_be_accepted() {
    let place = place("0.1", "3", "start = { v = { spin = 1 } }");
    let states = place.path("states.json");
    std::fs::write(&states, "{\"states\": [{\"q\": [0, 0], \"v\": [0, 0], \"a\": [0, 0], \"tau\": [1, 1]}]}").unwrap();
    let message = "inertia of body \"blade\" has the principal moment 3 kg*m^2, above the sum 1.1 of the other two";
    let with = |command: &'static str, more: &[&'static str]| {
        let states: &[&str] = if command == "dynamics" { &["--states", "states.json"] } else { &[] };
        place.springpot(&[&[command, "mixer.urdf"][..], states, more].concat())
    };
    for command in ["dynamics", "info"] {
        refused(&with(command, &[]), &[message, HELP]);
    }
    refused(&with("init", &["--out", "refused.toml"]), &[message, HELP]);
    let listed = "<inertia> that no distribution of mass has: link \"blade\" (line 7: moment 3.0 above the sum 1.1 of the other two)";
    with("dynamics", &["--accept-inertia"]).says(&[listed]);
    let info = with("info", &["--accept-inertia"]);
    let told = info.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(info.code == Some(0) && told.contains(listed), "{info:?}");

    // What `init` writes has the key, and runs.
    place.done(&["init", "mixer.urdf", "--accept-inertia", "--out", "begun.toml"]);
    assert!(place.read("begun.toml").contains("\naccept_inertia = true\n"));
    place.done(&["run", "begun.toml", "--quiet"]).says(&[listed]);
    assert_eq!(place.record("results/begun")["plan"]["urdf"]["accept_inertia"], true);

    // It is one of the warnings that a scenario accepts, and without the key the scenario is refused.
    place.done(&["check", "mixer.toml"]).says(&[listed, "accept = [\"triangle-inequality\"] in [robot]"]);
    let text = place.read("mixer.toml");
    place.write("told.toml", text.replace("[motion]", "accept = [\"triangle-inequality\"]\n[motion]"));
    assert_eq!(place.done(&["run", "told.toml", "--quiet"]).stderr, "");
    let cure = "correct it, or write accept_inertia = true in [robot] to take it as it is";
    refused(&place.springpot(&["check", "mixer.toml", "--set", "robot.accept_inertia=false"]), &[message, cure]);
    refused(
        &place.springpot(&["info", "mixer.toml", "--accept-inertia"]),
        &["write accept_inertia = true beside its file"],
    );
}

#[test]
fn a_negative_moment_is_accepted_as_long_as_the_mass_matrix_is_positive() {
    // About its own x axis the blade has less than nothing: where that is the axis of the roll, at spin = 0, -0.005 kg*m^2 are left.
    let place = place("-0.01", "1", "start = { q = { spin = \"90 deg\" }, v = { spin = -1 } }");
    let message = "the <inertia> of link \"blade\" has the principal moment -0.01 kg*m^2";
    refused(&place.springpot(&["info", "mixer.urdf"]), &[message, HELP]);
    let listed = "<inertia> with a negative principal moment: link \"blade\" (line 7: -0.01 kg*m^2, used as it is)";
    let check = place.done(&["check", "mixer.toml", "--quiet"]);
    check.says(&[listed, "accept = [\"not-positive\"] in [robot]"]);

    // The run ends where the blade has turned so far, and keeps the rows before.
    let indefinite = "the mass matrix is not positive definite at joint \"roll\"";
    for more in [&[][..], &["--set", "solver.method=\"backward-euler\"", "--set", "solver.step=0.01"]] {
        let ended = place.springpot(&[&["run", "mixer.toml", "--quiet", "--out", "r"][..], more].concat());
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        ended.says(&[indefinite]);
        let t = place.table("r/results.csv").numbers("t");
        let last = t.last().unwrap();
        assert!((1.3..=1.6).contains(last), "{last}");
    }
    let short = ["run", "mixer.toml", "--quiet", "--out", "s", "--set", "time.end=1"];
    place.done(&short).says(&[listed]);

    // A start there is refused before anything runs.
    let there = ["--set", "motion.start.q.spin=0"];
    let run = place.springpot(&[&["run", "mixer.toml"][..], &there].concat());
    refused(&run, &["t = 0 s: the mass matrix is not positive definite at joint \"roll\"", "nothing was run"]);
    let check = place.springpot(&[&["check", "mixer.toml", "--quiet"][..], &there].concat());
    assert_eq!(check.code, Some(1));
    check.says(&[indefinite]);

    let state = |spin: &str| format!("{{\"q\": [0, {spin}], \"v\": [0, 0], \"a\": [0, 0], \"tau\": [1, 1]}}");
    place.write("states.json", format!("{{\"states\": [{}, {}]}}", state("1.5"), state("0")));
    let ended = place.springpot(&["dynamics", "mixer.urdf", "--accept-inertia", "--states", "states.json"]);
    assert_eq!(ended.code, Some(1));
    ended.says(&["states[1]: the mass matrix is not positive definite at joint \"roll\": an accepted inertia is"]);
    assert!(!ended.stderr.contains("states[0]"), "{}", ended.stderr);
}

#[test]
fn what_no_robot_can_have_stays_refused() {
    let place = Place::new();
    for (robot, words) in [
        (robot("0.1", "nan"), "holds \"nan\"; it must be a finite number"),
        (robot("0.1", "1").replace("<mass value=\"1\"/>", "<mass value=\"-1\"/>"), "is -1; it must be 0 or more"),
        (
            robot("-5", "1"),
            "the mass matrix is not positive definite at joint \"roll\": body \"cross\" and what hangs on it",
        ),
        (
            robot("0.1", "-1"),
            "the mass matrix is not positive definite at joint \"spin\": body \"blade\" and what hangs on it",
        ),
        (robot("0", "0"), "the mass matrix is singular at joint \"spin\""),
    ] {
        place.write("mixer.urdf", robot);
        let ended = place.springpot(&["info", "mixer.urdf", "--accept-inertia"]);
        refused(&ended, &[words]);
        assert!(!ended.stderr.contains("accept"), "{}", ended.stderr);
    }
    place.write(
        "bodies.toml",
        place.read("arm.toml").replace("[robot.gripper]", "[robot]\naccept_inertia = true\n[robot.gripper]"),
    );
    let words = "`accept_inertia` of [robot] belongs to `urdf`, and this robot has none; correct the inertia of the [[robot.body]]";
    refused(&place.springpot(&["check", "bodies.toml"]), &[words]);
}
