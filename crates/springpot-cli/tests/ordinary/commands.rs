//! Every command on every robot.

use crate::ran::{ROOT, Tried};
use crate::robots::robots;
use std::path::Path;
use std::process::Command;

/// Runs the program in a folder; what it says where it does not end with 0.
fn springpot(folder: &Path, arguments: &[&str]) -> Result<String, String> {
    let ended = Command::new(env!("CARGO_BIN_EXE_springpot")).current_dir(folder).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    match ended.status.code() {
        Some(0) => Ok(String::from_utf8(ended.stdout).unwrap()),
        code => Err(format!("springpot {}: {code:?}, {said}", arguments.join(" "))),
    }
}

/// What somebody does with a robot that was just downloaded, command by command.
fn first_hour(robot: &str, is_floating: bool, tried: &mut Tried) {
    let place = tempfile::tempdir().unwrap();
    let mut go = |arguments: &[&str]| tried.one(robot, springpot(place.path(), arguments)).unwrap_or_default();
    let base: &[&str] = if is_floating { &["--floating-base"] } else { &[] };
    let with = |arguments: &[&'static str]| [arguments, base].concat();

    let told = go(&[&["info", robot, "--json"], &with(&["--accept-inertia"])[..]].concat());
    let told: serde_json::Value = serde_json::from_str(&told).unwrap_or_default();
    go(&[&["info", robot], &with(&["--accept-inertia"])[..]].concat());
    go(&[&["init", robot, "--out", "robot.toml"], &with(&["--accept-inertia"])[..]].concat());

    let count = |key: &str| told[key].as_u64().unwrap_or_default() as usize;
    let q = vec![0.1; count("nq")];
    let v = vec![0.1; count("nv")];
    let states = serde_json::json!({ "states": [{ "q": q, "v": v, "a": v, "tau": v }] });
    std::fs::write(place.path().join("states.json"), states.to_string()).unwrap();
    go(&[&["dynamics", robot, "--states", "states.json"], &with(&["--accept-inertia"])[..]].concat());

    // An FMU is one case.
    let text = std::fs::read_to_string(place.path().join("robot.toml")).unwrap_or_default();
    let sweep = text.find("[[sweep]]").map_or(0..0, |at| at..at + text[at..].find("\n\n").unwrap_or(0));
    std::fs::write(place.path().join("one.toml"), [&text[..sweep.start], &text[sweep.end..]].concat()).unwrap();
    for arguments in [
        &["check", "robot.toml"][..],
        &["run", "robot.toml", "--out", "out", "--view"],
        &["dynamics", "robot.toml", "--at", "0.1"],
        &["modes", "robot.toml"],
        &["modulus", "robot.toml", "strut"],
        &["plot", "out", "strut.force", "--out", "plot.svg"],
        &["metrics", "out", "--metric", "rms(strut.force)"],
        &["report", "out"],
        &["view", "out"],
        &["export", "out", "out.mcap"],
        &["export", "out", "out.glb"],
        &["export", "out", "out.gltf"],
        &["fmu", "one.toml", "--out", "robot.fmu"],
    ] {
        go(arguments);
    }
}

#[test]
fn every_command_takes_a_robot() {
    let mut tried = Tried::default();
    first_hour(&format!("{ROOT}/testdata/multibody/double_pendulum.urdf"), false, &mut tried);
    tried.end(17);
}

#[test]
#[ignore = "a minute"]
fn every_command_takes_every_robot() {
    let mut tried = Tried::default();
    for (robot, is_floating) in robots() {
        first_hour(&robot, is_floating, &mut tried);
    }
    tried.end(17 * 14);
}
