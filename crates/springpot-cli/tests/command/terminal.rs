//! What a terminal shows: a progress bar, colours unless they are not wanted, lines that fit. Needs `script` (util-linux).

use crate::support::{ENDLESS, Place};
use std::process::Command;

/// What the program writes to a terminal of 60 columns; `None` where there is no `script` to make one.
fn shown(place: &Place, environment: &str, arguments: &[&str]) -> Option<String> {
    let quoted: Vec<String> = arguments.iter().map(|argument| format!("'{argument}'")).collect();
    let program = env!("CARGO_BIN_EXE_springpot");
    let line = format!("stty rows 24 cols 60; {environment} '{program}' {}", quoted.join(" "));
    let mut script = Command::new("script");
    script.current_dir(place.path("")).args(["--quiet", "--command", &line, "/dev/null"]);
    script.env_remove("NO_COLOR").env("TERM", "xterm");
    Some(String::from_utf8(script.output().ok()?.stdout).unwrap())
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
    let Some(bar) = shown(&place, "timeout --foreground -s INT 2", &endless) else { return };
    assert!(bar.contains(" %, row ") && bar.contains(" of 2,000,001, ") && bar.contains(" left"), "{bar}");
    assert!(bar.contains("interrupted after the row at t = "), "{bar}");
    // Short runs, quiet ones and pipes show none.
    let quiet = shown(&place, "timeout --foreground -s INT 1", &[&endless[..], &["--quiet"]].concat()).unwrap();
    assert!(!quiet.contains('%') && quiet.contains("interrupted after"), "{quiet}");
    let short = shown(&place, "", &["run", "arm.toml"]).unwrap();
    assert!(!short.contains('%') && short.contains("5 rows, "), "{short}");
}
