//! `springpot dynamics --states`: input that is refused, with its place and what would be right.

use crate::support::{Place, testdata};

/// Asserts that the states are refused with these words, and that nothing is printed.
fn refused(urdf: &str, flags: &[&str], states: impl AsRef<[u8]>, words: &[&str]) {
    let place = Place::new();
    place.write("states.json", states);
    let urdf = testdata(&format!("multibody/{urdf}.urdf"));
    let ended = place.springpot(&[&["dynamics", &urdf, "--states", "states.json"], flags].concat());
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.starts_with("error: "), "{}", ended.stderr);
    for word in words {
        assert!(ended.stderr.contains(word), "{word:?} in {}", ended.stderr);
    }
}

fn pendulum(states: &str, words: &[&str]) {
    refused("double_pendulum", &[], states, words);
}

#[test]
fn broken_json_is_marked() {
    for (text, words) in [
        ("", &["states.json:1:1: not JSON: EOF"][..]),
        (
            "{\"states\": [\n  {\"q\": [1, 2],\n   \"v\": [0, 0,]}]}",
            &["states.json:3:15: not JSON: expected value", "3 │"],
        ),
        ("{\"states\": []} x", &["states.json:1:16: not JSON: trailing characters"]),
        ("{\"ä", &["states.json:1:3: not JSON: EOF"]),
        ("{'states': []}", &["states.json:1:2: not JSON: key must be a string"]),
        ("{\"states\": [{\"q\": [1,\n NaN]}]}", &["states.json:2:2: NaN is no JSON", "─┬─", "must be finite"]),
        ("{\"states\": [{\"q\": [-Infinity]}]}", &["states.json:1:20: -Infinity is no JSON"]),
        (
            "{\"states\": [{\"q\": [1e999, 0], \"v\": [0, 0], \"a\": [0, 0], \"tau\": [0, 0]}]}",
            &["1e999 of joint1 is beyond all numbers"],
        ),
    ] {
        pendulum(text, words);
    }
    refused("double_pendulum", &[], b"{\"states\": [\"\xff\"]}", &["states.json:1:14: not UTF-8"]);
    let deep = "[".repeat(200_000);
    pendulum(&deep, &["not JSON: EOF"]);
    pendulum(&format!("{deep}{}", "]".repeat(200_000)), &["the file is an array"]);
}

#[test]
fn wrong_shapes_are_named() {
    let zeros = "\"v\": [0, 0], \"a\": [0, 0], \"tau\": [0, 0]";
    for (text, words) in [
        ("[]".to_owned(), &["states.json:1:1: the file is an array", "\"joints\" and \"states\""][..]),
        ("{}".to_owned(), &["the file has no \"states\"", "help: write {\"states\""]),
        (
            "{\"state\": []}".to_owned(),
            &["1:2: unknown key \"state\" in the file", "there is \"joints\" and \"states\""],
        ),
        ("{\"states\": [], \"states\": []}".to_owned(), &["1:16: \"states\" stands twice"]),
        ("{\"states\": {}}".to_owned(), &["1:12: \"states\" is an object, but must be an array"]),
        ("{\"states\": [3]}".to_owned(), &["1:13: states[0] is 3, but must be an object"]),
        (
            format!("{{\"states\": [{{\"q\": [0, 0], {zeros}}}, {{\"q\": [0, 0], \"v\": [0, 0], \"a\": [0, 0]}}]}}"),
            &["states[1] has no \"tau\"", "zeros where the robot is at rest"],
        ),
        ("{\"states\": [{\"q\": [0, 0]}]}".to_owned(), &["1:13: states[0] has no \"v\", \"a\" and \"tau\""]),
        (
            format!("{{\"states\": [{{\"q\": [0, 0], \"qd\": [], {zeros}}}]}}"),
            &["1:27: unknown key \"qd\" in states[0]"],
        ),
        (
            format!("{{\"states\": [{{\"q\": [0, 0, 0], {zeros}}}]}}"),
            &["\"q\" of states[0] holds 3 numbers, but must hold 2", "write joint1, joint2"],
        ),
        (format!("{{\"states\": [{{\"q\": [], {zeros}}}]}}"), &["\"q\" of states[0] holds 0 numbers"]),
        (
            format!("{{\"states\": [{{\"q\": 1, {zeros}}}]}}"),
            &["\"q\" of states[0] is 1, but must be an array of 2 numbers"],
        ),
        (
            format!("{{\"states\": [{{\"q\": [0, \"1\"], {zeros}}}]}}"),
            &["1:23: \"q\" of states[0]: the entry of joint2 is the text \"1\""],
        ),
        (format!("{{\"states\": [{{\"q\": [null, 0], {zeros}}}]}}"), &["the entry of joint1 is null"]),
        (format!("{{\"states\": [{{\"q\": [[0], 0], {zeros}}}]}}"), &["the entry of joint1 is an array"]),
    ] {
        pendulum(&text, words);
    }
    // The state's number is told wherever it stands.
    let many = format!("{{\"q\": [0, 0], {zeros}}},\n").repeat(41);
    pendulum(
        &format!("{{\"states\": [\n{many}{{\"q\": [0], {zeros}}}]}}"),
        &["states.json:43:7: \"q\" of states[41] holds 1"],
    );
}

#[test]
fn joints_are_named_once_each() {
    for (joints, words) in [
        ("3", &["\"joints\" is 3, but must be an array of names"][..]),
        ("[1]", &["1:13: \"joints\" holds 1"]),
        ("[\"joint1\"]", &["1:12: \"joints\" leaves out joint2"]),
        ("[]", &["leaves out joint1, joint2"]),
        ("[\"joint1\", \"joint2\", \"joint1\"]", &["joint \"joint1\" stands twice"]),
        ("[\"joint1\", \"join2\"]", &["1:23: there is no joint \"join2\"", "did you mean `joint2`?"]),
        ("[\"joint1\", \"link2\"]", &["\"link2\" is a link, not a joint; the joint that carries it is \"joint2\""]),
        ("[\"joint1\", \"joint2\", \"joint3\"]", &["joint \"joint3\" is fixed and has no coordinate", "leave it out"]),
    ] {
        pendulum(&format!("{{\"joints\": {joints}, \"states\": []}}"), words);
        // The order is known when the states are read, wherever it stands.
        refused("double_pendulum", &[], format!("{{\"states\": [], \"joints\": {joints}}}"), &words[..0]);
    }
    let fingers = r#"{"joints": ["panda_finger_joint2"], "states": []}"#;
    let words = ["follows joint \"panda_finger_joint1\" and has no coordinate of its own", "--ignore-mimic gives it"];
    refused("panda", &[], fingers, &words);
    refused("panda", &["--ignore-mimic"], fingers, &["leaves out panda_joint1"]);
}

#[test]
fn floating_bases_have_their_own_mistakes() {
    let flags = ["--floating-base"];
    let state = |q: &str| format!("{{\"states\": [{{\"q\": [{q}], \"v\": [], \"a\": [], \"tau\": []}}]}}");
    let nothing = "{\"states\": []}";
    refused(
        "solo12",
        &flags,
        state("0, 0"),
        &["holds 2 numbers, but must hold 19", "floating_base.x", "floating_base.qw"],
    );
    let zeros = ["0"; 18].join(", ");
    let flat =
        format!("{{\"states\": [{{\"q\": [0, {zeros}], \"v\": [{zeros}], \"a\": [{zeros}], \"tau\": [{zeros}]}}]}}");
    refused("solo12", &flags, flat, &["the quaternion is 0 0 0 0", "0 0 0 1"]);
    let christoffel = ["--floating-base", "--christoffel"];
    let words = ["--christoffel: joint \"floating_base\" has 6 degrees of freedom", "\"coriolis\" holds"];
    refused("solo12", &christoffel, nothing, &words);
}

#[test]
fn frames_and_files_that_do_not_exist_are_refused() {
    let nothing = "{\"states\": []}";
    refused("ur5", &["--frame", "tool"], nothing, &["--frame \"tool\": the robot has no link and no joint", "`tool0`"]);
    refused("ur5", &["--set", "robot.gravity=[0,0,0]"], nothing, &["--set changes values of a scenario"]);
    let place = Place::new();
    let ur5 = testdata("multibody/ur5.urdf");
    for (arguments, words) in [
        (&["dynamics", &ur5, "--states", "none.json"][..], "error: none.json: cannot be read: "),
        (&["dynamics", "none.urdf", "--states", "none.json"], "error: none.urdf: cannot be read: "),
        (&["dynamics", "none.toml", "--states", "none.json"], "error: none.toml: cannot be opened: "),
        (
            &["dynamics", "arm.toml", "--states", "none.json", "--floating-base"],
            "--floating-base is for files of robots",
        ),
        (&["dynamics", "arm.toml", "--states", "none.json", "--ignore-mimic"], "--ignore-mimic is for files of robots"),
        (
            &["dynamics", "arm.toml", "--states", "none.json", "--package-path", "."],
            "--package-path is for files of robots",
        ),
        (&["dynamics", "arm.toml", "--states", "none.json", "--set", "robot.body.arm.mass=-1"], "--set:1:21"),
    ] {
        let ended = place.springpot(arguments);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}

#[test]
fn what_no_computer_holds_is_refused() {
    let place = Place::new();
    place.write("states.json", "{\"states\": []}");
    let chain = |n: usize| {
        let inertial = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
        let link = |k: usize| {
            format!(
                "<link name=\"l{k}\">{inertial}</link><joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{}\"/>\
                 <child link=\"l{k}\"/></joint>",
                k - 1
            )
        };
        let links: String = (1..=n).map(link).collect();
        format!("<robot name=\"chain\"><link name=\"l0\"/>{links}</robot>")
    };
    place.write("chain.urdf", chain(20_000));
    let ended = place.springpot(&["dynamics", "chain.urdf", "--states", "states.json"]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("nv = 20000; matrices are printed up to nv = 3000"), "{}", ended.stderr);
    place.write("chain.urdf", chain(500));
    let ended = place.springpot(&["dynamics", "chain.urdf", "--states", "states.json", "--christoffel"]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("symbols are printed up to nv = 400"), "{}", ended.stderr);
    place.done(&["dynamics", "chain.urdf", "--states", "states.json"]);
}
