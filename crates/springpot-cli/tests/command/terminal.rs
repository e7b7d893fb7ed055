//! What a terminal shows: a progress bar, colours unless they are not wanted, lines that fit. Needs `script` (util-linux).

use crate::support::{ENDLESS, Place, length, wait_for};
use std::io::Read as _;
use std::process::{Command, Stdio};

/// A terminal of 60 columns in which the program runs.
fn terminal(place: &Place, environment: &str, arguments: &[&str]) -> Command {
    let quoted: Vec<String> = arguments.iter().map(|argument| format!("'{argument}'")).collect();
    let program = env!("CARGO_BIN_EXE_springpot");
    let line =
        format!("stty rows 24 cols 60; echo $$ >process; exec env {environment} '{program}' {}", quoted.join(" "));
    let mut script = Command::new("script");
    script.current_dir(place.path("")).args(["--quiet", "--command", &line, "/dev/null"]);
    script.env_remove("NO_COLOR").env("TERM", "xterm").env("SHELL", "/bin/sh").stdin(Stdio::null());
    script
}

/// What the program writes to it; `None` where there is no `script` to make one.
fn shown(place: &Place, environment: &str, arguments: &[&str]) -> Option<String> {
    Some(String::from_utf8(terminal(place, environment, arguments).output().ok()?.stdout).unwrap())
}

/// The same of a program that is interrupted as soon as enough was written.
fn shown_until(place: &Place, arguments: &[&str], is_enough: impl Fn(&str) -> bool) -> Option<String> {
    let mut child = terminal(place, "", arguments).stdout(Stdio::piped()).spawn().ok()?;
    let (mut bytes, mut is_told) = (Vec::new(), false);
    let mut out = child.stdout.take().unwrap();
    let mut chunk = [0; 4096];
    loop {
        let count = out.read(&mut chunk).unwrap();
        if count == 0 {
            break;
        }
        bytes.extend_from_slice(&chunk[..count]);
        if !is_told && is_enough(&String::from_utf8_lossy(&bytes)) {
            is_told = interrupted(place);
        }
    }
    child.wait().unwrap();
    Some(String::from_utf8(bytes).unwrap())
}

fn interrupted(place: &Place) -> bool {
    Command::new("kill").args(["-INT", place.read("process").trim()]).status().unwrap().success()
}

#[test]
fn messages_fit_and_are_coloured_where_that_is_wanted() {
    let place = Place::new();
    let arguments = ["check", "arm.toml", "--set", "element.damper.rest_length=0.1"];
    let Some(coloured) = shown(&place, "", &arguments) else { return };
    assert!(coloured.contains("\u{1b}[33mwarning:\u{1b}[0m element"), "{coloured}");
    let plain = shown(&place, "NO_COLOR=1", &arguments).unwrap();
    assert!(!plain.contains('\u{1b}') && plain.contains("warning: element"), "{plain}");
    assert!(plain.lines().all(|line| line.trim_end().chars().count() <= 60), "{plain}");

    for off in ["CLICOLOR=0", "TERM=dumb", "CLICOLOR_FORCE=1 NO_COLOR=1"] {
        assert!(!shown(&place, off, &arguments).unwrap().contains('\u{1b}'), "{off}");
    }
    // Into a pipe, where colours are asked for.
    let forced = place.command(&arguments).env("CLICOLOR_FORCE", "1").output().unwrap();
    assert!(String::from_utf8(forced.stderr).unwrap().contains("\u{1b}[33mwarning:"));

    let refused = shown(
        &place,
        "NO_COLOR=1",
        &["run", "arm.toml", "--set", "motion.joints.x=0.05 - 0.05*kos(6*t) + 0.001*sin(60*t)"],
    );
    let refused = refused.unwrap();
    assert!(refused.contains("╰── here") && refused.contains("did you mean"), "{refused}");
    assert!(refused.lines().all(|line| line.trim_end().chars().count() <= 60), "{refused}");
}

#[test]
fn a_long_run_shows_how_far_it_is() {
    let place = Place::new();
    let endless = [&["run", "arm.toml"], &ENDLESS[..]].concat();
    let Some(bar) = shown_until(&place, &endless, |text| text.contains(" left")) else { return };
    assert!(bar.contains(" %, row ") && bar.contains(" of 2,000,001, ") && bar.contains(" left"), "{bar}");
    assert!(bar.contains("interrupted after the row at t = "), "{bar}");
    // Short runs, quiet ones and pipes show none.
    let quiet = std::thread::scope(|scope| {
        scope.spawn(|| {
            wait_for("rows", || length(place.path("results/arm/results.csv.part")) >= 6_000);
            interrupted(&place);
        });
        shown(&place, "", &[&endless[..], &["--quiet"]].concat()).unwrap()
    });
    assert!(!quiet.contains('%') && quiet.contains("interrupted after"), "{quiet}");
    assert!(quiet.lines().all(|line| line.trim_end().chars().count() <= 60), "{quiet}");
    let short = shown(&place, "", &["run", "arm.toml"]).unwrap();
    let seconds =
        short.split(" rows, ").nth(1).and_then(|rest| rest.split(" in ").nth(1)?.split(' ').next()?.parse().ok());
    let is_short = seconds.is_some_and(|seconds: f64| seconds < 0.3);
    assert!((!short.contains('%') || !is_short) && short.contains("5 rows, "), "{short}");
}

#[test]
fn rows_do_not_steer_it() {
    let place = Place::new();
    place.write("x.csv", "t,x,note\n0,1,a\u{1b}]0;owned\u{7}\n1,2,\u{202e}b\n2,3,größe\n");
    for scheme in ["spline", "exponential"] {
        let arguments = ["derivative", "x.csv", "--column", "x", "--order", "1", "--scheme", scheme];
        let Some(text) = shown(&place, "", &arguments) else { return };
        assert!(
            text.contains("0,1,a␛]0;owned␇,") && text.contains(",\u{fffd}b,") && text.contains(",größe,"),
            "{text}"
        );
        assert!(!text.contains(['\u{1b}', '\u{7}', '\u{202e}']), "{text:?}");
    }
}

#[test]
fn wide_names_do_not_break_tables() {
    let place = Place::new();
    let joint = |side: &str, part: &str, parent: &str| {
        let link = format!("{side}_gripper_of_the_upper_arm_{part}_finger_link");
        format!(
            "<link name=\"{link}\"><inertial><mass value=\"0.125\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" \
             iyz=\"0\"/></inertial></link><link name=\"{side}_{part}_a_frame_with_a_name_that_is_longer_than_the_terminal_is_wide\"/>\
             <joint name=\"{side}_fixed_{part}\" type=\"fixed\"><parent link=\"{link}\"/>\
             <child link=\"{side}_{part}_a_frame_with_a_name_that_is_longer_than_the_terminal_is_wide\"/></joint>\
             <joint name=\"{side}_gripper_of_the_upper_arm_{part}_finger_joint\" type=\"revolute\"><parent link=\"{parent}\"/>\
             <child link=\"{link}\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1.25\" upper=\"2.5\" velocity=\"3\" effort=\"4\"/>\
             <dynamics damping=\"0.1\"/></joint>"
        )
    };
    let joints: String = ["left", "right"]
        .into_iter()
        .flat_map(|side| ["inner", "outer"].map(|part| joint(side, part, "base")))
        .collect();
    place.write("wide.urdf", format!("<robot name=\"wide\"><link name=\"base\"/>{joints}</robot>"));
    let Some(text) = shown(&place, "NO_COLOR=1", &["info", "wide.urdf"]) else { return };
    let text = text.replace('\r', "");
    let tables: Vec<&str> =
        text.lines().take_while(|line| !line.starts_with("links on fixed")).map(str::trim_end).collect();
    assert!(text.contains("\n  right_gripper_of_the_upper_arm_outer_finger_link\n    right_outer_a_frame"), "{text}");
    assert!(tables.len() > 14 && tables.iter().all(|line| line.chars().count() <= 60), "{text}");
    // A pipe takes whole names.
    assert!(place.done(&["info", "wide.urdf"]).stdout.contains("right_gripper_of_the_upper_arm_outer_finger_joint  "));
}
