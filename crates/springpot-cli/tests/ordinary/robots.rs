//! Robots that are let go: at rest, tilted, thrown, on the ground and floating, under two gravities.

use crate::ran::{ROOT, Tried, cases, ran};
use springpot::law::Catalog;
use springpot::model::{JointKind, Model};
use springpot_scenario::Scenario;
use std::fmt::Write as _;
use std::path::Path;

/// Every robot that the project holds, and those below the folder that SPRINGPOT_ROBOTS names which are not refused; whether it floats.
pub(crate) fn robots() -> Vec<(String, bool)> {
    let mut own = Vec::new();
    for folder in ["testdata/multibody", "scenarios/robots"] {
        below(&Path::new(ROOT).join(folder), &mut own);
    }
    assert!(own.len() >= 7, "{own:?}");
    let mut others = Vec::new();
    if let Some(folder) = std::env::var_os("SPRINGPOT_ROBOTS") {
        below(Path::new(&folder), &mut others);
    }
    let both = |urdf: String| [false, true].map(|is_floating| (urdf.clone(), is_floating));
    let others = others.into_iter().flat_map(both).filter(|(urdf, is_floating)| is_taken(urdf, *is_floating));
    own.into_iter().flat_map(both).chain(others).collect()
}

/// The URDF files below a folder.
fn below(folder: &Path, found: &mut Vec<String>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            below(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "urdf") {
            found.push(path.to_str().unwrap().to_owned());
        }
    }
}

fn is_taken(robot: &str, is_floating: bool) -> bool {
    let read = Scenario::parse(&head(robot, is_floating, DOWN, 1.0), "ordinary.toml", ROOT);
    read.and_then(|scenario| scenario.cases(&Catalog::standard())).is_ok_and(|cases| cases.plan(0).is_ok())
}

#[derive(Debug, Clone, Copy)]
enum Start {
    Rest,
    Tilted,
    Thrown(f64),
}

/// The joints of one degree of freedom that a start may name, with a coordinate within their limits.
fn joints(model: &Model) -> Vec<(String, f64)> {
    let own = model.own_joints().filter(|&joint| {
        let turns = matches!(model.described_joint(joint).kind, JointKind::Revolute | JointKind::Prismatic);
        turns && model.followed(joint).is_none()
    });
    own.map(|joint| {
        let limits = model.limits(joint);
        // Wheels and rotors turn without end, or nearly.
        let or = |limit: f64, other: f64| if limit.abs() < 10.0 { limit } else { other };
        let (lower, upper) = (or(limits.lower, -1.0), or(limits.upper, 1.0));
        let middle = 0.5 * (lower + upper);
        let q = middle + 0.2 * (upper - lower) * (1.7 * joint as f64 + 0.4).sin();
        (model.joint_names()[joint].clone(), q)
    })
    .collect()
}

/// A scenario of one of them and nothing else, at rest.
fn head(robot: &str, is_floating: bool, gravity: [f64; 3], end: f64) -> String {
    format!(
        "[robot]\nurdf = {robot:?}\nfloating_base = {is_floating}\naccept_inertia = true\ngravity = {gravity:?}\n\
         [time]\nend = {end}\noutput_step = {}\n[motion]\nkind = \"forward\"\n",
        end / 10.0
    )
}

/// The same with a start.
fn text(robot: &str, is_floating: bool, gravity: [f64; 3], start: Start, end: f64) -> String {
    let mut text = head(robot, is_floating, gravity, end);
    let joints = joints(&cases(&text).plan(0).unwrap().system().model);
    let (key, values): (_, Vec<f64>) = match start {
        Start::Rest => return text,
        Start::Tilted => ("q", joints.iter().map(|(_, q)| *q).collect()),
        Start::Thrown(v) => ("v", (0..joints.len()).map(|k| if k % 2 == 0 { v } else { -v }).collect()),
    };
    let _ = writeln!(text, "[motion.start.{key}]");
    for ((name, _), value) in joints.iter().zip(values) {
        let _ = writeln!(text, "{name:?} = {value:?}");
    }
    text
}

const DOWN: [f64; 3] = [0.0, 0.0, -9.81];
/// Hung on a wall, on the Moon.
const ASIDE: [f64; 3] = [0.3, 1.5, -0.4];

fn let_go(gravities: &[[f64; 3]], end: f64) {
    let mut tried = Tried::default();
    for (robot, is_floating) in robots() {
        for &gravity in gravities {
            let what = format!("{robot}, floating {is_floating}, gravity {gravity:?}");
            let mut go =
                |start| tried.one(&format!("{what}, {start:?}"), ran(&text(&robot, is_floating, gravity, start, end)));
            let (rest, nudged) = (go(Start::Rest), go(Start::Thrown(1e-3)));
            go(Start::Tilted);
            go(Start::Thrown(0.5));
            // Nothing happens at rest that a nudge would not do, too.
            if let Some((rest, nudged)) = rest.zip(nudged) {
                let enough = match rest.steps <= 2 * nudged.steps {
                    true => Ok(()),
                    false => Err(format!("{} steps from rest, and {} after a nudge", rest.steps, nudged.steps)),
                };
                tried.one(&what, enough);
            }
        }
    }
    tried.end(robots().len() * gravities.len() * 4);
}

#[test]
fn every_robot_is_thrown() {
    let mut tried = Tried::default();
    for (robot, is_floating) in robots() {
        for start in [Start::Thrown(1e-3), Start::Thrown(0.5)] {
            let what = format!("{robot}, floating {is_floating}, {start:?}");
            tried.one(&what, ran(&text(&robot, is_floating, DOWN, start, 0.1)));
        }
    }
    tried.end(28);
}

#[test]
fn every_robot_is_let_go() {
    let_go(&[DOWN], 0.1);
}

/// Joints that rest on their stops while all of the robot falls are pressed against them by rounding alone.
#[test]
fn every_robot_is_let_go_on_its_stops() {
    let mut tried = Tried::default();
    for (robot, is_floating) in robots() {
        let text = text(&robot, is_floating, DOWN, Start::Rest, 0.1);
        let limited = text.replacen("[time]", "limits = { stiffness = 1e4, damping = 10 }\n[time]", 1);
        let read = Scenario::parse(&limited, "ordinary.toml", ROOT).and_then(|s| s.cases(&Catalog::standard()));
        // Robots without limits refuse the key.
        if read.is_ok_and(|cases| cases.plan(0).is_ok()) {
            tried.one(&format!("{robot}, floating {is_floating}"), ran(&limited));
        }
    }
    tried.end(8);
}

#[test]
#[ignore = "some minutes"]
fn every_robot_is_let_go_for_a_second_under_two_gravities() {
    let_go(&[DOWN, ASIDE], 1.0);
}

#[test]
#[ignore = "some minutes"]
fn every_robot_floats_and_rests_without_gravity() {
    let mut tried = Tried::default();
    for (robot, is_floating) in robots() {
        for start in [Start::Rest, Start::Tilted, Start::Thrown(0.5)] {
            let what = format!("{robot}, floating {is_floating}, {start:?}");
            tried.one(&what, ran(&text(&robot, is_floating, [0.0; 3], start, 1.0)));
        }
    }
    tried.end(42);
}
