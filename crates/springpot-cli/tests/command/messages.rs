//! What is read out of files and off the command line, as messages and tables repeat it: negative numbers are numbers, nothing
//! steers the terminal, nothing is too long to be read, and every mistake has its place.

use crate::support::{ARM, Ended, Place, testdata};

/// Escape sequences, C1, marks of direction, blanks without width; escapes of JSON and TOML, but for the last ones.
const STEERING: &str = "a\\u001b[31m\\u001b]0;owned\\u0007\\u009b\\u200b\\u200f\\u202e\\u2066\\u2069\\ufeff";
/// The same as characters.
const STEERS: [char; 10] =
    ['\u{1b}', '\u{7}', '\u{9b}', '\u{200b}', '\u{200f}', '\u{202e}', '\u{2066}', '\u{2069}', '\u{feff}', '\u{7f}'];

/// Asserts that nothing in the output steers a terminal.
#[track_caller]
fn is_plain(ended: &Ended) {
    for text in [&ended.stdout, &ended.stderr] {
        let found = text.chars().find(|c| STEERS.contains(c) || c.is_control() && *c != '\n');
        assert!(found.is_none(), "{found:?} in {text:?}");
    }
}

#[test]
fn negative_numbers_are_numbers() {
    let place = Place::new();
    place.write("x.csv", "t,x\n0,1\n1,2\n2,4\n3,7\n");
    for (order, name) in [("-1e-3", "-0.001"), ("-5e-1", "-0.5"), ("-.5", "-0.5"), ("-1", "-1"), ("-2E0", "-2")] {
        let ended = place.done(&["derivative", "x.csv", "--column", "x", "--order", order]);
        assert!(ended.stdout.starts_with(&format!("t,x,D^{name} x\n")), "{order}: {}", ended.stdout);
    }
    let prony = ["prony", "--order", "0.5", "--coefficient", "5", "--from", "1e-3", "--to", "1"];
    let with = |option: &str, value: &'static str| {
        let mut arguments = prony.to_vec();
        match arguments.iter().position(|argument| *argument == option) {
            Some(at) => arguments[at + 1] = value,
            None => arguments.extend([Box::leak(option.to_owned().into_boxed_str()), value]),
        }
        arguments
    };
    for (arguments, words) in [
        (with("--from", "-1e-3"), "--from -1e-3: not a positive number"),
        (with("--to", "-.5"), "--to -.5: not a positive number"),
        (with("--coefficient", "-5e-1"), "--coefficient -5e-1: not a positive number"),
        (with("--equilibrium", "-.5 N/m"), "--equilibrium -.5 N/m: not a positive number"),
        (with("--rtol", "-1e-3"), "the tolerance must lie between"),
        (with("--order", "-.5"), "--order -0.5: out of range"),
        (vec!["dynamics", "arm.toml", "--at", "-1e-3"], "--at -1e-3: "),
        (vec!["dynamics", "arm.toml", "--at", "-.5 s"], "--at -.5 s: "),
        (vec!["dynamics", "arm.toml", "--at", "0", "--case", "-1"], "--case -1: not a value that it takes"),
        (vec!["run", "arm.toml", "--checkpoint-every", "-.5"], "--checkpoint-every -.5: not a positive time"),
        (vec!["run", "arm.toml", "--jobs", "-1"], "--jobs -1: not a value that it takes"),
    ] {
        let refused = place.springpot(&arguments);
        assert!(refused.code == Some(2) && refused.stderr.contains(words), "{arguments:?}: {}", refused.stderr);
    }
}

#[test]
fn levels_of_simd_are_asked_for_by_name() {
    let place = Place::with(ARM);
    let check = |level: &str| place.command(&["check", "arm.toml"]).env("SPRINGPOT_SIMD", level).output().unwrap();
    let refused = check("sse2");
    assert_eq!(refused.status.code(), Some(2));
    let words = "error: SPRINGPOT_SIMD is \"sse2\"; it must be baseline, avx2 or avx512, or not set at all\n";
    assert_eq!(String::from_utf8(refused.stderr).unwrap(), words);
    assert_eq!(check("baseline").stdout, check("").stdout);
    assert!(check("baseline").status.success());
}

#[test]
fn a_title_does_not_steer_the_terminal() {
    let title = format!("title = \"{STEERING}\\u007f\\nrobot     forged π²\"");
    let place = Place::with(&ARM.replace("title = \"Damped arm\"", &title));
    for arguments in [&["check", "arm.toml"][..], &["dynamics", "arm.toml", "--at", "0.1"]] {
        let ended = place.done(arguments);
        is_plain(&ended);
        let title = "a␛[31m␛]0;owned␇\u{fffd}\u{fffd}\u{fffd}\u{fffd}\u{fffd}\u{fffd}\u{fffd}␡␊robot";
        assert!(ended.stdout.contains(title) && ended.stdout.contains("forged π²"), "{}", ended.stdout);
        assert!(!ended.stdout.lines().any(|line| line.starts_with("robot     forged")), "{}", ended.stdout);
    }
    // A title that nobody reads to its end.
    let place = Place::with(&ARM.replace("Damped arm", &"long ".repeat(10_000)));
    let ended = place.done(&["check", "arm.toml"]);
    assert!(ended.stdout.len() < 2_000 && ended.stdout.contains('…'), "{}", ended.stdout);
}

#[test]
fn names_do_not_steer_it_either() {
    let place = Place::new();
    // XML has no escape for most control characters; those of direction and C1 stand there as they are.
    let name = "\u{202e}\u{2066}knee\u{9b}\u{200b}größe π &#10;x";
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" \
             iyz=\"0\"/></inertial></link>"
        )
    };
    let joint = |kind: &str, name: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"base\"/><child link=\"{child}\"/><axis xyz=\"0 0 1\"/>\
             <dynamics damping=\"1\"/></joint>"
        )
    };
    let robot = format!(
        "<robot name=\"{name}\"><link name=\"base\"/>{}{}{}{}</robot>",
        link(name),
        link("foot"),
        joint("continuous", name, name),
        joint("fixed", &format!("{name} fixed"), "foot"),
    );
    place.write("r.urdf", &robot);
    place.write("states.json", "{\"states\": [{\"q\": [0], \"v\": [0], \"a\": [0], \"tau\": [0]}]}");
    place.write("bad.json", format!("{{\"joints\": [\"{name}\"]}}"));
    place.write("key.json", format!("{{\"{STEERING}\": 1}}"));
    place.write("bad.urdf", robot.replace("continuous", &format!("contin{name}uous")));
    place.write("ragged.urdf", robot.replace("<mass value=\"1\"/>", &format!("<mass value=\"{name}\"/>")));
    place.write("x.csv", format!("t,{name}\n0,1\n1,2\n"));
    place.write("cell.csv", format!("t,x\n0,{name}\u{1b}[2J\n1,2\n"));
    place.write("bad.toml", format!("{ARM}\n# \u{202e}\n[{name}]\n"));
    for (arguments, code) in [
        (&["info", "r.urdf"][..], 0),
        (&["info", "r.urdf", "--json"], 0),
        (&["dynamics", "r.urdf", "--states", "states.json"], 0),
        (&["dynamics", "r.urdf", "--states", "bad.json"], 2),
        (&["dynamics", "r.urdf", "--states", "key.json"], 2),
        (&["dynamics", "r.urdf", "--states", "states.json", "--frame", "knee"], 2),
        (&["info", "bad.urdf"], 2),
        (&["info", "ragged.urdf"], 2),
        (&["check", "bad.toml"], 2),
        (&["check", "arm.toml", "--set", "motion.joints.q1={csv=\"x.csv\", column=\"x\"}"], 2),
        (&["check", "arm.toml", "--set", "motion.joints.q1={csv=\"cell.csv\", column=\"x\"}"], 2),
        (&["derivative", "x.csv", "--column", "x", "--order", "1"], 2),
        (&["derivative", "cell.csv", "--column", "x", "--order", "1"], 2),
        (&["plot", "cell.csv", "x"], 2),
        (&["plot", "x.csv", "y"], 2),
    ] {
        let ended = place.springpot(arguments);
        assert_eq!(ended.code, Some(code), "{arguments:?}: {}", ended.stderr);
        is_plain(&ended);
    }
    let info = place.done(&["info", "r.urdf"]);
    assert!(info.stdout.contains("knee\u{fffd}\u{fffd}größe π ␊x"), "{}", info.stdout);
    let json: serde_json::Value = serde_json::from_str(&place.done(&["info", "r.urdf", "--json"]).stdout).unwrap();
    assert_eq!(json["name"], name.replace("&#10;", "\n"));
    // Data are data: a pipe has the columns as they were.
    place.write("x.csv", format!("t,{name}\n0,1\n1,2\n2,3\n"));
    let rows = place.done(&["derivative", "x.csv", "--column", name, "--order", "1"]);
    assert!(rows.stdout.starts_with(&format!("t,{name},D^1 {name}\n")), "{}", rows.stdout);
}

#[test]
fn what_is_too_long_is_cut() {
    let place = Place::new();
    let (digits, word, words) = ("9".repeat(100_000), "x".repeat(100_000), "many words ".repeat(10_000));
    let robot = std::fs::read_to_string(testdata("multibody/double_pendulum.urdf")).unwrap();
    place.write("link.urdf", robot.replacen("<child link=\"", &format!("<child link=\"{word}"), 1));
    place.write("kind.urdf", robot.replacen("type=\"", &format!("type=\"{words}"), 1));
    place.write("digits.csv", format!("t,x\n0,1\n1,{digits}\n2,3\n"));
    place.write("header.csv", format!("t,{word},{word}\n0,1,1\n1,2,2\n"));
    place.write("words.csv", format!("t,x\n0,1\n1,{words}\n2,3\n"));
    place.write("digits.json", format!("{{\"states\": [{{\"q\": [{digits}, 0]}}]}}"));
    place.write("key.json", format!("{{\"{word}\": 1}}"));
    let edited = |from: &str, to: &str| {
        assert_eq!(ARM.matches(from).count(), 1, "{from}");
        ARM.replace(from, to)
    };
    for (k, text) in [
        edited("mass = 2\n", &format!("mass = {digits}\n")),
        edited("mass = 2\n", &format!("mass = \"{digits} kg\"\n")),
        edited("mass = 2\n", &format!("mass = \"2 {word}\"\n")),
        edited("mass = 2\n", &format!("mass = \"{words}\"\n")),
        edited("output_step = \"100 ms\"", &format!("output_step = -{digits}")),
        edited("law = \"magnetorheological\"", &format!("law = \"{word}\"")),
        edited("law = \"magnetorheological\"", &format!("law = \"{words}\"")),
        edited("rest_length = \"50 cm\"", &format!("{word} = 1")),
        edited("body = \"world\"", &format!("body = \"{words}\"")),
        edited("name = \"damper\"", &format!("name = \"{words}\"")),
        edited("q1 = \"0.3*sin(4*t)\"", &format!("q1 = \"{word}*t\"")),
        edited("q1 = \"0.3*sin(4*t)\"", &format!("q1 = \"1/0 + {}0\"", "1*".repeat(2_000))),
        edited("u = \"1 + 0.5*sin(20*t)\"", &format!("u = {{ csv = \"{word}\", column = \"x\" }}")),
        format!("{ARM}[[sweep]]\nparameter = \"{word}\"\nvalues = [1]\n"),
        format!("{ARM}[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [{digits}]\n"),
    ]
    .into_iter()
    .enumerate()
    {
        place.write(&format!("{k}.toml"), text);
    }
    let scenarios: Vec<String> = (0..15).map(|k| format!("{k}.toml")).collect();
    let scenarios = scenarios.iter().map(|file| vec!["check", file]);
    let robot = testdata("multibody/double_pendulum.urdf");
    let others = [
        vec!["info", "link.urdf"],
        vec!["info", "kind.urdf"],
        vec!["derivative", "digits.csv", "--column", "x", "--order", "1"],
        vec!["derivative", "words.csv", "--column", "x", "--order", "1"],
        vec!["derivative", "header.csv", "--column", "x", "--order", "1"],
        vec!["plot", "words.csv", "x"],
        vec!["dynamics", &robot, "--states", "digits.json"],
        vec!["dynamics", &robot, "--states", "key.json"],
    ];
    for arguments in scenarios.chain(others) {
        let refused = place.springpot(&arguments);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{arguments:?}: {:.999}", refused.stderr);
        let longest = refused.stderr.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(longest < 700, "{arguments:?}: {longest} characters: {}", &refused.stderr[..700]);
    }
    place.write("metric.toml", format!("{ARM}[[metric]]\nname = \"{word}\"\nof = \"t\"\nkind = \"max\"\n"));
    let told = place.done(&["run", "metric.toml", "--out", "o"]).stdout;
    assert!(told.contains("metrics  xxx") && told.lines().all(|line| line.chars().count() < 200), "{told:.999}");
    let shown = place.springpot(&["check", "0.toml"]).stderr;
    assert!(shown.contains("999…999") && shown.contains(", not a finite number"), "{shown}");
}

#[test]
fn mistakes_of_whole_files_have_a_place() {
    let place = Place::new();
    for (text, words) in [
        ("\nt,u,u\n0,1,1\n1,2,2\n", "m.csv:2: columns 2 and 3 are both called `u`"),
        ("t,u,\n0,1,\n1,2,\n", "m.csv:1: column 3 has no name"),
        ("t;u\n0;1\n1;2\n", "m.csv:1: columns must be separated by commas, but the header has ';' as character 2"),
        ("t,u\n0,1\n\n", "m.csv:2: 1 rows of numbers; at least two are needed"),
        ("s,u\n0,1\n1,2\n", "m.csv:1: no column `t`"),
        ("0,1\n1,2\n", "m.csv:1: the first row must name the columns"),
    ] {
        place.write("m.csv", text);
        let refused =
            place.springpot(&["check", "arm.toml", "--set", "motion.joints.q1={csv=\"m.csv\", column=\"u\"}"]);
        assert!(refused.code == Some(2) && refused.stderr.contains(words), "{text:?}: {}", refused.stderr);
    }
    for (text, words) in [
        (
            "<?xml version=\"1.0\"?>\n<!-- < -->\n  <!DOCTYPE robot>\n<robot name=\"r\"/>",
            "r.urdf:3:3: not XML: it has a",
        ),
        ("\n <robot name=\"r\">\n<link name=\"a\"/>\n", "r.urdf:2:2: not XML: the outermost element is never closed"),
        ("<robot name=\"r\">\n<link name=\"a", "r.urdf:2:14: not XML: the text ends too early"),
        ("<!-- nothing -->\n", "r.urdf:1:17: not XML: there is no element in it"),
    ] {
        place.write("r.urdf", text);
        let refused = place.springpot(&["info", "r.urdf"]);
        let marked = refused.stderr.contains(" │ ") && refused.stderr.contains("here");
        assert!(refused.code == Some(2) && refused.stderr.contains(words) && marked, "{text:?}: {}", refused.stderr);
    }
}
