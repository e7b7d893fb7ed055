//! A reader that goes away early, as `head` does, ends every command that prints quietly.

use crate::support::{Place, testdata};
use std::process::Stdio;

#[test]
fn whoever_reads_may_stop() {
    let place = Place::new();
    let panda = testdata("multibody/panda.urdf");
    place.write("states.json", "{\"states\": [{\"q\": [0, 0], \"v\": [1, 1], \"a\": [0, 0], \"tau\": [0, 0]}]}");
    for arguments in [
        &["--help"][..],
        &["--version"],
        &["run", "--help"],
        &["run", "arm.toml"],
        &["check", "arm.toml"],
        &["check", "--schema"],
        &["info", &panda],
        &["info", &panda, "--json"],
        &["dynamics", "arm.toml", "--at", "0.1"],
        &["dynamics", "arm.toml", "--states", "states.json"],
        &["laws"],
        &["laws", "springpot"],
        &["laws", "--json"],
        &["laws", "--from", "stiffness = 3"],
        &["init"],
        &["completions", "bash"],
        &["man"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = place.command(arguments);
        let ended = command.stdout(writer).stderr(Stdio::piped()).output().unwrap();
        let stderr = String::from_utf8(ended.stderr).unwrap();
        // Without a URDF's warnings nothing is said.
        let quiet = stderr.lines().all(|line| line.starts_with("warning: "));
        assert!(ended.status.code() == Some(0) && quiet, "{arguments:?}: {:?} {stderr}", ended.status);
    }
}
