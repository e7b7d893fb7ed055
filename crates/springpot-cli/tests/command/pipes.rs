//! A reader that goes away early, as `head` does, ends every command that prints quietly.

use crate::support::{Place, testdata};
use std::process::Stdio;

#[test]
fn whoever_reads_may_stop() {
    let place = Place::new();
    let panda = testdata("multibody/panda.urdf");
    place.write("states.json", "{\"states\": [{\"q\": [0, 0], \"v\": [1, 1], \"a\": [0, 0], \"tau\": [0, 0]}]}");
    let rows = (0..40_000).map(|k| format!("{k},{}\n", (0.001 * f64::from(k)).sin()));
    place.write("motion.csv", format!("t,x\n{}", rows.collect::<String>()));
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
        &["derivative", "motion.csv", "--column", "x", "--order", "0.5"],
        &["derivative", "motion.csv", "--column", "x", "--order", "0.5", "--scheme", "exponential"],
        &["prony", "--order", "0.5", "--coefficient", "1", "--from", "1e-3", "--to", "10", "--format", "csv"],
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
